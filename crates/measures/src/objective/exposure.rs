//! Drives of unequal length: what is counted in one is held against what is counted in the same part of another.

use maveric_domain::Drive;
use std::collections::BTreeSet;

/// Lengths that differ by at most this share of the shortest are equal: logs end a moment sooner or later.
const EQUAL_SHARE: f64 = 0.01;
/// Share of the shortest drive's time that has to be left in each.
const LEAST_SHARE: f64 = 0.8;

/// How much a drive gives one to count: its length, and when it met each lead vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposure {
    /// From the first row to the last, in s.
    pub duration_s: f64,
    /// Time since the first row at which each lead vehicle was ahead in ego's lane for the first time, in s, rising.
    pub leads_s: Vec<f64>,
}

impl Exposure {
    /// That of a drive.
    pub fn from_drive(drive: &Drive) -> Self {
        let rows = drive.rows();
        let start = rows.time_s.first().copied().unwrap_or_default();
        let since = |row: usize| rows.time_s[row] - start;
        let (mut met, mut leads_s) = (BTreeSet::new(), Vec::new());
        for row in (0..drive.len()).filter(|&row| drive.lead_ahead(row)) {
            if met.insert(rows.lead_id[row]) {
                leads_s.push(since(row));
            }
        }
        Self { duration_s: drive.len().checked_sub(1).map_or(0.0, since), leads_s }
    }

    /// Lead vehicles met by a time.
    fn leads_by(&self, end_s: f64) -> usize {
        self.leads_s.partition_point(|&met| met <= end_s)
    }
}

/// The part of a drive that is held against the same part of a person's other drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Comparable {
    /// All of it: the drives are of equal length.
    Whole,
    /// From its start to this time, in s.
    Until(f64),
    /// Too little: so many s of the shortest drive's `of_s` are left once the drives have met as many lead vehicles.
    TooLittle {
        /// What would be left, in s.
        left_s: f64,
        /// The shortest drive, in s.
        of_s: f64,
    },
}

impl Comparable {
    /// Whether the drive has no count and no extreme that could be compared.
    pub fn is_too_little(self) -> bool {
        matches!(self, Self::TooLittle { .. })
    }
}

/// The comparable part of each of a person's drives, in their order.
///
/// Drives of one length (to 1 %) are compared whole. Else all are cut to the time of the shortest, and then to the number of lead
/// vehicles that each of them has met by then: one that meets more has more to overtake. A drive of which less than 80 % of the shortest
/// one's time is left is comparable with none.
///
/// # Example
/// ```
/// use maveric_measures::objective::{Comparable, Exposure, comparable};
/// let drive = |duration_s: f64| Exposure {
///     duration_s,
///     leads_s: (0..).map(|i| 10.0 + 60.0 * f64::from(i)).take_while(|t| *t < duration_s).collect(),
/// };
/// let parts = comparable(&[drive(300.0), drive(600.0)]);
/// assert_eq!(parts, [Comparable::Until(300.0), Comparable::Until(300.0)]);
/// ```
pub fn comparable(drives: &[Exposure]) -> Vec<Comparable> {
    let lengths = || drives.iter().map(|drive| drive.duration_s);
    let shortest = lengths().fold(f64::INFINITY, f64::min);
    let longest = lengths().fold(0.0, f64::max);
    if longest <= shortest * (1.0 + EQUAL_SHARE) {
        return vec![Comparable::Whole; drives.len()];
    }
    let met = drives.iter().map(|drive| drive.leads_by(shortest));
    let leads = met.min().unwrap_or_default();
    let part = |drive: &Exposure| {
        let next = drive.leads_s.get(leads).copied();
        let end_s = next.filter(|&next| next <= shortest).unwrap_or(shortest);
        if end_s < LEAST_SHARE * shortest {
            Comparable::TooLittle { left_s: end_s, of_s: shortest }
        } else {
            Comparable::Until(end_s)
        }
    };
    drives.iter().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::testing::Scripted;

    fn drive(duration_s: f64, leads_s: &[f64]) -> Exposure {
        Exposure { duration_s, leads_s: leads_s.to_vec() }
    }

    #[test]
    fn drives_of_one_length_are_compared_whole_whatever_they_met() {
        let parts = comparable(&[drive(600.0, &[5.0]), drive(606.0, &[5.0, 6.0, 7.0])]);
        assert_eq!(parts, [Comparable::Whole; 2]);
        assert_eq!(comparable(&[drive(30.0, &[])]), [Comparable::Whole]);
        assert!(comparable(&[]).is_empty());
        let longer = comparable(&[drive(600.0, &[5.0]), drive(606.1, &[5.0])]);
        assert_eq!(longer, [Comparable::Until(600.0); 2]);
    }

    #[test]
    fn the_longer_is_cut_to_the_time_and_the_leads_of_the_shorter() {
        let short = drive(300.0, &[10.0, 150.0]);
        let long = drive(600.0, &[10.0, 120.0, 280.0, 400.0, 500.0]);
        let parts = comparable(&[short.clone(), long.clone()]);
        assert_eq!(parts, [Comparable::Until(300.0), Comparable::Until(280.0)]);
        // The one that met fewer is the longer one: then the shorter is cut.
        let calm = drive(600.0, &[10.0]);
        let busy = drive(300.0, &[10.0, 250.0]);
        let parts = comparable(&[busy, calm]);
        assert_eq!(parts, [Comparable::Until(250.0), Comparable::Until(300.0)]);
    }

    #[test]
    fn less_than_four_fifths_of_the_shorter_are_refused() {
        let short = drive(300.0, &[10.0]);
        let at = |next: f64| comparable(&[short.clone(), drive(600.0, &[10.0, next])])[1];
        assert_eq!(at(240.0), Comparable::Until(240.0));
        let (left_s, of_s) = (239.9, 300.0);
        assert_eq!(at(239.9), Comparable::TooLittle { left_s, of_s });
    }

    #[test]
    fn a_lead_is_met_when_it_is_first_ahead_in_ones_own_lane() {
        // It comes into sight at once; nobody is there without one.
        let alone = Exposure::from_drive(&Scripted::new(40.0).drive());
        assert!(alone.leads_s.is_empty());
        assert!((alone.duration_s - 39.95).abs() < 1e-9, "{alone:?}");
        let one = Exposure::from_drive(&Scripted::new(40.0).lead(85.0, 25.0).drive());
        assert_eq!(one.leads_s.len(), 1);
        assert!(one.leads_s[0] < 1.0, "{one:?}");
    }
}

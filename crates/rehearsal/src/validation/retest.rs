//! How much of what differs between drives is the driver's: the reliability that bounds everything which is learned from one drive.

use super::{MEASURES, Values, title};
use maveric_measures::objective;
use maveric_stats::icc;
use serde::Serialize;

/// One measure of two drives of the same people.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Retest {
    pub measure: &'static str,
    pub title: &'static str,
    /// Its unit; `1` for counts and shares.
    pub unit: &'static str,
    /// People with a value in both drives.
    pub n: usize,
    /// People without one of the values.
    pub missing: usize,
    /// ICC(2,1): share of the variance of one drive that is between people.
    pub icc: Option<f64>,
    /// Its 95 % interval.
    pub interval: Option<(f64, f64)>,
    /// Standard error of measurement, in the measure's unit.
    pub sem: Option<f64>,
    /// Smallest detectable change, in the measure's unit.
    pub sdc: Option<f64>,
}

/// Every measure; both slices in the same order of people. A measure that fewer than two people have twice has no number.
pub fn retest(first: &[Values], again: &[Values]) -> Vec<Retest> {
    let row = |(k, measure): (usize, &&'static str)| {
        let [one, two] = [first, again].map(|d| d.iter().map(|v| v[k]).collect::<Vec<_>>());
        let agreement = icc(&[("first", &one), ("again", &two)]).ok();
        let known = |(a, b): &(&Option<f64>, &Option<f64>)| a.is_some() && b.is_some();
        let n = one.iter().zip(&two).filter(known).count();
        Retest {
            measure,
            title: title(k),
            unit: objective::find(measure).map_or("", |m| m.unit),
            n,
            missing: one.len() - n,
            icc: agreement.as_ref().and_then(|f| f.icc),
            interval: agreement.as_ref().and_then(|f| f.ci.ends()),
            sem: agreement.as_ref().map(|f| f.sem),
            sdc: agreement.map(|f| f.sdc),
        }
    };
    MEASURES.iter().enumerate().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_as_large_as_the_person_leaves_half_and_a_missing_value_is_counted() {
        let drive = |x: f64| {
            let mut values = Values::default();
            values[0] = Some(x);
            values
        };
        // Two people's means and two days, crossed: variances 1 and 1.
        let first = [10.0, 12.0, 10.0, 12.0, 9.0].map(drive);
        let mut again = [10.0, 12.0, 12.0, 10.0, 9.0].map(drive);
        again[4][0] = None;
        let rows = retest(&first, &again);
        let speed = &rows[0];
        assert_eq!((speed.n, speed.missing), (4, 1));
        // Differences 0, 0, 2, -2: no difference between days, error (4 + 4)/2/3.
        assert!((speed.sem.unwrap() - (4.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((speed.sdc.unwrap() - 1.96 * (8.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        let (low, high) = speed.interval.unwrap();
        assert!(low < speed.icc.unwrap() && speed.icc.unwrap() < high);
        assert_eq!((rows[1].n, rows[1].icc, rows[1].sem), (0, None, None));
    }
}

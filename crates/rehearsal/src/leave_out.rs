//! People left out in turn: what a model that has never met somebody says of their drives, beside what any clock and ruler say.
//!
//! Nothing is compared across models but what the road measures, and what was put into the spread between people of its own model.

mod direction;
mod errors;
mod identity;
mod order;
mod retest;
mod shipped;

pub use direction::{AXES, Change, Direction, PersonDirection, Pointed, direction};
pub use errors::{ErrorShare, errors_that_hold};
pub use identity::{Whose, whose};
pub use order::{Asked, By, Mean, Order, PersonOrder, ReadOrder, order};
pub use retest::{Repeated, Retest, retest};
pub use shipped::{Shipped, ShippedPerson, shipped};

use crate::{
    error::RehearsalError,
    validation::{Known, mean},
};
use maveric_domain::{ConditionId, DriveId, ParticipantId};
use maveric_stats::{Proportion, proportion_exact};
use serde::Serialize;
use std::fmt;

/// A drive of somebody who was told how to drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Drove {
    /// The recording, by its id.
    pub drive: DriveId,
    pub participant: ParticipantId,
    /// What they were told; a role that repeats another is that one.
    pub role: ConditionId,
    /// The score that belongs to it, in points.
    pub points: Option<f64>,
    pub speed_mps: Option<f64>,
    /// Median time gap over the samples with a vehicle ahead, in s.
    pub time_gap_s: Option<f64>,
}

/// What a model that has not met one person makes of every drive, in the order of the drives; none where a drive shows nothing.
#[derive(Debug, Clone, Default)]
pub struct Line {
    /// Position on the line of the score.
    pub position: Vec<Option<f64>>,
    pub se: Vec<Option<f64>>,
    /// The score read from the style, in points.
    pub score: Vec<Option<f64>>,
}

/// The styles of every drive as a model that has not met one person reads them, in the order of the drives.
pub type Styles = Vec<Option<Known>>;

/// Somebody whom a table cannot count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Uncounted {
    pub participant: ParticipantId,
    #[serde(flatten)]
    pub why: Missing,
}

/// What is missing of somebody.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "missing")]
pub enum Missing {
    /// They drove in no such role.
    Drive { role: ConditionId },
    /// They drove only once in the role.
    Second {
        /// The role that was to be driven twice.
        role: ConditionId,
    },
    /// Nothing can be read from a drive.
    Reading {
        /// The drive that shows nothing.
        drive: DriveId,
        /// By what it would be read.
        by: By,
    },
    /// One of their two drives has no value of these measures; in the others they are counted.
    Measures {
        /// What the measures are called.
        measures: Vec<String>,
    },
    /// Nothing that changes was measured in both of their drives and in both of the car's.
    Change,
}

impl Uncounted {
    fn new(participant: &ParticipantId, why: Missing) -> Self {
        let participant = participant.clone();
        Self { participant, why }
    }
}

impl Missing {
    fn reading(drive: &Drove, by: By) -> Self {
        let drive = drive.drive.clone();
        Self::Reading { drive, by }
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drive { role } => write!(f, "no drive in the role `{role}`"),
            Self::Second { role } => write!(f, "one drive in the role `{role}`, expected two"),
            Self::Reading { drive, by } => {
                let what = match by {
                    By::Line => "no habit that places it on the line",
                    By::Speed => "no speed",
                    By::TimeGap => "no vehicle ahead, so no time gap",
                };
                write!(f, "drive {drive} shows {what}")
            }
            Self::Measures { measures } => {
                let measures = measures.join(", ").to_lowercase();
                write!(f, "no {measures} in one of the two drives, counted in the rest")
            }
            Self::Change => {
                f.write_str("no change that was measured in their drives and in the car's")
            }
        }
    }
}

/// Everybody who drove, in order.
pub fn people(drives: &[Drove]) -> Vec<ParticipantId> {
    let mut people: Vec<ParticipantId> = drives.iter().map(|d| d.participant.clone()).collect();
    people.sort();
    people.dedup();
    people
}

/// The places of somebody's drives in a role, in the order of the drives.
fn driven(drives: &[Drove], who: &ParticipantId, role: ConditionId) -> Vec<usize> {
    let theirs = |(_, d): &(usize, &Drove)| d.participant == *who && d.role == role;
    let places = drives.iter().enumerate().filter(theirs);
    places.map(|(place, _)| place).collect()
}

/// A share with Clopper and Pearson's 95 % interval; none of nobody.
fn share(hits: usize, n: usize) -> Result<Option<Proportion>, RehearsalError> {
    let share = (n > 0).then(|| proportion_exact(hits, n, 0.95));
    Ok(share.transpose()?)
}

/// Standard errors to either side of an interval that a true difference lies in about 95 times of 100.
const REACH: f64 = 2.0;

/// Whether a wrong order is not what the standard error lets expect: the interval of its difference does not hold 0. Where no standard
/// error is known nobody can say so.
fn wrong_and_sure(wrong: bool, difference: Option<f64>, se: Option<f64>) -> bool {
    wrong && difference.zip(se).is_some_and(|(d, se)| d.abs() > REACH * se)
}

/// Mean and SD between people of a value over everybody but `who`, the SD within roles and pooled over them; none where no role has
/// two people who differ.
pub fn between_people(
    drives: &[Drove],
    values: &[Option<f64>],
    who: &ParticipantId,
) -> Option<(f64, f64)> {
    let mut roles: Vec<ConditionId> = drives.iter().map(|d| d.role).collect();
    roles.sort();
    roles.dedup();
    let (mut squares, mut free, mut values_of_others) = (0.0, 0.0, Vec::new());
    for role in roles {
        let others = drives.iter().zip(values);
        let others = others.filter(|(d, _)| d.participant != *who && d.role == role);
        let known: Vec<f64> = others.filter_map(|(_, v)| *v).collect();
        let Some(centre) = mean(&known) else { continue };
        squares += known.iter().map(|v| (v - centre).powi(2)).sum::<f64>();
        free += known.len() as f64 - 1.0;
        values_of_others.extend(known);
    }
    let sd = (free > 0.0).then(|| (squares / free).sqrt())?;
    (sd > 0.0).then_some((mean(&values_of_others)?, sd))
}

#[cfg(test)]
pub(crate) mod testing {
    use super::*;

    /// A drive of person `who` in a role, with speed in m/s and time gap in s.
    pub(crate) fn drove(
        who: &str,
        role: &str,
        points: f64,
        speed: f64,
        gap: impl Into<Option<f64>>,
    ) -> Drove {
        Drove {
            drive: DriveId::new(format!("{who}-{role}-{:.0}", 1000.0 * speed)).unwrap(),
            participant: ParticipantId::new(who).unwrap(),
            role: role.parse().unwrap(),
            points: Some(points),
            speed_mps: Some(speed),
            time_gap_s: gap.into(),
        }
    }

    /// Six people, calm and sporty: sporty is 4 m/s faster for everybody but the last, who is told the same and drives slower.
    pub(crate) fn six() -> Vec<Drove> {
        let mut drives = Vec::new();
        for i in 0..6_u8 {
            let (who, own) = (format!("P{i}"), f64::from(i));
            let by = if i == 5 { -0.4 } else { 4.0 };
            drives.push(drove(&who, "calm", 20.0, 25.0 + own, 2.0 - 0.05 * own));
            let gap = 1.5 - 0.05 * own;
            drives.push(drove(&who, "sporty", 45.0, 25.0 + own + by, gap));
        }
        drives
    }
}

#[cfg(test)]
mod tests {
    use super::{testing::*, *};

    #[test]
    fn the_spread_between_people_knows_neither_the_roles_nor_who_is_left_out() {
        let drives = [
            drove("A", "calm", 1.0, 10.0, None),
            drove("A", "sporty", 1.0, 30.0, None),
            drove("B", "calm", 1.0, 12.0, None),
            drove("B", "sporty", 1.0, 32.0, None),
            drove("C", "calm", 1.0, 99.0, None),
        ];
        let speeds: Vec<Option<f64>> = drives.iter().map(|d| d.speed_mps).collect();
        let (centre, sd) = between_people(&drives, &speeds, &drives[4].participant).unwrap();
        assert!((centre - 21.0).abs() < 1e-12 && (sd - 2.0_f64.sqrt()).abs() < 1e-12);
        let gaps = vec![None; drives.len()];
        assert_eq!(between_people(&drives, &gaps, &drives[4].participant), None);
        assert_eq!(people(&drives).len(), 3);
    }

    #[test]
    fn what_is_missing_is_said_by_name() {
        let role: ConditionId = "sporty".parse().unwrap();
        let drive = DriveId::new("P1-calm").unwrap();
        let said = [
            Missing::Drive { role }.to_string(),
            Missing::Second { role }.to_string(),
            Missing::Reading { drive, by: By::TimeGap }.to_string(),
            Missing::Measures {
                measures: vec!["Mean speed".to_owned(), "Smallest gap".to_owned()],
            }
            .to_string(),
        ];
        assert!(said[3].starts_with("no mean speed, smallest gap in one of the two drives"));
        assert_eq!(said[0], "no drive in the role `sporty`");
        assert_eq!(said[1], "one drive in the role `sporty`, expected two");
        assert!(said[2].contains("P1-calm") && said[2].contains("vehicle ahead"));
    }
}

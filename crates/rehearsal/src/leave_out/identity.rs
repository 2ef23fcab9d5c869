//! Whose drive is it? Read by the model that has not met the driver, among one drive of everybody.

use super::{Drove, Missing, Styles, Uncounted, driven, people, share};
use crate::{error::RehearsalError, leave_out::By, validation::distance};
use maveric_domain::ConditionId;
use maveric_stats::Proportion;
use serde::Serialize;

/// How many drivers are found again.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Whose {
    /// The role whose first drive stands for everybody.
    pub among: ConditionId,
    /// The role of the drive whose driver is looked for: its first drive or, in the same role, the second.
    pub sought: ConditionId,
    /// By what: the style, speed alone, time gap alone.
    pub by: By,
    pub n: usize,
    /// Drivers among whom each is looked for, on average.
    pub candidates: f64,
    /// Share that chance would find.
    pub chance: f64,
    /// Drivers whose own drive is the nearest; a tie is not nearest.
    pub hits: usize,
    /// Their share, with Clopper and Pearson's interval; none without drivers.
    pub share: Option<Proportion>,
    pub uncounted: Vec<Uncounted>,
}

/// Looks for the driver of each drive in a role among the drives of everybody in another, or in the same; `folds` in the order of
/// [`people`]. A style is near by what both posteriors leave open.
///
/// # Errors
/// [`RehearsalError::Stats`] where an interval has no ends.
pub fn whose(
    drives: &[Drove],
    folds: &[Styles],
    among: ConditionId,
    sought: ConditionId,
) -> Result<Vec<Whose>, RehearsalError> {
    let everybody = people(drives);
    // Of each person the drive that stands for them, and the one whose driver is looked for.
    let first: Vec<Option<usize>> =
        everybody.iter().map(|who| driven(drives, who, among).first().copied()).collect();
    let place = usize::from(among == sought);
    let mut rows = Vec::new();
    for by in By::ALL {
        let (mut n, mut hits, mut candidates, mut chance) = (0, 0, 0, 0.0);
        let mut uncounted = Vec::new();
        for (who, person) in everybody.iter().enumerate() {
            let mut miss = |why| uncounted.push(Uncounted::new(person, why));
            let Some(own) = first[who] else {
                miss(Missing::Drive { role: among });
                continue;
            };
            let Some(&seen) = driven(drives, person, sought).get(place) else {
                miss(if place == 0 {
                    Missing::Drive { role: sought }
                } else {
                    Missing::Second { role: sought }
                });
                continue;
            };
            let apart = |other: usize| match by {
                By::Line => {
                    let styles = folds.get(who)?;
                    distance(styles[other].as_ref()?, styles[seen].as_ref()?)
                }
                By::Speed => Some((drives[other].speed_mps? - drives[seen].speed_mps?).abs()),
                By::TimeGap => Some((drives[other].time_gap_s? - drives[seen].time_gap_s?).abs()),
            };
            let Some(distance) = apart(own) else {
                // One of the two shows nothing; the one that is looked for, where it measures nothing itself.
                let drive = if apart(seen).is_none() { seen } else { own };
                miss(Missing::reading(&drives[drive], by));
                continue;
            };
            let others = (0..everybody.len()).filter(|&other| other != who);
            let others: Vec<f64> = others.filter_map(|o| apart(first[o]?)).collect();
            n += 1;
            candidates += 1 + others.len();
            chance += 1.0 / (1 + others.len()) as f64;
            hits += usize::from(others.iter().all(|other| distance < *other));
        }
        rows.push(Whose {
            among,
            sought,
            by,
            n,
            candidates: candidates as f64 / n.max(1) as f64,
            chance: chance / n.max(1) as f64,
            hits,
            share: share(hits, n)?,
            uncounted,
        });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::{super::testing::*, *};

    fn styles(drives: &[Drove], of: impl Fn(usize) -> Option<f64>) -> Vec<Styles> {
        let one: Styles =
            (0..drives.len()).map(|i| of(i).map(|w| (vec![w], vec![vec![0.01]]))).collect();
        vec![one; people(drives).len()]
    }

    #[test]
    fn whoever_drives_alike_is_found_and_whoever_drives_like_another_is_not() {
        let drives = six();
        let (calm, sporty) = (drives[0].role, drives[1].role);
        let alike = styles(&drives, |i| Some((i / 2) as f64 + 0.1 * (i % 2) as f64));
        let found = whose(&drives, &alike, calm, sporty).unwrap();
        let line = &found[0];
        assert_eq!((line.by, line.n, line.hits), (By::Line, 6, 6));
        assert!((line.chance - 1.0 / 6.0).abs() < 1e-12);
        // 4 m/s faster is the calm speed of another; only the one who drives slower is nearest to their own.
        assert_eq!((found[1].by, found[1].hits), (By::Speed, 1));
        let turned = styles(&drives, |i| Some((((i / 2) + i % 2) % 6) as f64));
        assert_eq!(whose(&drives, &turned, calm, sporty).unwrap()[0].hits, 0);
    }

    #[test]
    fn one_drive_in_a_role_is_no_second_and_what_shows_nothing_is_not_counted() {
        let drives = six();
        let calm = drives[0].role;
        let none = whose(&drives, &styles(&drives, |_| Some(0.0)), calm, calm).unwrap();
        assert_eq!((none[0].n, none[0].share), (0, None));
        assert_eq!(none[0].uncounted[0].why, Missing::Second { role: calm });
        let silent = styles(&drives, |i| (i != 1).then_some(i as f64));
        let found = whose(&drives, &silent, calm, drives[1].role).unwrap();
        assert_eq!((found[0].n, found[0].uncounted.len()), (5, 1));
        assert_eq!(found[1].n, 6, "its speed is known");
    }
}

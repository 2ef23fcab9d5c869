//! Is the car's driving like its owner's as a distribution, and more like it than other people's is?

use super::mean;
use crate::error::RehearsalError;
use maveric_measures::likeness::{COLUMNS, Discrepancy, Spread, Window, discrepancy};
use maveric_stats::proportion;
use serde::Serialize;

/// Random splits behind each p.
const PERMUTATIONS: usize = 99;
/// p below which two drives count as driven differently.
const DIFFERENT: f64 = 0.05;

/// One kind of drive beside the owner's first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Likeness {
    pub what: &'static str,
    pub n: usize,
    /// Mean squared maximum mean discrepancy.
    pub mmd2: Option<f64>,
    /// Mean Kullback-Leibler divergence, in nats.
    pub divergence: Option<f64>,
    /// Share of owners from whom it differs by more than chance (p < .05); none where that was not asked.
    pub different: Option<f64>,
    /// Share of owners who are the nearest of all people to it; only for one drive an owner.
    pub owner_nearest: Option<f64>,
    /// Ends of Wilson's 95 % interval of that.
    pub owner_nearest_interval: Option<(f64, f64)>,
    /// Mean place of the owner among all people, 1 being the nearest.
    pub mean_rank: Option<f64>,
}

/// Which columns of the windows are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Looking {
    Alone,
    Without,
}

/// How far the drives of the own style, and those beside them, are from the owners' first drives in some columns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ByColumn {
    /// The column that is looked at alone, or left out.
    pub column: &'static str,
    pub looking: Looking,
    /// The second drive of the owner.
    pub again: Likeness,
    /// The car in the own style.
    pub car: Likeness,
    /// The first drives of other people.
    pub others: Likeness,
}

/// The windows of what is compared, each in the same order of people.
pub struct Driven {
    pub own: Vec<Vec<Window>>,
    /// Own second drives: no likeness can be expected to be better.
    pub again: Vec<Vec<Window>>,
    /// The car in the own style.
    pub mimic: Vec<Vec<Window>>,
    /// The car with the mean style, on each person's road: what knowing nobody gives.
    pub average: Vec<Vec<Window>>,
}

const AGAIN: &str = "second drive of the owner (ceiling)";
const CAR: &str = "car in the own style";
const OTHERS: &str = "first drives of other people";

impl Driven {
    fn spread(&self) -> Spread {
        let drives = [&self.own, &self.again];
        Spread::of(drives.into_iter().flatten().map(Vec::as_slice))
    }

    /// Each drive beside its owner's first.
    fn beside_owner(
        &self,
        drives: &[Vec<Window>],
        spread: &Spread,
        seed: u64,
    ) -> Vec<Option<Discrepancy>> {
        let owners = drives.iter().zip(&self.own);
        owners.map(|(drive, own)| discrepancy(drive, own, spread, PERMUTATIONS, seed)).collect()
    }

    /// Each first drive beside those of all other people.
    fn between_people(&self, spread: &Spread, seed: u64) -> Vec<Discrepancy> {
        let mut discrepancies = Vec::new();
        for (i, one) in self.own.iter().enumerate() {
            for (j, other) in self.own.iter().enumerate() {
                if i != j {
                    discrepancies.extend(discrepancy(one, other, spread, 0, seed));
                }
            }
        }
        discrepancies
    }
}

/// Holds each kind against the owners' first drives.
///
/// # Errors
/// [`RehearsalError::Stats`] without people.
pub fn likeness(driven: &Driven, seed: u64) -> Result<Vec<Likeness>, RehearsalError> {
    let spread = driven.spread();
    let kinds = [
        (AGAIN, &driven.again),
        (CAR, &driven.mimic),
        ("the car with the mean style (floor)", &driven.average),
    ];
    let mut rows = Vec::new();
    for (what, drives) in kinds {
        let mut discrepancies: Vec<Discrepancy> = Vec::new();
        let mut ranks: Vec<usize> = Vec::new();
        let beside = driven.beside_owner(drives, &spread, seed);
        for (i, (drive, owner)) in drives.iter().zip(beside).enumerate() {
            let Some(owner) = owner else {
                continue;
            };
            let others = (0..driven.own.len()).filter(|&j| j != i);
            let nearer = others
                .filter_map(|j| discrepancy(drive, &driven.own[j], &spread, 0, seed))
                .filter(|d| d.mmd2 <= owner.mmd2);
            ranks.push(1 + nearer.count());
            discrepancies.push(owner);
        }
        rows.push(row(what, &discrepancies, &ranks)?);
    }
    rows.push(row(OTHERS, &driven.between_people(&spread, seed), &[])?);
    Ok(rows)
}

/// By what drives differ: the same with each column of the windows alone, and without each.
///
/// # Errors
/// [`RehearsalError::Stats`] without people.
pub fn likeness_by_column(driven: &Driven, seed: u64) -> Result<Vec<ByColumn>, RehearsalError> {
    let full_spread = driven.spread();
    let mut rows = Vec::new();
    for looking in [Looking::Alone, Looking::Without] {
        for (k, column) in COLUMNS.into_iter().enumerate() {
            let spread = match looking {
                Looking::Alone => full_spread.only(k),
                Looking::Without => full_spread.without(k),
            };
            let beside = |drives: &[Vec<Window>]| -> Vec<Discrepancy> {
                let discrepancies = driven.beside_owner(drives, &spread, seed);
                discrepancies.into_iter().flatten().collect()
            };
            rows.push(ByColumn {
                column,
                looking,
                again: row(AGAIN, &beside(&driven.again), &[])?,
                car: row(CAR, &beside(&driven.mimic), &[])?,
                others: row(OTHERS, &driven.between_people(&spread, seed), &[])?,
            });
        }
    }
    Ok(rows)
}

fn row(
    what: &'static str,
    discrepancies: &[Discrepancy],
    ranks: &[usize],
) -> Result<Likeness, RehearsalError> {
    let mean_of = |value: &dyn Fn(&Discrepancy) -> Option<f64>| {
        let values: Vec<f64> = discrepancies.iter().filter_map(value).collect();
        mean(&values)
    };
    let hits = ranks.iter().filter(|&&r| r == 1).count();
    let share = match ranks.len() {
        0 => None,
        n => Some(proportion(hits, n, 0.95)?),
    };
    let places: Vec<f64> = ranks.iter().map(|&r| r as f64).collect();
    Ok(Likeness {
        what,
        n: discrepancies.len(),
        mmd2: mean_of(&|d| Some(d.mmd2)),
        divergence: mean_of(&|d| Some(d.divergence)),
        different: mean_of(&|d| d.p.map(|p| f64::from(u8::from(p < DIFFERENT)))),
        owner_nearest: share.as_ref().map(|s| s.estimate),
        owner_nearest_interval: share.map(|s| (s.low, s.high)),
        mean_rank: mean(&places),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Windows around a speed, in a fixed pattern that no two phases share.
    fn drive(speed: f64, phase: usize) -> Vec<Window> {
        let wobble = |i: usize, k: usize| (((i + phase) * (k + 3)) as f64 * 0.7).sin();
        (0..60)
            .map(|i| std::array::from_fn(|k| wobble(i, k) + if k == 0 { speed } else { 0.0 }))
            .collect()
    }

    #[test]
    fn who_drives_alike_twice_is_nearest_to_themselves_and_the_average_to_nobody() {
        let people = [20.0, 24.0, 28.0, 32.0];
        let of = |phase: usize| people.map(|v| drive(v, phase)).to_vec();
        let driven = Driven {
            own: of(0),
            again: of(5),
            mimic: people.map(|v| drive(v + 0.3, 9)).to_vec(),
            average: people.map(|_| drive(26.0, 9)).to_vec(),
        };
        let rows = likeness(&driven, 1).unwrap();
        let [again, car, floor, others] = &rows[..] else {
            panic!("{rows:?}");
        };
        assert_eq!(again.owner_nearest, Some(1.0));
        assert_eq!(car.owner_nearest, Some(1.0));
        assert!(floor.owner_nearest.unwrap() <= 0.5);
        let mmd2 = |row: &Likeness| row.mmd2.unwrap();
        assert!(mmd2(again) < mmd2(floor) && mmd2(car) < mmd2(floor) && mmd2(again) < mmd2(others));
        assert_eq!((others.n, others.owner_nearest), (12, None));
    }

    #[test]
    fn a_car_that_differs_in_one_column_is_told_by_it_and_by_no_other() {
        let own: Vec<Vec<Window>> = (0..4).map(|phase| drive(24.0, phase)).collect();
        // Its jerk alone is that of nobody.
        let smooth = |drive: &Vec<Window>| -> Vec<Window> {
            drive.iter().map(|&[v, g, a, j, y]| [v, g, a, j - 4.0, y]).collect()
        };
        let driven = Driven {
            mimic: own.iter().map(smooth).collect(),
            again: own.iter().rev().cloned().collect(),
            average: own.clone(),
            own,
        };
        let rows = likeness_by_column(&driven, 1).unwrap();
        assert_eq!(rows.len(), 10);
        for row in rows {
            let by_jerk = (row.column == "jerk") == (row.looking == Looking::Alone);
            assert_eq!(row.car.different, Some(f64::from(u8::from(by_jerk))), "{row:?}");
            assert_eq!(row.car.divergence > row.others.divergence, by_jerk, "{row:?}");
            assert_eq!((row.car.owner_nearest, row.again.n), (None, 4));
        }
    }
}

//! Many laws behind the same leader, driven abreast.
#![allow(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "code for one processor must be inlined into the function compiled for it; lanes of several arrays run abreast"
)]

use crate::{
    closed_loop::{MAX_ACCEL_MPS2, MIN_ACCEL_MPS2},
    run::Stretch,
};
use maveric_laws::Idm;
use pulp::{Arch, NullaryFnOnce};
use std::ops::Range;

pub(crate) const LANES: usize = 16;
/// One number of each car.
pub(crate) type Lanes = [f64; LANES];
/// Rows after which cars that are out of the race make room for others.
const BLOCK: usize = 128;
/// Numbers of a law at most.
const NUMBERS: usize = 7;

/// A car between two blocks of rows.
struct Car<'a> {
    /// Place of its law among those that are driven.
    place: usize,
    law: &'a Idm,
    gap_m: f64,
    speed_mps: f64,
    /// Sum of squared errors of the gap so far, in m².
    squares: f64,
}

/// RMSE of the gap of each law over the rows after the first, in m, or infinity once it must exceed the limit beside it; as
/// [`SimulationErrors`](crate::SimulationErrors) of one law after the other have it.
pub(crate) fn gap_rmse_each(stretch: &Stretch<'_>, laws: &[Idm], limits_m: &[f64]) -> Vec<f64> {
    let n = (stretch.rows.len() - 1) as f64;
    let most = |car: &Car<'_>| limits_m[car.place].max(0.0).powi(2) * n;
    let mut cars = cars(stretch, laws);
    // Below 0 nothing is within the limit, a car without an error neither.
    cars.retain(|car| limits_m[car.place] >= 0.0);
    let mut room = [[0.0; LANES]; BLOCK];
    for rows in blocks(stretch) {
        for abreast in cars.chunks_mut(LANES) {
            let errors = &mut room[..rows.len()];
            drive(stretch, rows.clone(), abreast, errors);
            let squares = Arch::new().dispatch(Squares { errors });
            for (car, squares) in abreast.iter_mut().zip(squares) {
                car.squares += squares;
            }
        }
        // What is no number is within no limit.
        cars.retain(|car| car.squares <= most(car));
    }
    let mut rmse_m = vec![f64::INFINITY; laws.len()];
    for car in cars {
        rmse_m[car.place] = (car.squares / n).sqrt();
    }
    rmse_m
}

/// Sums over the rows after the first of products of errors of the gap, in m²: those of the first law, and of how far each other law's lie
/// from them. At most [`LANES`] laws.
pub(crate) fn products(stretch: &Stretch<'_>, laws: &[Idm]) -> [Lanes; LANES] {
    let mut cars = cars(stretch, laws);
    let mut sums = [[0.0; LANES]; LANES];
    let mut room = [[0.0; LANES]; BLOCK];
    for rows in blocks(stretch) {
        let errors = &mut room[..rows.len()];
        drive(stretch, rows, &mut cars, errors);
        Arch::new().dispatch(AddProducts { errors, laws: laws.len(), sums: &mut sums });
    }
    sums
}

fn cars<'a>(stretch: &Stretch<'_>, laws: &'a [Idm]) -> Vec<Car<'a>> {
    let (columns, first) = (stretch.run.columns(), stretch.rows.start);
    let car = |(place, law)| Car {
        place,
        law,
        gap_m: columns.gap_m[first],
        speed_mps: columns.ego_speed_mps[first].max(0.0),
        squares: 0.0,
    };
    laws.iter().enumerate().map(car).collect()
}

/// The rows of a stretch after its first, block by block.
fn blocks(stretch: &Stretch<'_>) -> impl Iterator<Item = Range<usize>> {
    let end = stretch.rows.end;
    (stretch.rows.start + 1..end).step_by(BLOCK).map(move |start| start..(start + BLOCK).min(end))
}

/// Drives up to [`LANES`] cars through some rows, as many as `errors`: of each one's gap at each of them, in m.
fn drive(stretch: &Stretch<'_>, rows: Range<usize>, cars: &mut [Car<'_>], errors: &mut [Lanes]) {
    // A lane without a car repeats the last one.
    let car_of = |lane: usize| lane.min(cars.len() - 1);
    let mut p = [[0.0; LANES]; NUMBERS];
    for l in 0..LANES {
        for (lanes, number) in p.iter_mut().zip(numbers(cars[car_of(l)].law)) {
            lanes[l] = number;
        }
    }
    let mut state = State {
        gap_m: std::array::from_fn(|l| cars[car_of(l)].gap_m),
        speed_mps: std::array::from_fn(|l| cars[car_of(l)].speed_mps),
    };
    Arch::new().dispatch(
        #[inline(always)]
        || drive_rows(stretch, rows, &p, &mut state, errors),
    );
    for (l, car) in cars.iter_mut().enumerate() {
        (car.gap_m, car.speed_mps) = (state.gap_m[l], state.speed_mps[l]);
    }
}

struct State {
    gap_m: Lanes,
    speed_mps: Lanes,
}

/// As [`simulate`](crate::simulate) does, every lane by its own law.
#[inline(always)]
fn drive_rows(
    stretch: &Stretch<'_>,
    rows: Range<usize>,
    p: &[Lanes; NUMBERS],
    state: &mut State,
    errors: &mut [Lanes],
) {
    let columns = stretch.run.columns();
    let step_s = 1.0 / stretch.run.rate_hz();
    let (mut gap, mut speed) = (state.gap_m, state.speed_mps);
    for (row, errors) in rows.zip(errors) {
        let lead_mps = columns.lead_speed_mps[row - 1];
        let leader_moved_m = columns.leader_x_m[row] - columns.leader_x_m[row - 1];
        let recorded_m = columns.gap_m[row];
        let (mut accel, mut next, mut moved) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let mut stops = false;
        for l in 0..LANES {
            let closing_m = speed[l] * (speed[l] - lead_mps) * p[6][l];
            let share = speed[l] * p[5][l];
            let wanted = idm(p, l).accel_of_mps2(share, closing_m, gap[l], speed[l]);
            accel[l] = wanted.clamp(MIN_ACCEL_MPS2, MAX_ACCEL_MPS2);
            next[l] = speed[l] + accel[l] * step_s;
            moved[l] = 0.5 * (speed[l] + next[l]) * step_s;
            stops |= next[l] < 0.0;
        }
        if stops {
            for l in 0..LANES {
                if next[l] < 0.0 {
                    moved[l] = speed[l] * speed[l] / (2.0 * accel[l].abs());
                    next[l] = 0.0;
                }
            }
        }
        for l in 0..LANES {
            gap[l] = gap[l] + leader_moved_m - moved[l];
            errors[l] = gap[l] - recorded_m;
        }
        speed = next;
    }
    (state.gap_m, state.speed_mps) = (gap, speed);
}

/// The numbers of a law; the last two are what it multiplies by in the place of a division.
pub(crate) fn numbers(law: &Idm) -> [f64; NUMBERS] {
    [
        law.desired_speed_mps,
        law.time_gap_s,
        law.standstill_gap_m,
        law.max_accel_mps2,
        law.comfortable_braking_mps2,
        1.0 / law.desired_speed_mps,
        1.0 / law.braking_mps2(),
    ]
}

#[inline(always)]
fn idm(p: &[Lanes; NUMBERS], l: usize) -> Idm {
    Idm {
        desired_speed_mps: p[0][l],
        time_gap_s: p[1][l],
        standstill_gap_m: p[2][l],
        max_accel_mps2: p[3][l],
        comfortable_braking_mps2: p[4][l],
    }
}

/// Sums over rows of the squared error of each car.
struct Squares<'a> {
    errors: &'a [Lanes],
}

impl NullaryFnOnce for Squares<'_> {
    type Output = Lanes;

    #[inline(always)]
    fn call(self) -> Lanes {
        let mut sums = [0.0; LANES];
        for of_row in self.errors {
            for l in 0..LANES {
                sums[l] += of_row[l] * of_row[l];
            }
        }
        sums
    }
}

/// Adds to the sums over rows what [`products`] gives.
struct AddProducts<'a> {
    errors: &'a mut [Lanes],
    laws: usize,
    sums: &'a mut [Lanes; LANES],
}

impl NullaryFnOnce for AddProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for of_row in self.errors {
            let first = of_row[0];
            for l in 1..LANES {
                of_row[l] -= first;
            }
            let of_row = *of_row;
            for (sums, by) in self.sums[..self.laws].iter_mut().zip(of_row) {
                let added: Lanes = std::array::from_fn(|l| sums[l] + by * of_row[l]);
                *sums = added;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SimulationErrors, simulate, testing};

    /// Twenty-one drivers who differ in their time gaps alone.
    fn laws() -> Vec<Idm> {
        let shares = (0..21).map(|i| f64::from(i) / 20.0);
        shares.map(|share| testing::DRIVER.with_time_gap_s(0.3 + 2.5 * share)).collect()
    }

    /// A run in which the leader stands still for a while.
    fn stop_and_go() -> crate::FollowingRun {
        let lead = |t: f64| (9.0 * (t / 9.0).sin() + 4.0).max(0.0);
        testing::behind("P01", 700, 12.0, 4.0, lead)
    }

    #[test]
    fn abreast_every_law_errs_as_it_does_alone() {
        let (run, laws) = (stop_and_go(), laws());
        let fit = run.fit();
        let found = gap_rmse_each(&fit, &laws, &[f64::INFINITY; 21]);
        for (law, found) in laws.iter().zip(found) {
            let alone = simulate(&fit, "", |g, v, lead| law.accel_mps2(g, v, lead)).unwrap();
            let alone = SimulationErrors::between(&fit, &alone).gap_rmse_m;
            assert!((found - alone).abs() <= 1e-9 * alone, "{law:?}: {found} {alone}");
        }
    }

    #[test]
    fn who_exceeds_the_limit_is_out_and_changes_nothing_for_the_others() {
        let (run, laws) = (stop_and_go(), laws());
        let fit = run.fit();
        let all = gap_rmse_each(&fit, &laws, &[f64::INFINITY; 21]);
        let limit = |(i, rmse): (usize, &f64)| if i % 3 == 0 { 1.01 * rmse } else { 0.99 * rmse };
        let limits: Vec<f64> = all.iter().enumerate().map(limit).collect();
        let within = gap_rmse_each(&fit, &laws, &limits);
        for (i, (all, within)) in all.iter().zip(&within).enumerate() {
            let expected = if i % 3 == 0 { *all } else { f64::INFINITY };
            assert_eq!(within.to_bits(), expected.to_bits(), "{i}");
        }
        let none = gap_rmse_each(&fit, &laws[..2], &[-1.0, f64::NAN]);
        assert!(none.iter().all(|n| n.is_infinite()));
    }

    #[test]
    fn products_are_those_of_the_first_and_of_the_ways_from_it() {
        let (run, laws) = (stop_and_go(), laws());
        let fit = run.fit();
        let errors = |law: &Idm| -> Vec<f64> {
            let driven = simulate(&fit, "", |g, v, lead| law.accel_mps2(g, v, lead)).unwrap();
            let recorded = &run.columns().gap_m[fit.rows()];
            driven.gap_m.iter().zip(recorded).skip(1).map(|(a, b)| a - b).collect()
        };
        let first = errors(&laws[3]);
        let way = |law: &Idm| -> Vec<f64> {
            errors(law).iter().zip(&first).map(|(a, b)| a - b).collect()
        };
        let lines = [first.clone(), way(&laws[4]), way(&laws[9])];
        let found = products(&fit, &[laws[3], laws[4], laws[9]]);
        for (k, a) in lines.iter().enumerate() {
            for (l, b) in lines.iter().enumerate() {
                let expected: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                assert!((found[k][l] - expected).abs() <= 1e-9 * expected.abs(), "{k} {l}");
            }
        }
    }
}

//! The linear counterpart of the networks: slopes for all drivers, one level a driver and output.
//!
//! With three outputs these levels are a three-number embedding, and the model is linear in it and in the windows.

use super::{Baseline, Said};
use crate::{
    rows::{Row, RowWeights},
    scaling::Standardization,
    windows::SIGNALS,
};

/// Ridge on the slopes, as a share of the number of rows; features are standardised.
const RIDGE: f64 = 1e-3;
/// Newton steps of the logistic fit.
const STEPS: usize = 25;

/// Signals of a window that an output reads.
const SPEED_READS: [usize; 3] = [1, 2, 3];
const CHANGE_READS: [usize; 3] = [0, 1, 2];

pub(super) struct LinearModel {
    features: Vec<Standardization>,
    speed: Slopes,
    distance: Slopes,
    change: Option<Logistic>,
    weights: RowWeights,
}

struct Slopes {
    slopes: Vec<f64>,
    /// Mean level of the drivers.
    level: Option<f64>,
}

struct Logistic {
    slopes: Vec<f64>,
    level: f64,
}

impl LinearModel {
    pub(super) fn of(of_each: &[Vec<Row>], weights: RowWeights) -> Self {
        let numbers = of_each
            .iter()
            .flatten()
            .next()
            .map_or(0, |r| r.window.len());
        let all = || of_each.iter().flatten();
        let features: Vec<Standardization> = (0..numbers)
            .map(|k| Standardization::of(all().map(move |r| r.window[k])))
            .collect();
        let reads = |row: &Row, signals: &[usize]| read(&features, row, signals);
        let speed = Slopes::of(of_each, |row| {
            row.on_grid
                .then(|| (reads(row, &SPEED_READS), row.ego_speed_mps))
        });
        let distance = Slopes::of(of_each, |row| {
            Some((vec![row.lead_speed_mps], row.following_distance_m?))
        });
        let change = (weights.changing > 0.0)
            .then(|| Logistic::of(of_each, weights, |row| reads(row, &CHANGE_READS)));
        Self {
            features,
            speed,
            distance,
            change,
            weights,
        }
    }
}

/// The standardised window of some signals.
fn read(features: &[Standardization], row: &Row, signals: &[usize]) -> Vec<f64> {
    let steps = row.window.len() / SIGNALS;
    signals
        .iter()
        .flat_map(|s| s * steps..(s + 1) * steps)
        .map(|k| features[k].apply(row.window[k]))
        .collect()
}

impl Baseline for LinearModel {
    fn say(&self, known: &[Row], unseen: &[Row]) -> Vec<Said> {
        let speed = |row: &Row| read(&self.features, row, &SPEED_READS);
        let change = |row: &Row| read(&self.features, row, &CHANGE_READS);
        let own_speed = self.speed.own_level(
            known
                .iter()
                .filter(|r| r.on_grid)
                .map(|r| (speed(r), r.ego_speed_mps)),
        );
        let own_distance = self.distance.own_level(
            known
                .iter()
                .filter_map(|r| Some((vec![r.lead_speed_mps], r.following_distance_m?))),
        );
        let own_change = self
            .change
            .as_ref()
            .map(|c| c.own_level(known, self.weights, change));
        let of_row = |row: &Row| Said {
            following_distance_m: own_distance
                .map(|level| level + dot(&self.distance.slopes, &[row.lead_speed_mps])),
            log_odds: self
                .change
                .as_ref()
                .zip(own_change)
                .map(|(c, level)| level + dot(&c.slopes, &change(row))),
            speed_mps: own_speed.map(|level| level + dot(&self.speed.slopes, &speed(row))),
        };
        unseen.iter().map(of_row).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Slopes {
    /// Least squares within drivers: every driver keeps a level of their own.
    fn of(of_each: &[Vec<Row>], pick: impl Fn(&Row) -> Option<(Vec<f64>, f64)>) -> Self {
        let mut normal = Normal::default();
        let mut groups = Vec::new();
        for rows in of_each {
            let pairs: Vec<(Vec<f64>, f64)> = rows.iter().filter_map(&pick).collect();
            let Some((first, _)) = pairs.first() else {
                continue;
            };
            let n = pairs.len() as f64;
            let mut x_mean = vec![0.0; first.len()];
            let mut y_mean = 0.0;
            for (x, y) in &pairs {
                x_mean.iter_mut().zip(x).for_each(|(m, x)| *m += x / n);
                y_mean += y / n;
            }
            for (x, y) in &pairs {
                let centred: Vec<f64> = x.iter().zip(&x_mean).map(|(x, m)| x - m).collect();
                normal.add(&centred, y - y_mean, 1.0);
            }
            groups.push((x_mean, y_mean));
        }
        let slopes = normal.solve(RIDGE * normal.rows);
        let levels: Vec<f64> = groups.iter().map(|(x, y)| y - dot(&slopes, x)).collect();
        let level = (!levels.is_empty()).then(|| levels.iter().sum::<f64>() / levels.len() as f64);
        Self { slopes, level }
    }

    /// The level at which the driver's rows lie; the others' mean without rows.
    fn own_level(&self, pairs: impl Iterator<Item = (Vec<f64>, f64)>) -> Option<f64> {
        let (n, sum) = pairs.fold((0.0, 0.0), |(n, sum), (x, y)| {
            (n + 1.0, sum + y - dot(&self.slopes, &x))
        });
        if n > 0.0 { Some(sum / n) } else { self.level }
    }
}

impl Logistic {
    /// Newton's method on the weighted log-likelihood; drivers' levels have a normal prior of SD 1 about a common one.
    fn of(of_each: &[Vec<Row>], weights: RowWeights, reads: impl Fn(&Row) -> Vec<f64>) -> Self {
        let mut rows = Vec::new();
        for (driver, of_driver) in of_each.iter().enumerate() {
            for row in of_driver {
                if let Some(change) = row.lane_change {
                    rows.push((driver, reads(row), change, weights.of_row(row)[1]));
                }
            }
        }
        let p = rows.first().map_or(0, |(_, x, ..)| x.len());
        // Slopes, then the common level, then each driver's distance from it.
        let size = p + 1 + of_each.len();
        let ridge = RIDGE * rows.len() as f64;
        let penalty = |k: usize| match k {
            k if k < p => ridge,
            k if k == p => 0.0,
            _ => 1.0,
        };
        let mut at = vec![0.0; size];
        for _ in 0..STEPS {
            let mut hessian = vec![0.0; size * size];
            let mut gradient = vec![0.0; size];
            for (driver, x, change, weight) in &rows {
                let own = p + 1 + driver;
                let odds = dot(&at[..p], x) + at[p] + at[own];
                let chance = 1.0 / (1.0 + (-odds).exp());
                let slope = weight * (f64::from(u8::from(*change)) - chance);
                let curve = weight * chance * (1.0 - chance);
                for (i, xi) in x.iter().enumerate() {
                    gradient[i] += slope * xi;
                    let line = &mut hessian[i * size..(i + 1) * size];
                    for (h, xj) in line.iter_mut().zip(x).take(i + 1) {
                        *h += curve * xi * xj;
                    }
                }
                for k in [p, own] {
                    gradient[k] += slope;
                    let line = &mut hessian[k * size..(k + 1) * size];
                    for (h, xj) in line.iter_mut().zip(x) {
                        *h += curve * xj;
                    }
                    line[k] += curve;
                }
                hessian[own * size + p] += curve;
            }
            for k in 0..size {
                hessian[k * size + k] += penalty(k) + 1e-9;
                gradient[k] -= penalty(k) * at[k];
            }
            let step = solve(hessian, gradient, size);
            at.iter_mut().zip(&step).for_each(|(a, s)| *a += s);
            if step.iter().all(|s| s.abs() < 1e-8) {
                break;
            }
        }
        Self {
            level: at.get(p).copied().unwrap_or(0.0),
            slopes: at[..p].to_vec(),
        }
    }

    /// The driver's own level, by the same prior.
    fn own_level(
        &self,
        known: &[Row],
        weights: RowWeights,
        reads: impl Fn(&Row) -> Vec<f64>,
    ) -> f64 {
        let rows: Vec<(f64, f64, f64)> = known
            .iter()
            .filter_map(|row| {
                let change = f64::from(u8::from(row.lane_change?));
                Some((
                    dot(&self.slopes, &reads(row)) + self.level,
                    change,
                    weights.of_row(row)[1],
                ))
            })
            .collect();
        let mut own = 0.0;
        for _ in 0..STEPS {
            let (mut gradient, mut curve) = (-own, 1.0);
            for (odds, change, weight) in &rows {
                let chance = 1.0 / (1.0 + (-(odds + own)).exp());
                gradient += weight * (change - chance);
                curve += weight * chance * (1.0 - chance);
            }
            own += gradient / curve;
        }
        self.level + own
    }
}

/// Normal equations, lower half.
#[derive(Default)]
struct Normal {
    matrix: Vec<f64>,
    right: Vec<f64>,
    rows: f64,
}

impl Normal {
    fn add(&mut self, x: &[f64], y: f64, weight: f64) {
        let p = x.len();
        self.matrix.resize(p * p, 0.0);
        self.right.resize(p, 0.0);
        self.rows += 1.0;
        for (i, xi) in x.iter().enumerate() {
            self.right[i] += weight * xi * y;
            let line = &mut self.matrix[i * p..(i + 1) * p];
            for (m, xj) in line.iter_mut().zip(x).take(i + 1) {
                *m += weight * xi * xj;
            }
        }
    }

    fn solve(&self, ridge: f64) -> Vec<f64> {
        let p = self.right.len();
        let mut matrix = self.matrix.clone();
        for k in 0..p {
            matrix[k * p + k] += ridge + 1e-9;
        }
        solve(matrix, self.right.clone(), p)
    }
}

/// Solves a symmetric positive definite system, of which the lower half is given, by Cholesky's method.
fn solve(mut a: Vec<f64>, mut b: Vec<f64>, n: usize) -> Vec<f64> {
    for i in 0..n {
        for j in 0..=i {
            let before: f64 = (0..j).map(|k| a[i * n + k] * a[j * n + k]).sum();
            let rest = a[i * n + j] - before;
            a[i * n + j] = if i == j {
                rest.max(1e-12).sqrt()
            } else {
                rest / a[j * n + j]
            };
        }
    }
    for i in 0..n {
        let before: f64 = (0..i).map(|k| a[i * n + k] * b[k]).sum();
        b[i] = (b[i] - before) / a[i * n + i];
    }
    for i in (0..n).rev() {
        let after: f64 = (i + 1..n).map(|k| a[k * n + i] * b[k]).sum();
        b[i] = (b[i] - after) / a[i * n + i];
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_is_solved() {
        let lower = vec![4.0, 0.0, 0.0, 2.0, 5.0, 0.0, 1.0, 3.0, 6.0];
        let x = solve(lower, vec![11.0, 21.0, 25.0], 3);
        for (found, expected) in x.iter().zip([1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-9, "{x:?}");
        }
    }
}

//! How well a drive determines an embedding: its standard error, from the curvature and from blocks of time.

use super::objective::Close;
use crate::linear_algebra::{dot, of_symmetric, symmetric_eigen, times};

/// Curvatures below this share of the largest count as none: the drive says nothing in that direction.
const LEAST_CURVATURE: f64 = 1e-6;
/// Fewer blocks than this do not show how much they scatter.
const FEWEST_BLOCKS: usize = 6;

/// How far the embedding might lie elsewhere had the driver driven another stretch of the same kind.
///
/// `w` minimises a mean over rows, so its covariance is the sandwich `H⁻¹ V H⁻¹`: H the objective's curvature at the
/// minimum (Gauss's and Newton's: differences of the gradient over a kink of the ReLUs, where a minimum
/// often lies, curve too much), V the covariance of its gradient. Rows follow each other by a second and hang together over many, so V is not taken over
/// rows: gradients are first summed over contiguous blocks of time ([`crate::PersonalizeSettings::block_s`]), several
/// times as long as one episode of following or passing, and V is taken over blocks, times `B/(B − d)`, since d numbers were fitted to them. What is measured is
/// the scatter around what *this objective* would find on endless driving, so a bias of the objective, such as L5's pull, is
/// no part of it; nor is a style that differs from day to day. An ADB score that was fitted counts as known exactly.
///
/// # Source
/// Huber 1967 and White 1982 for the sandwich; Liang and Zeger 1986 for sums over clusters; Carlstein 1986 for
/// contiguous blocks as clusters of a time series. Newey and West 1987 weigh lags instead, to the same end.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Uncertainty {
    /// Standard error of each coordinate, shape `(d,)`.
    pub standard_error: Vec<f64>,
    /// Covariance of the embedding, shape `(d, d)`, row by row.
    pub covariance: Vec<f64>,
    /// Blocks of time, B.
    pub blocks: usize,
    /// Independent rows that would say as much as these rows do; at most their number.
    pub effective_rows: f64,
}

impl Uncertainty {
    /// Standard error along a direction, such as that of aggression: `√(uᵀ Σ u)` with `u` the unit vector.
    ///
    /// `direction` has shape `(d,)` and need not be of unit length; a zero direction has standard error 0.
    pub fn along(&self, direction: &[f64]) -> f64 {
        let length = dot(direction, direction);
        if length > 0.0 {
            (dot(direction, &times(&self.covariance, direction)) / length)
                .max(0.0)
                .sqrt()
        } else {
            0.0
        }
    }

    /// From the objective looked at closely at its minimum, or why there is none.
    pub(super) fn of(close: &Close) -> Result<Self, &'static str> {
        let d = close.embedding_size;
        let (gradients, squares) = (&close.block_gradients, &close.squares);
        let blocks = gradients.len();
        if blocks < FEWEST_BLOCKS.max(d + 2) {
            return Err("too few blocks of time; drive longer");
        }
        let (values, vectors) = symmetric_eigen(&close.curvature, d);
        let least = values[0].max(0.0) * LEAST_CURVATURE;
        if values.iter().any(|&v| v <= least) {
            return Err("the drive says nothing in some direction of style space");
        }
        let inverse = of_symmetric(&values, &vectors, |v| 1.0 / v);

        let b = blocks as f64;
        let mean: Vec<f64> = (0..d)
            .map(|i| gradients.iter().map(|g| g[i]).sum::<f64>() / b)
            .collect();
        let centred = |i: usize, j: usize| -> f64 {
            gradients
                .iter()
                .map(|g| (g[i] - mean[i]) * (g[j] - mean[j]))
                .sum()
        };
        let mut meat = vec![0.0; d * d];
        for i in 0..d {
            for j in 0..d {
                meat[i * d + j] = centred(i, j) * b / (b - d as f64);
            }
        }
        let covariance = product(&inverse, &product(&meat, &inverse, d), d);

        // As if rows were independent, for the number of rows that they are worth.
        let rows = close.grid_rows;
        let alone: f64 = (0..d)
            .map(|i| squares[i * d + i] - (b * mean[i]).powi(2) / rows)
            .sum();
        let together: f64 = (0..d).map(|i| meat[i * d + i]).sum();
        let effective_rows = if together > 0.0 {
            (rows * alone / together).min(rows)
        } else {
            rows
        };
        Ok(Self {
            standard_error: (0..d)
                .map(|i| covariance[i * d + i].max(0.0).sqrt())
                .collect(),
            covariance,
            blocks,
            effective_rows,
        })
    }
}

/// Product of two `(n, n)` matrices.
fn product(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
    let mut c = vec![0.0; n * n];
    for i in 0..n {
        for k in 0..n {
            for j in 0..n {
                c[i * n + j] += a[i * n + k] * b[k * n + j];
            }
        }
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        params::{PersonalizeParams, PersonalizeSettings},
        personalize::{
            Personalizer,
            reference::{Problem, Reference},
        },
        rows::{Row, rows_of},
        test_drives::{Habits, drive},
    };
    use maveric_domain::DriveId;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Mcg;

    /// Correlation of the noise from one second to the next.
    const HANGING_TOGETHER: f64 = 0.8;

    /// A driver who does what the model says of one embedding, and noise that hangs together over seconds.
    struct MadeUp {
        problem: Problem,
        rows: Vec<Row>,
        true_to_style: Vec<[f64; 2]>,
    }

    impl MadeUp {
        fn new() -> Self {
            // Where lanes are changed is not drawn anew, so it must not count; nor must L5, which no driver obeys.
            let problem = Problem::new("speed and distance", false, |s| {
                s.loss_weights.lane_change = 0.0;
                s.loss_weights.mutual_information = 0.0;
            });
            let habits = Habits {
                speed_mps: 30.0,
                time_gap_s: 1.6,
                passes: true,
            };
            let drive = drive("long", &habits, 600.0);
            let rows = rows_of(&drive, &problem.model.row_settings(), 1.0).unwrap();
            let w = problem.model.training()[0].embedding.coordinates().to_vec();
            let reference = Reference::new(&problem.model, &rows, None);
            let true_to_style = rows.iter().map(|r| reference.distance_and_speed(&w, r));
            Self {
                true_to_style: true_to_style.collect(),
                problem,
                rows,
            }
        }

        fn driven(&self, seed: u64) -> Vec<Row> {
            let mut rng = Pcg64Mcg::seed_from_u64(seed);
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let fresh = (1.0 - HANGING_TOGETHER * HANGING_TOGETHER).sqrt();
            let mut noise = [normal(), normal()];
            let mut rows = self.rows.clone();
            for (row, &[distance, speed]) in rows.iter_mut().zip(&self.true_to_style) {
                if row.on_grid {
                    noise = noise.map(|n| HANGING_TOGETHER * n + fresh * normal());
                }
                row.following_distance_m =
                    row.following_distance_m.map(|_| distance + 4.0 * noise[0]);
                row.ego_speed_mps = speed + 1.5 * noise[1];
            }
            rows
        }

        fn fit(&self, rows: &[Row]) -> (Vec<f64>, Option<Uncertainty>) {
            let settings = PersonalizeSettings {
                starts: 1,
                ..PersonalizeSettings::default()
            };
            let params = PersonalizeParams::new(settings).unwrap();
            let id = DriveId::new("made-up").unwrap();
            let personalizer = Personalizer::new(&self.problem.model, params);
            let found = personalizer.fit_rows(&id, rows, None, 1).unwrap();
            (found.embedding.coordinates().to_vec(), found.uncertainty)
        }
    }

    fn mean(values: impl Iterator<Item = f64>) -> f64 {
        let values: Vec<f64> = values.collect();
        values.iter().sum::<f64>() / values.len() as f64
    }

    #[test]
    fn the_standard_error_is_the_scatter_over_repeated_drives() {
        let driver = MadeUp::new();
        let repeats: Vec<(Vec<f64>, Uncertainty)> = (0..30)
            .map(|seed| {
                let (w, uncertainty) = driver.fit(&driver.driven(seed));
                (w, uncertainty.unwrap())
            })
            .collect();
        for i in 0..3 {
            let centre = mean(repeats.iter().map(|(w, _)| w[i]));
            let scatter = mean(repeats.iter().map(|(w, _)| (w[i] - centre).powi(2))).sqrt();
            let said = mean(repeats.iter().map(|(_, u)| u.standard_error[i].powi(2))).sqrt();
            assert!(
                (0.5..2.0).contains(&(said / scatter)),
                "{i}: {said} said, {scatter} seen"
            );
            // An interval of two standard errors holds the centre about as often as it says (95%).
            let held = repeats
                .iter()
                .filter(|(w, u)| (w[i] - centre).abs() < 2.0 * u.standard_error[i])
                .count();
            assert!(held >= 20, "{i}: {held} of 30, {said} said, {scatter} seen");
        }
        // Noise with correlation .8 a second is worth about (1 - .8)/(1 + .8) of its rows.
        let rows = driver.rows.iter().filter(|r| r.on_grid).count() as f64;
        let worth = mean(repeats.iter().map(|(_, u)| u.effective_rows)) / rows;
        assert!((0.04..0.5).contains(&worth), "{worth}");
    }

    #[test]
    fn half_the_driving_scatters_as_two_halves_differ() {
        let driver = MadeUp::new();
        let half = driver.rows.len() / 2;
        let mut squares = Vec::new();
        for seed in 100..120 {
            let rows = driver.driven(seed);
            let (a, of_a) = driver.fit(&rows[..half]);
            let (b, of_b) = driver.fit(&rows[half..]);
            let (of_a, of_b) = (of_a.unwrap(), of_b.unwrap());
            for i in 0..3 {
                let expected = of_a.standard_error[i].powi(2) + of_b.standard_error[i].powi(2);
                squares.push((a[i] - b[i]).powi(2) / expected);
            }
        }
        let ratio = mean(squares.into_iter()).sqrt();
        assert!((0.5..2.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn along_an_axis_it_is_that_axis_own() {
        let uncertainty = Uncertainty {
            standard_error: vec![2.0, 1.0],
            covariance: vec![4.0, 1.0, 1.0, 1.0],
            blocks: 10,
            effective_rows: 50.0,
        };
        assert!((uncertainty.along(&[3.0, 0.0]) - 2.0).abs() < 1e-12);
        assert!((uncertainty.along(&[1.0, -1.0]) - 1.5_f64.sqrt()).abs() < 1e-12);
        assert!(uncertainty.along(&[0.0, 0.0]).abs() < 1e-12);
    }
}

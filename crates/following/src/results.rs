//! What an evaluation gives: tables and series, ready for a file.

use crate::{method::FollowingMethod, run::each_once, simulation_errors::SimulationErrors};
use maveric_laws::Idm;
use serde::{Deserialize, Serialize};

/// One method on one driver's test rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MethodErrors {
    /// What drove in ego's place.
    pub method: FollowingMethod,
    /// IDM with its fitted numbers.
    pub law: Idm,
    /// The error that the fit minimised: RMSE of the gap in closed loop over the rows that it was fitted to, in m.
    pub fit_gap_rmse_m: f64,
    /// How far it came from the recording.
    #[serde(flatten)]
    pub errors: SimulationErrors,
}

/// One method over all drives, every drive the same weight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MethodMean {
    /// The method that drove in place of every driver.
    pub method: FollowingMethod,
    /// Mean RMSE of the gap, in m.
    pub gap_rmse_m: f64,
    /// Median over drivers of the RMSE of the gap, in m: a few drivers carry the mean.
    pub gap_rmse_median_m: f64,
    /// Mean RMSE of the speed, in m/s.
    pub speed_rmse_mps: f64,
    /// Mean RMSE of the gap over the root mean square gap.
    pub nrmse: f64,
    /// Mean of the mixed error.
    pub mixed: f64,
    /// In how many drives the simulated gap reached 0.
    pub reached_zero: usize,
    pub drivers: usize,
}

/// Two methods person by person: the RMSE of the gap under one less that under the other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Compared {
    /// The method whose error the difference is taken of.
    pub method: FollowingMethod,
    /// The method whose error is subtracted.
    pub beside: FollowingMethod,
    /// Mean difference, in m; below 0 where `method` is nearer.
    pub mean_m: f64,
    /// Lower end of its 95 % interval, people drawn with replacement; `None` with too few of them.
    pub low_m: Option<f64>,
    pub high_m: Option<f64>,
    pub median_m: f64,
    /// For how many people `method` is nearer.
    pub better: usize,
    /// For how many it is further off.
    pub worse: usize,
}

/// Gap and speed under one method at the times of a [`TestSeries`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodSeries {
    /// What drove in ego's place.
    pub method: FollowingMethod,
    /// Simulated gap, in m, 0 where the leader was reached; shape `(k,)`.
    pub gap_m: Vec<f64>,
    /// Simulated speed, in m/s; shape `(k,)`.
    pub speed_mps: Vec<f64>,
}

/// The test rows once a second, to draw; every column has shape `(k,)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestSeries {
    /// Time, in s, as in the run.
    pub time_s: Vec<f64>,
    pub gap_m: Vec<f64>,
    /// Recorded speed of ego, in m/s.
    pub ego_speed_mps: Vec<f64>,
    /// Recorded speed of the leader, in m/s.
    pub lead_speed_mps: Vec<f64>,
    /// What each method made of it.
    pub simulated: Vec<MethodSeries>,
}

/// Every method on one driver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriverEvaluation {
    /// Name of the driver, or of the drive.
    pub driver: String,
    /// Who drove, where that is not the name of the driver.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub person: Option<String>,
    /// One entry per method, in the order of [`FollowingMethod::ALL`].
    pub methods: Vec<MethodErrors>,
    /// The test rows, to draw.
    pub series: TestSeries,
}

/// Every method on every driver's test rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FollowingEvaluation {
    /// How many people were learned from.
    pub learned_from: usize,
    /// What is driven by default: [`FollowingMethod::DRIVEN_BY_DEFAULT`].
    pub driven: FollowingMethod,
    /// One entry a run, in their order.
    pub drivers: Vec<DriverEvaluation>,
    /// One entry per method, in the order of [`FollowingMethod::ALL`].
    pub means: Vec<MethodMean>,
    /// Pairs of methods person by person; empty unless somebody compared them.
    pub compared: Vec<Compared>,
}

impl FollowingEvaluation {
    /// The mean over drivers of one method, if it was tried.
    pub fn mean(&self, method: FollowingMethod) -> Option<&MethodMean> {
        self.means.iter().find(|m| m.method == method)
    }

    /// Whether the mean gap error of a method is the least of all.
    pub fn is_best(&self, method: FollowingMethod) -> bool {
        let means = self.means.iter();
        let best = means.min_by(|a, b| a.gap_rmse_m.total_cmp(&b.gap_rmse_m));
        best.is_some_and(|best| best.method == method)
    }

    pub fn people(&self) -> usize {
        each_once(self.drivers.iter().map(DriverEvaluation::person)).len()
    }

    /// The RMSE of the gap under `method` less that under `beside`, in m, a person: the mean over the drives of one who has several;
    /// empty unless both were tried.
    pub fn differences_m(&self, method: FollowingMethod, beside: FollowingMethod) -> Vec<f64> {
        let mut of_people: Vec<(&str, Vec<f64>)> = Vec::new();
        for drive in &self.drivers {
            let errors = drive.gap_rmse_m(method).zip(drive.gap_rmse_m(beside));
            let Some(difference) = errors.map(|(one, other)| one - other) else {
                continue;
            };
            match of_people.iter_mut().find(|(p, _)| *p == drive.person()) {
                Some((_, differences)) => differences.push(difference),
                None => of_people.push((drive.person(), vec![difference])),
            }
        }
        let of_people = of_people.iter();
        let mean = of_people.map(|(_, d)| d.iter().sum::<f64>() / d.len() as f64);
        mean.collect()
    }
}

impl DriverEvaluation {
    pub fn person(&self) -> &str {
        self.person.as_deref().unwrap_or(&self.driver)
    }

    /// The gap's RMSE under a method, in m, if it was tried.
    pub fn gap_rmse_m(&self, method: FollowingMethod) -> Option<f64> {
        let tried = self.methods.iter().find(|m| m.method == method);
        tried.map(|m| m.errors.gap_rmse_m)
    }
}

impl MethodMean {
    /// Over the drivers on whom `method` was tried; `None` without one.
    pub(crate) fn over(method: FollowingMethod, drivers: &[DriverEvaluation]) -> Option<Self> {
        let errors: Vec<SimulationErrors> = drivers
            .iter()
            .flat_map(|d| &d.methods)
            .filter(|m| m.method == method)
            .map(|m| m.errors)
            .collect();
        if errors.is_empty() {
            return None;
        }
        let mean = |error: fn(&SimulationErrors) -> f64| {
            errors.iter().map(error).sum::<f64>() / errors.len() as f64
        };
        let gaps: Vec<f64> = errors.iter().map(|e| e.gap_rmse_m).collect();
        Some(Self {
            method,
            gap_rmse_m: mean(|e| e.gap_rmse_m),
            gap_rmse_median_m: median(&gaps),
            speed_rmse_mps: mean(|e| e.speed_rmse_mps),
            nrmse: mean(|e| e.nrmse),
            mixed: mean(|e| e.mixed),
            reached_zero: errors.iter().filter(|e| e.reached_zero).count(),
            drivers: errors.len(),
        })
    }
}

/// The middle of some numbers, or the mean of both in the middle; 0 without any.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    match n {
        0 => 0.0,
        _ if n % 2 == 1 => sorted[n / 2],
        _ => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;
    use FollowingMethod as M;

    fn errors(gap_rmse_m: f64, reached_zero: bool) -> SimulationErrors {
        SimulationErrors {
            gap_rmse_m,
            speed_rmse_mps: 0.5 * gap_rmse_m,
            nrmse: 0.1 * gap_rmse_m,
            mixed: 0.2 * gap_rmse_m,
            reached_zero,
        }
    }

    fn driver(name: &str, methods: &[(M, f64, bool)]) -> DriverEvaluation {
        let one = |&(method, gap, zero): &(M, f64, bool)| MethodErrors {
            method,
            law: testing::DRIVER,
            fit_gap_rmse_m: gap,
            errors: errors(gap, zero),
        };
        DriverEvaluation {
            driver: name.to_owned(),
            person: None,
            methods: methods.iter().map(one).collect(),
            series: TestSeries {
                time_s: Vec::new(),
                gap_m: Vec::new(),
                ego_speed_mps: Vec::new(),
                lead_speed_mps: Vec::new(),
                simulated: Vec::new(),
            },
        }
    }

    fn evaluation() -> FollowingEvaluation {
        let drivers = vec![
            driver(
                "A",
                &[
                    (M::IdmPopulation, 2.5, false),
                    (M::IdmPopulationOwnTimeGap, 3.0, false),
                    (M::IdmOwn, 2.0, false),
                ],
            ),
            driver(
                "B",
                &[
                    (M::IdmPopulation, 4.0, false),
                    (M::IdmPopulationOwnTimeGap, 3.0, false),
                    (M::IdmOwn, 4.0, true),
                ],
            ),
            driver("C", &[(M::IdmPopulation, 3.0, false), (M::IdmOwn, 12.0, true)]),
        ];
        FollowingEvaluation {
            learned_from: 3,
            driven: M::DRIVEN_BY_DEFAULT,
            means: M::ALL.iter().filter_map(|m| MethodMean::over(*m, &drivers)).collect(),
            drivers,
            compared: Vec::new(),
        }
    }

    #[test]
    fn a_mean_is_over_the_drivers_on_whom_the_method_was_tried() {
        let found = evaluation();
        let mean = found.mean(M::IdmOwn).unwrap();
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} instead of {b}");
        near(mean.gap_rmse_m, 6.0);
        near(mean.gap_rmse_median_m, 4.0);
        near(mean.speed_rmse_mps, 3.0);
        near(mean.nrmse, 0.6);
        near(mean.mixed, 1.2);
        assert_eq!((mean.reached_zero, mean.drivers), (2, 3));
        let time_gap = found.mean(M::IdmPopulationOwnTimeGap).unwrap();
        near(time_gap.gap_rmse_m, 3.0);
        assert_eq!((time_gap.reached_zero, time_gap.drivers), (0, 2));
        assert_eq!(MethodMean::over(M::IdmOwn, &[]), None);
    }

    #[test]
    fn is_best_is_the_method_with_the_least_mean() {
        let mut found = evaluation();
        // 3.0 m, and 9.5 / 3 m and 6.0 m.
        assert!(found.is_best(M::IdmPopulationOwnTimeGap));
        assert!(!found.is_best(M::IdmPopulation) && !found.is_best(M::IdmOwn));
        found.means.remove(1);
        assert!(found.is_best(M::IdmPopulation));
        assert!(!found.is_best(M::IdmPopulationOwnTimeGap));
    }

    #[test]
    fn differences_are_driver_by_driver_where_both_were_tried() {
        let found = evaluation();
        let time_gap = M::IdmPopulationOwnTimeGap;
        assert_eq!(found.differences_m(M::IdmOwn, time_gap), [-1.0, 1.0]);
        assert_eq!(found.differences_m(time_gap, M::IdmOwn), [1.0, -1.0]);
    }

    #[test]
    fn a_person_with_several_drives_counts_once_by_their_mean() {
        let mut found = evaluation();
        assert_eq!(found.people(), 3);
        found.drivers[1].person = Some("A".to_owned());
        assert_eq!(found.people(), 2);
        let time_gap = M::IdmPopulationOwnTimeGap;
        assert_eq!(found.differences_m(M::IdmOwn, time_gap), [0.0]);
        assert_eq!(found.differences_m(M::IdmOwn, M::IdmPopulation), [-0.25, 9.0]);
    }

    #[test]
    fn a_median_is_the_middle_or_the_mean_of_both() {
        for (values, expected) in [
            (&[][..], 0.0),
            (&[3.0], 3.0),
            (&[5.0, 1.0], 3.0),
            (&[9.0, 1.0, 4.0], 4.0),
            (&[9.0, 1.0, 4.0, 6.0], 5.0),
        ] {
            assert!((median(values) - expected).abs() < 1e-12, "{values:?}");
        }
    }
}

//! Every method on every driver's test rows.

use crate::{
    closed_loop::{ClosedLoop, simulate},
    closed_loop_network::{TrainedFor, study},
    error::{FollowingError, enough_drivers},
    keep_distance::KeepDistance,
    law::{Law, TIME_GAP_GAINS},
    method::FollowingMethod as M,
    peers::{self, Peers},
    results::{
        DriverEvaluation, FollowingEvaluation, MethodErrors, MethodMean, MethodSeries, TestSeries,
    },
    run::{FollowingRun, Stretch},
    settings::FollowingSettings,
    simulation_errors::SimulationErrors,
};

/// F of one driver: following distance (m) from the leader's speed (m/s).
pub type DistanceLaw<'a> = Box<dyn Fn(f64) -> f64 + 'a>;

/// F of each driver, in the order of the runs.
pub struct Distances<'a> {
    /// With the driver's own embedding.
    pub own: Vec<DistanceLaw<'a>>,
    /// With the mean embedding of the training drivers.
    pub mean: Vec<DistanceLaw<'a>>,
}

/// Tries the laws, the network in closed loop and F, where it is given, on the test rows of `judged`.
///
/// What is known of people before a driver is met are the fit rows of `learned`, without any drive of the same person: give the same
/// runs twice, and each is judged beside the others; or two groups of people. The network learns from all of `learned`. The
/// comparisons of the result are left empty.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] below two people to learn from; [`FollowingError::TooShort`] below nine rows; [`FollowingError::LawCount`] if there is not one F a
/// driver; [`FollowingError::LawNotFinite`] if an F is NaN or infinite where it is asked; [`FollowingError::NeverMoves`] for a
/// driver without a time gap; [`FollowingError::RatesDiffer`]; [`FollowingError::BadSetting`].
///
/// # Source
/// Method section 5 for the steering by F and its safety constraint; the protocol is that of the closed-loop
/// calibration of car-following models (Kesting and Treiber 2008): only the leader is recorded.
pub fn evaluate(
    judged: &[FollowingRun],
    learned: &[FollowingRun],
    f: Option<&Distances<'_>>,
    settings: &FollowingSettings,
) -> Result<FollowingEvaluation, FollowingError> {
    settings.check()?;
    let people = peers::people(learned).len();
    enough_drivers(people, 2)?;
    for run in judged.iter().chain(learned) {
        run.long_enough()?;
    }
    for (what, laws) in f.iter().flat_map(|f| [("own", &f.own), ("mean", &f.mean)]) {
        if laws.len() != judged.len() {
            return Err(FollowingError::LawCount {
                what,
                found: laws.len(),
                expected: judged.len(),
            });
        }
    }
    let (mut laws, time_gap_shrinkage) = peers::idm(judged, learned, settings)?;
    peers::add_the_rest(&mut laws, judged, learned, settings)?;
    let closed_loop = (settings.closed_loop_seeds > 0)
        .then(|| study(judged, learned, settings))
        .transpose()?;
    let networks = closed_loop.as_ref().map_or(&[][..], |c| &c.trained);
    let drivers = drive(judged, &laws, networks, f, settings)?;
    Ok(FollowingEvaluation {
        learned_from: people,
        driven: M::DRIVEN_BY_DEFAULT,
        means: means(&drivers),
        drivers,
        compared: Vec::new(),
        peers: laws,
        time_gap_shrinkage,
        closed_loop,
    })
}

fn means(drivers: &[DriverEvaluation]) -> Vec<MethodMean> {
    M::all()
        .filter_map(|m| MethodMean::over(m, drivers))
        .collect()
}

pub(crate) fn drive(
    judged: &[FollowingRun],
    laws: &[Peers],
    networks: &[TrainedFor],
    f: Option<&Distances<'_>>,
    settings: &FollowingSettings,
) -> Result<Vec<DriverEvaluation>, FollowingError> {
    judged
        .iter()
        .zip(laws)
        .enumerate()
        .map(|(index, (run, laws))| {
            let test = run.test();
            let mut methods = Vec::new();
            let mut series = recorded_series(run);
            for method in M::all() {
                let driver = Driver {
                    test: &test,
                    laws,
                    networks,
                    index,
                    f: f.map(|f| (&f.own[index], &f.mean[index])),
                    settings,
                };
                let Some(simulated) = driver.drive(method)? else {
                    continue;
                };
                methods.push(MethodErrors {
                    method,
                    errors: SimulationErrors::between(&test, &simulated),
                });
                let gap_m = each_second(run, &simulated.gap_m);
                series.simulated.push(MethodSeries {
                    method,
                    gap_m: gap_m.into_iter().map(|gap| gap.max(0.0)).collect(),
                    speed_mps: each_second(run, &simulated.speed_mps),
                });
            }
            Ok(DriverEvaluation {
                driver: run.driver().to_owned(),
                person: (run.person() != run.driver()).then(|| run.person().to_owned()),
                methods,
                series,
            })
        })
        .collect()
}

/// Everything that may drive in one driver's place.
struct Driver<'a> {
    test: &'a Stretch<'a>,
    laws: &'a Peers,
    /// Networks that drive together, and which of their drivers this is.
    networks: &'a [TrainedFor],
    index: usize,
    f: Option<(&'a DistanceLaw<'a>, &'a DistanceLaw<'a>)>,
    settings: &'a FollowingSettings,
}

impl Driver<'_> {
    /// `None` for a method that was not fitted or given.
    fn drive(&self, method: M) -> Result<Option<ClosedLoop>, FollowingError> {
        let by = |law: &mut dyn FnMut(f64, f64, f64) -> f64| {
            simulate(self.test, method.as_str(), law).map(Some)
        };
        let network = |embedding: fn(&TrainedFor, usize) -> &[f64]| {
            let count = self.networks.len() as f64;
            let each = self.networks.iter();
            let mut each: Vec<_> = each
                .map(|trained| trained.network.driving(embedding(trained, self.index)))
                .collect();
            let mean_accel =
                move |g, v, lead| each.iter_mut().map(|law| law(g, v, lead)).sum::<f64>() / count;
            (!self.networks.is_empty()).then_some(mean_accel)
        };
        match method {
            M::ClosedLoopOwn => network(|t, index| &t.own[index]).map(|mut law| by(&mut law)),
            M::ClosedLoopShrunken => {
                network(|t, index| &t.shrunken[index]).map(|mut law| by(&mut law))
            }
            M::ClosedLoopMean => {
                network(|t, _| t.network.mean_embedding()).map(|mut law| by(&mut law))
            }
            M::ClosedLoopAndIdmShrunken => {
                let idm = self.laws.laws.get(&M::IdmPopulationShrunkenTimeGap);
                network(|t, index| &t.shrunken[index])
                    .zip(idm)
                    .map(|(mut learned, idm)| {
                        let mut idm = idm.law.driving(self.test);
                        by(&mut |g, v, lead| 0.5 * (learned(g, v, lead) + idm(g, v, lead)))
                    })
            }
            M::FollowingDistanceOwn => self.f.map(|(own, _)| by(&mut self.keeping(own))),
            M::FollowingDistanceMean => self.f.map(|(_, mean)| by(&mut self.keeping(mean))),
            fitted => self
                .laws
                .laws
                .get(&fitted)
                .map(|fitted| by(&mut fitted.law.driving(self.test))),
        }
        .transpose()
        .map(Option::flatten)
    }

    /// Steers to F with the gains of Helly's law of the others.
    fn keeping<'f>(&self, f: &'f DistanceLaw<'_>) -> impl FnMut(f64, f64, f64) -> f64 + 'f {
        let helly = self.laws.laws.get(&M::HellyPopulation);
        let gains = match helly.map(|fitted| fitted.law) {
            Some(Law::Helly(law)) => law.gains,
            _ => TIME_GAP_GAINS,
        };
        let law = KeepDistance {
            distance_m: f,
            gains,
            safety: self.settings.safety,
        };
        move |g, v, lead| law.accel_mps2(g, v, lead)
    }
}

fn recorded_series(run: &FollowingRun) -> TestSeries {
    let columns = run.columns();
    let test = |column: &[f64]| each_second(run, &column[run.test_start()..]);
    TestSeries {
        time_s: test(&columns.time_s),
        gap_m: test(&columns.gap_m),
        ego_speed_mps: test(&columns.ego_speed_mps),
        lead_speed_mps: test(&columns.lead_speed_mps),
        simulated: Vec::new(),
    }
}

fn each_second(run: &FollowingRun, column: &[f64]) -> Vec<f64> {
    let stride = (run.rate_hz().round() as usize).max(1);
    column.iter().step_by(stride).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ClosedLoopSettings, SearchSettings, testing};

    fn quick(closed_loop_seeds: usize) -> FollowingSettings {
        FollowingSettings {
            search: SearchSettings {
                members_per_parameter: 4,
                generations: 15,
                ..SearchSettings::default()
            },
            closed_loop_seeds,
            closed_loop: ClosedLoopSettings {
                iterations: 60,
                ..ClosedLoopSettings::default()
            },
            ..FollowingSettings::default()
        }
    }

    fn runs(time_gaps_s: &[f64]) -> Vec<FollowingRun> {
        let run =
            |t: &f64| testing::driven_by_idm(&format!("T{t}"), testing::DRIVER.with_time_gap_s(*t));
        time_gaps_s.iter().map(run).collect()
    }

    fn lines(slopes_s: &[f64]) -> Vec<DistanceLaw<'static>> {
        let line =
            |&slope: &f64| -> DistanceLaw<'static> { Box::new(move |lead| 3.0 + slope * lead) };
        slopes_s.iter().map(line).collect()
    }

    fn gap(evaluation: &FollowingEvaluation, method: M) -> f64 {
        evaluation.mean(method).unwrap().gap_rmse_m
    }

    #[test]
    fn what_is_known_of_the_driver_orders_the_methods() {
        let runs = runs(&[1.0, 1.5, 2.2]);
        let f = Distances {
            own: lines(&[1.1, 1.6, 2.3]),
            mean: lines(&[1.65; 3]),
        };
        let found = evaluate(&runs, &runs, Some(&f), &quick(0)).unwrap();
        let rmse = |method| gap(&found, method);
        let population = rmse(M::IdmPopulation);
        assert!(rmse(M::IdmOwn) < population);
        assert!(rmse(M::IdmPopulationOwnTimeGap) < population);
        assert!(rmse(M::FollowingDistanceOwn) < rmse(M::FollowingDistanceMean));
        assert!(found.mean(M::ClosedLoopOwn).is_none());
        let of = |d: &DriverEvaluation| d.gap_rmse_m(M::IdmPopulation);
        let mut gaps: Vec<f64> = found.drivers.iter().filter_map(of).collect();
        gaps.sort_by(f64::total_cmp);
        let median = found.mean(M::IdmPopulation).unwrap().gap_rmse_median_m;
        assert!((median - gaps[1]).abs() < 1e-12, "{gaps:?}");
        let differences = found.differences_m(M::IdmOwn, M::IdmPopulation);
        let harmed = differences.iter().filter(|d| **d >= 0.0).count();
        assert_eq!(found.harmed(M::IdmOwn, M::IdmPopulation).len(), harmed);
    }

    #[test]
    fn people_can_be_judged_by_what_was_learned_from_others() {
        let (judged, learned) = (runs(&[2.8]), runs(&[1.0, 1.5, 2.2]));
        let found = evaluate(&judged, &learned, None, &quick(1)).unwrap();
        assert_eq!((found.drivers.len(), found.learned_from), (1, 3));
        assert!(gap(&found, M::ClosedLoopShrunken) < gap(&found, M::ClosedLoopMean));
        assert_eq!(found.time_gap_shrinkage.people, 3);
    }

    #[test]
    fn the_others_are_other_people_and_not_further_drives_of_the_same_one() {
        let mut runs = runs(&[1.0, 2.6, 1.5, 2.0]);
        let of_others = |judged: &[FollowingRun], learned: &[FollowingRun]| {
            let found = evaluate(judged, learned, None, &quick(0)).unwrap();
            let law = found.peers[0].laws[&M::ConstantTimeGapPopulation].law;
            (law, found.people(), found.learned_from)
        };
        let (expected, ..) = of_others(&runs[..1], &runs[2..]);
        let (four_people, ..) = of_others(&runs, &runs);
        assert_ne!(four_people, expected);
        runs[1] = runs[1].clone().of_person("T1");
        assert_eq!(of_others(&runs, &runs), (expected, 3, 3));
        let one = evaluate(&runs[..2], &runs[..2], None, &quick(0));
        assert!(matches!(one, Err(FollowingError::TooFewDrivers { .. })));
    }

    #[test]
    fn series_are_once_a_second_and_never_below_zero() {
        let runs = runs(&[1.0, 1.5, 2.2]);
        let nothing_kept = Distances {
            own: lines(&[-9.0; 3]),
            mean: lines(&[-9.0; 3]),
        };
        let found = evaluate(&runs, &runs, Some(&nothing_kept), &quick(0)).unwrap();
        for driver in &found.drivers {
            let series = &driver.series;
            assert_eq!(series.time_s.len(), 50);
            assert!((series.time_s[1] - series.time_s[0] - 1.0).abs() < 1e-9);
            // The network's four rows are not entered.
            assert_eq!(series.simulated.len(), M::all().count() - 4);
            for method in &series.simulated {
                assert_eq!((method.gap_m.len(), method.speed_mps.len()), (50, 50));
                assert!(method.gap_m.iter().all(|&gap| gap >= 0.0));
            }
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes_and_they_survive_a_file() {
        let runs = runs(&[1.0, 1.5, 2.2]);
        let first = evaluate(&runs, &runs, None, &quick(1)).unwrap();
        assert_eq!(first, evaluate(&runs, &runs, None, &quick(1)).unwrap());
        let text = serde_json::to_string(&first).unwrap();
        assert_eq!(first, serde_json::from_str(&text).unwrap());
    }

    #[test]
    fn the_test_rows_move_nothing_but_the_floor() {
        let mut runs = runs(&[1.0, 1.5, 2.2]);
        let before = evaluate(&runs, &runs, None, &quick(1)).unwrap();
        for run in &mut runs {
            let mut columns = run.columns().clone();
            columns.gap_m[run.test_start()..].fill(50.0);
            *run = FollowingRun::new(run.driver(), run.rate_hz(), columns).unwrap();
        }
        let after = evaluate(&runs, &runs, None, &quick(1)).unwrap();
        let networks = [&before, &after].map(|e| e.closed_loop.as_ref().unwrap().trained.clone());
        assert_eq!(networks[0], networks[1]);
        assert_eq!(before.time_gap_shrinkage, after.time_gap_shrinkage);
        for (mut a, mut b) in before.peers.into_iter().zip(after.peers) {
            assert_ne!(a.laws.remove(&M::IdmFloor), b.laws.remove(&M::IdmFloor));
            assert_eq!(a, b);
        }
    }

    #[test]
    fn one_person_has_no_others_and_each_driver_needs_an_f() {
        let runs = runs(&[1.0, 1.5, 2.2]);
        let one = evaluate(&runs[..1], &runs[..1], None, &quick(0));
        assert!(matches!(one, Err(FollowingError::TooFewDrivers { .. })));
        let f = Distances {
            own: lines(&[1.5; 2]),
            mean: lines(&[1.5; 3]),
        };
        let short = evaluate(&runs, &runs, Some(&f), &quick(0));
        assert!(matches!(
            short,
            Err(FollowingError::LawCount {
                found: 2,
                expected: 3,
                ..
            })
        ));
    }
}

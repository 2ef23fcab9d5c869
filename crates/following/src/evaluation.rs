//! Every method on every driver's test rows.

use crate::{
    calibrate::Calibrated,
    closed_loop::simulate,
    driver_laws::{DriverLaws, laws_of_each},
    error::{FollowingError, enough_drivers},
    method::FollowingMethod as M,
    results::{
        DriverEvaluation, FollowingEvaluation, MethodErrors, MethodMean, MethodSeries, TestSeries,
    },
    run::{FollowingRun, people},
    settings::FollowingSettings,
    simulation_errors::SimulationErrors,
};

/// Fits IDM in three ways and drives by each on the test rows of `judged`.
///
/// What is known of people before a driver is met are the fit rows of `learned`, without any drive of the same person: give the same
/// runs twice, and each is judged beside the others; or two groups of people. The comparisons of the result are left empty.
///
/// # Errors
/// - [`FollowingError::TooFewDrivers`] below two people to learn from.
/// - [`FollowingError::TooShort`] below nine rows.
/// - [`FollowingError::NeverMoves`] for a driver without a time gap.
/// - [`FollowingError::BadSetting`].
///
/// # Source
/// The protocol is that of the closed-loop calibration of car-following models (Kesting and Treiber 2008): only the leader is
/// recorded.
pub fn evaluate(
    judged: &[FollowingRun],
    learned: &[FollowingRun],
    settings: &FollowingSettings,
) -> Result<FollowingEvaluation, FollowingError> {
    settings.check()?;
    let learned_from = people(learned).len();
    enough_drivers(learned_from, 2)?;
    for run in judged.iter().chain(learned) {
        run.check_fit(settings.moving_above_mps)?;
    }
    let laws = laws_of_each(judged, learned, settings)?;
    let drivers = judged.iter().zip(&laws);
    let drivers: Vec<DriverEvaluation> =
        drivers.map(|(run, laws)| drive(run, laws)).collect::<Result<_, _>>()?;
    let means = M::ALL.iter().filter_map(|m| MethodMean::over(*m, &drivers));
    Ok(FollowingEvaluation {
        learned_from,
        driven: M::DRIVEN_BY_DEFAULT,
        means: means.collect(),
        drivers,
        compared: Vec::new(),
    })
}

/// Drives the test rows of one run by each law.
fn drive(run: &FollowingRun, laws: &DriverLaws) -> Result<DriverEvaluation, FollowingError> {
    let test = run.test();
    let mut methods = Vec::new();
    let mut series = recorded_series(run);
    for &(method, Calibrated { law, fit_gap_rmse_m }) in laws {
        let by_law = |gap_m, ego_mps, lead_mps| law.accel_mps2(gap_m, ego_mps, lead_mps);
        let simulated = simulate(&test, method.as_str(), by_law)?;
        methods.push(MethodErrors {
            method,
            law,
            fit_gap_rmse_m,
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
    use crate::{SearchSettings, testing};
    use maveric_laws::Idm;

    fn quick() -> FollowingSettings {
        FollowingSettings {
            search: SearchSettings {
                members_per_parameter: 4,
                generations: 15,
                ..SearchSettings::default()
            },
            ..FollowingSettings::default()
        }
    }

    fn runs(time_gaps_s: &[f64]) -> Vec<FollowingRun> {
        let run =
            |t: &f64| testing::driven_by_idm(&format!("T{t}"), testing::DRIVER.with_time_gap_s(*t));
        time_gaps_s.iter().map(run).collect()
    }

    fn gap(evaluation: &FollowingEvaluation, method: M) -> f64 {
        evaluation.mean(method).unwrap().gap_rmse_m
    }

    #[test]
    fn knowing_more_of_the_driver_gives_less_error() {
        let runs = runs(&[1.0, 1.5, 2.2]);
        let found = evaluate(&runs, &runs, &quick()).unwrap();
        let rmse = |method| gap(&found, method);
        assert!(rmse(M::IdmPopulationOwnTimeGap) < 0.5 * rmse(M::IdmPopulation));
        assert!(rmse(M::IdmOwn) < rmse(M::IdmPopulationOwnTimeGap));
        assert_eq!(found.driven, M::IdmPopulationOwnTimeGap);
        let of = |d: &DriverEvaluation| d.gap_rmse_m(M::IdmPopulation);
        let mut gaps: Vec<f64> = found.drivers.iter().filter_map(of).collect();
        gaps.sort_by(f64::total_cmp);
        let median = found.mean(M::IdmPopulation).unwrap().gap_rmse_median_m;
        assert!((median - gaps[1]).abs() < 1e-12, "{gaps:?}");
    }

    #[test]
    fn own_numbers_mislead_if_the_driver_changes() {
        // The first two thirds are those of a driver who keeps long gaps; the last third is that of the others.
        let mut runs = runs(&[2.8, 1.4, 1.5]);
        let usual = runs[1].columns().clone();
        let mut columns = runs[0].columns().clone();
        let from = runs[0].test_start();
        columns.gap_m[from..].copy_from_slice(&usual.gap_m[from..]);
        columns.ego_speed_mps[from..].copy_from_slice(&usual.ego_speed_mps[from..]);
        runs[0] = FollowingRun::new("changes", testing::RATE_HZ, columns).unwrap();
        let found = evaluate(&runs, &runs, &quick()).unwrap();
        let of = |method| found.drivers[0].gap_rmse_m(method).unwrap();
        assert!(of(M::IdmPopulation) < of(M::IdmPopulationOwnTimeGap));
        assert!(of(M::IdmPopulation) < of(M::IdmOwn));
    }

    #[test]
    fn methods_drive_by_the_law_that_they_name() {
        let runs = runs(&[1.0, 1.5, 2.2]);
        let found = evaluate(&runs, &runs, &quick()).unwrap();
        for (run, driver) in runs.iter().zip(&found.drivers) {
            let tried: Vec<M> = driver.methods.iter().map(|m| m.method).collect();
            assert_eq!(tried, M::ALL);
            for method in &driver.methods {
                let rmse = |law: Idm| {
                    let test = run.test();
                    let by_law = |g, v, lead| law.accel_mps2(g, v, lead);
                    let driven = simulate(&test, "law", by_law).unwrap();
                    SimulationErrors::between(&test, &driven).gap_rmse_m
                };
                let error = method.errors.gap_rmse_m;
                assert!((rmse(method.law) - error).abs() < 1e-12);
                let further = method.law.with_time_gap_s(method.law.time_gap_s + 1.0);
                assert!((rmse(further) - error).abs() > 0.1);
            }
        }
    }

    #[test]
    fn people_can_be_judged_by_what_was_learned_from_others() {
        let (judged, learned) = (runs(&[2.8]), runs(&[1.0, 1.5, 2.2]));
        let found = evaluate(&judged, &learned, &quick()).unwrap();
        assert_eq!((found.drivers.len(), found.learned_from), (1, 3));
        assert!(gap(&found, M::IdmPopulationOwnTimeGap) < gap(&found, M::IdmPopulation));
    }

    #[test]
    fn the_others_are_other_people_and_not_further_drives_of_the_same_one() {
        let mut runs = runs(&[1.0, 2.6, 1.5, 2.0]);
        let of_others = |runs: &[FollowingRun]| {
            let found = evaluate(runs, runs, &quick()).unwrap();
            let law = found.drivers[0].methods[0].law;
            (law.time_gap_s, found.people(), found.learned_from)
        };
        let (of_three, people, learned_from) = of_others(&runs);
        assert_eq!((people, learned_from), (4, 4));
        // Without the long gaps of the second drive.
        runs[1] = runs[1].clone().of_person("T1");
        let (of_two, people, learned_from) = of_others(&runs);
        assert_eq!((people, learned_from), (3, 3));
        assert!(of_two < of_three - 0.1, "{of_two} {of_three}");
        let one = evaluate(&runs[..2], &runs[..2], &quick());
        assert!(matches!(one, Err(FollowingError::TooFewDrivers { .. })));
    }

    #[test]
    fn series_are_once_a_second_and_never_below_zero() {
        // A leader that stops at once in the test rows, within the gap that is kept.
        let stop = |t: f64| if t < 100.0 { 20.0 } else { 0.0 };
        let mut runs = runs(&[1.0, 1.5, 2.2]);
        runs[0] = testing::behind("stops", 1500, 5.0, 20.0, stop);
        let found = evaluate(&runs, &runs, &quick()).unwrap();
        assert!(found.means.iter().all(|mean| mean.reached_zero == 1));
        for driver in &found.drivers {
            let series = &driver.series;
            assert_eq!(series.time_s.len(), 50);
            assert!((series.time_s[1] - series.time_s[0] - 1.0).abs() < 1e-9);
            assert_eq!(series.simulated.len(), 3);
            for method in &series.simulated {
                assert_eq!((method.gap_m.len(), method.speed_mps.len()), (50, 50));
                assert!(method.gap_m.iter().all(|&gap| gap >= 0.0));
            }
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes_and_they_survive_a_file() {
        let runs = runs(&[1.0, 1.5, 2.2]);
        let first = evaluate(&runs, &runs, &quick()).unwrap();
        assert_eq!(first, evaluate(&runs, &runs, &quick()).unwrap());
        let text = serde_json::to_string(&first).unwrap();
        assert_eq!(first, serde_json::from_str(&text).unwrap());
    }

    #[test]
    fn the_test_rows_change_no_law() {
        let mut runs = runs(&[1.0, 1.5, 2.2]);
        let laws = |runs: &[FollowingRun]| laws_of_each(runs, runs, &quick()).unwrap();
        let before = laws(&runs);
        for run in &mut runs {
            let mut columns = run.columns().clone();
            columns.gap_m[run.test_start()..].fill(50.0);
            *run = FollowingRun::new(run.driver(), run.rate_hz(), columns).unwrap();
        }
        assert_eq!(before, laws(&runs));
        for run in &mut runs {
            let mut columns = run.columns().clone();
            columns.gap_m[..run.test_start()].fill(50.0);
            *run = FollowingRun::new(run.driver(), run.rate_hz(), columns).unwrap();
        }
        assert_ne!(before, laws(&runs));
    }

    #[test]
    fn too_few_people_short_drives_and_standstill_are_refused() {
        use FollowingError as E;
        let mut runs = runs(&[1.0, 1.5, 2.2]);
        let one = evaluate(&runs[..1], &runs[..1], &quick());
        assert!(matches!(one, Err(E::TooFewDrivers { found: 1, .. })));
        let refused = |bad: FollowingRun, runs: &mut Vec<FollowingRun>| {
            runs.push(bad);
            let judged = evaluate(runs, &runs[..3], &quick()).unwrap_err();
            let learned = evaluate(&runs[..3], runs, &quick()).unwrap_err();
            runs.pop();
            assert_eq!(judged, learned);
            judged
        };
        let short = testing::behind("short", 8, 20.0, 10.0, |_| 10.0);
        let short = refused(short, &mut runs);
        assert!(matches!(short, E::TooShort { expected: 9, .. }));
        let stands = testing::behind("stands", 300, 20.0, 2.0, |_| 2.0);
        let stands = refused(stands, &mut runs);
        assert!(matches!(stands, E::NeverMoves { .. }));
        let settings = FollowingSettings { moving_above_mps: f64::NAN, ..quick() };
        let bad = evaluate(&runs, &runs, &settings);
        assert!(matches!(bad, Err(E::BadSetting { .. })));
    }

    #[test]
    fn drives_may_have_different_rates() {
        let mut runs = runs(&[1.0, 1.5, 2.2]);
        let every_second = |column: &[f64]| column.iter().step_by(2).copied().collect();
        let c = runs[2].columns();
        let columns = crate::FollowingColumns {
            time_s: every_second(&c.time_s),
            leader_x_m: every_second(&c.leader_x_m),
            lead_speed_mps: every_second(&c.lead_speed_mps),
            ego_speed_mps: every_second(&c.ego_speed_mps),
            gap_m: every_second(&c.gap_m),
        };
        let at_10_hz = evaluate(&runs, &runs, &quick()).unwrap();
        runs[2] = FollowingRun::new("T2.2", 5.0, columns).unwrap();
        let at_5_hz = evaluate(&runs, &runs, &quick()).unwrap();
        for (a, b) in at_10_hz.drivers.iter().zip(&at_5_hz.drivers) {
            let time_gaps = [a, b].map(|d| d.methods[1].law.time_gap_s);
            assert!((time_gaps[0] - time_gaps[1]).abs() < 0.1, "{time_gaps:?}");
        }
    }
}

//! Every method on every driver's test rows.

use super::{
    baselines::{Baselines, DriverBaselines},
    closed_loop::{ClosedLoop, simulate},
    error::FollowingError,
    laws::{helly::Gains, keep_distance::KeepDistance},
    method::FollowingMethod,
    open_loop::distance_rmse_m,
    results::{
        DriverEvaluation, FollowingEvaluation, MethodErrors, MethodMean, MethodSeries, TestSeries,
    },
    run::{FollowingRun, Stretch},
    settings::FollowingSettings,
    simulation_errors::SimulationErrors,
    steering::{Steered, SteeringGains, calibrate_gains},
};
use maveric_domain::stream_seed;
use rayon::prelude::*;

/// F of one driver: following distance (m) from the leader's speed (m/s).
pub type DistanceLaw<'a> = Box<dyn Fn(f64) -> f64 + 'a>;

/// Drives in one driver's place over a stretch, as [`simulate`] does.
pub type InPlaceOf<'a> = Box<dyn Fn(&Stretch<'_>) -> Result<ClosedLoop, FollowingError> + 'a>;

/// Another learned method to try beside F.
pub struct Contender<'a> {
    /// Which one.
    pub method: FollowingMethod,
    /// One entry a driver, in the order of the runs.
    pub drivers: Vec<InPlaceOf<'a>>,
}

/// Fits the baselines and tries them and F, own and mean, on every driver's test rows.
///
/// `own_f` and `mean_f` hold one F a driver, in the order of `runs`: with the driver's own embedding, and with the
/// mean embedding of the training drivers. To try several networks fit once and call [`evaluate_beside`].
///
/// # Errors
/// Those of [`Baselines::calibrate`] and [`evaluate_beside`].
///
/// # Source
/// Method section 5 for the steering by F and its safety constraint; the protocol is that of the closed-loop
/// calibration of car-following models (Kesting and Treiber 2008): only the leader is recorded.
pub fn evaluate(
    runs: &[FollowingRun],
    own_f: &[DistanceLaw<'_>],
    mean_f: &[DistanceLaw<'_>],
    settings: &FollowingSettings,
) -> Result<FollowingEvaluation, FollowingError> {
    let baselines = Baselines::calibrate(runs, settings)?;
    evaluate_beside(runs, &baselines, own_f, mean_f, &[], settings)
}

/// Tries F, own and mean, and `others`, beside baselines that were fitted to the same `runs`.
///
/// # Errors
/// [`FollowingError::LawCount`] if there is not one F, one set of baselines, or one of each contender, a driver;
/// [`FollowingError::LawNotFinite`] if an F is NaN or infinite where it is asked; [`FollowingError::BadSetting`];
/// what a contender fails with.
pub fn evaluate_beside(
    runs: &[FollowingRun],
    baselines: &Baselines,
    own_f: &[DistanceLaw<'_>],
    mean_f: &[DistanceLaw<'_>],
    others: &[Contender<'_>],
    settings: &FollowingSettings,
) -> Result<FollowingEvaluation, FollowingError> {
    settings.check()?;
    let expected = runs.len();
    let counts = others.iter().map(|c| (c.method.as_str(), c.drivers.len()));
    for (what, found) in [
        ("own_f", own_f.len()),
        ("mean_f", mean_f.len()),
        ("baselines", baselines.drivers.len()),
    ]
    .into_iter()
    .chain(counts)
    {
        if found != expected {
            return Err(FollowingError::LawCount {
                what,
                found,
                expected,
            });
        }
    }
    let gains = steering_gains(runs, baselines, own_f, settings)?;
    let drivers = (0..runs.len())
        .map(|i| {
            let contestants = Contestants {
                laws: &baselines.drivers[i],
                own_f: &own_f[i],
                mean_f: &mean_f[i],
                gains: gains[i],
                others: others.iter().map(|c| (c.method, &c.drivers[i])).collect(),
            };
            evaluate_driver(&runs[i], &contestants, settings)
        })
        .collect::<Result<Vec<_>, _>>()?;
    let methods = drivers.first().map_or(&[][..], |d| &d.methods);
    let means = methods
        .iter()
        .enumerate()
        .map(|(at, m)| mean_over_drivers(m.method, &drivers, at))
        .collect();
    Ok(FollowingEvaluation {
        drivers,
        means,
        baselines: baselines.clone(),
        open_loop: Vec::new(),
        closed_loop: None,
    })
}

/// Everything that drives in one driver's place.
struct Contestants<'a> {
    laws: &'a DriverBaselines,
    own_f: &'a DistanceLaw<'a>,
    mean_f: &'a DistanceLaw<'a>,
    /// How hard to steer by F.
    gains: Gains,
    others: Vec<(FollowingMethod, &'a InPlaceOf<'a>)>,
}

fn steering_gains(
    runs: &[FollowingRun],
    baselines: &Baselines,
    own_f: &[DistanceLaw<'_>],
    settings: &FollowingSettings,
) -> Result<Vec<Gains>, FollowingError> {
    let helly = baselines.drivers.iter();
    if settings.steering == SteeringGains::HellyPopulation {
        return Ok(helly.map(|laws| laws.helly_population.law.gains).collect());
    }
    if runs.len() < 2 {
        return Err(FollowingError::TooFewDrivers {
            found: runs.len(),
            expected: 2,
        });
    }
    let steered = runs
        .iter()
        .zip(own_f)
        .map(|(run, f)| Steered::new(run, f))
        .collect::<Result<Vec<_>, _>>()?;
    let fitted = (0..runs.len()).into_par_iter().map(|driver| {
        let others: Vec<&Steered<'_>> = (0..runs.len())
            .filter(|&other| other != driver)
            .map(|other| &steered[other])
            .collect();
        let seed = stream_seed(settings.seed, &[runs[driver].driver(), "steering_gains"]);
        calibrate_gains(&others, settings.safety, &settings.search, seed).law
    });
    Ok(fitted.collect())
}

fn evaluate_driver(
    run: &FollowingRun,
    contestants: &Contestants<'_>,
    settings: &FollowingSettings,
) -> Result<DriverEvaluation, FollowingError> {
    let test = run.test();
    let mut methods = Vec::with_capacity(FollowingMethod::ALL.len());
    let mut series = recorded_series(run);
    for method in FollowingMethod::ALL {
        let Some(simulated) = drive(run, method, contestants, settings)? else {
            continue;
        };
        let errors = SimulationErrors::of(&test, &simulated);
        methods.push(MethodErrors { method, errors });
        let gap_m = each_second(run, &simulated.gap_m);
        series.simulated.push(MethodSeries {
            method,
            gap_m: gap_m.into_iter().map(|gap| gap.max(0.0)).collect(),
            speed_mps: each_second(run, &simulated.speed_mps),
        });
    }
    let above_mps = settings.moving_above_mps;
    Ok(DriverEvaluation {
        driver: run.driver().to_owned(),
        methods,
        steering_gains: contestants.gains,
        open_loop_own_rmse_m: distance_rmse_m(&test, above_mps, contestants.own_f),
        open_loop_mean_rmse_m: distance_rmse_m(&test, above_mps, contestants.mean_f),
        series,
    })
}

/// `None` for a learned method that nobody entered.
fn drive(
    run: &FollowingRun,
    method: FollowingMethod,
    contestants: &Contestants<'_>,
    settings: &FollowingSettings,
) -> Result<Option<ClosedLoop>, FollowingError> {
    use FollowingMethod as M;
    let (test, name, laws) = (run.test(), method.as_str(), contestants.laws);
    let by_idm = |law: super::Idm| simulate(&test, name, |g, v, lead| law.accel_mps2(g, v, lead));
    let by_helly =
        |law: super::Helly| simulate(&test, name, |g, v, lead| law.accel_mps2(g, v, lead));
    let by_time_gap =
        |law: super::ConstantTimeGap| simulate(&test, name, |g, v, l| law.accel_mps2(g, v, l));
    let by_distance = |f: &DistanceLaw<'_>| {
        let law = KeepDistance {
            distance_m: f,
            gains: contestants.gains,
            safety: settings.safety,
        };
        simulate(&test, name, |g, v, lead| law.accel_mps2(g, v, lead))
    };
    match method {
        M::ConstantTimeGapOwn => by_time_gap(laws.constant_time_gap_own),
        M::ConstantTimeGapPopulation => by_time_gap(laws.constant_time_gap_population),
        M::NewellOwn => simulate(&test, name, laws.newell_own.law.law(&test)),
        M::HellyOwn => by_helly(laws.helly_own.law),
        M::HellyPopulation => by_helly(laws.helly_population.law),
        M::GippsOwn => {
            let law = laws.gipps_own.law;
            simulate(&test, name, |g, v, lead| law.accel_mps2(g, v, lead))
        }
        M::IdmOwn => by_idm(laws.idm_own.law),
        M::IdmPopulation => by_idm(laws.idm_population.law),
        M::IdmPopulationOwnTimeGap => by_idm(laws.idm_population_own_time_gap.law),
        M::IdmPopulationOwnTimeGapAndStandstill => {
            by_idm(laws.idm_population_own_time_gap_and_standstill.law)
        }
        M::IdmPrincipalDirections => by_idm(laws.idm_principal_directions.law),
        M::FollowingDistanceOwn => by_distance(contestants.own_f),
        M::FollowingDistanceMean => by_distance(contestants.mean_f),
        M::IdmFloor => by_idm(laws.idm_floor.law),
        M::VelocityOwn | M::VelocityAndDistanceOwn | M::ClosedLoopOwn | M::ClosedLoopMean => {
            let entered = contestants.others.iter().find(|(m, _)| *m == method);
            return entered.map(|(_, drive)| drive(&test)).transpose();
        }
    }
    .map(Some)
}

fn recorded_series(run: &FollowingRun) -> TestSeries {
    let columns = run.columns();
    let test = |column: &[f64]| each_second(run, &column[run.test_start()..]);
    TestSeries {
        time_s: test(&columns.time_s),
        gap_m: test(&columns.gap_m),
        ego_speed_mps: test(&columns.ego_speed_mps),
        lead_speed_mps: test(&columns.lead_speed_mps),
        simulated: Vec::with_capacity(FollowingMethod::ALL.len()),
    }
}

fn each_second(run: &FollowingRun, column: &[f64]) -> Vec<f64> {
    let stride = (run.rate_hz().round() as usize).max(1);
    column.iter().step_by(stride).copied().collect()
}

fn mean_over_drivers(
    method: FollowingMethod,
    drivers: &[DriverEvaluation],
    at: usize,
) -> MethodMean {
    let errors = || drivers.iter().map(|driver| driver.methods[at].errors);
    let mean =
        |of: fn(SimulationErrors) -> f64| errors().map(of).sum::<f64>() / drivers.len() as f64;
    MethodMean {
        method,
        gap_rmse_m: mean(|e| e.gap_rmse_m),
        speed_rmse_mps: mean(|e| e.speed_rmse_mps),
        nrmse: mean(|e| e.nrmse),
        mixed: mean(|e| e.mixed),
        reached_zero: errors().filter(|e| e.reached_zero).count(),
        drivers: drivers.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SearchSettings, made_up};

    const QUICK: FollowingSettings = FollowingSettings {
        seed: 1,
        search: SearchSettings {
            members_per_parameter: 4,
            generations: 15,
            simplex_steps: 40,
        },
        moving_above_mps: 2.0,
        steering: SteeringGains::HellyPopulation,
        safety: crate::SafetyBound {
            reaction_s: 0.3,
            reaction_accel_mps2: 1.0,
            ego_braking_mps2: 7.0,
            lead_braking_mps2: 8.0,
            standstill_gap_m: 2.0,
        },
    };

    fn runs() -> Vec<FollowingRun> {
        [1.0, 1.5, 2.2]
            .into_iter()
            .map(|t| made_up::driven_by_idm(&format!("T{t}"), made_up::DRIVER.with_time_gap_s(t)))
            .collect()
    }

    fn lines(slopes_s: &[f64]) -> Vec<DistanceLaw<'static>> {
        let line =
            |&slope: &f64| -> DistanceLaw<'static> { Box::new(move |lead| 3.0 + slope * lead) };
        slopes_s.iter().map(line).collect()
    }

    fn gap(evaluation: &FollowingEvaluation, method: FollowingMethod) -> f64 {
        let mean = evaluation.means.iter().find(|m| m.method == method);
        mean.unwrap().gap_rmse_m
    }

    #[test]
    fn what_is_known_of_the_driver_orders_the_methods() {
        let own = lines(&[1.1, 1.6, 2.3]);
        let mean = lines(&[1.65; 3]);
        let found = evaluate(&runs(), &own, &mean, &QUICK).unwrap();
        let rmse = |method| gap(&found, method);
        let population = rmse(FollowingMethod::IdmPopulation);
        assert!(rmse(FollowingMethod::IdmOwn) < population);
        assert!(rmse(FollowingMethod::IdmPopulationOwnTimeGap) < population);
        let mean = rmse(FollowingMethod::FollowingDistanceMean);
        assert!(rmse(FollowingMethod::FollowingDistanceOwn) < mean);
    }

    #[test]
    fn a_contender_stands_beside_f_and_says_whom_it_harms() {
        let runs = runs();
        let baselines = Baselines::calibrate(&runs, &QUICK).unwrap();
        let f = lines(&[1.5; 3]);
        let as_recorded = |t: f64| -> InPlaceOf<'static> {
            let law = made_up::DRIVER.with_time_gap_s(t);
            Box::new(move |s| simulate(s, "own", |g, v, lead| law.accel_mps2(g, v, lead)))
        };
        let others = [
            Contender {
                method: FollowingMethod::ClosedLoopOwn,
                drivers: [1.0, 1.4, 2.2].map(as_recorded).into(),
            },
            Contender {
                method: FollowingMethod::ClosedLoopMean,
                drivers: [1.5; 3].map(as_recorded).into(),
            },
        ];
        let found = evaluate_beside(&runs, &baselines, &f, &f, &others, &QUICK).unwrap();
        assert!(gap(&found, FollowingMethod::ClosedLoopOwn) < 1.0);
        let harmed = found.harmed(
            FollowingMethod::ClosedLoopOwn,
            FollowingMethod::ClosedLoopMean,
        );
        assert_eq!(harmed, ["T1.5"]);
        assert!(found.mean(FollowingMethod::VelocityOwn).is_none());
    }

    #[test]
    fn series_are_once_a_second_and_never_below_zero() {
        let nothing_kept = lines(&[-9.0; 3]);
        let found = evaluate(&runs(), &nothing_kept, &nothing_kept, &QUICK).unwrap();
        for driver in &found.drivers {
            let series = &driver.series;
            assert_eq!(series.time_s.len(), 50);
            assert!((series.time_s[1] - series.time_s[0] - 1.0).abs() < 1e-9);
            // Four learned methods are not entered.
            assert_eq!(series.simulated.len(), FollowingMethod::ALL.len() - 4);
            for method in &series.simulated {
                assert_eq!((method.gap_m.len(), method.speed_mps.len()), (50, 50));
                assert!(method.gap_m.iter().all(|&gap| gap >= 0.0));
            }
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes_and_they_survive_a_file() {
        let f = lines(&[1.5; 3]);
        let first = evaluate(&runs(), &f, &f, &QUICK).unwrap();
        assert_eq!(first, evaluate(&runs(), &f, &f, &QUICK).unwrap());
        let text = serde_json::to_string(&first).unwrap();
        assert_eq!(first, serde_json::from_str(&text).unwrap());
    }

    #[test]
    fn gains_fitted_to_the_others_do_not_read_the_drivers_own_rows() {
        let settings = FollowingSettings {
            steering: SteeringGains::OtherDrivers,
            ..QUICK
        };
        let baselines = Baselines::calibrate(&runs(), &QUICK).unwrap();
        let gains = |own_f: &[DistanceLaw<'_>]| {
            let mean_f = lines(&[1.5; 3]);
            let found = evaluate_beside(&runs(), &baselines, own_f, &mean_f, &[], &settings);
            found
                .unwrap()
                .drivers
                .iter()
                .map(|d| d.steering_gains)
                .collect::<Vec<_>>()
        };
        let before = gains(&lines(&[1.1, 1.6, 2.3]));
        let after = gains(&lines(&[0.7, 1.6, 2.3]));
        assert_eq!(before[0], after[0]);
        assert_ne!(before[1], after[1]);
    }

    #[test]
    fn the_test_rows_do_not_move_what_was_fitted_before_them() {
        let mut runs = runs();
        let before = Baselines::calibrate(&runs, &QUICK).unwrap();
        for run in &mut runs {
            let mut columns = run.columns().clone();
            columns.gap_m[run.test_start()..].fill(50.0);
            *run = FollowingRun::new(run.driver(), run.rate_hz(), columns).unwrap();
        }
        let after = Baselines::calibrate(&runs, &QUICK).unwrap();
        for (a, b) in before.drivers.iter().zip(&after.drivers) {
            assert_eq!((a.idm_own, a.idm_population), (b.idm_own, b.idm_population));
            assert_eq!(a.helly_population, b.helly_population);
            assert_ne!(a.idm_floor, b.idm_floor);
        }
    }

    #[test]
    fn one_driver_has_no_population_and_each_needs_a_distance_law() {
        let f = lines(&[1.5; 2]);
        let one = evaluate(&runs()[..1], &f[..1], &f[..1], &QUICK);
        assert!(matches!(one, Err(FollowingError::TooFewDrivers { .. })));
        let short = evaluate(&runs(), &f, &f, &QUICK);
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

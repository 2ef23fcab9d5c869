use super::{drives::stream, *};
use crate::testing::{design, population};
use maveric_participants::{Cohort, CohortSettings};

fn mean_change(model: &PopulationModel, measure: &str, shift: f64) -> f64 {
    let people =
        Cohort::draw(0, 400, 5, &CohortSettings::default(), &design()).unwrap().participants;
    let changes = people.iter().filter_map(|p| {
        let d = model.drives(
            p,
            &[("mimic", CarSetting::Shift(0.0)), ("x", CarSetting::Shift(shift))],
            5,
        );
        Some(d.trials[1][measure]? - d.trials[0][measure]?)
    });
    let changes: Vec<f64> = changes.collect();
    changes.iter().sum::<f64>() / changes.len() as f64
}

#[test]
fn the_dial_moves_velocity_as_stated_and_not_at_all_without_effects() {
    let model = population();
    let up = mean_change(&model, "mean_velocity_mps", 1.0);
    assert!((up - 0.98 * 2.4).abs() < 0.2, "{up}");
    assert!(mean_change(&model.scaled(0.0), "mean_velocity_mps", 1.0).abs() < 0.1);
}

#[test]
fn a_drive_that_never_merges_back_has_neither_gap() {
    let model = population();
    let people =
        Cohort::draw(0, 400, 6, &CohortSettings::default(), &design()).unwrap().participants;
    let mut missing = 0;
    for p in &people {
        let own = model.drives(p, &[], 6).own;
        assert_eq!(own["headway_merge_back_m"].is_none(), own["headway_merge_back_s"].is_none());
        missing += usize::from(own["headway_merge_back_m"].is_none());
    }
    assert!((1..20).contains(&missing), "{missing}");
}

#[test]
fn a_derived_measure_of_nothing_is_refused() {
    let mut model = population();
    model.measures.remove("mean_velocity_mps");
    let error = model.check().unwrap_err();
    assert!(error.contains("needs `mean_velocity_mps`"), "{error}");
}

/// A measure of mean 0 and SD 1 that nothing explains and nothing moves.
fn plain() -> DrawnMeasure {
    let still = Step { step: 0.0, sd: 0.0 };
    DrawnMeasure {
        mean: 0.0,
        sd: 1.0,
        log: false,
        whole: false,
        missing: 0.0,
        loadings: BTreeMap::new(),
        low: -1e6,
        high: 1e6,
        bias: 0.0,
        error_sd: 0.0,
        up: still,
        down: still,
        across: Round { cosine: 0.0, sine: 0.0, sd: 0.0 },
    }
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12, "{found} instead of {expected}");
}

#[test]
fn a_setting_moves_a_measure_by_its_step_in_its_direction() {
    let measure = DrawnMeasure {
        up: Step { step: 0.5, sd: 0.1 },
        down: Step { step: -0.4, sd: 0.2 },
        across: Round { cosine: 0.3, sine: -0.7, sd: 0.0 },
        ..plain()
    };
    let mut rng = stream(1, &[]);
    let mut moved = |setting| measure.moved(setting, [2.0, -1.0], &mut rng);
    near(moved(CarSetting::Shift(0.0)), 0.0);
    near(moved(CarSetting::Mean), 0.0);
    near(moved(CarSetting::Shift(3.0)), 3.0 * (0.5 + 0.1 * 2.0));
    near(moved(CarSetting::Shift(-3.0)), 3.0 * (-0.4 - 0.2));
    near(moved(CarSetting::Round(0.0)), 0.3);
    near(moved(CarSetting::Round(std::f64::consts::FRAC_PI_2)), -0.7);
}

#[test]
fn a_value_is_shown_in_its_unit_within_its_limits() {
    let mut rng = stream(1, &[]);
    let mut shown = |m: &DrawnMeasure, z: f64| m.shown(z, &mut rng).unwrap();
    let unit = DrawnMeasure { mean: 20.0, sd: 4.0, low: 10.0, high: 30.0, ..plain() };
    near(shown(&unit, 1.5), 26.0);
    near(shown(&unit, 5.0), 30.0);
    near(shown(&unit, -5.0), 10.0);
    let whole = DrawnMeasure { whole: true, ..unit.clone() };
    near(shown(&whole, 0.1), 20.0);
    // A logarithm of these moments: its mean is 20 and its SD 4.
    let log = DrawnMeasure { log: true, low: 0.0, high: 1e6, ..unit };
    let spread = (1.0_f64 + 0.04).ln().sqrt();
    near(shown(&log, 0.0), 20.0 / 1.04_f64.sqrt());
    near(shown(&log, 2.0) / shown(&log, 0.0), (2.0 * spread).exp());
}

#[test]
fn the_car_s_errors_on_a_person_s_trials_share_as_much_as_the_population_says() {
    let people =
        Cohort::draw(0, 3000, 5, &CohortSettings::default(), &design()).unwrap().participants;
    let measure = DrawnMeasure { bias: 0.25, error_sd: 0.8, ..plain() };
    let mut model = population();
    model.shared = 0.6;
    model.measures = BTreeMap::from([("x".to_owned(), MeasureModel::Drawn(Box::new(measure)))]);
    let still = CarSetting::Shift(0.0);
    let errors: Vec<[f64; 2]> = people
        .iter()
        .map(|p| {
            let d = model.drives(p, &[("one", still), ("two", still)], 5);
            [0, 1].map(|i: usize| d.trials[i]["x"].unwrap() - d.own["x"].unwrap())
        })
        .collect();
    let n = errors.len() as f64;
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| errors.iter().map(of).sum::<f64>() / n;
    let (a, b) = (mean(&|e| e[0]), mean(&|e| e[1]));
    let variance = mean(&|e| (e[0] - a).powi(2));
    let together = mean(&|e| (e[0] - a) * (e[1] - b));
    // Four standard errors of 3000 people.
    assert!((a - 0.25).abs() < 0.06 && (b - 0.25).abs() < 0.06, "{a} {b}");
    assert!((variance - 0.64).abs() < 0.07, "{variance}");
    assert!((together / variance - 0.6).abs() < 0.05, "{}", together / variance);
}

#[test]
fn a_gap_in_seconds_is_that_in_metres_over_the_speed_and_positions_weigh_the_score() {
    let mut model = population();
    for measure in model.measures.values_mut() {
        if let MeasureModel::Derived(m) = measure {
            (m.factor, m.scatter) = (1.25, 0.0);
        }
    }
    let people =
        Cohort::draw(0, 20, 5, &CohortSettings::default(), &design()).unwrap().participants;
    for p in &people {
        let drives = model.drives(p, &[("up", CarSetting::Shift(1.0))], 5);
        for (name, measure) in &model.measures {
            let MeasureModel::Derived(m) = measure else {
                continue;
            };
            for values in [&drives.own, &drives.trials[0]] {
                let expected = values[&m.metres].map(|d| 1.25 * d / values[&m.velocity].unwrap());
                match (values[name], expected) {
                    (Some(a), Some(b)) => near(a, b),
                    (a, b) => assert_eq!(a, b),
                }
            }
        }
        let w = model.line.adb_weight;
        let (without, with) = model.positions(p, 1.5, 5);
        near(with, (1.0 - w) * without + w * 1.5);
    }
}

#[test]
fn a_scaled_world_has_every_effect_so_much_larger_and_nothing_explains_more_than_there_is() {
    let model = population();
    let half = model.scaled(0.5);
    let squares = |m: &PopulationModel| m.line.loadings.values().map(|l| l * l).sum::<f64>();
    near(squares(&half), 0.25 * squares(&model));
    near(half.line.adb_weight, 0.5 * model.line.adb_weight);
    near(half.other_style, 0.5);
    for (name, measure) in &model.measures {
        let (MeasureModel::Drawn(m), MeasureModel::Drawn(h)) = (measure, &half.measures[name])
        else {
            continue;
        };
        for (a, b) in [(m.up, h.up), (m.down, h.down)] {
            near(b.step, 0.5 * a.step);
            near(b.sd, 0.5 * a.sd);
        }
        near(h.across.cosine, 0.5 * m.across.cosine);
        near(h.across.sine, 0.5 * m.across.sine);
        near(h.across.sd, 0.5 * m.across.sd);
        let kept = DrawnMeasure { up: m.up, down: m.down, across: m.across, ..(**h).clone() };
        assert_eq!(kept, **m, "{name}: what is no effect stays");
    }
    let most = model.scaled(1e6);
    near(squares(&most), 0.97 * 0.97);
    near(most.line.adb_weight, 1.0);
}

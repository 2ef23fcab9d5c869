//! A study of six people, computed by hand.

use crate::{Analysis, AnalysisError, Family, Friedman, StudyData, Tables, analyse};
use maveric_domain::{
    ConditionId, DriveId, DriveMeta, DrivenBy, Embedding, EmbeddingRow, MeasuredDrive, Moment,
    ParticipantId, Score,
};
use maveric_stats::OmnibusTest;
use std::collections::BTreeMap;

const SPEED: &str = "mean_velocity_mps";
/// Mean speed of the own drive, in m/s, and of the four conditions less that.
const OWN: [f64; 6] = [25.0, 26.0, 27.0, 28.0, 29.0, 30.0];
const FASTER: [[f64; 6]; 4] = [
    [0.5, -1.0, 0.9, -0.7, 0.0, 0.3],
    [3.0, 2.5, 2.0, 3.5, 1.5, 4.0],
    [-2.0, -3.0, -2.5, -1.5, -3.5, -1.0],
    [0.1, 1.2, -0.8, 0.4, -0.2, -0.3],
];
const ADB: [f64; 6] = [20.0, 25.0, 22.0, 30.0, 28.0, 35.0];
const CONSCIENTIOUSNESS: [f64; 6] = [3.0, 1.0, 4.0, 2.0, 5.0, 3.5];
const TRUST: [[f64; 6]; 4] = [
    [5.0, 4.0, 6.0, 5.0, 4.5, 5.5],
    [3.0, 4.5, 2.0, 4.0, 3.5, 3.0],
    [5.0, 4.5, 4.0, 4.0, 2.5, 4.5],
    [4.0, 3.0, 5.0, 4.5, 4.0, 4.0],
];

fn person(i: usize) -> ParticipantId {
    ParticipantId::new(format!("P{}", i + 1)).unwrap()
}

fn drive(i: usize, condition: ConditionId, speed: Option<f64>) -> MeasuredDrive {
    MeasuredDrive {
        meta: DriveMeta {
            drive: DriveId::new(format!("P{}-{condition}", i + 1)).unwrap(),
            participant: person(i),
            condition,
            driven_by: DrivenBy::Human,
        },
        values: BTreeMap::from([(SPEED.to_owned(), speed)]),
    }
}

fn score(i: usize, moment: Moment, scale: &str, subscale: &str, value: f64) -> Score {
    Score {
        participant: person(i),
        moment,
        scale: scale.to_owned(),
        subscale: subscale.to_owned(),
        value: Some(value),
        answered: 1,
        items: 1,
    }
}

fn position(i: usize) -> EmbeddingRow {
    EmbeddingRow {
        drive: DriveId::new(format!("P{}-own", i + 1)).unwrap(),
        participant: person(i),
        condition: ConditionId::OWN,
        adb_used: true,
        adb: None,
        adb_hat: None,
        line_position: Some(i as f64),
        readings: None,
        covariance: None,
        line_position_se: None,
        embedding: Embedding::new(vec![i as f64]).unwrap(),
    }
}

fn tables() -> Tables {
    let mut tables = Tables::default();
    for i in 0..6 {
        tables.tested.insert(person(i));
        tables
            .measurements
            .push(drive(i, ConditionId::OWN, Some(OWN[i])));
        tables.embeddings.push(position(i));
        let pre = |scale, subscale, value| score(i, Moment::Pre, scale, subscale, value);
        tables.pre.push(pre("adb", "total", ADB[i]));
        tables
            .pre
            .push(pre("mini_ipip", "conscientiousness", CONSCIENTIOUSNESS[i]));
        for (k, condition) in ConditionId::AV.into_iter().enumerate() {
            let speed = OWN[i] + FASTER[k][i];
            tables.measurements.push(drive(i, condition, Some(speed)));
            let trust = score(
                i,
                Moment::After(condition),
                "jian_trust",
                "overall",
                TRUST[k][i],
            );
            tables.post.push(trust);
        }
    }
    tables
}

fn analysed(tables: Tables) -> Analysis {
    let family: Family = "mini_ipip".parse().unwrap();
    analyse(&StudyData::new(tables).unwrap(), &family, Friedman::Exact).unwrap()
}

#[track_caller]
fn near(found: Option<f64>, expected: f64) {
    let found = found.expect("a number");
    assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
}

#[test]
fn the_line_against_the_score_is_the_correlation_by_hand() {
    let a = analysed(tables());
    let row = |name: &str| a.line.rows.iter().find(|r| r.measure == name).unwrap();
    // Positions 0 to 5: Sxx = 17.5; Sxy = 446 - 6 · 2.5 · 80/3 = 46; Syy = 4418 - 6 · (80/3)² = 454/3.
    near(
        row("adb").correlation.r,
        46.0 / (17.5 * 454.0_f64 / 3.0).sqrt(),
    );
    near(row(SPEED).correlation.r, 1.0);
    assert_eq!(row("lane_changes").correlation.n, 0);
}

#[test]
fn accuracy_is_one_less_the_error_over_the_own_value() {
    let a = analysed(tables());
    let errors = 0.5 / 25.0 + 1.0 / 26.0 + 0.9 / 27.0 + 0.7 / 28.0 + 0.0 + 0.3 / 30.0;
    near(a.accuracy[0].mean, 1.0 - errors / 6.0);
    assert_eq!((a.accuracy[0].n, a.accuracy[1].n), (6, 0));
}

#[test]
fn six_of_six_nearer_has_the_smallest_exact_p() {
    let a = analysed(tables());
    for row in a.nearer.iter().filter(|r| r.measure == SPEED) {
        near(row.share, 1.0);
        near(row.p, 2.0 / 64.0);
        // Two rows have values, so Holm counts two.
        near(row.p_holm, 4.0 / 64.0);
    }
}

#[test]
fn a_panel_holds_the_differences_and_friedmans_test_by_hand() {
    let a = analysed(tables());
    let panel = &a.panels[0];
    near(panel.rows[1][0], -3600.0 / 1609.344);
    let found = panel.comparison.as_ref().unwrap();
    // Ranks: the faster car 4 and the slower 1 for everybody, the two others 16 and 14 in all:
    // 12 / (6 · 4 · 5) · (16² + 24² + 6² + 14²) - 3 · 6 · 5.
    assert_eq!(found.chosen, OmnibusTest::Friedman);
    near(found.omnibus.statistic, 16.4);
    let condition = FASTER.map(|row| row.iter().sum::<f64>() / 6.0);
    let pair = panel
        .pairs
        .iter()
        .find(|p| (p.first, p.second) == (ConditionId::MIMIC, ConditionId::AGGRESSIVE));
    near(
        pair.unwrap().mean_difference,
        (condition[0] - condition[1]) * 3600.0 / 1609.344,
    );
    assert_eq!(panel.pairs.len(), 6);
}

#[test]
fn homophily_is_the_factor_against_the_difference_in_rating() {
    let a = analysed(tables());
    let row = a
        .homophily
        .iter()
        .find(|r| r.versus == ConditionId::CAUTIOUS && r.rating == "trust")
        .unwrap();
    // Differences 0, -0.5, 2, 1, 2, 1 with the factor 3, 1, 4, 2, 5, 3.5: means 5.5/6 and 18.5/6.
    let (x, y): (f64, f64) = (18.5 / 6.0, 5.5 / 6.0);
    let sxy = (0.0 - 0.5 + 8.0 + 2.0 + 10.0 + 3.5) - 6.0 * x * y;
    let sxx = (9.0 + 1.0 + 16.0 + 4.0 + 25.0 + 12.25) - 6.0 * x * x;
    let syy = (0.0 + 0.25 + 4.0 + 1.0 + 4.0 + 1.0) - 6.0 * y * y;
    assert_eq!(row.correlation.method, "pearson");
    near(row.correlation.r, sxy / (sxx * syy).sqrt());
    // Two tests in the family have answers.
    let least = row.correlation.p.unwrap();
    assert!(row.p_holm.unwrap() <= 2.0 * least + 1e-12 && row.p_holm.unwrap() >= least);
}

#[test]
fn one_of_six_preferred_the_faster_car_and_one_the_slower() {
    let a = analysed(tables());
    let trust = a.preferences.iter().find(|p| p.rating == "trust").unwrap();
    assert_eq!(
        (trust.n, trust.aggressive_above, trust.cautious_above),
        (6, 1, 1)
    );
    // P1 rates both alike.
    assert_eq!(trust.mimic_not_above_cautious, 2);
    // Wilson's interval of 1/6.
    let z2 = 1.959_963_984_540_054_f64.powi(2);
    let half = (z2 * (5.0 / 36.0 / 6.0 + z2 / 144.0)).sqrt();
    let share = trust.aggressive_share.as_ref().unwrap();
    assert!((share.low - (1.0 / 6.0 + z2 / 12.0 - half) / (1.0 + z2 / 6.0)).abs() < 1e-9);
}

#[test]
fn whoever_lacks_a_value_is_left_out_and_named() {
    let mut tables = tables();
    for drive in &mut tables.measurements {
        if drive.meta.drive.as_str() == "P4-mimic" {
            drive.values.insert(SPEED.to_owned(), None);
        }
    }
    let a = analysed(tables);
    assert_eq!(a.panels[0].dropped, ["P4"]);
    assert_eq!((a.panels[0].n, a.accuracy[0].dropped), (5, 1));
    let said = |e: &crate::Exclusion| e.who == "P4" && e.what == "comparison of mean velocity";
    assert!(a.exclusions.iter().any(said));
}

#[test]
fn too_few_people_and_unknown_factors_are_refused_by_name() {
    let mut two = tables();
    two.measurements
        .retain(|d| ["P1", "P2"].contains(&d.meta.participant.as_str()));
    let error = StudyData::new(two).unwrap_err();
    assert!(matches!(error, AnalysisError::TooFewPeople { found: 2 }));
    let data = StudyData::new(tables()).unwrap();
    for (family, said) in [
        ("mdsi", "the scale `mdsi`, which nobody answered"),
        (
            "mini_ipip.pace",
            "the factors of mini_ipip are conscientiousness",
        ),
    ] {
        let error = analyse(&data, &family.parse().unwrap(), Friedman::Exact).unwrap_err();
        assert!(
            error.to_string().contains(said) && error.suggestion().is_some(),
            "{error}"
        );
    }
}

//! Six people whose drives, scores and answers can be worked out by hand.

use crate::{Analysis, Panel, Purpose, StudyData, Tables, analyse};
use maveric_domain::{
    ConditionId, ConditionRow, Design, DriveId, DriveMeta, DrivenBy, Embedding, EmbeddingRow,
    MeasuredDrive, Moment, ParticipantId, Score,
    press::{PressMoment, PressedRide},
    stream_seed,
};
use std::collections::BTreeMap;

pub(crate) const CONDITIONS: [&str; 4] = ["same", "fast", "slow", "across"];
pub(crate) const DESIGN: &str = r#"
    [study]
    title = "Six people"
    [people]
    learn = { group = "drivers" }
    [style]
    score = "adb.total"
    label = "ADB score"
    points = 15
    [baseline]
    id = "own"
    [[condition]]
    id = "same"
    car = { dial = 0 }
    [[condition]]
    id = "fast"
    car = { dial = "+1" }
    [[condition]]
    id = "slow"
    car = { dial = "-1" }
    [[condition]]
    id = "across"
    car = { across = true }
    [homophily]
    factors = ["mini_ipip"]
    ratings = ["jian_trust.overall"]
"#;

pub(crate) const SPEED: &str = "mean_velocity_mps";
/// Mean speed of the own drive, in m/s, and of the four conditions less that.
pub(crate) const OWN: [f64; 6] = [25.0, 26.0, 27.0, 28.0, 29.0, 30.0];
pub(crate) const FASTER: [[f64; 6]; 4] = [
    [0.5, -1.0, 0.9, -0.7, 0.0, 0.3],
    [3.0, 2.5, 2.0, 3.5, 1.5, 4.0],
    [-2.0, -3.0, -2.5, -1.5, -3.5, -1.0],
    [0.1, 1.2, -0.8, 0.4, -0.2, -0.3],
];
pub(crate) const ADB: [f64; 6] = [20.0, 25.0, 22.0, 30.0, 28.0, 35.0];
pub(crate) const CONSCIENTIOUSNESS: [f64; 6] = [3.0, 1.0, 4.0, 2.0, 5.0, 3.5];
pub(crate) const TRUST: [[f64; 6]; 4] = [
    [5.0, 4.0, 6.0, 5.0, 4.5, 5.5],
    [3.0, 4.5, 2.0, 4.0, 3.5, 3.0],
    [5.0, 4.5, 4.0, 4.0, 2.5, 4.5],
    [4.0, 3.0, 5.0, 4.5, 4.0, 4.0],
];

pub(crate) fn person(i: usize) -> ParticipantId {
    ParticipantId::new(format!("P{}", i + 1)).unwrap()
}

pub(crate) fn id(text: &str) -> ConditionId {
    text.parse().unwrap()
}

pub(crate) fn drive(i: usize, condition: &str, speed: Option<f64>) -> MeasuredDrive {
    MeasuredDrive {
        meta: DriveMeta::new(
            DriveId::new(format!("P{}-{condition}", i + 1)).unwrap(),
            person(i),
            id(condition),
            DrivenBy::Human,
        ),
        values: BTreeMap::from([(SPEED.to_owned(), speed)]),
        counted_s: None,
    }
}

pub(crate) fn score(i: usize, moment: Moment, scale: &str, subscale: &str, value: f64) -> Score {
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

pub(crate) fn position(i: usize, position: f64) -> EmbeddingRow {
    let drive = DriveId::new(format!("P{}-own", i + 1)).unwrap();
    let style = Embedding::new(vec![position]).unwrap();
    EmbeddingRow {
        adb_used: true,
        line_position: Some(position),
        ..EmbeddingRow::new(drive, person(i), id("own"), style)
    }
}

pub(crate) fn tables() -> Tables {
    let mut tables = Tables::default();
    for i in 0..6 {
        tables.measurements.push(drive(i, "own", Some(OWN[i])));
        tables.embeddings.push(position(i, i as f64));
        let pre = |scale, subscale, value| score(i, Moment::Pre, scale, subscale, value);
        tables.pre.push(pre("adb", "total", ADB[i]));
        tables.pre.push(pre("mini_ipip", "conscientiousness", CONSCIENTIOUSNESS[i]));
        for (k, condition) in CONDITIONS.into_iter().enumerate() {
            let speed = OWN[i] + FASTER[k][i];
            tables.measurements.push(drive(i, condition, Some(speed)));
            let after = Moment::after(id(condition));
            let trust = score(i, after, "jian_trust", "overall", TRUST[k][i]);
            tables.post.push(trust);
        }
    }
    tables
}

pub(crate) fn design(text: &str) -> Design {
    Design::from_toml(text).unwrap()
}

pub(crate) fn analysed_by(text: &str, tables: Tables) -> Analysis {
    let data = StudyData::new(&design(text), tables).unwrap();
    analyse(&data, Purpose::Report).unwrap()
}

pub(crate) fn analysed(tables: Tables) -> Analysis {
    analysed_by(DESIGN, tables)
}

/// The shortest design: these conditions, none of them steered, against the own drive.
pub(crate) fn plain(conditions: &[&str], more: &str) -> String {
    let conditions: Vec<String> =
        conditions.iter().map(|c| format!("[[condition]]\nid = \"{c}\"\n")).collect();
    format!("[study]\ntitle = \"t\"\n[baseline]\nid = \"own\"\n{}{more}", conditions.concat())
}

pub(crate) fn panel<'a>(a: &'a Analysis, outcome: &str) -> &'a Panel {
    a.panels.iter().find(|p| p.outcome == outcome).unwrap()
}

#[track_caller]
pub(crate) fn near(found: Option<f64>, expected: f64) {
    let found = found.expect("a number");
    assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
}

pub(crate) fn steered(
    i: usize,
    condition: &str,
    angle_rad: Option<f64>,
    beyond_training: bool,
) -> ConditionRow {
    ConditionRow {
        participant: person(i),
        condition: id(condition),
        adb_hat: None,
        moved_points: None,
        moved_points_sd: None,
        clamped: false,
        angle_rad,
        lent: None,
        beyond_training,
        beyond_why: None,
        sweep: None,
        embedding: Embedding::new(vec![0.0]).unwrap(),
    }
}

/// People whose own style lies from 20 to 40, in the cars at 0 and 15 points to either side: what lies `best` points from their own style is
/// trusted most, and a squared point from there less by `bend`.
pub(crate) fn liked(people: usize, best: impl Fn(f64) -> f64, bend: f64) -> Tables {
    let mut tables = Tables::default();
    for i in 0..people {
        // Between -1 and 1, without a pattern.
        let draw = |what: &str| {
            let key = format!("{i} {what}");
            2.0 * (stream_seed(1, &[&key]) as f64 / u64::MAX as f64) - 1.0
        };
        let own = 30.0 + 10.0 * draw("own");
        let top = best(own) + draw("top");
        tables.pre.push(score(i, Moment::Pre, "mini_ipip", "conscientiousness", draw("trait")));
        for (condition, moved) in [("same", 0.0), ("fast", 15.0), ("slow", -15.0)] {
            tables.conditions.push(ConditionRow {
                adb_hat: Some(own + moved),
                moved_points: Some(moved),
                ..steered(i, condition, None, false)
            });
            let trust = 4.0 + draw("level") - bend * (moved - top).powi(2) + 0.3 * draw(condition);
            let after = Moment::after(id(condition));
            tables.post.push(score(i, after, "jian_trust", "overall", trust));
        }
    }
    tables
}

/// People who rode fast and slow and pressed so often (by person and condition); braking was so much stronger before a press.
pub(crate) fn pressing(
    people: usize,
    presses: impl Fn(usize, usize) -> usize,
    braking: f64,
) -> StudyData {
    let conditions = ["fast", "slow"];
    let (mut tables, mut rides, mut moments) = (Tables::default(), Vec::new(), Vec::new());
    for i in 0..people {
        tables.measurements.push(drive(i, "own", Some(25.0)));
        for (k, condition) in conditions.into_iter().enumerate() {
            let ridden = drive(i, condition, Some(25.0 + (i + k) as f64));
            rides.push(PressedRide {
                participant: person(i),
                condition: id(condition),
                drive: ridden.meta.drive.clone(),
                minutes: 20.0,
                presses: presses(i, k),
            });
            tables.measurements.push(ridden);
            for minute in 0..presses(i, k) as u32 {
                for second in 20..50 {
                    let draw = |what: &str| {
                        let key = format!("{i} {k} {minute} {second} {what}");
                        Some(stream_seed(1, &[&key]) as f64 / u64::MAX as f64)
                    };
                    let pressed = second == 35;
                    let before = if pressed { braking } else { 0.0 };
                    moments.push(PressMoment {
                        participant: person(i),
                        condition: id(condition),
                        drive: rides[rides.len() - 1].drive.clone(),
                        minute,
                        time_s: f64::from(60 * minute + second),
                        pressed,
                        at_risk: true,
                        to_press_s: (25..=35).contains(&second).then(|| f64::from(35 - second)),
                        least_gap_m: draw("gap"),
                        inverse_time_to_collision_per_s: draw("closing"),
                        braking_mps2: draw("braking").map(|b| b + before),
                        jerk_mps3: draw("jerk"),
                        lateral_acceleration_mps2: draw("aside"),
                        lane_change: draw("change").map(f64::round),
                        cut_in: draw("cut in").map(f64::round),
                    });
                }
            }
        }
    }
    let design = design(&plain(&conditions, ""));
    let data = StudyData::new(&design, tables).unwrap();
    data.with_presses(rides, moments)
}

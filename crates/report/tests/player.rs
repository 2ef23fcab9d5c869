//! The watch player: what goes in comes out, and nothing else does.
#![expect(clippy::unwrap_used, reason = "a helper of a test stops at the first surprise")]

use base64::Engine as _;
use maveric_domain::{ConditionId, drive::Direction};
use maveric_report::{
    Context, ReportError,
    html::{
        CentreLine, ChangeSpan, InterventionSpan, PlayerDrive, Track, WatchPlayer, player,
        player::{GAP_QUANTUM_M, POSITION_QUANTUM_M, SAMPLES_PER_S, SPEED_QUANTUM_MPS},
        watch_page,
    },
};
use serde_json::Value;

const RATE_HZ: f64 = 20.0;

fn time(rows: usize) -> Vec<f64> {
    (0..rows).map(|row| row as f64 / RATE_HZ).collect()
}

fn track(id: u32, first_row: usize, rows: usize, from_m: f64, mps: f64) -> Track {
    let at = |row: usize| (first_row + row) as f64 / RATE_HZ;
    Track {
        id,
        length_m: 4.7,
        width_m: 1.9,
        first_row,
        x_m: (0..rows).map(|row| from_m + mps * at(row) + 0.7 * at(row).sin()).collect(),
        y_m: (0..rows).map(|row| 1.8 * (0.2 * at(row)).cos()).collect(),
    }
}

/// A drive among cars that come and go.
fn drive(rows: usize, cars: u32) -> PlayerDrive {
    let others: Vec<Track> = (0..cars)
        .map(|id| {
            let first = (rows / 3).min(id as usize * 7);
            track(id + 1, first, rows - first, 60.0 - 30.0 * f64::from(id), 25.0)
        })
        .collect();
    PlayerDrive {
        label: "Mimic".into(),
        note: "automated".into(),
        condition: ConditionId::new("same").unwrap(),
        lanes: 2,
        lane_width_m: 3.66,
        centre_line: None,
        time_s: time(rows),
        segment: vec![0; rows],
        ego: track(0, 0, rows, 1234.567, 25.0),
        speed_mps: time(rows).iter().map(|t| 25.0 + (0.3 * t).sin()).collect(),
        gap_m: time(rows)
            .iter()
            .map(|t| (t.rem_euclid(20.0) < 15.0).then(|| 40.0 * (0.1 * t).cos()))
            .collect(),
        reference: vec![Some(1); rows],
        others: others
            .into_iter()
            .map(|car| Track { x_m: car.x_m.iter().map(|x| x + 1234.567).collect(), ..car })
            .collect(),
        lane_changes: vec![ChangeSpan { start_s: 3.0, end_s: 7.0, direction: Direction::Right }],
        interventions: Some(vec![InterventionSpan { start_s: 9.0, end_s: 9.5 }]),
    }
}

fn watch(drives: Vec<PlayerDrive>) -> WatchPlayer {
    WatchPlayer { name: "watch".into(), title: "Drives of P07".into(), drives }
}

fn html(drives: Vec<PlayerDrive>) -> String {
    player(&watch(drives), &Context::real()).unwrap().html
}

fn data(html: &str) -> Value {
    let (_, rest) = html.split_once("class=\"pl-data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// Reads the bytes of a drive as the script does.
struct Reader {
    bytes: std::vec::IntoIter<u8>,
}

impl Reader {
    fn new(drive: &Value) -> Self {
        let text = drive["bytes"].as_str().unwrap();
        let bytes = base64::engine::general_purpose::STANDARD.decode(text);
        Self { bytes: bytes.unwrap().into_iter() }
    }

    fn next(&mut self) -> i64 {
        let (mut value, mut shift) = (0_u64, 0);
        loop {
            let byte = self.bytes.next().unwrap();
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return (value >> 1).cast_signed() ^ -(value & 1).cast_signed();
            }
            shift += 7;
        }
    }

    fn column(&mut self, count: usize, quantum: f64, order: usize) -> Vec<f64> {
        let (mut value, mut slope) = (0, 0);
        let step = |reader: &mut Self| {
            let next = reader.next();
            if order == 2 {
                slope += next;
                value += slope;
            } else {
                value += next;
            }
            value as f64 * quantum
        };
        let mut step = step;
        (0..count).map(|_| step(self)).collect()
    }
}

fn close(found: &[f64], expected: impl Iterator<Item = f64>, quantum: f64) {
    let expected: Vec<f64> = expected.collect();
    assert_eq!(found.len(), expected.len());
    for (i, (f, e)) in found.iter().zip(&expected).enumerate() {
        assert!((f - e).abs() <= 0.5 * quantum + 1e-6, "sample {i}: {f} and {e}");
    }
}

fn index(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

#[test]
fn positions_speeds_and_gaps_come_back_within_their_quantum() {
    let drive = drive(1200, 3);
    let data = data(&html(vec![drive.clone()]));
    let packed = &data["drives"][0];
    let every = (RATE_HZ / SAMPLES_PER_S) as usize;
    let start = drive.ego.x_m[0];
    let samples = index(&packed["samples"]);
    assert_eq!(samples, 300);
    assert_eq!(packed["runs"], serde_json::json!([[0, 300]]));
    let mut reader = Reader::new(packed);
    let thinned = |values: &[f64]| values.iter().copied().step_by(every).collect::<Vec<_>>();
    let x = thinned(&drive.ego.x_m);
    close(
        &reader.column(samples, POSITION_QUANTUM_M, 2),
        x.iter().map(|x| x - start),
        POSITION_QUANTUM_M,
    );
    let y = thinned(&drive.ego.y_m);
    close(&reader.column(samples, POSITION_QUANTUM_M, 1), y.into_iter(), POSITION_QUANTUM_M);
    let speed = thinned(&drive.speed_mps);
    close(&reader.column(samples, SPEED_QUANTUM_MPS, 1), speed.into_iter(), SPEED_QUANTUM_MPS);
    let none = -32_768.0 * GAP_QUANTUM_M;
    let gap = drive.gap_m.iter().step_by(every);
    close(
        &reader.column(samples, GAP_QUANTUM_M, 1),
        gap.map(|gap| gap.unwrap_or(none)),
        GAP_QUANTUM_M,
    );
    let cars = packed["cars"].as_array().unwrap();
    assert_eq!(cars.len(), 3);
    for (car, track) in cars.iter().zip(&drive.others) {
        let (first, count) = (index(&car[1]), index(&car[2]));
        let rows = |values: &[f64]| -> Vec<f64> {
            let at = (first..first + count).map(|sample| sample * every - track.first_row);
            at.map(|row| values[row]).collect()
        };
        close(
            &reader.column(count, POSITION_QUANTUM_M, 2),
            rows(&track.x_m).iter().map(|x| x - start),
            POSITION_QUANTUM_M,
        );
        close(
            &reader.column(count, POSITION_QUANTUM_M, 1),
            rows(&track.y_m).into_iter(),
            POSITION_QUANTUM_M,
        );
    }
    assert_eq!(reader.bytes.next(), None);
}

#[test]
fn a_car_out_of_sight_is_left_out_while_it_is() {
    let mut drive = drive(400, 1);
    // It stands; ego passes it.
    drive.others[0].x_m = vec![drive.ego.x_m[0] + 250.0; 400];
    drive.others[0].first_row = 0;
    drive.others[0].y_m = vec![0.0; 400];
    let data = data(&html(vec![drive.clone()]));
    let car = &data["drives"][0]["cars"][0];
    let first = index(&car[1]);
    let ahead = |sample: usize| 250.0 - (drive.ego.x_m[sample * 4] - drive.ego.x_m[0]);
    assert!(ahead(first) <= 150.0 && ahead(first - 1) > 150.0);
    let last = first + index(&car[2]) - 1;
    assert!(ahead(last) >= -90.0 && ahead(last + 1) < -90.0);
}

#[test]
fn a_hole_in_the_recording_is_a_hole_in_the_data() {
    let mut drive = drive(400, 0);
    for row in 200..400 {
        drive.time_s[row] += 6.0;
        drive.segment[row] = 1;
    }
    let html = html(vec![drive]);
    let data = data(&html);
    let runs = &data["drives"][0]["runs"];
    assert_eq!(runs, &serde_json::json!([[0, 50], [80, 50]]));
    // The speed's line is broken there.
    let line = html.split_once("pl-speed\" d=\"").unwrap().1;
    let line = line.split_once('"').unwrap().0;
    assert_eq!(line.matches('M').count(), 2);
}

#[test]
fn what_somebody_typed_stays_text() {
    let typed = "</script><script>alert('x')</script> & \"P\" \u{5d0}\u{5d1} \u{1f697}";
    let mut drive = drive(100, 1);
    drive.label = typed.into();
    drive.note = typed.into();
    let mut input = watch(vec![drive]);
    input.title = typed.into();
    let provenance = [(typed.to_owned(), typed.to_owned())];
    let page = watch_page(&input, &Context::synthetic(1), &provenance).unwrap();
    assert!(!page.contains("<script>alert") && !page.contains("alert('x')"));
    assert!(page.contains("&lt;script&gt;") && page.contains("\u{1f697}"));
    // The data block and the script, and nothing that somebody typed.
    assert_eq!(page.matches("<script").count(), 2);
}

#[test]
fn the_page_needs_nothing_from_outside_and_says_who_is_made_up() {
    let page = watch_page(
        &watch(vec![drive(100, 1)]),
        &Context::synthetic(4),
        &[("Version".into(), "1".into())],
    )
    .unwrap();
    for outside in ["http:", "https:", "src=", "@import", "//www", "fetch(", "eval("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.contains("default-src 'none'"));
    assert!(page.contains("<b>Synthetic participants.</b>") && page.contains("seed 4"));
    let real = watch_page(&watch(vec![drive(100, 1)]), &Context::real(), &[]).unwrap();
    assert!(!real.contains("Synthetic"));
}

#[test]
fn without_a_script_there_are_time_lines_and_a_table() {
    let html = html(vec![drive(400, 2)]);
    assert!(html.contains("class=\"pl-controls\" hidden"));
    assert!(html.contains("<path class=\"pl-speed\""));
    assert!(html.contains("class=\"pl-mark pl-right\" style=\"left:15.15%;width:20.20%\""));
    let table = html.split_once("<tbody>").unwrap().1;
    assert!(table.contains(
        "<td class=\"number\">0</td><td class=\"number\">1</td><td class=\"number\">1</td>"
    ));
}

#[test]
fn where_nobody_could_intervene_there_is_a_dash() {
    let mut by_hand = drive(100, 0);
    by_hand.interventions = None;
    let html = html(vec![by_hand.clone(), drive(100, 0)]);
    assert!(html.contains("<td class=\"number\">–</td>"));
    let alone = player(&watch(vec![by_hand]), &Context::real()).unwrap();
    assert!(!alone.html.contains("Interventions</th>"));
}

#[test]
fn a_curved_road_travels_along() {
    let radius = 400.0;
    let place = |i: u32| {
        let angle = f64::from(i) * 10.0 / radius;
        (radius * angle.sin(), radius * (1.0 - angle.cos()))
    };
    let line = CentreLine { start_m: 1000.0, step_m: 10.0, map_m: (0..100).map(place).collect() };
    let mut curved = drive(400, 1);
    curved.centre_line = Some(line);
    let html = html(vec![curved]);
    let data = data(&html);
    let packed = &data["drives"][0];
    assert_eq!(packed["line"], serde_json::json!([-234.567, 10.0, 100]));
    // 128 m ahead on a circle of 400 m the road has turned aside by 400 (1 - cos 0.32) = 20.3 m.
    let half = packed["half"].as_f64().unwrap() - 3.66 - 1.2;
    assert!((half - 20.3).abs() < 0.5, "{half}");
    let mut reader = Reader::new(packed);
    for (quantum, order) in [(0.01, 2), (0.01, 1), (0.01, 1), (0.1, 1)] {
        reader.column(100, quantum, order);
    }
    for car in packed["cars"].as_array().unwrap() {
        reader.column(index(&car[2]), 0.01, 2);
        reader.column(index(&car[2]), 0.01, 1);
    }
    let east = reader.column(100, POSITION_QUANTUM_M, 2);
    close(&east, (0..100).map(|i| place(i).0), POSITION_QUANTUM_M);
}

#[test]
fn the_same_drives_give_the_same_bytes() {
    let page = || watch_page(&watch(vec![drive(300, 4)]), &Context::synthetic(1), &[]).unwrap();
    assert_eq!(page(), page());
}

#[test]
fn five_ten_minute_drives_in_traffic_stay_small() {
    let bytes = html(vec![drive(12_000, 6); 5]).len();
    assert!(bytes < 1_500_000, "{bytes}");
}

#[test]
fn what_cannot_be_shown_is_refused_by_name() {
    let refused = |change: fn(&mut WatchPlayer)| {
        let mut input = watch(vec![drive(100, 1)]);
        change(&mut input);
        player(&input, &Context::real()).unwrap_err()
    };
    let error = refused(|w| w.drives.clear());
    assert!(matches!(error, ReportError::TooFew { .. }));
    let error = refused(|w| w.name = "Drives of P07".into());
    assert!(matches!(error, ReportError::BadName { .. }));
    let error = refused(|w| w.drives[0].others[0].y_m[3] = f64::NAN);
    assert!(error.to_string().contains("y_m of vehicle 1 of drive Mimic"));
    let error = refused(|w| w.drives[0].speed_mps.truncate(99));
    assert!(error.to_string().contains("speed_mps of drive Mimic"));
    let error = refused(|w| w.drives[0].time_s[50] = 0.0);
    assert!(matches!(error, ReportError::OutOfRange { .. }));
    let error = refused(|w| w.drives[0].ego.x_m[50] = 1e12);
    assert!(error.to_string().contains("within 5000 km"));
    let error = refused(|w| w.drives[0].others[0].first_row = 90);
    assert!(matches!(error, ReportError::LengthMismatch { .. }));
    let error = refused(|w| w.drives[0].lane_width_m = f64::INFINITY);
    assert!(error.to_string().contains("lane_width_m"));
}

#[test]
fn a_car_that_is_passed_in_the_other_lane_is_not_ahead() {
    let shown = |aside_m: f64| {
        let mut one = drive(300, 1);
        one.gap_m = vec![Some(7.0); 300];
        let ego = one.ego.y_m.clone();
        for (y, own) in one.others[0].y_m.iter_mut().zip(&ego) {
            *y = own + aside_m;
        }
        html(vec![one])
    };
    assert!(shown(0.0).contains("7 m to the car ahead"));
    let passing = shown(3.66);
    assert!(passing.contains("7 m to the car in the other lane"), "{passing}");
}

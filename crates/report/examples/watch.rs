//! Writes `watch.html`, a page that plays two made-up drives: `cargo run -p maveric-report --example watch`.

use maveric_domain::{ConditionId, drive::Direction};
use maveric_report::{
    Context,
    html::{ChangeSpan, InterventionSpan, PlayerDrive, Track, WatchPlayer, watch_page},
};

const ROWS: u32 = 600;
const RATE_HZ: f64 = 10.0;

/// A car at a steady speed that moves over to another lane from `start_s` on.
fn track(id: u32, from_m: f64, speed_mps: f64, lane_m: f64, start_s: f64) -> Track {
    let time = || (0..ROWS).map(|row| f64::from(row) / RATE_HZ);
    let over = |t: f64| {
        let share = ((t - start_s) / 4.0).clamp(0.0, 1.0);
        lane_m * share * share * (3.0 - 2.0 * share)
    };
    Track {
        id,
        length_m: 4.7,
        width_m: 1.9,
        first_row: 0,
        x_m: time().map(|t| from_m + speed_mps * t).collect(),
        y_m: time().map(over).collect(),
    }
}

fn drive(condition: ConditionId, label: &str, speed_mps: f64, start_s: f64) -> PlayerDrive {
    let ego = track(0, 0.0, speed_mps, 3.66, start_s);
    let lead = track(1, 80.0, 24.0, 3.66, f64::MAX);
    let ahead: Vec<f64> = lead.x_m.iter().zip(&ego.x_m).map(|(l, e)| l - e).collect();
    let gap = |x: &f64| (x.abs() - 4.7).max(0.0).copysign(*x);
    PlayerDrive {
        label: label.to_owned(),
        note: "made up".to_owned(),
        condition,
        lanes: 2,
        lane_width_m: 3.66,
        centre_line: None,
        time_s: (0..ROWS).map(|row| f64::from(row) / RATE_HZ).collect(),
        segment: vec![0; ROWS as usize],
        speed_mps: vec![speed_mps; ROWS as usize],
        gap_m: ahead.iter().map(|x| Some(gap(x))).collect(),
        reference: vec![Some(1); ROWS as usize],
        ego,
        others: vec![lead],
        lane_changes: vec![ChangeSpan {
            start_s,
            end_s: start_s + 4.0,
            direction: Direction::Left,
        }],
        interventions: Some(vec![InterventionSpan {
            start_s: 40.0,
            end_s: 41.0,
        }]),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let drives = WatchPlayer {
        name: "watch".to_owned(),
        title: "Two made-up drives".to_owned(),
        drives: vec![
            drive(ConditionId::new("faster")?, "Aggressive", 31.0, 7.0),
            drive(ConditionId::new("slower")?, "Cautious", 26.0, 25.0),
        ],
    };
    let page = watch_page(&drives, &Context::synthetic(1), &[])?;
    std::fs::write("watch.html", page)?;
    Ok(())
}

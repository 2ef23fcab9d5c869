//! Ten minutes of passing slower leads.

use maveric_report::figures::time_space::{Decision, DecisionKind, TimeSpace, Track};

/// When each lead is passed, in seconds.
const PASSED: [f64; 6] = [85.0, 170.0, 255.0, 345.0, 440.0, 540.0];

pub(crate) fn input() -> TimeSpace {
    let times = |from: f64, to: f64| {
        (0..1200).map(|k| 0.5 * f64::from(k)).filter(move |t| (from..=to).contains(t))
    };
    let passing = |t: f64| PASSED.iter().any(|passed| (t - passed).abs() < 8.0);
    let ego = |t: f64| 29.0 * t + 35.0 * (t / 45.0).sin();
    let track = |from: f64, to: f64, x: &dyn Fn(f64) -> f64, lane: &dyn Fn(f64) -> u8| Track {
        time_s: times(from, to).collect(),
        x_m: times(from, to).map(x).collect(),
        lane: times(from, to).map(lane).collect(),
    };
    let lead = |passed: f64| {
        let x = move |t: f64| ego(passed) + 26.2 * (t - passed);
        track(passed - 70.0, passed + 60.0, &x, &|_| 0)
    };
    let other = |met: f64| {
        let x = move |t: f64| ego(met) + 32.5 * (t - met);
        track(met - 60.0, met + 60.0, &x, &|_| 1)
    };
    let decision = |passed: &f64| {
        [(-9.0, DecisionKind::LaneChange), (8.5, DecisionKind::MergeBack)]
            .map(|(after, kind)| Decision { time_s: passed + after, kind })
    };
    let mut decisions: Vec<Decision> = PASSED.iter().flat_map(decision).collect();
    decisions.push(Decision { time_s: 318.0, kind: DecisionKind::Safety });
    TimeSpace {
        drive: "P07-mimic".into(),
        condition: super::conditions()[0],
        ego: track(0.0, 600.0, &ego, &|t| u8::from(passing(t))),
        leads: PASSED.map(lead).to_vec(),
        others: [40.0, 130.0, 320.0, 410.0, 500.0].map(other).to_vec(),
        decisions,
    }
}

//! Speed and gap over time as SVG that stretches with the page: no text, lines that keep their width.

use super::pack::{SAMPLES_PER_S, Sampled};
use maveric_domain::SpeedUnit;
use std::fmt::Write as _;

/// Size of the picture, in its own units.
const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 64.0;
/// Where speed and gap are drawn, from top to bottom.
const SPEED: (f64, f64) = (3.0, 29.0);
const GAP: (f64, f64) = (36.0, 62.0);
/// Points that a line has at most.
const MOST_POINTS: usize = 600;
/// Gaps above this are not drawn, in m.
pub(super) const GAP_AXIS_M: f64 = 120.0;

/// What all rows share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Axes {
    /// The longest drive, in s.
    pub(super) duration_s: f64,
    /// Time between two grid lines, in s.
    pub(super) step_s: f64,
    /// In which unit speeds are read.
    pub(super) unit: SpeedUnit,
    /// Lowest and highest speed in it, multiples of 10.
    pub(super) speed: (f64, f64),
}

/// The moment, as a sample, at which most drives have a vehicle ahead at 5 to 60 m; the first of them, on a whole second.
pub(super) fn moment(drives: &[Sampled]) -> usize {
    let second = SAMPLES_PER_S as usize;
    let longest = drives.iter().map(|d| d.samples).max().unwrap_or(0);
    let near = |drive: &&Sampled, sample: usize| {
        let gap = drive.gap_m.get(sample).copied().flatten();
        gap.is_some_and(|gap| (5.0..60.0).contains(&gap))
    };
    let count = |sample: usize| drives.iter().filter(|d| near(d, sample)).count();
    let mut best = (0, 0);
    for sample in (0..longest).step_by(second) {
        let near_count = count(sample);
        if near_count > best.1 {
            best = (sample, near_count);
        }
    }
    best.0
}

impl Axes {
    pub(super) fn new(drives: &[Sampled], unit: SpeedUnit) -> Self {
        let longest = drives.iter().map(|d| d.samples - 1).max().unwrap_or(0);
        let duration_s = (longest as f64 / SAMPLES_PER_S).max(1.0 / SAMPLES_PER_S);
        let steps = [1.0, 5.0, 10.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0];
        let fits = steps.into_iter().find(|step| duration_s / step <= 10.5);
        let speeds = || {
            let speeds_of = |d: &Sampled| {
                let there = (0..d.samples).filter(|&i| d.has(i));
                there.map(|i| d.speed_mps[i] * unit.per_mps()).collect::<Vec<_>>()
            };
            drives.iter().flat_map(speeds_of)
        };
        let low = (speeds().fold(f64::MAX, f64::min) / 10.0).floor() * 10.0;
        let high = (speeds().fold(f64::MIN, f64::max) / 10.0).ceil() * 10.0;
        Self {
            duration_s,
            step_s: fits.unwrap_or(7200.0),
            unit,
            speed: (low, high.max(low + 10.0)),
        }
    }

    /// Times of the grid lines, in s.
    pub(super) fn ticks(&self) -> Vec<f64> {
        let count = (self.duration_s / self.step_s + 1e-9).floor() as usize;
        (0..=count).map(|i| i as f64 * self.step_s).collect()
    }
}

/// Draws one drive's speed and gap.
pub(super) fn timeline(sampled: &Sampled, axes: &Axes) -> String {
    let mut out = format!(
        "<svg class=\"pl-lines\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" preserveAspectRatio=\"none\" aria-hidden=\"true\" focusable=\"false\">"
    );
    let x = |s: f64| s / axes.duration_s * WIDTH;
    out.push_str("<path class=\"pl-grid\" d=\"");
    for tick in axes.ticks() {
        let _ = write!(out, "M{:.1} 0V{HEIGHT}", x(tick));
    }
    for y in [SPEED.0, SPEED.1, GAP.0, GAP.1] {
        let _ = write!(out, "M0 {y}H{WIDTH}");
    }
    out.push_str("\"/>");
    let stride = sampled.samples.div_ceil(MOST_POINTS).max(SAMPLES_PER_S as usize / 2);
    let (low, high) = axes.speed;
    let height = |(top, bottom): (f64, f64), share: f64| bottom - share * (bottom - top);
    let speed = |i: usize| {
        let read = sampled.speed_mps[i] * axes.unit.per_mps();
        sampled.has(i).then(|| height(SPEED, (read - low) / (high - low)))
    };
    let gap = |i: usize| {
        let gap = sampled.gap_m[i].filter(|gap| sampled.has(i) && (0.0..=GAP_AXIS_M).contains(gap));
        gap.map(|gap| height(GAP, gap / GAP_AXIS_M))
    };
    line(&mut out, "pl-speed", sampled.samples, stride, axes, speed);
    line(&mut out, "pl-gaps", sampled.samples, stride, axes, gap);
    out.push_str("</svg>");
    out
}

fn line(
    out: &mut String,
    class: &str,
    samples: usize,
    stride: usize,
    axes: &Axes,
    height: impl Fn(usize) -> Option<f64>,
) {
    let _ = write!(out, "<path class=\"{class}\" d=\"");
    let mut drawing = false;
    for i in (0..samples).step_by(stride) {
        let Some(y) = height(i) else {
            drawing = false;
            continue;
        };
        let letter = if drawing { 'L' } else { 'M' };
        let x = i as f64 / SAMPLES_PER_S / axes.duration_s * WIDTH;
        let _ = write!(out, "{letter}{x:.1} {y:.1}");
        drawing = true;
    }
    out.push_str("\"/>");
}

#[cfg(test)]
mod tests {
    use super::super::pack::Run;
    use super::*;

    /// A drive of these speeds (mph) and gaps, with a hole from `hole` on of two samples.
    fn sampled(speed_mph: &[f64], gap_m: &[Option<f64>], hole: usize) -> Sampled {
        let n = speed_mph.len();
        let behind = hole + 2;
        Sampled {
            samples: n,
            runs: vec![Run { first: 0, count: hole }, Run { first: behind, count: n - behind }],
            x_m: vec![0.0; n],
            y_m: vec![0.0; n],
            speed_mps: speed_mph.iter().map(|v| v / SpeedUnit::Mph.per_mps()).collect(),
            gap_m: gap_m.to_vec(),
            reference: vec![None; n],
            seen: Vec::new(),
        }
    }

    #[test]
    fn all_rows_share_the_longest_time_and_speeds_in_tens() {
        let short = sampled(&[44.0, 52.0, 1.0, 99.0, 61.0], &[None; 5], 2);
        let axes = Axes::new(std::slice::from_ref(&short), SpeedUnit::Mph);
        assert!((axes.duration_s - 0.8).abs() < 1e-12);
        // Within the hole speeds mean nothing.
        assert_eq!((axes.speed, axes.step_s), ((40.0, 70.0), 1.0));
        assert_eq!(axes.ticks(), [0.0]);
        let long = sampled(&vec![50.0; 5 * 60 + 1], &vec![None; 5 * 60 + 1], 9);
        let axes = Axes::new(&[short, long.clone()], SpeedUnit::Mph);
        assert_eq!((axes.duration_s, axes.step_s), (60.0, 10.0));
        assert_eq!(axes.ticks(), [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0]);
        // Even speeds still have a height; nobody has a moment.
        assert_eq!(Axes::new(&[long], SpeedUnit::Mph).speed, (50.0, 60.0));
        assert!((Axes::new(&[], SpeedUnit::Mph).duration_s - 0.2).abs() < 1e-12);
    }

    #[test]
    fn lines_are_drawn_where_time_speed_and_gap_say_and_stop_at_holes() {
        let speed: Vec<f64> = (0..21).map(|i| 40.0 + f64::from(i)).collect();
        let mut gap = vec![Some(60.0); 21];
        (gap[16], gap[18], gap[20]) = (None, Some(121.0), Some(-1.0));
        let drive = sampled(&speed, &gap, 9);
        let axes = Axes::new(std::slice::from_ref(&drive), SpeedUnit::Mph);
        assert_eq!((axes.duration_s, axes.speed), (4.0, (40.0, 60.0)));
        let svg = timeline(&drive, &axes);
        let path = |class: &str| {
            let start = svg.find(&format!("class=\"{class}\" d=\"")).unwrap();
            let rest = &svg[start..];
            let from = rest.find(" d=\"").unwrap() + 4;
            rest[from..from + rest[from..].find('"').unwrap()].to_owned()
        };
        // Every second sample, 0.4 s apart: 100 units; speed from 29 up to 3, the hole at samples 9 and 10.
        let y = |i: f64| 29.0 - 26.0 * i / 20.0;
        let mut expected = String::new();
        for i in (0..21).step_by(2).filter(|i| *i != 10) {
            let letter = if i == 0 || i == 12 { 'M' } else { 'L' };
            let _ = write!(expected, "{letter}{:.1} {:.1}", 50.0 * f64::from(i), y(f64::from(i)));
        }
        assert_eq!(path("pl-speed"), expected);
        let expected =
            "M0.0 49.0L100.0 49.0L200.0 49.0L300.0 49.0L400.0 49.0M600.0 49.0L700.0 49.0";
        assert_eq!(path("pl-gaps"), expected);
        let grid = "M0.0 0V64M250.0 0V64M500.0 0V64M750.0 0V64M1000.0 0V64M0 3H1000M0 29H1000M0 36H1000M0 62H1000";
        assert_eq!(path("pl-grid"), grid);
    }

    #[test]
    fn the_moment_is_the_first_whole_second_at_which_most_follow_somebody() {
        let of = |gap: &dyn Fn(usize) -> f64| {
            let gap_m: Vec<_> = (0..51).map(|i| Some(gap(i))).collect();
            sampled(&[50.0; 51], &gap_m, 49)
        };
        let first = of(&|i| if i < 11 { 61.0 } else { 20.0 });
        let second = of(&|i| if i < 21 { 4.9 } else { 5.0 });
        assert_eq!(moment(std::slice::from_ref(&first)), 15);
        assert_eq!(moment(&[first, second]), 25);
        assert_eq!(moment(&[of(&|_| 60.0)]), 0);
        assert_eq!(moment(&[]), 0);
    }
}

//! What is seen of the road, in metres around ego: forward and to the left.

use super::drive::{CentreLine, PlayerDrive};

/// What a wide picture shows behind ego and ahead, in m.
pub(super) const SHOWN_M: (f64, f64) = (72.0, 128.0);
/// Widths are drawn this many times as large as lengths, on a straight road.
pub(super) const STRETCH: f64 = 1.6;
/// Ground beside the road, in m.
const VERGE_M: f64 = 1.2;
/// A curve leaves the picture sideways at this, in m.
const MOST_SIDEWAYS_M: f64 = 36.0;

impl CentreLine {
    fn place(&self, index: usize) -> (f64, f64) {
        self.map_m[index.min(self.map_m.len() - 1)]
    }

    /// Place on the map (m) and heading (rad) of the line at `x_m`; beyond its ends it goes on straight.
    pub(super) fn at(&self, x_m: f64) -> (f64, f64, f64) {
        let last = self.map_m.len() - 1;
        let position = (x_m - self.start_m) / self.step_m;
        let index = (position.max(0.0) as usize).min(last - 1);
        let share = position - index as f64;
        let (a, b) = (self.place(index), self.place(index + 1));
        let heading = |i: usize| {
            let (a, b) = (self.place(i.saturating_sub(1)), self.place(i + 1));
            libm::atan2(b.1 - a.1, b.0 - a.0)
        };
        let (from, to) = (heading(index), heading(index + 1));
        let turn = (to - from + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1), from + share.clamp(0.0, 1.0) * turn)
    }
}

/// Lateral position of the middle of the road, in m.
pub(super) fn middle_m(drive: &PlayerDrive) -> f64 {
    0.5 * (f64::from(drive.lanes) - 1.0) * drive.lane_width_m
}

/// How far a place of the road lies to the left, seen along the road at `from_m`, in m.
fn aside_m(line: &CentreLine, from_m: f64, x_m: f64) -> f64 {
    let (here, there) = (line.at(from_m), line.at(x_m));
    let (sin, cos) = libm::sincos(here.2);
    (there.1 - here.1) * cos - (there.0 - here.0) * sin
}

/// How far the picture reaches to each side of the middle of the road, in m.
pub(super) fn half_height_m(drive: &PlayerDrive) -> f64 {
    let straight = 0.5 * f64::from(drive.lanes) * drive.lane_width_m + VERGE_M;
    let Some(line) = &drive.centre_line else {
        return straight;
    };
    let sideways = (0..line.map_m.len()).map(|i| {
        let x_m = line.start_m + i as f64 * line.step_m;
        let ahead = aside_m(line, x_m, x_m + SHOWN_M.1).abs();
        ahead.max(aside_m(line, x_m, x_m - SHOWN_M.0).abs())
    });
    straight + sideways.fold(0.0, f64::max).min(MOST_SIDEWAYS_M)
}

/// Times as wide as long.
pub(super) fn stretch(drive: &PlayerDrive) -> f64 {
    if drive.centre_line.is_some() { 1.0 } else { STRETCH }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// A left-hand bend of 200 m: the line's places are on a circle.
    fn bend() -> CentreLine {
        let place = |i: u32| {
            let angle = f64::from(i) / 200.0;
            (1000.0 + 200.0 * angle.sin(), 50.0 + 200.0 * (1.0 - angle.cos()))
        };
        CentreLine { start_m: 30.0, step_m: 1.0, map_m: (0..=400).map(place).collect() }
    }

    fn near(found: (f64, f64, f64), expected: (f64, f64, f64)) {
        let apart = [found.0 - expected.0, found.1 - expected.1, 50.0 * (found.2 - expected.2)];
        assert!(apart.iter().all(|d| d.abs() < 0.02), "{found:?} instead of {expected:?}");
    }

    #[test]
    fn along_a_circle_the_line_turns_evenly_and_goes_on_straight_at_its_ends() {
        let line = bend();
        for s in [20.0, 100.25, 300.5] {
            let angle: f64 = s / 200.0;
            let expected =
                (1000.0 + 200.0 * angle.sin(), 50.0 + 200.0 * (1.0 - angle.cos()), angle);
            near(line.at(30.0 + s), expected);
        }
        let (east, north, heading) = line.at(20.0);
        assert!((east - 990.0).abs() < 0.1 && (north - 50.0).abs() < 0.1 && heading.abs() < 0.01);
        // The last piece's direction is that of its middle.
        let (end, turned) = (line.at(430.0), 2.0_f64 - 0.5 / 200.0);
        let beyond = (end.0 + 10.0 * turned.cos(), end.1 + 10.0 * turned.sin(), turned);
        near(line.at(440.0), beyond);
    }

    #[test]
    fn what_lies_on_a_circle_is_seen_to_the_left() {
        let line = bend();
        for s in [-60.0, 0.0, 45.0, 200.0] {
            let expected = 200.0 * (1.0 - (s / 200.0_f64).cos());
            let found = aside_m(&line, 130.0, 130.0 + s);
            assert!((found - expected).abs() < 0.02, "{s}: {found}");
        }
    }

    #[test]
    fn a_line_that_turns_past_west_does_not_turn_back() {
        // Headings from 3.0 up to 3.3 rad, which is −2.98.
        let mut at = (0.0, 0.0);
        let map_m = (0..=30).map(|i| {
            let heading = 3.0 + 0.01 * f64::from(i);
            let here = at;
            at = (at.0 + heading.cos(), at.1 + heading.sin());
            here
        });
        let line = CentreLine { start_m: 0.0, step_m: 1.0, map_m: map_m.collect() };
        for x in 1..29 {
            let (_, _, heading) = line.at(f64::from(x) + 0.5);
            let expected: f64 = 3.0 + 0.01 * f64::from(x);
            let apart = (heading - expected + PI).rem_euclid(2.0 * PI) - PI;
            assert!(apart.abs() < 0.02, "{x}: {heading}");
        }
        assert!(FRAC_PI_2 < line.at(1.0).2);
    }
}

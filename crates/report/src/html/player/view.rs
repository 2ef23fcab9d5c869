//! What is seen of the road, in metres around ego: forward and to the left.

use super::drive::{CentreLine, PlayerDrive};

/// What a still shows behind ego and ahead, in m.
pub(super) const STILL_M: (f64, f64) = (72.0, 128.0);
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
        let at = (x_m - self.start_m) / self.step_m;
        let index = (at.max(0.0) as usize).min(last - 1);
        let share = at - index as f64;
        let (a, b) = (self.place(index), self.place(index + 1));
        let heading = |i: usize| {
            let (a, b) = (self.place(i.saturating_sub(1)), self.place(i + 1));
            libm::atan2(b.1 - a.1, b.0 - a.0)
        };
        let (from, to) = (heading(index), heading(index + 1));
        let turn = (to - from + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        (
            a.0 + share * (b.0 - a.0),
            a.1 + share * (b.1 - a.1),
            from + share.clamp(0.0, 1.0) * turn,
        )
    }
}

/// The picture around a place of the road.
#[derive(Debug, Clone, Copy)]
pub(super) struct View<'a> {
    line: Option<&'a CentreLine>,
    x_m: f64,
    middle_m: f64,
}

/// Lateral position of the middle of the road, in m.
pub(super) fn middle_m(drive: &PlayerDrive) -> f64 {
    0.5 * (f64::from(drive.lanes) - 1.0) * drive.lane_width_m
}

impl<'a> View<'a> {
    pub(super) fn new(drive: &'a PlayerDrive, x_m: f64) -> Self {
        Self {
            line: drive.centre_line.as_ref(),
            x_m,
            middle_m: middle_m(drive),
        }
    }

    /// Metres forward of ego and to the left of the middle of the road, and how far the road has turned, in rad.
    pub(super) fn see(&self, x_m: f64, y_m: f64) -> (f64, f64, f64) {
        let Some(line) = self.line else {
            return (x_m - self.x_m, y_m - self.middle_m, 0.0);
        };
        let on_map = |x_m: f64, y_m: f64| {
            let (east, north, heading) = line.at(x_m);
            (
                east - y_m * libm::sin(heading),
                north + y_m * libm::cos(heading),
                heading,
            )
        };
        let here = on_map(self.x_m, self.middle_m);
        let there = on_map(x_m, y_m);
        let (dx, dy) = (there.0 - here.0, there.1 - here.1);
        let (sin, cos) = libm::sincos(here.2);
        (dx * cos + dy * sin, dy * cos - dx * sin, there.2 - here.2)
    }
}

/// How far the picture reaches to each side of the middle of the road, in m.
pub(super) fn half_height_m(drive: &PlayerDrive) -> f64 {
    let straight = 0.5 * f64::from(drive.lanes) * drive.lane_width_m + VERGE_M;
    let Some(line) = &drive.centre_line else {
        return straight;
    };
    let sideways = (0..line.map_m.len()).map(|i| {
        let x_m = line.start_m + i as f64 * line.step_m;
        let view = View {
            line: Some(line),
            x_m,
            middle_m: 0.0,
        };
        let ahead = view.see(x_m + STILL_M.1, 0.0).1.abs();
        ahead.max(view.see(x_m - STILL_M.0, 0.0).1.abs())
    });
    straight + sideways.fold(0.0, f64::max).min(MOST_SIDEWAYS_M)
}

/// Times as wide as long.
pub(super) fn stretch(drive: &PlayerDrive) -> f64 {
    if drive.centre_line.is_some() {
        1.0
    } else {
        STRETCH
    }
}

//! The controller whose parameters the network gives.
#![allow(
    clippy::inline_always,
    reason = "code for one processor must be inlined into the function compiled for it"
)]

use super::layout::OUTPUTS;
use maveric_laws::{LEAST_GAP_M, Rss};
use serde::{Deserialize, Serialize};

/// Where the outputs are 0: 1.5 s, 2 m, 1 m/s² and 0.4 s²/m, an unremarkable driver.
const USUAL: [f64; OUTPUTS] = [1.5, 2.0, 1.0, 0.4];

/// Mean and standard deviation of the speed that the network reads.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Scaling {
    pub(super) speed_mean_mps: f64,
    pub(super) speed_sd_mps: f64,
}

impl Scaling {
    /// What the network reads.
    #[inline(always)]
    pub(super) fn input(&self, speed: f64) -> f64 {
        (speed - self.speed_mean_mps) / self.speed_sd_mps
    }
}

/// What the network asks of the controller at one moment; all above 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parameters {
    time_gap_s: f64,
    standstill_gap_m: f64,
    accel_mps2: f64,
    closing_s2_per_m: f64,
}

/// Derivatives by what went in.
pub(super) struct Back {
    pub(super) gap: f64,
    pub(super) speed: f64,
    pub(super) outputs: [f64; OUTPUTS],
}

impl Parameters {
    #[inline(always)]
    pub(super) fn of(outputs: [f64; OUTPUTS]) -> Self {
        let [t, s, a, c] = std::array::from_fn(|k| USUAL[k] * positive(outputs[k]));
        Self {
            time_gap_s: t,
            standstill_gap_m: s,
            accel_mps2: a,
            closing_s2_per_m: c,
        }
    }

    /// The wanted gap without regard to closing, in m.
    pub(super) fn following_distance_m(&self, speed: f64) -> f64 {
        self.standstill_gap_m + speed * self.time_gap_s
    }

    /// a·(1 - (s*/gap)²), s* = s0 + max(0, v·T + c·v·(v - v_lead)), and never more than the safety bound allows.
    #[inline(always)]
    pub(super) fn accel_mps2(&self, safety: &Rss, gap: f64, v: f64, lead: f64) -> f64 {
        let wanted = self.standstill_gap_m + self.moving_m(v, lead).max(0.0);
        let ratio = wanted / gap.max(LEAST_GAP_M);
        let steering = self.accel_mps2 * (1.0 - ratio * ratio);
        let most = safety.most_accel_mps2(gap, v, lead);
        if steering > most { most } else { steering }
    }

    /// From the derivative by the acceleration to those by gap, speed and the network's outputs.
    #[inline(always)]
    pub(super) fn back(
        &self,
        outputs: [f64; OUTPUTS],
        safety: &Rss,
        (gap, v, lead): (f64, f64, f64),
        d_accel: f64,
    ) -> Back {
        let moving = self.moving_m(v, lead);
        let wanted = self.standstill_gap_m + moving.max(0.0);
        let seen = gap.max(LEAST_GAP_M);
        let ratio = wanted / seen;
        let steering = self.accel_mps2 * (1.0 - ratio * ratio);
        // Where the safety bound drives, nothing that the network says does.
        let bound = steering > safety.most_accel_mps2(gap, v, lead);
        let steered = if bound { 0.0 } else { d_accel };
        let d_ratio = -2.0 * self.accel_mps2 * ratio * steered;
        let d_wanted = d_ratio / seen;
        let d_gap = if gap > LEAST_GAP_M {
            -d_ratio * ratio / seen
        } else {
            0.0
        };
        let d_moving = if moving > 0.0 { d_wanted } else { 0.0 };
        let c = self.closing_s2_per_m;
        let d = [
            d_moving * v,
            d_wanted,
            steered * (1.0 - ratio * ratio),
            d_moving * v * (v - lead),
        ];
        let by_gap = safety.safe_speed_slope_per_s(gap, lead) / safety.reaction_s;
        let (gap, speed) = if bound {
            (d_accel * by_gap, -d_accel / safety.reaction_s)
        } else {
            (d_gap, d_moving * (self.time_gap_s + c * (2.0 * v - lead)))
        };
        Back {
            gap,
            speed,
            outputs: std::array::from_fn(|k| d[k] * USUAL[k] * positive_slope(outputs[k])),
        }
    }

    #[inline(always)]
    fn moving_m(&self, v: f64, lead: f64) -> f64 {
        v * (self.time_gap_s + self.closing_s2_per_m * (v - lead))
    }
}

/// x + √(1 + x²): above 0, 1 at 0, and like an exponential but for its growth.
#[inline(always)]
fn positive(x: f64) -> f64 {
    // The two are equal; the sum loses its digits below 0.
    let sum = x.abs() + (1.0 + x * x).sqrt();
    if x < 0.0 { 1.0 / sum } else { sum }
}

#[inline(always)]
fn positive_slope(x: f64) -> f64 {
    positive(x) / (1.0 + x * x).sqrt()
}

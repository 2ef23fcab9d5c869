//! The controller whose parameters the network gives.
#![allow(
    clippy::inline_always,
    reason = "code for one processor must be inlined into the function compiled for it"
)]

use super::{
    lanes::{Lanes, lanes, nothing},
    layout::OUTPUTS,
};
use maveric_laws::{LEAST_GAP_M, Real, Rss};
use serde::{Deserialize, Serialize};

/// Where the outputs are 0: 1.5 s, 2 m, 1 m/s² and 0.4 s²/m, an unremarkable driver.
const USUAL: [f64; OUTPUTS] = [1.5, 2.0, 1.0, 0.4];

/// Mean and standard deviation of the speed that the network reads.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Scaling<T = f64> {
    pub(super) speed_mean_mps: T,
    pub(super) speed_sd_mps: T,
}

impl<T: Real> Scaling<T> {
    /// What the network reads.
    #[inline(always)]
    pub(super) fn input(&self, speed: T) -> T {
        (speed - self.speed_mean_mps) / self.speed_sd_mps
    }
}

/// What the network asks of the controller at one moment; all above 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parameters<T> {
    pub(super) time_gap_s: T,
    pub(super) standstill_gap_m: T,
    pub(super) accel_mps2: T,
    pub(super) closing_s2_per_m: T,
}

/// Derivatives by what went in.
pub(super) struct Back<T> {
    pub(super) gap: T,
    pub(super) speed: T,
    /// By each parameter, in the order of the network's outputs.
    pub(super) parameters: [T; OUTPUTS],
}

impl<T: Real> Parameters<T> {
    /// In the order of the network's outputs.
    #[inline(always)]
    pub(super) fn from_array(
        [time_gap_s, standstill_gap_m, accel_mps2, closing_s2_per_m]: [T; OUTPUTS],
    ) -> Self {
        Self {
            time_gap_s,
            standstill_gap_m,
            accel_mps2,
            closing_s2_per_m,
        }
    }

    /// The wanted gap without regard to closing, in m.
    pub(super) fn following_distance_m(&self, speed: T) -> T {
        self.standstill_gap_m + speed * self.time_gap_s
    }

    /// a·(1 - (s*/gap)²), s* = s0 + max(0, v·T + c·v·(v - v_lead)), and never more than the safety bound allows.
    #[inline(always)]
    pub(super) fn accel_mps2(&self, safety: &Rss<T>, gap: T, v: T, lead: T) -> T {
        let wanted = self.standstill_gap_m + self.moving_m(v, lead).max(T::of(0.0));
        let ratio = wanted / gap.max(T::of(LEAST_GAP_M));
        let steering = self.accel_mps2 * (T::of(1.0) - ratio * ratio);
        let most = safety.most_accel_mps2(gap, v, lead);
        if steering > most { most } else { steering }
    }

    /// From the derivative by the acceleration to those by gap, speed and the parameters.
    #[inline(always)]
    pub(super) fn back(&self, safety: &Rss<T>, (gap, v, lead): (T, T, T), d_accel: T) -> Back<T> {
        let (zero, one, two) = (T::of(0.0), T::of(1.0), T::of(2.0));
        let moving = self.moving_m(v, lead);
        let wanted = self.standstill_gap_m + moving.max(zero);
        let seen = gap.max(T::of(LEAST_GAP_M));
        let ratio = wanted / seen;
        let steering = self.accel_mps2 * (one - ratio * ratio);
        // Where the safety bound drives, nothing that the network says does.
        let bound = steering > safety.most_accel_mps2(gap, v, lead);
        let steered = if bound { zero } else { d_accel };
        let d_ratio = -two * self.accel_mps2 * ratio * steered;
        let d_wanted = d_ratio / seen;
        let d_gap = if gap > T::of(LEAST_GAP_M) {
            -d_wanted * ratio
        } else {
            zero
        };
        let d_moving = if moving > zero { d_wanted } else { zero };
        let c = self.closing_s2_per_m;
        let by_gap = safety.safe_speed_slope_per_s(gap, lead) / safety.reaction_s;
        let (gap, speed) = if bound {
            (d_accel * by_gap, -d_accel / safety.reaction_s)
        } else {
            (d_gap, d_moving * (self.time_gap_s + c * (two * v - lead)))
        };
        Back {
            gap,
            speed,
            parameters: [
                d_moving * v,
                d_wanted,
                steered * (one - ratio * ratio),
                d_moving * v * (v - lead),
            ],
        }
    }

    #[inline(always)]
    fn moving_m(&self, v: T, lead: T) -> T {
        v * (self.time_gap_s + self.closing_s2_per_m * (v - lead))
    }
}

/// What the outputs of the network stand for in each lane, and how that changes with them: x + √(1 + x²), above 0, 1 at 0, and like an
/// exponential but for its growth.
#[inline(always)]
pub(super) fn of_outputs<T: Real, const N: usize>(
    outputs: &[Lanes<T, N>; OUTPUTS],
) -> [[Lanes<T, N>; OUTPUTS]; 2] {
    let one = T::of(1.0);
    let [mut values, mut slopes] = [[nothing(); OUTPUTS]; 2];
    let both = values
        .as_flattened_mut()
        .iter_mut()
        .zip(slopes.as_flattened_mut());
    for (&x, (value, slope)) in outputs.as_flattened().iter().zip(both) {
        let root = (one + x * x).sqrt();
        let sum = x.abs() + root;
        // One division for one over the root and one over the sum.
        let over = one / (sum * root);
        // The sum loses its digits below 0, where one over it without the sign is the same.
        *value = if x < T::of(0.0) { over * root } else { sum };
        *slope = *value * (over * sum);
    }
    for k in 0..OUTPUTS {
        let usual = T::of(USUAL[k]);
        values[k] = lanes(&values[k], &values[k], |value, _| usual * value);
        slopes[k] = lanes(&slopes[k], &slopes[k], |slope, _| usual * slope);
    }
    [values, slopes]
}

//! The laws that are fitted: what drives in a driver's place by a few numbers.

use crate::run::Stretch;
pub use maveric_laws::{Gains, Gipps, Helly, Idm};
use serde::{Deserialize, Serialize};

/// A law with its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Law {
    /// Newell's rule.
    Newell(Newell),
    /// Helly's linear law; from 0 m on, a constant time gap.
    Helly(Helly),
    /// Gipps' law.
    Gipps(Gipps),
    /// The Intelligent Driver Model.
    Idm(Idm),
}

/// Newell's rule: ego drives where the leader was, `delay_s` ago and `distance_m` further back.
///
/// # Source
/// Newell 2002.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Newell {
    /// How much later ego is where the leader was, in s.
    pub delay_s: f64,
    /// Distance, bumper to bumper, in m.
    pub distance_m: f64,
}

/// Gains of the adaptive cruise control of Milanés and Shladover 2014: 0.23 1/s² on the gap, 0.07 1/s on the speed.
pub const TIME_GAP_GAINS: Gains = Gains {
    speed_per_s: 0.07,
    gap_per_s2: 0.23,
};

impl Law {
    /// One time gap (s) at every speed, kept by [`TIME_GAP_GAINS`].
    pub fn constant_time_gap(time_gap_s: f64) -> Self {
        Self::Helly(Helly {
            gains: TIME_GAP_GAINS,
            standstill_gap_m: 0.0,
            time_gap_s,
        })
    }

    /// The law to be asked once for each row of `stretch` but the last, in order: from gap (m), ego speed and lead speed
    /// (m/s) to an acceleration (m/s²), as [`simulate`](crate::simulate) does.
    pub fn driving<'a>(self, stretch: &'a Stretch<'_>) -> impl FnMut(f64, f64, f64) -> f64 + 'a {
        let mut row = stretch.rows.start;
        move |gap_m, ego_mps, lead_mps| {
            row += 1;
            match self {
                Self::Newell(law) => law.accel_mps2(stretch, row, gap_m, ego_mps),
                Self::Helly(law) => law.accel_mps2(gap_m, ego_mps, lead_mps),
                Self::Gipps(law) => law.accel_mps2(gap_m, ego_mps, lead_mps),
                Self::Idm(law) => law.accel_mps2(gap_m, ego_mps, lead_mps),
            }
        }
    }
}

impl Newell {
    /// Acceleration that ends at `row`, in m/s².
    #[inline]
    pub(crate) fn accel_mps2(
        self,
        stretch: &Stretch<'_>,
        row: usize,
        gap_m: f64,
        ego_mps: f64,
    ) -> f64 {
        let ego_x_m = stretch.run.columns().leader_x_m[row - 1] - gap_m;
        let to_go_m = self.leader_x_m(stretch, row) - self.distance_m - ego_x_m;
        maveric_laws::newell_accel_mps2(to_go_m, ego_mps, 1.0 / stretch.run.rate_hz())
    }

    /// Where the leader was `delay_s` before `row`: its recorded past where there is one; before the first row of the run
    /// it is taken to have kept its first speed.
    fn leader_x_m(self, stretch: &Stretch<'_>, row: usize) -> f64 {
        let columns = stretch.run.columns();
        let then = row as f64 - self.delay_s * stretch.run.rate_hz();
        if then <= 0.0 {
            let before_s = then / stretch.run.rate_hz();
            return columns.leader_x_m[0] + before_s * columns.lead_speed_mps[0];
        }
        let (before, share) = (then.floor() as usize, then.fract());
        let low = columns.leader_x_m[before];
        let high = columns.leader_x_m[(before + 1).min(row)];
        low + share * (high - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{simulate, testing};

    #[test]
    fn by_newell_ego_ends_where_the_leader_was() {
        let lead = |t: f64| 12.0 + 3.0 * (t / 9.0).sin();
        let run = testing::behind("P01", 1200, 25.0, 12.0, lead);
        let newell = Law::Newell(Newell {
            delay_s: 1.25,
            distance_m: 6.0,
        });
        let test = run.test();
        let driven = simulate(&test, "newell", newell.driving(&test)).unwrap();
        let x = &run.columns().leader_x_m;
        let last = run.rows() - 1;
        let ego_x = x[last] - driven.gap_m.last().unwrap();
        let delayed = 0.5 * (x[last - 12] + x[last - 13]);
        assert!((ego_x - (delayed - 6.0)).abs() < 0.1);
    }

    #[test]
    fn a_constant_time_gap_is_kept_at_every_speed() {
        for speed in [8.0, 20.0] {
            let run = testing::behind("P01", 3000, 20.0, speed, |_| speed);
            let test = run.test();
            let law = Law::constant_time_gap(1.5);
            let driven = simulate(&test, "time gap", law.driving(&test)).unwrap();
            assert!((driven.gap_m.last().unwrap() - 1.5 * speed).abs() < 0.01);
        }
    }
}

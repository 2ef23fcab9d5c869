//! Newell's rule.

use crate::run::Stretch;
use serde::{Deserialize, Serialize};

/// Newell's rule: ego drives where the leader was, `delay_s` ago and `distance_m` further back.
///
/// # Source
/// Newell 2002. The bounds of the calibration are ours: 0.1-4 s and 0-30 m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Newell {
    /// Delay, in s.
    pub delay_s: f64,
    /// Distance, bumper to bumper, in m.
    pub distance_m: f64,
}

impl Newell {
    pub(crate) const BOUNDS: &'static [(f64, f64)] = &[(0.1, 4.0), (0.0, 30.0)];

    /// The rule as a law to be asked once for each row of `stretch` but the last, in order; in m/s².
    ///
    /// The leader's recorded past before the stretch is used where there is one; before the first row of the run the
    /// leader is taken to have kept its first speed.
    pub fn law<'a>(self, stretch: &'a Stretch<'_>) -> impl FnMut(f64, f64, f64) -> f64 + 'a {
        let step_s = 1.0 / stretch.run.rate_hz();
        let mut row = stretch.rows.start;
        move |gap_m, ego_speed_mps, _lead_speed_mps| {
            let columns = stretch.run.columns();
            let ego_x_m = columns.leader_x_m[row] - gap_m;
            row += 1;
            let wanted_x_m = self.leader_x_m(stretch, row) - self.distance_m;
            // A mean speed that leads there within the step would swing about; as the next speed it does not.
            ((wanted_x_m - ego_x_m) / step_s - ego_speed_mps) / step_s
        }
    }

    /// Where the leader was `delay_s` before `row`.
    fn leader_x_m(self, stretch: &Stretch<'_>, row: usize) -> f64 {
        let columns = stretch.run.columns();
        let at = row as f64 - self.delay_s * stretch.run.rate_hz();
        if at <= 0.0 {
            let before_s = at / stretch.run.rate_hz();
            return columns.leader_x_m[0] + before_s * columns.lead_speed_mps[0];
        }
        let (before, share) = (at.floor() as usize, at.fract());
        let low = columns.leader_x_m[before];
        let high = columns.leader_x_m[(before + 1).min(row)];
        low + share * (high - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{made_up, simulate};

    #[test]
    fn ego_ends_where_the_leader_was() {
        let lead = |t: f64| 12.0 + 3.0 * (t / 9.0).sin();
        let run = made_up::behind("P01", 1200, 25.0, 12.0, lead);
        let newell = Newell {
            delay_s: 1.25,
            distance_m: 6.0,
        };
        let test = run.test();
        let driven = simulate(&test, "newell", newell.law(&test)).unwrap();
        let x = &run.columns().leader_x_m;
        let last = run.rows() - 1;
        let ego_x = x[last] - driven.gap_m.last().unwrap();
        let delayed = 0.5 * (x[last - 12] + x[last - 13]);
        assert!((ego_x - (delayed - 6.0)).abs() < 0.1);
    }
}

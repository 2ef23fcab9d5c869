//! Responsibility-sensitive safety: the gap that is never to be undercut.

use serde::{Deserialize, Serialize};

/// The rule's numbers, and a gap at standstill beside it.
///
/// # Source
/// Shalev-Shwartz, Shammah and Shashua 2017, Definition 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Rss {
    /// Time before ego brakes, in s, above 0.
    pub reaction_s: f64,
    /// Ego's acceleration until then, in m/s².
    pub reaction_accel_mps2: f64,
    /// Braking of ego after that, in m/s², above 0.
    pub ego_braking_mps2: f64,
    /// Hardest braking of the leader, in m/s², above 0.
    pub lead_braking_mps2: f64,
    /// Gap kept at standstill, in m.
    pub standstill_gap_m: f64,
}

impl Rss {
    /// The least safe gap at these speeds, in m: ego can still stop if the leader brakes as hard as it can.
    #[inline]
    pub fn distance_m(&self, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        let after = ego_speed_mps + self.reaction_s * self.reaction_accel_mps2;
        let reacting = 0.5 * (ego_speed_mps + after) * self.reaction_s;
        let stopping = after * after / (2.0 * self.ego_braking_mps2);
        let lead_stops = lead_speed_mps * lead_speed_mps / (2.0 * self.lead_braking_mps2);
        self.standstill_gap_m + (reacting + stopping - lead_stops).max(0.0)
    }
}

/// The rule across the road.
///
/// # Source
/// Shalev-Shwartz, Shammah and Shashua 2017, Definition 6.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralRss {
    /// μ: what is left between the sides, in m.
    pub margin_m: f64,
    /// ρ: reaction time of both, in s.
    pub reaction_s: f64,
    /// Acceleration towards the other during it, in m/s².
    pub reaction_mps2: f64,
    /// Lateral braking, in m/s².
    pub braking_mps2: f64,
}

impl LateralRss {
    /// Distance between the sides of two vehicles that move towards each other with these lateral speeds, at which both can still stop
    /// moving sideways without touching, in m.
    ///
    /// d = μ + Σ over both of (t + t_ρ)/2 · ρ + t_ρ |t_ρ| / (2 b), with t the speed towards the other, t_ρ = t + ρ a, at least μ.
    pub fn distance_m(&self, one_mps: f64, other_mps: f64) -> f64 {
        let needs = |towards_mps: f64| {
            let then = towards_mps + self.reaction_s * self.reaction_mps2;
            0.5 * (towards_mps + then) * self.reaction_s
                + then * then.abs() / (2.0 * self.braking_mps2)
        };
        self.margin_m + (needs(one_mps) + needs(other_mps)).max(0.0)
    }
}

/// Braking that is needed not to come nearer than `margin_m`, in m/s², positive.
///
/// Counts on the lead keeping its braking `lead_braking_mps2` (positive) until it stands.
pub fn needed_braking_mps2(
    gap_m: f64,
    margin_m: f64,
    speed_mps: f64,
    lead_speed_mps: f64,
    lead_braking_mps2: f64,
) -> f64 {
    let room = (gap_m - margin_m).max(crate::LEAST_GAP_M);
    let closing = speed_mps - lead_speed_mps;
    if closing <= 0.0 {
        return 0.0;
    }
    if lead_braking_mps2 <= 0.5 {
        return closing * closing / (2.0 * room);
    }
    // If the speeds meet before the lead stands, only that counts: stopping behind its last place would not help.
    if 2.0 * room / closing < lead_speed_mps / lead_braking_mps2 {
        return lead_braking_mps2 + closing * closing / (2.0 * room);
    }
    let lead_stops_in = lead_speed_mps * lead_speed_mps / (2.0 * lead_braking_mps2);
    speed_mps * speed_mps / (2.0 * (room + lead_stops_in))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RSS: Rss = Rss {
        reaction_s: 0.3,
        reaction_accel_mps2: 2.0,
        ego_braking_mps2: 7.0,
        lead_braking_mps2: 8.0,
        standstill_gap_m: 2.0,
    };

    #[test]
    fn the_distance_is_the_one_worked_out_by_hand() {
        // Reacting 0.3 · 30.3 = 9.09, stopping 30.6²/14 = 66.883, the leader 900/16 = 56.25; and 2 m.
        assert!((RSS.distance_m(30.0, 30.0) - 21.723).abs() < 1e-3);
        assert!(RSS.distance_m(0.0, 0.0) < 2.2);
    }

    #[test]
    fn who_brakes_as_is_needed_comes_to_the_margin_and_no_nearer() {
        for (gap, speed, lead, lead_brakes) in [
            (52.0, 30.0, 20.0, 0.0),
            // The speeds meet while the lead still moves; it stands before that; it stands already.
            (12.0, 30.0, 20.0, 3.0),
            (52.0, 30.0, 20.0, 3.0),
            (52.0, 30.0, 0.0, 0.0),
        ] {
            let needed = needed_braking_mps2(gap, 2.0, speed, lead, lead_brakes);
            let way = |from: f64, braking: f64, t: f64| {
                let t = if braking > 0.0 { t.min(from / braking) } else { t };
                from * t - 0.5 * braking * t * t
            };
            let apart = |tick: u32| {
                let t = f64::from(tick) * 1e-3;
                gap + way(lead, lead_brakes, t) - way(speed, needed, t)
            };
            let nearest = (0..30_000).map(apart).fold(gap, f64::min);
            assert!((nearest - 2.0).abs() < 1e-3, "{nearest}");
        }
        // Nobody brakes for who is no slower.
        assert!(needed_braking_mps2(52.0, 2.0, 20.0, 20.0, 4.0).abs() < 1e-12);
    }

    #[test]
    fn two_that_brake_sideways_in_time_come_no_nearer_than_the_margin() {
        let rule =
            LateralRss { margin_m: 0.2, reaction_s: 0.3, reaction_mps2: 0.2, braking_mps2: 0.8 };
        for (mut one, mut other) in [(1.2_f64, 0.0_f64), (0.6, 0.9), (1.0, -0.3)] {
            let mut apart = rule.distance_m(one, other);
            let step = 1e-4;
            for tick in 0..40_000 {
                let reacting = f64::from(tick) * step < rule.reaction_s;
                for speed in [&mut one, &mut other] {
                    *speed += step
                        * if reacting {
                            rule.reaction_mps2
                        } else {
                            -rule.braking_mps2 * speed.signum()
                        };
                }
                apart -= (one + other) * step;
                assert!(apart > rule.margin_m - 1e-3, "{apart}");
            }
        }
    }
}

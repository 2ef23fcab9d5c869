//! Settings of the automated car's controllers.

use super::setting::{choices, settings};
use serde::{Deserialize, Serialize};

/// How the paper's rule makes a wish of the probability of a lane change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ChangeRule {
    /// When P(change) has added up to `hazard_threshold`: "this driver would have changed by now".
    Accumulated,
    /// When P(change) exceeds `probability_threshold`: the paper, to the letter.
    Paper,
}

/// How the car follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FollowingRule {
    /// The gap asked for is the gap kept; a car that means to pass drives up to the lead.
    AskedGap,
    /// The intelligent-driver model, with the gap asked for in the place of its time gap.
    Idm,
    /// The paper, to the letter: the following controller takes part below λ only.
    Paper,
}

choices!(ChangeRule, FollowingRule);

settings! {
    /// What the controllers do with a planner's set-points.
    ///
    /// # Source
    /// Method section 5; every number from calibration section 4, where the alternatives that failed are listed.
    /// The jerk bounds and the harder braking of the safety layer are ours.
    pub struct ControllerSettings as own {
        /// Lowest and highest speed asked for that is followed: the training range.
        speed_range_mps: [f64; 2] = [15.0, 38.0], 0.0..=60.0;
        /// Velocity controller, proportional gain.
        velocity_gain_per_s: f64 = 0.6, 0.01..=2.0;
        /// Velocity controller, integral gain.
        velocity_integral_per_s2: f64 = 0.05, 0.0..=0.5;
        /// Which rule follows. `asked_gap` takes the next three, `idm` of them the braking; both pass by the two after them; the
        /// seven that follow are the paper's.
        following_rule: FollowingRule = FollowingRule::AskedGap;
        /// Following controller, gain on the speed.
        following_gain_per_s: f64 = 1.2, 0.2..=2.0;
        /// Closing speed for each m by which the gap is longer than asked.
        approach_gain_per_s: f64 = 0.3, 0.02..=0.5;
        /// Braking with which a long gap is closed.
        approach_braking_mps2: f64 = 1.5, 0.5..=3.0;
        /// Least share of the safe distance to which a car that means to pass drives up.
        passing_least_share: f64 = 0.75, 0.5..=1.0;
        /// Time inside the safe distance that it may spend behind a lead.
        passing_inside_s: f64 = 3.0, 0.0..=30.0;
        /// Following controller, gain on the gap.
        gap_gain_per_s2: f64 = 0.04, 0.0..=0.5;
        /// Following controller, gain on the difference of speeds.
        speed_difference_gain_per_s: f64 = 0.5, 0.01..=2.0;
        /// λ, the gap below which the following controller takes part: at least this.
        following_threshold_m: f64 = 15.0, 5.0..=200.0;
        /// λ as a factor of f̂.
        following_threshold_factor: f64 = 0.7, 0.0..=5.0;
        /// λ covers the distance in which this braking ends the closing speed.
        closing_braking_mps2: f64 = 2.0, 0.5..=3.5;
        /// λ also covers the closing speed over this time: throttle lag and jerk bound, which a point-mass car does not have.
        closing_response_s: f64 = 0.3, 0.0..=3.0;
        /// Band above λ over which the following controller takes over: no jump, and no flutter at the edge.
        handover_band_m: f64 = 3.0, 0.1..=20.0;
        /// Bound on the change of acceleration; braking for safety is free of it.
        jerk_limit_mps3: f64 = 4.0, 1.0..=50.0;
        /// Safe distance: reaction time.
        reaction_s: f64 = 0.3, 0.1..=3.0;
        /// Safe distance: acceleration during the reaction.
        reaction_acceleration_mps2: f64 = 1.0, Range::NotNegative;
        /// Safe distance: braking of the vehicle behind.
        own_braking_mps2: f64 = 7.0, 3.0..=8.0;
        /// Safe distance: braking of the vehicle ahead. One that brakes less hard than ego would make a safe distance of nothing.
        other_braking_mps2: f64 = 8.0, Range::Because(own.own_braking_mps2, 12.0, "own_braking_mps2 to 12 m/s²");
        /// Distance kept on top.
        margin_m: f64 = 2.0, 1.0..=50.0;
        /// Braking that must be needed before the safety layer overrides the controllers.
        intervenes_above_mps2: f64 = 3.5, 1.0..=5.0;
        /// Lateral safe distance: what is left between the sides.
        lateral_margin_m: f64 = 0.2, 0.0..=1.0;
        /// Lateral safe distance: acceleration towards the other during the reaction.
        lateral_reaction_mps2: f64 = 0.2, 0.0..=2.0;
        /// Lateral safe distance: lateral braking.
        lateral_braking_mps2: f64 = 0.8, 0.3..=4.0;
        /// Which rule makes a wish of a probability: for planners that have one; this and the next three are theirs alone.
        change_rule: ChangeRule = ChangeRule::Accumulated;
        /// Λ above which moving out is wished for.
        hazard_threshold: f64 = 0.4, Range::Positive;
        /// Λ above which moving back is.
        merge_back_hazard_threshold: f64 = 1.2, Range::Positive;
        /// δ: P(change) above which a change is wished for by the paper's rule.
        probability_threshold: f64 = 0.2, 0.0..=1.0;
        /// Longest duration of a lane change.
        change_longest_s: f64 = 4.8, Range::Because(own.change_shortest_s, 15.0, "change_shortest_s to 15 s");
        /// Shortest duration of a lane change.
        change_shortest_s: f64 = 2.5, 2.0..=10.0;
        /// Duration as a factor of the time until ego would be `change_reserve_m` behind its lead.
        change_time_factor: f64 = 1.5, 0.5..=1.8;
        /// Gap to the lead that a change leaves.
        change_reserve_m: f64 = 3.0, 1.0..=50.0;
        /// Time in the passing lane with nobody to pass after which the car goes back.
        return_after_s: f64 = 8.0, Range::NotNegative;
        /// Time gap that must be free ahead for that.
        return_free_s: f64 = 4.0, 1.0..=60.0;
        /// Stanley controller, gain on the cross-track error.
        stanley_gain_per_s: f64 = 1.5, 0.3..=4.0;
        /// Lateral acceleration above which the car slows down for a bend.
        curve_acceleration_mps2: f64 = 2.5, 0.5..=5.0;
        /// Braking with which it does.
        curve_braking_mps2: f64 = 1.0, 0.3..=3.0;
    }
}

impl ControllerSettings {
    /// The same with the paper's rule of following, for planners that leave moving out to a probability.
    #[must_use]
    pub fn literal(&self) -> Self {
        Self { following_rule: FollowingRule::Paper, ..self.clone() }
    }
}

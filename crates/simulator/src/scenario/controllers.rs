//! Settings of the automated car's controllers.

use super::{Range, check};
use crate::error::SimulatorError;
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

/// What the controllers do with a planner's set-points.
///
/// # Source
/// Method section 5; every number from calibration section 4, where the alternatives that failed are listed.
/// The jerk bounds and the harder braking of the safety layer are ours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerSettings {
    /// Lowest and highest speed asked for that is followed, in m/s: the training range.
    pub speed_range_mps: [f64; 2],
    /// Velocity controller, proportional gain, in 1/s.
    pub velocity_gain_per_s: f64,
    /// Velocity controller, integral gain, in 1/s².
    pub velocity_integral_per_s2: f64,
    /// Which rule follows. [`FollowingRule::AskedGap`] takes the next three, [`FollowingRule::Idm`] of them the braking;
    /// both pass by the two after them; the seven that follow are the paper's.
    pub following_rule: FollowingRule,
    /// Following controller, gain on the speed, in 1/s.
    pub following_gain_per_s: f64,
    /// Closing speed for each m by which the gap is longer than asked, in 1/s.
    pub approach_gain_per_s: f64,
    /// Braking with which a long gap is closed, in m/s².
    pub approach_braking_mps2: f64,
    /// Least share of the safe distance to which a car that means to pass drives up.
    pub passing_least_share: f64,
    /// Time inside the safe distance that it may spend behind a lead, in s.
    pub passing_inside_s: f64,
    /// Following controller, gain on the gap, in 1/s².
    pub gap_gain_per_s2: f64,
    /// Following controller, gain on the difference of speeds, in 1/s.
    pub speed_difference_gain_per_s: f64,
    /// λ, the gap below which the following controller takes part: at least this, in m.
    pub following_threshold_m: f64,
    /// λ as a factor of f̂.
    pub following_threshold_factor: f64,
    /// λ covers the distance in which this braking ends the closing speed, in m/s².
    pub closing_braking_mps2: f64,
    /// λ also covers the closing speed over this time, in s: throttle lag and jerk bound, which a point-mass car
    /// does not have.
    pub closing_response_s: f64,
    /// Band above λ over which the following controller takes over, in m: no jump, and no flutter at the edge.
    pub handover_band_m: f64,
    /// Bound on the change of acceleration, in m/s³; braking for safety is free of it.
    pub jerk_limit_mps3: f64,
    /// Safe distance: reaction time, in s.
    pub reaction_s: f64,
    /// Safe distance: acceleration during the reaction, in m/s².
    pub reaction_acceleration_mps2: f64,
    /// Safe distance: braking of the vehicle behind, in m/s².
    pub own_braking_mps2: f64,
    /// Safe distance: braking of the vehicle ahead, in m/s².
    pub other_braking_mps2: f64,
    /// Distance kept on top, in m.
    pub margin_m: f64,
    /// Braking that must be needed before the safety layer overrides the controllers, in m/s².
    pub intervenes_above_mps2: f64,
    /// Lateral safe distance: what is left between the sides, in m.
    #[serde(default = "paper_lateral_margin")]
    pub lateral_margin_m: f64,
    /// Lateral safe distance: acceleration towards the other during the reaction, in m/s².
    #[serde(default = "paper_lateral_reaction")]
    pub lateral_reaction_mps2: f64,
    /// Lateral safe distance: lateral braking, in m/s².
    #[serde(default = "paper_lateral_braking")]
    pub lateral_braking_mps2: f64,
    /// Which rule makes a wish of a probability: for planners that have one; this and the next three are theirs alone.
    pub change_rule: ChangeRule,
    /// Λ above which moving out is wished for.
    pub hazard_threshold: f64,
    /// Λ above which moving back is.
    pub merge_back_hazard_threshold: f64,
    /// δ: P(change) above which a change is wished for by the paper's rule.
    pub probability_threshold: f64,
    /// Longest duration of a lane change, in s.
    pub change_longest_s: f64,
    /// Shortest duration of a lane change, in s.
    pub change_shortest_s: f64,
    /// Duration as a factor of the time until ego would be `change_reserve_m` behind its lead.
    pub change_time_factor: f64,
    /// Gap to the lead that a change leaves, in m.
    pub change_reserve_m: f64,
    /// Time in the passing lane with nobody to pass after which the car goes back, in s.
    pub return_after_s: f64,
    /// Time gap that must be free ahead for that, in s.
    pub return_free_s: f64,
    /// Stanley controller, gain on the cross-track error, in 1/s.
    pub stanley_gain_per_s: f64,
    /// Lateral acceleration above which the car slows down for a bend, in m/s².
    #[serde(default = "paper_curve_acceleration")]
    pub curve_acceleration_mps2: f64,
    /// Braking with which it does, in m/s².
    #[serde(default = "paper_curve_braking")]
    pub curve_braking_mps2: f64,
}

fn paper_lateral_margin() -> f64 {
    ControllerSettings::PAPER.lateral_margin_m
}

fn paper_lateral_reaction() -> f64 {
    ControllerSettings::PAPER.lateral_reaction_mps2
}

fn paper_lateral_braking() -> f64 {
    ControllerSettings::PAPER.lateral_braking_mps2
}

fn paper_curve_acceleration() -> f64 {
    ControllerSettings::PAPER.curve_acceleration_mps2
}

fn paper_curve_braking() -> f64 {
    ControllerSettings::PAPER.curve_braking_mps2
}

impl ControllerSettings {
    pub(crate) const PAPER: Self = Self {
        speed_range_mps: [15.0, 38.0],
        velocity_gain_per_s: 0.6,
        velocity_integral_per_s2: 0.05,
        following_rule: FollowingRule::AskedGap,
        following_gain_per_s: 1.2,
        approach_gain_per_s: 0.3,
        approach_braking_mps2: 1.5,
        passing_least_share: 0.75,
        passing_inside_s: 3.0,
        gap_gain_per_s2: 0.04,
        speed_difference_gain_per_s: 0.5,
        following_threshold_m: 15.0,
        following_threshold_factor: 0.7,
        closing_braking_mps2: 2.0,
        closing_response_s: 0.3,
        handover_band_m: 3.0,
        jerk_limit_mps3: 4.0,
        reaction_s: 0.3,
        reaction_acceleration_mps2: 1.0,
        own_braking_mps2: 7.0,
        other_braking_mps2: 8.0,
        margin_m: 2.0,
        intervenes_above_mps2: 3.5,
        lateral_margin_m: 0.2,
        lateral_reaction_mps2: 0.2,
        lateral_braking_mps2: 0.8,
        change_rule: ChangeRule::Accumulated,
        hazard_threshold: 0.4,
        merge_back_hazard_threshold: 1.2,
        probability_threshold: 0.2,
        change_longest_s: 4.8,
        change_shortest_s: 2.5,
        change_time_factor: 1.5,
        change_reserve_m: 3.0,
        return_after_s: 8.0,
        return_free_s: 4.0,
        stanley_gain_per_s: 1.5,
        curve_acceleration_mps2: 2.5,
        curve_braking_mps2: 1.0,
    };

    /// The same with the paper's rule of following, for planners that leave moving out to a probability.
    #[must_use]
    pub fn literal(&self) -> Self {
        Self {
            following_rule: FollowingRule::Paper,
            ..self.clone()
        }
    }

    /// Whether every number is in its range.
    ///
    /// # Errors
    /// [`SimulatorError::Setting`] for the first that is not.
    pub fn check(&self) -> Result<(), SimulatorError> {
        let [low, high] = self.speed_range_mps;
        let speeds = Range::Within(0.0, 60.0, "0 to 60 m/s, lowest first");
        let above_low = Range::Within(low, 60.0, "0 to 60 m/s, lowest first");
        let gain = Range::Within(0.01, 2.0, "0.01 to 2");
        let small_gain = Range::Within(0.0, 0.5, "0 to 0.5");
        let own_braking = Range::Within(3.0, 8.0, "3 to 8 m/s²");
        // A vehicle ahead that brakes less hard than ego would make a safe distance of nothing.
        let other_braking =
            Range::Within(self.own_braking_mps2, 12.0, "own_braking_mps2 to 12 m/s²");
        let ranges = [
            ("speed_range_mps", low, speeds),
            ("speed_range_mps", high, above_low),
            ("velocity_gain_per_s", self.velocity_gain_per_s, gain),
            (
                "velocity_integral_per_s2",
                self.velocity_integral_per_s2,
                small_gain,
            ),
            (
                "following_gain_per_s",
                self.following_gain_per_s,
                Range::Within(0.2, 2.0, "0.2 to 2"),
            ),
            (
                "approach_gain_per_s",
                self.approach_gain_per_s,
                Range::Within(0.02, 0.5, "0.02 to 0.5"),
            ),
            (
                "approach_braking_mps2",
                self.approach_braking_mps2,
                Range::Within(0.5, 3.0, "0.5 to 3 m/s²"),
            ),
            (
                "passing_least_share",
                self.passing_least_share,
                Range::Within(0.5, 1.0, "0.5 to 1"),
            ),
            (
                "passing_inside_s",
                self.passing_inside_s,
                Range::Within(0.0, 30.0, "0 to 30 s"),
            ),
            ("gap_gain_per_s2", self.gap_gain_per_s2, small_gain),
            (
                "speed_difference_gain_per_s",
                self.speed_difference_gain_per_s,
                gain,
            ),
            (
                "following_threshold_m",
                self.following_threshold_m,
                Range::Within(5.0, 200.0, "5 to 200 m"),
            ),
            (
                "following_threshold_factor",
                self.following_threshold_factor,
                Range::Within(0.0, 5.0, "0 to 5"),
            ),
            (
                "closing_braking_mps2",
                self.closing_braking_mps2,
                Range::Within(0.5, 3.5, "0.5 to 3.5 m/s²"),
            ),
            (
                "closing_response_s",
                self.closing_response_s,
                Range::Within(0.0, 3.0, "0 to 3 s"),
            ),
            (
                "handover_band_m",
                self.handover_band_m,
                Range::Within(0.1, 20.0, "0.1 to 20 m"),
            ),
            (
                "jerk_limit_mps3",
                self.jerk_limit_mps3,
                Range::Within(1.0, 50.0, "1 to 50 m/s³"),
            ),
            (
                "reaction_s",
                self.reaction_s,
                Range::Within(0.1, 3.0, "0.1 to 3 s"),
            ),
            (
                "reaction_acceleration_mps2",
                self.reaction_acceleration_mps2,
                Range::NotNegative,
            ),
            ("own_braking_mps2", self.own_braking_mps2, own_braking),
            ("other_braking_mps2", self.other_braking_mps2, other_braking),
            (
                "margin_m",
                self.margin_m,
                Range::Within(1.0, 50.0, "1 to 50 m"),
            ),
            (
                "intervenes_above_mps2",
                self.intervenes_above_mps2,
                Range::Within(1.0, 5.0, "1 to 5 m/s²"),
            ),
            (
                "lateral_margin_m",
                self.lateral_margin_m,
                Range::Within(0.0, 1.0, "0 to 1 m"),
            ),
            (
                "lateral_reaction_mps2",
                self.lateral_reaction_mps2,
                Range::Within(0.0, 2.0, "0 to 2 m/s²"),
            ),
            (
                "lateral_braking_mps2",
                self.lateral_braking_mps2,
                Range::Within(0.3, 4.0, "0.3 to 4 m/s²"),
            ),
            ("hazard_threshold", self.hazard_threshold, Range::Positive),
            (
                "merge_back_hazard_threshold",
                self.merge_back_hazard_threshold,
                Range::Positive,
            ),
            (
                "probability_threshold",
                self.probability_threshold,
                Range::Within(0.0, 1.0, "0 to 1"),
            ),
            (
                "change_shortest_s",
                self.change_shortest_s,
                Range::Within(2.0, 10.0, "2 to 10 s"),
            ),
            (
                "change_longest_s",
                self.change_longest_s,
                Range::Within(
                    self.change_shortest_s,
                    15.0,
                    "the shortest duration to 15 s",
                ),
            ),
            (
                "change_time_factor",
                self.change_time_factor,
                Range::Within(0.5, 1.8, "0.5 to 1.8"),
            ),
            (
                "change_reserve_m",
                self.change_reserve_m,
                Range::Within(1.0, 50.0, "1 to 50 m"),
            ),
            ("return_after_s", self.return_after_s, Range::NotNegative),
            (
                "return_free_s",
                self.return_free_s,
                Range::Within(1.0, 60.0, "1 to 60 s"),
            ),
            (
                "stanley_gain_per_s",
                self.stanley_gain_per_s,
                Range::Within(0.3, 4.0, "0.3 to 4 1/s"),
            ),
            (
                "curve_acceleration_mps2",
                self.curve_acceleration_mps2,
                Range::Within(0.5, 5.0, "0.5 to 5 m/s²"),
            ),
            (
                "curve_braking_mps2",
                self.curve_braking_mps2,
                Range::Within(0.3, 3.0, "0.3 to 3 m/s²"),
            ),
        ];
        ranges
            .into_iter()
            .try_for_each(|(key, found, range)| check("controllers", key, found, range))
    }
}

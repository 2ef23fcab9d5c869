//! Settings of the traffic.

use super::setting::settings;

settings! {
    /// The lead vehicles, one after the other. v_e is ego's target speed.
    ///
    /// # Source
    /// Paper, Study 1, for the six speeds; calibration section 1 for when and where they appear.
    pub struct LeadSettings {
        /// Speeds as factors of v_e.
        factors_of_target: Vec<f64> = vec![0.85, 0.90, 0.97], 0.2..=2.0;
        /// Speeds as factors of the posted speed.
        factors_of_posted: Vec<f64> = vec![0.9, 1.0, 1.1], 0.2..=2.0;
        /// When the first slot opens; a tenth of the drive where that is sooner.
        first_slot_s: f64 = 30.0, Range::NotNegative;
        /// Time between slots; two fifths of the drive where that is less, so that a short drive meets at least two.
        slot_spacing_s: f64 = 88.0, Range::Positive;
        /// Ego rows before this time do not count for v_e.
        target_speed_from_s: f64 = 10.0, Range::NotNegative;
        /// Gap at which a lead appears.
        appears_ahead_m: f64 = 200.0, 150.0..=2000.0;
        /// Road that must be free ahead before one appears, and beyond which the last one is over.
        clear_ahead_m: f64 = 205.0, 150.0..=2000.0;
        /// Distance behind ego in the other lane beyond which the last one is over.
        over_behind_m: f64 = 130.0, Range::Positive;
        /// Distance from ego at which a vehicle leaves the world.
        removed_m: f64 = 420.0, 150.0..=2000.0;
        /// Speed while ego approaches, at most, as a factor of v_e.
        approach_factor: f64 = 0.85, 0.2..=2.0;
        /// Time gap at which the lead takes its own speed.
        approach_time_gap_s: f64 = 3.5, Range::NotNegative;
        /// Time after which it does so in any case.
        approach_limit_s: f64 = 25.0, Range::NotNegative;
        /// Its acceleration.
        acceleration_mps2: f64 = 1.0, Range::Positive;
        /// Time after which a lead still ahead in ego's lane drives off.
        drives_off_after_s: f64 = 80.0, Range::Positive;
        /// How much faster than ego it then drives.
        drives_off_faster_mps: f64 = 6.0, Range::NotNegative;
    }
}

settings! {
    /// Encounters in which cars beside ego keep it from passing, so that it follows first.
    ///
    /// # Source
    /// Calibration section 1: without them a quarter of the drivers have under 8 s of following rows.
    pub struct BlockedSettings {
        /// How many of the encounters, drawn.
        encounters: usize = 2, Range::NotNegative;
        /// Cars side by side with ego.
        cars: usize = 3, 0.0..=9.0;
        /// Distance between their centres.
        spacing_m: f64 = 22.0, 15.0..=100.0;
        /// Distance behind ego at which the first appears.
        appears_behind_m: f64 = 110.0, 60.0..=400.0;
        /// Their speed over ego's per metre that they are away from their place.
        position_gain_per_s: f64 = 0.25, Range::NotNegative;
        /// Largest difference from ego's speed.
        speed_difference_limit_mps: f64 = 5.0, Range::NotNegative;
        /// Difference of speeds at which ego has met the lead.
        met_within_mps: f64 = 1.5, Range::NotNegative;
        /// Time from then until they leave.
        rides_for_s: f64 = 15.0, Range::NotNegative;
        /// Time after which they leave in any case.
        leaves_after_s: f64 = 70.0, Range::NotNegative;
        /// How much faster than ego they leave.
        leaves_faster_mps: f64 = 6.0, Range::NotNegative;
        /// Time from their appearance during which no other off-lane vehicle comes.
        quiet_s: f64 = 50.0, Range::NotNegative;
    }
}

settings! {
    /// Single vehicles of the passing lane.
    ///
    /// # Source
    /// Calibration section 1. All are faster than ego: one in ego's lane or slower than v_e would hold up the leads.
    pub struct OffLaneSettings {
        /// Shortest and longest time from one to the next.
        interval_s: [f64; 2] = [45.0, 75.0], 1.0..=1e6;
        /// Share that comes from behind; the others appear ahead.
        share_from_behind: f64 = 0.6, 0.0..=1.0;
        /// Distance behind ego at which one appears.
        appears_behind_m: f64 = 180.0, 100.0..=400.0;
        /// How much faster than v_e it then is, least and most.
        faster_mps: [f64; 2] = [1.5, 5.5], 0.0..=20.0;
        /// Distance ahead of ego at which one appears.
        appears_ahead_m: f64 = 190.0, 100.0..=400.0;
        /// Its speed then as a factor of v_e, least and most.
        ahead_factor: [f64; 2] = [1.06, 1.20], 1.0..=2.0;
    }
}

//! What a drive met on its road: not what the driver did, but what there was to do it with.

use super::{Measure, Shown, exposure::Exposure, mean};

/// Lead vehicles met.
///
/// # Source
/// Ours: two rides are comparable as far as they met the same.
pub(super) const LEADS: Measure = Measure {
    name: "leads_met",
    title: "Lead vehicles met",
    unit: "1",
    shown: Shown::Plain,
    aggression: None,
    description: "Vehicles that were the reference vehicle ahead in ego's own lane at some time.",
    of_passing: false,
    grows: true,
    why_missing: "nothing of the drive can be compared",
    value: |drive| Some(Exposure::from_drive(drive).leads_s.len() as f64),
};

pub(super) const LEAD_SPEED: Measure = Measure {
    name: "mean_lead_speed_mps",
    title: "Mean speed of lead vehicles",
    unit: "m/s",
    shown: Shown::Speed,
    aggression: None,
    description: "Mean speed of the vehicle ahead in ego's own lane, over the rows with one.",
    of_passing: false,
    grows: false,
    why_missing: "no vehicle was ahead in ego's lane",
    value: |drive| {
        let ahead = (0..drive.len()).filter(|&row| drive.lead_ahead(row));
        mean(ahead.map(|row| drive.rows().lead_speed_mps[row]))
    },
};

/// How long ego was held up.
pub(super) const FOLLOWING: Measure = Measure {
    name: "following_s",
    title: "Time following",
    unit: "s",
    shown: Shown::In("s"),
    aggression: None,
    description: "Time in which ego follows the reference vehicle (method, section 2).",
    of_passing: false,
    grows: true,
    why_missing: "nothing of the drive can be compared",
    value: |drive| {
        let following = drive.rows().following.iter().filter(|f| **f);
        Some(following.count() as f64 / drive.rate_hz())
    },
};

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn a_lead_that_is_passed_was_met_once_at_its_speed() {
        let drive = Scripted::new(40.0).lead(85.0, 25.0).pass(5.0, 30.0).drive();
        assert_eq!(LEADS.of(&drive), Some(1.0));
        assert!((LEAD_SPEED.of(&drive).unwrap() - 25.0).abs() < 1e-9);
    }

    #[test]
    fn an_empty_road_has_no_lead_and_nobody_to_follow() {
        let drive = Scripted::new(40.0).drive();
        let met = [LEADS, LEAD_SPEED, FOLLOWING].map(|measure| measure.of(&drive));
        assert_eq!(met, [Some(0.0), None, Some(0.0)]);
    }

    #[test]
    fn who_stays_30_m_behind_for_40_s_follows_all_the_time() {
        let drive = Scripted::new(40.0).lead(30.0, 30.0).drive();
        let following = FOLLOWING.of(&drive).unwrap();
        assert!((following - 40.0).abs() < 0.2, "{following}");
    }
}

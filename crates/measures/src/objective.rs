//! The objective measures: what a drive was like, one number each.

mod cut_in;
mod exposure;
mod headway_merge_back;
mod headway_time;
mod jerk;
mod lane_changes;
mod lane_position_sd;
mod left_lane_fraction;
mod low_pass;
mod mean_velocity;
mod met;
mod min_headway_distance;
mod strongest_braking;
#[cfg(test)]
pub(crate) mod testing;
mod time_gap;
mod time_gap_following;
mod time_to_collision;

pub(crate) use cut_in::cut_ins;
pub use exposure::{Comparable, Exposure, comparable};
pub(crate) use low_pass::derivatives;
pub use time_gap::median_time_gap_s;
pub(crate) use time_to_collision::inverse_time_to_collision;

use maveric_domain::{Drive, SpeedUnit, design::Sign};

/// One objective measure of a drive.
///
/// # Example
/// One of one's own:
/// ```
/// use maveric_domain::*;
/// use maveric_measures::{Measure, objective::Shown};
/// let standing = Measure {
///     name: "standing_s",
///     title: "Time at standstill",
///     unit: "s",
///     shown: Shown::In("s"),
///     aggression: None,
///     description: "How long the car stood.",
///     of_passing: false,
///     grows: true,
///     why_missing: "",
///     value: |drive| {
///         let stood = drive.rows().ego_speed_mps.iter().filter(|v| **v < 0.1);
///         Some(stood.count() as f64 / drive.rate_hz())
///     },
/// };
/// # let time_s: Vec<f64> = (0..220).map(|i| f64::from(i) / 20.0).collect();
/// # let zero = vec![0.0; 220];
/// # let ego = EgoTrack { length_m: 4.7, x_m: zero.clone(), y_m: zero.clone(), speed_mps: zero };
/// # let recording = Recording::new(Road::PAPER, 20.0, time_s, vec![0; 220], ego, Vec::new())?;
/// # let meta = DriveMeta::named("P01-own", "P01", "own", DrivenBy::Human)?;
/// let drive = Drive::from_recording(meta, &recording)?;
/// assert_eq!(standing.of(&drive), Some(11.0));
/// # Ok::<(), maveric_domain::DomainError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Measure {
    /// Code name, such as `mean_headway_time_s`: the unit is its suffix.
    pub name: &'static str,
    /// Name for people, as in the paper.
    pub title: &'static str,
    /// Unit of the value, such as `m/s`; `1` for counts and shares.
    pub unit: &'static str,
    /// How people read it.
    pub shown: Shown,
    /// Which way a more aggressive drive moves it; `None` where aggression is not known to.
    pub aggression: Option<Sign>,
    /// What is measured, in one sentence.
    pub description: &'static str,
    /// Whether it is about passing or lanes: a drive without lateral positions has no value.
    pub of_passing: bool,
    /// Whether a longer drive has more of it, or is likelier to have an extreme: a count, the smallest gap. Over drives of unequal
    /// length it is taken from what is [`comparable`] of them.
    pub grows: bool,
    /// Why a drive may have no value.
    pub why_missing: &'static str,
    /// The value for a drive that the measure is about; [`Measure::of`] asks it.
    pub value: fn(&Drive) -> Option<f64>,
}

/// How people read the values of a measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// Counts and shares.
    Plain,
    /// As it is measured, in this unit.
    In(&'static str),
    /// A speed, measured in m/s, in the unit of the study.
    Speed,
}

impl Shown {
    /// The unit, where speeds are read in this one; empty for counts and shares.
    pub fn unit(self, speed: SpeedUnit) -> &'static str {
        match self {
            Self::Plain => "",
            Self::In(unit) => unit,
            Self::Speed => speed.name(),
        }
    }

    /// What a value is multiplied with to be in that unit.
    pub fn factor(self, speed: SpeedUnit) -> f64 {
        match self {
            Self::Speed => speed.per_mps(),
            Self::Plain | Self::In(_) => 1.0,
        }
    }
}

impl Measure {
    /// The value for a drive, in [`Measure::unit`]; `None` for the reason in [`Measure::why_missing`].
    ///
    /// A value is finite.
    pub fn of(&self, drive: &Drive) -> Option<f64> {
        if self.of_passing && !drive.has_lateral() {
            return None;
        }
        (self.value)(drive).filter(|v| v.is_finite())
    }
}

/// Why a drive has no measure of lanes: it may have lateral positions in a lane that is the only known one.
const WITHOUT_LANES: &str = "the log has no lateral positions, or its road has one lane, by `lanes` of the mapping or without a mapping of the road";

/// The measures of method section 8, in its order.
static ALL: [Measure; 7] = [
    mean_velocity::MEASURE,
    lane_changes::MEASURE,
    headway_time::MEASURE,
    min_headway_distance::MEASURE,
    headway_merge_back::DISTANCE,
    headway_merge_back::TIME,
    left_lane_fraction::MEASURE,
];

/// Measures beyond the method's: measured where a design names them.
static FURTHER: [Measure; 9] = [
    time_gap_following::MEASURE,
    time_to_collision::LEAST,
    time_to_collision::SHORT,
    cut_in::GAP,
    cut_in::TIME_TO_COLLISION,
    lane_position_sd::MEASURE,
    strongest_braking::MEASURE,
    jerk::MEASURE,
    min_headway_distance::TO_CHANGE,
];

/// What a drive met: always measured, since rides are comparable as far as they met the same.
static MET: [Measure; 3] = [met::LEADS, met::LEAD_SPEED, met::FOLLOWING];

/// The seven measures of the method (section 8), in its order.
pub fn all() -> &'static [Measure] {
    &ALL
}

/// Measures beyond the method's, another reading of one of its definitions among them; not part of [`all`].
pub fn further() -> &'static [Measure] {
    &FURTHER
}

/// What a drive met on its road, beside what its driver did; not part of [`all`].
pub fn met() -> &'static [Measure] {
    &MET
}

/// The measure of this code name, among [`all`], [`further`] and [`met`].
pub fn find(name: &str) -> Option<&'static Measure> {
    let mut known = ALL.iter().chain(&FURTHER).chain(&MET);
    known.find(|m| m.name == name)
}

/// Mean of the values; `None` without any.
fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut n = 0_u32;
    let sum: f64 = values.into_iter().inspect(|_| n += 1).sum();
    (n > 0).then(|| sum / f64::from(n))
}

#[cfg(test)]
mod tests {
    use super::testing::*;
    use super::*;
    use maveric_domain::Sees;
    use std::collections::BTreeSet;

    #[test]
    fn every_measure_has_a_name_of_its_own_and_is_found_by_it() {
        let names: BTreeSet<&str> =
            all().iter().chain(further()).chain(met()).map(|m| m.name).collect();
        assert_eq!(names.len(), 7 + 9 + 3);
        assert!(names.iter().all(|n| find(n).is_some()));
        assert!(find("mean_speed").is_none());
    }

    #[test]
    fn missing_lanes_are_explained_by_a_single_lane() {
        let drive = Scripted::new(60.0).pass(8.0, 28.0).drive();
        let one_lane = drive.seen_by(Sees { lanes: false, ..Sees::ALL });
        assert!(one_lane.has_lateral());
        for name in ["lane_changes", "left_lane_fraction"] {
            let measure = find(name).unwrap();
            assert_eq!(measure.of(&one_lane), None);
            assert!(measure.why_missing.contains("one lane"), "{}", measure.why_missing);
        }
    }

    #[test]
    fn a_drive_without_lateral_positions_has_a_speed_and_no_measure_of_passing() {
        let drive = Scripted::new(40.0).lead(85.0, 25.0).pass(5.0, 30.0).drive();
        assert!(all().iter().all(|m| m.of(&drive).is_some()));
        let without = drive.without_lateral();
        let there = all().iter().filter(|m| m.of(&without).is_some());
        let there: Vec<&str> = there.map(|m| m.name).collect();
        assert_eq!(there, ["mean_velocity_mps"]);
    }

    #[test]
    fn a_rig_that_does_not_see_lanes_counts_no_changes_rather_than_none() {
        let drive = Scripted::new(40.0).lead(85.0, 25.0).pass(5.0, 30.0).drive();
        let lead: Vec<f64> = drive.rows().lead_dx_m.clone();
        let pair = drive.seen_by(Sees::LEAD);
        for (name, there) in
            [("lane_changes", false), ("left_lane_fraction", false), ("mean_velocity_mps", true)]
        {
            let value = find(name).unwrap().of(&pair);
            assert_eq!(value.is_some(), there, "{name}");
        }
        assert_eq!(pair.rows().lead_dx_m, lead);
    }

    #[test]
    fn an_empty_road_gives_speed_count_and_lane_share_and_nothing_else() {
        let drive = Scripted::new(60.0).drive();
        let values: Vec<Option<f64>> = all().iter().map(|m| m.of(&drive)).collect();
        assert_eq!(values, [Some(30.0), Some(0.0), None, None, None, None, Some(0.0)]);
    }
}

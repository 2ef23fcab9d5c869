//! Every habit that is learned.

use super::{
    following_gap, free_speed,
    head::{Event, Head},
    merge_back, move_out, pass, passing_speed,
};
use crate::posted::Posted;
use maveric_domain::Drive;

/// Where each head stands in [`HEADS`].
pub(crate) mod at {
    pub(crate) const FREE_SPEED: usize = 0;
    pub(crate) const FOLLOWING_GAP: usize = 1;
    pub(crate) const MOVE_OUT: usize = 2;
    pub(crate) const MERGE_BACK: usize = 3;
    pub(crate) const PASS: usize = 4;
    pub(crate) const PASSING_SPEED: usize = 5;
}

/// Every habit that is learned.
///
/// # Source
/// Ours: habits are events, and the style enters each linearly.
pub static HEADS: [Head; 6] = [
    free_speed::HEAD,
    following_gap::HEAD,
    move_out::HEAD,
    merge_back::HEAD,
    pass::HEAD,
    passing_speed::HEAD,
];

/// The events of every head in one drive, of which only those before `until_s` count; in the order of [`HEADS`]. A free speed is read
/// as a model reads it that learned where this was `posted`; in m/s without.
pub fn events_of(drive: &Drive, until_s: f64, posted: Option<&Posted>) -> Vec<Vec<Event>> {
    let usable_events = |head: &Head| {
        let mut events = (head.events)(drive);
        events.retain(|e| e.time_s < until_s && e.z().all(f64::is_finite));
        events
    };
    let mut events: Vec<Vec<Event>> = HEADS.iter().map(usable_events).collect();
    let factor = posted.map_or(1.0, |p| p.factor(drive.road().posted_speed_mps));
    for event in &mut events[at::FREE_SPEED] {
        event.outcome = event.outcome.times(factor);
    }
    events
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heads::Outcome;
    use crate::test_drives::{Habits, drive_apart};
    use maveric_domain::Sees;

    #[test]
    fn a_drive_shows_the_habits_that_made_it() {
        let habits = Habits { speed_mps: 30.0, time_gap_s: 2.0, passes: true };
        let events = events_of(&drive_apart("P01", &habits, 600.0), f64::INFINITY, None);
        let middle = |head: usize| {
            let values = events[head].iter().map(|e| match e.outcome {
                Outcome::Value(v) | Outcome::AtLeast(v) => v,
            });
            let mut values: Vec<f64> = values.collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        assert!((middle(at::FREE_SPEED) - 30.0).abs() < 0.5);
        assert!((middle(at::FOLLOWING_GAP) - 2.0).abs() < 0.4, "{}", middle(at::FOLLOWING_GAP));
        assert!((middle(at::MERGE_BACK) - 1.6).abs() < 0.3, "{}", middle(at::MERGE_BACK));
        assert!(middle(at::PASS) > 0.5);
        // Whoever waits behind before moving out would have gone at a longer gap: that is censored.
        assert!(
            events[at::MOVE_OUT]
                .iter()
                .all(|e| matches!(e.outcome, Outcome::AtLeast(_) | Outcome::Value(_)))
        );
        assert!(!events[at::PASSING_SPEED].is_empty());
    }

    #[test]
    fn a_habit_is_read_only_where_the_rig_could_have_shown_it() {
        let habits = Habits { speed_mps: 30.0, time_gap_s: 2.0, passes: true };
        let drive = drive_apart("P01", &habits, 600.0);
        let shown = |sees: &str| -> Vec<bool> {
            let drive = drive.clone().seen_by(sees.parse().unwrap());
            let events = events_of(&drive, f64::INFINITY, None);
            events.iter().map(|e| !e.is_empty()).collect()
        };
        assert_eq!(shown("ahead beside behind lanes"), [true; 6]);
        // Free speed, following gap, moving out; then merging back, passing, and the speed at that.
        let camera = [true, true, true, false, false, false];
        assert_eq!(shown("ahead lanes"), camera);
        assert_eq!(shown("ahead beside lanes"), camera);
        let pair = [true, true, false, false, false, false];
        assert_eq!(shown("ahead"), pair);
        // Whoever does not look ahead does not know that the road is free.
        for blind in ["nothing", "lanes", "behind", "beside behind lanes"] {
            assert_eq!(shown(blind), [false; 6], "{blind}");
        }
        let whole = events_of(&drive, f64::INFINITY, None);
        let seen = events_of(&drive.clone().seen_by(Sees::ALL), f64::INFINITY, None);
        assert_eq!(whole, seen);
    }

    #[test]
    fn who_never_passes_has_no_move_out_and_is_known_for_it() {
        let habits = Habits { speed_mps: 30.0, time_gap_s: 1.5, passes: false };
        let events = events_of(&drive_apart("P01", &habits, 300.0), f64::INFINITY, None);
        assert!(events[at::MOVE_OUT].is_empty() && events[at::MERGE_BACK].is_empty());
        let stayed = events[at::PASS].iter().all(|e| e.outcome == Outcome::Value(0.0));
        assert!(stayed);
        let first = events_of(&drive_apart("P01", &habits, 300.0), 60.0, None);
        assert!(first.iter().flatten().all(|e| e.time_s < 60.0));
    }
}

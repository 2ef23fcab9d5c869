//! The one shape of a head, and the list of them.

use super::{
    family::{Family, Outcome},
    following_gap, free_speed, merge_back, move_out, pass, passing_speed,
};
use maveric_domain::Drive;
use serde::{Deserialize, Serialize};

/// Something a driver does in a situation, of which the style says how: a habit.
///
/// `η = a(z) + B(z)·w`: `z` is the constant 1 and what [`Head::reads`] names; `a` is linear in `z`, and `w` acts on the constant.
#[derive(Debug, Clone, Copy)]
pub struct Head {
    /// Code name.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// Unit of what is predicted.
    pub unit: &'static str,
    /// What η means.
    pub family: Family,
    /// Share of how drivers differ in it that the style need not say: a small one where it carries the habit, a half where it is beside.
    pub left_open: f64,
    /// Names of what it reads beside the constant, with units.
    pub reads: &'static [&'static str],
    /// Whatever of the kind happened in a drive, in order of time.
    pub(super) events: fn(&Drive) -> Vec<Event>,
}

/// What fitting has to know of a head.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shape {
    pub(crate) name: &'static str,
    pub(crate) family: Family,
    pub(crate) left_open: f64,
    /// Numbers that it reads beside the constant.
    pub(crate) reads: usize,
    /// Ridge on its slopes, in events.
    pub(crate) ridge: f64,
}

impl Head {
    pub(super) fn shape(&self) -> Shape {
        Shape {
            name: self.name,
            family: self.family,
            left_open: self.left_open,
            reads: self.reads.len(),
            ridge: RIDGE,
        }
    }
}

/// Ridge of the habits: it decides only where the events do not.
const RIDGE: f64 = 1e-3;

/// [`Head::left_open`] of the habits that a style is there to carry: its numbers are drawn along them first.
///
/// With three numbers for six habits the likelihood alone hardly determines which of them the numbers say exactly; it may as well
/// spend them on habits that the car seldom shows. Chosen on development seeds.
pub(super) const CARRIED: f64 = 0.02;
/// [`Head::left_open`] of habits that are said as far as they go along with those.
pub(super) const BESIDE: f64 = 0.5;

/// One time that a driver showed a habit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// When, in s from the drive's start.
    pub time_s: f64,
    /// The situation, as [`Head::reads`] names it; shape `(reads,)`.
    pub reads: Vec<f64>,
    /// What was done.
    pub outcome: Outcome,
}

impl Event {
    /// z: the constant, then what is read.
    pub(crate) fn z(&self) -> impl Iterator<Item = f64> + '_ {
        std::iter::once(1.0).chain(self.reads.iter().copied())
    }
}

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

/// The events of every head in one drive, of which only those before `until_s` count; in the order of [`HEADS`].
pub fn events_of(drive: &Drive, until_s: f64) -> Vec<Vec<Event>> {
    let of = |head: &Head| {
        let mut events = (head.events)(drive);
        events.retain(|e| e.time_s < until_s && e.z().all(f64::is_finite));
        events
    };
    HEADS.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_drives::{Habits, drive_apart};

    #[test]
    fn a_drive_shows_the_habits_that_made_it() {
        let habits = Habits {
            speed_mps: 30.0,
            time_gap_s: 2.0,
            passes: true,
        };
        let events = events_of(&drive_apart("P01", &habits, 600.0), f64::INFINITY);
        let middle = |head: usize| {
            let values = events[head].iter().map(|e| match e.outcome {
                Outcome::Value(v) | Outcome::AtLeast(v) => v,
            });
            let mut values: Vec<f64> = values.collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        assert!((middle(at::FREE_SPEED) - 30.0).abs() < 0.5);
        assert!(
            (middle(at::FOLLOWING_GAP) - 2.0).abs() < 0.4,
            "{}",
            middle(at::FOLLOWING_GAP)
        );
        assert!(
            (middle(at::MERGE_BACK) - 1.6).abs() < 0.3,
            "{}",
            middle(at::MERGE_BACK)
        );
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
    fn who_never_passes_has_no_move_out_and_is_known_for_it() {
        let habits = Habits {
            speed_mps: 30.0,
            time_gap_s: 1.5,
            passes: false,
        };
        let events = events_of(&drive_apart("P01", &habits, 300.0), f64::INFINITY);
        assert!(events[at::MOVE_OUT].is_empty() && events[at::MERGE_BACK].is_empty());
        let stayed = events[at::PASS]
            .iter()
            .all(|e| e.outcome == Outcome::Value(0.0));
        assert!(stayed);
        let first = events_of(&drive_apart("P01", &habits, 300.0), 60.0);
        assert!(first.iter().flatten().all(|e| e.time_s < 60.0));
    }
}

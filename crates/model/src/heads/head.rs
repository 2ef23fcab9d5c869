//! The one shape of a head.

use super::family::{Family, Outcome};
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
    /// What was done at a row of a drive.
    pub(super) fn at(drive: &Drive, row: usize, reads: Vec<f64>, outcome: Outcome) -> Self {
        let times = &drive.rows().time_s;
        Self { time_s: times[row] - times[0], reads, outcome }
    }

    /// z: the constant, then what is read.
    pub(crate) fn z(&self) -> impl Iterator<Item = f64> + '_ {
        std::iter::once(1.0).chain(self.reads.iter().copied())
    }
}

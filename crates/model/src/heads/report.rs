//! What a head learned from, and how it does on driving kept back.

use super::{fitted::FittedHead, kept_back::KeptBack, list::HEADS};
use serde::{Deserialize, Serialize};

/// One head: what it learned from, and how it does on driving kept back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeadReport {
    /// Code name.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// Unit of what it predicts.
    pub unit: String,
    /// Events learned from.
    pub events: usize,
    /// Drives among them.
    pub drives: usize,
    /// Share of how drives differ that the style explains; none where nothing was learned.
    pub explained: Option<f64>,
    /// On the last part of drives of people left out; none where too little is kept back.
    pub kept_back: Option<KeptBack>,
}

impl HeadReport {
    pub(super) fn new(fitted: &FittedHead, which: usize, kept_back: Option<KeptBack>) -> Self {
        let head = &HEADS[which];
        let square = fitted.slopes.iter().map(|b| b * b).sum::<f64>();
        let variance = square + fitted.between_sd * fitted.between_sd;
        Self {
            name: head.name.to_owned(),
            title: head.title.to_owned(),
            unit: head.unit.to_owned(),
            events: fitted.events,
            drives: fitted.drives,
            explained: fitted.learned().then(|| square / variance),
            kept_back,
        }
    }
}

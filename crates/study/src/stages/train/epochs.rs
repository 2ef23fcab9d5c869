//! How the epochs of a training go, a line each.

use crate::outcome::Watch;
use maveric_model::EpochReport;
use std::{ops::ControlFlow, time::Instant};

/// Tells how the epochs go: losses, bound, rate.
pub(super) struct EpochProgress<'a> {
    watch: Watch<'a>,
    last: Instant,
    /// Rows a second of the fastest epoch so far.
    rows_per_s: Option<f64>,
}

impl<'a> EpochProgress<'a> {
    pub(super) fn new(watch: Watch<'a>) -> Self {
        Self { watch, last: Instant::now(), rows_per_s: None }
    }

    pub(super) fn show(&mut self, report: &EpochReport) -> ControlFlow<()> {
        let seconds = self.last.elapsed().as_secs_f64();
        self.last = Instant::now();
        // The first epoch includes reading the rows.
        let rate = (report.epoch > 1 && seconds > 0.0).then(|| report.rows as f64 / seconds);
        self.rows_per_s = match (self.rows_per_s, rate) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        };
        let text = epoch_line(report, rate);
        match self.watch.step(report.epoch, report.epochs, &text) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    }

    pub(super) fn rate_line(&self) -> Option<String> {
        let rate = self.rows_per_s?;
        Some(format!("{:.0} thousand rows a second", rate / 1e3))
    }
}

/// An epoch's losses, the bound, and how fast it went.
fn epoch_line(report: &EpochReport, rows_per_s: Option<f64>) -> String {
    let losses = report.validation.unwrap_or(report.losses);
    let terms = [
        losses.following_distance,
        losses.lane_change,
        losses.velocity,
        report.losses.aggression,
        losses.mutual_information,
    ];
    let rows = match report.validation {
        Some(_) => "epochs, people kept back:",
        None => "epochs:",
    };
    let terms = (1..).zip(terms);
    let terms = terms.filter_map(|(number, term)| Some(format!("L{number} {:.3}", term?)));
    let mut parts = vec![format!("{rows} {}", terms.collect::<Vec<String>>().join(" "))];
    let bound = losses.mutual_information_bound;
    parts.extend(bound.map(|bound| format!("I >= {bound:.2} nats")));
    parts.extend(rows_per_s.map(|rate| format!("{:.0}k rows/s", rate / 1e3)));
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_model::LossTerms;

    #[test]
    fn an_epochs_line_names_every_loss_that_there_is() {
        let losses = LossTerms {
            velocity: Some(0.25),
            mutual_information_bound: Some(1.5),
            ..LossTerms::default()
        };
        let report = EpochReport {
            epoch: 2,
            epochs: 3,
            rows: 1000,
            losses,
            total: 0.25,
            validation: None,
            validation_total: None,
        };
        assert_eq!(
            epoch_line(&report, Some(812_345.0)),
            "epochs: L3 0.250, I >= 1.50 nats, 812k rows/s"
        );
    }
}

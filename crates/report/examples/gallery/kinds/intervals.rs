//! Five estimates with floor and ceiling, as a card shows them.

use super::wobble;
use maveric_report::{
    Context, Figure, ReportError,
    figures::intervals::{IntervalRow, Intervals, intervals},
};

pub(crate) fn draw(context: &Context) -> Result<Figure, ReportError> {
    intervals("intervals", "Does it hold?", &input(), context)
}

pub(crate) fn input() -> Intervals {
    let row = |(i, label): (usize, &str)| {
        let value = 0.5 + 0.4 * wobble(i, 61);
        IntervalRow {
            floor: Some(0.3),
            ceiling: Some(0.95),
            ..IntervalRow::new(label, Some(value), Some((value - 0.1, value + 0.1)))
        }
    };
    let labels = ["Mean velocity", "Mean headway time", "Number of lane changes"];
    Intervals {
        axis: "Accuracy".into(),
        rows: labels.into_iter().enumerate().map(row).collect(),
        nothing: None,
        bounds: Some((0.8, f64::INFINITY)),
        what: "*n* = 24, means with 95% CI".into(),
    }
}

//! The errors of many drivers at once: a row a model.

use super::car_following::Follower;
use super::prelude::*;
use maveric_stats::{mean, quantile};

/// One model's error for every driver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelErrors {
    /// Which model.
    pub model: Follower,
    /// Root-mean-square error of the gap over the test third, in metres, one a driver.
    pub gap_rmse_m: Vec<f64>,
}

/// Height of a model's row, in points.
pub(crate) const ROW: f64 = 14.0;

/// Draws, a model a row, the range of nine in ten drives, the quartiles and the mean.
pub(crate) fn paint(
    canvas: &mut Canvas<'_>,
    place: Place,
    labels: &Labels<'_>,
    models: &[ModelErrors],
) {
    let ranges = models.iter().map(|model| {
        let mut values = model.gap_rmse_m.clone();
        values.sort_by(f64::total_cmp);
        [0.05, 0.25, 0.75, 0.95].map(|share| quantile(&values, share).unwrap_or(0.0))
    });
    let ranges: Vec<[f64; 4]> = ranges.collect();
    let most = ranges.iter().map(|range| range[3]).fold(0.1, f64::max);
    let rows = Rows::new(models.iter().map(|model| model.model.label()), 0.6);
    let x = Scale::between(0.0, 1.05 * most, 6);
    let mut panel = Panel::open(canvas, place, labels, (x, rows.axis()));
    for (row, (model, [low, lower, upper, high])) in models.iter().zip(ranges).enumerate() {
        let y = rows.y(row);
        panel.line([(low, y), (high, y)], Pen::new(GREY, stroke::BOX));
        panel.line([(lower, y), (upper, y)], Pen::new(GREY, 3.0));
        if let Some(mean) = mean(&model.gap_rmse_m) {
            let mark = (2.4, model.model.marker(), model.model.colour());
            panel.mark((mean, y), mark);
        }
    }
}

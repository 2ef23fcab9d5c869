//! The errors of many drivers at once: a row a model.

use super::car_following::Follower;
use super::fit;
use super::prelude::*;

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

/// Draws, a model a row, the range of nine in ten drivers, the quartiles and the mean.
pub(crate) fn paint(canvas: &mut Canvas<'_>, place: Place, models: &[ModelErrors], x_title: &str) {
    let last = models.len() as f64 - 1.0;
    let sorted: Vec<Vec<f64>> = models
        .iter()
        .map(|model| {
            let mut values = model.gap_rmse_m.clone();
            values.sort_by(f64::total_cmp);
            values
        })
        .collect();
    let most = sorted.iter().map(|values| fit::quantile(values, 0.95));
    let most = most.fold(0.1, f64::max);
    let names = models.iter().enumerate();
    let ticks = names.map(|(row, model)| (last - row as f64, model.model.label().to_owned()));
    let labels = Labels {
        x: x_title,
        ..Labels::default()
    };
    let y = Scale::labelled(-0.6, last + 0.6, ticks.collect());
    let frame = Frame::draw(
        canvas,
        place,
        &labels,
        Scale::between(0.0, 1.05 * most, 6),
        y,
    );
    for (row, (model, values)) in models.iter().zip(&sorted).enumerate() {
        let y = last - row as f64;
        let [low, lower, upper, high] =
            [0.05, 0.25, 0.75, 0.95].map(|share| frame.at(fit::quantile(values, share), y));
        canvas.line(low, high, Pen::new(GREY, stroke::BOX));
        canvas.line(lower, upper, Pen::new(GREY, 3.0));
        if let Some(mean) = fit::mean(values) {
            canvas.marker(
                frame.at(mean, y),
                2.4,
                model.model.marker(),
                model.model.colour(),
            );
        }
    }
}

//! How far from the recorded gap each model drove, driver by driver.

use super::axes::{Frame, Labels, Scale};
use super::canvas::{Key, Look, Pen, cap_height};
use super::car_following::Follower;
use super::check::Check;
use super::fit;
use super::theme::{GRID, MUTED, size, stroke};
use super::{Context, Figure, Plan, Shows, draw};
use crate::apa::number;
use crate::error::ReportError;
use serde::{Deserialize, Serialize};

/// Errors of several models on the same drivers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FollowingErrors {
    /// Names of the recordings, such as `OpenACC AstaZero`.
    pub data_set: String,
    /// The drivers' ids, one row each.
    pub drivers: Vec<String>,
    /// The models.
    pub models: Vec<ModelErrors>,
}

/// One model's error for every driver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelErrors {
    /// Which model.
    pub model: Follower,
    /// Root-mean-square error of the gap over the test third, in metres, one a driver.
    pub gap_rmse_m: Vec<f64>,
}

const NAME: &str = "following-errors";
const ROW: f64 = 12.0;

/// Draws a row of dots for every driver, and one for the mean.
///
/// # Errors
/// [`ReportError`] if there is no driver or model, lengths differ, or a value is negative or not
/// finite.
pub fn following_errors(input: &FollowingErrors, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "drivers", input.drivers.len())?;
    check.at_least(1, "models", input.models.len())?;
    for model in &input.models {
        check.length(
            model.model.label(),
            model.gap_rmse_m.len(),
            input.drivers.len(),
        )?;
        check.finite("gap_rmse_m", model.gap_rmse_m.iter().copied())?;
        let least = model
            .gap_rmse_m
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        check.that(
            least >= 0.0,
            "gap_rmse_m",
            least,
            "an error of at least 0 m",
        )?;
    }
    let means: Vec<f64> = input
        .models
        .iter()
        .filter_map(|model| fit::mean(&model.gap_rmse_m))
        .collect();
    let found: Vec<String> = input
        .models
        .iter()
        .zip(&means)
        .map(|(model, mean)| format!("{}: {} m.", model.model.label(), number(*mean, 2)))
        .collect();
    let rows = input.drivers.len() + 1;
    let height_points = 58.0 + 10.0 * (input.models.len() as f64 / 3.0).ceil() + ROW * rows as f64;
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (120.0, height_points / 72.0 * 25.4),
        title: "Error of the gap in closed loop, by driver".to_owned(),
        caption: format!(
            "{}: root-mean-square error of the gap over the unseen last third of each drive, in \
             closed loop. Points are networks, short lines what they are held against; the floor was \
             fitted to that third itself. *n* = {} drivers, each with the same weight in the mean.",
            crate::markup::literal(&input.data_set),
            input.drivers.len()
        ),
        alt: format!("Mean over drivers. {}", found.join(" ")),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, mut place| {
        let keys: Vec<(Key, &str)> = input
            .models
            .iter()
            .map(|m| {
                let point = || Key::Point(m.model.marker(), m.model.colour());
                (
                    m.model.mark().map_or_else(point, Key::Line),
                    m.model.label(),
                )
            })
            .collect();
        let mut row = Vec::new();
        let mut top = place.top + 4.0;
        for key in keys {
            row.push(key);
            let wide: f64 = row
                .iter()
                .map(|(_, label)| Look::new(size::TICK).width(label) + 15.5)
                .sum();
            if wide > place.right - place.left && row.len() > 1 {
                let last = row.pop();
                canvas.legend_row((place.left, top), &row);
                row = last.into_iter().collect();
                top += 10.0;
            }
        }
        canvas.legend_row((place.left, top), &row);
        place.top = top + cap_height(size::TICK) + 4.0;
        let most = input
            .models
            .iter()
            .flat_map(|m| &m.gap_rmse_m)
            .copied()
            .fold(0.0, f64::max);
        let x = Scale::between(0.0, 1.05 * most.max(0.1), 6);
        let names = input.drivers.iter().map(String::as_str).chain(["Mean"]);
        let last = rows as f64 - 1.0;
        let ticks = names
            .enumerate()
            .map(|(index, name)| (last - index as f64, crate::markup::literal(name)))
            .collect();
        let y = Scale::labelled(-0.6, rows as f64 - 0.4, ticks);
        let labels = Labels {
            x: "Root-mean-square error of the gap (m)",
            ..Labels::default()
        };
        let frame = Frame::draw(canvas, place, &labels, x, y);
        let (left, right) = (frame.place.left, frame.place.right);
        let divide = frame.y.at(0.5);
        canvas.line(
            (left, divide),
            (right, divide),
            Pen::new(MUTED, stroke::AXIS),
        );
        for index in 0..rows {
            let values: Vec<f64> = input
                .models
                .iter()
                .zip(&means)
                .map(|(model, mean)| model.gap_rmse_m.get(index).copied().unwrap_or(*mean))
                .collect();
            let y = last - index as f64;
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(0.0, f64::max);
            canvas.line(frame.at(low, y), frame.at(high, y), Pen::new(GRID, 2.0));
            for (model, value) in input.models.iter().zip(&values).rev() {
                let (x, y) = frame.at(*value, y);
                match model.model.mark() {
                    Some(pen) => canvas.line((x, y - 4.5), (x, y + 4.5), pen),
                    None => {
                        canvas.marker((x, y), 2.4, model.model.marker(), model.model.colour());
                    }
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_driver_without_an_error_is_refused() {
        let input = FollowingErrors {
            data_set: "x".into(),
            drivers: vec!["a".into(), "b".into()],
            models: vec![ModelErrors {
                model: Follower::Model,
                gap_rmse_m: vec![1.0],
            }],
        };
        let refused = following_errors(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::LengthMismatch { .. })));
    }
}

//! How far from the recorded gap each model drove, driver by driver.

use super::fit;
use super::following_spread as spread;
use super::prelude::*;

pub use super::following_spread::ModelErrors;

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

const NAME: &str = "following-errors";
const X_TITLE: &str = "Root-mean-square error of the gap (m)";
const ROW: f64 = 15.0;
/// Above this many drivers they have no row of their own.
const MOST_DRIVERS: usize = 40;

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
    let crowd = input.drivers.len() > MOST_DRIVERS;
    let height_points = if crowd {
        58.0 + spread::ROW * input.models.len() as f64
    } else {
        58.0 + 10.0 * (input.models.len() as f64 / 3.0).ceil() + ROW * rows as f64
    };
    let shown = if crowd {
        "Thin lines hold nine in ten drivers, thick lines the middle half, points are means over drivers"
    } else {
        "Points are networks, short lines what they are held against, above each other where they would meet"
    };
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (120.0, height_points / 72.0 * 25.4),
        title: "Error of the gap in closed loop, by driver".to_owned(),
        caption: format!(
            "{}: root-mean-square error of the gap over the unseen last third of each drive, in \
             closed loop. {shown}; the floor was fitted to that third itself. *n* = {} drivers, each with \
             the same weight in the mean; no test.",
            crate::markup::literal(&input.data_set),
            input.drivers.len()
        ),
        alt: format!("Mean over drivers. {}", found.join(" ")),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, place| {
        if crowd {
            return spread::paint(canvas, place, &input.models, X_TITLE);
        }
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
        let place = canvas.legend(place, &keys);
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
            x: X_TITLE,
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
            let offsets = apart(&values.iter().map(|v| frame.x.at(*v)).collect::<Vec<_>>());
            for ((model, value), offset) in input.models.iter().zip(&values).zip(offsets).rev() {
                let (x, y) = frame.at(*value, y);
                let y = y + offset;
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

/// How far markers at these places move up or down so that none hides another, in points.
fn apart(places: &[f64]) -> Vec<f64> {
    const LEVELS: [f64; 3] = [0.0, -4.2, 4.2];
    const WIDE: f64 = 4.6;
    let mut taken: Vec<(f64, f64)> = Vec::new();
    places
        .iter()
        .map(|&x| {
            let free = |level: &&f64| {
                let mut here = taken.iter().filter(|(_, at)| (at - **level).abs() < 0.1);
                here.all(|(other, _)| (other - x).abs() >= WIDE)
            };
            let level = *LEVELS.iter().find(free).unwrap_or(&0.0);
            taken.push((x, level));
            level
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::car_following::Follower;
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

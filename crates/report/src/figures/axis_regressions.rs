//! What each axis of the style space goes with: every measure against every axis.

use super::axes::{Frame, Labels, Scale};
use super::check::Check;
use super::crowd;
use super::regression::{Regression, y_scale};
use super::theme::{GREEN, INK, Marker, TWO_COLUMNS_MM};
use super::{Context, Figure, Plan, Shows, draw};
use crate::error::ReportError;
use crate::markup;
use serde::{Deserialize, Serialize};

/// A grid of scatter plots: a row a measure, a column an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AxisRegressions {
    /// The axes, the style line first.
    pub axes: Vec<StyleAxis>,
    /// The measures, from top to bottom; at most 8.
    pub measures: Vec<AxisMeasure>,
}

/// One direction of the style space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StyleAxis {
    /// Title of the axis with the unit: `Aggression (SD)`.
    pub title: String,
    /// Where each driver lies on it.
    pub positions: Vec<f64>,
}

/// One measure against every axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AxisMeasure {
    /// Title with the unit: `Mean velocity (mph)`.
    pub title: String,
    /// The drivers' values, in the order of the positions; `None`: has none.
    pub values: Vec<Option<f64>>,
    /// For each axis its test, with marks. Shown above the panel.
    pub statistics: Vec<String>,
}

const NAME: &str = "axis-regressions";
const MOST_AXES: usize = 4;
const MOST_MEASURES: usize = 8;

/// Draws each measure against each axis, with line, 95% band and test.
///
/// # Errors
/// [`ReportError`] if there is no axis or measure, more than 4 axes or 8 measures, nobody, lengths differ, or a value
/// is not finite.
///
/// # Source
/// Method, sections 4 and 9.1: the style line; 9.4: what is perpendicular to it. The picture is ours.
pub fn axis_regressions(input: &AxisRegressions, context: &Context) -> Result<Figure, ReportError> {
    check(input)?;
    let drivers = input.axes[0].positions.len();
    let missing: Vec<String> = input
        .measures
        .iter()
        .filter_map(|measure| {
            let n = measure.values.iter().flatten().count();
            (n < drivers).then(|| format!(" ({n} with a value: {})", measure.title))
        })
        .collect();
    let found = input.measures.iter().flat_map(|measure| {
        let tests = input.axes.iter().zip(&measure.statistics);
        tests.map(|(axis, test)| {
            format!(
                "{} against {}: {}.",
                measure.title,
                axis.title,
                markup::plain(test)
            )
        })
    });
    let (columns, rows) = (input.axes.len(), input.measures.len());
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (
            (TWO_COLUMNS_MM / 3.0 * columns as f64).clamp(85.0, TWO_COLUMNS_MM),
            46.0 * rows as f64 + 5.0,
        ),
        title: "What each axis of the style space goes with".to_owned(),
        caption: format!(
            "Each driver’s position on the axes of the style space against measures of their own drive; the first \
             axis is the style line, the others are perpendicular to it. Lines: least squares with 95% bands. \
             The test stands above each panel; *p* values are not adjusted. *n* = {drivers} drivers{}.{}",
            missing.concat(),
            crowd::words(drivers)
        ),
        alt: found.collect::<Vec<_>>().join(" "),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, whole| {
        for (row, measure) in input.measures.iter().enumerate() {
            for (column, axis) in input.axes.iter().enumerate() {
                let place = whole.cell((column, row), (columns, rows), (11.0, 9.0));
                let pairs = axis.positions.iter().zip(&measure.values);
                let points: Vec<(f64, f64)> =
                    pairs.filter_map(|(x, y)| Some((*x, (*y)?))).collect();
                let line = Regression::of(&points);
                let labels = Labels {
                    subtitle: &measure.statistics[column],
                    x: &axis.title,
                    y: if column == 0 { &measure.title } else { "" },
                    ..Labels::default()
                };
                let x = Scale::over(axis.positions.iter().copied(), 4);
                let y = y_scale(&points, line.as_ref(), 4);
                let frame = Frame::draw(canvas, place, &labels, x, y);
                let (marker, ink) = if column == 0 {
                    (Marker::Circle, INK)
                } else {
                    (Marker::Diamond, GREEN)
                };
                if let Some(line) = line {
                    line.paint(canvas, &frame, ink);
                }
                crowd::paint(canvas, &frame, &points, 1.5, (marker, ink));
            }
        }
    })
}

fn check(input: &AxisRegressions) -> Result<(), ReportError> {
    let check = Check(NAME);
    let most = [
        ("axes", input.axes.len(), MOST_AXES, "1 to 4 axes"),
        (
            "measures",
            input.measures.len(),
            MOST_MEASURES,
            "1 to 8 measures: choose some",
        ),
    ];
    for (what, found, most, expected) in most {
        check.at_least(1, what, found)?;
        check.that(found <= most, what, found as f64, expected)?;
    }
    let drivers = input.axes[0].positions.len();
    check.at_least(1, "drivers", drivers)?;
    for axis in &input.axes {
        check.length(&axis.title, axis.positions.len(), drivers)?;
        check.finite(&axis.title, axis.positions.iter().copied())?;
    }
    for measure in &input.measures {
        check.length(&measure.title, measure.values.len(), drivers)?;
        check.length("statistics", measure.statistics.len(), input.axes.len())?;
        check.finite(&measure.title, measure.values.iter().flatten().copied())?;
        check.at_least(1, "values", measure.values.iter().flatten().count())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_driver_without_a_value_is_counted_in_the_caption() {
        let input = AxisRegressions {
            axes: vec![StyleAxis {
                title: "Aggression (SD)".into(),
                positions: vec![-1.0, 0.0, 1.0, 2.0],
            }],
            measures: vec![AxisMeasure {
                title: "Merge back (m)".into(),
                values: vec![Some(60.0), None, Some(45.0), Some(44.0)],
                statistics: vec!["*r*(1) = −.95".into()],
            }],
        };
        let figure = axis_regressions(&input, &Context::real()).unwrap();
        assert!(
            figure
                .caption
                .contains("*n* = 4 drivers (3 with a value: Merge back (m))")
        );
    }
}

//! Where drivers lie on the style line, against what they do and say.

use super::crowd;
use super::prelude::*;
use super::regression::Cloud;

/// Panels of the same people, one a measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AggressionLine {
    /// The panels; three to a row.
    pub panels: Vec<LinePanel>,
}

/// One measure against the position on the line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LinePanel {
    /// Such as `Mean velocity`.
    pub title: String,
    /// Title of the axis with the unit: `Mean velocity (mph)`.
    pub axis: String,
    /// (position on the line, in standard deviations of the training embeddings; measure).
    pub points: Vec<(f64, f64)>,
    /// The test, with marks. Shown as the subtitle.
    pub statistic: String,
}

const NAME: &str = "aggression-line";

/// Draws each measure against the position on the style line, with line and band.
///
/// # Errors
/// [`ReportError`] if there is no panel, a panel is empty or a value is not finite.
///
/// # Source
/// Method, sections 4 and 9.1. The paper gives these correlations in its text, without a figure.
pub fn aggression_line(input: &AggressionLine, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.at_least(1, "participants", panel.points.len())?;
        check.finite("position", panel.points.iter().map(|point| point.0))?;
        check.finite(&panel.title, panel.points.iter().map(|point| point.1))?;
    }
    let grid = Grid::limited(input.panels.len(), 3, (10.0, 9.0));
    let sizes = input.panels.iter().map(|panel| panel.points.len());
    let panels = input.panels.iter();
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM * grid.columns as f64 / 3.0, 55.0 * grid.rows() + 3.0),
        title: "Position on the style line against each measure".to_owned(),
        caption: format!(
            "Each test participant’s position on the style line (the projection of the \
             embedding on the gradient of the style predictor) against each measure of their own \
             drive, in standard deviations of the training drivers. Line: least squares, with its \
             95% band. *n* = {}. The correlation and its test stand below each title.{}",
            counted(sizes.clone(), ", by panel (not every drive has a value of every measure)"),
            crowd::words(sizes.max().unwrap_or(0))
        ),
        alt: described(panels.map(|p| (p.title.as_str(), p.statistic.as_str()))),
        shows: Shows::Participants,
    };
    draw_panels(plan, context, grid, &[], |canvas, index, place| {
        let panel = &input.panels[index];
        let labels = Labels {
            title: &panel.title,
            subtitle: &panel.statistic,
            x: "Position on the style line (SD)",
            y: &panel.axis,
            ..Labels::default()
        };
        let cloud = Cloud { points: &panel.points, ticks: 4, radius: 1.6 };
        cloud.paint(canvas, place, &labels, &[]);
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(points: Vec<(f64, f64)>) -> AggressionLine {
        AggressionLine {
            panels: vec![LinePanel {
                title: "Mean velocity".into(),
                axis: "Mean velocity (mph)".into(),
                points,
                statistic: "*r*(2) = .49".into(),
            }],
        }
    }

    #[test]
    fn participants_at_one_position_are_drawn_without_a_line() {
        let figure =
            aggression_line(&input(vec![(1.0, 2.0), (1.0, 3.0), (1.0, 4.0)]), &Context::real());
        assert!(!figure.unwrap().svg.contains("<polygon"));
    }

    #[test]
    fn nobody_is_an_error_and_not_an_empty_picture() {
        let refused = aggression_line(&input(Vec::new()), &Context::real());
        assert!(matches!(refused, Err(ReportError::TooFew { .. })));
    }
}

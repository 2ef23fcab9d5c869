//! How much of a drive it takes to know a driver.

use super::prelude::*;

/// What personalising reaches after some minutes of driving, panel by panel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearningCurve {
    /// One panel a quantity.
    pub panels: Vec<LearningPanel>,
    /// Drivers, for the caption.
    pub drivers: usize,
    /// What the points were judged on, as a sentence: `Losses on the last fifth of each drive.`
    pub judged_on: String,
}

/// One quantity against minutes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearningPanel {
    /// Such as `*L*_{2} lane change`; with marks.
    pub title: String,
    /// Title of the axis, with the unit.
    pub axis: String,
    /// Ascending in minutes.
    pub points: Vec<LearningPoint>,
    /// The same quantity for the mean training embedding: what is known before the first minute.
    pub before: Option<f64>,
}

/// A mean over drivers with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LearningPoint {
    /// Minutes driven.
    pub minutes: f64,
    /// Mean over drivers.
    pub mean: f64,
    /// Low end of its 95% interval.
    pub low: f64,
    /// High end.
    pub high: f64,
}

const NAME: &str = "learning-curve";

/// Draws each quantity against the minutes driven.
///
/// # Errors
/// [`ReportError`] if there is no panel, a panel has no point, minutes do not ascend, or a value is not finite.
pub fn learning_curve(input: &LearningCurve, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.at_least(1, "points", panel.points.len())?;
        let values = panel
            .points
            .iter()
            .flat_map(|p| [p.minutes, p.mean, p.low, p.high]);
        check.finite("a point", values.chain(panel.before))?;
        for pair in panel.points.windows(2) {
            let ascends = pair[0].minutes < pair[1].minutes;
            check.that(ascends, "minutes", pair[1].minutes, "ascending minutes")?;
        }
    }
    let found: Vec<String> = input
        .panels
        .iter()
        .map(|panel| {
            let (first, last) = (panel.points[0], panel.points[panel.points.len() - 1]);
            format!(
                "{}: {} after {} min, {} after {} min.",
                crate::markup::plain(&panel.title),
                number(first.mean, 3),
                number(first.minutes, 0),
                number(last.mean, 3),
                number(last.minutes, 0)
            )
        })
        .collect();
    let columns = input.panels.len().clamp(1, 4);
    let rows = input.panels.len().div_ceil(columns);
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 56.0 * rows as f64 + 6.0),
        title: "How much driving it takes to know a driver".to_owned(),
        caption: format!(
            "Embeddings fitted to the first minutes of a drive. {} Points: mean over drivers, 95% intervals; \
             dashed: the mean training embedding. *n* = {} drivers; no test.",
            input.judged_on, input.drivers
        ),
        alt: found.join(" "),
        shows: Shows::Participants,
    };
    let known = input.panels.iter().any(|panel| panel.before.is_some());
    let dashed = Pen::new(GREY, stroke::STRONG).dashed(3.0, 2.0);
    draw_panels_below(
        plan,
        context,
        Grid::new(input.panels.len(), columns, (10.0, 9.0)),
        |canvas, mut whole| {
            if known {
                let keys = [
                    (Key::Point(Marker::Circle, INK), "fitted to the driver"),
                    (Key::Line(dashed), "mean training embedding"),
                ];
                canvas.legend_row((whole.left, whole.top + 4.0), &keys);
                whole.top += cap_height(size::TICK) + 8.0;
            }
            whole
        },
        |canvas, index, place| {
            let panel = &input.panels[index];
            let last = panel.points[panel.points.len() - 1].minutes;
            let values = panel.points.iter().flat_map(|p| [p.low, p.high]);
            let y = Scale::over(values.chain(panel.before), 4);
            let labels = Labels {
                title: &panel.title,
                x: "Minutes driven",
                y: &panel.axis,
                ..Labels::default()
            };
            let x = Scale::between(0.0, 1.05 * last, 5);
            let frame = Frame::draw(canvas, place, &labels, x, y);
            if let Some(before) = panel.before {
                canvas.line(frame.at(0.0, before), frame.at(last, before), dashed);
            }
            let path: Vec<(f64, f64)> = panel
                .points
                .iter()
                .map(|p| frame.at(p.minutes, p.mean))
                .collect();
            canvas.path(&path, Pen::new(INK, stroke::STRONG));
            for point in &panel.points {
                let ends = [
                    frame.at(point.minutes, point.low),
                    frame.at(point.minutes, point.high),
                ];
                canvas.line(ends[0], ends[1], Pen::new(INK, stroke::AXIS));
                canvas.marker(
                    frame.at(point.minutes, point.mean),
                    2.0,
                    Marker::Circle,
                    INK,
                );
            }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minutes_out_of_order_are_refused() {
        let point = |minutes| LearningPoint {
            minutes,
            mean: 1.0,
            low: 0.9,
            high: 1.1,
        };
        let panel = LearningPanel {
            title: "L".into(),
            axis: "loss".into(),
            points: vec![point(2.0), point(1.0)],
            before: None,
        };
        let input = LearningCurve {
            panels: vec![panel],
            drivers: 3,
            judged_on: String::new(),
        };
        let refused = learning_curve(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

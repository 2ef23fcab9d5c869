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
        let values = panel.points.iter().flat_map(LearningPoint::numbers);
        check.finite("a point", values.chain(panel.before))?;
        let minutes = panel.points.iter().map(|p| p.minutes);
        check.rising("minutes", minutes, "ascending minutes")?;
    }
    let grid = Grid::limited(input.panels.len(), 4, (10.0, 9.0));
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 56.0 * grid.rows() + 6.0),
        title: "How much driving it takes to know a driver".to_owned(),
        caption: format!(
            "Embeddings fitted to the first minutes of a drive. {} Points: mean over drivers, 95% intervals; \
             dashed: the mean training embedding. *n* = {} drivers; no test.",
            input.judged_on, input.drivers
        ),
        alt: sentences(input.panels.iter().map(LearningPanel::ends)),
        shows: Shows::Participants,
    };
    let dashed = Pen::new(GREY, stroke::STRONG).dashed(3.0, 2.0);
    let keys = [
        (Key::Point(Marker::Circle, INK), "fitted to the driver"),
        (Key::Line(dashed), "mean training embedding"),
    ];
    let known = input.panels.iter().any(|panel| panel.before.is_some());
    let keys = if known { &keys[..] } else { &[] };
    draw_panels(plan, context, grid, keys, |canvas, index, place| {
        let LearningPanel { points, before, .. } = &input.panels[index];
        let last = points[points.len() - 1].minutes;
        let values = points.iter().flat_map(|p| [p.low, p.high]);
        let labels = Labels {
            title: &input.panels[index].title,
            x: "Minutes driven",
            y: &input.panels[index].axis,
            ..Labels::default()
        };
        let x = Scale::between(0.0, 1.05 * last, 5);
        let y = Scale::over(values.chain(*before), 4);
        let mut panel = Panel::open(canvas, place, &labels, (x, y));
        if let Some(before) = *before {
            panel.line([(0.0, before), (last, before)], dashed);
        }
        let points: Vec<[f64; 4]> = points.iter().map(LearningPoint::numbers).collect();
        panel.curve(&points, (2.0, Marker::Circle, INK));
    })
}

impl LearningPoint {
    fn numbers(&self) -> [f64; 4] {
        [self.minutes, self.mean, self.low, self.high]
    }
}

impl LearningPanel {
    /// Where it begins and ends, in words.
    fn ends(&self) -> String {
        let after = |p: &LearningPoint| {
            let (mean, minutes) = (number(p.mean, 3), number(p.minutes, 0));
            format!("{mean} after {minutes} min")
        };
        let (first, last) = (&self.points[0], &self.points[self.points.len() - 1]);
        let title = markup::plain(&self.title);
        format!("{title}: {}, {}.", after(first), after(last))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minutes_out_of_order_are_refused() {
        let point = |minutes| LearningPoint { minutes, mean: 1.0, low: 0.9, high: 1.1 };
        let panel = LearningPanel {
            title: "L".into(),
            axis: "loss".into(),
            points: vec![point(2.0), point(1.0)],
            before: None,
        };
        let input = LearningCurve { panels: vec![panel], drivers: 3, judged_on: String::new() };
        let refused = learning_curve(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

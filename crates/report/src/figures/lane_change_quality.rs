//! How well the car changes lane, at every speed it does so.

use super::crowd;
use super::prelude::*;

/// Lane changes at several speeds, judged by several quantities.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LaneChangeQuality {
    /// Speed of each lane change, in m/s.
    pub speed_mps: Vec<f64>,
    /// The quantities; three to a row.
    pub panels: Vec<QualityPanel>,
    /// How the changes were made, as a sentence: `Changes of 4.8 s to the left on a dry road.`
    pub manoeuvre: String,
}

/// One quantity over speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QualityPanel {
    /// Such as `Lateral error`.
    pub title: String,
    /// Title of the axis with the unit: `Largest (m)`.
    pub axis: String,
    /// One value a lane change, not negative.
    pub values: Vec<f64>,
    /// What should not be passed, and its name: `(2.0, "comfort")`.
    pub limit: Option<(f64, String)>,
}

const NAME: &str = "lane-change-quality";

/// Draws each quantity against speed, with the limit that it should stay below.
///
/// # Errors
/// [`ReportError`] if there is no lane change or panel, lengths differ, or a value is negative or not finite.
///
/// # Source
/// Method, section 6: lane changes and the path controller.
pub fn lane_change_quality(
    input: &LaneChangeQuality,
    context: &Context,
) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    let changes = input.speed_mps.len();
    check.at_least(1, "lane changes", changes)?;
    check.at_least(1, "panels", input.panels.len())?;
    check.finite("speed_mps", input.speed_mps.iter().copied())?;
    for panel in &input.panels {
        check.length(&panel.title, panel.values.len(), changes)?;
        let limit = panel.limit.as_ref().map(|limit| limit.0);
        for value in panel.values.iter().copied().chain(limit) {
            let fits = value >= 0.0 && value.is_finite();
            check.that(fits, &panel.title, value, "a finite size, at least 0")?;
        }
    }
    let above: usize = input.panels.iter().map(QualityPanel::beyond).sum();
    let limits = if input.panels.iter().any(|p| p.limit.is_some()) {
        format!("; dashed: the limit, which {above} values pass")
    } else {
        String::new()
    };
    let grid = Grid::limited(input.panels.len(), 3, (11.0, 10.0));
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (grid.width_mm(), 55.0 * grid.rows() + 3.0),
        title: "Quality of the lane changes over speed".to_owned(),
        caption: format!(
            "{} Each point is the largest value in one lane change{limits}.{} \
             Simulated runs of the controllers: no data of participants. *n* = {changes} lane changes; no test.",
            input.manoeuvre,
            crowd::words(changes).replace("participants", "lane changes")
        ),
        alt: sentences(input.panels.iter().map(QualityPanel::words)),
        shows: Shows::Explanation,
    };
    draw_panels(plan, context, grid, &[], |canvas, index, place| {
        let QualityPanel {
            title,
            axis,
            values,
            limit,
        } = &input.panels[index];
        let labels = Labels {
            title,
            x: "Speed (m/s)",
            y: axis,
            ..Labels::default()
        };
        let limit_value = limit.as_ref().map(|limit| limit.0);
        let most = values
            .iter()
            .copied()
            .chain(limit_value)
            .fold(0.0, f64::max);
        let top = if most > 0.0 { 1.12 * most } else { 1.0 };
        let x = Scale::over(input.speed_mps.iter().copied(), 5);
        let mut panel = Panel::open(canvas, place, &labels, (x, Scale::between(0.0, top, 4)));
        if let Some((limit, name)) = limit {
            panel.level(*limit, Pen::new(GREY, stroke::BOX).dashed(3.0, 2.0));
            let (left, y) = (panel.frame.place.left, panel.frame.y.at(*limit));
            let look = Look::new(size::SMALL).colour(MUTED);
            panel.canvas.text(name, (left + 3.0, y - 2.0), look);
        }
        let points = input.speed_mps.iter().copied().zip(values.iter().copied());
        let (points, look): (Vec<_>, _) = (points.collect(), (Marker::Circle, INK));
        crowd::paint(panel.canvas, &panel.frame, &points, 1.6, look);
    })
}

impl QualityPanel {
    /// How many values pass the limit.
    fn beyond(&self) -> usize {
        let limit = self.limit.as_ref().map_or(f64::INFINITY, |limit| limit.0);
        self.values.iter().filter(|value| **value > limit).count()
    }

    fn words(&self) -> String {
        let most = self.values.iter().copied().fold(0.0, f64::max);
        let limit = self
            .limit
            .as_ref()
            .map_or_else(String::new, |(limit, name)| {
                let (beyond, changes) = (self.beyond(), self.values.len());
                let limit = number(*limit, 2);
                format!(", {beyond} of {changes} above the limit {name} ({limit})")
            });
        format!("{}: at most {}{limit}.", self.title, number(most, 2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_above_the_limit_are_counted() {
        let input = LaneChangeQuality {
            speed_mps: vec![20.0, 25.0, 30.0],
            panels: vec![QualityPanel {
                title: "Lateral acceleration".into(),
                axis: "Largest (m/s²)".into(),
                values: vec![1.2, 1.9, 2.4],
                limit: Some((2.0, "comfort".into())),
            }],
            manoeuvre: "Changes of 4.8 s.".into(),
        };
        let figure = lane_change_quality(&input, &Context::real()).unwrap();
        assert!(figure.caption.contains("which 1 values pass"));
        assert!(figure.alt.contains("1 of 3 above the limit comfort (2.00)"));
    }
}

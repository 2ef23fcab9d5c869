//! Two columns against each other, with their line and band.

use super::crowd;
use super::prelude::*;
use super::regression::Cloud;

/// Points, and what is said of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scatter {
    /// Title of the x axis. Plain text.
    pub x: String,
    /// Title of the y axis. Plain text.
    pub y: String,
    /// The pairs.
    pub points: Vec<(f64, f64)>,
    /// The test, with marks, shown above the panel.
    pub test: String,
    /// Parallel lines of people, each by its ends, in the place of one line through all points; empty: one line.
    pub people: Vec<[(f64, f64); 2]>,
}

const NAME: &str = "scatter";

/// Draws the points, the least-squares line with its 95% band, or each person's line of a common slope.
///
/// # Errors
/// [`ReportError`] if there is no point, or a number is not finite.
///
/// # Source
/// Lines of people as Bakdash and Marusich (2017) draw their correlation within people.
pub fn scatter(input: &Scatter, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "points", input.points.len())?;
    let ends = input.people.iter().flatten();
    check.finite("points", input.points.iter().chain(ends).flat_map(|&(x, y)| [x, y]))?;
    let n = input.points.len();
    let test = markup::plain(&input.test);
    let lines = if input.people.is_empty() {
        "Line: least squares with its 95% band."
    } else {
        "Lines: one a person, of the slope that they have in common."
    };
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (ONE_COLUMN_MM, 75.0),
        title: format!("{} and {}", input.y, input.x),
        caption: format!("Each point is a pair of values, *n* = {n}. {lines}{}", crowd::words(n)),
        alt: format!("{} against {}: {test}.", input.y, input.x),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, place| {
        let (x, y) = (markup::literal(&input.x), markup::literal(&input.y));
        let labels = Labels { subtitle: &input.test, x: &x, y: &y, ..Labels::default() };
        let cloud = Cloud { points: &input.points, ticks: 5, radius: 1.5 };
        cloud.paint(canvas, place, &labels, &input.people);
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_point_is_drawn_and_an_infinite_one_refused() {
        let mut input = Scatter {
            x: "age_y".into(),
            y: "speed".into(),
            points: vec![(1.0, 2.0)],
            test: String::new(),
            people: Vec::new(),
        };
        let figure = scatter(&input, &Context::real()).unwrap();
        assert!(figure.svg.contains("age_y"));
        input.people = vec![[(0.0, 1.0), (f64::INFINITY, 1.0)]];
        assert!(scatter(&input, &Context::real()).is_err());
    }
}

//! The recommended shift of the dial against the preferred one.

use super::prelude::*;

/// People with their preference and what was recommended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recommendations {
    /// What the dial is counted in, such as `ADB points`.
    pub unit: String,
    /// Preferred shift, recommended shift, low and high end of its interval; a person each.
    pub people: Vec<[f64; 4]>,
    /// People that the model was learned from.
    pub learned_from: usize,
}

const NAME: &str = "recommendation";
/// Near enough, in points of the dial.
const NEAR: f64 = 5.0;

/// Draws a point a person with its interval, and the band of ±5 points around a perfect recommendation.
///
/// # Errors
/// [`ReportError`] if there is nobody, or a value is not finite.
pub fn recommendation(input: &Recommendations, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "people", input.people.len())?;
    check.finite("a shift", input.people.iter().flatten().copied())?;
    let near = input
        .people
        .iter()
        .filter(|p| (p[0] - p[1]).abs() <= NEAR)
        .count();
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (ONE_COLUMN_MM + 10.0, 84.0),
        title: "Recommended against preferred shift".to_owned(),
        caption: format!(
            "New people after the conditions of the study, by a model learned from {} others. Lines: 95% intervals; band: within 5 points. *n* = {}.",
            input.learned_from,
            input.people.len()
        ),
        alt: format!(
            "{near} of {} recommendations lie within 5 points of the preferred shift.",
            input.people.len()
        ),
        shows: Shows::Participants,
    };
    let [preferred, recommended] =
        ["Preferred", "Recommended"].map(|which| format!("{which} shift ({})", input.unit));
    draw(plan, context, |canvas, place| {
        let labels = Labels {
            x: &preferred,
            y: &recommended,
            ..Labels::default()
        };
        let ends = input
            .people
            .iter()
            .flatten()
            .map(|v| v.abs())
            .fold(15.0, f64::max)
            + 1.0;
        let scale = || Scale::between(-ends, ends, 6);
        let frame = Frame::draw(canvas, place, &labels, scale(), scale());
        let inner = ends - NEAR;
        let corners = [
            (-ends, -inner),
            (inner, ends),
            (ends, ends),
            (ends, inner),
            (-inner, -ends),
            (-ends, -ends),
        ];
        canvas.polygon(&corners.map(|(x, y)| frame.at(x, y)), PALE, 1.0);
        let dashed = Pen::new(MUTED, stroke::AXIS).dashed(2.0, 2.0);
        canvas.line(frame.at(-ends, -ends), frame.at(ends, ends), dashed);
        for [truth, found, low, high] in &input.people {
            canvas.line(
                frame.at(*truth, *low),
                frame.at(*truth, *high),
                Pen::new(GREY, stroke::AXIS),
            );
            canvas.marker(frame.at(*truth, *found), 1.8, Marker::Circle, INK);
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_and_far_people_are_counted() {
        let input = Recommendations {
            unit: "ADB points".to_owned(),
            people: vec![[3.0, 5.0, -2.0, 12.0], [-14.0, -2.0, -12.0, 8.0]],
            learned_from: 24,
        };
        let figure = recommendation(&input, &Context::synthetic(1)).unwrap();
        assert!(figure.alt.starts_with("1 of 2") && !figure.svg.contains("NaN"));
        let nobody = Recommendations {
            unit: "ADB points".to_owned(),
            people: vec![],
            ..input
        };
        assert!(recommendation(&nobody, &Context::real()).is_err());
    }
}

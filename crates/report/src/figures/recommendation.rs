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
    let people = input.people.len();
    check.at_least(1, "people", people)?;
    check.finite("a shift", input.people.iter().flatten().copied())?;
    let near = |p: &&[f64; 4]| (p[0] - p[1]).abs() <= NEAR;
    let near = input.people.iter().filter(near).count();
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (ONE_COLUMN_MM + 10.0, 84.0),
        title: "Recommended against preferred shift".to_owned(),
        caption: format!(
            "New people after the conditions of the study, by a model learned from {} others. Lines: 95% intervals; band: within 5 points. *n* = {people}.",
            input.learned_from,
        ),
        alt: format!(
            "{near} of {people} recommendations lie within 5 points of the preferred shift."
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
        let far = input.people.iter().flatten().map(|v| v.abs());
        let ends = far.fold(15.0, f64::max) + 1.0;
        let scale = Scale::between(-ends, ends, 6);
        let mut panel = Panel::open(canvas, place, &labels, (scale.clone(), scale));
        let inner = ends - NEAR;
        let half = [(-ends, -inner), (inner, ends), (ends, ends)];
        let other = half.map(|(x, y)| (-x, -y));
        panel.area(&[half, other].concat(), PALE, 1.0);
        let alike = Pen::new(MUTED, stroke::AXIS).dashed(2.0, 2.0);
        panel.line([(-ends, -ends), (ends, ends)], alike);
        let pen = Pen::new(GREY, stroke::AXIS);
        for &[truth, shift, low, high] in &input.people {
            panel.upright_interval(truth, [shift, low, high], pen, (1.8, Marker::Circle, INK));
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

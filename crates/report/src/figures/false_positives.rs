//! How often each test says yes where there is nothing to find.

use super::prelude::*;

/// False-positive rates by part of the report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FalsePositives {
    /// The parts from top to bottom.
    pub parts: Vec<PartRates>,
    /// Families of tests after Holm's correction: name, rate of any false positive, its 95 % interval.
    pub families: Vec<(String, f64, (f64, f64))>,
    /// Simulated studies.
    pub studies: usize,
    /// Participants of each.
    pub participants: usize,
}

/// The tests of one part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartRates {
    /// Such as `Pairs of conditions`.
    pub name: String,
    /// Rate of each test, 0 to 1.
    pub rates: Vec<f64>,
}

const NAME: &str = "false-positives";
const LEVEL: f64 = 0.05;
const TOLERANCE: f64 = 0.01;

/// Whether a rate is the level, within the tolerance: both ends belong to it, whatever a difference rounds to.
fn near(rate: f64) -> bool {
    (rate - LEVEL).abs() <= TOLERANCE + 1e-9
}

/// Draws a point a test, with the level and ±.01 around it, and the families' rates after Holm below.
///
/// # Errors
/// [`ReportError`] if there is no part or no study, or a rate is not between 0 and 1.
pub fn false_positives(input: &FalsePositives, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "parts", input.parts.len())?;
    check.at_least(1, "studies", input.studies)?;
    let rates = || input.parts.iter().flat_map(|p| p.rates.iter().copied());
    let families = input.families.iter();
    let intervals = families.map(|(_, rate, (low, high))| [*rate, *low, *high]);
    let every = || rates().chain(intervals.clone().flatten());
    check.within((0.0, 1.0), "a rate", every(), "0 to 1")?;
    let tests = rates().count();
    let within = rates().filter(|&rate| near(rate)).count();
    let parts = input.parts.iter();
    let parts = parts.map(|p| format!("{} ({})", p.name, p.rates.len()));
    let families = input.families.iter().map(|(name, ..)| format!("Any in {name}"));
    let rows = Rows::new(parts.chain(families), 0.7);
    let count = input.parts.len() + input.families.len();
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 26.0 + 5.4 * count as f64),
        title: "False positives where there is nothing to find".to_owned(),
        caption: format!(
            "Points: a test each, share of the simulated studies without any effect in which *p* < .05; \
             band: .05 ± .01. Squares: share of studies with any false positive in a family after Holm, 95% intervals. \
             *n* = {} studies of {} participants.",
            input.studies, input.participants
        ),
        alt: format!("{within} of {tests} tests have a rate of .05 within .01."),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, whole| {
        let keys = [
            (Key::Point(Marker::Circle, INK), "a test, uncorrected"),
            (Key::Point(Marker::Square, PURPLE), "a family, after Holm"),
        ];
        let place = canvas.legend(whole, &keys);
        let labels = Labels { x: "Share of studies with p < .05", ..Labels::default() };
        let x = Scale::over(every().chain([0.0, 0.08]), 6);
        let mut panel = Panel::open(canvas, place, &labels, (x, rows.axis()));
        panel.stripe([LEVEL - TOLERANCE, LEVEL + TOLERANCE], PALE, 1.0);
        panel.upright(LEVEL, Pen::new(MUTED, stroke::AXIS).dashed(2.0, 2.0));
        for (row, part) in input.parts.iter().enumerate() {
            let count = part.rates.len().max(1) as f64;
            for (i, &rate) in part.rates.iter().enumerate() {
                // Spread over the row in the order of the tests, so that none hides another.
                let off = ((i as f64 + 0.5) / count - 0.5) * 0.6;
                let tone = if near(rate) { GREY } else { INK };
                panel.mark((rate, rows.y(row) + off), (1.2, Marker::Circle, tone));
            }
        }
        for (i, interval) in intervals.clone().enumerate() {
            let (y, pen) = (rows.y(input.parts.len() + i), Pen::new(INK, stroke::BOX));
            panel.level_interval(interval, y, pen, (2.0, Marker::Square, PURPLE));
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_above_one_is_refused_and_others_are_drawn() {
        let input = |rate| FalsePositives {
            parts: vec![PartRates { name: "pairs".into(), rates: vec![0.04, rate] }],
            families: vec![("panel".into(), 0.03, (0.02, 0.05))],
            studies: 400,
            participants: 24,
        };
        let figure = false_positives(&input(0.2), &Context::synthetic(1)).unwrap();
        assert!(figure.alt.starts_with("1 of 2"), "{}", figure.alt);
        let refused = false_positives(&input(1.2), &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

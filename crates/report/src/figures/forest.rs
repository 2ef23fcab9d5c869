//! Many contrasts under each other: estimates with their intervals.

use super::prelude::*;
use crate::apa::decimals;

/// Contrasts or coefficients, from top to bottom.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Forest {
    /// What is estimated, as a title: `Differences of trust`. Plain text.
    pub title: String,
    /// Title of the axis, with marks: `*d*_{z} (95% CI)`.
    pub axis: String,
    /// The contrasts; at most 60.
    pub rows: Vec<ForestRow>,
    /// Differences that count as none, shaded.
    pub bounds: Option<(f64, f64)>,
    /// People behind the estimates.
    pub n: usize,
}

/// One contrast.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForestRow {
    /// Its name. Plain text.
    pub name: String,
    /// Estimate and the ends of its interval; `None`: it has no value.
    pub estimate: Option<[f64; 3]>,
    /// What is written beside it, with marks: its p.
    pub said: String,
}

const NAME: &str = "forest";
const MOST: usize = 60;
const ROW_MM: f64 = 5.0;

/// Draws a line a contrast: estimate, interval, and what is said of it.
///
/// # Errors
/// [`ReportError`] if there is no contrast, more than 60, none with a value, or a number is not finite.
pub fn forest(input: &Forest, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    let values = || input.rows.iter().filter_map(|row| row.estimate).flatten();
    check.at_least(1, "contrasts", input.rows.len())?;
    check.at_most(MOST, "contrasts", input.rows.len())?;
    check.finite("an estimate", values())?;
    check.finite("bounds", input.bounds.into_iter().flat_map(<[f64; 2]>::from))?;
    check.at_least(1, "estimates", values().count())?;
    let estimates = input.rows.iter().filter_map(|row| {
        let ends = row.estimate?;
        let [value, low, high] = ends.map(|v| number(v, decimals(ends[2] - ends[1])));
        Some(format!("{} {value} [{low}, {high}]", row.name))
    });
    let bounds =
        if input.bounds.is_some() { " Shaded: differences that count as none." } else { "" };
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM * 0.75, ROW_MM * input.rows.len() as f64 + 18.0),
        title: input.title.clone(),
        caption: format!(
            "{}: estimates with intervals, and their tests; the dashed line is no difference.{bounds} *n* = {} participants.",
            markup::literal(&input.title),
            input.n
        ),
        alt: estimates.collect::<Vec<_>>().join("; "),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, mut place| {
        let look = Look::new(size::TICK);
        let texts: Vec<&str> = input.rows.iter().map(|row| row.said.as_str()).collect();
        let right = place.right;
        place.right -= look.widest(&texts) + 8.0;
        let rows = Rows::new(input.rows.iter().map(|row| &row.name), 0.7);
        let ends = input.bounds.into_iter().flat_map(<[f64; 2]>::from);
        let x = Scale::over(values().chain([0.0]).chain(ends), 6);
        let labels = Labels { x: &input.axis, ..Labels::default() };
        let mut panel = Panel::open(canvas, place, &labels, (x, rows.axis()));
        if let Some((low, high)) = input.bounds {
            panel.stripe([low, high], PALE, 1.0);
        }
        panel.nothing(0.0);
        for (i, row) in input.rows.iter().enumerate() {
            let y = rows.y(i);
            let right_end = (right, panel.frame.y.at(y));
            panel.canvas.text(&row.said, right_end, look.end().centred());
            let Some([value, low, high]) = row.estimate else {
                panel.dash(panel.frame.x.at(0.0), y);
                continue;
            };
            panel.line([(low, y), (high, y)], Pen::new(INK, stroke::STRONG));
            let centre = panel.frame.at(value, y);
            panel.canvas.disc(centre, 2.0, INK, 1.0);
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contrast_without_a_value_keeps_its_line_and_none_at_all_are_refused() {
        let row = |name: &str, estimate| ForestRow {
            name: name.to_owned(),
            estimate,
            said: "*p* = .020".to_owned(),
        };
        let mut input = Forest {
            title: "Differences".into(),
            axis: "*d*_{z}".into(),
            rows: vec![row("a|b", Some([0.5, 0.1, 0.9])), row("a|c", None)],
            bounds: Some((-0.2, 0.2)),
            n: 24,
        };
        let figure = forest(&input, &Context::real()).unwrap();
        assert!(figure.svg.contains("a|c") && figure.alt == "a|b 0.50 [0.10, 0.90]");
        input.rows[0].estimate = Some([0.004, 0.001, 0.007]);
        let figure = forest(&input, &Context::real()).unwrap();
        assert_eq!(figure.alt, "a|b 0.0040 [0.0010, 0.0070]");
        input.rows.remove(0);
        assert!(matches!(forest(&input, &Context::real()), Err(ReportError::TooFew { .. })));
    }
}

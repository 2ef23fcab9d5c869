//! Many contrasts under each other: estimates with their intervals.

use super::prelude::*;
use crate::apa;

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
    check.that(
        input.rows.len() <= MOST,
        "contrasts",
        input.rows.len() as f64,
        "at most 60",
    )?;
    check.finite("an estimate", values())?;
    check.finite("bounds", input.bounds.into_iter().flat_map(|(a, b)| [a, b]))?;
    check.at_least(1, "estimates", values().count())?;
    let found = input.rows.iter().filter_map(|row| {
        let [value, low, high] = row.estimate?.map(|v| apa::number(v, 2));
        Some(format!("{} {value} [{low}, {high}]", row.name))
    });
    let bounds = if input.bounds.is_some() {
        " Shaded: differences that count as none."
    } else {
        ""
    };
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (
            TWO_COLUMNS_MM * 0.75,
            ROW_MM * input.rows.len() as f64 + 18.0,
        ),
        title: input.title.clone(),
        caption: format!(
            "{}: estimates with intervals, and their tests; the dashed line is no difference.{bounds} *n* = {} participants.",
            markup::literal(&input.title),
            input.n
        ),
        alt: found.collect::<Vec<_>>().join("; "),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, mut place| {
        let look = Look::new(size::TICK);
        let widest = input
            .rows
            .iter()
            .map(|row| look.width(&row.said))
            .fold(0.0, f64::max);
        let right = place.right;
        place.right -= widest + 8.0;
        let last = input.rows.len() as f64 - 1.0;
        let names = input.rows.iter().enumerate();
        let names = names.map(|(i, row)| (last - i as f64, markup::literal(&row.name)));
        let ends = input.bounds.into_iter().flat_map(|(a, b)| [a, b]);
        let x = Scale::over(values().chain([0.0]).chain(ends), 6);
        let y = Scale::labelled(-0.7, last + 0.7, names.collect());
        let labels = Labels {
            x: &input.axis,
            ..Labels::default()
        };
        let frame = Frame::draw(canvas, place, &labels, x, y);
        ground(canvas, &frame, input.bounds);
        for (i, row) in input.rows.iter().enumerate() {
            let y = frame.y.at(last - i as f64);
            canvas.text(&row.said, (right, y), look.end().centred());
            let Some([value, low, high]) = row.estimate else {
                canvas.text("–", (frame.x.at(0.0), y), look.middle().centred());
                continue;
            };
            let ends = ((frame.x.at(low), y), (frame.x.at(high), y));
            canvas.line(ends.0, ends.1, Pen::new(INK, stroke::STRONG));
            canvas.disc((frame.x.at(value), y), 2.0, INK, 1.0);
        }
    })
}

/// The bounds, shaded, and the line of no difference.
fn ground(canvas: &mut Canvas<'_>, frame: &Frame, bounds: Option<(f64, f64)>) {
    let (top, bottom) = (frame.place.top, frame.place.bottom);
    if let Some((low, high)) = bounds {
        let corners = ((frame.x.at(low), top), (frame.x.at(high), bottom));
        canvas.fill_rect(corners.0, corners.1, PALE, 1.0);
    }
    let zero = frame.x.at(0.0);
    let pen = Pen::new(GREY, stroke::AXIS).dashed(2.0, 1.5);
    canvas.line((zero, top), (zero, bottom), pen);
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
        input.rows.remove(0);
        assert!(matches!(
            forest(&input, &Context::real()),
            Err(ReportError::TooFew { .. })
        ));
    }
}

//! A declared family of correlations: a panel a rating, a line a trait, intervals that hold for all of them at once.

use super::prelude::*;
use crate::apa::bounded;
use maveric_domain::ConditionId;

/// Coefficients with their intervals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Family {
    /// Names of the lines, from top to bottom; at most 40. Plain text.
    pub rows: Vec<String>,
    /// The condition that each series is about; colours and shapes are theirs.
    pub series: Vec<ConditionId>,
    /// A panel each; at most 12.
    pub panels: Vec<FamilyPanel>,
    /// What the intervals are, and of how many tests. With marks.
    pub what: String,
    /// Participants, for the caption.
    pub participants: usize,
}

/// One panel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FamilyPanel {
    /// Its title. Plain text.
    pub title: String,
    /// For each line a value a series: coefficient and the ends of its interval; `None` could not be computed.
    pub cells: Vec<Vec<Option<[f64; 3]>>>,
}

const NAME: &str = "family";
const ROW_MM: f64 = 4.4;
const COLUMNS: usize = 4;

/// Draws a forest of coefficients in panels.
///
/// # Errors
/// [`ReportError`] without a line, a series or a panel, with more than the page holds, with lengths that differ, or with a coefficient that
/// is not in −1..=1.
pub fn family(input: &Family, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "lines", input.rows.len())?;
    check.at_least(1, "series", input.series.len())?;
    check.at_least(1, "panels", input.panels.len())?;
    check.that(
        input.rows.len() <= 40,
        "lines",
        input.rows.len() as f64,
        "at most 40",
    )?;
    check.that(
        input.panels.len() <= 12,
        "panels",
        input.panels.len() as f64,
        "at most 12",
    )?;
    for panel in &input.panels {
        check.length(&panel.title, panel.cells.len(), input.rows.len())?;
        for row in &panel.cells {
            check.length(&panel.title, row.len(), input.series.len())?;
            for value in row.iter().flatten().flatten() {
                check.that(
                    (-1.0..=1.0).contains(value),
                    &panel.title,
                    *value,
                    "a coefficient, −1 to 1",
                )?;
            }
        }
    }
    let all = || {
        input
            .panels
            .iter()
            .flat_map(|p| p.cells.iter().flatten().flatten())
    };
    let clear = all()
        .filter(|[_, low, high]| *low > 0.0 || *high < 0.0)
        .count();
    let columns = input.panels.len().min(COLUMNS);
    let lines = input.panels.len().div_ceil(COLUMNS);
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (
            TWO_COLUMNS_MM,
            lines as f64 * (ROW_MM * input.rows.len() as f64 + 17.0) + 8.0,
        ),
        title: "The declared family of correlations".to_owned(),
        caption: format!(
            "{} {clear} of {} leave zero out. A line without a mark could not be computed. *n* = {} participants.",
            input.what,
            all().count(),
            input.participants
        ),
        alt: strongest(input),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, place| {
        let looks: Vec<_> = input.series.iter().map(|id| context.look(*id)).collect();
        let keys: Vec<(Key, &str)> = looks
            .iter()
            .map(|look| (Key::Point(look.marker(), look.rgb()), look.label.as_str()))
            .collect();
        canvas.legend_row((place.left, place.top + 4.0), &keys);
        let look = Look::new(size::TICK);
        let widest = input.rows.iter().map(|r| look.width(&markup::literal(r)));
        let names = widest.fold(0.0, f64::max) + 6.0;
        let grid = Place {
            top: place.top + cap_height(size::TICK) + 8.0,
            left: place.left + names,
            ..place
        };
        for (index, panel) in input.panels.iter().enumerate() {
            let at = (index % COLUMNS, index / COLUMNS);
            let mut cell = grid.cell(at, (columns, lines), (7.0, 8.0));
            if at.0 == 0 {
                cell.left = place.left;
            }
            paint(canvas, cell, input, panel, context);
        }
    })
}

fn paint(
    canvas: &mut Canvas<'_>,
    cell: Place,
    input: &Family,
    panel: &FamilyPanel,
    context: &Context,
) {
    let last = input.rows.len() as f64 - 1.0;
    let first = cell.right - cell.left > 0.3 * canvas.width;
    let named = input.rows.iter().enumerate().map(|(i, row)| {
        let name = if first {
            markup::literal(row)
        } else {
            String::new()
        };
        (last - i as f64, name)
    });
    let ticks = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|t| (t, bounded(t, 1)));
    let x = Scale::labelled(-1.0, 1.0, ticks.to_vec());
    let y = Scale::labelled(-0.7, last + 0.7, named.collect());
    let title = markup::literal(&panel.title);
    let labels = Labels {
        title: &title,
        x: "Correlation",
        ..Labels::default()
    };
    let frame = Frame::draw(canvas, cell, &labels, x, y);
    let zero = frame.x.at(0.0);
    let pen = Pen::new(GREY, stroke::AXIS).dashed(2.0, 1.5);
    canvas.line((zero, frame.place.top), (zero, frame.place.bottom), pen);
    let step = (frame.y.at(0.0) - frame.y.at(1.0)) / (input.series.len() as f64 + 1.0);
    for (i, row) in panel.cells.iter().enumerate() {
        for (s, (value, id)) in row.iter().zip(&input.series).enumerate() {
            let Some([r, low, high]) = value else {
                continue;
            };
            let look = context.look(*id);
            let off = (s as f64 - (input.series.len() as f64 - 1.0) / 2.0) * step;
            let y = frame.y.at(last - i as f64) + off;
            let ends = ((frame.x.at(*low), y), (frame.x.at(*high), y));
            canvas.line(ends.0, ends.1, Pen::new(look.rgb(), stroke::BOX));
            canvas.marker((frame.x.at(*r), y), 1.6, look.marker(), look.rgb());
        }
    }
}

fn strongest(input: &Family) -> String {
    let all = input.panels.iter().flat_map(|p| {
        let rows = p.cells.iter().zip(&input.rows);
        rows.flat_map(move |(cells, row)| cells.iter().flatten().map(move |c| (p, row, c)))
    });
    let most = all.max_by(|a, b| a.2[0].abs().total_cmp(&b.2[0].abs()));
    most.map_or_else(
        || "None could be computed.".to_owned(),
        |(panel, row, [r, low, high])| {
            let [r, low, high] = [r, low, high].map(|v| bounded(*v, 2));
            format!(
                "The strongest is {row} with {}: {r} [{low}, {high}].",
                panel.title
            )
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input() -> Family {
        let cell = |r: f64| Some([r, r - 0.5, (r + 0.5).min(1.0)]);
        Family {
            rows: vec!["Openness".into(), "Patience".into()],
            series: vec![
                ConditionId::new("fast").unwrap(),
                ConditionId::new("slow").unwrap(),
            ],
            panels: vec![FamilyPanel {
                title: "Trust".into(),
                cells: vec![vec![cell(0.1), None], vec![cell(0.6), cell(-0.2)]],
            }],
            what: "Intervals for all 4 at once.".into(),
            participants: 24,
        }
    }

    #[test]
    fn what_leaves_zero_out_is_counted_and_the_strongest_is_named() {
        let figure = family(&input(), &Context::real()).unwrap();
        assert!(
            figure.caption.contains("1 of 3 leave zero out"),
            "{}",
            figure.caption
        );
        assert_eq!(
            figure.alt,
            "The strongest is Patience with Trust: .60 [.10, 1.00]."
        );
    }

    #[test]
    fn a_coefficient_above_one_and_a_short_row_are_refused() {
        let mut bad = input();
        bad.panels[0].cells[0][0] = Some([1.2, 0.0, 1.0]);
        assert!(family(&bad, &Context::real()).is_err());
        let mut short = input();
        short.panels[0].cells.pop();
        assert!(family(&short, &Context::real()).is_err());
    }
}

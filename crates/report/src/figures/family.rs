//! A declared family of correlations: a panel a rating, a line a trait, intervals that hold for all of them at once.

use super::ConditionLook;
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
    /// People behind each coefficient, for the caption.
    pub n: Vec<usize>,
}

/// The correlations with one rating.
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
    check.at_most(40, "lines", input.rows.len())?;
    check.at_most(12, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.length(&panel.title, panel.cells.len(), input.rows.len())?;
        for row in &panel.cells {
            check.length(&panel.title, row.len(), input.series.len())?;
            let values = row.iter().flatten().flatten().copied();
            let expected = "a coefficient, −1 to 1";
            check.within((-1.0, 1.0), &panel.title, values, expected)?;
        }
    }
    let cells = input.panels.iter().flat_map(|p| &p.cells).flatten();
    let cells: Vec<&[f64; 3]> = cells.flatten().collect();
    let clear = |cell: &&&[f64; 3]| cell[1] > 0.0 || cell[2] < 0.0;
    let clear = cells.iter().filter(clear).count();
    let columns = input.panels.len().min(COLUMNS);
    let lines = input.panels.len().div_ceil(COLUMNS);
    let height = ROW_MM * input.rows.len() as f64 + 17.0;
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, lines as f64 * height + 8.0),
        title: "The declared family of correlations".to_owned(),
        caption: format!(
            "{} {clear} of {} leave zero out. A line without a mark could not be computed. *n* = {} participants who have both values.",
            input.what,
            cells.len(),
            counted(input.n.iter().copied(), "")
        ),
        alt: strongest(input),
        shows: Shows::Participants,
    };
    let looks: Vec<_> = input.series.iter().map(|id| context.look(*id)).collect();
    draw(plan, context, |canvas, place| {
        let keys = looks.iter().map(|look| (look.key(), &look.label));
        let below = canvas.legend(place, &keys.collect::<Vec<_>>());
        let rows = Rows::new(&input.rows, 0.7);
        // The first column carries the names beside its equal share of the width.
        let grid = Place { left: place.left + rows.width() + 6.0, ..below };
        for (index, panel) in input.panels.iter().enumerate() {
            let (column, line) = (index % COLUMNS, index / COLUMNS);
            let mut cell = grid.cell((column, line), (columns, lines), (7.0, 8.0));
            let mut y = rows.unnamed();
            if column == 0 {
                (cell.left, y) = (place.left, rows.axis());
            }
            paint(canvas, cell, panel, (&rows, y), &looks);
        }
    })
}

fn paint(
    canvas: &mut Canvas<'_>,
    cell: Place,
    input: &FamilyPanel,
    (rows, y): (&Rows, Scale),
    looks: &[ConditionLook],
) {
    let ticks = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|t| (t, bounded(t, 1)));
    let x = Scale::labelled(-1.0, 1.0, ticks.to_vec());
    let labels =
        Labels { title: &markup::literal(&input.title), x: "Correlation", ..Labels::default() };
    let mut panel = Panel::open(canvas, cell, &labels, (x, y));
    panel.nothing(0.0);
    let step = 1.0 / (looks.len() as f64 + 1.0);
    for (i, row) in input.cells.iter().enumerate() {
        for (s, (value, look)) in row.iter().zip(looks).enumerate() {
            let y = rows.y(i) - (s as f64 - (looks.len() as f64 - 1.0) / 2.0) * step;
            if let Some(interval) = value {
                let mark = (1.6, look.marker, look.rgb());
                panel.level_interval(*interval, y, Pen::new(look.rgb(), stroke::BOX), mark);
            }
        }
    }
}

fn strongest(input: &Family) -> String {
    let cells = input.panels.iter().flat_map(|panel| {
        let rows = panel.cells.iter().zip(&input.rows);
        rows.flat_map(move |(cells, row)| cells.iter().flatten().map(move |c| (panel, row, c)))
    });
    let most = cells.max_by(|a, b| a.2[0].abs().total_cmp(&b.2[0].abs()));
    let words = |(panel, row, cell): (&FamilyPanel, &String, &[f64; 3])| {
        let [r, low, high] = cell.map(|v| bounded(v, 2));
        format!("The strongest is {row} with {}: {r} [{low}, {high}].", panel.title)
    };
    most.map_or_else(|| "None could be computed.".to_owned(), words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input() -> Family {
        let cell = |r: f64| Some([r, r - 0.5, (r + 0.5).min(1.0)]);
        Family {
            rows: vec!["Openness".into(), "Patience".into()],
            series: vec![ConditionId::new("fast").unwrap(), ConditionId::new("slow").unwrap()],
            panels: vec![FamilyPanel {
                title: "Trust".into(),
                cells: vec![vec![cell(0.1), None], vec![cell(0.6), cell(-0.2)]],
            }],
            what: "Intervals for all 4 at once.".into(),
            n: vec![23, 21, 23],
        }
    }

    #[test]
    fn what_leaves_zero_out_is_counted_and_the_strongest_is_named() {
        let figure = family(&input(), &Context::real()).unwrap();
        assert!(
            figure.caption.contains("1 of 3 leave zero out")
                && figure.caption.contains("*n* = 21 to 23 participants"),
            "{}",
            figure.caption
        );
        assert_eq!(figure.alt, "The strongest is Patience with Trust: .60 [.10, 1.00].");
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

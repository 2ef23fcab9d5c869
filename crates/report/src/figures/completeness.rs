//! What is there of what a study awaits, kind by kind and time by time.

use super::prelude::*;

/// Counts of people.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Completeness {
    /// Names of the times, from top to bottom: before the drives, the baseline, each condition; at most 52. Plain text.
    pub rows: Vec<String>,
    /// A panel a kind of data; at most 6.
    pub panels: Vec<CompletenessPanel>,
}

/// One kind of data.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CompletenessPanel {
    /// Such as `Logs`. Plain text.
    pub title: String,
    /// A row each: of how many people it is there, and of how many it is awaited.
    pub counts: Vec<(usize, usize)>,
}

const NAME: &str = "completeness";
const ROW_MM: f64 = 4.4;

/// Draws a bar a time in a panel a kind: as long as people are awaited, filled as far as they are there.
///
/// # Errors
/// [`ReportError`] without a row or a panel, with more than the page holds, with lengths that differ, or if more are there than awaited.
pub fn completeness(input: &Completeness, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "rows", input.rows.len())?;
    check.at_most(52, "rows", input.rows.len())?;
    check.at_least(1, "panels", input.panels.len())?;
    check.at_most(6, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.length(&panel.title, panel.counts.len(), input.rows.len())?;
        for &(there, awaited) in &panel.counts {
            let expected = format!("at most the {awaited} awaited");
            check.that(there <= awaited, &panel.title, there as f64, &expected)?;
        }
    }
    let rows = Rows::new(&input.rows, 0.7);
    draw(plan(input), context, |canvas, place| {
        // The first column carries the names beside its equal share of the width.
        let grid = Place { left: place.left + rows.width() + 6.0, ..place };
        for (index, panel) in input.panels.iter().enumerate() {
            let mut cell = grid.cell((index, 0), (input.panels.len(), 1), (10.0, 0.0));
            let mut y = rows.unnamed();
            if index == 0 {
                (cell.left, y) = (place.left, rows.axis());
            }
            paint(canvas, cell, panel, &rows, y);
        }
    })
}

fn paint(canvas: &mut Canvas<'_>, cell: Place, input: &CompletenessPanel, rows: &Rows, y: Scale) {
    let longest = input.counts.iter().map(|c| c.1).max().unwrap_or(0).max(1);
    let x = Scale::between(0.0, longest as f64, 4);
    let labels = Labels { title: &markup::literal(&input.title), x: "People", ..Labels::default() };
    let mut panel = Panel::open(canvas, cell, &labels, (x, y));
    for (row, &(there, awaited)) in input.counts.iter().enumerate() {
        let middle = rows.y(row);
        if awaited == 0 {
            panel.dash(panel.frame.x.at(0.0) + 5.0, middle);
            continue;
        }
        let bar = [middle - 0.3, middle + 0.3];
        panel.shade([0.0, awaited as f64], bar, ORANGE, 0.35);
        panel.shade([0.0, there as f64], bar, BLUE, 1.0);
    }
}

fn plan(input: &Completeness) -> Plan {
    let lines = input.panels.iter().map(|panel| {
        let total = |f: fn(&(usize, usize)) -> usize| panel.counts.iter().map(f).sum::<usize>();
        format!("{}: {} of {}.", panel.title, total(|c| c.0), total(|c| c.1))
    });
    let awaited = input.panels.iter().flat_map(|panel| &panel.counts);
    let most = awaited.map(|counts| counts.1).max().unwrap_or(0);
    Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, ROW_MM * input.rows.len() as f64 + 20.0),
        title: "What is there".to_owned(),
        caption: format!(
            "Blue: people of whom it is there; pale: people of whom it is missing. A dash: nothing is awaited. *n* = {most} people at most; counts, no test."
        ),
        alt: sentences(lines),
        shows: Shows::Participants,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input() -> Completeness {
        Completeness {
            rows: vec!["Before the drives".into(), "Calm".into()],
            panels: vec![
                CompletenessPanel { title: "Logs".into(), counts: vec![(0, 0), (3, 4)] },
                CompletenessPanel { title: "Answers".into(), counts: vec![(4, 4), (2, 4)] },
            ],
        }
    }

    #[test]
    fn what_is_there_is_counted_of_what_is_awaited() {
        let figure = completeness(&input(), &Context::real()).unwrap();
        assert_eq!(figure.alt, "Logs: 3 of 4. Answers: 6 of 8.");
        // Nothing is awaited of logs before the drives: a dash and no bar.
        assert_eq!(figure.svg.matches("–</text>").count(), 1);
    }

    #[test]
    fn more_than_are_awaited_and_a_short_panel_are_refused() {
        let mut more = input();
        more.panels[0].counts[1] = (5, 4);
        let refused = completeness(&more, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
        let mut short = input();
        short.panels[1].counts.pop();
        assert!(completeness(&short, &Context::real()).is_err());
    }
}

//! Groups or conditions of any design side by side: rainclouds with their contrasts.

use super::crowd::MOST_POINTS;
use super::prelude::*;
use super::rainclouds::{self, Panel, Slot};
use super::theme::nth_look;
use crate::apa;

/// What is compared, an outcome a panel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Any number of panels.
    pub panels: Vec<ComparisonPanel>,
    /// What the intervals of the means are, as a sentence: `95% within-subject intervals (Morey)`.
    pub intervals: String,
    /// What the contrasts' p are: `p values after Holm`.
    pub contrasts: String,
}

/// One outcome.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparisonPanel {
    /// The outcome, with its unit. Plain text.
    pub outcome: String,
    /// The test, with marks, as [`crate::apa`] writes it. Shown above the panel.
    pub test: String,
    /// Groups, conditions, or cells of both.
    pub cells: Vec<ComparedCell>,
    /// One row a person, one value a cell; `None`: has none there.
    pub rows: Vec<Vec<Option<f64>>>,
    /// Pairs that are shown as brackets.
    pub contrasts: Vec<Contrast>,
}

/// One group, condition or cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparedCell {
    /// Its name. Plain text.
    pub name: String,
    /// Its mean as the test has it, and the ends of the mean's interval.
    pub mean: Option<[f64; 3]>,
}

/// A pair of cells.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Contrast {
    /// Place of one cell.
    pub first: usize,
    /// Place of the other.
    pub second: usize,
    /// Its p, adjusted as the figure says.
    pub p: f64,
}

const NAME: &str = "comparison";
/// Above this many brackets only those below .05 are drawn.
const MOST_CONTRASTS: usize = 6;

/// Draws a raincloud a cell: half violin, box, points, each person's line, mean with interval, and the contrasts.
///
/// # Errors
/// [`ReportError`] if there is no panel, cell or value, a value is not finite, a row has another length than the cells, or a contrast
/// names a cell that is not there.
///
/// # Source
/// Rainclouds after Allen et al. (2019), Wellcome Open Research 4; the brackets are ours.
pub fn comparison(input: &Comparison, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        let k = panel.cells.len();
        check.at_least(1, "cells", k)?;
        for row in &panel.rows {
            check.length("a person's row", row.len(), k)?;
        }
        check.finite(&panel.outcome, panel.rows.iter().flatten().flatten().copied())?;
        check.finite("a mean", panel.cells.iter().filter_map(|c| c.mean).flatten())?;
        check.finite("a contrast's p", panel.contrasts.iter().map(|c| c.p))?;
        check.at_least(1, "values", panel.rows.iter().flatten().flatten().count())?;
        for contrast in &panel.contrasts {
            let last = contrast.first.max(contrast.second);
            check.that(last < k, "a contrast's cell", last as f64, "the place of a cell")?;
        }
    }
    let cells = input.panels.iter().map(|p| p.cells.len());
    let most_cells = cells.max().unwrap_or(1);
    let columns = match (input.panels.len(), most_cells) {
        (1, _) | (_, 7..) => 1,
        (n, 5..) => n.min(2),
        (n, _) => n.min(3),
    };
    let grid = Grid::new(input.panels.len(), columns, (10.0, 11.0));
    let wide = (22.0 * most_cells as f64).clamp(TWO_COLUMNS_MM / 3.0, TWO_COLUMNS_MM);
    let width = (wide * columns as f64).clamp(85.0, TWO_COLUMNS_MM);
    let outcomes: Vec<&str> = input.panels.iter().map(|p| p.outcome.as_str()).collect();
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (width, 68.0 * grid.rows() + 3.0),
        title: outcomes.join(", "),
        caption: caption(input),
        alt: alternative(input),
        shows: Shows::Participants,
    };
    draw_panels(plan, context, grid, &[], |canvas, index, place| {
        rainclouds::paint(canvas, place, &drawn(&input.panels[index]));
    })
}

fn drawn(panel: &ComparisonPanel) -> Panel<'_> {
    let slots = panel.cells.iter().enumerate().map(|(index, cell)| Slot {
        name: markup::literal(&cell.name),
        look: nth_look(index),
        mean: cell.mean,
    });
    let shown = |c: &&Contrast| panel.contrasts.len() <= MOST_CONTRASTS || c.p < 0.05;
    let contrasts = panel.contrasts.iter().filter(shown);
    let contrasts = contrasts.map(|c| (c.first, c.second, apa::p(c.p).markup().to_owned()));
    Panel {
        title: "",
        subtitle: &panel.test,
        axis: &panel.outcome,
        slots: slots.collect(),
        rows: &panel.rows,
        contrasts: contrasts.collect(),
        reference: None,
        range: None,
    }
}

fn caption(input: &Comparison) -> String {
    let people = input.panels.iter().map(|p| p.rows.len()).max().unwrap_or(0);
    let points = if people > MOST_POINTS {
        "Single people are left out, there being too many."
    } else {
        "Each point is a person, each thin line one person across the cells."
    };
    let brackets = if input.panels.iter().all(|p| p.contrasts.is_empty()) {
        String::new()
    } else {
        let many = input.panels.iter().any(|p| p.contrasts.len() > MOST_CONTRASTS);
        let which = if many { ", those below .05" } else { "" };
        format!(" Brackets: {}{which}.", input.contrasts)
    };
    let mut cells = input.panels.iter().flat_map(|p| &p.cells);
    let means = if cells.any(|cell| cell.mean.is_some()) {
        format!(", black dots means with {}", input.intervals)
    } else {
        String::new()
    };
    format!(
        "{points} Half violins are kernel densities (to two bandwidths beyond the data), boxes quartiles with whiskers to 1.5 times \
         their distance{means}. *n* = {people}.{brackets}"
    )
}

fn alternative(input: &Comparison) -> String {
    let panel = |panel: &ComparisonPanel| {
        let means = panel.cells.iter().filter_map(|cell| {
            let [mean, low, high] = cell.mean?;
            let written = apa::number(mean, apa::decimals(high - low));
            Some(format!("{} {written}", cell.name))
        });
        let means: Vec<String> = means.collect();
        let cells: Vec<&str> = panel.cells.iter().map(|cell| cell.name.as_str()).collect();
        let cells = match &means[..] {
            [] => cells.join(", "),
            means => format!("means {}", means.join(", ")),
        };
        let test = match markup::plain(&panel.test) {
            test if test.is_empty() => test,
            test => format!(" {test}."),
        };
        format!("{}: {cells}.{test}", panel.outcome)
    };
    sentences(input.panels.iter().map(panel))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input() -> Comparison {
        let cell = |name: &str, mean: f64| ComparedCell {
            name: name.to_owned(),
            mean: Some([mean, mean - 0.5, mean + 0.5]),
        };
        Comparison {
            panels: vec![ComparisonPanel {
                outcome: "Trust_1 *sum*".into(),
                test: "*t*(3) = 2.10".into(),
                cells: vec![cell("a_b", 1.5), cell("c*d*", 2.5)],
                rows: vec![
                    vec![Some(1.0), Some(2.0)],
                    vec![Some(2.0), None],
                    vec![Some(1.5), Some(3.0)],
                ],
                contrasts: vec![Contrast { first: 0, second: 1, p: 0.04 }],
            }],
            intervals: "95% intervals".into(),
            contrasts: "*p* after Holm".into(),
        }
    }

    #[test]
    fn names_from_a_table_are_drawn_as_they_are() {
        let figure = comparison(&input(), &Context::real()).unwrap();
        assert!(figure.svg.contains("a_b") && figure.svg.contains("c*d*"), "{}", figure.svg);
        assert!(figure.alt.contains("a_b 1.50, c*d* 2.50"), "{}", figure.alt);
        assert!(figure.caption.contains("Brackets: *p* after Holm."));
    }

    #[test]
    fn a_description_has_no_gap_where_there_are_no_means_or_no_test() {
        let mut bare = input();
        assert!(alternative(&bare).contains("means a_b 1.50, c*d* 2.50. t(3) = 2.10."));
        for cell in &mut bare.panels[0].cells {
            cell.mean = None;
        }
        let said = alternative(&bare);
        assert!(said.contains(": a_b, c*d*. t(3) = 2.10."), "{said}");
        assert!(caption(&bare).contains("their distance. *n* = 3."));
        let mut small = input();
        small.panels[0].cells[0].mean = Some([0.004, 0.002, 0.006]);
        let said = alternative(&small);
        assert!(said.contains("means a_b 0.0040, c*d* 2.50."), "{said}");
        bare.panels[0].test = String::new();
        let said = alternative(&bare);
        assert!(said.ends_with(": a_b, c*d*."), "{said}");
    }

    #[test]
    fn a_contrast_of_a_cell_that_is_not_there_is_refused() {
        let mut wrong = input();
        wrong.panels[0].contrasts[0].second = 2;
        assert!(matches!(
            comparison(&wrong, &Context::real()),
            Err(ReportError::OutOfRange { .. })
        ));
    }

    #[test]
    fn of_many_contrasts_only_those_below_the_level_are_drawn() {
        let mut many = input();
        let contrasts =
            (0..8).map(|i| Contrast { first: 0, second: 1, p: 0.01 + 0.1 * f64::from(i) });
        many.panels[0].contrasts = contrasts.collect();
        assert_eq!(drawn(&many.panels[0]).contrasts.len(), 1);
        assert!(caption(&many).ends_with("those below .05."));
    }
}

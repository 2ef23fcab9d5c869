//! Correlations of many pairs at a glance, with their tests' stars.

use super::axes::Place;
use super::canvas::{Canvas, Look, Pen, cap_height};
use super::check::Check;
use super::theme::{
    MUTED, ONE_COLUMN_MM, PALE, TWO_COLUMNS_MM, diverging, on_colour, size, stroke,
};
use super::{Context, Figure, Plan, Shows, draw};
use crate::apa::bounded;
use crate::error::ReportError;
use crate::markup;
use serde::{Deserialize, Serialize};

/// A table of coefficients.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CorrelationHeatMap {
    /// Names of the rows, from top to bottom; at most 40. Plain text.
    pub rows: Vec<String>,
    /// Names of the columns; at most 40. Plain text.
    pub columns: Vec<String>,
    /// For each row a cell a column; `None`: could not be computed.
    pub cells: Vec<Vec<Option<HeatCell>>>,
    /// Whose p the stars show, as a sentence: which tests, and over which family they were adjusted. With marks.
    pub family: String,
    /// Participants, for the caption.
    pub participants: usize,
}

/// One pair.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HeatCell {
    /// The coefficient, −1 to 1.
    pub value: f64,
    /// Its p, 0 to 1, adjusted as [`CorrelationHeatMap::family`] says.
    pub p: f64,
}

impl HeatCell {
    /// Stars of the p: three below .001, two below .01, one below .05.
    fn stars(self) -> &'static str {
        match self.p {
            p if p < 0.001 => "***",
            p if p < 0.01 => "**",
            p if p < 0.05 => "*",
            _ => "",
        }
    }
}

const NAME: &str = "correlation-heatmap";
const MOST: usize = 40;
const ROW: f64 = 20.0;
const FOOT: f64 = 26.0;

/// Draws a coloured cell a pair, the coefficient and its stars in it.
///
/// # Errors
/// [`ReportError`] if there is no row or column, or more than 40; if lengths differ; if a coefficient is not in
/// −1..=1 or a p not in 0..=1.
///
/// # Source
/// Method, section 9.5: homophily. The picture is ours; the paper has a table.
pub fn correlation_heatmap(
    input: &CorrelationHeatMap,
    context: &Context,
) -> Result<Figure, ReportError> {
    check(input)?;
    let everything: Vec<(&str, &str, HeatCell)> = input
        .cells
        .iter()
        .zip(&input.rows)
        .flat_map(|(cells, row)| {
            let pairs = cells.iter().zip(&input.columns);
            pairs.filter_map(move |(cell, column)| Some((row.as_str(), column.as_str(), (*cell)?)))
        })
        .collect();
    let missing = input.rows.len() * input.columns.len() - everything.len();
    let starred = everything.iter().filter(|(.., c)| c.p < 0.05).count();
    let strongest = everything
        .iter()
        .max_by(|a, b| a.2.value.abs().total_cmp(&b.2.value.abs()));
    let strongest = strongest.map_or_else(
        || "None could be computed.".to_owned(),
        |(row, column, cell)| {
            let value = bounded(cell.value, 2);
            format!("The strongest is {value}, of {row} with {column}.")
        },
    );
    let without = if missing == 0 {
        String::new()
    } else {
        format!(" A dash: could not be computed ({missing}).")
    };
    let wide = input.columns.len() > 5;
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (
            if wide { TWO_COLUMNS_MM } else { ONE_COLUMN_MM },
            mm(ROW * input.rows.len() as f64 + column_room(input) + FOOT + 16.0),
        ),
        title: "Correlations at a glance".to_owned(),
        caption: format!(
            "Coefficients, blue below and orange above zero. Stars: *p* < .05 (\\*), .01 (\\*\\*), .001 (\\*\\*\\*). \
             {} {starred} of {} pairs have a star.{without} *n* = {} participants.",
            input.family,
            everything.len(),
            input.participants
        ),
        alt: format!(
            "{} correlations, {starred} of them starred. {strongest}",
            everything.len()
        ),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, place| {
        let names = input.rows.iter().map(|name| label_width(name));
        let grid = Place {
            left: place.left + names.fold(0.0, f64::max) + 4.0,
            bottom: place.bottom - FOOT - column_room(input),
            ..place
        };
        for (row, cells) in input.cells.iter().enumerate() {
            for (column, cell) in cells.iter().enumerate() {
                let at = (column, row);
                paint_cell(
                    canvas,
                    grid.cell(at, (input.columns.len(), input.rows.len()), (1.0, 1.0)),
                    *cell,
                );
            }
        }
        paint_names(canvas, grid, input);
        paint_key(canvas, (grid.left, place.bottom - 3.0), grid.right);
    })
}

fn check(input: &CorrelationHeatMap) -> Result<(), ReportError> {
    let check = Check(NAME);
    for (what, names) in [("rows", &input.rows), ("columns", &input.columns)] {
        check.at_least(1, what, names.len())?;
        let found = names.len() as f64;
        check.that(names.len() <= MOST, what, found, "at most 40: choose some")?;
    }
    check.length("cells", input.cells.len(), input.rows.len())?;
    for (name, row) in input.rows.iter().zip(&input.cells) {
        check.length(name, row.len(), input.columns.len())?;
        for cell in row.iter().flatten() {
            let possible = (-1.0..=1.0).contains(&cell.value);
            check.that(possible, name, cell.value, "a coefficient, −1 to 1")?;
            check.that((0.0..=1.0).contains(&cell.p), "p", cell.p, "0 to 1")?;
        }
    }
    Ok(())
}

fn mm(points: f64) -> f64 {
    (points / 72.0 * 25.4 * 10.0).round() / 10.0
}

fn label_width(name: &str) -> f64 {
    Look::new(size::TICK).width(&markup::literal(name))
}

/// Whether the names of the columns have to stand upright to fit.
fn upright(input: &CorrelationHeatMap) -> bool {
    let widest = |names: &[String]| names.iter().map(|n| label_width(n)).fold(0.0, f64::max);
    let width_mm = if input.columns.len() > 5 {
        TWO_COLUMNS_MM
    } else {
        ONE_COLUMN_MM
    };
    let grid = width_mm / 25.4 * 72.0 - widest(&input.rows) - 10.0;
    widest(&input.columns) > grid / input.columns.len() as f64 - 3.0
}

fn column_room(input: &CorrelationHeatMap) -> f64 {
    if upright(input) {
        input
            .columns
            .iter()
            .map(|name| label_width(name))
            .fold(0.0, f64::max)
            + 5.0
    } else {
        cap_height(size::TICK) + 6.0
    }
}

fn paint_cell(canvas: &mut Canvas<'_>, place: Place, cell: Option<HeatCell>) {
    let (a, b) = ((place.left, place.top), (place.right, place.bottom));
    let middle = (f64::midpoint(a.0, b.0), f64::midpoint(a.1, b.1));
    let look = Look::new(size::TICK).middle().centred();
    let Some(cell) = cell else {
        canvas.fill_rect(a, b, PALE, 1.0);
        canvas.text("–", middle, look.colour(MUTED));
        return;
    };
    let ground = diverging(cell.value);
    canvas.fill_rect(a, b, ground, 1.0);
    let look = look.colour(on_colour(ground));
    let stars = markup::literal(cell.stars());
    let written = bounded(cell.value, 2);
    if look.width(&written) + look.width(&stars) + 2.0 <= b.0 - a.0 {
        canvas.text(&format!("{written}{stars}"), middle, look);
    } else if look.width(&written) + 1.0 <= b.0 - a.0 {
        canvas.text(&written, (middle.0, middle.1 - 3.6), look);
        canvas.text(&stars, (middle.0, middle.1 + 4.6), look);
    } else {
        canvas.text(&stars, middle, look);
    }
}

fn paint_names(canvas: &mut Canvas<'_>, grid: Place, input: &CorrelationHeatMap) {
    let look = Look::new(size::TICK);
    let count = (input.columns.len(), input.rows.len());
    for (row, name) in input.rows.iter().enumerate() {
        let cell = grid.cell((0, row), count, (1.0, 1.0));
        let y = f64::midpoint(cell.top, cell.bottom);
        canvas.text(
            &markup::literal(name),
            (grid.left - 4.0, y),
            look.end().centred(),
        );
    }
    for (column, name) in input.columns.iter().enumerate() {
        let cell = grid.cell((column, 0), count, (1.0, 1.0));
        let at = (f64::midpoint(cell.left, cell.right), grid.bottom + 4.0);
        let look = if upright(input) {
            look.end().centred().turned()
        } else {
            look.middle().hanging()
        };
        canvas.text(&markup::literal(name), at, look);
    }
}

fn paint_key(canvas: &mut Canvas<'_>, (left, bottom): (f64, f64), right: f64) {
    let width = (right - left).min(120.0);
    let (top, middle) = (bottom - 16.0, bottom - 10.0);
    for step in 0..40 {
        let share = f64::from(step) / 39.0;
        let from = left + width * f64::from(step) / 40.0;
        let to = from + width / 40.0 + if step < 39 { 0.15 } else { 0.0 };
        canvas.fill_rect((from, top), (to, middle), diverging(2.0 * share - 1.0), 1.0);
    }
    canvas.rect(
        (left, top),
        (left + width, middle),
        Pen::new(MUTED, stroke::THIN),
    );
    let beside = (left + width + 5.0, f64::midpoint(top, middle));
    canvas.text("coefficient", beside, Look::new(size::SMALL).centred());
    let look = Look::new(size::SMALL).middle();
    for (share, label) in [(0.0, "−1"), (0.5, "0"), (1.0, "1")] {
        let x = left + width * share;
        let look = match label {
            "−1" => Look::new(size::SMALL),
            "1" => look.end(),
            _ => look,
        };
        canvas.text(label, (x, bottom), look);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input() -> CorrelationHeatMap {
        CorrelationHeatMap {
            rows: vec!["Openness <b>".into()],
            columns: vec!["Trust".into(), "Comfort".into()],
            cells: vec![vec![
                Some(HeatCell {
                    value: -0.61,
                    p: 0.004,
                }),
                None,
            ]],
            family: "*p* unadjusted.".into(),
            participants: 24,
        }
    }

    #[test]
    fn a_pair_has_its_stars_and_a_missing_one_a_dash() {
        let figure = correlation_heatmap(&input(), &Context::real()).unwrap();
        assert!(figure.svg.contains(">−.61**</text>") && figure.svg.contains(">–</text>"));
        assert!(figure.caption.contains("A dash: could not be computed (1)"));
        assert!(figure.svg.contains("Openness &lt;b&gt;"));
    }

    #[test]
    fn a_coefficient_above_one_is_refused() {
        let mut input = input();
        input.cells[0][1] = Some(HeatCell { value: 1.2, p: 0.5 });
        let refused = correlation_heatmap(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

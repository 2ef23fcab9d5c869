//! The one grid of panels: letters, and each panel as a figure of its own.

use super::axes::Place;
use super::canvas::Canvas;
use super::figure::MARGIN;
use super::legend::Key;
use super::page::points_from_mm;
use super::theme::{ONE_COLUMN_MM, TWO_COLUMNS_MM};
use super::{Context, Figure, Plan, draw};
use crate::error::ReportError;

/// Panels in rows, from left to right.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Grid {
    count: usize,
    pub(crate) columns: usize,
    gap: (f64, f64),
}

impl Grid {
    /// So many panels, so many a row, with room between columns and between rows in points.
    pub(crate) fn new(count: usize, columns: usize, gap: (f64, f64)) -> Self {
        Self { count, columns, gap }
    }

    /// At most `most` a row.
    pub(crate) fn limited(count: usize, most: usize, gap: (f64, f64)) -> Self {
        Self::new(count, count.clamp(1, most), gap)
    }

    fn lines(self) -> usize {
        self.count.div_ceil(self.columns)
    }

    /// Rows of panels, to multiply a height with.
    pub(crate) fn rows(self) -> f64 {
        self.lines() as f64
    }

    /// Whether its panels have letters.
    pub(crate) fn has_letters(self) -> bool {
        self.count > 1
    }

    /// Points' width of a panel in a drawing so many millimetres wide.
    pub(crate) fn panel_width(self, drawn_mm: f64) -> f64 {
        let gaps = self.gap.0 * (self.columns - 1) as f64;
        (points_from_mm(drawn_mm) - 2.0 * MARGIN - gaps) / self.columns as f64
    }

    /// Width in millimetres where three columns fill the page; never below one column of print.
    pub(crate) fn width_mm(self) -> f64 {
        (TWO_COLUMNS_MM / 3.0 * self.columns as f64).max(ONE_COLUMN_MM)
    }
}

/// The letter of a panel: a, b … z; none after that.
fn letter(index: usize) -> Option<char> {
    (b'a'..=b'z').nth(index).map(char::from)
}

/// Draws all panels into one figure, and each again as a figure of one column's width, with the names of the series above them.
pub(crate) fn draw_panels(
    plan: Plan,
    context: &Context,
    grid: Grid,
    keys: &[(Key, &str)],
    paint: impl Fn(&mut Canvas<'_>, usize, Place),
) -> Result<Figure, ReportError> {
    let head = |canvas: &mut Canvas<'_>, place: Place| match keys {
        [] => place,
        keys => canvas.legend(place, keys),
    };
    let rows = grid.lines();
    let single = |index: usize| {
        let letter = letter(index)?;
        Some(Plan {
            name: format!("{}-{letter}", plan.name),
            size_mm: (ONE_COLUMN_MM, (plan.size_mm.1 / rows as f64).max(40.0)),
            title: format!("{} ({letter})", plan.title),
            caption: format!("Panel {letter}. {}", plan.caption),
            alt: plan.alt.clone(),
            shows: plan.shows,
        })
    };
    let mut panels = Vec::new();
    for index in 0..if grid.count > 1 { grid.count } else { 0 } {
        let Some(single) = single(index) else { break };
        panels.push(draw(single, context, |canvas, place| {
            let place = head(canvas, place);
            paint(canvas, index, place);
        })?);
    }
    let mut cells = Vec::new();
    let mut whole = draw(plan, context, |canvas, whole| {
        let place = head(canvas, whole);
        if place.top > whole.top {
            cells.push(Place { bottom: place.top - 3.0, ..whole }.boxed((0.0, 0.0), whole.bottom));
        }
        for index in 0..grid.count {
            let index_of_cell = (index % grid.columns, index / grid.columns);
            canvas.letter = letter(index).filter(|_| grid.has_letters());
            let cell = place.cell(index_of_cell, (grid.columns, rows), grid.gap);
            cells.push(cell.boxed(grid.gap, whole.bottom));
            paint(canvas, index, cell);
        }
    })?;
    whole.panels = panels;
    if grid.count > 1 {
        whole.cells = cells;
    }
    Ok(whole)
}

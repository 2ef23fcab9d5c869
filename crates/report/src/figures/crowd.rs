//! Participants as points while they can be told apart, as a density when they cannot.

use super::prelude::*;
use std::collections::BTreeMap;

/// Above this many, single participants are not drawn.
pub(crate) const MOST_POINTS: usize = 300;

/// Side of a cell of the density, in points.
const CELL: f64 = 4.5;

/// What a caption adds where a density is drawn instead of points: empty for few points.
pub(crate) fn words(points: usize) -> &'static str {
    if points > MOST_POINTS {
        " Shade: how many participants lie there (the root of their number), there being too many for single points."
    } else {
        ""
    }
}

/// Draws each point as a marker, or, above [`MOST_POINTS`], how densely they lie.
pub(crate) fn paint(
    canvas: &mut Canvas<'_>,
    frame: &Frame,
    points: &[(f64, f64)],
    radius: f64,
    (marker, colour): (Marker, RGBColor),
) {
    if points.len() <= MOST_POINTS {
        for &(x, y) in points {
            canvas.marker(frame.at(x, y), radius, marker, colour);
        }
        return;
    }
    let points = points.iter().map(|&(x, y)| (x, y, 0.0));
    paint_density(canvas, frame, points, |_| colour);
}

/// Shades each cell by how many points (x, y, any third number) lie there, in the colour of the mean of their third numbers.
pub(crate) fn paint_density(
    canvas: &mut Canvas<'_>,
    frame: &Frame,
    points: impl IntoIterator<Item = (f64, f64, f64)>,
    colour: impl Fn(f64) -> RGBColor,
) {
    let cells = cells(frame, points);
    let most = cells.iter().map(|cell| cell.count).max().unwrap_or(1);
    for cell in &cells {
        let (a, b) = cell.corners(frame);
        canvas.fill_rect(a, b, colour(cell.mean()), shade(cell.count, most));
    }
}

/// How dark a cell is: the root of its share, never invisible.
fn shade(count: usize, most: usize) -> f64 {
    0.1 + 0.8 * (count as f64 / most as f64).sqrt()
}

/// A cell of the density.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    column: i64,
    row: i64,
    count: usize,
    sum: f64,
}

impl Cell {
    /// Two opposite corners on the page, cut at the frame.
    fn corners(&self, frame: &Frame) -> ((f64, f64), (f64, f64)) {
        let left = frame.place.left + self.column as f64 * CELL;
        let top = frame.place.top + self.row as f64 * CELL;
        let end = ((left + CELL).min(frame.place.right), (top + CELL).min(frame.place.bottom));
        ((left, top), end)
    }

    /// Mean of the third number of the points in it.
    fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }
}

/// Counts points (x, y, any third number) in cells of the page, row by row.
fn cells(frame: &Frame, points: impl IntoIterator<Item = (f64, f64, f64)>) -> Vec<Cell> {
    let mut cells: BTreeMap<(i64, i64), (usize, f64)> = BTreeMap::new();
    for (x, y, third) in points {
        let (x, y) = frame.at(x, y);
        let column = ((x - frame.place.left) / CELL).floor() as i64;
        let row = ((y - frame.place.top) / CELL).floor() as i64;
        let cell = cells.entry((row, column)).or_default();
        cell.0 += 1;
        cell.1 += third;
    }
    cells
        .into_iter()
        .map(|((row, column), (count, sum))| Cell { column, row, count, sum })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A panel of 100 by 40 points on the page, of which x is 0 to 100 and y 0 to 40 upwards.
    fn frame() -> Frame {
        let place = Place { left: 20.0, top: 10.0, right: 120.0, bottom: 50.0 };
        let (x, y) = (Scale::between(0.0, 100.0, 5), Scale::between(0.0, 40.0, 4));
        Frame::laid(x, y, place)
    }

    #[test]
    fn points_are_counted_in_the_cells_where_they_lie_row_by_row() {
        let frame = frame();
        let points = [(1.0, 39.0, 2.0), (50.0, 1.0, 5.0), (4.4, 36.0, 4.0), (4.6, 39.0, 9.0)];
        let found = cells(&frame, points);
        let told: Vec<_> = found.iter().map(|c| (c.column, c.row, c.count)).collect();
        assert_eq!(told, [(0, 0, 2), (1, 0, 1), (11, 8, 1)]);
        let means: Vec<u64> = found.iter().map(|c| c.mean().to_bits()).collect();
        assert_eq!(means, [3.0, 9.0, 5.0].map(f64::to_bits));
        let corners = |i: usize| {
            let ((a, b), (c, d)) = found[i].corners(&frame);
            [a, b, c, d].map(|v| (100.0 * v).round() as i32)
        };
        assert_eq!(corners(0), [2000, 1000, 2450, 1450]);
        assert_eq!(corners(1), [2450, 1000, 2900, 1450]);
        // The last row is cut at the frame.
        assert_eq!(corners(2), [6950, 4600, 7400, 5000]);
        // So is the last column.
        let ((left, _), (right, _)) = cells(&frame, [(99.9, 20.0, 0.0)])[0].corners(&frame);
        assert!((left - 119.0).abs() < 1e-9 && (right - 120.0).abs() < 1e-9);
    }

    #[test]
    fn a_cell_is_as_dark_as_the_root_of_its_share_and_never_invisible() {
        for (count, shaded) in [(400, 0.9), (100, 0.5), (4, 0.18), (0, 0.1)] {
            assert!((shade(count, 400) - shaded).abs() < 1e-12, "{count}");
        }
        assert!(words(MOST_POINTS).is_empty() && words(MOST_POINTS + 1).contains("Shade"));
    }
}

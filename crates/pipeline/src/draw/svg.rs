//! A plain layered picture: one column a step from the sources, in pixels.

use super::{Node, Picture};

const BOX_HEIGHT: usize = 32;
const ROW: usize = 52;
const GAP: usize = 56;
const MARGIN: usize = 16;
/// A wide letter at the size of the text; names are plain ASCII.
const LETTER: usize = 9;

const HEAD: &str = "<defs><marker id=\"head\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" \
    markerWidth=\"7\" markerHeight=\"7\" orient=\"auto\"><path d=\"M0 0L8 4L0 8z\" \
    fill=\"#555\"/></marker></defs>\n";

/// Where the box of a stage stands.
#[derive(Clone, Copy, Default)]
struct Cell {
    column: usize,
    row: usize,
}

pub(super) fn draw(picture: &Picture<'_>) -> String {
    let cells = cells(picture);
    let box_width = picture.width() * LETTER + 2 * MARGIN;
    let left = |cell: Cell| MARGIN + cell.column * (box_width + GAP);
    let middle = |cell: Cell| MARGIN + cell.row * ROW + BOX_HEIGHT / 2;
    let columns = cells.iter().map(|c| c.column + 1).max().unwrap_or(0);
    let rows = cells.iter().map(|c| c.row + 1).max().unwrap_or(0);
    let edge = |(maker, user): (usize, usize)| {
        let (from, to) = (cells[maker], cells[user]);
        let (x, y) = (left(from) + box_width, middle(from));
        let (end_x, end_y) = (left(to), middle(to));
        let bend = usize::midpoint(x, end_x);
        // Along a row, past the boxes between: under them, not behind them.
        let passes = from.row == to.row && to.column > from.column + 1;
        let sag = if passes { ROW * 2 / 3 } else { 0 };
        let (bend_y, bend_end_y) = (y + sag, end_y + sag);
        format!(
            "<path d=\"M{x} {y}C{bend} {bend_y} {bend} {bend_end_y} {end_x} {end_y}\" fill=\"none\" \
             stroke=\"#555\" marker-end=\"url(#head)\"/>\n"
        )
    };
    let node = |(number, node): (usize, &Node)| {
        let cell = cells[number];
        let (x, y) = (left(cell), middle(cell) - BOX_HEIGHT / 2);
        let (text_x, text_y) = (x + box_width / 2, middle(cell) + 5);
        format!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{box_width}\" height=\"{BOX_HEIGHT}\" rx=\"4\" \
             fill=\"#f4f6f8\" stroke=\"#555\"/>\n<text x=\"{text_x}\" y=\"{text_y}\" \
             text-anchor=\"middle\">{}</text>\n",
            node.label
        )
    };
    let width = 2 * MARGIN + columns * (box_width + GAP) - GAP.min(columns * GAP);
    let height = 2 * MARGIN + rows * ROW - (ROW - BOX_HEIGHT);
    let edges: String = picture.edges().map(edge).collect();
    let nodes: String = picture.nodes.iter().enumerate().map(node).collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"14\">\n\
         {HEAD}{edges}{nodes}</svg>\n"
    )
}

/// Each stage one column right of the last of its makers, at the lowest free row from
/// that of its first maker on.
fn cells(picture: &Picture<'_>) -> Vec<Cell> {
    let mut cells = vec![Cell::default(); picture.nodes.len()];
    let mut next_row: Vec<usize> = Vec::new();
    for (number, node) in picture.nodes.iter().enumerate() {
        let makers: Vec<Cell> = node.makers.iter().map(|&i| cells[i]).collect();
        let column = makers.iter().map(|c| c.column + 1).max().unwrap_or(0);
        if next_row.len() <= column {
            next_row.resize(column + 1, 0);
        }
        let row = makers.iter().map(|c| c.row).min().unwrap_or(0);
        let row = row.max(next_row[column]);
        next_row[column] = row + 1;
        cells[number] = Cell { column, row };
    }
    cells
}

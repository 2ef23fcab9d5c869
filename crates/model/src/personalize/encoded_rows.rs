//! A drive's rows, encoded once: everything the losses need that does not depend on `w`.

use super::{
    frozen::Frozen,
    lines::{Line, ROWS},
};
use crate::rows::Row;
use crate::windows::SIGNALS;

/// [`ROWS`] rows; those past the data have weight 0 everywhere.
#[derive(Debug, Clone)]
pub(super) struct Tile {
    /// First layer of C before `w`.
    pub(super) lane_change: Vec<Line>,
    /// What only rows on the grid have: the others are there for their lane change alone.
    pub(super) grid: Option<GridPart>,
    /// Targets of F, C and V: standardised distance, 1 for a change, standardised speed.
    pub(super) targets: [Line; 3],
    /// Weights in L1, L2, L3 and L5.
    pub(super) weights: [Line; 4],
    /// Block of time of each row.
    pub(super) block: [usize; ROWS],
}

/// First layers of F, V and M before `w`.
#[derive(Debug, Clone)]
pub(super) struct GridPart {
    pub(super) following_distance: Vec<Line>,
    pub(super) velocity: Vec<Line>,
    pub(super) mutual_information: Vec<Line>,
}

/// Rows in tiles.
#[derive(Debug, Clone)]
pub(super) struct EncodedRows {
    pub(super) tiles: Vec<Tile>,
    /// Rows on the grid, at least 1.
    pub(super) grid_rows: f64,
    /// Blocks of time that the rows fall into.
    pub(super) blocks: usize,
}

impl EncodedRows {
    /// Encodes `rows`; `rows_per_block` rows of the grid make a block of time.
    pub(super) fn new(frozen: &Frozen, rows: &[Row], rows_per_block: usize) -> Self {
        let mut grid = Vec::new();
        let mut others = Vec::new();
        for row in rows {
            let block = grid.len() / rows_per_block.max(1);
            if row.on_grid {
                grid.push((row, block));
            } else {
                // Before the first row of the next block it still belongs to this one.
                others.push((row, grid.len().saturating_sub(1) / rows_per_block.max(1)));
            }
        }
        let blocks = grid.last().map_or(0, |(_, block)| block + 1);
        let tiles = grid.chunks(ROWS).map(|rows| tile(frozen, rows, true));
        let tiles = tiles.chain(others.chunks(ROWS).map(|rows| tile(frozen, rows, false)));
        Self {
            tiles: tiles.collect(),
            grid_rows: grid.len().max(1) as f64,
            blocks,
        }
    }
}

fn tile(frozen: &Frozen, rows: &[(&Row, usize)], on_grid: bool) -> Tile {
    let scaling = &frozen.scaling;
    let steps = frozen.window_steps;
    let mut window = vec![Line::ZERO; SIGNALS * steps];
    let mut lead_speed = [Line::ZERO];
    let mut targets = [Line::ZERO; 3];
    let mut weights = [Line::ZERO; 4];
    let mut blocks = [0; ROWS];
    let [ego, lead, ..] = &scaling.signals;
    for (r, &(row, block)) in rows.iter().enumerate() {
        for (signal, values) in row.window.chunks_exact(steps).enumerate() {
            let lines = &mut window[signal * steps..(signal + 1) * steps];
            for (line, &value) in lines.iter_mut().zip(values) {
                line.0[r] = scaling.signals[signal].apply(value) as f32;
            }
        }
        lead_speed[0].0[r] = lead.apply(row.lead_speed_mps) as f32;
        let distance = row.following_distance_m;
        let of_row = [
            distance.map_or(0.0, |d| scaling.following_distance.apply(d)),
            f64::from(u8::from(row.lane_change == Some(true))),
            ego.apply(row.ego_speed_mps),
        ];
        for (line, value) in targets.iter_mut().zip(of_row) {
            line.0[r] = value as f32;
        }
        for (line, weight) in weights.iter_mut().zip(frozen.row_weights.of_row(row)) {
            line.0[r] = weight as f32;
        }
        blocks[r] = block;
    }
    // C reads the first three signals, V the last three.
    let read = (SIGNALS - 1) * steps;
    let lane_context = frozen.lane_encoder.run(&window[..read]);
    let grid = on_grid.then(|| {
        let speed_context = frozen.speed_encoder.run(&window[steps..]);
        let reads: Vec<Line> = lead_speed
            .iter()
            .chain(&lane_context)
            .chain(&speed_context)
            .copied()
            .collect();
        GridPart {
            following_distance: frozen.following_distance.prepare(&lead_speed),
            velocity: frozen.velocity.prepare(&speed_context),
            mutual_information: frozen.mutual_information.prepare(&reads),
        }
    });
    Tile {
        lane_change: frozen.lane_change.prepare(&lane_context),
        grid,
        targets,
        weights,
        block: blocks,
    }
}

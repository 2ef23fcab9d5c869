//! One tile of rows through all five sub-networks and back.

use super::{
    layout::{Layer, Layout},
    matrix::Matrix,
    product::Start,
    through::{Gradients, Shared, Through, ZERO},
};
use crate::losses::{Sums, cross_entropy, normal, squared_error};

/// Most rows of a tile: few enough that what a layer reads and writes stays in the nearest cache.
pub(crate) const ROWS: usize = 64;

/// A row of data beside its window: what is known and what it counts for.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Known {
    /// v_lead, then the targets of F, C and V.
    pub(crate) values: [f32; 4],
    /// Weights in L1, L2, L3 and L5.
    pub(crate) weights: [f32; 4],
}

/// Hidden layers and output of a head, and the gradient by the output.
#[derive(Debug)]
struct Head {
    hidden: Vec<Matrix>,
    output: Matrix,
    by_output: Matrix,
}

impl Head {
    fn new(stack: &[Layer]) -> Self {
        let outputs = stack.last().map_or(0, |layer| layer.native.outputs);
        Self {
            hidden: hidden(stack),
            output: Matrix::zeros(ROWS, outputs),
            by_output: Matrix::zeros(ROWS, outputs),
        }
    }
}

fn hidden(stack: &[Layer]) -> Vec<Matrix> {
    let sizes = stack.iter().take(stack.len().saturating_sub(1));
    sizes.map(|layer| Matrix::zeros(ROWS, layer.native.outputs)).collect()
}

/// A tile with room for all it needs, kept from batch to batch.
#[derive(Debug)]
pub(crate) struct Tile {
    rows: usize,
    /// Shape `(rows, 4 × steps)`, in the order v_ego, v_lead, d_x, d_y; C reads the first three, V the last.
    pub(crate) windows: Matrix,
    /// First column that V reads.
    speed_window: usize,
    /// ε of the reparameterised sample, shape `(rows, d)`.
    pub(crate) noise: Matrix,
    pub(crate) known: Vec<Known>,
    /// Place of each row's driver in the roster.
    pub(crate) place: Vec<u32>,
    /// M's input; the encoders write their codes there, where the heads read them.
    reads: Matrix,
    by_reads: Matrix,
    lane_encoder: Vec<Matrix>,
    speed_encoder: Vec<Matrix>,
    following_distance: Head,
    lane_change: Head,
    velocity: Head,
    mutual_information: Head,
    /// Gradient by `w` of each row as L5's target.
    by_target: Matrix,
    scratch: [Matrix; 2],
}

/// The three predictions of a row, standardised; C's with the classes weighted as in training.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Predicted {
    pub(crate) following_distance: f32,
    pub(crate) probability: f32,
    pub(crate) speed: f32,
}

impl Tile {
    pub(crate) fn new(layout: &Layout, embedding_size: usize, window_numbers: usize) -> Self {
        let read = layout.speed_encoder[0].native.inputs;
        let stacks = [
            &layout.following_distance,
            &layout.lane_encoder,
            &layout.lane_head,
            &layout.speed_encoder,
            &layout.speed_head,
            &layout.mutual_information,
        ];
        let widest = stacks.into_iter().flatten().map(|layer| layer.width).max();
        let scratch = || Matrix::zeros(ROWS, widest.unwrap_or(0));
        Self {
            rows: 0,
            windows: Matrix::zeros(ROWS, window_numbers),
            speed_window: window_numbers - read,
            noise: Matrix::zeros(ROWS, embedding_size),
            known: vec![Known::default(); ROWS],
            place: vec![0; ROWS],
            reads: Matrix::zeros(ROWS, layout.reads.columns),
            by_reads: Matrix::zeros(ROWS, layout.reads.columns),
            lane_encoder: hidden(&layout.lane_encoder),
            speed_encoder: hidden(&layout.speed_encoder),
            following_distance: Head::new(&layout.following_distance),
            lane_change: Head::new(&layout.lane_head),
            velocity: Head::new(&layout.speed_head),
            mutual_information: Head::new(&layout.mutual_information),
            by_target: Matrix::zeros(ROWS, embedding_size),
            scratch: [scratch(), scratch()],
        }
    }

    /// How many rows have been put into the tile.
    pub(crate) fn set_rows(&mut self, rows: usize) {
        self.rows = rows.min(ROWS);
    }

    /// Through all networks to the losses, whose gradients by the outputs are left for [`Self::backward`].
    pub(crate) fn forward(&mut self, shared: &Shared<'_>) -> Sums {
        let layout = shared.layout;
        let columns = shared.roster.columns;
        let reads = layout.reads;
        for (row, known) in self.known[..self.rows].iter().enumerate() {
            self.reads.row_mut(row)[reads.lead_speed] = known.values[0];
        }
        let through = Through::new(shared, &self.place[..self.rows]);
        let encoders = [
            (&layout.lane_encoder, 0, &mut self.lane_encoder, 0),
            (&layout.speed_encoder, self.speed_window, &mut self.speed_encoder, reads.code),
        ];
        for (stack, window, hidden, code) in encoders {
            let code = self.reads.columns_mut(code);
            through.forward(stack, self.windows.columns(window), None, hidden, code);
        }
        let heads = [
            (
                &layout.following_distance,
                reads.lead_speed,
                columns.following_distance,
                &mut self.following_distance,
            ),
            (&layout.lane_head, 0, columns.lane_change, &mut self.lane_change),
            (&layout.speed_head, reads.code, columns.velocity, &mut self.velocity),
        ];
        for (stack, x, table, head) in heads {
            let out = head.output.columns_mut(0);
            let x = self.reads.columns(x);
            through.forward(stack, x, Some(table), &mut head.hidden, out);
        }
        let mut sums = Sums::default();
        self.predictor_losses(shared, &mut sums);
        if shared.weights.mutual_information > 0.0 {
            let head = &mut self.mutual_information;
            let out = head.output.columns_mut(0);
            let through = Through::new(shared, &self.place[..self.rows]);
            let x = self.reads.columns(0);
            through.forward(&layout.mutual_information, x, None, &mut head.hidden, out);
            self.mutual_information_loss(shared, &mut sums);
        }
        sums
    }

    /// Predictions of every row after [`Self::forward`].
    pub(crate) fn predicted(&self, layout: &Layout) -> impl Iterator<Item = Predicted> {
        let columns = layout.reads;
        (0..self.rows).map(move |row| {
            let reads = self.reads.row(row);
            Predicted {
                following_distance: reads[columns.following_distance],
                probability: reads[columns.probability],
                speed: reads[columns.speed],
            }
        })
    }

    /// Goes back through M to what it reads: the outputs of the predictors, the aggression and the embedding.
    fn mutual_information_backward(&mut self, shared: &Shared<'_>, to: &mut Gradients<'_>) {
        let (layout, columns) = (shared.layout, shared.roster.columns);
        let through = Through::new(shared, &self.place[..self.rows]);
        let head = &self.mutual_information;
        through.backward(
            &layout.mutual_information,
            (self.reads.columns(0), &head.hidden, head.by_output.columns(0)),
            None,
            Some((self.by_reads.columns_mut(0), ZERO)),
            &mut self.scratch,
            to,
        );
        let reads = layout.reads;
        for row in 0..self.rows {
            let by = self.by_reads.row(row);
            let out = &mut self.following_distance.by_output;
            out.row_mut(row)[0] += by[reads.following_distance];
            self.velocity.by_output.row_mut(row)[0] += by[reads.speed];
            let p = self.reads.row(row)[reads.probability];
            let slope = by[reads.probability] * p * (1.0 - p);
            let logits = self.lane_change.by_output.row_mut(row);
            logits[0] -= slope;
            logits[1] += slope;
            let line = to.lines.row_mut(self.place[row] as usize);
            line[columns.aggression] += by[reads.aggression];
            let by_embedding = &self.by_target.row(row);
            for (to, from) in line[columns.embedding..].iter_mut().zip(by_embedding.iter()) {
                *to += from;
            }
        }
    }

    /// Adds the gradients of what [`Self::forward`] computed.
    pub(crate) fn backward(&mut self, shared: &Shared<'_>, to: &mut Gradients<'_>) {
        let has_m = shared.weights.mutual_information > 0.0;
        if has_m {
            self.mutual_information_backward(shared, to);
        }
        let (layout, columns) = (shared.layout, shared.roster.columns);
        let through = Through::new(shared, &self.place[..self.rows]);
        let scratch = &mut self.scratch;
        let start = if has_m { Start::Add } else { ZERO };
        let head = &self.following_distance;
        through.backward(
            &layout.following_distance,
            (self.reads.columns(layout.reads.lead_speed), &head.hidden, head.by_output.columns(0)),
            Some(columns.following_distance),
            None,
            scratch,
            to,
        );
        let parts = [
            (
                &layout.lane_head,
                &layout.lane_encoder,
                &self.lane_change,
                &self.lane_encoder,
                columns.lane_change,
                (0, 0),
            ),
            (
                &layout.speed_head,
                &layout.speed_encoder,
                &self.velocity,
                &self.speed_encoder,
                columns.velocity,
                (layout.reads.code, self.speed_window),
            ),
        ];
        for (stack, encoder, head, hidden, table, (code, window)) in parts {
            through.backward(
                stack,
                (self.reads.columns(code), &head.hidden, head.by_output.columns(0)),
                Some(table),
                Some((self.by_reads.columns_mut(code), start)),
                scratch,
                to,
            );
            through.backward(
                encoder,
                (self.windows.columns(window), hidden, self.by_reads.columns(code)),
                None,
                None,
                scratch,
                to,
            );
        }
    }

    /// L1, L2 and L3, and their gradients by the outputs; puts the outputs before M.
    fn predictor_losses(&mut self, shared: &Shared<'_>, sums: &mut Sums) {
        let weights = &shared.weights;
        let reads = shared.layout.reads;
        let aggression = shared.roster.columns.aggression;
        let scaled = |c: f32, weight: f64| (f64::from(c) * weight * shared.scale) as f32;
        for row in 0..self.rows {
            let Known { values: [_, distance, change, speed], weights: [in_f, in_c, in_v, _] } =
                self.known[row];
            let f = self.following_distance.output.row(row)[0];
            let c = scaled(in_f, weights.following_distance);
            let (loss, slope) = squared_error(f, distance, c);
            sums.following_distance.add(loss, f64::from(in_f));
            self.following_distance.by_output.row_mut(row)[0] = slope;

            let v = self.velocity.output.row(row)[0];
            let c = scaled(in_v, weights.velocity);
            let (loss, slope) = squared_error(v, speed, c);
            sums.velocity.add(loss, f64::from(in_v));
            self.velocity.by_output.row_mut(row)[0] = slope;

            let logits = self.lane_change.output.row(row);
            let (keep, go) = (logits[0], logits[1]);
            let p = (1.0 / (1.0 + libm::exp(f64::from(keep - go)))) as f32;
            let c = scaled(in_c, weights.lane_change);
            let (loss, slopes) = cross_entropy(keep, go, p, change, c);
            sums.lane_change.add(loss, f64::from(in_c));
            self.lane_change.by_output.row_mut(row)[..2].copy_from_slice(&slopes);

            let input = self.reads.row_mut(row);
            input[reads.following_distance] = f;
            input[reads.probability] = p;
            input[reads.speed] = v;
            input[reads.aggression] = shared.roster.table.row(self.place[row] as usize)[aggression];
        }
    }

    /// L5 and its gradients by M's outputs and by `w`.
    fn mutual_information_loss(&mut self, shared: &Shared<'_>, sums: &mut Sums) {
        let embedding = shared.roster.columns.embedding;
        let d = shared.layout.mutual_information.last();
        let d = d.map_or(0, |layer| layer.native.outputs / 2);
        let share = shared.weights.mutual_information * shared.scale / d as f64;
        for row in 0..self.rows {
            let w = &shared.roster.table.row(self.place[row] as usize)[embedding..][..d];
            let c = f64::from(self.known[row].weights[3]);
            let out = self.mutual_information.output.row(row);
            let by_out = self.mutual_information.by_output.row_mut(row);
            let by_w = self.by_target.row_mut(row);
            let noise = self.noise.row(row);
            let (mut loss, mut likelihood, mut error) = (0.0, 0.0, 0.0);
            for i in 0..d {
                let (mean, log_sd) = (out[i], out[d + i]);
                let point = [mean, log_sd, noise[i], w[i]];
                let (one, slope, log) = normal(shared.reading, point, c * share);
                loss += one;
                likelihood += log;
                error += f64::from(mean - w[i]).powi(2);
                by_out[i] = slope.mean;
                by_out[d + i] = slope.log_sd;
                by_w[i] = slope.embedding;
            }
            sums.mutual_information.add(loss / d as f64, c);
            sums.log_likelihood.add(likelihood, c);
            sums.reading.add(error / d as f64, c);
        }
    }
}

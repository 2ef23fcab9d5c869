//! The linear counterpart of the networks: slopes for all drivers, one level a driver and output.
//!
//! Three heads of the one shape that read whole windows and know no style. With three outputs the drivers' own deviations are a
//! three-number embedding, and the model is linear in it and in the windows.

use crate::{
    heads::{DriveEvents, Event, Family, FittedHead, Outcome, Shape, fit, solve},
    held_out::Said,
    rows::{Row, RowWeights},
    scaling::Standardization,
    windows::SIGNALS,
};

/// Ridge on the slopes, as a share of the number of events; windows are standardised.
const RIDGE: f64 = 1e-3;

/// Signals of a window that an output reads.
const SPEED_READS: [usize; 3] = [1, 2, 3];
const CHANGE_READS: [usize; 3] = [0, 1, 2];

pub(super) struct LinearWindows {
    features: Vec<Standardization>,
    /// Of the gap, of a change being started, of the speed.
    heads: Vec<FittedHead>,
    /// What takes log-odds of a row to those of both classes at one half.
    balance: f64,
}

impl LinearWindows {
    pub(super) fn learn(of_each: &[Vec<Row>], weights: &RowWeights) -> Self {
        let all_rows = || of_each.iter().flatten();
        let numbers = all_rows().next().map_or(0, |r| r.window.len());
        let features: Vec<Standardization> = (0..numbers)
            .map(|k| Standardization::from_values(all_rows().map(move |r| r.window[k])))
            .collect();
        let read = 3 * numbers / SIGNALS;
        let shape = |name, family, reads| Shape {
            name,
            family,
            left_open: 1.0,
            reads,
            ridge: RIDGE * all_rows().count() as f64,
        };
        let shapes = [
            shape("gap", Family::Gaussian, 1),
            shape("change", Family::Logistic, read),
            shape("speed", Family::Gaussian, read),
        ];
        let drives: Vec<DriveEvents> = of_each.iter().map(|rows| events(&features, rows)).collect();
        let odds = weights.changing / weights.keeping;
        Self {
            heads: fit(&shapes, &drives, 0).heads,
            balance: if odds > 0.0 { libm::log(odds) } else { 0.0 },
            features,
        }
    }

    /// What it says of `unseen` rows of a driver whose `known` rows it has met.
    pub(super) fn say(&self, known: &[Row], unseen: &[Row]) -> Vec<Said> {
        let latent = solve(&self.heads, &events(&self.features, known), None, 0, None);
        let eta = |head: usize, reads: Vec<f64>| {
            let z = std::iter::once(1.0).chain(reads);
            let fitted = &self.heads[head];
            fitted.learned().then(|| fitted.eta(&[], z) + latent.mean[head])
        };
        let of_row = |row: &Row| Said {
            following_distance_m: eta(0, vec![row.lead_speed_mps]),
            log_odds: eta(1, read(&self.features, row, CHANGE_READS))
                .map(|odds| odds + self.balance),
            speed_mps: eta(2, read(&self.features, row, SPEED_READS)),
        };
        unseen.iter().map(of_row).collect()
    }
}

/// The standardised window of some signals.
fn read(features: &[Standardization], row: &Row, signals: [usize; 3]) -> Vec<f64> {
    let steps = row.window.len() / SIGNALS;
    let numbers = signals.into_iter().flat_map(|s| s * steps..(s + 1) * steps);
    numbers.map(|k| features[k].apply(row.window[k])).collect()
}

/// The rows of a drive as events of the three heads.
fn events(features: &[Standardization], rows: &[Row]) -> DriveEvents {
    let event =
        |reads: Vec<f64>, value: f64| Event { time_s: 0.0, reads, outcome: Outcome::Value(value) };
    let gap = |row: &Row| Some(event(vec![row.lead_speed_mps], row.following_distance_m?));
    let change = |row: &Row| {
        let change = f64::from(u8::from(row.lane_change?));
        Some(event(read(features, row, CHANGE_READS), change))
    };
    let speed = |row: &Row| {
        let speed = || event(read(features, row, SPEED_READS), row.ego_speed_mps);
        row.on_grid.then(speed)
    };
    vec![
        rows.iter().filter_map(gap).collect(),
        rows.iter().filter_map(change).collect(),
        rows.iter().filter_map(speed).collect(),
    ]
}

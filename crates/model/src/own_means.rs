//! What a driver's own averages predict.

use crate::{
    held_out::Said,
    rows::{Row, RowWeights},
};

/// Mean of what there is.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (n, sum) = values.fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v));
    (n > 0.0).then(|| sum / n)
}

fn gaps(rows: &[Row]) -> impl Iterator<Item = f64> + '_ {
    rows.iter().filter_map(|r| r.following_distance_m)
}

/// Time gap over following rows, in s.
fn time_gap(rows: &[Row]) -> Option<f64> {
    let pairs = rows.iter().filter_map(|r| Some((r.following_distance_m?, r.lead_speed_mps)));
    mean(pairs.filter(|(_, v)| *v > 1.0).map(|(gap, v)| gap / v))
}

/// Time with and without a change being started, in s.
fn seconds<'a>(rows: impl Iterator<Item = &'a Row>) -> [f64; 2] {
    let mut seconds = [0.0; 2];
    for row in rows {
        if let Some(change) = row.lane_change {
            seconds[usize::from(change)] += row.stands_for_s;
        }
    }
    seconds
}

/// The driver's mean speed, mean gap and rate of changes; the others' where the driver shows none.
pub(crate) struct OwnMeans {
    following_distance_m: Option<f64>,
    time_gap_s: Option<f64>,
    rate: f64,
    raised: f64,
}

impl OwnMeans {
    /// Learns what others do from the rows of each.
    pub(crate) fn learn(of_each: &[Vec<Row>], weights: &RowWeights) -> Self {
        let [keeping, changing] = seconds(of_each.iter().flatten());
        Self {
            following_distance_m: mean(of_each.iter().flat_map(|rows| gaps(rows))),
            time_gap_s: mean(of_each.iter().filter_map(|rows| time_gap(rows))),
            rate: changing / (keeping + changing).max(f64::MIN_POSITIVE),
            raised: weights.log_odds_raised,
        }
    }

    /// What the means of `known` rows say of any other.
    pub(crate) fn say(&self, known: &[Row]) -> Said {
        let [keeping, changing] = seconds(known.iter());
        // One change as the others make them is known beforehand, so that nobody has a rate of 0.
        let before = 1.0 / self.rate.max(1e-9);
        let change = changing + 1.0;
        let keep = keeping + before - 1.0;
        Said {
            following_distance_m: mean(gaps(known)).or(self.following_distance_m),
            log_odds: (self.rate > 0.0).then(|| libm::log(change / keep) + self.raised),
            speed_mps: mean(known.iter().filter(|r| r.on_grid).map(|r| r.ego_speed_mps)),
        }
    }

    /// What the mean time gap of `known` rows, times the lead's speed, says of a row.
    pub(crate) fn by_time_gap(&self, known: &[Row], row: &Row) -> Said {
        let gap_s = time_gap(known).or(self.time_gap_s);
        Said { following_distance_m: gap_s.map(|s| s * row.lead_speed_mps), ..Said::default() }
    }
}

//! How good heads are where they have not looked: the last part of drives of people that they did not learn from.

use super::{
    family::{Family, Outcome},
    fit::{DriveEvents, fit},
    fitted::{FittedHead, OwnHead},
    head::Event,
    list::HEADS,
    posterior::solve,
};
use serde::{Deserialize, Serialize};

/// Parts into which the people are split.
const FOLDS: usize = 5;
/// Share of a drive's events, from its start, that its driver is known by.
const KNOWN: f64 = 2.0 / 3.0;

/// Root-mean-square errors of one head over events kept back, in its unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct KeptBack {
    /// Events judged.
    pub events: usize,
    /// Of the head with the style that the first part of the drive shows.
    pub head: f64,
    /// Of the mean of that driver's own first part, the population's where there is none.
    pub own_mean: f64,
    /// Of the head with the mean style.
    pub everybody: f64,
}

#[derive(Clone, Copy, Default)]
struct Sums {
    n: usize,
    squares: [f64; 3],
}

/// Cross-fitted by person: `owners` names whose each drive is. One a head, in the order of [`HEADS`].
pub(super) fn kept_back(
    drives: &[DriveEvents],
    owners: &[&str],
    d: usize,
) -> Vec<Option<KeptBack>> {
    let mut people = owners.to_vec();
    people.sort_unstable();
    people.dedup();
    let mut sums = vec![Sums::default(); HEADS.len()];
    if people.len() >= FOLDS {
        let fold = |owner: &str| people.iter().position(|p| *p == owner).unwrap_or(0) % FOLDS;
        for left_out in 0..FOLDS {
            let both = || drives.iter().zip(owners);
            let seen = both().filter(|(_, o)| fold(o) != left_out);
            let seen: Vec<DriveEvents> = seen.map(|(e, _)| e.clone()).collect();
            let heads = fit(&HEADS.map(|h| h.shape()), &seen, d).heads;
            for (events, _) in both().filter(|(_, o)| fold(o) == left_out) {
                judge(&heads, events, d, &mut sums);
            }
        }
    }
    let errors = |sums: &Sums| {
        let root = |k: usize| (sums.squares[k] / sums.n as f64).sqrt();
        (sums.n > 0).then(|| KeptBack {
            events: sums.n,
            head: root(0),
            own_mean: root(1),
            everybody: root(2),
        })
    };
    sums.iter().map(errors).collect()
}

fn judge(heads: &[FittedHead], events: &DriveEvents, d: usize, sums: &mut [Sums]) {
    let end_s = events.iter().flatten().map(|e| e.time_s).fold(0.0, f64::max);
    let is_known = |e: &Event| e.time_s <= KNOWN * end_s;
    let known: DriveEvents =
        events.iter().map(|e| e.iter().filter(|e| is_known(e)).cloned().collect()).collect();
    let style = solve(heads, &known, None, d, None);
    for (k, fitted) in heads.iter().enumerate() {
        let own_head = OwnHead::new(fitted, style.w(d));
        let mean = OwnHead::new(fitted, &vec![0.0; d]);
        let (Some(own_head), Some(mean)) = (own_head, mean) else {
            continue;
        };
        let shown = own_mean(fitted.family, &known[k]);
        for event in events[k].iter().filter(|e| !is_known(e)) {
            let Outcome::Value(value) = event.outcome else {
                continue;
            };
            let everybody = mean.expected_for(event);
            sums[k].n += 1;
            let predictions = [own_head.expected_for(event), shown.unwrap_or(everybody), everybody];
            for (sum, prediction) in sums[k].squares.iter_mut().zip(predictions) {
                *sum += (prediction - value).powi(2);
            }
        }
    }
}

/// The middle of what somebody showed.
fn own_mean(family: Family, events: &[Event]) -> Option<f64> {
    let value = |e: &Event| match e.outcome {
        Outcome::Value(v) | Outcome::AtLeast(v) => family.linked(v),
    };
    let mean = events.iter().map(value).sum::<f64>() / events.len() as f64;
    let back = if family == Family::LogNormal { libm::exp(mean) } else { mean };
    (!events.is_empty()).then_some(back)
}

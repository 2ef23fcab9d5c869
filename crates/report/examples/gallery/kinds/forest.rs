//! Every pair of five conditions.

use super::wobble;
use maveric_report::{
    apa,
    figures::forest::{Forest, ForestRow},
};

pub(crate) fn input() -> Forest {
    let names = ["calm", "brisk", "late", "early", "own"];
    let pairs = (0..5).flat_map(|a| (a + 1..5).map(move |b| (a, b)));
    let row = |(a, b): (usize, usize)| {
        let value = 0.9 * wobble(a, b + 40);
        ForestRow {
            name: format!("{}|{}", names[a], names[b]),
            estimate: Some([value, value - 0.42, value + 0.45]),
            said: apa::p_holm((-4.0 * value.abs()).exp()).markup().to_owned(),
        }
    };
    Forest {
        title: "Differences of trust".into(),
        axis: "*d*_{z} (A minus B, 95% CI)".into(),
        rows: pairs.map(row).collect(),
        bounds: Some((-0.2, 0.2)),
        n: 24,
    }
}

//! Orders of conditions in which each stands in every place equally often.

use serde::{Deserialize, Serialize};

/// A square of orders: a row a person, over and over again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Square {
    /// Each condition stands in every place, and after every other, equally often: [`williams`].
    #[default]
    Williams,
    /// Each condition stands in every place equally often, and always after the same other: as few rows as there are conditions.
    Latin,
}

impl Square {
    /// Rows over so many conditions, after which it begins again.
    pub fn rows(self, conditions: usize) -> usize {
        match self {
            Self::Williams => williams_rows(conditions),
            Self::Latin => conditions,
        }
    }

    /// The row `index` over `conditions` places: numbers from 0, each once.
    pub fn row(self, conditions: usize, index: usize) -> Vec<usize> {
        match self {
            Self::Williams => williams(conditions, index),
            Self::Latin => (0..conditions).map(|place| (place + index) % conditions).collect(),
        }
    }
}

/// Rows of the Williams square over so many conditions.
pub fn williams_rows(conditions: usize) -> usize {
    if conditions.is_multiple_of(2) { conditions } else { 2 * conditions }
}

/// The row `index` of a Williams square over `conditions` places: numbers from 0, each once.
///
/// An even number of conditions needs as many rows, an odd one twice as many; further people begin again.
///
/// # Source
/// Williams 1949: 0, 1, n − 1, 2, n − 2, … and its shifts; for odd n the reverse of each too.
pub fn williams(conditions: usize, index: usize) -> Vec<usize> {
    if conditions == 0 {
        return Vec::new();
    }
    let row = index % williams_rows(conditions);
    let (shift, reversed) = (row % conditions, row >= conditions);
    let first = (0..conditions).map(|place| {
        if place % 2 == 1 { place.div_ceil(2) } else { (conditions - place / 2) % conditions }
    });
    let mut order: Vec<usize> = first.map(|c| (c + shift) % conditions).collect();
    if reversed {
        order.reverse();
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn every_condition_stands_in_every_place_and_after_every_other_equally_often() {
        for n in 1..=7_usize {
            let rows = williams_rows(n);
            let orders: Vec<Vec<usize>> = (0..rows).map(|index| williams(n, index)).collect();
            let mut places: BTreeMap<(usize, usize), usize> = BTreeMap::new();
            let mut after: BTreeMap<(usize, usize), usize> = BTreeMap::new();
            for order in &orders {
                let mut sorted = order.clone();
                sorted.sort_unstable();
                assert_eq!(sorted, (0..n).collect::<Vec<_>>(), "{n}: {order:?}");
                for (place, condition) in order.iter().enumerate() {
                    *places.entry((place, *condition)).or_default() += 1;
                }
                for pair in order.windows(2) {
                    *after.entry((pair[0], pair[1])).or_default() += 1;
                }
            }
            assert!(places.values().all(|count| *count == rows / n), "{n}");
            assert!(after.values().all(|count| *count == rows / n), "{n}");
            assert_eq!(after.len(), n * (n - 1), "{n}");
            assert_eq!(williams(n, rows), orders[0]);
        }
    }

    #[test]
    fn a_latin_square_has_each_condition_in_every_place_once() {
        for n in 1..=7_usize {
            assert_eq!(Square::Latin.rows(n), n);
            for place in 0..n {
                let mut there: Vec<usize> =
                    (0..n).map(|row| Square::Latin.row(n, row)[place]).collect();
                there.sort_unstable();
                assert_eq!(there, (0..n).collect::<Vec<_>>());
            }
        }
    }
}

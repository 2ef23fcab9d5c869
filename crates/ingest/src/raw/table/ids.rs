//! Names of vehicles as numbers: names are text until all of a file are known.

use crate::raw::GIVEN_FROM;
use std::collections::BTreeMap;

/// A number for each name, different for different names: a name that is a number in its usual form keeps it, and if none
/// is, names are counted from 0.
pub(super) fn numbers(names: &[String]) -> Vec<u32> {
    let usual = |name: &String| {
        let number: u32 = name.parse().ok()?;
        (number < GIVEN_FROM && number.to_string() == *name).then_some(number)
    };
    let from = if names.iter().any(|name| usual(name).is_some()) { GIVEN_FROM } else { 0 };
    let number = |(place, name): (u32, &String)| usual(name).unwrap_or(from + place);
    (0..GIVEN_FROM / 2).zip(names).map(number).collect()
}

/// Different keys with their numbers from 0, in their order.
pub(super) fn numbered<K: Ord>(keys: impl Iterator<Item = K>) -> BTreeMap<K, u32> {
    let mut numbers: BTreeMap<K, u32> = BTreeMap::new();
    for key in keys {
        numbers.entry(key).or_default();
    }
    for (i, number) in (0..).zip(numbers.values_mut()) {
        *number = i;
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn different_names_have_different_numbers_and_usual_ones_keep_theirs() {
        let names = ["1", "7", "007", "car", "-1", "4294967297", "99999999999"];
        let names = names.map(str::to_owned);
        let found = numbers(&names);
        assert_eq!(found[..2], [1, 7]);
        assert_eq!(found.iter().collect::<BTreeSet<_>>().len(), names.len());
        assert_eq!(numbers(&["b", "c"].map(str::to_owned)), [0, 1]);
    }
}

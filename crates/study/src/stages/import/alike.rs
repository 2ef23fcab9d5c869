//! Columns that look like those of a scale but for a part of their names: most likely the same questions after another condition.

use super::{columns::Columns, formats::Format, grid::Grid};
use crate::error::StudyError;
use std::collections::{BTreeMap, BTreeSet};

/// Fewest letters that two names share to be alike; half of them at least.
const SHARED_LETTERS: usize = 3;

/// Refuses a pattern that names the columns of one condition alone, of `scales` of which nothing says when they were answered: they would
/// count as answered before the drives.
///
/// # Errors
/// [`StudyError::BadFile`] naming pattern and columns, and what to write.
pub(super) fn refuse(
    grid: &Grid,
    format: &Format,
    columns: &Columns<'_>,
    scales: &BTreeSet<usize>,
    unused: &BTreeSet<String>,
) -> Result<(), StudyError> {
    for (position, pattern) in columns.patterns().enumerate().filter(|(p, _)| scales.contains(p)) {
        let scale = &columns.scales[position];
        let (before, behind) = pattern.around_item();
        let mut others: BTreeMap<&str, (usize, &str)> = BTreeMap::new();
        for name in unused {
            let (_, field) = format.field_of(name);
            if let Some(other) = other_stem(field, &before, &behind) {
                others.entry(other).or_insert((0, name.as_str())).0 += 1;
            }
        }
        let whole = others.values().find(|(n, _)| *n >= scale.items.len());
        if let Some((_, example)) = whole {
            let id = &scale.id;
            let problem = format!(
                "scale `{id}`: `{before}{{item}}{behind}` names the columns of one moment only, and it is not said which: `{example}` and others look the same"
            );
            let help = format!(
                "in the map of columns, under [scales.{id}], put `{{condition}}` where they differ (column = \"{{condition}}…{{item}}\", with the words under [moments]), or say when these were answered: moment = \"pre\""
            );
            return Err(StudyError::file(grid.path(), problem).with_help(help));
        }
    }
    Ok(())
}

/// What stands before the item's number in a name that is like a pattern, and is not the same.
fn other_stem<'n>(name: &'n str, before: &str, behind: &str) -> Option<&'n str> {
    let stem = name.strip_suffix(behind)?;
    let other = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    let letters = |text: &mut dyn Iterator<Item = char>| text.filter(|c| c.is_alphabetic()).count();
    let shared = |pairs: &mut dyn Iterator<Item = (char, char)>| {
        letters(&mut pairs.take_while(|(a, b)| a == b).map(|(a, _)| a))
    };
    let ahead = shared(&mut other.chars().zip(before.chars()));
    let back = shared(&mut other.chars().rev().zip(before.chars().rev()));
    let most = SHARED_LETTERS.max(letters(&mut before.chars()).div_ceil(2));
    let numbered = other.len() < stem.len();
    (other != before && numbered && ahead + back >= most).then_some(other)
}

//! Columns that are numbered alike, which may be the items of a scale.

use super::{columns::Columns, formats::Format, grid::Grid, word_in_name::place_of};
use maveric_domain::{
    Moment, Scale,
    design::Software,
    survey::{Item, Kind},
};
use std::collections::BTreeMap;

/// Columns whose names differ in one number alone.
#[derive(Debug)]
pub(super) struct Family {
    pub(super) before: String,
    pub(super) behind: String,
    pub(super) columns: BTreeMap<u32, usize>,
}

impl Family {
    pub(super) fn pattern(&self) -> String {
        format!("{}{{item}}{}", self.before, self.behind)
    }
}

/// Every family of columns whose numbers are 1, 2, 3 and so on.
pub(super) fn families(grid: &Grid, format: &Format) -> Vec<Family> {
    let mut families: BTreeMap<(String, String), BTreeMap<u32, usize>> = BTreeMap::new();
    for (column, name) in grid.columns.iter().enumerate() {
        let field = numbered_part(format, name);
        let is_digit = |at: usize| field.as_bytes().get(at).is_some_and(u8::is_ascii_digit);
        let starts = (0..field.len()).filter(|at| is_digit(*at) && (*at == 0 || !is_digit(at - 1)));
        for start in starts {
            let end = (start..field.len()).find(|at| !is_digit(*at)).unwrap_or(field.len());
            if let Ok(number) = field[start..end].parse() {
                let key = (field[..start].to_owned(), field[end..].to_owned());
                families.entry(key).or_default().insert(number, column);
            }
        }
    }
    let families =
        families.into_iter().map(|((before, behind), columns)| Family { before, behind, columns });
    let is_counted =
        |family: &Family| family.columns.keys().copied().eq(1..=family.columns.len() as u32);
    families.filter(|family| family.columns.len() > 1 && is_counted(family)).collect()
}

/// The part of a column's name that tells it from others: its field; of a table of no known software the whole, where what stands behind its
/// last dot is a number alone (`adb.7`) or has none (`adb_7.calm`).
fn numbered_part<'n>(format: &Format, name: &'n str) -> &'n str {
    let (_, field) = format.field_of(name);
    let is_digit = |c: char| c.is_ascii_digit();
    let is_name = field.contains(is_digit) && !field.chars().all(is_digit);
    if format.software == Software::Wide && !is_name {
        return name;
    }
    field
}

/// How the answers in a family of columns look to a scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Answers {
    Within,
    /// All within, when 1 is added.
    FromZero,
    Words,
    Beyond,
}

pub(super) fn answers(grid: &Grid, scale: &Scale, family: &Family) -> Answers {
    let mut numbers: Vec<(&Item, i32)> = Vec::new();
    for (number, column) in &family.columns {
        let Some(item) = scale.item(*number) else {
            return Answers::Beyond;
        };
        for cell in grid.filled(*column).filter(|_| item.kind != Kind::Text) {
            match cell.parse().ok().or_else(|| scale.answer_in_words(*number, cell)) {
                Some(answer) => numbers.push((item, answer)),
                None => return Answers::Words,
            }
        }
    }
    // Negative numbers are codes for no answer.
    let given = || numbers.iter().filter(|(item, n)| *n >= item.min.min(0));
    let possible =
        |(item, n): &(&Item, i32), add| n.checked_add(add).is_some_and(|n| item.takes(n));
    if given().all(|answer| possible(answer, 0)) {
        Answers::Within
    } else if given().all(|answer| answer.0.min == 1 && possible(answer, 1)) {
        Answers::FromZero
    } else {
        Answers::Beyond
    }
}

/// The one pattern of several families whose names differ in one place, and what stands there.
pub(super) fn joint_pattern(families: &[&Family]) -> Option<(String, Vec<String>)> {
    let (first, rest) = families.split_first()?;
    if rest.is_empty() || rest.iter().any(|f| f.behind != first.behind) {
        return None;
    }
    let names: Vec<Vec<char>> = families.iter().map(|f| f.before.chars().collect()).collect();
    let shortest = names.iter().map(Vec::len).min()?;
    let same = |at: &dyn Fn(&Vec<char>) -> Option<char>| {
        names.iter().all(|name| at(name) == at(&names[0]))
    };
    let ahead = (0..shortest).take_while(|i| same(&|name| name.get(*i).copied())).count();
    let back = (0..shortest - ahead)
        .take_while(|i| same(&|name| name.iter().rev().nth(*i).copied()))
        .count();
    let middle = |name: &Vec<char>| name[ahead..name.len() - back].iter().collect::<String>();
    let words: Vec<String> = names.iter().map(middle).collect();
    if words.iter().any(String::is_empty) {
        return None;
    }
    let text = |part: &[char]| part.iter().collect::<String>();
    let ends = (text(&names[0][..ahead]), text(&names[0][names[0].len() - back..]));
    Some((format!("{}{{condition}}{}{{item}}{}", ends.0, ends.1, first.behind), words))
}

/// A family's pattern, `{condition}` where a word stands that the study knows as one.
pub(super) fn with_condition(family: &Family, columns: &Columns<'_>) -> String {
    let known = [Moment::Pre, Moment::Post].map(|moment| moment.to_string());
    let mut words: Vec<&str> = columns.words().chain(known.iter().map(String::as_str)).collect();
    words.sort_by_key(|word| std::cmp::Reverse(word.len()));
    let replaced = |text: &str| {
        let place = words.iter().find_map(|word| Some((place_of(text, word)?, word.len())));
        place.map(|(start, length)| {
            format!("{}{{condition}}{}", &text[..start], &text[start + length..])
        })
    };
    let before = replaced(&family.before);
    let behind = if before.is_none() { replaced(&family.behind) } else { None };
    format!(
        "{}{{item}}{}",
        before.as_ref().unwrap_or(&family.before),
        behind.as_ref().unwrap_or(&family.behind)
    )
}

/// Whether the study's only condition stands in a family's names and is no part of the scale's own.
pub(super) fn names_only_condition(scale: &Scale, family: &Family, columns: &Columns<'_>) -> bool {
    let stands = |name: &str| {
        let only = columns.only_condition.as_ref();
        only.is_some_and(|only| place_of(name, only.as_str()).is_some())
    };
    (stands(&family.before) || stands(&family.behind)) && !stands(&scale.id)
}

/// Whether a part of a scale's id stands in the names of a family.
pub(super) fn resembles(scale: &Scale, family: &Family) -> bool {
    let name = format!("{}|{}", family.before, family.behind).to_lowercase();
    let mut parts = scale.id.split('_').filter(|part| part.len() >= 3);
    parts.any(|part| name.contains(&part.to_lowercase()))
}

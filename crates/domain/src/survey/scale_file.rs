//! A questionnaire's file: short forms and tables of items are read into one list of items and their words.

use super::{
    item::{Item, Kind},
    scale::Scale,
    subscale::{NormCorrelation, Scoring, Subscale},
    words_file::{ItemTexts, Words, complete},
};
use crate::error::DomainError;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Most items that a questionnaire may have: a slip of the keyboard should not ask a million questions.
const MOST_ITEMS: usize = 1000;

/// Answers lie between this and its negative.
const FURTHEST: i32 = 1_000_000_000;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScaleFile {
    id: String,
    title: String,
    reference: String,
    licence: Option<String>,
    #[serde(default)]
    kind: Kind,
    items: Option<usize>,
    min: Option<i32>,
    max: Option<i32>,
    step: Option<i32>,
    #[serde(default)]
    reversed: Vec<u32>,
    #[serde(default)]
    item: Vec<ItemTable>,
    scoring: Option<Scoring>,
    #[serde(default = "default_min_answered")]
    min_answered: f64,
    #[serde(default)]
    subscales: Vec<Subscale>,
    column: Option<String>,
    #[serde(default)]
    correlations: Vec<NormCorrelation>,
    #[serde(default = "default_language")]
    language: String,
    shown_title: Option<String>,
    instruction: Option<String>,
    #[serde(default)]
    anchors: Vec<String>,
    #[serde(default)]
    levels: Vec<String>,
    #[serde(default)]
    wording: Vec<String>,
    #[serde(default)]
    pairs: Vec<Vec<String>>,
    #[serde(default)]
    translation: BTreeMap<String, Words>,
}

fn default_min_answered() -> f64 {
    0.8
}

fn default_language() -> String {
    "en".to_owned()
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ItemTable {
    kind: Option<Kind>,
    min: Option<i32>,
    max: Option<i32>,
    step: Option<i32>,
    reversed: bool,
    expected: Option<i32>,
    optional: bool,
    text: String,
    pair: Vec<String>,
    anchors: Vec<String>,
    levels: Vec<String>,
}

impl Scale {
    /// Reads a questionnaire's file and checks that it agrees with itself.
    ///
    /// # Errors
    /// [`DomainError::ScaleToml`] naming line and key where the text is no definition; [`DomainError::BadScale`] naming the first
    /// contradiction.
    ///
    /// # Example
    /// ```
    /// let scale = maveric_domain::Scale::from_toml(r#"
    ///     id = "calm"
    ///     title = "Calmness"
    ///     reference = "made up"
    ///     items = 2
    ///     min = 1
    ///     max = 7
    ///     anchors = ["not at all", "very"]
    ///     scoring = "mean"
    ///     reversed = [2]
    ///     [[subscales]]
    ///     id = "calm"
    ///     title = "Calmness"
    ///     items = [1, 2]
    /// "#)?;
    /// assert!(scale.is_reversed(&scale.subscales[0], 2));
    /// # Ok::<(), maveric_domain::DomainError>(())
    /// ```
    pub fn from_toml(text: &str) -> Result<Self, DomainError> {
        let file: ScaleFile = toml::from_str(text)
            .map_err(|e| DomainError::ScaleToml { problem: e.to_string().trim_end().to_owned() })?;
        let scale = file.id.clone();
        let scale = file.scale().map_err(|problem| DomainError::BadScale { scale, problem })?;
        scale.checked()
    }
}

impl ScaleFile {
    fn scale(mut self) -> Result<Scale, String> {
        let tables = std::mem::take(&mut self.item);
        let n = self.count(tables.len())?;
        let items: Vec<Item> = match tables.len() {
            0 => {
                let like_the_scale = self.item(&ItemTable::default(), 1);
                vec![like_the_scale.map_err(|e| e.replace("item 1: ", ""))?; n]
            }
            _ => (1..)
                .zip(&tables)
                .map(|(number, table)| self.item(table, number))
                .collect::<Result<_, _>>()?,
        };
        let items = self.reversed(items)?;
        let texts = |table: ItemTable| ItemTexts {
            text: table.text,
            pair: table.pair,
            anchors: table.anchors,
            levels: table.levels,
        };
        let words = Words {
            shown_title: self.shown_title,
            instruction: self.instruction,
            anchors: self.anchors,
            levels: self.levels,
            items: self.wording,
            pairs: self.pairs,
            item: tables.into_iter().map(texts).collect(),
        };
        let wording = words.wording("wording", self.kind, &items)?;
        let mut translations = BTreeMap::new();
        for (language, words) in self.translation {
            let translated = words.wording("items", self.kind, &items);
            let translated = translated
                .and_then(|translated| complete(translated, &wording))
                .map_err(|problem| format!("[translation.{language}]: {problem}"))?;
            if language == self.language {
                return Err(format!(
                    "[translation.{language}] is the language of the file itself (`language`)"
                ));
            }
            translations.insert(language, translated);
        }
        let scoring = match self.scoring {
            None if !self.subscales.is_empty() => {
                return Err("has subscales, expected scoring = \"sum\" or \"mean\"".to_owned());
            }
            scoring => scoring.unwrap_or(Scoring::Mean),
        };
        Ok(Scale {
            id: self.id,
            title: self.title,
            reference: self.reference,
            licence: self.licence,
            items,
            scoring,
            min_answered: self.min_answered,
            subscales: self.subscales,
            column: self.column,
            correlations: self.correlations,
            language: self.language,
            wording,
            translations,
        })
    }

    /// How many items there are: the keys that list them agree.
    fn count(&self, tables: usize) -> Result<usize, String> {
        let lists = [tables, self.pairs.len(), self.wording.len()];
        let listed = lists.into_iter().find(|n| *n > 0);
        let Some(n) = self.items.or(listed) else {
            return Err(
                "has no items, expected `items = N`, `wording`, `pairs` or [[item]]".to_owned()
            );
        };
        match tables {
            _ if !(1..=MOST_ITEMS).contains(&n) => {
                Err(format!("{n} items, expected at least one item and at most {MOST_ITEMS}"))
            }
            0 => Ok(n),
            tables if tables == n => Ok(n),
            tables => Err(format!("has {tables} tables [[item]] for {n} items")),
        }
    }

    /// One item; what the scale says of range and levels holds for items of its kind.
    fn item(&self, table: &ItemTable, number: usize) -> Result<Item, String> {
        let kind = table.kind.unwrap_or(self.kind);
        let bad = |problem: String| Err(format!("item {number}: {problem}"));
        let of_scale = |key: Option<i32>| key.filter(|_| kind == self.kind);
        let (mut min, mut max) =
            (table.min.or(of_scale(self.min)), table.max.or(of_scale(self.max)));
        let step = table.step.or(of_scale(self.step));
        if kind.has_levels() {
            let levels = self.levels_of(table, kind, min.zip(max));
            if levels < 2 {
                let kind = kind.name();
                return bad(format!("a `{kind}` with {levels} `levels`, expected two or more"));
            }
            let lowest = min.unwrap_or(1);
            let highest = lowest.saturating_add(levels - 1);
            if let Some(max) = max.filter(|max| *max != highest) {
                return bad(format!(
                    "{levels} levels from {lowest} end at {highest}, and max is {max}"
                ));
            }
            (min, max) = (Some(lowest), Some(highest));
        }
        if kind == Kind::Text {
            if min.or(max).or(step).is_some() {
                return bad("a `text` has neither min, max nor step".to_owned());
            }
            (min, max) = (Some(0), Some(0));
        }
        let (Some(min), Some(max)) = (min, max) else {
            return bad(format!("a `{}` needs min and max", kind.name()));
        };
        if kind != Kind::Text && min >= max {
            return bad(format!("min {min} is not below max {max}"));
        }
        if min < -FURTHEST || max > FURTHEST {
            return bad(format!("{min} to {max}, expected within ±{FURTHEST}"));
        }
        if let Some(step) = step.filter(|s| kind != Kind::Slider || *s < 1 || (max - min) % s != 0)
        {
            return bad(format!(
                "step {step}, expected one of a slider that leads from {min} to {max}"
            ));
        }
        let item = Item {
            kind,
            min,
            max,
            step: step.unwrap_or(1),
            reversed: table.reversed,
            expected: table.expected,
            optional: table.optional,
        };
        if item.reversed && !kind.rates() {
            return bad(format!("a `{}` cannot be reversed", kind.name()));
        }
        match item.expected {
            Some(answer) if !item.takes(answer) => {
                let range = item.range();
                bad(format!("expected is {answer}, which is no answer ({range})"))
            }
            _ => Ok(item),
        }
    }

    /// How many levels a ladder or a choice has: those that are written, or as many as a ladder without words leads through.
    fn levels_of(&self, table: &ItemTable, kind: Kind, ends: Option<(i32, i32)>) -> i32 {
        let of_scale = self.levels.len() * usize::from(kind == self.kind);
        let own_levels = Some(table.levels.len()).filter(|n| *n > 0);
        match (own_levels.unwrap_or(of_scale), ends) {
            (0, Some((min, max))) if kind == Kind::Ladder => {
                max.saturating_sub(min).saturating_add(1).max(0)
            }
            (written, _) => i32::try_from(written).unwrap_or(i32::MAX),
        }
    }

    /// Reverses the items that `reversed` lists, too.
    fn reversed(&self, mut items: Vec<Item>) -> Result<Vec<Item>, String> {
        let n = items.len();
        for number in &self.reversed {
            let listed = (*number as usize).checked_sub(1);
            match listed.and_then(|place| items.get_mut(place)) {
                Some(item) if item.kind.rates() => item.reversed = true,
                Some(item) => {
                    let kind = item.kind.name();
                    return Err(format!("item {number}: a `{kind}` cannot be reversed"));
                }
                None => {
                    return Err(format!("reversed item {number} is not among its {n} items"));
                }
            }
        }
        Ok(items)
    }
}

#[cfg(test)]
mod tests;

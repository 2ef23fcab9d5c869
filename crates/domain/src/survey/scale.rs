//! A questionnaire, as it was read and checked.

use super::{
    item::{Item, Kind},
    subscale::{NormCorrelation, Scoring, Subscale},
    wording::Wording,
};
use crate::error::DomainError;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A questionnaire: its items, their words, and how they are scored. [`Scale::from_toml`] makes and checks it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scale {
    /// Code name, such as `mini_ipip`.
    pub id: String,
    /// Name for the analyst; nobody who answers reads it.
    pub title: String,
    /// Where the scale was published.
    pub reference: String,
    /// What may be done with the wording.
    pub licence: Option<String>,
    /// Its items; they are numbered from 1.
    pub items: Vec<Item>,
    /// Sum or mean.
    pub scoring: Scoring,
    /// Share of a subscale's items that must be answered for it to be scored.
    pub min_answered: f64,
    /// What is scored; nothing of a questionnaire that is only asked.
    pub subscales: Vec<Subscale>,
    /// How survey software names the column of an item: a pattern with `{item}`; without it `ID_{item}`.
    pub column: Option<String>,
    /// Usual correlations between subscales; made-up people are made to have them.
    pub correlations: Vec<NormCorrelation>,
    /// The language of the file's own words, such as `en`.
    pub language: String,
    /// Its words in that language.
    pub wording: Wording,
    /// And in others.
    pub translations: BTreeMap<String, Wording>,
}

impl Scale {
    /// How many items it has.
    pub fn count(&self) -> u32 {
        self.items.len() as u32
    }

    /// The item of this number, from 1.
    pub fn item(&self, number: u32) -> Option<&Item> {
        self.items.get((number as usize).checked_sub(1)?)
    }

    /// The answers that its items have, each once.
    pub fn ranges(&self) -> String {
        let mut ranges: Vec<String> = Vec::new();
        for range in self.items.iter().map(Item::range) {
            if !ranges.contains(&range) {
                ranges.push(range);
            }
        }
        ranges.join(", ")
    }

    /// Its words in a language; `de` also where it is asked for `de-at`.
    pub fn wording_in(&self, language: &str) -> Option<&Wording> {
        let wording = |language: &str| match self.translations.get(language) {
            None if language == self.language => Some(&self.wording),
            translated => translated,
        };
        let general = || wording(language.split_once('-')?.0);
        wording(language).or_else(general)
    }

    /// The languages that it is there in, its own first.
    pub fn languages(&self) -> impl Iterator<Item = &str> {
        let original = std::iter::once(self.language.as_str());
        original.chain(self.translations.keys().map(String::as_str))
    }

    /// The answer that these words stand for in any language, in small or large letters, where each answer of the item has words.
    pub fn answer_in_words(&self, number: u32, words: &str) -> Option<i32> {
        let item = self.item(number)?;
        let wordings = std::iter::once(&self.wording).chain(self.translations.values());
        wordings
            .map(|wording| &wording.items[number as usize - 1].anchors)
            .filter(|anchors| anchors.len() == item.points())
            .find_map(|anchors| {
                let same = |(_, anchor): &(i32, &String)| anchor.eq_ignore_ascii_case(words);
                Some(item.answers().zip(anchors).find(same)?.0)
            })
    }

    /// The names of its scores: `scale.subscale`.
    pub fn score_names(&self) -> impl Iterator<Item = String> {
        let subscales = self.subscales.iter();
        subscales.map(|subscale| format!("{}.{}", self.id, subscale.id))
    }

    /// The subscales that a score adds up: itself, or those of `sum_of`.
    pub fn parts<'a>(&'a self, subscale: &'a Subscale) -> Vec<&'a Subscale> {
        if subscale.sum_of.is_empty() {
            return vec![subscale];
        }
        let part = |id: &String| self.subscales.iter().find(|s| s.id == *id);
        subscale.sum_of.iter().filter_map(part).collect()
    }

    /// The items of a score, each once, in their order.
    pub fn items_of(&self, subscale: &Subscale) -> Vec<u32> {
        if subscale.sum_of.is_empty() {
            return subscale.items.clone();
        }
        let parts = self.parts(subscale).into_iter();
        let items: BTreeSet<u32> = parts.flat_map(|part| part.items.iter().copied()).collect();
        items.into_iter().collect()
    }

    /// Lowest and highest possible score of a subscale.
    pub fn score_range(&self, subscale: &Subscale) -> (f64, f64) {
        let (mut low, mut high) = (0.0, 0.0);
        for part in self.parts(subscale) {
            let times = match self.scoring {
                Scoring::Mean => 1.0,
                Scoring::Sum => part.items.len() as f64,
            };
            if let Some(item) = part.items.first().and_then(|first| self.item(*first)) {
                low += times * f64::from(item.min);
                high += times * f64::from(item.max);
            }
        }
        (subscale.weight * low, subscale.weight * high)
    }

    /// The column in which survey software keeps an item's answer, by the scale's pattern.
    pub fn column_of(&self, item: u32) -> String {
        let pattern = self.column.clone();
        let pattern = pattern.unwrap_or_else(|| format!("{}_{{item}}", self.id));
        pattern.replace("{item}", &item.to_string())
    }

    /// Whether `item` is reversed in `subscale`.
    pub fn is_reversed(&self, subscale: &Subscale, item: u32) -> bool {
        self.item(item).is_some_and(|i| i.reversed) || subscale.reversed.contains(&item)
    }

    /// Says whether the definition agrees with itself.
    ///
    /// # Errors
    /// [`DomainError::BadScale`] naming the first contradiction.
    pub(super) fn checked(self) -> Result<Self, DomainError> {
        let problem = self.contradiction().err();
        match problem {
            None => Ok(self),
            Some(problem) => Err(DomainError::BadScale { scale: self.id, problem }),
        }
    }

    fn contradiction(&self) -> Result<(), String> {
        let is_code_name = |text: &str| {
            let fits = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_';
            !text.is_empty() && text.bytes().all(fits)
        };
        let ids = std::iter::once(&self.id).chain(self.subscales.iter().map(|s| &s.id));
        for id in ids {
            if !is_code_name(id) {
                return Err(format!("id `{id}` must be lower-case letters, digits and `_`"));
            }
        }
        let share = self.min_answered;
        if !(share > 0.0 && share <= 1.0) {
            return Err(format!("min_answered {share} is not in (0, 1]"));
        }
        for (place, subscale) in self.subscales.iter().enumerate() {
            let id = &subscale.id;
            if self.subscales[..place].iter().any(|s| s.id == *id) {
                return Err(format!("subscale `{id}` is defined twice"));
            }
            self.subscale(subscale).map_err(|problem| format!("subscale `{id}`{problem}"))?;
        }
        if let Some(column) = self.column.as_deref().filter(|c| !c.contains("{item}")) {
            return Err(format!(
                "column `{column}` has no `{{item}}` where the item's number stands"
            ));
        }
        self.correlations()
    }

    /// What is wrong with a subscale, as the end of a sentence that begins with its name.
    fn subscale(&self, sub: &Subscale) -> Result<(), String> {
        let n = self.items.len();
        if !(sub.weight.is_finite() && sub.weight > 0.0) {
            return Err(format!(": weight is {}, expected a number above 0", sub.weight));
        }
        if sub.sum_of.is_empty() && sub.items.is_empty() {
            return Err(" has no items".to_owned());
        }
        if !sub.sum_of.is_empty() {
            self.sum(sub)?;
        }
        let mut seen = BTreeSet::new();
        for item in &sub.items {
            let Some(asked) = self.item(*item) else {
                return Err(format!(" names item {item} of {n}"));
            };
            if !seen.insert(item) {
                return Err(format!(" names item {item} twice"));
            }
            if matches!(asked.kind, Kind::Choice | Kind::Text) {
                let kind = asked.kind.name();
                return Err(format!(" scores item {item}, a `{kind}`: its answers are no numbers"));
            }
            if asked.expected.is_some() {
                return Err(format!(
                    " scores item {item}, which is there for attention (`expected`)"
                ));
            }
            let first = self.item(sub.items[0]).map(Item::range);
            if let Some(first) = first.filter(|first| *first != asked.range()) {
                let (range, of) = (asked.range(), sub.items[0]);
                return Err(format!(
                    " scores item {of} ({first}) and item {item} ({range}), expected one range of answers"
                ));
            }
        }
        if let Some(item) = sub.reversed.iter().find(|i| !sub.items.contains(i)) {
            return Err(match self.item(*item) {
                Some(_) => format!(" reverses item {item}, which it does not have"),
                None => format!(" names item {item} of {n}"),
            });
        }
        let (low, high) = self.score_range(sub);
        if let Some(same) = sub.same.filter(|s| !(low..=high).contains(s)) {
            return Err(format!(": same is {same}, expected {low} to {high}"));
        }
        let norms = sub.norms.as_ref();
        norms.map_or(Ok(()), |norms| norms.check((low, high)).map_err(|p| format!(": {p}")))
    }

    /// What is wrong with a score that adds up others.
    fn sum(&self, sub: &Subscale) -> Result<(), String> {
        if !sub.items.is_empty() || self.scoring != Scoring::Sum {
            return Err(
                " has `sum_of`, expected no `items` of its own and scoring = \"sum\"".to_owned()
            );
        }
        for id in &sub.sum_of {
            match self.subscales.iter().find(|s| s.id == *id) {
                None => return Err(format!(": sum_of names `{id}`, which is no subscale")),
                Some(part) if !part.sum_of.is_empty() => {
                    return Err(format!(": sum_of names `{id}`, a sum itself"));
                }
                Some(_) => {}
            }
        }
        Ok(())
    }

    fn correlations(&self) -> Result<(), String> {
        for (n, found) in self.correlations.iter().enumerate() {
            let [a, b] = &found.of;
            let pair = format!("correlation of `{a}` and `{b}`");
            for id in [a, b] {
                if !self.subscales.iter().any(|s| s.id == *id) {
                    return Err(format!("{pair}: there is no subscale `{id}`"));
                }
            }
            let same = |c: &NormCorrelation| {
                c.of == [a.clone(), b.clone()] || c.of == [b.clone(), a.clone()]
            };
            if a == b || self.correlations[..n].iter().any(same) {
                return Err(format!("{pair} is given twice, or of one subscale"));
            }
            if !(found.r > -1.0 && found.r < 1.0) {
                return Err(format!("{pair} is {}, expected between -1 and 1", found.r));
            }
            if found.source.trim().is_empty() {
                return Err(format!("{pair}: source is empty, expected a publication or `chosen`"));
            }
        }
        Ok(())
    }
}

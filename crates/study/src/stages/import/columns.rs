//! What the columns of an export mean: by convention, by the scales' own files, or by a map.

use super::{
    map_file::{MapFile, ScaleColumns},
    pattern::Pattern,
    word_in_name::place_of,
    workbook::in_place_of_value,
};
use crate::error::StudyError;
use maveric_domain::{ConditionId, Design, Moment, Scale, survey::Item};
use std::{collections::BTreeMap, path::Path};

/// When an answer was given, by the name of its column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum When {
    /// The name does not say it: a field beside it may.
    Unsaid,
    Known(Moment),
    /// After the ride of this number, from 1, in the person's own order.
    Trial(usize),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Slot {
    pub(super) scale: usize,
    pub(super) item: u32,
    pub(super) when: When,
}

/// Fields that say the moment where no map names one.
const MOMENT_FIELDS: [&str; 2] = ["condition", "moment"];

/// The columns of the study's scales.
#[derive(Debug, Clone)]
pub(super) struct Columns<'a> {
    pub(super) scales: &'a [Scale],
    pub(super) map: MapFile,
    /// Every word for a moment: those of the map, and every label of the design.
    words: BTreeMap<String, Moment>,
    /// That of a design with no other.
    pub(super) only_condition: Option<ConditionId>,
    patterns: Vec<Pattern>,
}

impl<'a> Columns<'a> {
    /// By the map at `path`; without one by convention. Every label of the design is a word for the moment after that drive, whatever else
    /// it is a word for, unless the map says otherwise.
    ///
    /// # Errors
    /// [`StudyError`] naming the map and the key that does not fit the scales.
    pub(super) fn new(
        path: Option<&Path>,
        scales: &'a [Scale],
        design: &Design,
    ) -> Result<Self, StudyError> {
        let map = path.map(MapFile::read).transpose()?.unwrap_or_default();
        let bad = |problem| StudyError::file(path.unwrap_or(Path::new("")), problem);
        if let Some(id) = map.scales.keys().find(|id| !scales.iter().any(|s| s.id == **id)) {
            let known: Vec<&str> = scales.iter().map(|s| s.id.as_str()).collect();
            let known = known.join(", ");
            return Err(bad(format!("[scales.{id}]: no such scale; the scales are {known}")));
        }
        let labels = design.labels();
        let words = map.moments.iter();
        let words = words.map(|(word, moment)| (format!("[moments] `{word}`"), *moment));
        let fixed = map.scales.iter();
        let fixed =
            fixed.filter_map(|(id, c)| Some((format!("[scales.{id}] `moment`"), c.moment?)));
        for (key, moment) in words.chain(fixed) {
            if let Some(id) = moment.condition().filter(|id| !labels.contains(id)) {
                let known = ConditionId::listed(&labels);
                return Err(bad(format!(
                    "{key}: `{id}` is no condition of the study, which has {known}"
                )));
            }
        }
        let mut patterns = Vec::new();
        for scale in scales {
            let mapped = map.scales.get(&scale.id);
            let in_scale = |problem: String| bad(format!("[scales.{}]: {problem}", scale.id));
            if let Some(columns) = mapped {
                columns.fits(scale).map_err(in_scale)?;
            }
            let pattern = mapped.and_then(|c| c.column.as_ref()).or(scale.column.as_ref());
            let convention = || format!("{}_{{item}}", scale.id);
            patterns.push(
                Pattern::new(&pattern.cloned().unwrap_or_else(convention)).map_err(in_scale)?,
            );
        }
        let mut words: BTreeMap<String, Moment> =
            labels.into_iter().map(|id| (id.to_string(), Moment::after(id))).collect();
        words.extend(map.moments.clone());
        Ok(Self {
            scales,
            map,
            words,
            only_condition: match design.conditions() {
                [only] => Some(only.id),
                _ => None,
            },
            patterns,
        })
    }

    /// The pattern of a scale, as it is written.
    pub(super) fn pattern_of(&self, scale: &Scale) -> String {
        let position = self.scales.iter().position(|s| s.id == scale.id);
        position.map_or_else(String::new, |at| self.patterns[at].to_string())
    }

    pub(super) fn patterns(&self) -> impl Iterator<Item = &Pattern> {
        self.patterns.iter()
    }

    /// Every word that means a moment.
    pub(super) fn words(&self) -> impl Iterator<Item = &str> {
        self.words.keys().map(String::as_str)
    }

    /// What a field holds by its name; an error is the word where a condition stands in it that means none.
    pub(super) fn slot_of<'n>(&self, name: &'n str) -> Option<Result<Slot, &'n str>> {
        let mut stranger = None;
        for (scale, pattern) in self.patterns.iter().enumerate() {
            let Some(parts) = pattern.read(name, self.words_of_items(scale)) else {
                continue;
            };
            let when = match (parts.moment, parts.trial) {
                (Some(word), _) => {
                    let Some(moment) = self.moment_by_word(word) else {
                        stranger = Some(Err(word));
                        continue;
                    };
                    When::Known(moment)
                }
                (None, Some(trial)) => When::Trial(trial),
                (None, None) => {
                    let fixed = self.mapped(scale).and_then(|c| c.moment);
                    fixed.map_or(When::Unsaid, When::Known)
                }
            };
            let item = parts.item;
            return Some(Ok(Slot { scale, item, when }));
        }
        stranger
    }

    /// Whether a field is called as the items of a scale are, whatever the word for the moment in it means.
    pub(super) fn is_of(&self, scale: usize, name: &str) -> bool {
        let words = self.words_of_items(scale);
        self.patterns[scale].read(name, words).is_some()
    }

    fn words_of_items(&self, scale: usize) -> &[String] {
        let mapped = self.mapped(scale).map(|c| c.items.as_slice());
        mapped.unwrap_or_default()
    }

    /// Whether the map says how the columns of a scale are called.
    pub(super) fn is_named_by_map(&self, scale: usize) -> bool {
        self.mapped(scale).is_some_and(|c| c.column.is_some())
    }

    fn mapped(&self, scale: usize) -> Option<&ScaleColumns> {
        self.map.scales.get(&self.scales[scale].id)
    }

    /// The moment that a word means by the map or the design, in small or large letters.
    pub(super) fn moment_by_word(&self, word: &str) -> Option<Moment> {
        let same = || self.words.iter().find(|(w, _)| w.eq_ignore_ascii_case(word));
        let exact = self.words.get(word).or_else(|| same().map(|(_, moment)| moment));
        let known = [Moment::Pre, Moment::Post];
        let named = |moment: &Moment| moment.to_string().eq_ignore_ascii_case(word);
        exact.copied().or_else(|| known.into_iter().find(named))
    }

    /// The word for a condition that stands by itself in a name.
    pub(super) fn condition_in(&self, name: &str) -> Option<&str> {
        let stands = |(word, moment): &(&String, &Moment)| {
            moment.condition().is_some() && place_of(name, word).is_some()
        };
        self.words.iter().find(stands).map(|(word, _)| word.as_str())
    }

    /// Fields that may say the moment.
    pub(super) fn moment_fields(&self) -> Vec<&str> {
        match &self.map.moment {
            Some(field) => vec![field.as_str()],
            None => MOMENT_FIELDS.to_vec(),
        }
    }

    /// The moment that a word in a field means.
    pub(super) fn moment_of(&self, word: &str) -> Result<Moment, String> {
        let word = word.trim();
        match self.moment_by_word(word) {
            Some(moment) => Ok(moment),
            None => word.parse().map_err(|e| {
                format!("{e}; other words can be given a meaning in the map's [moments]")
            }),
        }
    }

    /// Whether what stands in the file is a word for no answer; `missing` are those of the software.
    pub(super) fn is_missing(&self, text: &str, missing: &[&str]) -> bool {
        missing.contains(&text) || self.map.missing.iter().any(|m| m == text)
    }

    /// An answer as given, from what stands in the file; `add` is added to numbers unless the map says otherwise, and `missing` are the
    /// software's words for no answer.
    pub(super) fn answer_of(
        &self,
        slot: &Slot,
        item: &Item,
        text: &str,
        add: i32,
        missing: &[&str],
    ) -> Result<Option<i32>, String> {
        let text = text.trim();
        let columns = self.mapped(slot.scale);
        let scale = &self.scales[slot.scale];
        let add = columns.and_then(|c| c.add).unwrap_or(add);
        // oTree and spreadsheets may write 3 as 3.0.
        let whole = text.strip_suffix(".0").unwrap_or(text).parse::<i32>().ok();
        let number = whole.and_then(|n| n.checked_add(add)).filter(|n| item.takes(*n));
        let of_scale = columns.and_then(|c| c.missing.as_ref());
        let is_missing = match of_scale {
            Some(words) => words.iter().any(|word| word == text),
            None => self.is_missing(text, missing),
        };
        if is_missing && of_scale.is_none() && number.is_some() {
            let id = &scale.id;
            return Err(format!(
                "`{text}` is a code for no answer, and an answer of the scale, which runs from {}; state the codes of this scale in the map of columns: [scales.{id}] missing = [] if it has none",
                item.range()
            ));
        }
        if is_missing || matches!(text, "" | "NA" | "null") {
            return Ok(None);
        }
        let labels = columns.map(|c| c.labels.as_slice()).unwrap_or_default();
        let mut labelled = item.answers().zip(labels);
        let labelled = labelled.find(|(_, l)| l.trim().eq_ignore_ascii_case(text));
        let in_words = labelled.map(|(answer, _)| answer);
        if let Some(answer) = in_words.or_else(|| scale.answer_in_words(slot.item, text)) {
            return Ok(Some(answer));
        }
        match number {
            Some(answer) => Ok(Some(answer)),
            None if text.starts_with('=') => Err(in_place_of_value(text)),
            None => {
                let written = Item { min: item.min - add, max: item.max - add, ..item.clone() };
                Err(format!(
                    "found `{text}`, expected a whole number from {}, or nothing; answers in words can be given their numbers by `labels` in the map of columns",
                    written.range()
                ))
            }
        }
    }
}

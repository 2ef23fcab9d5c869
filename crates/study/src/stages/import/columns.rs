//! What the columns of an export mean: by convention, by the scales' own files, or by a map.

use crate::{atomic_write::read_text, error::StudyError};
use maveric_domain::{Design, Moment, Scale};
use serde::Deserialize;
use std::{collections::BTreeMap, path::Path};

/// A map, as a TOML file: only what differs from the convention need be in it.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ColumnMap {
    /// Column, or property of a trial, that holds the participant's id.
    pub(super) participant: Option<String>,
    /// Field beside the answers that says the moment; `condition` or `moment` without it.
    pub(super) moment: Option<String>,
    /// Words in that field, and the moments they mean.
    moments: BTreeMap<String, Moment>,
    /// By the scale's id.
    scales: BTreeMap<String, ScaleColumns>,
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ScaleColumns {
    /// Pattern of the field's name, with `{item}`.
    column: Option<String>,
    /// Added to every number: 1 where the software counts answers from 0.
    add: Option<i32>,
    /// Answers in words, from the lowest.
    labels: Vec<String>,
}

/// Fields that say the moment where no map names one.
const MOMENT_FIELDS: [&str; 2] = ["condition", "moment"];

impl ColumnMap {
    pub(super) fn read(path: &Path) -> Result<Self, StudyError> {
        let text = read_text(path)?;
        toml::from_str(&text)
            .map_err(|e| StudyError::file(path, format!("not a map of columns: {e}")))
    }

    /// Every label of the design is a word for the moment after that drive, whatever else it is a word for, unless the map says otherwise.
    pub(super) fn know(&mut self, design: &Design) {
        for id in design.labels() {
            let moment = self.moments.entry(id.to_string());
            moment.or_insert(Moment::After(id));
        }
    }

    /// Whether the map fits the scales.
    pub(super) fn check(&self, path: Option<&Path>, scales: &[Scale]) -> Result<(), StudyError> {
        let bad = |problem| Err(StudyError::file(path.unwrap_or(Path::new("")), problem));
        for (id, columns) in &self.scales {
            let Some(scale) = scales.iter().find(|s| s.id == *id) else {
                let known: Vec<&str> = scales.iter().map(|s| s.id.as_str()).collect();
                return bad(format!(
                    "[scales.{id}]: no such scale; the scales are {}",
                    known.join(", ")
                ));
            };
            let boxes = (scale.max - scale.min + 1) as usize;
            if !columns.labels.is_empty() && columns.labels.len() != boxes {
                let found = columns.labels.len();
                return bad(format!(
                    "[scales.{id}]: {found} labels for the {boxes} answers {} to {}",
                    scale.min, scale.max
                ));
            }
            if let Some(column) = columns.column.as_ref().filter(|c| !c.contains("{item}")) {
                return bad(format!(
                    "[scales.{id}]: column `{column}` has no `{{item}}` where the item's number stands"
                ));
            }
        }
        Ok(())
    }

    /// Pattern of the fields of a scale.
    pub(super) fn pattern(&self, scale: &Scale) -> String {
        let mapped = self.scales.get(&scale.id).and_then(|c| c.column.clone());
        let declared = || scale.column.clone();
        mapped
            .or_else(declared)
            .unwrap_or_else(|| format!("{}_{{item}}", scale.id))
    }

    /// Position of the scale and number of the item that a field belongs to.
    pub(super) fn item_of(&self, scales: &[Scale], field: &str) -> Option<(usize, u32)> {
        scales.iter().enumerate().find_map(|(position, scale)| {
            let pattern = self.pattern(scale);
            let (before, after) = pattern.split_once("{item}")?;
            let number = field.strip_prefix(before)?.strip_suffix(after)?;
            let digits = !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit());
            Some((position, number.parse().ok().filter(|_| digits)?))
        })
    }

    /// Fields that may say the moment.
    pub(super) fn moment_fields(&self) -> Vec<&str> {
        match &self.moment {
            Some(field) => vec![field.as_str()],
            None => MOMENT_FIELDS.to_vec(),
        }
    }

    /// The moment that a word means.
    pub(super) fn moment_of(&self, word: &str) -> Result<Moment, String> {
        let word = word.trim();
        match self.moments.get(word) {
            Some(moment) => Ok(*moment),
            None => word.parse().map_err(|e| {
                format!("{e}; other words can be given a meaning in the map's [moments]")
            }),
        }
    }

    /// An answer as given, from what stands in the file; `add` is added to numbers unless the map says otherwise.
    pub(super) fn answer_of(
        &self,
        scale: &Scale,
        text: &str,
        add: i32,
    ) -> Result<Option<i32>, String> {
        let text = text.trim();
        if matches!(text, "" | "NA" | "null") {
            return Ok(None);
        }
        let columns = self.scales.get(&scale.id);
        let labels = columns.map(|c| c.labels.as_slice()).unwrap_or_default();
        let mut labelled = (scale.min..).zip(labels);
        if let Some((answer, _)) = labelled.find(|(_, l)| l.trim().eq_ignore_ascii_case(text)) {
            return Ok(Some(answer));
        }
        let add = columns.and_then(|c| c.add).unwrap_or(add);
        // oTree and spreadsheets may write 3 as 3.0.
        let whole = text.strip_suffix(".0").unwrap_or(text).parse::<i32>().ok();
        match whole.and_then(|n| n.checked_add(add)) {
            Some(answer) if (scale.min..=scale.max).contains(&answer) => Ok(Some(answer)),
            _ => Err(format!(
                "found `{text}`, expected a whole number from {} to {}, or nothing",
                scale.min - add,
                scale.max - add
            )),
        }
    }
}

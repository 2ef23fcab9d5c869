//! A map of columns as a file: what an export calls otherwise than by convention.

use super::grid::HowToRead;
use crate::{atomic_write::read_text, error::StudyError, tables::keys::composed};
use maveric_domain::{Moment, Scale, survey::Item};
use serde::Deserialize;
use std::{collections::BTreeMap, path::Path};

/// A map, as a TOML file: only what differs from the convention need be in it.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct MapFile {
    sheet: Option<String>,
    encoding: Option<String>,
    /// Column, or property of a trial, that holds the participant's id.
    pub(super) participant: Option<String>,
    /// Field beside the answers that says the moment; `condition` or `moment` without it.
    pub(super) moment: Option<String>,
    /// Words for no answer, beside those of the software.
    pub(super) missing: Vec<String>,
    /// Words in that field or in the names of columns, and the moments they mean.
    pub(super) moments: BTreeMap<String, Moment>,
    pub(super) scales: BTreeMap<String, ScaleColumns>,
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ScaleColumns {
    /// Pattern of the field's name, with `{item}`.
    pub(super) column: Option<String>,
    /// Words that stand for the items there, in their order; without them their numbers do.
    pub(super) items: Vec<String>,
    /// Words for no answer to this scale, in the place of those of the software and of the map.
    pub(super) missing: Option<Vec<String>>,
    /// When it was answered, where neither name nor field says it.
    pub(super) moment: Option<Moment>,
    /// Added to every number: 1 where the software counts answers from 0.
    pub(super) add: Option<i32>,
    /// Answers in words, from the lowest.
    pub(super) labels: Vec<String>,
}

/// Whether a file is a map in which somebody wrote: comments and empty lines are not what one is kept for.
pub(super) fn is_filled_in(path: &Path) -> Result<bool, StudyError> {
    if !path.is_file() {
        return Ok(false);
    }
    let text = std::fs::read(path).map_err(StudyError::read(path))?;
    let mut lines = text.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
    Ok(lines.any(|line| !line.is_empty() && !line.starts_with(b"#")))
}

impl MapFile {
    pub(super) fn read(path: &Path) -> Result<Self, StudyError> {
        let text = read_text(path)?;
        toml::from_str(&composed(&text))
            .map_err(|e| StudyError::file(path, format!("not a map of columns: {e}")))
    }

    /// How the file itself is to be read; `sheet` names another one of a workbook.
    pub(super) fn how<'a>(&'a self, sheet: Option<&'a str>) -> HowToRead<'a> {
        HowToRead { sheet: sheet.or(self.sheet.as_deref()), encoding: self.encoding.as_deref() }
    }
}

impl ScaleColumns {
    pub(super) fn fits(&self, scale: &Scale) -> Result<(), String> {
        let (labels, items) = (self.labels.len(), self.items.len());
        let unfit = |item: &&Item| labels != 0 && labels != item.points();
        if let Some(item) = scale.items.iter().find(unfit) {
            let (boxes, range) = (item.points(), item.range());
            return Err(format!("{labels} labels for the {boxes} answers {range}"));
        }
        if items != 0 && items != scale.items.len() {
            return Err(format!(
                "{items} words in `items` for the scale's {} items",
                scale.count()
            ));
        }
        Ok(())
    }
}

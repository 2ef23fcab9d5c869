//! Which subscales a file of effects speaks of, and whether they cover a scale.

use crate::error::ParticipantError;
use maveric_domain::{Scale, Subscale};
use std::collections::{BTreeMap, BTreeSet};

/// Whether models (scale → subscale → model) are of scales that there are, and cover each item of these once.
pub(crate) fn covered<M>(
    scales: &[Scale],
    models: &BTreeMap<String, BTreeMap<String, M>>,
) -> Result<(), ParticipantError> {
    for (id, models) in models {
        let Some(scale) = scales.iter().find(|s| s.id == *id) else {
            return Err(ParticipantError::UnknownSubscale {
                scale: id.clone(),
                subscale: models.keys().next().cloned().unwrap_or_default(),
            });
        };
        covered_once(scale, models.keys())?;
    }
    Ok(())
}

/// Whether each item belongs to exactly one of the subscales named.
fn covered_once<'a>(
    scale: &Scale,
    subscales: impl Iterator<Item = &'a String>,
) -> Result<(), ParticipantError> {
    let mut seen = BTreeSet::new();
    for id in subscales {
        for &item in &subscale_of(scale, id)?.items {
            if !seen.insert(item) {
                return Err(ParticipantError::ItemTwice { scale: scale.id.clone(), item });
            }
        }
    }
    match (1..=scale.count()).find(|i| !seen.contains(i)) {
        Some(item) => Err(ParticipantError::ItemWithoutModel { scale: scale.id.clone(), item }),
        None => Ok(()),
    }
}

pub(crate) fn subscale_of<'a>(
    scale: &'a Scale,
    id: &str,
) -> Result<&'a Subscale, ParticipantError> {
    let subscale = scale.subscales.iter().find(|s| s.id == id);
    subscale.ok_or_else(|| ParticipantError::UnknownSubscale {
        scale: scale.id.clone(),
        subscale: id.to_owned(),
    })
}

//! Whose drive a recording is: the metadata record that our own logs carry.

use crate::error::IngestError;
use maveric_domain::{
    ConditionId, DomainError, DriveId, DriveMeta, DrivenBy, ParticipantId, Recording, Road,
};
use std::{collections::BTreeMap, path::Path, str::FromStr};

/// Name of the metadata record.
pub(crate) const NAME: &str = "maveric.drive";

/// Key and value where lateral positions stand for none.
pub(crate) const LATERAL: &str = "lateral";
pub(crate) const UNKNOWN: &str = "unknown";

/// Key of what whoever made the recording has to say of it.
const NOTE: &str = "note";

/// What the record says.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DriveRecord {
    pub(crate) meta: DriveMeta,
    pub(crate) road: Road,
    pub(crate) ego_length_m: f64,
    /// Whether lateral positions stand for none.
    pub(crate) without_lateral: bool,
    pub(crate) note: Option<String>,
}

/// The record's values for a recording.
pub(crate) fn values(
    meta: &DriveMeta,
    recording: &Recording,
    note: Option<&str>,
) -> BTreeMap<String, String> {
    let road = recording.road();
    let pairs: [(&str, String); 9] = [
        ("drive", meta.drive.to_string()),
        ("participant", meta.participant.to_string()),
        ("condition", meta.condition.as_str().to_owned()),
        ("driven_by", meta.driven_by.as_str().to_owned()),
        ("lanes", road.lanes.to_string()),
        ("lane_width_m", road.lane_width_m.to_string()),
        ("posted_speed_mps", road.posted_speed_mps.to_string()),
        ("rate_hz", recording.rate_hz().to_string()),
        ("ego_length_m", recording.ego().length_m.to_string()),
    ];
    let mut values: BTreeMap<String, String> = pairs.map(|(k, v)| (k.to_owned(), v)).into();
    if !recording.has_lateral() {
        values.insert(LATERAL.to_owned(), UNKNOWN.to_owned());
    }
    if let Some(note) = note {
        values.insert(NOTE.to_owned(), note.to_owned());
    }
    values
}

/// Reads the record's values.
///
/// # Errors
/// [`IngestError::BadMetadata`] where one is missing or makes no sense.
pub(crate) fn parse(
    path: &Path,
    values: &BTreeMap<String, String>,
) -> Result<DriveRecord, IngestError> {
    let of = Of { path, values };
    Ok(DriveRecord {
        meta: DriveMeta {
            drive: of.id("drive", DriveId::new)?,
            participant: of.id("participant", ParticipantId::new)?,
            condition: of.word("condition", "a condition", ConditionId::from_str)?,
            driven_by: of.word(
                "driven_by",
                "human, synthetic or automated",
                DrivenBy::from_str,
            )?,
        },
        road: Road {
            lanes: of.word("lanes", "a number from 1 to 255", |text| {
                text.parse().ok().filter(|&n: &u8| n > 0).ok_or(())
            })?,
            lane_width_m: of.positive("lane_width_m")?,
            posted_speed_mps: of.positive("posted_speed_mps")?,
        },
        ego_length_m: of.positive("ego_length_m")?,
        without_lateral: values.get(LATERAL).is_some_and(|v| v == UNKNOWN),
        note: values.get(NOTE).cloned(),
    })
}

struct Of<'a> {
    path: &'a Path,
    values: &'a BTreeMap<String, String>,
}

impl Of<'_> {
    fn word<T, E>(
        &self,
        key: &'static str,
        expected: &'static str,
        read: impl Fn(&str) -> Result<T, E>,
    ) -> Result<T, IngestError> {
        let found = self.values.get(key).map_or("", String::as_str);
        read(found).map_err(|_| IngestError::BadMetadata {
            path: self.path.to_owned(),
            key,
            found: found.to_owned(),
            expected,
        })
    }

    fn id<T>(
        &self,
        key: &'static str,
        read: impl Fn(String) -> Result<T, DomainError>,
    ) -> Result<T, IngestError> {
        self.word(key, "1 to 64 letters, digits, `_` or `-`", |text| {
            read(text.to_owned())
        })
    }

    fn positive(&self, key: &'static str) -> Result<f64, IngestError> {
        self.word(key, "a finite number above 0", |text| {
            let number = text.parse().ok();
            number.filter(|n: &f64| n.is_finite() && *n > 0.0).ok_or(())
        })
    }
}

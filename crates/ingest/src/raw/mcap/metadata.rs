//! Whose drive a file holds and on which road, as texts by key: in the metadata of our own logs, and of drives as Parquet.

use crate::error::IngestError;
use maveric_domain::{
    ConditionId, DomainError, DriveId, DriveMeta, DrivenBy, Occasion, ParticipantId, Recording,
    Road, Sees,
    occasion::{OCCASION, first, is_first},
};
use std::{collections::BTreeMap, num::NonZeroU32, path::Path, str::FromStr};

/// Name of the metadata record of a log.
pub(crate) const NAME: &str = "maveric.drive";

/// Key and value where lateral positions stand for none.
const LATERAL: &str = "lateral";
const UNKNOWN: &str = "unknown";

/// Key of what the rig sees, where it does not see everything.
const SEES: &str = "sees";

/// Key of what whoever made the recording has to say of it.
const NOTE: &str = "note";

/// Keys that every drive has, in their order; the last four may be there.
pub(crate) const KEYS: [&str; 12] = [
    "drive",
    "participant",
    "condition",
    "driven_by",
    "rate_hz",
    "lanes",
    "lane_width_m",
    "posted_speed_mps",
    LATERAL,
    SEES,
    OCCASION[0],
    OCCASION[1],
];

/// What is said of a drive, by [`KEYS`] and in their order.
pub(crate) fn meta_entries(
    meta: &DriveMeta,
    road: &Road,
    rate_hz: f64,
    has_lateral: bool,
    sees: Sees,
) -> Vec<(&'static str, String)> {
    let values = [
        meta.drive.to_string(),
        meta.participant.to_string(),
        meta.condition.as_str().to_owned(),
        meta.driven_by.as_str().to_owned(),
        rate_hz.to_string(),
        road.lanes.to_string(),
        road.lane_width_m.to_string(),
        road.posted_speed_mps.to_string(),
    ];
    let lateral = (!has_lateral).then(|| (LATERAL, UNKNOWN.to_owned()));
    // A file that says nothing, as all did once, sees everything.
    let sees = (sees != Sees::ALL).then(|| (SEES, sees.to_string()));
    let numbers = OCCASION.into_iter().zip([meta.session, meta.trial]);
    let numbers = numbers.filter(|(_, number)| !is_first(number));
    KEYS.into_iter()
        .zip(values)
        .chain(lateral)
        .chain(sees)
        .chain(numbers.map(|(key, number)| (key, number.to_string())))
        .collect()
}

/// What a log's record says.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DriveRecord {
    pub(crate) meta: DriveMeta,
    pub(crate) road: Road,
    pub(crate) ego_length_m: f64,
    /// Whether lateral positions stand for none.
    pub(crate) without_lateral: bool,
    pub(crate) sees: Sees,
    pub(crate) note: Option<String>,
}

/// The record's values for a recording.
pub(crate) fn values(
    meta: &DriveMeta,
    recording: &Recording,
    note: Option<&str>,
) -> BTreeMap<String, String> {
    let road = recording.road();
    let (rate_hz, lateral) = (recording.rate_hz(), recording.has_lateral());
    let entries = meta_entries(meta, road, rate_hz, lateral, recording.sees());
    let length = [("ego_length_m", recording.ego().length_m.to_string())];
    let note = note.map(|note| (NOTE, note.to_owned()));
    let entries = entries.into_iter().chain(length).chain(note);
    entries.map(|(key, value)| (key.to_owned(), value)).collect()
}

/// Reads the record's values.
///
/// # Errors
/// [`IngestError::BadMetadata`] where one is missing or makes no sense.
pub(crate) fn parse(
    path: &Path,
    values: &BTreeMap<String, String>,
) -> Result<DriveRecord, IngestError> {
    let record = MetaValues { path, values };
    Ok(DriveRecord {
        meta: record.meta()?,
        road: record.road()?,
        ego_length_m: record.positive("ego_length_m")?,
        without_lateral: record.without_lateral(),
        sees: record.sees()?,
        note: values.get(NOTE).cloned(),
    })
}

/// What a file says of its drive; each value that is missing or makes no sense is an [`IngestError::BadMetadata`].
pub(crate) struct MetaValues<'a> {
    pub(crate) path: &'a Path,
    pub(crate) values: &'a BTreeMap<String, String>,
}

impl MetaValues<'_> {
    /// Whose drive it is.
    pub(crate) fn meta(&self) -> Result<DriveMeta, IngestError> {
        let driven_by = "human, synthetic or automated";
        let meta = DriveMeta::new(
            self.id("drive", DriveId::new)?,
            self.id("participant", ParticipantId::new)?,
            self.word("condition", "a condition", ConditionId::from_str)?,
            self.word("driven_by", driven_by, DrivenBy::from_str)?,
        );
        let [session, trial] = OCCASION.map(|key| {
            if self.values.contains_key(key) {
                self.word(key, "a whole number from 1", NonZeroU32::from_str)
            } else {
                Ok(first())
            }
        });
        Ok(meta.on(Occasion { session: session?, trial: trial? }))
    }

    /// On which road.
    pub(crate) fn road(&self) -> Result<Road, IngestError> {
        let lanes = |text: &str| text.parse().ok().filter(|&n: &u8| n > 0).ok_or(());
        Ok(Road {
            lanes: self.word("lanes", "a number from 1 to 255", lanes)?,
            lane_width_m: self.positive("lane_width_m")?,
            posted_speed_mps: self.positive("posted_speed_mps")?,
        })
    }

    /// Whether lateral positions stand for none.
    pub(crate) fn without_lateral(&self) -> bool {
        self.values.get(LATERAL).is_some_and(|v| v == UNKNOWN)
    }

    /// What the rig sees.
    pub(crate) fn sees(&self) -> Result<Sees, IngestError> {
        if self.values.contains_key(SEES) {
            let expected = "some of ahead, beside, behind and lanes, or nothing";
            self.word(SEES, expected, Sees::from_str)
        } else {
            Ok(Sees::ALL)
        }
    }

    fn word<T, E>(
        &self,
        key: &'static str,
        expected: &'static str,
        read: impl Fn(&str) -> Result<T, E>,
    ) -> Result<T, IngestError> {
        let value = self.values.get(key).map_or("", String::as_str);
        read(value).map_err(|_| IngestError::BadMetadata {
            path: self.path.to_owned(),
            key,
            found: value.to_owned(),
            expected,
        })
    }

    fn id<T>(
        &self,
        key: &'static str,
        read: impl Fn(String) -> Result<T, DomainError>,
    ) -> Result<T, IngestError> {
        self.word(key, "1 to 64 letters, digits, `_` or `-`", |text| read(text.to_owned()))
    }

    pub(crate) fn positive(&self, key: &'static str) -> Result<f64, IngestError> {
        self.word(key, "a finite number above 0", |text| {
            let number = text.parse().ok();
            number.filter(|n: &f64| n.is_finite() && *n > 0.0).ok_or(())
        })
    }
}

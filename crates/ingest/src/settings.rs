//! How to ingest, and what comes of it.

use crate::{error::IngestError, mapping::Mapping, quality::Warning, source::Source};
use maveric_domain::{DriveMeta, Recording};

/// How to ingest a log.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct IngestSettings {
    /// What columns, topics and names mean; needed for tables.
    pub mapping: Option<Mapping>,
    /// Rows a second of the result; without it the mapping's, else [`IngestSettings::RATE_HZ`].
    pub rate_hz: Option<f64>,
    /// Whether to keep what is readable of a damaged file instead of refusing it.
    pub recover: bool,
    /// Longest hole between samples that is bridged, in s; without it the mapping's, else [`IngestSettings::MAX_GAP_S`].
    pub max_gap_s: Option<f64>,
}

impl IngestSettings {
    /// The canonical rate, in Hz.
    ///
    /// # Source
    /// Method section 2 (ours).
    pub const RATE_HZ: f64 = 20.0;

    /// The canonical longest hole that is bridged, in s.
    ///
    /// # Source
    /// Method section 2 (ours).
    pub const MAX_GAP_S: f64 = 0.5;

    /// The rate that applies: this setting, the mapping's, or the canonical one.
    ///
    /// # Errors
    /// [`IngestError::BadSetting`] outside 0 to 1000 Hz.
    pub fn rate_hz(&self) -> Result<f64, IngestError> {
        let mapped = self.mapping.as_ref().and_then(|m| m.rate_hz);
        let rate = self.rate_hz.or(mapped).unwrap_or(Self::RATE_HZ);
        check("rate_hz", rate, 1000.0, "above 0, at most 1000")
    }

    pub(crate) fn max_gap_s(&self) -> Result<f64, IngestError> {
        let mapped = self.mapping.as_ref().and_then(|m| m.max_gap_s);
        let longest = self.max_gap_s.or(mapped).unwrap_or(Self::MAX_GAP_S);
        check("max_gap_s", longest, 60.0, "above 0, at most 60")
    }
}

fn check(
    name: &'static str,
    found: f64,
    most: f64,
    expected: &'static str,
) -> Result<f64, IngestError> {
    if found > 0.0 && found <= most {
        Ok(found)
    } else {
        Err(IngestError::BadSetting { name, found, expected })
    }
}

/// One drive of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Ingested {
    /// Whose drive it is: from the log's own metadata, else from its file name.
    pub meta: DriveMeta,
    /// Who was where.
    pub recording: Recording,
    /// What was left out, filled in or doubted.
    pub warnings: Vec<Warning>,
    /// The files that were read for it.
    pub sources: Vec<Source>,
}

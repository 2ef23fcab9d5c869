//! How people's own drives wander: a row a drive.

use super::Table;
use crate::error::StudyError;
use maveric_domain::{ConditionId, Drive, DriveId, ParticipantId, Variability, Wander};
use maveric_model::variability;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// One drive: a row of the table. A number is missing where the drive shows too little of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "`columns.toml` says what they are")]
pub struct VariabilityRow {
    pub drive: DriveId,
    pub participant: ParticipantId,
    pub condition: ConditionId,
    pub speed_sd_mps: Option<f64>,
    pub speed_lag_s: Option<f64>,
    pub gap_log_sd: Option<f64>,
    pub gap_lag_s: Option<f64>,
    pub place_sd_m: Option<f64>,
    pub place_lag_s: Option<f64>,
    pub place_m: Option<f64>,
}

impl VariabilityRow {
    /// Measures a drive.
    pub fn from_drive(drive: &Drive) -> Self {
        let meta = drive.meta();
        let v = variability(drive);
        let sd = |wander: Option<Wander>| wander.map(|w| w.sd);
        let lag = |wander: Option<Wander>| wander.map(|w| w.time_s);
        Self {
            drive: meta.drive.clone(),
            participant: meta.participant.clone(),
            condition: meta.condition,
            speed_sd_mps: sd(v.free_speed),
            speed_lag_s: lag(v.free_speed),
            gap_log_sd: sd(v.gap),
            gap_lag_s: lag(v.gap),
            place_sd_m: sd(v.place),
            place_lag_s: lag(v.place),
            place_m: v.place_m,
        }
    }

    /// What a car that wanders like this drive is given.
    pub fn variability(&self) -> Variability {
        let wander = |sd: Option<f64>, lag: Option<f64>| {
            let (sd, time_s) = (sd?, lag?);
            Some(Wander { sd, time_s })
        };
        Variability {
            free_speed: wander(self.speed_sd_mps, self.speed_lag_s),
            gap: wander(self.gap_log_sd, self.gap_lag_s),
            place: wander(self.place_sd_m, self.place_lag_s),
            place_m: self.place_m,
        }
    }
}

/// Reads the drives, one row each.
pub(crate) fn read_variability(path: &Path) -> Result<Vec<VariabilityRow>, StudyError> {
    let table = Table::read(path)?;
    table.each_once(&["drive"])?;
    table.records()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::{TableName, write_rows};

    #[test]
    fn what_wanders_comes_back_from_its_file_and_what_was_not_shown_stays_missing() {
        let row = VariabilityRow {
            drive: DriveId::new("P01-own").unwrap(),
            participant: ParticipantId::new("P01").unwrap(),
            condition: "own".parse().unwrap(),
            speed_sd_mps: Some(0.4),
            speed_lag_s: Some(9.5),
            gap_log_sd: None,
            gap_lag_s: None,
            place_sd_m: Some(0.1),
            place_lag_s: Some(5.0),
            place_m: Some(-0.05),
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("variability.csv");
        write_rows(TableName::Variability, &path, [&row]).unwrap();
        assert_eq!(read_variability(&path).unwrap(), std::slice::from_ref(&row));
        let v = row.variability();
        assert_eq!((v.gap, v.place_m), (None, Some(-0.05)));
        assert_eq!(
            v.free_speed,
            Some(Wander {
                sd: 0.4,
                time_s: 9.5
            })
        );
    }
}

//! The conditions of each participant: where in style space the car should drive.

use super::{
    Table, TableName,
    embeddings::{coordinates, read_coordinates},
    write_rows,
};
use crate::error::StudyError;
use std::path::Path;

pub use maveric_domain::{ConditionRow, SweepPoint};

/// Writes conditions, one row each; those of a sweep with its points.
pub(crate) fn write_conditions(path: &Path, rows: &[ConditionRow]) -> Result<(), StudyError> {
    let written = rows.iter().map(|row| (row, coordinates(&row.embedding), &row.lent, &row.sweep));
    write_rows(TableName::Conditions, path, written)
}

/// Reads conditions back.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_conditions(path: &Path) -> Result<Vec<ConditionRow>, StudyError> {
    let table = Table::read(path)?;
    let beside = [("embedding", read_coordinates(&table)?)];
    let mut rows: Vec<ConditionRow> = table.records_beside(&beside)?;
    if table.has("donor") {
        for (row, lent) in rows.iter_mut().zip(table.records_with("donor")?) {
            row.lent = lent;
        }
    }
    if !table.has("drive") {
        table.each_once(&["participant", "condition"])?;
        return Ok(rows);
    }
    table.each_once(&["participant", "condition", "drive"])?;
    for (row, point) in rows.iter_mut().zip(table.records()?) {
        row.sweep = Some(point);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{BeyondWhy, DriveId, Embedding, Lent, ParticipantId};

    #[test]
    fn a_sweep_comes_back_with_its_drives_a_study_without_and_a_lent_style_with_its_donor() {
        let row = |sweep: Option<SweepPoint>| ConditionRow {
            participant: ParticipantId::new("P01").unwrap(),
            condition: "sporty".parse().unwrap(),
            adb_hat: Some(40.0),
            moved_points: Some(10.0),
            moved_points_sd: Some(1.5),
            clamped: false,
            angle_rad: None,
            lent: None,
            beyond_training: false,
            beyond_why: sweep.is_none().then(|| BeyondWhy::Habits { habit: "pass".to_owned() }),
            sweep,
            embedding: Embedding::new(vec![0.5, -1.0]).unwrap(),
        };
        let point = |points: f64, name: &str| SweepPoint {
            drive: DriveId::new(name).unwrap(),
            attribute: "aggression".to_owned(),
            requested_points: points,
            attribute_points: points,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("conditions.csv");
        let sweep = vec![row(Some(point(5.0, "P01-a"))), row(Some(point(10.0, "P01-b")))];
        let lent = ConditionRow {
            condition: "lent".parse().unwrap(),
            lent: Some(Lent {
                donor: DriveId::new("P02-own").unwrap(),
                donor_shift_points: -3.5,
                donor_distance_sd: 1.25,
                donor_within_reach: true,
            }),
            ..row(None)
        };
        for rows in [vec![row(None)], sweep, vec![row(None), lent]] {
            write_conditions(&path, &rows).unwrap();
            assert_eq!(read_conditions(&path).unwrap(), rows);
        }
        let half = std::fs::read_to_string(&path).unwrap().replace("1.25", "");
        std::fs::write(&path, half).unwrap();
        let refused = read_conditions(&path).unwrap_err().to_string();
        assert!(refused.contains("donor_distance_sd"), "{refused}");
        assert_eq!(row(None).drive().unwrap().as_str(), "P01-sporty");
    }
}

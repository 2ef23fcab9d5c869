//! The conditions of each participant: where in style space the car should drive.

use super::{
    Table, TableBuilder,
    embeddings::{read_coordinates, with_coordinates},
};
use crate::error::StudyError;
use maveric_domain::{BeyondWhy, ConditionId, Embedding, ParticipantId};
use serde::Deserialize;
use std::path::Path;

pub use maveric_domain::{ConditionRow, SweepPoint};

/// What of a condition has a column in every table.
#[derive(Deserialize)]
struct Steered {
    participant: ParticipantId,
    condition: ConditionId,
    adb_hat: Option<f64>,
    moved_points: Option<f64>,
    moved_points_sd: Option<f64>,
    clamped: bool,
    angle_rad: Option<f64>,
    beyond_training: bool,
}

/// Whether the model has met the drive that a style was learned of; a table of before has no such column.
#[derive(Deserialize)]
struct Met {
    beyond_why: Option<BeyondWhy>,
}

/// Writes conditions, one row each; those of a sweep with its points.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_conditions(path: &Path, rows: &[ConditionRow]) -> Result<(), StudyError> {
    let embeddings: Vec<&Embedding> = rows.iter().map(|r| &r.embedding).collect();
    let table = TableBuilder::some_of::<Steered, _>(rows)?;
    let table = table.beside(TableBuilder::some_of::<Met, _>(rows)?);
    let mut table = with_coordinates(table, &embeddings);
    if rows.iter().any(|r| r.sweep.is_some()) {
        table = table.beside(TableBuilder::of(
            rows.iter().filter_map(|r| r.sweep.as_ref()),
        )?);
    }
    table.write(path)
}

/// Reads conditions back.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_conditions(path: &Path) -> Result<Vec<ConditionRow>, StudyError> {
    let table = Table::read(path)?;
    let sweep: Vec<Option<SweepPoint>> = if table.has("drive") {
        table.each_once(&["participant", "condition", "drive"])?;
        table.records()?.into_iter().map(Some).collect()
    } else {
        table.each_once(&["participant", "condition"])?;
        vec![None; table.rows()]
    };
    let met = if table.has("beyond_why") {
        table.records()?
    } else {
        (0..table.rows())
            .map(|_| Met { beyond_why: None })
            .collect()
    };
    let rows = table.records::<Steered>()?.into_iter().zip(met);
    Ok(rows
        .zip(read_coordinates(&table)?.into_iter().zip(sweep))
        .map(|((row, met), (embedding, sweep))| ConditionRow {
            participant: row.participant,
            condition: row.condition,
            adb_hat: row.adb_hat,
            moved_points: row.moved_points,
            moved_points_sd: row.moved_points_sd,
            clamped: row.clamped,
            angle_rad: row.angle_rad,
            beyond_training: row.beyond_training,
            beyond_why: met.beyond_why,
            sweep,
            embedding,
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::DriveId;

    #[test]
    fn a_sweep_comes_back_with_its_drives_and_a_study_without() {
        let row = |sweep: Option<SweepPoint>| ConditionRow {
            participant: ParticipantId::new("P01").unwrap(),
            condition: "sporty".parse().unwrap(),
            adb_hat: Some(40.0),
            moved_points: Some(10.0),
            moved_points_sd: Some(1.5),
            clamped: false,
            angle_rad: None,
            beyond_training: false,
            beyond_why: sweep.is_none().then(|| BeyondWhy::Habits {
                habit: "pass".to_owned(),
            }),
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
        let sweep = vec![
            row(Some(point(5.0, "P01-a"))),
            row(Some(point(10.0, "P01-b"))),
        ];
        for rows in [vec![row(None)], sweep] {
            write_conditions(&path, &rows).unwrap();
            assert_eq!(read_conditions(&path).unwrap(), rows);
        }
        // A table of before has no column for it.
        let before = "participant,condition,adb_hat,moved_points,moved_points_sd,clamped,angle_rad,beyond_training,w1\nP01,own,30,0,,false,,false,0.5\n";
        std::fs::write(&path, before).unwrap();
        assert_eq!(read_conditions(&path).unwrap()[0].beyond_why, None);
        assert_eq!(row(None).drive().unwrap().as_str(), "P01-sporty");
    }
}

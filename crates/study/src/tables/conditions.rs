//! The conditions of each participant: where in style space the car should drive.

use super::{
    Table, TableBuilder,
    embeddings::{read_coordinates, with_coordinates},
};
use crate::error::StudyError;
use maveric_domain::{ConditionId, DriveId, Embedding, ParticipantId};
use std::path::Path;

pub use maveric_domain::{ConditionRow, SweepPoint};

/// Writes conditions, one row each.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_conditions(path: &Path, rows: &[ConditionRow]) -> Result<(), StudyError> {
    let builder = TableBuilder::default()
        .text("participant", rows.iter().map(|r| r.participant.as_str()))
        .text("condition", rows.iter().map(|r| r.condition.as_str()))
        .numbers("adb_hat", rows.iter().map(|r| r.adb_hat))
        .numbers("moved_points", rows.iter().map(|r| r.moved_points))
        .numbers("moved_points_sd", rows.iter().map(|r| r.moved_points_sd))
        .flags("clamped", rows.iter().map(|r| r.clamped))
        .numbers("angle_rad", rows.iter().map(|r| r.angle_rad))
        .flags("beyond_training", rows.iter().map(|r| r.beyond_training));
    let embeddings: Vec<&Embedding> = rows.iter().map(|r| &r.embedding).collect();
    let builder = with_coordinates(builder, &embeddings);
    if rows.iter().all(|r| r.sweep.is_none()) {
        return builder.write(path);
    }
    let text = |of: fn(&SweepPoint) -> &str| -> Vec<&str> {
        rows.iter()
            .map(|r| r.sweep.as_ref().map_or("", of))
            .collect()
    };
    let number = |of: fn(&SweepPoint) -> f64| -> Vec<Option<f64>> {
        rows.iter().map(|r| r.sweep.as_ref().map(of)).collect()
    };
    builder
        .text("drive", text(|p| p.drive.as_str()))
        .text("attribute", text(|p| p.attribute.as_str()))
        .numbers("requested_points", number(|p| p.requested_points))
        .numbers("attribute_points", number(|p| p.attribute_points))
        .write(path)
}

fn read_sweep(table: &Table) -> Result<Vec<Option<SweepPoint>>, StudyError> {
    if !table.has("drive") {
        return Ok(vec![None; table.rows()]);
    }
    let drive = table.text("drive")?;
    let attribute = table.text("attribute")?;
    let requested = table.numbers("requested_points")?;
    let moved = table.numbers("attribute_points")?;
    (0..table.rows())
        .map(|row| {
            let Some(name) = &drive[row] else {
                return Ok(None);
            };
            let number = |column: &str, cell: Option<f64>| {
                cell.ok_or_else(|| table.bad_cell(row, column, "", "a number"))
            };
            let drive = DriveId::new(name.clone())
                .map_err(|e| table.bad_cell(row, "drive", name, e.to_string()))?;
            Ok(Some(SweepPoint {
                drive,
                attribute: attribute[row].clone().unwrap_or_default(),
                requested_points: number("requested_points", requested[row])?,
                attribute_points: number("attribute_points", moved[row])?,
            }))
        })
        .collect()
}

/// Reads conditions back.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_conditions(path: &Path) -> Result<Vec<ConditionRow>, StudyError> {
    let table = Table::read(path)?;
    let sweep = read_sweep(&table)?;
    if sweep.iter().all(Option::is_none) {
        table.each_once(&["participant", "condition"])?;
    } else {
        table.each_once(&["participant", "condition", "drive"])?;
    }
    let participant: Vec<ParticipantId> = table.ids("participant")?;
    let condition: Vec<ConditionId> = table.parsed("condition")?;
    let adb_hat = table.numbers("adb_hat")?;
    let moved_points = table.numbers("moved_points")?;
    let moved_points_sd = table.numbers("moved_points_sd")?;
    let clamped: Vec<bool> = table.parsed("clamped")?;
    let angle_rad = table.numbers("angle_rad")?;
    let beyond_training: Vec<bool> = table.parsed("beyond_training")?;
    let embedding = read_coordinates(&table)?;
    Ok((0..table.rows())
        .map(|i| ConditionRow {
            sweep: sweep[i].clone(),
            participant: participant[i].clone(),
            condition: condition[i],
            adb_hat: adb_hat[i],
            moved_points: moved_points[i],
            moved_points_sd: moved_points_sd[i],
            clamped: clamped[i],
            angle_rad: angle_rad[i],
            beyond_training: beyond_training[i],
            embedding: embedding[i].clone(),
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(row(None).drive().unwrap().as_str(), "P01-sporty");
    }
}

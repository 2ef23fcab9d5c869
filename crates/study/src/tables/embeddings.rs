//! Fitted embeddings: a row a drive and fit.

use super::{Table, TableBuilder};
use crate::error::StudyError;
use maveric_domain::{ConditionId, DriveId, Embedding, ParticipantId};
use std::path::Path;

pub use maveric_domain::{EmbeddingRow, FitDetails};

/// Adds `<prefix>1`, `<prefix>2`, … with one list a row.
fn with_numbered(builder: TableBuilder, prefix: &str, lists: &[&[Option<f64>]]) -> TableBuilder {
    let size = lists.iter().map(|l| l.len()).max().unwrap_or(0);
    (0..size).fold(builder, |b, i| {
        let column = lists.iter().map(|l| l.get(i).copied().flatten());
        b.numbers(&format!("{prefix}{}", i + 1), column)
    })
}

/// One list a row of `<prefix>1`, `<prefix>2`, …
fn read_numbered(table: &Table, prefix: &str) -> Result<Vec<Vec<Option<f64>>>, StudyError> {
    let mut lists = vec![Vec::new(); table.rows()];
    for i in 1.. {
        let column = format!("{prefix}{i}");
        if !table.has(&column) {
            break;
        }
        for (list, cell) in lists.iter_mut().zip(table.numbers(&column)?) {
            list.push(cell);
        }
    }
    Ok(lists)
}

pub(super) fn with_coordinates(builder: TableBuilder, embeddings: &[&Embedding]) -> TableBuilder {
    let size = embeddings.first().map_or(0, |e| e.size());
    (0..size).fold(builder, |b, i| {
        b.numbers(
            &format!("w{}", i + 1),
            embeddings.iter().map(|e| Some(e.coordinates()[i])),
        )
    })
}

pub(super) fn read_coordinates(table: &Table) -> Result<Vec<Embedding>, StudyError> {
    let mut columns = Vec::new();
    while table.has(&format!("w{}", columns.len() + 1)) {
        columns.push(table.all_numbers(&format!("w{}", columns.len() + 1))?);
    }
    if columns.is_empty() {
        table.all_numbers("w1")?; // says which columns there are
    }
    (0..table.rows())
        .map(|row| Ok(Embedding::new(columns.iter().map(|c| c[row]).collect())?))
        .collect()
}

/// Writes embeddings, one row each; `w1`, `w2`, … are the coordinates, and what [`FitDetails`] names follows them.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_embeddings(path: &Path, rows: &[EmbeddingRow]) -> Result<(), StudyError> {
    let builder = TableBuilder::default()
        .text("drive", rows.iter().map(|r| r.drive.as_str()))
        .text("participant", rows.iter().map(|r| r.participant.as_str()))
        .text("condition", rows.iter().map(|r| r.condition.as_str()))
        .flags("adb_used", rows.iter().map(|r| r.adb_used))
        .numbers("adb", rows.iter().map(|r| r.adb))
        .numbers("adb_hat", rows.iter().map(|r| r.adb_hat))
        .numbers("line_position", rows.iter().map(|r| r.line_position))
        .numbers("start_spread", rows.iter().map(|r| r.start_spread))
        .integers(
            "rows",
            rows.iter()
                .map(|r| r.rows.and_then(|n| i64::try_from(n).ok())),
        );
    let embeddings: Vec<&Embedding> = rows.iter().map(|r| &r.embedding).collect();
    let builder = with_coordinates(builder, &embeddings);
    if rows.iter().all(|r| r.details.is_none()) {
        return builder.write(path);
    }
    let lists = |of: fn(&FitDetails) -> &[Option<f64>]| -> Vec<&[Option<f64>]> {
        rows.iter()
            .map(|r| r.details.as_ref().map_or(&[] as &[_], of))
            .collect()
    };
    let number = |of: fn(&FitDetails) -> Option<f64>| -> Vec<Option<f64>> {
        rows.iter()
            .map(|r| r.details.as_ref().and_then(of))
            .collect()
    };
    let builder = with_numbered(builder, "se", &lists(|d| &d.standard_error));
    let builder = with_numbered(builder, "spread", &lists(|d| &d.start_spread));
    let builder = with_numbered(builder, "guess", &lists(|d| &d.amortized_guess));
    builder
        .numbers("line_position_se", number(|d| d.line_position_se))
        .numbers("effective_rows", number(|d| d.effective_rows))
        .write(path)
}

/// Reads embeddings back.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_embeddings(path: &Path) -> Result<Vec<EmbeddingRow>, StudyError> {
    let table = Table::read(path)?;
    let drive: Vec<DriveId> = table.ids("drive")?;
    let participant: Vec<ParticipantId> = table.ids("participant")?;
    let condition: Vec<ConditionId> = table.parsed("condition")?;
    let adb_used: Vec<bool> = table.parsed("adb_used")?;
    let adb = table.numbers("adb")?;
    let adb_hat = table.numbers("adb_hat")?;
    let line_position = table.numbers("line_position")?;
    let start_spread = table.numbers("start_spread")?;
    let rows = table.numbers("rows")?;
    let embedding = read_coordinates(&table)?;
    let has_details = table.has("se1");
    let standard_error = read_numbered(&table, "se")?;
    let spread = read_numbered(&table, "spread")?;
    let guess = read_numbered(&table, "guess")?;
    let optional = |column: &str| {
        if table.has(column) {
            table.numbers(column)
        } else {
            Ok(vec![None; table.rows()])
        }
    };
    let line_position_se = optional("line_position_se")?;
    let effective_rows = optional("effective_rows")?;
    Ok((0..table.rows())
        .map(|i| EmbeddingRow {
            details: has_details.then(|| FitDetails {
                standard_error: standard_error[i].clone(),
                start_spread: spread[i].clone(),
                amortized_guess: guess[i].clone(),
                line_position_se: line_position_se[i],
                effective_rows: effective_rows[i],
            }),
            drive: drive[i].clone(),
            participant: participant[i].clone(),
            condition: condition[i],
            adb_used: adb_used[i],
            adb: adb[i],
            adb_hat: adb_hat[i],
            line_position: line_position[i],
            start_spread: start_spread[i],
            rows: rows[i].map(|n| n as usize),
            embedding: embedding[i].clone(),
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn embeddings_with_and_without_details_come_back_as_they_were() {
        let row = |name: &str, details: Option<FitDetails>| EmbeddingRow {
            drive: DriveId::new(name).unwrap(),
            participant: ParticipantId::new("P01").unwrap(),
            condition: ConditionId::OWN,
            adb_used: false,
            adb: None,
            adb_hat: Some(30.5),
            line_position: Some(0.25),
            start_spread: Some(0.01),
            rows: Some(600),
            details,
            embedding: Embedding::new(vec![0.5, -1.0]).unwrap(),
        };
        let details = FitDetails {
            standard_error: vec![Some(0.1), Some(0.2)],
            start_spread: vec![Some(0.0), Some(0.01)],
            amortized_guess: vec![None, None],
            line_position_se: Some(0.15),
            effective_rows: None,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("embeddings.csv");
        for rows in [
            vec![row("a", None), row("b", None)],
            vec![row("a", Some(details.clone())), row("b", Some(details))],
        ] {
            write_embeddings(&path, &rows).unwrap();
            assert_eq!(read_embeddings(&path).unwrap(), rows);
        }
    }
}

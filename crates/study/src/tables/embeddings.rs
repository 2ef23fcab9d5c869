//! Fitted embeddings: a row a drive and fit.

use super::{Table, TableBuilder};
use crate::error::StudyError;
use maveric_domain::{BeyondWhy, ConditionId, DriveId, Embedding, ParticipantId};
use serde::{Deserialize, Serialize};
use std::path::Path;

pub use maveric_domain::EmbeddingRow;

/// What of a fit has a column in every table.
#[derive(Deserialize)]
struct Fit {
    drive: DriveId,
    participant: ParticipantId,
    condition: ConditionId,
    adb_used: bool,
    adb: Option<f64>,
    adb_hat: Option<f64>,
    line_position: Option<f64>,
    readings: Option<usize>,
}

/// What a model says of whether it has met such a driver; in tables of before there was support there are no such columns.
#[derive(Deserialize, Serialize)]
struct Met {
    support_p: Option<f64>,
    beyond: Option<bool>,
    beyond_why: Option<BeyondWhy>,
    #[serde(default)]
    posted_unseen: Option<bool>,
}

/// Names of the covariances of `d` numbers that a table holds, and where they stand: those on and above the diagonal.
fn covariances(d: usize) -> impl Iterator<Item = (String, usize, usize)> {
    let above = move |i| (i..d).map(move |j| (format!("cov{}_{}", i + 1, j + 1), i, j));
    (0..d).flat_map(above)
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

/// Writes embeddings, one row each; `w1`, `w2`, … are the coordinates, `cov1_1`, `cov1_2`, … their covariances.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_embeddings(path: &Path, rows: &[EmbeddingRow]) -> Result<(), StudyError> {
    let met = |r: &EmbeddingRow| Met {
        support_p: r.support_p,
        beyond: r.beyond(),
        beyond_why: r.beyond_why.clone(),
        posted_unseen: r.posted_unseen,
    };
    let met: Vec<Met> = rows.iter().map(met).collect();
    let builder = TableBuilder::some_of::<Fit, _>(rows)?.beside(TableBuilder::of(&met)?);
    let embeddings: Vec<&Embedding> = rows.iter().map(|r| &r.embedding).collect();
    let builder = with_coordinates(builder, &embeddings);
    if rows.iter().all(|r| r.covariance.is_none()) {
        return builder.write(path);
    }
    let d = embeddings.first().map_or(0, |e| e.size());
    let entry = |i: usize, j: usize| {
        rows.iter()
            .map(move |r| Some(*r.covariance.as_ref()?.get(i * d + j)?))
    };
    covariances(d)
        .fold(builder, |b, (name, i, j)| b.numbers(&name, entry(i, j)))
        .numbers("line_position_se", rows.iter().map(|r| r.line_position_se))
        .write(path)
}

/// Reads embeddings back.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_embeddings(path: &Path) -> Result<Vec<EmbeddingRow>, StudyError> {
    let table = Table::read(path)?;
    table.each_once(&["drive", "adb_used"])?;
    let fits: Vec<Fit> = table.records()?;
    let embedding = read_coordinates(&table)?;
    let covariance = read_covariances(&table, &embedding)?;
    let line_position_se = if table.has("line_position_se") {
        table.numbers("line_position_se")?
    } else {
        vec![None; table.rows()]
    };
    let met: Vec<Option<Met>> = if table.has("support_p") {
        table.records()?.into_iter().map(Some).collect()
    } else {
        fits.iter().map(|_| None).collect()
    };
    let found = covariance.into_iter().zip(line_position_se).zip(embedding);
    Ok(fits
        .into_iter()
        .zip(met)
        .zip(found)
        .map(
            |((fit, met), ((covariance, line_position_se), embedding))| EmbeddingRow {
                drive: fit.drive,
                participant: fit.participant,
                condition: fit.condition,
                adb_used: fit.adb_used,
                adb: fit.adb,
                adb_hat: fit.adb_hat,
                line_position: fit.line_position,
                readings: fit.readings,
                covariance,
                line_position_se,
                support_p: met.as_ref().and_then(|m| m.support_p),
                posted_unseen: met.as_ref().and_then(|m| m.posted_unseen),
                beyond_why: met.and_then(|m| m.beyond_why),
                embedding,
            },
        )
        .collect())
}

/// The covariance of each row; none where a cell of it is missing.
fn read_covariances(
    table: &Table,
    embeddings: &[Embedding],
) -> Result<Vec<Option<Vec<f64>>>, StudyError> {
    let mut found: Vec<Option<Vec<f64>>> = vec![None; table.rows()];
    let d = embeddings.first().map_or(0, Embedding::size);
    if !table.has("cov1_1") {
        return Ok(found);
    }
    found.fill(Some(vec![0.0; d * d]));
    for (name, i, j) in covariances(d) {
        for (row, cell) in found.iter_mut().zip(table.numbers(&name)?) {
            match (row.as_mut(), cell) {
                (Some(matrix), Some(value)) => {
                    (matrix[i * d + j], matrix[j * d + i]) = (value, value);
                }
                _ => *row = None,
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn embeddings_with_and_without_covariance_come_back_as_they_were() {
        let row = |name: &str, covariance: Option<Vec<f64>>| EmbeddingRow {
            drive: DriveId::new(name).unwrap(),
            participant: ParticipantId::new("P01").unwrap(),
            condition: "own".parse().unwrap(),
            adb_used: false,
            adb: None,
            adb_hat: Some(30.5),
            line_position: Some(0.25),
            readings: Some(60),
            line_position_se: covariance.as_ref().map(|_| 0.15),
            support_p: covariance.as_ref().map(|_| 0.002),
            beyond_why: covariance.as_ref().map(|_| BeyondWhy::Style {
                habit: "pass".to_owned(),
            }),
            posted_unseen: covariance.as_ref().map(|_| true),
            covariance,
            embedding: Embedding::new(vec![0.5, -1.0]).unwrap(),
        };
        let known = || Some(vec![0.04, 0.01, 0.01, 0.09]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("embeddings.csv");
        for rows in [
            vec![row("a", None), row("b", None)],
            vec![row("a", known()), row("b", None)],
        ] {
            write_embeddings(&path, &rows).unwrap();
            assert_eq!(read_embeddings(&path).unwrap(), rows);
        }
    }
}

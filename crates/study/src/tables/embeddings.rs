//! Fitted embeddings: a row a drive and fit.

use super::{Table, TableName, write_rows};
use crate::error::StudyError;
use maveric_domain::{Embedding, ParticipantId};
use std::path::Path;

pub use maveric_domain::EmbeddingRow;

/// Names of the covariances of `d` numbers that a table holds, and where they stand: those on and above the diagonal.
fn covariances(d: usize) -> impl Iterator<Item = (String, usize, usize)> {
    let above = move |i| (i..d).map(move |j| (format!("cov{}_{}", i + 1, j + 1), i, j));
    (0..d).flat_map(above)
}

/// The coordinates, each with the name of its column.
pub(super) fn coordinates(embedding: &Embedding) -> Vec<(String, f64)> {
    let named = |(i, &w): (usize, &f64)| (format!("w{}", i + 1), w);
    embedding.coordinates().iter().enumerate().map(named).collect()
}

/// The coordinates of each row.
pub(super) fn read_coordinates(table: &Table) -> Result<Vec<Option<Vec<f64>>>, StudyError> {
    let mut columns = Vec::new();
    while table.has(&format!("w{}", columns.len() + 1)) {
        columns.push(table.all_numbers(&format!("w{}", columns.len() + 1))?);
    }
    if columns.is_empty() {
        table.all_numbers("w1")?; // says which columns there are
    }
    let coordinates = |row: usize| Some(columns.iter().map(|c| c[row]).collect());
    Ok((0..table.rows()).map(coordinates).collect())
}

/// Writes embeddings, one row each; `w1`, `w2`, … are the coordinates, `cov1_1`, `cov1_2`, … their covariances.
pub fn write_embeddings(path: &Path, rows: &[EmbeddingRow]) -> Result<(), StudyError> {
    let written = rows.iter().map(|row| {
        let d = row.embedding.size();
        let entry = |(name, i, j): (String, usize, usize)| {
            Some((name, row.covariance.as_ref()?.get(i * d + j)?))
        };
        let covariances: Vec<(String, &f64)> = covariances(d).filter_map(entry).collect();
        let beyond = ("beyond", row.beyond());
        (row, beyond, coordinates(&row.embedding), covariances)
    });
    write_rows(TableName::Embeddings, path, written)
}

/// Reads embeddings back.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_embeddings(path: &Path) -> Result<Vec<EmbeddingRow>, StudyError> {
    let table = Table::read(path)?;
    table.each_once(&["drive", "adb_used"])?;
    let embeddings = read_coordinates(&table)?;
    let d = embeddings.first().map_or(0, |w| w.as_ref().map_or(0, Vec::len));
    let covariances = read_covariances(&table, d)?;
    let mut beside = vec![("embedding", embeddings), ("covariance", covariances)];
    // Tables without covariances have no errors beside them; one by hand need not say what is beyond a model.
    beside.extend(table.absent(&["line_position_se", "support_p", "beyond_why", "posted_unseen"]));
    table.records_beside(&beside)
}

/// Reads embeddings that a model with `size` numbers is to drive by.
///
/// # Errors
/// As [`read_embeddings`]; [`StudyError::BadFile`] for styles of another model, and for a file without rows.
pub fn read_styles(path: &Path, size: usize) -> Result<Vec<EmbeddingRow>, StudyError> {
    let rows = read_embeddings(path)?;
    let numbers = rows.first().map_or(0, |row| row.embedding.size());
    if numbers == size {
        return Ok(rows);
    }
    let problem = match numbers {
        0 => "has no row, expected one for everybody, or one a person".to_owned(),
        _ => format!("has styles of {numbers} numbers (w1, …), and the model's have {size}"),
    };
    let help = "write it with `maveric personalize` and the study's model";
    Err(StudyError::file(path, problem).with_help(help))
}

/// The style of `who` in a file of embeddings: of their own row, or of its only row.
///
/// # Errors
/// [`StudyError::BadFile`] naming the file, and whose row it has not.
pub fn style_of<'a>(
    rows: &'a [EmbeddingRow],
    file: &Path,
    who: &ParticipantId,
) -> Result<&'a Embedding, StudyError> {
    let by_id = rows.iter().find(|row| row.participant == *who);
    if let Some(row) = by_id.or(rows.first().filter(|_| rows.len() == 1)) {
        return Ok(&row.embedding);
    }
    Err(StudyError::BadFile {
        path: file.to_owned(),
        problem: format!(
            "has {} rows, and none of {who}; expected one row for everybody, or one a person",
            rows.len()
        ),
        help: Some(format!("add the row of {who}, then open the seat or run the stage again")),
    })
}

/// The covariance of each row; none where a cell of it is missing.
fn read_covariances(table: &Table, d: usize) -> Result<Vec<Option<Vec<f64>>>, StudyError> {
    let mut matrices: Vec<Option<Vec<f64>>> = vec![None; table.rows()];
    if !table.has("cov1_1") {
        return Ok(matrices);
    }
    matrices.fill(Some(vec![0.0; d * d]));
    for (name, i, j) in covariances(d) {
        for (row, cell) in matrices.iter_mut().zip(table.numbers(&name)?) {
            match (row.as_mut(), cell) {
                (Some(matrix), Some(value)) => {
                    (matrix[i * d + j], matrix[j * d + i]) = (value, value);
                }
                _ => *row = None,
            }
        }
    }
    Ok(matrices)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{BeyondWhy, DriveId};

    #[test]
    fn embeddings_with_and_without_covariance_come_back_as_they_were() {
        let row = |name: &str, covariance: Option<Vec<f64>>| EmbeddingRow {
            drive: DriveId::new(name).unwrap(),
            participant: ParticipantId::new("P01").unwrap(),
            condition: "own".parse().unwrap(),
            session: maveric_domain::occasion::first(),
            trial: maveric_domain::occasion::first(),
            adb_used: false,
            adb: None,
            adb_hat: Some(30.5),
            line_position: Some(0.25),
            readings: Some(60),
            line_position_se: covariance.as_ref().map(|_| 0.15),
            support_p: covariance.as_ref().map(|_| 0.002),
            beyond_why: covariance.as_ref().map(|_| BeyondWhy::Style { habit: "pass".to_owned() }),
            posted_unseen: covariance.as_ref().map(|_| true),
            covariance,
            embedding: Embedding::new(vec![0.5, -1.0]).unwrap(),
        };
        let known = || Some(vec![0.04, 0.01, 0.01, 0.09]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("embeddings.csv");
        for rows in [vec![row("a", None), row("b", None)], vec![row("a", known()), row("b", None)]]
        {
            write_embeddings(&path, &rows).unwrap();
            assert_eq!(read_embeddings(&path).unwrap(), rows);
        }
    }
}

//! Writing rows, as the dictionary has their columns.

use super::{TableBuilder, TableName};
use crate::error::StudyError;
use maveric_domain::occasion::OCCASION;
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

/// Writes a table of a row each; its columns stand in the order of the dictionary, which has to know them.
///
/// A row is a struct, whose fields are its cells (one that is a list or a struct is none), a pair of a column's name and its cell, or
/// several of these side by side: a tuple, a list. Of a column that only some rows have the others' cells are missing; those that do not
/// say of which session or trial they are, are of the first.
///
/// # Errors
/// As [`TableBuilder::write`]; [`StudyError::BadFile`] for a column that the dictionary does not have, or rows without one that it has.
pub fn write_rows<T: Serialize>(
    table: TableName,
    path: &Path,
    rows: impl IntoIterator<Item = T>,
) -> Result<(), StudyError> {
    let entry = table.entry();
    let refused = |what: String| StudyError::file(path, format!("cannot be written: {what}"));
    // Whatever does not say of which session or trial it is, is of the first.
    let absent = |name: &str| {
        if OCCASION.contains(&name) { Value::from(1) } else { Value::Null }
    };
    let mut columns: Vec<(usize, String, Vec<Value>)> = Vec::new();
    let mut count = 0;
    for row in rows {
        let row = serde_json::to_value(row).map_err(|e| refused(e.to_string()))?;
        for (name, cell) in cells(row) {
            let known = columns.iter_mut().find(|column| column.1 == name);
            if let Some((.., column)) = known {
                column.resize(count, absent(&name));
                column.push(cell);
            } else if let Some(place) = entry.place_of(&name) {
                let mut column = vec![absent(&name); count];
                column.push(cell);
                columns.push((place, name, column));
            } else if !cell.is_null() {
                let what = format!("the dictionary of tables has no column `{name}`");
                return Err(refused(what));
            }
        }
        count += 1;
    }
    for name in entry.always() {
        if !columns.iter().any(|column| column.1 == name) {
            if count > 0 {
                return Err(refused(format!("no row has the column `{name}`")));
            }
            columns.extend(entry.place_of(name).map(|at| (at, name.to_owned(), Vec::new())));
        }
    }
    columns.sort_by_key(|column| column.0);
    let mut builder = TableBuilder::default();
    for (_, name, mut cells) in columns {
        cells.resize(count, absent(&name));
        builder = builder.values(&name, &cells);
    }
    builder.write(path)
}

/// The cells of a row, each with the name of its column.
fn cells(row: Value) -> Vec<(String, Value)> {
    match row {
        Value::Object(fields) => {
            let is_cell = |(_, value): &(_, Value)| !value.is_array() && !value.is_object();
            fields.into_iter().filter(is_cell).collect()
        }
        Value::Array(parts) => match <[Value; 2]>::try_from(parts) {
            Ok([Value::String(name), cell]) => vec![(name, cell)],
            Ok(parts) => parts.into_iter().flat_map(cells).collect(),
            Err(parts) => parts.into_iter().flat_map(cells).collect(),
        },
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::{Table, read_rows};
    use maveric_domain::ParticipantId;
    use serde::Deserialize;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Answered {
        answer: Option<i32>,
        participant: ParticipantId,
        scale: String,
        moment: String,
        item: u32,
    }

    fn answered(answer: Option<i32>) -> Answered {
        Answered {
            answer,
            participant: ParticipantId::new("P1").unwrap(),
            scale: String::new(),
            moment: "pre".to_owned(),
            item: 4,
        }
    }

    #[test]
    fn rows_come_back_as_they_were_and_stand_as_the_dictionary_has_them() {
        let rows = [answered(None), answered(Some(-3)), answered(None)];
        let folder = tempfile::tempdir().unwrap();
        for name in ["t.csv", "t.parquet"] {
            let path = folder.path().join(name);
            write_rows(TableName::Answers, &path, &rows).unwrap();
            assert_eq!(read_rows::<Answered>(&path).unwrap(), rows);
        }
        let text = std::fs::read_to_string(folder.path().join("t.csv")).unwrap();
        let expected = "participant,moment,scale,item,answer\nP1,pre,\"\",4,\nP1,pre,\"\",4,-3\nP1,pre,\"\",4,\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn numbers_come_back_to_their_last_digit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let values = [Some(0.1 + 0.2), None, Some(1e-300)];
        let row = |value: &Option<f64>| serde_json::json!({ "drive": "d", "rows": 1, "participant": "P", "condition": "own", "driven_by": "human", "duration_s": value });
        write_rows(TableName::Drives, &path, values.iter().map(row)).unwrap();
        assert_eq!(Table::read(&path).unwrap().numbers("duration_s").unwrap(), values);
    }

    #[test]
    fn a_table_without_rows_has_the_columns_that_it_has_always() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        write_rows::<Answered>(TableName::Answers, &path, []).unwrap();
        let table = Table::read(&path).unwrap();
        assert_eq!(table.columns(), ["participant", "moment", "scale", "item", "answer"]);
        assert!(table.records::<Answered>().unwrap().is_empty());
    }

    #[test]
    fn columns_by_name_are_those_of_every_row_and_lists_of_rows_are_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let row = |who: &str, cells: serde_json::Value| {
            (
                ("participant.label", who.to_owned()),
                cells,
                serde_json::json!({ "other": [{ "a": 1 }], "none": null }),
            )
        };
        let rows = [
            row("A", serde_json::json!([["trial.1.player.x_1", 2]])),
            row("B", serde_json::json!([["pre.1.player.x_1", 5], ["trial.1.player.x_1", 3]])),
        ];
        write_rows(TableName::SurveysWide, &path, rows).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text, "participant.label,pre.1.player.x_1,trial.1.player.x_1\nA,,2\nB,5,3\n");
    }

    #[test]
    fn a_column_that_the_dictionary_does_not_have_is_refused_and_one_that_is_not_there_too() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let refused = |row: serde_json::Value| {
            let written = write_rows(TableName::Forgotten, &path, [row]);
            written.err().map(|e| e.to_string()).unwrap_or_default()
        };
        let more =
            refused(serde_json::json!({ "participant": "P1", "models": null, "why": "asked" }));
        assert!(more.contains("no column `why`"), "{more}");
        let less = refused(serde_json::json!({ "participant": "P1" }));
        assert!(less.contains("no row has the column `models`"), "{less}");
        assert!(!path.exists());
        assert_eq!(refused(serde_json::json!({ "participant": "P1", "models": null })), "");
    }
}

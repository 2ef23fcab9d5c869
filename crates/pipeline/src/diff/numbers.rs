//! Tables and JSON files as cells, and what two of them differ in.

use std::collections::BTreeMap;

use serde_json::Value;

use super::{FileDifference, NumberDifference};

/// How many of each kind of difference are told.
const TOLD: usize = 10;

/// A cell's text by its place.
pub(super) type Cells = BTreeMap<String, String>;

/// The leaves of a JSON document by their pointers; `None` if it is none.
pub(super) fn json_cells(bytes: &[u8]) -> Option<Cells> {
    fn add(value: &Value, at: &mut String, cells: &mut Cells) {
        let mut below = |name: &str, value: &Value| {
            let length = at.len();
            at.push('/');
            at.push_str(name);
            add(value, at, cells);
            at.truncate(length);
        };
        match value {
            Value::Array(values) => {
                for (i, value) in values.iter().enumerate() {
                    below(&i.to_string(), value);
                }
            }
            Value::Object(values) => values.iter().for_each(|(name, value)| below(name, value)),
            Value::String(text) => drop(cells.insert(at.clone(), text.clone())),
            leaf => drop(cells.insert(at.clone(), leaf.to_string())),
        }
    }
    let value: Value = serde_json::from_slice(bytes).ok()?;
    let mut cells = Cells::new();
    add(&value, &mut String::new(), &mut cells);
    Some(cells)
}

/// The cells of a table with a heading. A row is named by its first cells, as many as it
/// takes to tell all rows apart, from columns of texts and whole numbers; else by its number.
pub(super) fn csv_cells(bytes: &[u8], delimiter: u8) -> Option<Cells> {
    let (headers, rows) = crate::table::read(bytes, delimiter).ok()?;
    let name = |row: &[String], cells: usize| row[..cells].join(" ");
    let unique = |cells: &usize| {
        let names: std::collections::BTreeSet<_> =
            rows.iter().map(|(_, row)| name(row, *cells)).collect();
        names.len() == rows.len()
    };
    // A measured value is what is compared, and names nothing.
    let measured = |column: &usize| {
        let is_decimal = |text: &String| number(text).is_some() && text.parse::<i64>().is_err();
        rows.iter().any(|(_, row)| is_decimal(&row[*column]))
    };
    let names = (0..headers.len()).find(measured).unwrap_or(headers.len());
    let names = names.min(headers.len().saturating_sub(1));
    let key = (1..=names).find(unique);
    let mut cells = Cells::new();
    for (i, (_, row)) in rows.iter().enumerate() {
        let row_name = key.map_or_else(|| format!("row {}", i + 1), |key| name(row, key));
        for (column, cell) in headers.iter().zip(row).skip(key.unwrap_or(0)) {
            cells.insert(format!("{row_name}, {column}"), cell.to_owned());
        }
    }
    Some(cells)
}

/// What two files differ in, given the cells of each.
pub(super) fn difference(path: String, a: &Cells, b: &Cells) -> FileDifference {
    let mut numbers = Vec::new();
    let mut texts = Vec::new();
    let mut compared = 0;
    for (at, first) in a {
        let Some(second) = b.get(at) else {
            continue;
        };
        match (number(first), number(second)) {
            (Some(first), Some(second)) => {
                compared += 1;
                if first.to_bits() != second.to_bits() {
                    numbers.push(NumberDifference { at: at.clone(), first, second });
                }
            }
            _ if first != second => texts.push(format!("{at}: {first} -> {second}")),
            _ => {}
        }
    }
    let differing = numbers.len();
    numbers.sort_by(|x, y| relative(y).total_cmp(&relative(x)));
    numbers.truncate(TOLD);
    let only = |these: &Cells, others: &Cells, run: &str| -> Vec<String> {
        let alone = these.keys().filter(|at| !others.contains_key(*at));
        alone.take(TOLD).map(|at| format!("{at}: only in the {run} run")).collect()
    };
    let mut unpaired = only(a, b, "first");
    unpaired.extend(only(b, a, "second"));
    unpaired.truncate(TOLD);
    texts.truncate(TOLD);
    FileDifference::Numbers { path, compared, differing, largest: numbers, unpaired, texts }
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

/// The distance as a part of the larger of both.
fn relative(difference: &NumberDifference) -> f64 {
    let (a, b) = (difference.first, difference.second);
    (a - b).abs() / a.abs().max(b.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many numbers were compared and how many differ, the largest differences, what is in one alone, and texts.
    type Told = (usize, usize, Vec<NumberDifference>, Vec<String>, Vec<String>);

    fn told(a: &Cells, b: &Cells) -> Told {
        match difference("t.csv".to_owned(), a, b) {
            FileDifference::Numbers { compared, differing, largest, unpaired, texts, .. } => {
                (compared, differing, largest, unpaired, texts)
            }
            other => panic!("these are tables: {other:?}"),
        }
    }

    #[test]
    fn rows_are_paired_by_as_many_first_cells_as_it_takes() {
        let a = csv_cells(b"who,day,x,note\nann,1,1.0,a\nann,2,2,b\n", b',').unwrap();
        let b = csv_cells(b"who,day,x,note\nann,2,2.5,c\nann,1,1,a\nbob,1,7,d\n", b',').unwrap();
        let (compared, differing, largest, unpaired, texts) = told(&a, &b);
        assert_eq!((compared, differing), (2, 1));
        assert_eq!((largest[0].at.as_str(), largest[0].second), ("ann 2, x", 2.5));
        assert_eq!(texts, ["ann 2, note: b -> c"]);
        assert_eq!(unpaired.len(), 2);
    }

    #[test]
    fn a_json_number_is_found_where_it_stands() {
        let a = json_cells(br#"{"a": [1, {"b": 2}], "t": "x", "n": null}"#).unwrap();
        assert_eq!(a["/a/1/b"], "2");
        assert_eq!(a.len(), 4);
        assert!(json_cells(b"{").is_none());
    }

    #[test]
    fn the_largest_differences_come_first_and_no_more_than_ten_of_a_kind() {
        let table = |numbers: &[(i32, f64)], text: &str| {
            let rows = numbers.iter().map(|(i, v)| format!("r{i},{v:?},{text}"));
            let lines: Vec<String> = std::iter::once("who,x,note".to_owned()).chain(rows).collect();
            csv_cells(lines.join("\n").as_bytes(), b',').unwrap()
        };
        let first: Vec<(i32, f64)> = (10..40).map(|i| (i, 100.5)).collect();
        // Row i is off by i percent of the larger; the last three are alone.
        let second: Vec<(i32, f64)> =
            (10..37).map(|i| (i, 100.5 * (1.0 - f64::from(i) / 100.0))).collect();
        let (a, b) = (table(&first, "one"), table(&second, "two"));
        let (compared, differing, largest, unpaired, texts) = told(&a, &b);
        assert_eq!((compared, differing, largest.len()), (27, 27, TOLD));
        let order: Vec<&str> = largest.iter().map(|d| d.at.as_str()).collect();
        assert_eq!(order[..3], ["r36, x", "r35, x", "r34, x"]);
        assert_eq!((texts.len(), texts[0].as_str()), (TOLD, "r10, note: one -> two"));
        assert_eq!(unpaired.len(), 6);
        assert!(unpaired.iter().all(|u| u.ends_with("only in the first run")));
        let (.., unpaired, _) = told(&b, &a);
        assert!(unpaired.iter().all(|u| u.ends_with("only in the second run")));
        // The other way round a distance is as large a part of the larger.
        let apart =
            |first, second| relative(&NumberDifference { at: String::new(), first, second });
        assert!((apart(2.0, 1.0) - 0.5).abs() < 1e-12 && (apart(1.0, 2.0) - 0.5).abs() < 1e-12);
        assert!((apart(-2.0, 2.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn rows_that_no_first_cells_tell_apart_are_numbered_and_a_measured_value_names_none() {
        let cells =
            |text: &str| csv_cells(text.as_bytes(), b',').unwrap().into_keys().collect::<Vec<_>>();
        assert_eq!(cells("a,b\n1,x\n1,y\n"), ["row 1, a", "row 1, b", "row 2, a", "row 2, b"]);
        assert_eq!(cells("a,b\n1.5,x\n2.5,y\n"), ["row 1, a", "row 1, b", "row 2, a", "row 2, b"]);
        assert_eq!(cells("a,b,c\n1,x,2.5\n1,y,2.5\n"), ["1 x, c", "1 y, c"]);
        assert_eq!(cells("a\n1\n2\n"), ["row 1, a", "row 2, a"]);
        assert!(csv_cells(b"", b',').is_none());
    }
}

//! Any other result: its numbers under the names of the JSON.

use super::table::{Columns, NONE, number};
use serde_json::{Map, Value};

fn cell(value: &Value) -> String {
    match value {
        Value::Null => NONE.to_owned(),
        Value::Number(n) => match n.as_i64() {
            Some(whole) => whole.to_string(),
            None => number(n.as_f64().unwrap_or_default()),
        },
        Value::String(text) => text.clone(),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.to_owned(),
        Value::Array(items) => {
            let cells: Vec<String> = items.iter().map(cell).collect();
            format!("[{}]", cells.join(", "))
        }
        Value::Object(_) => String::new(),
    }
}

fn is_leaf(value: &Value) -> bool {
    match value {
        Value::Object(_) => false,
        Value::Array(items) => items.len() <= 2 && items.iter().all(is_leaf),
        _ => true,
    }
}

/// Rows with the same names side by side.
fn rows<'a>(rows: impl Iterator<Item = (String, &'a Map<String, Value>)>) -> Vec<String> {
    let rows: Vec<_> = rows.collect();
    let Some((_, first)) = rows.first() else {
        return Vec::new();
    };
    let columns: Vec<&String> = first.keys().filter(|key| *key != "name").collect();
    let header: Vec<&str> = [""]
        .into_iter()
        .chain(columns.iter().map(|key| key.as_str()))
        .collect();
    let mut table = Columns::new(&header);
    for (name, row) in &rows {
        // An item's own name says more than its place.
        let name = row.get("name").and_then(Value::as_str).unwrap_or(name);
        let cells = columns
            .iter()
            .map(|key| row.get(*key).map_or_else(String::new, cell));
        table.row([name.to_owned()].into_iter().chain(cells));
    }
    table.lines()
}

/// A line a number, a table a group of numbers.
pub(in crate::stages::stats) fn plain(value: &Value) -> Vec<String> {
    let Value::Object(object) = value else {
        return Vec::new();
    };
    let hidden = |key: &str| matches!(key, "undefined" | "warnings");
    let mut lines = Vec::new();
    let mut table = Columns::new(&["", ""]);
    let mut lists: Vec<(&str, &Vec<Value>)> = Vec::new();
    for (key, inner) in object.iter().filter(|(key, _)| !hidden(key)) {
        match inner {
            Value::Array(list) if !list.iter().any(Value::is_object) => lists.push((key, list)),
            leaf if is_leaf(leaf) => table.row([key.clone(), cell(leaf)]),
            _ => {}
        }
    }
    lines.extend(table.lines().into_iter().skip(1));
    if !lists.is_empty() {
        let header: Vec<&str> = ["row"]
            .into_iter()
            .chain(lists.iter().map(|(k, _)| *k))
            .collect();
        let mut table = Columns::new(&header);
        for i in 0..lists.iter().map(|(_, list)| list.len()).max().unwrap_or(0) {
            let cells = lists
                .iter()
                .map(|(_, list)| list.get(i).map_or_else(String::new, cell));
            table.row([(i + 1).to_string()].into_iter().chain(cells));
        }
        lines.extend(table.lines());
    }
    for (key, inner) in object.iter().filter(|(key, _)| !hidden(key)) {
        let below = match inner {
            Value::Array(list) => rows(
                (1..)
                    .zip(list)
                    .filter_map(|(i, row)| Some((i.to_string(), row.as_object()?))),
            ),
            Value::Object(map) if map.values().all(is_leaf) => {
                let mut table = Columns::new(&["", ""]);
                for (name, leaf) in map {
                    table.row([name.clone(), cell(leaf)]);
                }
                table.lines().into_iter().skip(1).collect()
            }
            Value::Object(map) => map
                .iter()
                .flat_map(|(name, inner)| {
                    let mut below = plain(inner);
                    below.insert(0, format!("  {name}"));
                    below
                })
                .collect(),
            _ => Vec::new(),
        };
        super::section(&mut lines, key, below);
    }
    if let Some(Value::Object(reasons)) = object.get("undefined") {
        let below = reasons
            .iter()
            .map(|(name, reason)| format!("  {name}: {}", reason.as_str().unwrap_or_default()))
            .collect();
        super::section(&mut lines, "No value (–)", below);
    }
    lines
}

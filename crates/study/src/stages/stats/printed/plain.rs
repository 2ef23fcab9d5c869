//! Any other result: its numbers under the names of the JSON.

use super::{
    Printed,
    cells::{self, number},
};
use maveric_report::{
    markup,
    tables::{Cell, Table},
};
use serde_json::{Map, Value};

fn cell(value: &Value) -> Cell {
    match value {
        Value::Null => Cell::Missing,
        Value::Number(n) => match n.as_i64() {
            Some(whole) => Cell::text(whole.to_string()),
            None => number(n.as_f64().unwrap_or_default()),
        },
        Value::String(text) => Cell::text(text),
        Value::Bool(yes) => Cell::text(if *yes { "yes" } else { "no" }),
        Value::Array(items) => {
            let cells: Vec<String> = items.iter().map(|v| cells::shown(&cell(v))).collect();
            Cell::text(format!("[{}]", cells.join(", ")))
        }
        Value::Object(_) => Cell::text(""),
    }
}

fn is_leaf(value: &Value) -> bool {
    match value {
        Value::Object(_) => false,
        Value::Array(items) => items.len() <= 2 && items.iter().all(is_leaf),
        _ => true,
    }
}

/// Names and values, a row each.
fn leaves<'a>(title: &str, leaves: impl Iterator<Item = (&'a String, &'a Value)>) -> Table {
    let leaves = leaves.filter(|(_, value)| is_leaf(value));
    cells::table(title, leaves)
        .text("", |(name, _)| *name)
        .right("Value", |(_, leaf)| cell(leaf))
        .done()
}

/// Objects with the same names side by side, those of the first.
fn rows<'a>(title: &str, rows: impl Iterator<Item = (String, &'a Map<String, Value>)>) -> Table {
    let rows: Vec<_> = rows.collect();
    let first = rows.first().map(|(_, first)| first.iter());
    let columns: Vec<&String> = first
        .into_iter()
        .flatten()
        .filter(|(key, value)| *key != "name" && is_leaf(value))
        .map(|(key, _)| key)
        .collect();
    // An item's own name says more than its place.
    let table = cells::table(title, &rows).text("", |(name, row)| {
        let label = row.get("name").and_then(Value::as_str);
        label.unwrap_or(name).to_owned()
    });
    let columns = columns.into_iter();
    let filled = columns.fold(table, |table, key| {
        table.right(markup::literal(key), |(_, row)| row.get(key).map_or(Cell::Missing, cell))
    });
    filled.done()
}

/// Lists of the same length side by side.
fn lists(lists: &[(&String, &Vec<Value>)]) -> Table {
    let most = lists.iter().map(|(_, list)| list.len()).max().unwrap_or(0);
    let table = cells::table("Rows", 0..most).text("Row", |i| (i + 1).to_string());
    let filled = lists.iter().fold(table, |table, (key, list)| {
        table.right(key.as_str(), |&i| list.get(i).map_or(Cell::Missing, cell))
    });
    filled.done()
}

/// A table a group of numbers; `sentences` first.
pub(in crate::stages::stats) fn plain(value: &Value, sentences: Vec<String>) -> Printed {
    let printed = Printed::default().lines("In a sentence", sentences);
    inside(printed, "Result", value)
}

/// Adds what is in one object, its title first.
fn inside(mut printed: Printed, title: &str, value: &Value) -> Printed {
    let Value::Object(object) = value else {
        return printed;
    };
    let hidden = |key: &str| matches!(key, "undefined" | "warnings" | "apa");
    let shown = || object.iter().filter(|(key, _)| !hidden(key));
    printed = printed.table(leaves(&markup::literal(title), shown()));
    let long: Vec<(&String, &Vec<Value>)> = shown()
        .filter(|(_, inner)| !is_leaf(inner))
        .filter_map(|(key, inner)| Some((key, inner.as_array()?)))
        .collect();
    let flat: Vec<_> = long
        .iter()
        .filter(|(_, list)| !list.is_empty() && list.iter().all(is_leaf))
        .copied()
        .collect();
    if !flat.is_empty() {
        printed = printed.table(lists(&flat));
    }
    for (key, list) in long {
        let objects =
            (1..).zip(list).filter_map(|(i, row)| Some((i.to_string(), row.as_object()?)));
        printed = printed.table(rows(&markup::literal(key), objects));
    }
    for (key, inner) in shown() {
        let Value::Object(map) = inner else { continue };
        let title = markup::literal(key);
        let alike = map.len() > 1
            && map.values().all(|v| v.as_object().is_some_and(|o| o.values().all(is_leaf)));
        printed = if alike {
            let objects =
                map.iter().filter_map(|(name, row)| Some((name.clone(), row.as_object()?)));
            printed.table(rows(&title, objects))
        } else if map.values().all(is_leaf) {
            printed.table(leaves(&title, map.iter()))
        } else {
            let mut printed = printed.table(leaves(&title, map.iter()));
            for (name, below) in map.iter().filter(|(_, below)| !is_leaf(below)) {
                printed = inside(printed, &format!("{key} {name}"), below);
            }
            printed
        };
    }
    if let Some(Value::Object(reasons)) = object.get("undefined") {
        let lines = reasons.iter().map(|(name, reason)| {
            let name = as_printed(name, object);
            markup::literal(&format!("{name}: {}", reason.as_str().unwrap_or_default()))
        });
        printed = printed.lines("No value (–)", lines.collect());
    }
    printed
}

/// The name of a number; rows of a list, which the JSON counts from 0, as the table counts them.
fn as_printed(name: &str, object: &Map<String, Value>) -> String {
    let mut parts = name.splitn(3, '.');
    let (list, row) = (parts.next().unwrap_or_default(), parts.next());
    let is_list = object.get(list).is_some_and(Value::is_array);
    let row = row.filter(|_| is_list);
    let Some(row) = row.and_then(|row| row.parse::<usize>().ok()) else {
        return name.to_owned();
    };
    let below = parts.map(|below| format!(".{below}"));
    format!("{list} {}{}", row + 1, below.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_reason_names_the_row_as_the_table_counts_it() {
        let value = json!({
            "row": [{ "power": 0.8 }, { "power": null }],
            "alpha": { "1": { "p": null } },
            "undefined": { "row.1.power": "too few", "alpha.1.p": "no data" },
        });
        let printed = plain(&value, Vec::new());
        let text = printed.written(Table::to_text).join("\n");
        assert!(text.contains("row 2.power: too few"), "{text}");
        assert!(text.contains("alpha.1.p: no data"), "{text}");
    }
}

//! oTree's wide table: a row a participant, columns `app.round.player.field`.

use super::{Found, Row, columns::ColumnMap, participant};
use crate::{error::StudyError, tables::Table};
use maveric_domain::{Moment, Scale};
use std::collections::BTreeMap;

type Cells = Vec<Option<String>>;

/// The columns of one scale within one player's page: by item, name and cells.
struct Sheet {
    scale: usize,
    columns: BTreeMap<u32, (String, Cells)>,
}

/// Columns that share everything before the last dot.
#[derive(Default)]
struct Page {
    moment: Option<(String, Cells)>,
    sheets: Vec<Sheet>,
}

pub(super) fn read(table: &Table, scales: &[Scale], map: &ColumnMap) -> Result<Found, StudyError> {
    let mut found = Found::default();
    let pages = pages(table, scales, map, &mut found)?;
    for (name, page) in &pages {
        for sheet in &page.sheets {
            complete(table, name, &scales[sheet.scale], sheet)?;
        }
    }
    let people = people(table, map)?;
    let bots = if table.has("participant._is_bot") {
        table.text("participant._is_bot")?
    } else {
        vec![None; table.rows()]
    };
    let mut bots_left_out = 0;
    for row in 0..table.rows() {
        if bots[row]
            .as_deref()
            .is_some_and(|b| matches!(b.trim(), "1" | "True" | "true"))
        {
            bots_left_out += 1;
            continue;
        }
        let place = format!("row {}", row + 1);
        let text = people[row].as_deref().unwrap_or_default();
        let mut sheets = Vec::new();
        for (name, page) in &pages {
            for sheet in &page.sheets {
                // A page that the person never reached is empty throughout.
                if sheet
                    .columns
                    .values()
                    .any(|(_, cells)| filled(cells[row].as_deref()))
                {
                    sheets.push((name, page, sheet));
                }
            }
        }
        if sheets.is_empty() {
            found.warnings.push(format!(
                "{place} (participant `{text}`) has no answers: left out"
            ));
            continue;
        }
        let id = participant(table.path(), &place, text)?;
        for (name, page, sheet) in sheets {
            let scale = &scales[sheet.scale];
            let moment = match &page.moment {
                None => Moment::Pre,
                Some((column, cells)) => {
                    let word = cells[row].as_deref().unwrap_or_default();
                    map.moment_of(word)
                        .map_err(|expected| table.bad_cell(row, column, word, expected))?
                }
            };
            for (item, (column, cells)) in &sheet.columns {
                let cell = cells[row].as_deref().unwrap_or_default();
                let answer = map.answer_of(scale, cell, 0).map_err(|said| {
                    let id = &scale.id;
                    let who = &people[row].clone().unwrap_or_default();
                    StudyError::file(
                        table.path(),
                        format!("participant {who} ({moment}), scale `{id}`, item {item} ({place}, column `{column}`): {said}"),
                    )
                })?;
                found.rows.push(Row {
                    participant: id.clone(),
                    moment,
                    scale: sheet.scale,
                    item: *item,
                    answer,
                    seconds: None,
                    place: format!("{place} of `{name}`"),
                });
            }
        }
    }
    if bots_left_out > 0 {
        found
            .warnings
            .push(format!("{bots_left_out} rows of bots: left out"));
    }
    Ok(found)
}

fn filled(cell: Option<&str>) -> bool {
    cell.is_some_and(|c| !c.trim().is_empty())
}

/// The columns by page; what belongs to no scale is noted.
fn pages(
    table: &Table,
    scales: &[Scale],
    map: &ColumnMap,
    found: &mut Found,
) -> Result<BTreeMap<String, Page>, StudyError> {
    let mut pages: BTreeMap<String, Page> = BTreeMap::new();
    for column in table.columns() {
        let (page, field) = column.rsplit_once('.').unwrap_or(("", &column));
        if let Some((scale, item)) = map.item_of(scales, field) {
            let cells = table.text(&column)?;
            let sheets = &mut pages.entry(page.to_owned()).or_default().sheets;
            let known = sheets.iter().position(|s| s.scale == scale);
            let position = known.unwrap_or(sheets.len());
            if known.is_none() {
                sheets.push(Sheet {
                    scale,
                    columns: BTreeMap::new(),
                });
            }
            let before = sheets[position]
                .columns
                .insert(item, (column.clone(), cells));
            if let Some((before, _)) = before {
                let id = &scales[scale].id;
                return Err(StudyError::file(
                    table.path(),
                    format!("scale `{id}`, item {item}: both `{before}` and `{column}` hold it"),
                ));
            }
        } else if map.moment_fields().contains(&field) {
            let cells = table.text(&column)?;
            pages.entry(page.to_owned()).or_default().moment = Some((column.clone(), cells));
        } else {
            found.unused.insert(column);
        }
    }
    Ok(pages)
}

/// Whether every item of a scale has a column, and no column an item that the scale lacks.
fn complete(table: &Table, page: &str, scale: &Scale, sheet: &Sheet) -> Result<(), StudyError> {
    let id = &scale.id;
    let bad = |problem| Err(StudyError::file(table.path(), problem));
    if let Some((item, (column, _))) = sheet
        .columns
        .iter()
        .find(|(i, _)| !(1..=scale.items).contains(*i))
    {
        let items = scale.items;
        return bad(format!(
            "column `{column}`: scale `{id}`: item {item} is not among its {items} items"
        ));
    }
    let missing: Vec<String> = (1..=scale.items)
        .filter(|i| !sheet.columns.contains_key(i))
        .map(|i| i.to_string())
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    bad(format!(
        "scale `{id}`: `{page}` has no column for items {}",
        missing.join(", ")
    ))
}

/// Whose row it is.
fn people(table: &Table, map: &ColumnMap) -> Result<Cells, StudyError> {
    let column = people_column(table, map);
    table.text(column.as_deref().unwrap_or("participant.label"))
}

/// The column that says whose each row is: the map's, else oTree's label where anybody has one, else its code.
pub(super) fn people_column(table: &Table, map: &ColumnMap) -> Option<String> {
    let any = |column: &&str| {
        let cells = table.text(column).unwrap_or_default();
        cells.iter().any(|c| filled(c.as_deref()))
    };
    map.participant.clone().or_else(|| {
        let known = ["participant.label", "participant.code", "participant"];
        known.iter().find(|c| any(c)).map(|c| (*c).to_owned())
    })
}

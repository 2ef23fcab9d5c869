//! What the columns of a table hold, page by page, and what is missing or unclear about them.

use super::{
    alike,
    columns::{Columns, Slot, When},
    formats::Format,
    grid::Grid,
    pattern::Pattern,
    sheets::Contents,
};
use crate::error::StudyError;
use maveric_domain::{Moment, Scale};
use std::collections::{BTreeMap, BTreeSet};

pub(super) struct ItemColumn {
    pub(super) slot: Slot,
    pub(super) column: usize,
}

/// What is asked on one page.
#[derive(Default)]
pub(super) struct PageColumns {
    /// The column that says when.
    pub(super) moment: Option<usize>,
    pub(super) items: Vec<ItemColumn>,
}

impl PageColumns {
    /// Whether nothing says when some of it was answered.
    fn is_unsaid(&self) -> bool {
        let mut items = self.items.iter();
        self.moment.is_none() && items.any(|item| item.slot.when == When::Unsaid)
    }
}

/// The columns by page; what belongs to no scale is noted.
///
/// # Errors
/// [`StudyError::BadFile`] for two columns of one item, items without a column, conditions that no column has, and answers of which it is not
/// said when they were given; [`StudyError::NoColumn`] for the map's `moment`.
pub(super) fn pages<'g>(
    grid: &'g Grid,
    format: &Format,
    columns: &Columns<'_>,
    contents: &mut Contents,
) -> Result<BTreeMap<&'g str, PageColumns>, StudyError> {
    let mut pages: BTreeMap<&str, PageColumns> = BTreeMap::new();
    let mut strangers: BTreeMap<&str, usize> = BTreeMap::new();
    let says_when = |name: &str| columns.moment_fields().contains(&name);
    let names = grid.columns.iter().map(|whole| first_of_two(grid, whole));
    let fields = names.map(|name| format.field_of(name));
    let dated: BTreeSet<&str> =
        fields.filter_map(|(page, field)| says_when(field).then_some(page)).collect();
    let mut everywhere = None;
    for (column, whole) in grid.columns.iter().enumerate() {
        let name = first_of_two(grid, whole);
        let (page, field) = format.field_of(name);
        let (page, slot) = match columns.slot_of(name).filter(|_| !page.is_empty()) {
            Some(Ok(slot)) => {
                let is_dated = slot.when == When::Unsaid && dated.contains(page);
                (if is_dated { page } else { "" }, Some(Ok(slot)))
            }
            by_name => (page, columns.slot_of(field).or(by_name)),
        };
        match slot {
            Some(Ok(slot)) => {
                let page_columns = pages.entry(page).or_default();
                let same = |item: &&ItemColumn| item.slot == slot;
                if let Some(before) = page_columns.items.iter().find(same) {
                    let problem = format!(
                        "scale `{}`, item {}: both `{}` and `{whole}` hold it",
                        columns.scales[slot.scale].id, slot.item, grid.columns[before.column]
                    );
                    return Err(StudyError::file(grid.path(), problem));
                }
                page_columns.items.push(ItemColumn { slot, column });
                continue;
            }
            Some(Err(word)) => *strangers.entry(word).or_default() += 1,
            None if says_when(field) || says_when(name) => {
                pages.entry(page).or_default().moment = Some(column);
                if columns.map.moment.as_deref() == Some(name) {
                    everywhere = Some(column);
                }
                continue;
            }
            None => (),
        }
        contents.unused.insert(whole.clone());
    }
    // What the map names whole holds for every page that has none of its own.
    for page in pages.values_mut() {
        page.moment = page.moment.or(everywhere);
    }
    let is_said = pages.values().any(|page| page.moment.is_some());
    if let Some(named) = columns.map.moment.as_ref().filter(|_| !is_said) {
        let there = grid.columns.clone();
        return Err(StudyError::no_column(grid.path(), named, there));
    }
    contents.warnings.extend(unread(columns, &contents.unused));
    pages.retain(|_, page_columns| !page_columns.items.is_empty());
    complete(grid, columns, &pages)?;
    conditions_named(grid, columns, &pages, &strangers, &mut contents.warnings)?;
    if let Some(name) = format.questionnaire {
        by_questionnaire(grid, name, columns, &mut pages, &mut contents.warnings)?;
    }
    let mut scales = BTreeSet::new();
    for (name, page) in pages.iter().filter(|(_, page)| page.is_unsaid()) {
        if let Some(word) = columns.condition_in(name) {
            contents.warnings.push(format!(
                "`{name}` has `{word}` in its name, and nothing says when what is asked there was answered: it counts as from before the drives; `{{condition}}` in the map of columns, where the word stands in `column`, says it"
            ));
        }
        let unsaid = page.items.iter().map(|item| item.slot);
        let unsaid = unsaid.filter(|slot| slot.when == When::Unsaid);
        scales.extend(unsaid.map(|slot| slot.scale));
    }
    alike::refuse(grid, format, columns, &scales, &contents.unused)?;
    Ok(pages)
}

/// The scales whose columns are there as they are called by convention too, and were not read because a pattern calls them otherwise.
fn unread(columns: &Columns<'_>, unused: &BTreeSet<String>) -> Vec<String> {
    let warning = |scale: &Scale| {
        let (id, count, pattern) = (&scale.id, scale.count(), columns.pattern_of(scale));
        let is_there = |item: u32| unused.contains(&format!("{id}_{item}"));
        (1..=count).all(is_there).then(|| {
            format!(
                "scale `{id}`: `{id}_1` to `{id}_{count}` were not read: its columns are called `{pattern}` by the map of columns or its file, and one pattern reads all"
            )
        })
    };
    columns.scales.iter().filter_map(warning).collect()
}

/// The name that a column was given before its number was put behind it: of two of one name both say the same.
fn first_of_two<'n>(grid: &Grid, name: &'n str) -> &'n str {
    let before = name.rsplit_once(" (column ").map(|(before, _)| before);
    before.filter(|before| grid.position(before).is_some()).unwrap_or(name)
}

/// Whether every item of a scale has a column wherever it is asked.
fn complete(
    grid: &Grid,
    columns: &Columns<'_>,
    pages: &BTreeMap<&str, PageColumns>,
) -> Result<(), StudyError> {
    let bad = |problem| Err(StudyError::file(grid.path(), problem));
    for (page, page_columns) in pages {
        let mut sheets: BTreeMap<(usize, When), Vec<&ItemColumn>> = BTreeMap::new();
        for item in &page_columns.items {
            let sheet = (item.slot.scale, item.slot.when);
            sheets.entry(sheet).or_default().push(item);
        }
        for ((scale, _), sheet) in sheets {
            let scale = &columns.scales[scale];
            let has = |item: &u32| sheet.iter().any(|other| other.slot.item == *item);
            let missing = (1..=scale.count()).filter(|item| !has(item));
            let missing: Vec<String> = missing.map(|item| item.to_string()).collect();
            if !missing.is_empty() {
                let beside = match sheet.first() {
                    Some(first) if page.is_empty() => {
                        format!("beside `{}`, the table", grid.columns[first.column])
                    }
                    _ => format!("`{page}`"),
                };
                let (id, missing) = (&scale.id, missing.join(", "));
                return bad(format!("scale `{id}`: {beside} has no column for items {missing}"));
            }
        }
    }
    Ok(())
}

/// Whether the names of columns have the conditions that the map gives words for; which of the design's they do not have, and which words
/// mean none, is said.
fn conditions_named(
    grid: &Grid,
    columns: &Columns<'_>,
    pages: &BTreeMap<&str, PageColumns>,
    strangers: &BTreeMap<&str, usize>,
    warnings: &mut Vec<String>,
) -> Result<(), StudyError> {
    if !columns.patterns().any(Pattern::names_a_moment) {
        return Ok(());
    }
    let items = pages.values().flat_map(|page| &page.items);
    let named: BTreeSet<Moment> = items
        .filter_map(|item| match item.slot.when {
            When::Known(moment) => Some(moment),
            _ => None,
        })
        .collect();
    let others: Vec<&str> = strangers.keys().copied().collect();
    let others = others.join("`, `");
    if named.is_empty() && !others.is_empty() {
        let known: Vec<&str> = columns.words().collect();
        let problem = format!(
            "no column names a condition of the study: where one stands, there are `{others}`, expected {}",
            known.join(", ")
        );
        let help = "say in the map of columns what each means, under [moments]";
        return Err(StudyError::file(grid.path(), problem).with_help(help));
    }
    let field_says = pages.values().any(|page| page.moment.is_some());
    let mut words = columns.map.moments.iter();
    if let Some((word, _)) = words.find(|(_, moment)| !named.contains(moment) && !field_says) {
        let instead = if others.is_empty() {
            String::new()
        } else {
            format!("; where a condition stands, other columns have `{others}`")
        };
        let problem = format!(
            "no column has `{word}`, for which [moments] of the map of columns has a meaning{instead}"
        );
        return Err(StudyError::file(grid.path(), problem));
    }
    if !others.is_empty() {
        let n: usize = strangers.values().sum();
        warnings.push(format!(
            "{n} columns not read: `{others}`, where a condition stands in their names, means none; [moments] of the map of columns can say what it means"
        ));
    }
    Ok(())
}

/// Takes the moment from the column that says which of several questionnaires a row answers, where nothing else says it.
fn by_questionnaire(
    grid: &Grid,
    name: &str,
    columns: &Columns<'_>,
    pages: &mut BTreeMap<&str, PageColumns>,
    warnings: &mut Vec<String>,
) -> Result<(), StudyError> {
    let Some(column) = grid.position(name) else {
        return Ok(());
    };
    let words: BTreeSet<&str> = grid.filled(column).collect();
    if words.is_empty() || !pages.values().any(PageColumns::is_unsaid) {
        return Ok(());
    }
    if let Some(word) = words.iter().find(|word| columns.moment_by_word(word).is_none()) {
        if words.len() == 1 {
            warnings.push(format!(
                "column `{name}` has `{word}` alone, which means no moment: these answers count as from before the drives; [moments] of the map of columns can say what it means"
            ));
            return Ok(());
        }
        let words: Vec<&str> = words.iter().copied().collect();
        let problem = format!(
            "column `{name}` has {}, and `{word}` is no condition: it is not said when these questionnaires were answered",
            words.join(", ")
        );
        let help = format!(
            "say it in the map of columns: [moments] {word} = \"pre\", or a condition; or name another column by `moment`"
        );
        return Err(StudyError::file(grid.path(), problem).with_help(help));
    }
    for page in pages.values_mut().filter(|page| page.is_unsaid()) {
        page.moment = Some(column);
    }
    Ok(())
}

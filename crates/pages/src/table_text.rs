//! A table as a text: title, columns and notes are templates, and each column says what of a row it shows.

use crate::texts::{environment, failed};
use maveric_report::{
    ReportError, apa,
    tables::{Align, Cell, Column, Data, Table},
};
use minijinja::{Environment, Value, context};
use serde::Deserialize;

/// A table of a file of texts.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TableText {
    /// Stem of its files and its anchor, where it is not its key.
    name: Option<String>,
    title: String,
    columns: Vec<ColumnText>,
    /// What a row is of, for the table for machines: an expression of ids. Without it there is none.
    id: Option<String>,
    /// What stands below; a note that comes out empty is left out.
    #[serde(default)]
    notes: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ColumnText {
    /// Its head where it is shown; a column without one is for machines alone.
    head: Option<String>,
    /// Its head for machines; a column without one is shown alone.
    key: Option<String>,
    /// An expression over a row.
    value: String,
    #[serde(default)]
    show: Show,
    decimals: Option<Decimals>,
    /// The unit of its numbers, an expression over a row; a share has one without.
    unit: Option<String>,
    side: Option<Align>,
    /// An expression over the page's values and `rows`: without it the column is always there.
    when: Option<String>,
    /// A list of the page's values: a column for each of its members, which `value` and `head` call `each`, by its place `at`.
    each: Option<String>,
}

/// Decimals of a column, or an expression over a row.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Decimals {
    Fixed(usize),
    Of(String),
}

/// How a column shows its values; where there is none its cell is missing.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Show {
    /// Any text, taken as it is.
    #[default]
    Text,
    Marked,
    Count,
    Number,
    /// A number, or a text that says why there is none.
    NumberOrText,
    Bounded,
    /// A share of 0 to 1, times 100.
    Percent,
    P,
    /// Numbers: their mean and, in brackets, the lowest and the highest.
    Range,
    /// The same of shares, times 100.
    PercentRange,
}

impl TableText {
    /// The table of these rows.
    #[expect(clippy::needless_pass_by_value, reason = "rows are made for their table")]
    pub(crate) fn table(
        &self,
        place: &str,
        key: &str,
        rows: Vec<Value>,
        page: &Value,
    ) -> Result<Table, ReportError> {
        let environment = environment();
        let page = &context! { rows => rows.clone(), ..page.clone() };
        let failure = |e: minijinja::Error| failed(format!("{place}: {e:#}"));
        let say =
            |text: &str, values: &Value| environment.render_str(text, values).map_err(failure);
        let mut notes = Vec::new();
        for note in &self.notes {
            notes.extend(Some(say(note, page)?).filter(|note| !note.is_empty()));
        }
        let mut table = Table {
            name: self.name.as_deref().map_or_else(|| Ok(key.to_owned()), |n| say(n, page))?,
            title: say(&self.title, page)?,
            columns: Vec::new(),
            rows: vec![Vec::new(); rows.len()],
            notes,
            data: None,
        };
        let mut data = Data {
            heads: Vec::new(),
            ids: Vec::new(),
            rows: vec![Vec::new(); rows.len()],
            units: vec![Vec::new(); rows.len()],
        };
        if let Some(id) = &self.id {
            let id = environment.compile_expression(id).map_err(failure)?;
            let ids = rows.iter().map(|row| Ok(id.eval(row.clone())?.to_string()));
            data.ids = ids.collect::<Result<_, minijinja::Error>>().map_err(failure)?;
        }
        for column in &self.columns {
            for values in column.copies(&environment, page).map_err(failure)? {
                let head = column.head.as_deref().map(|head| say(head, &values)).transpose()?;
                let expression = environment.compile_expression(&column.value).map_err(failure)?;
                for (at, row) in rows.iter().enumerate() {
                    let row = context! { ..row.clone(), ..values.clone() };
                    let value = expression.eval(row.clone());
                    let cell = value.and_then(|value| {
                        column.cell(&value, column.decimals(&environment, row.clone())?)
                    });
                    let named = head.as_deref().or(column.key.as_deref()).unwrap_or_default();
                    let cell = cell.map_err(|e| failed(format!("{place}, {named}: {e:#}")))?;
                    if column.key.is_some() {
                        data.rows[at].push(cell.clone());
                        data.units[at].push(column.unit(&environment, row).map_err(failure)?);
                    }
                    if head.is_some() {
                        table.rows[at].push(cell);
                    }
                }
                data.heads.extend(column.key.clone());
                table.columns.extend(head.map(|header| Column { header, align: column.align() }));
            }
        }
        table.data = self.id.is_some().then_some(data);
        Ok(table)
    }

    /// Whether its texts are templates and its values expressions.
    #[cfg(test)]
    pub(crate) fn check(&self) -> Result<(), minijinja::Error> {
        let environment = environment();
        let heads = self.columns.iter().filter_map(|c| c.head.as_ref());
        for text in heads.chain(&self.notes).chain(&self.name).chain([&self.title]) {
            environment.template_from_str(text)?;
        }
        for column in &self.columns {
            for text in [&column.when, &column.each, &column.unit]
                .into_iter()
                .flatten()
                .chain([&column.value])
            {
                environment.compile_expression(text)?;
            }
        }
        Ok(())
    }
}

impl ColumnText {
    fn align(&self) -> Align {
        self.side.unwrap_or(match self.show {
            Show::Text | Show::Marked => Align::Left,
            _ => Align::Right,
        })
    }

    /// The values with which the column is written: none where it is not wanted, once for each member of its list.
    fn copies(
        &self,
        environment: &Environment<'_>,
        page: &Value,
    ) -> Result<Vec<Value>, minijinja::Error> {
        let eval = |text: &String| environment.compile_expression(text)?.eval(page.clone());
        if let Some(when) = &self.when
            && !eval(when)?.is_true()
        {
            return Ok(Vec::new());
        }
        let Some(each) = &self.each else {
            return Ok(vec![page.clone()]);
        };
        let members = eval(each)?.try_iter()?.enumerate();
        Ok(members.map(|(at, each)| context! { at, each, ..page.clone() }).collect())
    }

    fn decimals(
        &self,
        environment: &Environment<'_>,
        row: Value,
    ) -> Result<usize, minijinja::Error> {
        match &self.decimals {
            None => Ok(2),
            Some(Decimals::Fixed(decimals)) => Ok(*decimals),
            Some(Decimals::Of(text)) => environment.compile_expression(text)?.eval(row)?.try_into(),
        }
    }

    fn unit(&self, environment: &Environment<'_>, row: Value) -> Result<String, minijinja::Error> {
        let Some(unit) = &self.unit else {
            let is_share = matches!(self.show, Show::Percent | Show::PercentRange);
            return Ok(if is_share { "%" } else { "" }.to_owned());
        };
        let found = environment.compile_expression(unit)?.eval(row)?;
        if found.is_undefined() {
            return Err(undefined(unit));
        }
        Ok(if found.is_none() { String::new() } else { found.to_string() })
    }

    fn cell(&self, found: &Value, decimals: usize) -> Result<Cell, minijinja::Error> {
        if found.is_undefined() {
            return Err(undefined(&self.value));
        }
        if found.is_none() {
            return Ok(Cell::Missing);
        }
        let number = |factor: f64| f64::try_from(found.clone()).map(|number| factor * number);
        Ok(match self.show {
            Show::Text => Cell::Text(found.to_string()),
            Show::Marked => Cell::Marked(found.to_string()),
            Show::Count => Cell::number(Some(number(1.0)?), 0),
            Show::NumberOrText if found.as_str().is_some() => Cell::Text(found.to_string()),
            Show::Number | Show::NumberOrText => Cell::number(Some(number(1.0)?), decimals),
            Show::Percent => Cell::number(Some(number(100.0)?), decimals),
            Show::Bounded => Cell::bounded(Some(number(1.0)?), decimals),
            Show::P => Cell::P(number(1.0)?),
            Show::Range => range(found, 1.0, decimals)?,
            Show::PercentRange => range(found, 100.0, decimals)?,
        })
    }
}

fn undefined(expression: &str) -> minijinja::Error {
    let text = format!("`{expression}` is not given");
    minijinja::Error::new(minijinja::ErrorKind::UndefinedError, text)
}

/// Mean of the numbers that are there and, in brackets, the lowest and the highest where they differ.
fn range(found: &Value, factor: f64, decimals: usize) -> Result<Cell, minijinja::Error> {
    let mut values: Vec<f64> = Vec::new();
    for value in found.try_iter()? {
        if value.is_undefined() {
            return Err(undefined("a member of the list"));
        }
        if !value.is_none() {
            values.push(factor * f64::try_from(value)?);
        }
    }
    if values.is_empty() {
        return Ok(Cell::Missing);
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if high - low < 1e-9 {
        return Ok(Cell::number(Some(mean), decimals));
    }
    let [mean, low, high] = [mean, low, high].map(|value| apa::number(value, decimals));
    Ok(Cell::text(format!("{mean} ({low} to {high})")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(columns: &str) -> Result<Table, ReportError> {
        let text = format!(
            "title = \"{{{{ n }}}} rows\"\ncolumns = [{columns}]\nnotes = [\"\", \"{{{{ n }}}}\"]"
        );
        let text: TableText = toml::from_str(&text).unwrap();
        let rows = vec![
            context! { name => "a*b", r => 0.456, all => vec![Some(0.5), None, Some(0.7)] },
            context! { name => "c", r => None::<f64>, all => vec![Some(0.5)] },
        ];
        let page = context! { n => 2, twice => false, of => vec!["x", "y"] };
        text.table("t.toml, table.t", "t", rows, &page)
    }

    #[test]
    fn columns_show_what_they_say_and_nothing_where_there_is_no_value() {
        let made = table(
            "{ head = \"Who\", value = \"name\" }, { head = \"*r*\", value = \"r\", show = \"bounded\" }, \
             { head = \"%\", value = \"r\", show = \"percent\", decimals = 1 }, { head = \"All\", value = \"all\", show = \"range\" }, \
             { head = \"Again\", value = \"name\", when = \"twice\" }, { head = \"{{ each }}\", value = \"at\", show = \"count\", each = \"of\" }",
        )
        .unwrap();
        let heads: Vec<&str> = made.columns.iter().map(|c| c.header.as_str()).collect();
        assert_eq!(heads, ["Who", "*r*", "%", "All", "x", "y"]);
        assert_eq!(made.title, "2 rows");
        assert_eq!(made.notes, ["2"]);
        assert_eq!(made.rows[0][0], Cell::text("a*b"));
        assert_eq!(made.rows[0][1], Cell::bounded(Some(0.456), 2));
        assert_eq!(made.rows[0][2], Cell::number(Some(45.6), 1));
        assert_eq!(made.rows[0][3], Cell::text("0.60 (0.50 to 0.70)"));
        assert_eq!(made.rows[0][5], Cell::count(1));
        assert_eq!(made.rows[1][1], Cell::Missing);
        assert_eq!(made.rows[1][3], Cell::number(Some(0.5), 2));
        made.check().unwrap();
    }

    #[test]
    fn columns_with_a_key_stand_in_the_table_for_machines_by_the_id_of_their_row() {
        let text = "title = \"t\"\nid = \"name ~ '.x'\"\ncolumns = [{ head = \"Who\", key = \"who\", value = \"name\" }, \
                    { head = \"Shown\", value = \"name\" }, { key = \"r\", value = \"r\", show = \"bounded\", unit = \"of\" }]";
        let text: TableText = toml::from_str(text).unwrap();
        let rows = vec![context! { name => "a", r => 0.5, of => "km/h" }];
        let made = text.table("t", "t", rows, &context! {}).unwrap();
        assert_eq!(made.columns.len(), 2);
        let data = made.data.unwrap();
        assert_eq!(
            (data.heads, data.ids),
            (vec!["who".to_owned(), "r".to_owned()], vec!["a.x".to_owned()])
        );
        assert_eq!(data.rows, [[Cell::text("a"), Cell::bounded(Some(0.5), 2)]]);
        assert_eq!(data.units, [["", "km/h"]]);
    }

    #[test]
    fn a_value_that_no_row_has_and_a_word_for_a_number_are_refused_by_place_and_head() {
        let error = table("{ head = \"Who\", value = \"nobody\" }").unwrap_err().to_string();
        assert!(error.contains("t.toml, table.t, Who") && error.contains("nobody"), "{error}");
        let error = table("{ head = \"Who\", value = \"name\", show = \"number\" }");
        assert!(error.unwrap_err().to_string().contains("table.t, Who"));
    }
}

//! Every number of a page under a name that a paper can use: made of ids, so that a label may change.

use maveric_report::{
    Card, apa, markup,
    tables::{Cell, Table, latex},
};
use std::{collections::BTreeMap, fmt::Write as _};

/// A number, or an answer, under its name.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Named {
    /// Letters alone: the macro without its backslash.
    name: String,
    value: Option<f64>,
    /// As the page shows it, with marks.
    shown: String,
    /// Where it stands: table or card, row, column.
    place: [String; 3],
    /// Empty where it has none.
    unit: String,
}

/// Letters alone, each word with a large first letter; digits are spelled, and so are the signs between words if they are `told` apart.
fn camel(text: &str, told: bool) -> String {
    const DIGITS: [&str; 10] =
        ["Zero", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine"];
    let mut out = String::new();
    let mut start = true;
    for sign in text.chars() {
        if let Some(digit) = sign.to_digit(10) {
            out.push_str(DIGITS[digit as usize]);
            start = true;
        } else if sign.is_ascii_alphabetic() {
            let capital = sign.to_ascii_uppercase();
            out.push(if start { capital } else { sign });
            start = false;
        } else {
            let spelled = match sign {
                '-' => "Hyphen",
                '_' => "Underscore",
                '.' => "Dot",
                _ => "Sign",
            };
            out.push_str(if told { spelled } else { "" });
            start = true;
        }
    }
    out
}

/// Small at its start, as commands of LaTeX are.
fn macro_of(place: &[String; 3], told: bool) -> String {
    let name: String = place.iter().map(|part| camel(part, told)).collect();
    let mut letters = name.chars();
    let first = letters.next().map(|first| first.to_ascii_lowercase());
    first.into_iter().chain(letters).collect()
}

/// The answers of the cards, and every number of the tables for machines.
pub(crate) fn numbers<'a>(cards: &[Card], tables: impl Iterator<Item = &'a Table>) -> Vec<Named> {
    let mut named = Vec::new();
    let mut add = |place: [&str; 3], value: Option<f64>, shown: String, unit: &str| {
        named.push(Named {
            name: String::new(),
            value,
            shown,
            place: place.map(str::to_owned),
            unit: unit.to_owned(),
        });
    };
    for card in cards {
        let mut part = |part: &str, shown: &str| {
            add(["card", &card.name, part], None, shown.to_owned(), "");
        };
        part("answer", &card.answer);
        part("verdict", &card.verdict);
        if let Some(number) = &card.number {
            part("number", &number.value);
            part("floor", &number.floor);
            part("ceiling", &number.ceiling);
        }
    }
    for table in tables {
        let Some(data) = &table.data else { continue };
        for (at, (id, cells)) in data.ids.iter().zip(&data.rows).enumerate() {
            for (column, (head, cell)) in data.heads.iter().zip(cells).enumerate() {
                let (value, shown) = match cell {
                    // In a sentence a p has its sign before it.
                    Cell::P(p) => (*p, apa::p_cell(*p)),
                    Cell::Number { value, .. } | Cell::Bounded { value, .. } => {
                        (*value, cell.marked())
                    }
                    _ => continue,
                };
                let unit = data.units.get(at).and_then(|units| units.get(column));
                let unit = unit.map_or("", String::as_str);
                add([&table.name, id, head], Some(value), shown, unit);
            }
        }
    }
    let mut times: BTreeMap<String, usize> = BTreeMap::new();
    for number in &named {
        *times.entry(macro_of(&number.place, false)).or_default() += 1;
    }
    for number in &mut named {
        let name = macro_of(&number.place, false);
        let twice = times.get(&name).is_some_and(|n| *n > 1);
        number.name = macro_of(&number.place, twice);
    }
    named
}

pub(crate) fn tex(named: &[Named]) -> String {
    let mut out = String::from(
        "% Every number of the page, as a macro named by ids; made anew with the page.\n",
    );
    for number in named {
        let place = number.place.join("; ").replace(['\n', '\r'], " ");
        let shown = latex(&number.shown);
        let _ = writeln!(out, "\\newcommand{{\\{}}}{{{shown}}} % {place}", number.name);
    }
    out
}

/// A row a number: `name,value,shown,table,row,column,unit`.
pub(crate) fn csv(named: &[Named]) -> String {
    let field = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let mut out = String::from("name,value,shown,table,row,column,unit\r\n");
    for n in named {
        let value = n.value.map(|v| v.to_string()).unwrap_or_default();
        let [table, row, column] = n.place.each_ref().map(|p| field(p));
        let shown = field(&markup::plain(&n.shown));
        let unit = field(&n.unit);
        let _ = write!(out, "{},{value},{shown},{table},{row},{column},{unit}\r\n", n.name);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_report::tables::Data;

    fn table(ids: [&str; 2]) -> Table {
        let row = |p| vec![Cell::text("x"), Cell::number(Some(61.234), 2), Cell::P(p)];
        Table {
            data: Some(Data {
                heads: ["outcome", "mean_2", "p"].map(str::to_owned).to_vec(),
                ids: ids.map(str::to_owned).to_vec(),
                rows: vec![row(0.0004), row(0.5)],
                units: vec![["", "km/h", ""].map(str::to_owned).to_vec(); 2],
            }),
            ..Table::of::<()>("omnibus", "Whatever it is called", []).done()
        }
    }

    fn names(named: &[Named]) -> Vec<&str> {
        named.iter().map(|n| n.name.as_str()).collect()
    }

    #[test]
    fn a_number_is_named_by_table_row_and_column_and_a_word_is_no_number() {
        let found = numbers(&[], [table(["speed.calm", "speed.sporty"])].iter());
        assert_eq!(
            names(&found),
            [
                "omnibusSpeedCalmMeanTwo",
                "omnibusSpeedCalmP",
                "omnibusSpeedSportyMeanTwo",
                "omnibusSpeedSportyP"
            ]
        );
        let tex = tex(&found);
        assert!(
            tex.contains(
                "\\newcommand{\\omnibusSpeedCalmMeanTwo}{61.23} % omnibus; speed.calm; mean_2"
            ),
            "{tex}"
        );
        assert!(tex.contains("{\\textless{} .001}"), "{tex}");
        let csv = csv(&found);
        let row = "omnibusSpeedCalmMeanTwo,61.234,\"61.23\",\"omnibus\",\"speed.calm\",\"mean_2\",\"km/h\"";
        assert!(csv.contains(row), "{csv}");
        assert!(csv.contains("\"speed.calm\",\"p\",\"\"\r\n"), "{csv}");
    }

    #[test]
    fn ids_that_read_alike_have_names_of_their_own_and_nothing_is_counted() {
        let found = numbers(&[], [table(["a_b", "a-b"])].iter());
        let mut names = names(&found);
        assert_eq!(names[0], "omnibusAUnderscoreBMeanUnderscoreTwo");
        assert_eq!(names[2], "omnibusAHyphenBMeanUnderscoreTwo");
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), 4);
    }
}

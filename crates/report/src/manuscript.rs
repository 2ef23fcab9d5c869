//! What a paper is written from: every number as a named macro, the answers as sentences, methods, references.

use crate::html::{Manuscript, Report};
use crate::markup;
use crate::tables::{Align, Cell, Table, latex, markdown};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// A number of the page under a name that a paper can use.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NamedNumber {
    /// Letters alone: the macro without its backslash.
    pub(crate) name: String,
    /// In full precision, of a cell that holds one number.
    pub(crate) value: Option<f64>,
    /// As the page shows it, with marks.
    pub(crate) shown: String,
    /// Where it stands: table or card, row, column. Plain text.
    pub(crate) place: [String; 3],
}

/// Letters alone, each word with a large first letter; digits and `%` are spelled out.
fn camel(text: &str) -> String {
    const DIGITS: [&str; 10] = [
        "Zero", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine",
    ];
    let mut out = String::new();
    let mut start = true;
    for sign in markup::plain(text).chars() {
        let greek = match sign {
            'α' => "Alpha",
            'ω' => "Omega",
            'ρ' => "Rho",
            '%' => "Percent",
            '²' => "Squared",
            _ => "",
        };
        if let Some(digit) = sign.to_digit(10) {
            out.push_str(DIGITS[digit as usize]);
            start = true;
        } else if !greek.is_empty() {
            out.push_str(greek);
            start = true;
        } else if sign.is_ascii_alphabetic() {
            out.push(if start {
                sign.to_ascii_uppercase()
            } else {
                sign
            });
            start = false;
        } else {
            start = true;
        }
    }
    out
}

/// Texts of a row longer than this explain, they do not name.
const LONGEST_NAME: usize = 40;

fn of_table(table: &Table, names: &mut BTreeSet<String>, found: &mut Vec<NamedNumber>) {
    for cells in &table.rows {
        // What stands before the numbers names a row; a verdict behind them does not, for it may change with the data.
        let words = cells.iter().zip(&table.columns);
        let named: Vec<&str> = words
            .take_while(|(cell, _)| matches!(cell, Cell::Text(_)))
            .filter_map(|(cell, column)| match cell {
                Cell::Text(text)
                    if column.align == Align::Left && text.chars().count() <= LONGEST_NAME =>
                {
                    Some(text.as_str())
                }
                _ => None,
            })
            .collect();
        for (cell, column) in cells.iter().zip(&table.columns) {
            let value = match cell {
                Cell::Number { value, .. } | Cell::Bounded { value, .. } | Cell::P(value) => {
                    Some(*value)
                }
                Cell::Marked(text) if text.contains(|sign: char| sign.is_ascii_digit()) => None,
                _ => continue,
            };
            let row: String = named.iter().map(|word| camel(word)).collect();
            found.push(NamedNumber {
                name: once(
                    &format!("{}{row}{}", camel(&table.name), camel(&column.header)),
                    names,
                ),
                value,
                shown: cell.marked(),
                place: [
                    table.name.clone(),
                    named.join(", "),
                    markup::plain(&column.header),
                ],
            });
        }
    }
}

/// The name itself, or with `Again` behind it as often as it was taken.
fn once(wanted: &str, names: &mut BTreeSet<String>) -> String {
    let mut letters = wanted.chars();
    let first = letters.next().unwrap_or('n').to_ascii_lowercase();
    let mut name: String = std::iter::once(first).chain(letters).collect();
    while !names.insert(name.clone()) {
        name.push_str("Again");
    }
    name
}

/// Every number of the cards and tables, each under a name of its own.
pub(crate) fn numbers(report: &Report) -> Vec<NamedNumber> {
    let mut names = BTreeSet::new();
    let mut found = Vec::new();
    for card in &report.cards {
        let mut said = vec![
            ("Answer", card.answer.clone()),
            ("Verdict", card.verdict.clone()),
        ];
        if let Some(number) = &card.number {
            said.push(("Number", number.value.clone()));
            said.push(("Floor", number.floor.clone()));
            said.push(("Ceiling", number.ceiling.clone()));
        }
        said.extend(card.tests.iter().map(|test| ("Test", test.clone())));
        for (part, shown) in said {
            found.push(NamedNumber {
                name: once(&format!("Card{}{part}", camel(&card.name)), &mut names),
                value: None,
                shown,
                place: [
                    format!("card {}", card.name),
                    String::new(),
                    part.to_owned(),
                ],
            });
        }
    }
    for table in report.all_sections().flat_map(|section| &section.tables) {
        of_table(table, &mut names, &mut found);
    }
    found
}

/// `manuscript/`: numbers, results, methods and references, in LaTeX and Markdown.
pub(crate) fn files(report: &Report, manuscript: &Manuscript) -> Vec<(String, String)> {
    let file = |name: &str, text: String| (format!("manuscript/{name}"), text);
    let named = numbers(report);
    vec![
        file("numbers.tex", numbers_tex(&named)),
        file("numbers.csv", numbers_csv(&named)),
        file("results.tex", results(report, true)),
        file("results.md", results(report, false)),
        file("methods.tex", methods(manuscript, true)),
        file("methods.md", methods(manuscript, false)),
        file("references.bib", references(&manuscript.references)),
    ]
}

fn numbers_tex(named: &[NamedNumber]) -> String {
    let mut out =
        String::from("% Every number of the page, as a macro; made anew with the page.\n");
    for number in named {
        let place: Vec<&str> = number
            .place
            .iter()
            .map(String::as_str)
            .filter(|p| !p.is_empty())
            .collect();
        let place = place.join("; ").replace(['\n', '\r'], " ");
        let _ = writeln!(
            out,
            "\\newcommand{{\\{}}}{{{}}} % {place}",
            number.name,
            latex(&number.shown)
        );
    }
    out
}

fn numbers_csv(named: &[NamedNumber]) -> String {
    let field = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let mut out = String::from("name,value,shown,table,row,column\r\n");
    for n in named {
        let value = n.value.map(|v| v.to_string()).unwrap_or_default();
        let [table, row, column] = n.place.each_ref().map(|p| field(p));
        let _ = write!(
            out,
            "{},{value},{},{table},{row},{column}\r\n",
            n.name,
            field(&markup::plain(&n.shown))
        );
    }
    out
}

/// The answers as sentences, each with its verdict, its rule and its tests.
fn results(report: &Report, tex: bool) -> String {
    let write = if tex { latex } else { markdown };
    let mut out = heading("Results", 1, tex);
    for card in &report.cards {
        out += &heading(&write(&markup::literal(&card.question)), 2, tex);
        let _ = write!(
            out,
            "{} ({}).\n\n",
            write(card.answer.trim_end_matches('.')),
            write(&card.verdict)
        );
        if let Some(number) = &card.number {
            let _ = write!(
                out,
                "{}; floor: {}; ceiling: {}.\n\n",
                write(&number.value),
                write(&number.floor),
                write(&number.ceiling)
            );
        }
        if !card.tests.is_empty() {
            let tests: Vec<String> = card.tests.iter().map(|test| write(test)).collect();
            let _ = write!(out, "{}.\n\n", tests.join("; "));
        }
    }
    out
}

fn methods(manuscript: &Manuscript, tex: bool) -> String {
    let write = if tex { latex } else { markdown };
    let mut out = heading("Method", 1, tex);
    for (title, paragraphs) in &manuscript.methods {
        out += &heading(&write(&markup::literal(title)), 2, tex);
        for paragraph in paragraphs {
            let _ = write!(out, "{}\n\n", write(paragraph));
        }
    }
    if !manuscript.references.is_empty() {
        if tex {
            let keys: Vec<&str> = manuscript
                .references
                .iter()
                .map(|(key, _)| key.as_str())
                .collect();
            let _ = writeln!(out, "\\nocite{{{}}}", keys.join(","));
        } else {
            out += &heading("References", 2, tex);
            for (_, reference) in &manuscript.references {
                let _ = write!(out, "{}\n\n", markdown(&markup::literal(reference)));
            }
        }
    }
    out
}

fn heading(text: &str, level: usize, tex: bool) -> String {
    match (tex, level) {
        (true, 1) => format!("\\section{{{text}}}\n\n"),
        (true, _) => format!("\\subsection{{{text}}}\n\n"),
        (false, level) => format!("{} {text}\n\n", "#".repeat(level)),
    }
}

/// An entry a reference. Its text stands whole in `note`: a reference manager takes it apart better than a guess would.
fn references(references: &[(String, String)]) -> String {
    let mut out = String::new();
    for (key, reference) in references {
        let note = latex(&markup::literal(reference));
        let _ = write!(out, "@misc{{{key},\n  note = {{{note}}}\n}}\n\n");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::Context;
    use crate::html::Section;
    use crate::tables::Column;

    fn report() -> Report {
        let row = |measure: &str, value| {
            vec![
                Cell::text(measure),
                Cell::number(Some(value), 2),
                Cell::Marked("*F*(3, 69) = 2.5, *p* = .067".into()),
                Cell::text("not shown"),
            ]
        };
        let table = Table {
            name: "omnibus-2".into(),
            title: "T".into(),
            columns: vec![
                Column::left("Measure"),
                Column::right("95% *M*"),
                Column::left("Test"),
                Column::left("Verdict"),
            ],
            rows: vec![row("Mean velocity", 61.234), row("Mean velocity", 1.0)],
            notes: Vec::new(),
        };
        Report {
            sections: vec![Section {
                title: "One".into(),
                tables: vec![table],
                ..Section::default()
            }],
            ..Report::new("T", "S", &Context::real())
        }
    }

    #[test]
    fn every_number_has_one_name_of_letters_alone() {
        let found = numbers(&report());
        let names: Vec<&str> = found.iter().map(|n| n.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "omnibusTwoMeanVelocityNineFivePercentM",
                "omnibusTwoMeanVelocityTest",
                "omnibusTwoMeanVelocityNineFivePercentMAgain",
                "omnibusTwoMeanVelocityTestAgain"
            ]
        );
        assert!(
            names
                .iter()
                .all(|n| n.chars().all(|c| c.is_ascii_alphabetic()))
        );
        assert_eq!(found[0].value, Some(61.234));
        let tex = numbers_tex(&found);
        assert!(
            tex.contains("\\newcommand{\\omnibusTwoMeanVelocityNineFivePercentM}{61.23}"),
            "{tex}"
        );
        assert!(numbers_csv(&found).contains(",61.234,\"61.23\","));
    }

    #[test]
    fn a_reference_with_signs_of_latex_stays_text() {
        let bib = references(&[("rosas".into(), "A & B_1 (50 %) {x}".into())]);
        assert!(bib.contains("A \\& B\\_1 (50 \\%) \\{x\\}"), "{bib}");
    }
}

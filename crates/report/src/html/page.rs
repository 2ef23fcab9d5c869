//! `index.html`: one file, no script, no network, readable on paper, on a phone and at night.

use super::report::{Report, Section};
use crate::error::ReportError;
use crate::figures::{DARK, Figure, font_face_css, hex};
use crate::markup;
use crate::tables::Table;
use minijinja::{Environment, UndefinedBehavior, Value, context};
use std::fmt::Write as _;

/// Fills in the page.
pub(crate) fn page(
    report: &Report,
    exclusions: &Table,
    ledger: Option<&Table>,
) -> Result<String, ReportError> {
    let mut number = 0;
    let sections: Vec<Value> = report
        .sections
        .iter()
        .map(|section| section_value(section, &mut number))
        .collect();
    let provenance = &report.provenance;
    let inputs: Vec<[String; 2]> = provenance
        .inputs
        .iter()
        .map(|input| [input.path.clone(), input.hash.clone()])
        .collect();
    fill(
        "page.html",
        context! {
            title => &report.title,
            subtitle => &report.subtitle,
            synthetic => report.context.synthetic,
            style => safe(style()),
            summary => report.summary.iter().map(|line| safe(markup::html(line))).collect::<Vec<_>>(),
            sections,
            ledger => ledger.map(table_value),
            exclusions => table_value(exclusions),
            warnings => &report.warnings,
            version => &provenance.version,
            seed => provenance.seed.map(|seed| seed.to_string()),
            command => &provenance.command,
            parameters => &provenance.parameters,
            inputs => &inputs,
        },
    )
}

/// A table as a page of its own.
pub(crate) fn table_page(table: &Table, report: &Report) -> Result<String, ReportError> {
    fill(
        "table.html",
        context! {
            title => markup::plain(&table.title),
            synthetic => report.context.synthetic,
            style => safe(include_str!("templates/page.css").to_owned()),
            table => table_value(table),
        },
    )
}

fn fill(template: &str, values: Value) -> Result<String, ReportError> {
    let failed = |error: minijinja::Error| ReportError::Template {
        reason: format!("{error:#}"),
    };
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    for (name, source) in [
        ("page.html", include_str!("templates/page.html")),
        ("table.html", include_str!("templates/table.html")),
        ("parts.html", include_str!("templates/parts.html")),
    ] {
        environment.add_template(name, source).map_err(failed)?;
    }
    let page = environment
        .get_template(template)
        .and_then(|page| page.render(values))
        .map_err(failed)?;
    // The template's own statements leave empty lines behind.
    let lines = page.lines().filter(|line| !line.trim().is_empty());
    Ok(lines.fold(String::with_capacity(page.len()), |out, line| {
        out + line + "\n"
    }))
}

/// Only what this crate wrote itself, escaped where it was not ours.
fn safe(html: String) -> Value {
    Value::from_safe_string(html)
}

fn section_value(section: &Section, number: &mut usize) -> Value {
    let figures: Vec<Value> = section
        .figures
        .iter()
        .map(|figure| {
            *number += 1;
            figure_value(figure, *number)
        })
        .collect();
    context! {
        title => &section.title,
        intro => section.intro.iter().map(|text| safe(markup::html(text))).collect::<Vec<_>>(),
        figures,
        tables => section.tables.iter().map(table_value).collect::<Vec<_>>(),
    }
}

/// Figures at least so wide, in millimetres, fill the page; on a phone they scroll.
const WIDE_MM: f64 = 150.0;
/// Between one column and that.
const MIDDLE_MM: f64 = 100.0;

fn figure_value(figure: &Figure, number: usize) -> Value {
    let width = figure
        .svg
        .split_once("width=\"")
        .and_then(|(_, rest)| rest.split_once("mm\""))
        .and_then(|(width, _)| width.parse::<f64>().ok())
        .unwrap_or(0.0);
    context! {
        name => &figure.name,
        number,
        title => safe(markup::html(&figure.title)),
        plain_title => markup::plain(&figure.title),
        caption => safe(markup::html(&figure.caption)),
        svg => safe(figure.svg.clone()),
        size => match width {
            width if width >= WIDE_MM => "wide",
            width if width >= MIDDLE_MM => "middle",
            _ => "narrow",
        },
    }
}

fn table_value(table: &Table) -> Value {
    context! {
        name => &table.name,
        title => markup::plain(&table.title),
        html => safe(table.to_html()),
    }
}

/// The page's own rules, the font, and the colours that the figures turn to in the dark.
fn style() -> String {
    let mut out = String::from(font_face_css());
    out.push_str(include_str!("templates/page.css"));
    out.push_str("@media screen and (prefers-color-scheme: dark) {\n");
    for (light, dark) in DARK {
        let light = hex(light);
        let _ = writeln!(
            out,
            "figure svg [fill=\"{light}\"]{{fill:{dark}}} figure svg [stroke=\"{light}\"]{{stroke:{dark}}}"
        );
    }
    out.push_str("}\n");
    out
}

//! `index.html`: one file, no network, readable on paper, on a phone, at night and without scripts.

use super::glossary::explained;
use super::ledger::ledger;
use super::live::{Live, LiveContent, embedded};
use super::player::{PlayerFragment, player};
use super::report::{Report, Section};
use super::scripts;
use super::style::style;
use super::template::{fill, safe};
use crate::card::Card;
use crate::claims::ledger_table;
use crate::error::ReportError;
use crate::figures::Figure;
use crate::markup;
use crate::tables::Table;
use minijinja::{Value, context};
use std::collections::BTreeSet;

/// Rows of a table that the page shows; the files have them all.
const MOST_ROWS: usize = 200;
/// Warnings that the page shows.
const MOST_WARNINGS: usize = 50;

/// Fills in the page.
pub(crate) fn page(
    report: &Report,
    plots: &[Option<Figure>],
    exclusions: &Table,
) -> Result<String, ReportError> {
    let mut number = 0;
    let mut shown = Vec::new();
    for live in &report.live {
        shown.push(Shown::new(live, report)?);
    }
    let mut shown_sections = |sections: &[Section]| -> Vec<Value> {
        let one = |section| section_value(section, &shown, &mut number);
        sections.iter().map(one).collect()
    };
    let sections = shown_sections(&report.sections);
    let supplement = shown_sections(&report.supplement);
    let known = anchors(report);
    let cards = report.cards.iter().zip(plots);
    let cards: Vec<Value> =
        cards.map(|(card, plot)| card_value(card, plot.as_ref(), &known)).collect();
    let provenance = &report.provenance;
    let inputs = provenance.inputs.iter();
    let inputs = inputs.map(|input| [input.path.clone(), input.hash.clone()]);
    let inputs: Vec<[String; 2]> = inputs.collect();
    let mut used = vec![scripts::TABLES, scripts::PANELS];
    used.extend(report.ledger.is_some().then_some(scripts::LEDGER));
    let players = || shown.iter().filter_map(|live| live.player.as_ref());
    used.extend((players().count() < shown.len()).then_some(scripts::SPACE));
    used.extend(players().next().map(|fragment| fragment.script));
    let player_style = players().next().map_or("", |fragment| &fragment.style);
    let used: Vec<String> = used.into_iter().map(scripts::packed).collect();
    let files: Vec<Value> = report
        .methods
        .files
        .iter()
        .map(|file| context! { path => &file.path, text => safe(whole_text(&file.text)) })
        .collect();
    let warnings = report.warnings.iter().take(MOST_WARNINGS).cloned();
    let filled = fill(
        "page.html",
        context! {
            title => &report.title,
            subtitle => &report.subtitle,
            synthetic => report.context.synthetic,
            scripted => report.context.scripted,
            described => described(report),
            style => safe(style(&report.context) + player_style),
            policy => safe(scripts::policy(&used)),
            scripts => used.into_iter().map(safe).collect::<Vec<_>>(),
            summary => marked(&report.summary),
            cards,
            sections,
            supplement,
            ledger => report.ledger.as_ref().map(|rows| ledger(rows, &known)),
            ledger_notes => report.ledger.as_ref().map(|rows| marked(&ledger_table(rows).notes[1..])),
            has_words => !report.glossary.is_empty(),
            has_methods => !(report.methods.text.is_empty() && report.methods.files.is_empty() && provenance.parameters.is_empty()),
            methods => marked(&report.methods.text),
            files,
            exclusions => table_value(exclusions),
            warnings => warnings.collect::<Vec<String>>(),
            more_warnings => report.warnings.len().saturating_sub(MOST_WARNINGS),
            version => &provenance.version,
            seed => provenance.seed.map(|seed| seed.to_string()),
            command => &provenance.command,
            parameters => &provenance.parameters,
            inputs => &inputs,
        },
    )?;
    let (explained, found) = explained(&filled, &report.glossary);
    let words = report.glossary.iter().filter(|(term, _)| found.contains(term.as_str()));
    let words: Vec<String> = words
        .map(|(term, meaning)| {
            format!("<dt>{}</dt><dd>{}</dd>", markup::escape(term), markup::escape(meaning))
        })
        .collect();
    Ok(explained.replacen("<dt>WORDS</dt>", &words.concat(), 1))
}

/// A table as a page of its own, whole.
pub(crate) fn table_page(table: &Table, report: &Report) -> Result<String, ReportError> {
    fill(
        "table.html",
        context! {
            title => markup::plain(&table.title),
            synthetic => report.context.synthetic,
            scripted => report.context.scripted,
            described => described(report),
            style => safe(include_str!("templates/page.css").to_owned()),
            policy => safe(scripts::policy(&[])),
            table => whole_table(table),
        },
    )
}

/// What the file says of itself in its metadata.
fn described(report: &Report) -> String {
    let people = report.context.metadata();
    if people.is_empty() {
        report.subtitle.clone()
    } else {
        format!("{people}. {}", report.subtitle)
    }
}

/// A file's text, its empty lines kept from [`fill`].
fn whole_text(text: &str) -> String {
    let line = |line: &str| match markup::escape(line) {
        line if line.trim().is_empty() => "&#32;".to_owned(),
        line => line,
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

fn marked(texts: &[String]) -> Vec<Value> {
    texts.iter().map(|text| safe(markup::html(text))).collect()
}

/// The ids of figures and tables on the page.
fn anchors(report: &Report) -> BTreeSet<String> {
    let ids = |section: &Section| {
        let figures = section.figures.iter().map(|f| format!("figure-{}", f.name));
        let tables = section.tables.iter().map(|t| format!("table-{}", t.name));
        figures.chain(tables).collect::<Vec<_>>()
    };
    report.all_sections().flat_map(ids).collect()
}

/// A card; it links to what answers its doubt if that is on the page.
fn card_value(card: &Card, plot: Option<&Figure>, anchors: &BTreeSet<String>) -> Value {
    let on_page = |id: &&String| anchors.contains(*id) || FIXED.contains(&id.as_str());
    let number = card.number.as_ref().map(|n| {
        let parts = [&n.value, &n.floor, &n.ceiling];
        parts.map(|part| safe(markup::html(part))).to_vec()
    });
    context! {
        name => &card.name,
        question => &card.question,
        answer => safe(markup::html(&card.answer)),
        tone => card.tone.class(),
        verdict => &card.verdict,
        rule => safe(markup::html(&card.rule)),
        number,
        svg => plot.map(|p| safe(p.svg.clone())),
        key => card.plot.as_ref().map(|p| safe(markup::html(&p.key()))),
        doubt => safe(markup::html(&card.doubt)),
        see => card.see.as_ref().filter(on_page),
        tests => marked(&card.tests),
    }
}

/// Anchors that every page has.
const FIXED: [&str; 4] = ["exclusions", "provenance", "methods", "ledger"];

fn section_value(section: &Section, live: &[Shown], number: &mut usize) -> Value {
    let figures: Vec<Value> = section
        .figures
        .iter()
        .map(|figure| {
            *number += 1;
            let below: Vec<Value> = live
                .iter()
                .filter(|live| live.below == figure.name)
                .map(|live| live.value.clone())
                .collect();
            figure_value(figure, *number, below)
        })
        .collect();
    context! {
        title => &section.title,
        intro => marked(&section.intro),
        figures,
        tables => section.tables.iter().map(table_value).collect::<Vec<_>>(),
    }
}

/// A live part, ready for the template.
struct Shown {
    below: String,
    value: Value,
    player: Option<PlayerFragment>,
}

impl Shown {
    fn new(live: &Live, report: &Report) -> Result<Self, ReportError> {
        let (value, player) = match &live.content {
            LiveContent::StyleSpace(space) => {
                let value = context! {
                    kind => "space",
                    below => &live.below,
                    names => space.names(),
                    left_out => space.left_out(),
                    data => safe(embedded(&space.json(&report.context))),
                    key => space.key(&report.context),
                    score => space.score.2.clone(),
                };
                (value, None)
            }
            LiveContent::Player(drives) => {
                let fragment = player(drives, &report.context)?;
                let value = context! {
                    kind => "player",
                    title => &drives.title,
                    html => safe(fragment.html.clone()),
                };
                (value, Some(fragment))
            }
        };
        Ok(Self { below: live.below.clone(), value, player })
    }
}

/// Figures at least so wide, in millimetres, fill the page; on a phone they scroll.
const WIDE_MM: f64 = 150.0;
/// Between one column and that.
const MIDDLE_MM: f64 = 100.0;

fn figure_value(figure: &Figure, number: usize, live: Vec<Value>) -> Value {
    let width = figure
        .svg
        .split_once("width=\"")
        .and_then(|(_, rest)| rest.split_once("mm\""))
        .and_then(|(width, _)| width.parse::<f64>().ok())
        .unwrap_or(0.0);
    context! {
        name => &figure.name,
        cells => figure.cells.iter().map(|c| c.map(|v| v.to_string()).join(" ")).collect::<Vec<_>>().join(","),
        panels => figure.panels.iter().map(|p| p.name.clone()).collect::<Vec<_>>(),
        number,
        title => safe(markup::html(&figure.title)),
        plain_title => markup::plain(&figure.title),
        caption => safe(markup::html(&figure.caption)),
        svg => safe(figure.svg.clone()),
        live,
        size => match width {
            width if width >= WIDE_MM => "wide",
            width if width >= MIDDLE_MM => "middle",
            _ => "narrow",
        },
    }
}

fn table_value(table: &Table) -> Value {
    if table.rows.len() <= MOST_ROWS {
        return whole_table(table);
    }
    let mut cut = table.clone();
    cut.rows.truncate(MOST_ROWS);
    cut.notes.push(format!(
        "Here: the first {MOST_ROWS} of {} rows. The files below have them all.",
        table.rows.len()
    ));
    whole_table(&cut)
}

fn whole_table(table: &Table) -> Value {
    context! {
        name => &table.name,
        title => markup::plain(&table.title),
        html => safe(table.to_html()),
    }
}

//! The page of people who were left out in turn.

use super::{Answer, InTurn, looks::Look, tables::intro};
use crate::{
    error::StudyError,
    stages::{report::hashed, validate::Validate},
};
use maveric_domain::Design;
use maveric_pages::{
    cards::in_turn::{self, text},
    glossary,
};
use maveric_report::{
    Context, Report,
    html::{Methods, Provenance, Section},
    tables::Table,
};
use minijinja::context;

pub(super) fn page(
    validation: &InTurn,
    options: &Validate,
    design: &Design,
    tables: Vec<(String, Vec<Table>)>,
    warnings: &[String],
) -> Result<Report, StudyError> {
    let context = Context::of(validation.synthetic, options.seed).with_speed(design.speed_unit());
    let values = context! {
        title => validation.rules.title.clone(),
        given => options.rules.is_some(),
        preface => context.preface(),
        people => validation.people,
        drives => validation.drives,
        heads => validation.heads.to_string(),
        source => validation.rules.source.clone(),
        order_of_drives => validation.rules.order_of_drives.clone(),
    };
    let say = |key: &str| text("page", key, &values);
    let new = Report::new(say("title")?, say("subtitle")?, &context);
    let judged = validation.tables.iter().zip(&validation.rules.tables);
    let judged = || judged.clone().filter(|(_, rule)| !rule.seen);
    let orders = judged().filter_map(|(t, _)| match &t.answer {
        Some(Answer::Order(order)) => Some((t.id.as_str(), order)),
        _ => None,
    });
    let identity = judged().filter_map(|(t, _)| match &t.answer {
        Some(Answer::Identity(rows)) => Some((t.id.as_str(), rows.as_slice())),
        _ => None,
    });
    let directions = judged().filter_map(|(t, _)| match &t.answer {
        Some(Answer::Direction { found, .. }) => Some((t.id.as_str(), found)),
        _ => None,
    });
    let cards = in_turn::InTurn {
        orders: orders.collect(),
        identity: identity.collect(),
        directions: directions.collect(),
        label: &|role| design.label(role),
    };
    let mut sections = Vec::new();
    for ((id, tables), (answered, rule)) in tables
        .into_iter()
        .zip(validation.tables.iter().zip(&validation.rules.tables))
    {
        sections.push(Section {
            title: maveric_pages::words::capital(&id.replace(['-', '_'], " ")),
            intro: intro(answered, rule)?,
            figures: Vec::new(),
            tables,
        });
    }
    if !validation.looks.is_empty() {
        sections.push(Section {
            title: say("looks")?,
            intro: vec![say("looks_intro")?],
            figures: Vec::new(),
            tables: vec![looked(&validation.looks, say("looks")?)],
        });
    }
    Ok(Report {
        glossary: glossary(),
        cards: cards.cards(&validation.findings)?,
        sections,
        methods: Methods {
            text: vec![say("method")?],
            files: Vec::new(),
        },
        warnings: warnings.to_vec(),
        provenance: Provenance {
            seed: Some(options.seed),
            command: options.command.clone().unwrap_or_default(),
            inputs: hashed(options.rules.iter().chain(&options.models).cloned())?,
            ..new.provenance
        },
        ..new
    })
}

fn looked(looks: &[Look], title: String) -> Table {
    Table::of("in-turn-looks", title, looks)
        .text("Date", |l| l.date.as_str())
        .text("Program", |l| l.program.as_str())
        .text("Commit", |l| l.commit.as_str())
        .text("Rules", |l| l.rules.chars().take(12).collect::<String>())
        .text("Part", |l| match l.part {
            super::Part::Development => "development",
            super::Part::Test => "test",
        })
        .text("People", |l| l.people.as_str())
        .text("Roles", |l| l.roles.as_str())
        .done()
}

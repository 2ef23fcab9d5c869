//! The page of people who were left out in turn.

use super::{Answer, InTurn, tables::intro};
use crate::{
    design::DesignFile,
    error::StudyError,
    stages::{report::hashed, validate::Validate},
};
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
    study: &DesignFile,
    tables: Vec<(String, Vec<Table>)>,
    warnings: &[String],
) -> Result<Report, StudyError> {
    let design = &study.design;
    let declared = design.validate();
    let context = Context::of(validation.synthetic, options.seed).with_speed(design.speed_unit());
    let values = context! {
        title => design.title(),
        preface => context.preface(),
        people => validation.people,
        drives => validation.drives,
        heads => validation.heads.to_string(),
        source => declared.source.clone(),
        order_of_drives => declared.order_of_drives.clone(),
    };
    let say = |key: &str| text("page", key, &values);
    let new = Report::new(say("title")?, say("subtitle")?, &context);
    let judged = || validation.tables.iter().filter(|t| !t.asked.seen);
    let orders = judged().filter_map(|t| match &t.answer {
        Some(Answer::Order(order)) => Some((t.asked.id.as_str(), order)),
        _ => None,
    });
    let identity = judged().filter_map(|t| match &t.answer {
        Some(Answer::Identity(rows)) => Some((t.asked.id.as_str(), rows.as_slice())),
        _ => None,
    });
    let directions = judged().filter_map(|t| match &t.answer {
        Some(Answer::Direction { found, .. }) => Some((t.asked.id.as_str(), found)),
        _ => None,
    });
    let cards = in_turn::InTurn {
        orders: orders.collect(),
        identity: identity.collect(),
        directions: directions.collect(),
        label: &|role| design.label(role),
    };
    let mut sections = Vec::new();
    for ((id, tables), answered) in tables.into_iter().zip(&validation.tables) {
        sections.push(Section {
            title: maveric_pages::words::capital(&id.replace(['-', '_'], " ")),
            intro: intro(answered)?,
            figures: Vec::new(),
            tables,
        });
    }
    Ok(Report {
        glossary: glossary(),
        cards: cards.cards(&validation.findings)?,
        sections,
        methods: Methods { text: vec![say("method")?], files: Vec::new() },
        warnings: warnings.to_vec(),
        provenance: Provenance {
            seed: Some(options.seed),
            command: options.command.clone().unwrap_or_default(),
            inputs: hashed(study.path.iter().chain(&options.models).cloned())?,
            ..new.provenance
        },
        ..new
    })
}

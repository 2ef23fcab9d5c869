//! The setting and the people.

use super::Run;
use crate::{
    atomic_write::if_there,
    beyond::beyond_in_words,
    error::StudyError,
    once::count,
    run_folder::lists,
    stages::{
        report::{people::People, scene},
        score::Reliability,
    },
    tables::{
        drives::exclusions,
        embeddings::{EmbeddingRow, read_embeddings},
        read_rows,
    },
};
use maveric_domain::{Scale, design::By};
use maveric_pages::words::{listed, of_group};
use maveric_report::{
    apa,
    figures::{
        domain,
        flow::{Flow, flow},
        simulator_view,
    },
    html::Section,
    tables::{self, Cell, Exclusion, Table},
};
use std::{collections::BTreeSet, path::Path};

pub(super) fn section_study(
    folder: &Path,
    run: &Run,
    people: &People,
    reliabilities: &[Reliable],
) -> Result<Section, StudyError> {
    let mut figures = vec![flow(&flow_of(run), &run.context)?];
    if run.model.is_some() {
        figures.push(domain(&run.context)?);
    }
    let simulated = run.design.conditions().iter().find(|c| c.simulated());
    let shown = run.own_style().or(simulated.map(|c| c.id));
    if let Some(view) = scene::view(&folder.join("av/logs"), shown)? {
        figures.push(simulator_view(&view, &run.context)?);
    }
    let mut tables = vec![tables::participants(
        &people.groups(),
        run.design.style().map(|style| style.label.as_str()),
        run.analysis.synthetic,
    )];
    if !reliabilities.is_empty() {
        tables.push(reliability_table(reliabilities));
    }
    Ok(Section {
        title: "The study".to_owned(),
        intro: vec![done(run)],
        figures,
        tables,
    })
}

/// What was done with whom.
pub(super) fn done(run: &Run) -> String {
    let a = &run.analysis;
    let mut sentences = Vec::new();
    if let Some(training) = &run.training {
        sentences.push(format!(
            "The model learned from {} drives by hand.",
            training.drives
        ));
    } else if run.model.is_some() {
        sentences.push("The model was learned elsewhere.".to_owned());
    }
    let (by_car, by_hand): (Vec<_>, Vec<_>) = run
        .design
        .conditions()
        .iter()
        .map(|c| (c.car.is_some(), run.label(c.id)))
        .partition(|(car, _)| *car);
    let labels = |of: Vec<(bool, String)>| {
        listed(&of.into_iter().map(|(_, label)| label).collect::<Vec<_>>())
    };
    let mut parts = Vec::new();
    if let Some(baseline) = run.design.baseline() {
        let by = match baseline.by {
            By::Hand => "drove by hand",
            By::Car => "rode the baseline",
        };
        parts.push(format!("{by} ({})", run.label(baseline.id)));
    }
    if !by_car.is_empty() {
        parts.push(format!("sat through {}", labels(by_car)));
    }
    if !by_hand.is_empty() {
        parts.push(format!(
            "took part in the recorded conditions ({})",
            labels(by_hand)
        ));
    }
    if a.panels.iter().any(|p| !p.measured) {
        parts.push("answered questionnaires about them".to_owned());
    }
    sentences.push(format!(
        "Each of the {} who are analysed {}.",
        count(a.participants, "participant", "participants"),
        listed(&parts)
    ));
    let out: usize = a.flow.left_out.iter().map(|l| l.who.len()).sum();
    if out > 0 {
        let reasons: Vec<String> = a
            .flow
            .left_out
            .iter()
            .map(|l| {
                format!(
                    "{} ({})",
                    l.who.len(),
                    maveric_report::markup::literal(&l.why)
                )
            })
            .collect();
        sentences.push(format!(
            "Of {} who were recruited, {out} {} left out: {}.",
            a.flow.recruited,
            if out == 1 { "was" } else { "were" },
            listed(&reasons)
        ));
    }
    sentences.join(" ")
}

fn flow_of(run: &Run) -> Flow {
    let flow = &run.analysis.flow;
    let rows = |left: &[maveric_analysis::LeftOutFor]| {
        left.iter().map(|l| (l.why.clone(), l.who.len())).collect()
    };
    Flow {
        recruited: flow.recruited,
        drove: flow.drove,
        left_out: rows(&flow.left_out),
        analysed: flow.analysed,
        drives_left_out: rows(&flow.drives),
        outcomes: run
            .analysis
            .panels
            .iter()
            .map(|p| (format!("{}{}", p.title, of_group(p)), p.n))
            .collect(),
    }
}

/// How well the items of a score agree, and what the page calls it.
pub(super) struct Reliable {
    /// `SCALE.SUBSCALE`, to find it by.
    pub(super) id: String,
    pub(super) title: String,
    pub(super) found: Reliability,
}

pub(super) fn reliabilities(folder: &Path, scales: &[Scale]) -> Result<Vec<Reliable>, StudyError> {
    let mut rows = Vec::new();
    for file in [
        "scores_reliabilities.csv",
        "rating_scores_reliabilities.csv",
    ] {
        let when = if file.starts_with("rating") {
            " (after a condition)"
        } else {
            ""
        };
        let all: Vec<Reliability> = if_there(&folder.join(file), read_rows)?;
        rows.extend(all.into_iter().map(|found| Reliable {
            id: format!("{}.{}{when}", found.scale, found.subscale),
            title: format!("{}{when}", titled(scales, &found.scale, &found.subscale)),
            found,
        }));
    }
    Ok(rows)
}

fn reliability_table(rows: &[Reliable]) -> Table {
    let interval = |r: &Reliability| {
        let (low, high) = r.ci_low.zip(r.ci_high)?;
        let [low, high] = [low, high].map(|v| apa::bounded(v, 2));
        Some(Cell::text(format!("[{low}, {high}]")))
    };
    Table::of("reliabilities", "Reliability of the questionnaires", rows)
        .text("Scale", |row| &row.title)
        .right("Items", |row| Cell::count(row.found.items))
        .right("*n*", |row| Cell::count(row.found.n))
        .right("Cronbach’s *α*", |row| Cell::bounded(row.found.alpha, 2))
        .right("95% CI", |row| interval(&row.found).unwrap_or(Cell::Missing))
        .right("McDonald’s *ω*", |row| Cell::bounded(row.found.omega, 2))
        .noted(
            "*n*: answer sheets on which every item of the scale is answered. The interval of *α* is Feldt’s; where people \
             answered several sheets each, that of a bootstrap which draws whole people.",
        )
}

/// What its file calls a subscale: `Mini-IPIP: Openness`; the ids where there is no file.
fn titled(scales: &[Scale], scale: &str, subscale: &str) -> String {
    let Some(known) = scales.iter().find(|s| s.id == scale) else {
        return format!("{scale}: {subscale}");
    };
    let part = known.subscales.iter().find(|s| s.id == subscale);
    match part {
        Some(part) if part.title != known.title => format!("{}: {}", known.title, part.title),
        _ => known.title.clone(),
    }
}

pub(super) fn listed_exclusions(folder: &Path) -> Result<Vec<Exclusion>, StudyError> {
    let mut found = Vec::new();
    for list in lists(folder) {
        let drives = list.parent().unwrap_or(folder);
        let stage = if drives.starts_with(folder.join("av")) {
            "simulate"
        } else {
            "ingest"
        };
        found.extend(exclusions(drives)?.into_iter().map(|row| Exclusion {
            // A log that could not be ingested is no drive, and has its own name alone.
            who: Some(row.drive).filter(|d| !d.is_empty()).unwrap_or(row.log),
            what: stage.to_owned(),
            why: row.what,
        }));
    }
    let rows = if_there(&folder.join("embeddings.csv"), read_embeddings)?;
    let why = |row: &EmbeddingRow| {
        let blank = row.readings == Some(0);
        let blank = blank.then(|| "shows no habit: its driver is taken as anybody".to_owned());
        blank.or_else(|| row.beyond_why.as_ref().map(beyond_in_words))
    };
    let personalised = rows
        .iter()
        .filter_map(|row| Some((row.drive.to_string(), why(row)?)));
    let personalised: BTreeSet<(String, String)> = personalised.collect();
    found.extend(personalised.into_iter().map(|(who, why)| Exclusion {
        who,
        what: "personalize".to_owned(),
        why,
    }));
    for file in [
        "answers_exclusions.csv",
        "scores_exclusions.csv",
        "rating_scores_exclusions.csv",
    ] {
        let listed: Vec<Exclusion> = if_there(&folder.join(file), read_rows)?;
        found.extend(listed);
    }
    Ok(found)
}

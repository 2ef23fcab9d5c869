//! The first two sections: the setting and the people; the model and its training.

use super::{Run, conditions::of_group, enumerated};
use crate::{
    error::StudyError,
    run_folder::lists,
    stages::{
        report::{people::People, scene},
        train::{NetworkSummary, TrainingSummary},
    },
    tables::{Table as File, embeddings::read_embeddings},
};
use maveric_domain::{Scale, design::By};
use maveric_model::{HeldOut, Model, Selection};
use maveric_report::{
    Figure,
    figures::{
        architecture::{Architecture, architecture},
        calibration::{Calibration, CalibrationBin, calibration},
        domain,
        flow::{Flow, flow},
        residuals::{ResidualPanel, Residuals, residuals},
        simulator_view,
        training_curves::{LossTerm, TrainingCurves, training_curves},
    },
    html::Section,
    tables::{self, Cell, Column, Exclusion, Reliability, Table},
};
use std::{collections::BTreeSet, path::Path};

pub(super) fn section_study(
    folder: &Path,
    run: &Run,
    people: &People,
    reliabilities: &[Reliability],
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
        tables.push(tables::reliabilities(reliabilities));
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
        enumerated(&of.into_iter().map(|(_, label)| label).collect::<Vec<_>>())
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
    if a.panels.iter().any(|p| p.outcome.contains('.')) {
        parts.push("answered questionnaires about them".to_owned());
    }
    sentences.push(format!(
        "Each of the {} participants who are analysed {}.",
        a.participants,
        enumerated(&parts)
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
            "Of {} who were recruited, {out} were left out: {}.",
            a.flow.recruited,
            enumerated(&reasons)
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

/// `None` without a model that was learned here.
pub(super) fn section_model(run: &Run) -> Result<Option<Section>, StudyError> {
    let (Some(model), Some(training)) = (&run.model, &run.training) else {
        return Ok(None);
    };
    let Some(networks) = &training.networks else {
        return Ok(Some(Section {
            title: "The model".to_owned(),
            intro: vec![format!(
                "Habits as events, each linear in an embedding of size {}: {} parameters in all, learned from {} drives, S in closed form \
                 afterwards. Settings: linear heads; the paper’s five networks are `--heads paper`.",
                model.embedding_size(),
                training.parameters,
                training.drives
            )],
            figures: Vec::new(),
            tables: vec![heads_of(training)],
        }));
    };
    let mut figures: Vec<Figure> = architecture_of(model, run)?.into_iter().collect();
    figures.extend(training_of(training, networks, run)?);
    let mut intro = vec![format!(
        "The paper’s five networks and an embedding of size {} a driver, {} parameters in all, learned from {} rows of {} drives.",
        model.embedding_size(),
        training.parameters,
        networks.rows,
        training.drives
    )];
    let learned_from = &networks.quality;
    let errors = [
        learned_from
            .speed_mps
            .as_ref()
            .map(|f| format!("ego speed {:.2} m/s", f.rmse)),
        learned_from
            .following_distance_m
            .as_ref()
            .map(|f| format!("following distance {:.1} m", f.rmse)),
    ];
    let errors: Vec<String> = errors.into_iter().flatten().collect();
    if !errors.is_empty() {
        intro.push(format!(
            "Root-mean-square errors of the networks that drive, on the rows they learned from: {}.",
            errors.join(", ")
        ));
    }
    intro.extend(networks.selection.as_ref().map(kept_back));
    Ok(Some(Section {
        title: "The model".to_owned(),
        intro,
        figures,
        tables: Vec::new(),
    }))
}

/// F and V for people kept back, beside those people's own means.
fn kept_back(selection: &Selection) -> String {
    type Of = fn(&HeldOut) -> Option<f64>;
    let both: [(&str, &str, Of); 2] = [
        ("ego speed", "m/s", |h| h.speed_mps),
        ("following distance", "m", |h| h.following_distance_m),
    ];
    let beside = |(what, unit, of): (&str, &str, Of)| {
        let (found, own) = (of(&selection.networks)?, of(&selection.own_means)?);
        let than = if found < own { "better" } else { "no better" };
        Some(format!(
            "{what} {found:.2} {unit}, {than} than the driver’s own mean ({own:.2} {unit})"
        ))
    };
    let said: Vec<String> = both.into_iter().filter_map(beside).collect();
    format!(
        "Networks trained without {} of the people, for as many passes ({}), on the last third of these people’s drives, known by the first \
         two: {}.",
        selection.people,
        selection.kept_epoch,
        said.join("; ")
    )
}

/// What each linear head learned from and how it does on driving kept back.
fn heads_of(training: &TrainingSummary) -> Table {
    let rows = training.heads.iter().map(|head| {
        let kept = head.kept_back.as_ref();
        let unit = if head.unit == "1" {
            String::new()
        } else {
            format!(" ({})", head.unit)
        };
        vec![
            Cell::text(format!("{}{unit}", head.title)),
            Cell::text(head.events.to_string()),
            Cell::number(head.explained.map(|e| 100.0 * e), 0),
            Cell::number(kept.map(|k| k.head), 2),
            Cell::number(kept.map(|k| k.own_mean), 2),
            Cell::number(kept.map(|k| k.everybody), 2),
        ]
    });
    let style = training
        .style
        .as_ref()
        .and_then(|s| s.cross_fitted_r.zip(s.cross_fitted_rmse));
    let score = style.map_or_else(String::new, |(r, rmse)| {
        format!(" The score of people left out is read with r = {r:.2}, off by {rmse:.1} points.")
    });
    Table {
        name: "heads".to_owned(),
        title: "Habits, and how well a style says them".to_owned(),
        columns: vec![
            Column::left("Habit"),
            Column::right("Events"),
            Column::right("Explained (%)"),
            Column::right("Off by"),
            Column::right("Own mean"),
            Column::right("Everybody’s"),
        ],
        rows: rows.collect(),
        notes: vec![format!(
            "Explained: share of how drives differ. Off by: root-mean-square error on the last third of drives of people left out, known by \
             the first two; beside it that driver’s own mean over the first two, and what is said of everybody. A style of few numbers need \
             not beat the own mean: where it does not, it stands here.{score}"
        )],
    }
}

pub(super) fn reliabilities(
    folder: &Path,
    scales: &[Scale],
) -> Result<Vec<Reliability>, StudyError> {
    let mut rows = Vec::new();
    for file in [
        "scores_reliabilities.csv",
        "rating_scores_reliabilities.csv",
    ] {
        let path = folder.join(file);
        if !path.is_file() {
            continue;
        }
        let table = File::read(&path)?;
        let (scale, subscale) = (table.text("scale")?, table.text("subscale")?);
        let (items, n) = (table.all_numbers("items")?, table.all_numbers("n")?);
        let (alpha, low, high) = (
            table.numbers("alpha")?,
            table.numbers("ci_low")?,
            table.numbers("ci_high")?,
        );
        let omega = table.numbers("omega")?;
        for i in 0..table.rows() {
            let when = if file.starts_with("rating") {
                " (after a condition)"
            } else {
                ""
            };
            rows.push(Reliability {
                id: format!(
                    "{}.{}{when}",
                    scale[i].as_deref().unwrap_or_default(),
                    subscale[i].as_deref().unwrap_or_default()
                ),
                scale: format!(
                    "{}{when}",
                    titled(
                        scales,
                        scale[i].as_deref().unwrap_or_default(),
                        subscale[i].as_deref().unwrap_or_default()
                    )
                ),
                items: items[i] as usize,
                n: n[i] as usize,
                alpha: alpha[i],
                interval: low[i].zip(high[i]),
                omega: omega[i],
            });
        }
    }
    Ok(rows)
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
        let path = list.with_file_name("exclusions.csv");
        if !path.exists() {
            continue;
        }
        let stage = if path.starts_with(folder.join("av")) {
            "simulate"
        } else {
            "ingest"
        };
        let table = File::read(&path)?;
        let (drive, what) = (table.text("drive")?, table.text("what")?);
        // A log that could not be ingested is no drive, and has its own name alone.
        let log = if table.has("log") {
            table.text("log")?
        } else {
            vec![None; table.rows()]
        };
        for i in 0..table.rows() {
            let who = drive[i].as_ref().or(log[i].as_ref());
            found.push(Exclusion {
                who: who.cloned().unwrap_or_default(),
                what: stage.to_owned(),
                why: what[i].clone().unwrap_or_default(),
            });
        }
    }
    let embeddings = folder.join("embeddings.csv");
    if embeddings.is_file() {
        let rows = read_embeddings(&embeddings)?;
        let blank: BTreeSet<String> = rows
            .iter()
            .filter(|row| row.readings == Some(0))
            .map(|row| row.drive.to_string())
            .collect();
        found.extend(blank.into_iter().map(|who| Exclusion {
            who,
            what: "personalize".to_owned(),
            why: "shows no habit: its driver is taken as anybody".to_owned(),
        }));
    }
    for file in ["scores_exclusions.csv", "rating_scores_exclusions.csv"] {
        let path = folder.join(file);
        if !path.is_file() {
            continue;
        }
        let table = File::read(&path)?;
        let (who, what, why) = (table.text("who")?, table.text("what")?, table.text("why")?);
        for i in 0..table.rows() {
            found.push(Exclusion {
                who: who[i].clone().unwrap_or_default(),
                what: what[i].clone().unwrap_or_default(),
                why: why[i].clone().unwrap_or_default(),
            });
        }
    }
    Ok(found)
}

fn architecture_of(model: &Model, run: &Run) -> Result<Option<Figure>, StudyError> {
    let Ok(paper) = model.paper() else {
        return Ok(None);
    };
    let a = paper.architecture();
    let hidden = |inputs: usize, outputs: usize| {
        let mut layers = vec![inputs];
        layers.extend(std::iter::repeat_n(a.hidden_units, a.hidden_layers));
        layers.push(outputs);
        layers
    };
    let (w, z) = (a.embedding_size, a.encoding_size);
    let encoder = vec![3 * a.window_steps, a.encoder_units, z];
    let sizes = Architecture {
        embedding: w,
        window_steps: a.window_steps,
        following_distance: hidden(w + 1, 1),
        lane_encoder: encoder.clone(),
        lane_change: hidden(w + z, 2),
        speed_encoder: encoder,
        velocity: hidden(w + z, 1),
        style: vec![w, 1],
        mutual_information: hidden(1 + 2 * z + 4, 2 * w),
    };
    Ok(Some(architecture(&sizes, &run.context)?))
}

fn training_of(
    training: &TrainingSummary,
    networks: &NetworkSummary,
    run: &Run,
) -> Result<Vec<Figure>, StudyError> {
    type Of = fn(&maveric_model::LossTerms) -> Option<f64>;
    let terms: [(&str, Of); 5] = [
        ("*L*_{1} following distance", |l| l.following_distance),
        ("*L*_{2} lane change", |l| l.lane_change),
        ("*L*_{3} velocity", |l| l.velocity),
        ("*L*_{4} style", |l| l.aggression),
        ("*L*_{5} mutual information", |l| l.mutual_information),
    ];
    // The run that kept people back shows both curves; the one that made the model has learned from all.
    let epochs = networks
        .selection
        .as_ref()
        .map_or(&networks.epochs, |s| &s.epochs);
    let term = |(title, of): (&str, Of)| {
        let train: Option<Vec<f64>> = epochs.iter().map(|e| of(&e.losses)).collect();
        let kept: Option<Vec<f64>> = epochs.iter().map(|e| of(e.validation.as_ref()?)).collect();
        Some(LossTerm {
            title: title.to_owned(),
            train: train?,
            validation: kept.unwrap_or_default(),
        })
    };
    let curves = TrainingCurves {
        terms: terms.into_iter().filter_map(term).collect(),
        drives: training.drives,
    };
    let mut figures = vec![training_curves(&curves, &run.context)?];
    let (quality, drives, held_out) = match &networks.selection {
        Some(kept) => (&kept.quality, kept.drives, true),
        None => (&networks.quality, training.drives, false),
    };
    if let Some(found) = &quality.lane_change {
        let bins = found.bins.iter().filter(|b| b.seconds >= 1.0);
        let input = Calibration {
            bins: bins
                .map(|b| CalibrationBin {
                    predicted: b.predicted,
                    observed: b.observed,
                    seconds: b.seconds,
                })
                .collect(),
            expected_error: found.expected_calibration_error,
            drives,
            held_out,
        };
        if !input.bins.is_empty() {
            figures.push(calibration(&input, &run.context)?);
        }
    }
    let panels = [
        ("Following distance (F)", "m", &quality.following_distance_m),
        ("Ego speed (V)", "m/s", &quality.speed_mps),
    ];
    let panels: Vec<ResidualPanel> = panels
        .into_iter()
        .filter_map(|(title, unit, found)| {
            let found = found.as_ref()?;
            Some(ResidualPanel {
                title: title.to_owned(),
                axis: format!("Predicted − recorded ({unit})"),
                unit: unit.to_owned(),
                quantiles: found.quantiles.clone(),
                mean: found.mean,
                rms: found.rmse,
                rows: found.rows,
            })
        })
        .collect();
    if !panels.is_empty() {
        let input = Residuals {
            panels,
            drives,
            held_out,
        };
        figures.push(residuals(&input, &run.context)?);
    }
    Ok(figures)
}

//! The first two sections: the setting and the people; the model and its training.

use super::Run;
use crate::{
    error::StudyError,
    stages::{
        report::{people::People, scene},
        train::{NetworkSummary, TrainingSummary},
    },
    tables::Table as File,
};
use maveric_model::{Quality, RowsOf};
use maveric_report::{
    Figure,
    figures::{
        architecture::{Architecture, architecture},
        calibration::{Calibration, CalibrationBin, calibration},
        domain,
        residuals::{ResidualPanel, Residuals, residuals},
        simulator_view,
        training_curves::{LossTerm, TrainingCurves, training_curves},
    },
    html::Section,
    tables::{self, Cell, Column, Exclusion, Reliability, Table},
};
use std::path::Path;

pub(super) fn section_study(
    folder: &Path,
    run: &Run,
    people: &People,
    reliabilities: &[Reliability],
) -> Result<Section, StudyError> {
    let mut figures = vec![domain(&run.context)?];
    if let Some(view) = scene::view(&folder.join("av/logs"))? {
        figures.push(simulator_view(&view, &run.context)?);
    }
    Ok(Section {
        title: "The study".to_owned(),
        intro: vec![format!(
            "Study 1 gave {} drives by hand, from which the model learned. Each of the {} participants of Study 2 drove by hand, \
             sat through Mimic, Aggressive, Cautious and Perpendicular, and rated each of them.",
            run.training.drives, run.analysis.participants
        )],
        figures,
        tables: vec![
            tables::participants(&people.groups(), run.analysis.synthetic),
            tables::reliabilities(reliabilities),
        ],
    })
}

pub(super) fn section_model(run: &Run) -> Result<Section, StudyError> {
    let training = &run.training;
    let Some(networks) = &training.networks else {
        return Ok(Section {
            title: "The model".to_owned(),
            intro: vec![format!(
                "Habits as events, each linear in an embedding of size {}: {} parameters in all, learned from {} drives, S in closed form \
                 afterwards. Settings: linear heads; the paper’s five networks are `--heads paper`.",
                run.model.embedding_size(),
                training.parameters,
                training.drives
            )],
            figures: Vec::new(),
            tables: vec![heads_of(training)],
        });
    };
    let mut figures: Vec<Figure> = architecture_of(run)?.into_iter().collect();
    figures.extend(training_of(run, networks)?);
    let mut intro = vec![format!(
        "The paper’s five networks and an embedding of size {} a driver, {} parameters in all, learned from {} rows of {} drives.",
        run.model.embedding_size(),
        training.parameters,
        networks.rows,
        training.drives
    )];
    let mut said = |of: &str, quality: &Quality| {
        let speed = quality
            .speed_mps
            .as_ref()
            .map(|f| format!("ego speed {:.2} m/s", f.rmse));
        let gap = quality.following_distance_m.as_ref();
        let gap = gap.map(|f| format!("following distance {:.1} m", f.rmse));
        let both: Vec<String> = speed.into_iter().chain(gap).collect();
        if !both.is_empty() {
            intro.push(format!(
                "Root-mean-square errors {of}: {}.",
                both.join(", ")
            ));
        }
    };
    said(
        "of the networks that drive, on the rows they learned from",
        &networks.quality,
    );
    if let Some(selection) = &networks.selection {
        said(
            "of networks that did not see the last part of each drive, there",
            &selection.quality,
        );
    }
    Ok(Section {
        title: "The model".to_owned(),
        intro,
        figures,
        tables: Vec::new(),
    })
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

pub(super) fn reliabilities(folder: &Path) -> Result<Vec<Reliability>, StudyError> {
    let mut rows = Vec::new();
    for file in [
        "scores_reliabilities.csv",
        "rating_scores_reliabilities.csv",
    ] {
        let table = File::read(&folder.join(file))?;
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
                scale: format!(
                    "{}: {}{when}",
                    scale[i].clone().unwrap_or_default(),
                    subscale[i].clone().unwrap_or_default()
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

pub(super) fn listed_exclusions(folder: &Path) -> Result<Vec<Exclusion>, StudyError> {
    let mut found = Vec::new();
    let driven = [
        ("drives/study1", "ingest"),
        ("drives/study2", "ingest"),
        ("av/drives", "simulate"),
    ];
    for (drives, stage) in driven {
        let path = folder.join(drives).join("exclusions.csv");
        if !path.exists() {
            continue;
        }
        let table = File::read(&path)?;
        let (drive, what) = (table.text("drive")?, table.text("what")?);
        for i in 0..table.rows() {
            found.push(Exclusion {
                who: drive[i].clone().unwrap_or_default(),
                what: stage.to_owned(),
                why: what[i].clone().unwrap_or_default(),
            });
        }
    }
    for file in ["scores_exclusions.csv", "rating_scores_exclusions.csv"] {
        let table = File::read(&folder.join(file))?;
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

fn architecture_of(run: &Run) -> Result<Option<Figure>, StudyError> {
    let Ok(paper) = run.model.paper() else {
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

fn training_of(run: &Run, networks: &NetworkSummary) -> Result<Vec<Figure>, StudyError> {
    type Of = fn(&maveric_model::LossTerms) -> Option<f64>;
    let terms: [(&str, Of); 5] = [
        ("*L*_{1} following distance", |l| l.following_distance),
        ("*L*_{2} lane change", |l| l.lane_change),
        ("*L*_{3} velocity", |l| l.velocity),
        ("*L*_{4} style", |l| l.aggression),
        ("*L*_{5} mutual information", |l| l.mutual_information),
    ];
    let training = &run.training;
    // The run that kept rows back shows both curves; the one that made the model has learned from all.
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
    let kept = networks.selection.as_ref().map(|s| &s.quality);
    let quality = kept.unwrap_or(&networks.quality);
    let held_out = quality.on == RowsOf::Validation;
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
            drives: training.drives,
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
                quantiles: found.quantiles.iter().map(|q| (q.share, q.value)).collect(),
                mean: found.mean,
                rms: found.rmse,
                rows: found.rows,
            })
        })
        .collect();
    if !panels.is_empty() {
        let input = Residuals {
            panels,
            drives: training.drives,
            held_out,
        };
        figures.push(residuals(&input, &run.context)?);
    }
    Ok(figures)
}

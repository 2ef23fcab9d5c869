//! What was learned: heads or networks, and how their training went.

use super::Run;
use crate::{error::StudyError, stages::train::TrainingSummary};
use maveric_model::{HeldOut, Model, NetworkReport, Selection};
use maveric_report::{
    Figure,
    figures::{
        architecture::{Architecture, architecture},
        calibration::{Calibration, CalibrationBin, calibration},
        residuals::{ResidualPanel, Residuals, residuals},
        training_curves::{LossTerm, TrainingCurves, training_curves},
    },
    html::Section,
    tables::{Cell, Table},
};

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
    let style = training
        .style
        .as_ref()
        .and_then(|s| s.cross_fitted_r.zip(s.cross_fitted_rmse));
    let score = style.map_or_else(String::new, |(r, rmse)| {
        format!(" The score of people left out is read with r = {r:.2}, off by {rmse:.1} points.")
    });
    let title = "Habits, and how well a style says them";
    Table::of("heads", title, &training.heads)
        .text("Habit", |head| match head.unit.as_str() {
            "1" => head.title.clone(),
            unit => format!("{} ({unit})", head.title),
        })
        .right("Events", |head| Cell::text(head.events.to_string()))
        .right("Explained (%)", |head| Cell::number(head.explained.map(|e| 100.0 * e), 0))
        .right("Off by", |head| Cell::number(head.kept_back.as_ref().map(|k| k.head), 2))
        .right("Own mean", |head| Cell::number(head.kept_back.as_ref().map(|k| k.own_mean), 2))
        .right("Everybody’s", |head| {
            Cell::number(head.kept_back.as_ref().map(|k| k.everybody), 2)
        })
        .noted(format!(
            "Explained: share of how drives differ. Off by: root-mean-square error on the last third of drives of people left out, known by \
             the first two; beside it that driver’s own mean over the first two, and what is said of everybody. A style of few numbers need \
             not beat the own mean: where it does not, it stands here.{score}"
        ))
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
    networks: &NetworkReport,
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

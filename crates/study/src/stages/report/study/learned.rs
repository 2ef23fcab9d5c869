//! What was learned: heads or networks, and how their training went.

use super::Run;
use crate::{error::StudyError, stages::train::TrainingSummary};
use maveric_model::{Model, NetworkReport};
use maveric_pages::study::StudyPage;
use maveric_report::{
    Figure,
    figures::{
        architecture::{Architecture, architecture},
        calibration::{Calibration, CalibrationBin, calibration},
        residuals::{ResidualPanel, Residuals, residuals},
        training_curves::{LossTerm, TrainingCurves, training_curves},
    },
    html::Section,
};

/// `None` without a model that was learned here.
pub(super) fn section_model(
    run: &Run,
    page: &StudyPage<'_>,
) -> Result<Option<Section>, StudyError> {
    let (Some(model), Some(training)) = (&run.model, &run.training) else {
        return Ok(None);
    };
    let Some(networks) = &training.networks else {
        let heads = page.texts.table("heads", &training.heads)?;
        return Ok(Some(page.texts.section("heads", Vec::new(), vec![heads])?));
    };
    let mut figures: Vec<Figure> = architecture_of(model, run)?.into_iter().collect();
    figures.extend(training_of(training, networks, run)?);
    Ok(Some(page.texts.section("networks", figures, Vec::new())?))
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
    type Loss = fn(&maveric_model::LossTerms) -> Option<f64>;
    let terms: [(&str, Loss); 5] = [
        ("*L*_{1} following distance", |l| l.following_distance),
        ("*L*_{2} lane change", |l| l.lane_change),
        ("*L*_{3} velocity", |l| l.velocity),
        ("*L*_{4} style", |l| l.aggression),
        ("*L*_{5} mutual information", |l| l.mutual_information),
    ];
    // The run that kept people back shows both curves; the one that made the model has learned from all.
    let epochs = networks.selection.as_ref().map_or(&networks.epochs, |s| &s.epochs);
    let term = |(title, loss): (&str, Loss)| {
        let train: Option<Vec<f64>> = epochs.iter().map(|e| loss(&e.losses)).collect();
        let kept: Option<Vec<f64>> = epochs.iter().map(|e| loss(e.validation.as_ref()?)).collect();
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
    if let Some(lane_change) = &quality.lane_change {
        let bins = lane_change.bins.iter().filter(|b| b.seconds >= 1.0);
        let input = Calibration {
            bins: bins
                .map(|b| CalibrationBin {
                    predicted: b.predicted,
                    observed: b.observed,
                    seconds: b.seconds,
                })
                .collect(),
            expected_error: lane_change.expected_calibration_error,
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
        .filter_map(|(title, unit, errors)| {
            let errors = errors.as_ref()?;
            Some(ResidualPanel {
                title: title.to_owned(),
                axis: format!("Predicted − recorded ({unit})"),
                unit: unit.to_owned(),
                quantiles: errors.quantiles.clone(),
                mean: errors.mean,
                rms: errors.rmse,
                rows: errors.rows,
            })
        })
        .collect();
    if !panels.is_empty() {
        let input = Residuals { panels, drives, held_out };
        figures.push(residuals(&input, &run.context)?);
    }
    Ok(figures)
}

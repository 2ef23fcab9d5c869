//! The first two sections: the setting and the people; the model and its training.

use super::Run;
use crate::{
    error::StudyError,
    stages::report::{people::People, scene},
    tables::Table as File,
};
use maveric_model::RowsOf;
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
    tables::{self, Exclusion, Reliability},
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
    let mut figures = vec![architecture_of(run)?];
    figures.extend(training_of(run)?);
    let training = &run.training;
    let quality = training.selection.as_ref().map(|s| &s.quality);
    let quality = quality.or(training.quality.as_ref());
    let mut intro = vec![format!(
        "Five networks and an embedding of size {} a driver, {} parameters in all, learned from {} rows of {} drives.",
        run.model.embedding_size(),
        training.parameters,
        training.rows,
        training.drives
    )];
    if let Some(quality) = quality {
        let of = match quality.on {
            RowsOf::Validation => "rows kept back from the training",
            RowsOf::Training => "the rows trained on",
        };
        let mut said = Vec::new();
        if let Some(found) = &quality.speed_mps {
            said.push(format!("ego speed {:.2} m/s", found.rmse));
        }
        if let Some(found) = &quality.following_distance_m {
            said.push(format!("following distance {:.1} m", found.rmse));
        }
        if !said.is_empty() {
            intro.push(format!(
                "Root-mean-square errors on {of}: {}.",
                said.join(", ")
            ));
        }
    }
    Ok(Section {
        title: "The model".to_owned(),
        intro,
        figures,
        tables: Vec::new(),
    })
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

fn architecture_of(run: &Run) -> Result<Figure, StudyError> {
    let a = run.model.architecture();
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
    Ok(architecture(&sizes, &run.context)?)
}

fn training_of(run: &Run) -> Result<Vec<Figure>, StudyError> {
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
    let epochs = training
        .selection
        .as_ref()
        .map_or(&training.epochs, |s| &s.epochs);
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
    let quality = training.selection.as_ref().map(|s| &s.quality);
    let Some(quality) = quality.or(training.quality.as_ref()) else {
        return Ok(figures);
    };
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

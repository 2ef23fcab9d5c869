//! The first section: the setting, the people, the model and its training.

use super::Run;
use crate::{
    error::StudyError,
    stages::report::{people::People, scene},
    tables::Table as File,
};
use maveric_report::{
    Figure,
    figures::{
        architecture::{Architecture, architecture},
        domain, simulator_view,
        training_curves::{LossTerm, TrainingCurves, training_curves},
    },
    html::Section,
    tables::{self, Exclusion, Reliability},
};
use std::path::Path;

pub(super) fn section_setting(
    folder: &Path,
    run: &Run,
    people: &People,
    reliabilities: &[Reliability],
) -> Result<Section, StudyError> {
    let mut figures = vec![domain(&run.context)?, architecture_of(run)?];
    if let Some(view) = scene::view(&folder.join("av/logs"))? {
        figures.push(simulator_view(&view, &run.context)?);
    }
    figures.push(training_of(run)?);
    Ok(Section {
        title: "Setting, people, model".to_owned(),
        intro: Vec::new(),
        figures,
        tables: vec![
            tables::participants(&people.groups(), run.analysis.synthetic),
            tables::reliabilities(reliabilities),
        ],
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
                omega: None,
            });
        }
    }
    Ok(rows)
}

pub(super) fn listed_exclusions(folder: &Path) -> Result<Vec<Exclusion>, StudyError> {
    let mut found = Vec::new();
    for study in ["study1", "study2"] {
        let path = folder.join("drives").join(study).join("exclusions.csv");
        if !path.exists() {
            continue;
        }
        let table = File::read(&path)?;
        let (drive, what) = (table.text("drive")?, table.text("what")?);
        for i in 0..table.rows() {
            found.push(Exclusion {
                who: drive[i].clone().unwrap_or_default(),
                what: "ingest".to_owned(),
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

fn training_of(run: &Run) -> Result<Figure, StudyError> {
    type Of = fn(&maveric_model::LossTerms) -> Option<f64>;
    let terms: [(&str, Of); 5] = [
        ("*L*_{1} following distance", |l| l.following_distance),
        ("*L*_{2} lane change", |l| l.lane_change),
        ("*L*_{3} velocity", |l| l.velocity),
        ("*L*_{4} style", |l| l.aggression),
        ("*L*_{5} mutual information", |l| l.mutual_information),
    ];
    let term = |(title, of): (&str, Of)| {
        let train: Option<Vec<f64>> = run.training.epochs.iter().map(|e| of(&e.losses)).collect();
        Some(LossTerm {
            title: title.to_owned(),
            train: train?,
            validation: Vec::new(),
        })
    };
    let terms = terms.into_iter().filter_map(term).collect();
    Ok(training_curves(
        &TrainingCurves {
            terms,
            drives: run.training.drives,
        },
        &run.context,
    )?)
}

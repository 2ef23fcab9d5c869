//! `steer`: where in style space each participant's conditions lie, or the points of a sweep.

mod attribute_scores;
mod conditions;
mod strangers;
mod sweep;
mod withheld;

pub use attribute_scores::AttributeSummary;
pub use withheld::drives as withheld_drives;

use crate::{
    beyond::own_drives,
    design::DesignFile,
    error::StudyError,
    forget::refuse_learned_from_gone,
    outcome::{Outcome, Watch},
    run_folder::read_model,
    stage::{Files, Stage},
    style_scores::style_range,
    tables::{
        collected::{LENT, consents_of_study},
        conditions::{ConditionRow, write_conditions},
        embeddings::read_embeddings,
    },
};
use maveric_domain::{Embedding, ParticipantId};
use maveric_model::{
    Model, ModelError,
    style_space::{LinearHead, share_outside_training},
};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Place the conditions of the design in style space
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric steer --model model.maveric --embeddings embeddings.csv --out conditions.csv\n\
    A sweep: maveric steer --model model.maveric --embeddings embeddings.csv --sweep=-20,-10,0,10,20 --out sweep.csv\n\
    Another direction: maveric steer --model model.maveric --embeddings embeddings.csv --attribute mini_ipip.openness --scores scores.csv --points 1 --hold aggression --out openness.csv"
)]
pub struct Steer {
    /// Design of the study (TOML); study.toml of the current directory when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Trained model
    #[arg(long)]
    pub model: PathBuf,
    /// Fitted embeddings
    #[arg(long)]
    pub embeddings: PathBuf,
    /// Conditions to write
    #[arg(long)]
    pub out: PathBuf,
    /// A step, in points of the style or of the attribute; the design's, of an attribute a third of its range, when not given
    #[arg(long)]
    pub points: Option<f64>,
    /// Place these points in place of the conditions, such as --sweep=-20,-10,0,10,20
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "POINTS")]
    pub sweep: Vec<f64>,
    /// Move along this score in place of aggression: SCALE.SUBSCALE of a table of scores, or any table's column
    #[arg(long, requires = "scores", value_name = "NAME")]
    pub attribute: Option<String>,
    /// Table that the attribute stands in
    #[arg(long, requires = "attribute", value_name = "FILE")]
    pub scores: Option<PathBuf>,
    /// Hold this score while moving along the attribute; `aggression` is the model's own
    #[arg(long, requires = "attribute", value_name = "NAME")]
    pub hold: Vec<String>,
    /// Turn the dial also for people beyond what the model has learned from; `[model] beyond = "drive"` in a design says the same
    #[arg(long)]
    pub beyond: bool,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

#[derive(Debug, Clone, Serialize)]
pub struct Steered {
    /// People with an own drive to steer from.
    pub participants: usize,
    /// Shifts that the ends of the scale cut short.
    pub clamped: usize,
    /// People beyond what the model has learned from.
    pub beyond: Vec<ParticipantId>,
    /// Whether they are left out of the conditions that turn the dial.
    pub beyond_left_out: bool,
    /// Heads that were fitted to scores.
    pub attributes: Vec<AttributeSummary>,
    /// What was written: a row a person and condition, or a person and point of a sweep.
    pub conditions: Vec<ConditionRow>,
}

impl Stage for Steer {
    const NAME: &'static str = "steer";
    const FAILURE: &'static str = "could not steer";
    type Result = Steered;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let study = DesignFile::below_or_paper(root, self.design.as_deref())?;
        Ok(Files::default()
            .reads([&self.model, &self.embeddings])
            .reads(&self.scores)
            .reads_design(self.design.as_deref())
            .reads_style(Some(&study))
            .reads_if_there([LENT.into(), consents_of_study()].map(|file| study.resolve(&file)))
            .writes([&self.out]))
    }

    /// Places every condition of the design that has a learned car, for every baseline embedding that was fitted with the score of
    /// the style; for one without a score, the fit without. With a sweep or an attribute, places its points instead.
    ///
    /// # Source
    /// Method section 4.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Steered>, StudyError> {
        let study = DesignFile::find(self.design.as_deref())?;
        refuse_learned_from_gone(&study, &self.model)?;
        let model = read_model(&self.model)?.on_range(style_range(&study)?);
        let rows = read_embeddings(&self.embeddings)?;
        let sweeps = !self.sweep.is_empty() || self.attribute.is_some();
        let axis = match LinearHead::aggression(&model) {
            Err(ModelError::NoAggressionAxis) if !sweeps && !study.design.has_a_dial() => None,
            axis => Some(axis?),
        };
        let Some(baseline) = study.design.baseline_id() else {
            return Err(study.wrong(
                "`baseline`: found none, expected the drive by hand that the car is fitted to",
                Some("add [baseline] with the id of that drive, such as id = \"own\"".to_owned()),
            ));
        };
        let people = own_drives(&rows, baseline);
        if people.is_empty() {
            return Err(StudyError::file(&self.embeddings, "holds no own drive to steer from"));
        }
        let outcome = match &axis {
            Some(axis) if sweeps => sweep::sweep(self, &study, (&model, axis), &people, watch)?,
            _ => conditions::conditions(self, &study, &model, axis.as_ref(), &people, watch)?,
        };
        write_conditions(&self.out, &outcome.value.conditions)?;
        Ok(outcome)
    }
}

fn is_beyond(model: &Model, embedding: &Embedding) -> Result<bool, StudyError> {
    Ok(share_outside_training(model, std::slice::from_ref(embedding))?
        .is_some_and(|share| share > 0.5))
}

/// SD of by how many points a style was moved from one end of a step to the other.
fn moved_sd(axis: &LinearHead, [from, to]: [&Embedding; 2]) -> Option<f64> {
    let ends = to.coordinates().iter().zip(from.coordinates());
    let step: Vec<f64> = ends.map(|(to, from)| to - from).collect();
    axis.step_sd(&step)
}

//! What training makes, and how it went.

use crate::{
    epochs::EpochReport,
    error::ModelWarning,
    heads::{HeadReport, StyleHead},
    model::Model,
    quality::Quality,
    selection::Selection,
};
use maveric_domain::{DriveId, Embedding};
use serde::{Deserialize, Serialize};

/// What training makes.
#[derive(Debug, Clone, PartialEq)]
pub struct Trained {
    /// The model.
    pub model: Model,
    /// The training drives' embeddings, in the order the drives were given, those left out left out.
    pub embeddings: Vec<(DriveId, Embedding)>,
    /// How it went.
    pub report: TrainingReport,
}

/// How training went.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrainingReport {
    /// Drives and losses left out.
    pub warnings: Vec<ModelWarning>,
    /// Drives learned from.
    pub drives: usize,
    /// Drives among them with a score of the style.
    pub drives_with_adb: usize,
    /// The linear heads: what each learned from and how well it does on driving kept back; empty for the paper's networks.
    pub heads: Vec<HeadReport>,
    /// S of the linear heads.
    pub style: Option<StyleHead>,
    /// The paper's networks; none for linear heads.
    pub networks: Option<NetworkReport>,
}

/// How the paper's networks were trained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NetworkReport {
    /// Rows learned from.
    pub rows: usize,
    /// Rows among them at which ego follows.
    pub following_rows: usize,
    /// Rows among them at which a lane change is being started.
    pub lane_change_rows: usize,
    /// Losses without data, and why.
    pub left_out: Vec<String>,
    /// Every epoch of the run that made the model, in order.
    pub epochs: Vec<EpochReport>,
    /// The run that kept people back, unless there was none: its losses on both parts, what stopped it, and how good its predictions
    /// are for people it has not learned from.
    pub selection: Option<Selection>,
    /// How good the predictions of the networks that drive are, on the rows that they learned from.
    pub quality: Quality,
}

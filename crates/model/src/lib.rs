#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod ablation;
mod adam;
pub mod bfgs;
mod dataset;
mod days;
mod epochs;
pub mod error;
mod fused;
pub mod heads;
mod heads_kind;
mod held_out;
mod linear_algebra;
mod losses;
pub mod model;
pub mod model_file;
mod network;
mod on_range;
mod own_means;
pub mod paper;
pub mod params;
pub mod personalize;
mod posted;
pub mod predict;
mod quality;
mod rows;
mod scaling;
mod selection;
pub mod style_space;
#[cfg(test)]
#[path = "../tests/support/drives.rs"]
mod test_drives;
mod train;
mod trainer;
mod training_report;
mod whitening;
pub mod windows;

pub use ablation::{
    Ablated, AblationSettings, Variant, VariantKind, VariantResult, ablate, variants,
};
pub use days::Days;
pub use epochs::{EpochReport, TrainingDrive};
pub use error::{ModelError, ModelWarning};
pub use heads::{
    BEYOND_P, FittedHead, HEADS, HeadReport, KeptBack, StyleHead, Support, score_line,
};
pub use heads_kind::HeadsKind;
pub use held_out::HeldOut;
pub use losses::{Loss, LossTerms, LossWeights, MutualInformationLoss};
pub use model::{Habits, Heads, LinearHeads, Model, TrainingEmbedding};
pub use network::Architecture;
pub use paper::{Learned, PaperNetworks};
pub use params::TrainSettings;
pub use personalize::{
    CurvePoint, CurveSettings, LearningCurve, Personalized, Personalizer, learn_days,
    learning_curve, personalize,
};
pub use posted::{FreeSpeed, Posted};
pub use predict::{Prediction, Predictor};
pub use quality::{Calibration, CalibrationBin, Quality, Residuals};
pub use selection::Selection;
pub use train::train;
pub use training_report::{NetworkReport, Trained, TrainingReport};
pub use windows::{Window, WindowBuffer, WindowSettings};

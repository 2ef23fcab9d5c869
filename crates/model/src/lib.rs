//! A driver's style as a small embedding: networks, training, personalising, style space.
//!
//! [`train()`] learns heads and an embedding per drive from [`maveric_domain::Drive`]s: linear ones ([`heads`]) or the paper's five
//! networks ([`paper`]); [`personalize()`] solves for the embedding of a new drive; [`style_space`] moves an embedding along or across
//! the direction of aggression; [`Habits`] and [`Predictor`] turn an embedding into what a planner asks for. No files, no clock, no
//! controllers.

pub mod ablation;
mod adam;
mod damped_newton;
mod dataset;
pub mod error;
mod fused;
pub mod heads;
mod linear_algebra;
pub mod losses;
pub mod model;
pub mod model_file;
pub mod network;
pub mod paper;
pub mod params;
pub mod personalize;
pub mod predict;
pub mod quality;
mod rows;
pub mod scaling;
pub mod style_space;
#[cfg(test)]
#[path = "../tests/support/drives.rs"]
mod test_drives;
pub mod train;
mod trainer;
pub mod whitening;
pub mod windows;

pub use ablation::{
    Ablated, AblationSettings, HeldOut, Variant, VariantKind, VariantResult, ablate, variants,
};
pub use adam::cosine;
pub use error::{ModelError, ModelWarning};
pub use heads::{FittedHead, HEADS, HeadReport, KeptBack, StyleHead};
pub use losses::{Loss, LossTerms, LossWeights, MutualInformationLoss};
pub use model::{Habits, Heads, HeadsKind, LinearHeads, Model, TrainingEmbedding};
pub use network::Architecture;
pub use paper::{Learned, PaperNetworks};
pub use params::{PersonalizeParams, PersonalizeSettings, TrainParams, TrainSettings};
pub use personalize::{
    CurveParams, CurvePoint, CurveSettings, LearningCurve, Personalized, Personalizer,
    learning_curve, personalize,
};
pub use predict::{Prediction, Predictor};
pub use quality::{Calibration, CalibrationBin, Quality, Quantile, Residuals, RowsOf};
pub use train::{
    EpochReport, NetworkReport, Selection, Trained, TrainingDrive, TrainingReport, train,
};
pub use windows::{Window, WindowBuffer, WindowSettings};

//! A driver's style as a small embedding: networks, training, personalising, style space.
//!
//! [`train()`] learns five sub-networks and an embedding per drive from [`maveric_domain::Drive`]s;
//! [`personalize()`] fits an embedding to a new drive with the networks frozen; [`style_space`] moves an
//! embedding along or across the direction of aggression; [`Predictor`] turns an embedding and a window of the
//! last seconds into a [`Prediction`]. No files, no clock, no controllers.

pub mod ablation;
mod adam;
pub mod checkpoint;
mod damped_newton;
mod dataset;
pub mod error;
mod fused;
mod linear_algebra;
pub mod losses;
pub mod model;
pub mod network;
pub mod optimise;
pub mod params;
pub mod personalize;
pub mod predict;
pub mod quality;
mod quasi_newton;
mod rows;
pub mod scaling;
pub mod style_space;
#[cfg(test)]
#[path = "../tests/support/drives.rs"]
mod test_drives;
pub mod train;
mod trainer;
pub mod training_state;
pub mod whitening;
pub mod windows;

pub use ablation::{
    Ablated, AblationSettings, HeldOut, Variant, VariantKind, VariantResult, ablate, variants,
};
pub use error::{ModelError, ModelWarning};
pub use losses::{Loss, LossTerms, LossWeights, MutualInformationLoss};
pub use model::{Learned, Model, TrainingEmbedding};
pub use network::Architecture;
pub use params::{PersonalizeParams, PersonalizeSettings, TrainParams, TrainSettings};
pub use personalize::{
    CurveParams, CurvePoint, CurveSettings, LearningCurve, Personalized, Personalizer, Start,
    Uncertainty, learning_curve, personalize,
};
pub use predict::{Prediction, Predictor};
pub use quality::{Calibration, CalibrationBin, Quality, Quantile, Residuals, RowsOf};
pub use train::{
    Checkpoints, EpochReport, Trained, TrainingDrive, TrainingReport, train, train_resumable,
};
pub use training_state::{Selection, TrainingState};
pub use windows::{Window, WindowBuffer, WindowSettings};

#![doc = include_str!("../README.md")]

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

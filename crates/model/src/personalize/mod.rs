//! Personalising: all weights frozen, an embedding fitted to one driver's drive.
//!
//! [`Personalizer`] reads the weights out of a model once; each drive is then encoded once, up to the first layers'
//! pre-activations, and damped Gauss-Newton steps run over the few numbers of `w`. [`Uncertainty`] says how well the drive
//! determines them, [`learning_curve()`] how much driving it takes.

mod encoded_rows;
mod fit;
mod frozen;
mod learning_curve;
mod lines;
mod objective;
#[cfg(test)]
mod reference;
mod uncertainty;

pub use fit::{Personalized, Personalizer, Start, personalize};
#[cfg(test)]
pub(crate) use frozen::Frozen;
pub use learning_curve::{CurveParams, CurvePoint, CurveSettings, LearningCurve, learning_curve};
#[cfg(test)]
pub(crate) use objective::Fit;
pub use uncertainty::Uncertainty;

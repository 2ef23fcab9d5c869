//! Questionnaires: what is asked, what was answered, what it scores.

mod answer;
mod item;
mod moment;
mod scale;
mod scale_file;
mod style_score;
pub(crate) mod subscale;
mod wording;
mod words_file;

pub use answer::{Answer, ProbeAnswer, Score};
pub use item::{Item, Kind};
pub use moment::Moment;
pub use scale::Scale;
pub use style_score::{ScoreRange, StyleScore};
pub use subscale::{NormCorrelation, Norms, Scoring, Subscale};
pub use wording::{ItemWords, Wording};

//! Questionnaires: what is asked, what was answered, what it scores.

mod adb_score;
mod answer;
mod item;
mod moment;
mod scale;
mod scale_file;
pub(crate) mod subscale;
mod wording;
mod words_file;

pub use adb_score::AdbScore;
pub use answer::{Answer, ProbeAnswer, Score};
pub use item::{Item, Kind};
pub use moment::Moment;
pub use scale::Scale;
pub use subscale::{NormCorrelation, Norms, Scoring, Subscale};
pub use wording::{ItemWords, Wording};

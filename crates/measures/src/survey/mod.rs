//! Questionnaires: definitions that are data, and the scores of their answers.

mod item_matrix;
mod scale;
mod score;
mod warning;

pub use item_matrix::ItemMatrix;
pub use scale::parse_scale;
pub use score::{Scored, score};
pub use warning::ScoreWarning;

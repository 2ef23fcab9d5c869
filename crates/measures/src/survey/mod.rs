//! Questionnaires: definitions that are data, and the scores of their answers.

mod item_matrix;
mod probe;
mod response_style;
mod scale;
mod score;
mod warning;

pub use item_matrix::ItemMatrix;
pub use probe::{ProbeAnswer, score_probes};
pub use response_style::{FASTEST_SECONDS_AN_ITEM, SheetTime, response_styles, too_fast};
pub use scale::parse_scale;
pub use score::{Scored, score};
pub use warning::ScoreWarning;

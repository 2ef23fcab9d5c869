//! Questionnaires: definitions that are data, and the scores of their answers.

mod attention;
mod item_matrix;
mod probe;
mod response_style;
mod score;
#[cfg(test)]
mod shipped;
mod warning;

pub use attention::attention_missed;
pub use item_matrix::ItemMatrix;
pub use probe::score_probes;
pub use response_style::{
    FASTEST_SECONDS_AN_ITEM, FEWEST_ITEMS, SheetTime, response_styles, too_fast,
};
pub use score::{Scored, score};
pub use warning::ScoreWarning;

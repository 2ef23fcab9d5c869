#![doc = include_str!("../README.md")]

mod accuracy;
mod analyse;
mod correlations;
mod data;
mod error;
mod family;
mod homophily;
mod line;
mod mixed;
mod panels;
mod result;
#[cfg(test)]
mod six_people;

pub use analyse::{Friedman, analyse};
pub use data::{StudyData, Tables};
pub use error::AnalysisError;
pub use family::Family;
pub use result::{
    AggressionLine, Analysis, Correlation, Exclusion, HomophilyRow, Kept, LineRow, MimicAccuracy,
    MixedRow, Nearer, Panel, PanelPair, Preference, SimilarityRow,
};

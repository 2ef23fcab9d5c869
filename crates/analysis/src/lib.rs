#![doc = include_str!("../README.md")]

mod analyse;
mod compare;
mod contrast;
mod correlations;
mod data;
mod design_test;
mod error;
mod exclusions;
mod homophily;
mod line;
mod mixed;
mod outcomes;
mod person;
mod recommendation;
mod reproduction;
mod result;
#[cfg(test)]
mod six_people;
mod verdict;

pub use analyse::{Friedman, analyse};
pub use data::{StudyData, Tables};
pub use error::AnalysisError;
pub use exclusions::{Driven, Flow, LeftOut, LeftOutFor, Why};
pub use person::Person;
pub use recommendation::{
    Dial, FURTHEST_POINTS, Learned, OnTheScale, Percept, Preferred, Reason, Recommendation,
    SETTINGS, Standard,
};
pub use result::{
    Above, AggressionLine, Analysis, Contrast, Correlation, Exclusion, Group, HomophilyRow, Kept,
    LineRow, MixedRow, Nearer, Panel, Preference, Reproduction, SimilarityRow,
};
pub use verdict::{Judged, Verdict};

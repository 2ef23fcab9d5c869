//! A result of a crate below with what became of its questions, as one JSON.

use maveric_analysis::Finding;
use serde::Serialize;

/// The keys of the result, and `findings`.
#[derive(Serialize)]
pub(crate) struct Judged<'a, T> {
    #[serde(flatten)]
    pub(crate) result: &'a T,
    pub(crate) findings: &'a [Finding],
}

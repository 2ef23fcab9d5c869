//! The answers behind a subscale's reliability.

use maveric_domain::{Moment, ParticipantId};

/// The answers of a subscale, reversed where its key says so: what its reliability is computed from.
#[derive(Debug, Clone, PartialEq)]
pub struct ItemMatrix {
    /// Code name of the scale.
    pub scale: String,
    /// Code name of the subscale.
    pub subscale: String,
    /// Item numbers: the columns, shape `(k,)`.
    pub items: Vec<u32>,
    /// Who answered when: the rows, shape `(n,)`.
    pub respondents: Vec<(ParticipantId, Moment)>,
    /// Answers after reversal, shape `(n, k)`; `None` where an item was left out.
    pub answers: Vec<Vec<Option<f64>>>,
}

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

impl ItemMatrix {
    /// The rows without a missing item at the moments that `keep` accepts, shape `(m, k)`, and how many rows
    /// at those moments were dropped.
    pub fn complete(&self, keep: impl Fn(Moment) -> bool) -> (Vec<Vec<f64>>, usize) {
        let kept = self
            .respondents
            .iter()
            .zip(&self.answers)
            .filter(|((_, moment), _)| keep(*moment));
        let mut dropped = 0;
        let mut rows = Vec::new();
        for (_, row) in kept {
            match row.iter().copied().collect::<Option<Vec<f64>>>() {
                Some(full) => rows.push(full),
                None => dropped += 1,
            }
        }
        (rows, dropped)
    }
}

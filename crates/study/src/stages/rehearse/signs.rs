//! Do effects planted at the paper's sizes come out with the paper's signs?

use crate::{atomic_write::read_text, error::StudyError};
use maveric_rehearsal::{Cell, n_for};
use maveric_report::claims;
use maveric_stats::Proportion;
use serde::Serialize;
use std::path::Path;

/// One of the paper's correlations over the rehearsed studies.
#[derive(Debug, Clone, Serialize)]
pub struct SignRow {
    /// The claim's key, such as `homophily.SCALE.FACTOR.OWN-OTHER.SCALE.SUBSCALE.r`.
    pub key: String,
    pub text: String,
    pub paper: f64,
    /// Participants of the studies that are compared.
    pub participants: usize,
    /// Mean of ours over the studies.
    pub mean: Option<f64>,
    /// The same over the studies in which p < .05, as the paper's printed rows were chosen.
    pub mean_when_significant: Option<f64>,
    /// Share of studies with the paper's sign.
    pub same_sign: Option<Proportion>,
    /// Share of studies with p < .05: the power.
    pub power: Option<Proportion>,
    /// Participants for a power of .8 at the planted sizes; `None` beyond the sizes tried.
    pub n_for_80: Option<usize>,
}

/// The size at which signs are compared: the paper's, or the next that was tried.
const PAPER_N: usize = 24;

pub(super) fn signs(path: &Path, cells: &[Cell]) -> Result<Vec<SignRow>, StudyError> {
    let ledger = claims::load(&read_text(path)?)?;
    let planted: Vec<&Cell> =
        cells.iter().filter(|c| (c.effect_scale - 1.0).abs() < 1e-12).collect();
    let Some(at) = planted.iter().find(|c| c.participants >= PAPER_N) else {
        return Ok(Vec::new());
    };
    let mut rows = Vec::new();
    for claim in ledger {
        let Some(key) = claim.key.strip_suffix(".r") else {
            continue;
        };
        let test_in = |c: &Cell| c.tests.iter().position(|t| t.key == key);
        let Some(i) = test_in(at) else { continue };
        let test = &at.tests[i];
        let same_sign = if claim.printed.value >= 0.0 {
            test.above_zero
        } else {
            test.above_zero.map(|s| Proportion {
                estimate: 1.0 - s.estimate,
                low: 1.0 - s.high,
                high: 1.0 - s.low,
            })
        };
        let curve: Vec<(usize, f64)> = planted
            .iter()
            .filter_map(|c| Some((c.participants, c.tests[test_in(c)?].rate?.estimate)))
            .collect();
        rows.push(SignRow {
            key: claim.key.clone(),
            text: claim.text.clone(),
            paper: claim.printed.value,
            participants: at.participants,
            mean: test.mean_estimate,
            mean_when_significant: test.mean_when_significant,
            same_sign,
            power: test.rate,
            n_for_80: n_for(&curve, 0.8),
        });
    }
    Ok(rows)
}

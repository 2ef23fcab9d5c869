//! The fifth section: who prefers what, and what goes with it.

use super::{Run, capital, printed, statement};
use crate::{error::StudyError, stages::analyse::HomophilyRow};
use maveric_domain::Condition;
use maveric_report::{
    claims::LedgerRow,
    figures::preference::{Preferences, ScalePreference, preference},
    html::Section,
    tables::{self, CorrelationRow},
};

pub(super) fn section_homophily(run: &Run, ledger: &[LedgerRow]) -> Result<Section, StudyError> {
    let shown = |row: &&HomophilyRow| {
        let key = homophily_key(row);
        row.correlation.p.is_some_and(|p| p < 0.05) || ledger.iter().any(|l| l.claim.key == key)
    };
    let mut rows: Vec<CorrelationRow> = run
        .analysis
        .homophily
        .iter()
        .filter(shown)
        .map(|row| CorrelationRow {
            independent: capital(&row.factor),
            dependent: format!("Mimic − {}, {}", capital(row.versus.as_str()), row.rating),
            ours: statement(&row.correlation),
            repeated: None,
            paper: printed(ledger, &homophily_key(row)),
        })
        .collect();
    rows.extend(run.analysis.similarity.iter().map(|row| CorrelationRow {
        independent: "Perceived similarity".to_owned(),
        dependent: capital(&row.rating),
        ours: statement(&row.pooled),
        repeated: statement(&row.within),
        paper: printed(ledger, &format!("correlation.similarity.{}.r", row.rating)),
    }));
    let bars = Preferences {
        scales: run
            .analysis
            .preferences
            .iter()
            .filter(|p| p.n > 0)
            .map(|p| ScalePreference {
                scale: if p.rating == "discomfort" {
                    "Comfort".to_owned()
                } else {
                    capital(&p.rating)
                },
                n: p.n,
                aggressive_above: p.aggressive_above,
                cautious_above: p.cautious_above,
            })
            .collect(),
    };
    let tested = run
        .analysis
        .homophily
        .iter()
        .filter(|r| r.correlation.p.is_some())
        .count();
    let low = run
        .analysis
        .homophily
        .iter()
        .filter(|r| r.correlation.p.is_some_and(|p| p < 0.05))
        .count();
    let holm = run
        .analysis
        .homophily
        .iter()
        .filter(|r| r.p_holm.is_some_and(|p| p < 0.05))
        .count();
    let bh = run
        .analysis
        .homophily
        .iter()
        .filter(|r| r.p_bh.is_some_and(|p| p < 0.05))
        .count();
    let figures = if bars.scales.is_empty() {
        Vec::new()
    } else {
        vec![preference(&bars, &run.context)?]
    };
    Ok(Section {
        title: "Who wants to be driven as they drive?".to_owned(),
        intro: vec![format!(
            "{tested} correlations of a factor with a rating difference were tested: {low} are below .05 as printed ({:.0} would be by \
             chance), {bh} with the false discovery rate controlled (Benjamini and Hochberg), {holm} after Holm. The table shows the \
             pairs that the paper printed and those below .05 here, uncorrected as in the paper.",
            0.05 * tested as f64
        )],
        figures,
        tables: vec![tables::correlations(&rows, run.analysis.participants)],
    })
}

fn homophily_key(row: &HomophilyRow) -> String {
    let versus = if row.versus == Condition::Cautious {
        "mc"
    } else {
        "ma"
    };
    format!("correlation.{}.{versus}_{}.r", row.factor, row.rating)
}

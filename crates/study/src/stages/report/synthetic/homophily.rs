//! The fifth section: who prefers what, and what goes with it.

use super::{Run, capital, printed, statement};
use crate::error::StudyError;
use maveric_analysis::{HomophilyRow, MixedRow};
use maveric_domain::ConditionId;
use maveric_report::{
    apa,
    claims::LedgerRow,
    figures::{
        correlation_heatmap::{CorrelationHeatMap, HeatCell, correlation_heatmap},
        preference::{Preferences, ScalePreference, preference},
    },
    html::Section,
    tables::{self, Cell, Column, CorrelationRow, Table},
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
    let mut figures = Vec::new();
    if !bars.scales.is_empty() {
        figures.push(preference(&bars, &run.context)?);
    }
    if let Some(map) = heat_map(run, tested) {
        figures.push(correlation_heatmap(&map, &run.context)?);
    }
    Ok(Section {
        title: "Who wants to be driven as they drive?".to_owned(),
        intro: vec![format!(
            "{tested} correlations of a factor with a rating difference were tested (the declared family: {}): {low} are below .05 as printed ({:.0} would be by \
             chance), {bh} with the false discovery rate controlled (Benjamini and Hochberg), {holm} after Holm. The table shows the \
             pairs that the paper printed and those below .05 here, uncorrected as in the paper.",
            run.analysis.family,
            0.05 * tested as f64
        )],
        figures,
        tables: std::iter::once(tables::correlations(&rows, run.analysis.participants))
            .chain(mixed(run))
            .collect(),
    })
}

/// Ratings on the shift of the dial: what the four answers of a person say together; `None` where it was not fitted.
fn mixed(run: &Run) -> Option<Table> {
    let fitted = &run.analysis.mixed;
    let unit = fitted.first()?.unit_points;
    let effect = |row: &MixedRow, name: &str| {
        let found = row.model.as_ref().and_then(|m| m.fixed.get(name));
        let Some(found) = found else {
            return [Cell::Missing, Cell::Missing, Cell::Missing];
        };
        let interval = found
            .ci_low
            .zip(found.ci_high)
            .map_or(Cell::Missing, |(low, high)| {
                Cell::text(format!(
                    "{} to {}",
                    apa::number(low, 2),
                    apa::number(high, 2)
                ))
            });
        let p = found.p.map_or(Cell::Missing, |p| {
            Cell::Marked(apa::p(p).markup().to_owned())
        });
        [Cell::number(Some(found.estimate), 2), interval, p]
    };
    let row = |row: &MixedRow| {
        let sd = row
            .model
            .as_ref()
            .and_then(|m| m.random_sd.get("shift").copied());
        std::iter::once(Cell::text(capital(&row.rating)))
            .chain(effect(row, "shift"))
            .chain(effect(row, "shift_squared"))
            .chain([Cell::number(sd, 2)])
            .collect()
    };
    let missing = fitted
        .iter()
        .filter_map(|r| Some(format!("{}: {}.", capital(&r.rating), r.why_not.as_ref()?)));
    Some(Table {
        name: "mixed".to_owned(),
        title: "Ratings on the shift of the dial".to_owned(),
        columns: vec![
            Column::left("Rating"),
            Column::right("Shift"),
            Column::right("95% CI"),
            Column::left("Test"),
            Column::right("Shift²"),
            Column::right("95% CI"),
            Column::left("Test"),
            Column::right("*SD* of the shift over people"),
        ],
        rows: fitted.iter().map(row).collect(),
        notes: std::iter::once(format!(
            "Linear mixed models (REML, Satterthwaite’s degrees of freedom), intercept and shift at random over people; one unit is {unit:.0} ADB points towards \
             aggressive. A negative shift² means that a rating falls on either side of the own style."
        ))
        .chain(missing)
        .collect(),
    })
}

/// Every test of the family at a glance; `None` where there is none.
fn heat_map(run: &Run, tested: usize) -> Option<CorrelationHeatMap> {
    let found = &run.analysis.homophily;
    let mut factors: Vec<&str> = Vec::new();
    let mut against: Vec<(ConditionId, &str)> = Vec::new();
    for row in found {
        if !factors.contains(&row.factor.as_str()) {
            factors.push(&row.factor);
        }
        if !against.contains(&(row.versus, row.rating.as_str())) {
            against.push((row.versus, &row.rating));
        }
    }
    against.sort_by_key(|(versus, _)| *versus);
    let cell = |factor: &str, (versus, rating): &(ConditionId, &str)| {
        let fits =
            |r: &&HomophilyRow| r.factor == factor && r.versus == *versus && r.rating == *rating;
        let row = found.iter().find(fits)?;
        Some(HeatCell {
            value: row.correlation.r?,
            p: row.p_holm?,
        })
    };
    (!factors.is_empty()).then(|| CorrelationHeatMap {
        rows: factors.iter().map(|f| capital(f)).collect(),
        columns: against
            .iter()
            .map(|(versus, rating)| format!("Mimic − {}, {rating}", capital(versus.as_str())))
            .collect(),
        cells: factors
            .iter()
            .map(|f| against.iter().map(|a| cell(f, a)).collect())
            .collect(),
        family: format!(
            "Stars: *p* adjusted after Holm over the {tested} tests of the declared family."
        ),
        participants: run.analysis.participants,
    })
}

fn homophily_key(row: &HomophilyRow) -> String {
    let versus = if row.versus == ConditionId::CAUTIOUS {
        "mc"
    } else {
        "ma"
    };
    format!("correlation.{}.{versus}_{}.r", row.factor, row.rating)
}

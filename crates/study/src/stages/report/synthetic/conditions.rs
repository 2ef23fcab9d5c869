//! The third and fourth sections: what the conditions did, and which habits they left alone.

use super::{Run, said, watch};
use crate::{error::StudyError, stages::report::keys::short, watching::WatchedDrive};
use maveric_analysis::{Nearer, Panel, PanelPair};
use maveric_domain::ConditionId;
use maveric_report::{
    apa,
    claims::LedgerRow,
    figures::{
        difference_panels::{DifferencePanel, DifferencePanels, PairTest, difference_panels},
        perpendicular::{AngleChange, PerpendicularChanges, PerpendicularPanel, perpendicular},
        perpendicular_circle, time_space,
    },
    html::Section,
    tables::{self, AccuracyRow, Cell, Column},
};
use std::collections::BTreeMap;

pub(super) fn section_conditions(
    run: &Run,
    ledger: &[LedgerRow],
    watched: &[WatchedDrive],
) -> Result<Section, StudyError> {
    let panels = DifferencePanels {
        // A panel without a single value has nothing to show: the exclusions say who is missing and why.
        panels: run
            .analysis
            .panels
            .iter()
            .filter(|p| p.rows.iter().flatten().any(Option::is_some))
            .map(panel)
            .collect(),
    };
    let reported: BTreeMap<&str, f64> = ledger
        .iter()
        .map(|row| (row.claim.key.as_str(), row.claim.printed.value))
        .collect();
    let rows: Vec<AccuracyRow> = run
        .analysis
        .accuracy
        .iter()
        .map(|r| AccuracyRow {
            measure: r.title.clone(),
            n: r.n,
            ours: r.mean,
            paper: reported
                .get(format!("mimic_accuracy.{}", short(&r.measure)).as_str())
                .map(|v| v / 100.0),
            population_mean: r.population_mean,
            test_retest: None,
        })
        .collect();
    let mut intro = vec![
        "Differences from each participant’s own drive; the table says which test was used and why, and analysis.json has every check."
            .to_owned(),
    ];
    let mut figures = Vec::new();
    if panels.panels.is_empty() {
        intro.push(
            "No participant has a value in any condition: there are no differences to draw."
                .to_owned(),
        );
    } else {
        figures.push(difference_panels(&panels, &run.context)?);
    }
    if let Some(drive) = watched
        .iter()
        .find(|d| d.meta.condition == ConditionId::MIMIC)
        && let Some(diagram) = watch::diagram(drive)
    {
        figures.push(time_space(&diagram, &run.context)?);
    }
    Ok(Section {
        title: "Does Mimic drive like the driver, and does the dial turn?".to_owned(),
        intro,
        figures,
        tables: vec![
            omnibus_table(run),
            tables::mimic_accuracy(&rows),
            nearer_table(run),
        ],
    })
}

pub(super) fn section_kept(run: &Run) -> Result<Section, StudyError> {
    let panels = run
        .analysis
        .kept
        .iter()
        .filter(|k| !k.points.is_empty())
        .map(|k| {
            let round = match (k.circular_r, k.circular_p) {
                (Some(r), Some(p)) => {
                    format!("*R* = {}, {}", apa::bounded(r, 2), apa::p(p).markup())
                }
                _ => format!("not computed from {} participants", k.points.len()),
            };
            PerpendicularPanel {
                title: k.title.clone(),
                axis: if k.unit.is_empty() {
                    "Change from Mimic".to_owned()
                } else {
                    format!("Change from Mimic ({})", k.unit)
                },
                points: k
                    .points
                    .iter()
                    .map(|(angle_rad, change)| AngleChange {
                        angle_rad: *angle_rad,
                        change: *change,
                    })
                    .collect(),
                statistic: round,
            }
        })
        .collect::<Vec<_>>();
    let mut figures = Vec::new();
    if !panels.is_empty() {
        let changes = PerpendicularChanges { panels };
        figures.push(perpendicular(&changes, &run.context)?);
        figures.push(perpendicular_circle(&changes, &run.context)?);
    }
    let intro = run.analysis.kept.iter().map(|k| {
        format!(
            "{}: along the aggression line {}; against the angle, as the paper does it, {}. An angle has no natural zero, so the \
             figure gives the multiple correlation with its cosine and sine.",
            k.title,
            said(&k.line),
            said(&k.angle)
        )
    });
    Ok(Section {
        title: "What does moving across the aggression line change?".to_owned(),
        intro: intro.collect(),
        figures,
        tables: Vec::new(),
    })
}

/// The omnibus test in words, with marks; `short` leaves out interval and ε, for a panel's width.
pub(super) fn omnibus(panel: &Panel, short: bool) -> String {
    match &panel.comparison {
        None if short => format!("not tested: *n* = {}", panel.n),
        None => format!(
            "not tested: {} participants with a value in every condition",
            panel.n
        ),
        Some(found) => {
            let said = if short {
                found.omnibus.short_statement(found.n)
            } else {
                found.omnibus.statement(found.n)
            };
            said.map_or_else(
                || "no test statistic: see the reasons in the analysis".to_owned(),
                |said| said.markup().to_owned(),
            )
        }
    }
}

/// Which test answered each panel, and why.
fn omnibus_table(run: &Run) -> tables::Table {
    let row = |panel: &Panel| {
        let reasons = panel
            .comparison
            .as_ref()
            .map(|c| c.reasons.as_slice())
            .unwrap_or_default();
        vec![
            Cell::text(panel.title.clone()),
            Cell::Marked(omnibus(panel, false)),
            Cell::text(capital_first(&reasons.join("; "))),
        ]
    };
    tables::Table {
        name: "omnibus".to_owned(),
        title: "Do the conditions differ?".to_owned(),
        columns: ["Measure", "Test over the conditions", "Why this one"]
            .map(Column::left)
            .to_vec(),
        rows: run.analysis.panels.iter().map(row).collect(),
        notes: Vec::new(),
    }
}

/// A sentence with its first letter large.
fn capital_first(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

fn nearer_table(run: &Run) -> tables::Table {
    let row = |r: &Nearer| {
        let p = r
            .p_holm
            .map_or_else(|| "n/a".to_owned(), |p| apa::p_holm(p).markup().to_owned());
        vec![
            Cell::text(r.title.clone()),
            Cell::text(r.than.to_string()),
            Cell::count(r.n),
            Cell::number(r.share.map(|s| 100.0 * s), 0),
            Cell::Marked(p),
        ]
    };
    tables::Table {
        name: "nearer".to_owned(),
        title: "Is Mimic nearer to the participant's own drive?".to_owned(),
        columns: vec![
            Column::left("Measure"),
            Column::left("Than"),
            Column::right("*n*"),
            Column::right("Mimic nearer (%)"),
            Column::left("Wilcoxon"),
        ],
        rows: run.analysis.nearer.iter().map(row).collect(),
        notes: vec![
            "Wilcoxon's signed ranks of |Mimic − own| against |condition − own|; p adjusted after Holm over the ten rows.".to_owned(),
        ],
    }
}

fn panel(panel: &Panel) -> DifferencePanel {
    let axis = match (panel.measure.as_str(), panel.unit.as_str()) {
        ("aggressiveness", _) => "Rated aggressiveness (1 to 7)".to_owned(),
        (_, "") => "Difference from own drive".to_owned(),
        (_, unit) => format!("Difference from own drive ({unit})"),
    };
    let pair = |p: &PanelPair| {
        Some(PairTest {
            first: p.first,
            second: p.second,
            p_holm: p.p_holm?,
        })
    };
    DifferencePanel {
        title: panel.title.clone(),
        axis,
        conditions: ConditionId::AV.to_vec(),
        rows: panel.rows.clone(),
        omnibus: omnibus(panel, true),
        pairs: panel
            .pairs
            .iter()
            .filter_map(pair)
            .filter(|p| p.first == ConditionId::MIMIC)
            .collect(),
        reference: Some(panel.same),
    }
}

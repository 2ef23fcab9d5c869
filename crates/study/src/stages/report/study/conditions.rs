//! What the conditions did, and which habits they left alone.

use super::{Run, watch};
use crate::{error::StudyError, stages::report::keys::short, watching::WatchedDrive};
use maveric_analysis::{Contrast, Panel};
use maveric_domain::design::Sign;
use maveric_pages::words::{capital, correlation, of_group, omnibus, paired, with_unit};
use maveric_report::{
    apa,
    claims::LedgerRow,
    figures::{
        difference_panels::{DifferencePanel, DifferencePanels, PairTest, difference_panels},
        perpendicular::{AngleChange, PerpendicularChanges, PerpendicularPanel, perpendicular},
        time_space,
    },
    html::Section,
    tables::{self, Cell},
};

pub(super) fn section_conditions(
    run: &Run,
    ledger: &[LedgerRow],
    watched: &[WatchedDrive],
) -> Result<Section, StudyError> {
    // A panel without a single value has nothing to show: the exclusions say who is missing and why.
    let drawn: Vec<&Panel> = run
        .analysis
        .panels
        .iter()
        .filter(|p| p.rows.iter().flatten().any(Option::is_some))
        .collect();
    let from = drawn.iter().find_map(|p| p.differences_from);
    let panels = DifferencePanels {
        panels: drawn.iter().map(|p| panel(run, p)).collect(),
        from,
    };
    let mut intro = vec![format!(
        "{} The table says which test was used and why, and analysis.json has every check.",
        match from {
            Some(from) => format!(
                "Measures are differences from the drive {}.",
                run.label(from)
            ),
            None => "Measures and answers are shown as they are.".to_owned(),
        }
    )];
    let mut figures = Vec::new();
    if panels.panels.is_empty() {
        intro.push(
            "No participant has a value in any condition: there is nothing to draw.".to_owned(),
        );
    } else {
        figures.push(difference_panels(&panels, &run.context)?);
    }
    let shown = run
        .own_style()
        .or(run.design.conditions().first().map(|c| c.id));
    if let Some(drive) = watched.iter().find(|d| Some(d.meta.condition) == shown)
        && let Some(diagram) = watch::diagram(drive)
    {
        figures.push(time_space(&diagram, &run.context)?);
    }
    let mut tables = vec![
        descriptives_table(run),
        omnibus_table(run),
        contrasts_table(run),
    ];
    tables.extend(accuracy_table(run, ledger));
    tables.extend(bias_table(run));
    tables.extend(nearer_table(run));
    Ok(Section {
        title: "What did the conditions do?".to_owned(),
        intro,
        figures,
        tables,
    })
}

/// How near the car at 0 on the dial comes to the person, beside the paper's number where it printed one; `None` where there is no such car.
fn accuracy_table(run: &Run, ledger: &[LedgerRow]) -> Option<tables::Table> {
    let rows = &run.analysis.reproduction;
    let condition = rows.first()?.condition;
    let paper = |measure: &str| {
        let key = format!("accuracy.{condition}.{}", short(measure));
        let row = ledger.iter().rfind(|row| row.claim.key == key)?;
        Some(row.claim.printed.value / 100.0)
    };
    let percent = |share: Option<f64>| Cell::number(share.map(|share| 100.0 * share), 1);
    // Nobody drove twice: then there is no column for it.
    let twice = rows.iter().any(|r| r.second_drive.is_some());
    let printed = rows.iter().any(|r| paper(&r.measure).is_some());
    let label = run.label(condition);
    let title = format!("How near {label} comes to the own drive (%)");
    let more = if twice {
        " The same driver’s second drive is about the ceiling."
    } else {
        ""
    };
    let table = tables::Table::of("accuracy", title, rows)
        .text("Measure", |r| &r.title)
        .right("*n*", |r| Cell::count(r.n))
        .right("Accuracy", |r| percent(r.mean))
        .and_if(printed, |table| table.right("Paper", |r| percent(paper(&r.measure))))
        .right("Mean of the training drivers as guess", |r| percent(r.population_mean))
        .and_if(twice, |table| table.right("Same driver, two drives", |r| percent(r.second_drive)))
        .noted(format!(
            "Accuracy: 1 − |car − driver| / driver, mean over drivers. A driver without a value in one of the two drives \
             is left out of that row. The guess is the floor: what no personalising gives. No test.{more}"
        ));
    Some(table)
}

/// Which habits a move across the dial changes; `None` where no car moves across it.
pub(super) fn section_kept(run: &Run) -> Result<Option<Section>, StudyError> {
    let Some(first) = run.analysis.kept.first() else {
        return Ok(None);
    };
    let change = format!("Change from {}", run.label(first.from));
    let panels = run
        .analysis
        .kept
        .iter()
        .filter(|k| !k.points.is_empty())
        .map(|k| {
            let round = match (k.circular_r, k.circular_p_holm) {
                (Some(r), Some(p)) => {
                    format!("*R* = {}, {}", apa::bounded(r, 2), apa::p_holm(p).markup())
                }
                _ => format!("not computed from {} participants", k.points.len()),
            };
            PerpendicularPanel {
                title: k.title.clone(),
                axis: with_unit(&change, &k.unit),
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
        let changes = PerpendicularChanges {
            panels,
            across: first.across,
            from: first.from,
        };
        figures.push(perpendicular(&changes, &run.context)?);
    }
    let intro = run.analysis.kept.iter().map(|k| {
        format!(
            "{}: along the line of {} {}. An angle has no natural zero, so the figure gives the multiple correlation of the change with its \
             cosine and sine (a habit a panel, Holm over the habits).",
            k.title,
            run.style_label(),
            correlation(&k.line)
        )
    });
    Ok(Some(Section {
        title: "What does moving across the dial change?".to_owned(),
        intro: intro.collect(),
        figures,
        tables: Vec::new(),
    }))
}

/// Which test answered each panel, and why.
fn omnibus_table(run: &Run) -> tables::Table {
    tables::Table::of("omnibus", "Do the conditions differ?", &run.analysis.panels)
        .text("Measure", |panel| {
            format!("{}{}", panel.title, of_group(panel))
        })
        .left("Test over the conditions", |panel| {
            Cell::Marked(omnibus(panel, false))
        })
        .text("Why this one", |panel| capital(&panel.reasons.join("; ")))
        .done()
}

/// Every declared contrast with its test.
fn contrasts_table(run: &Run) -> tables::Table {
    let panels = run.analysis.panels.iter();
    let all: Vec<(&Panel, &Contrast)> = panels
        .flat_map(|panel| panel.contrasts.iter().map(move |pair| (panel, pair)))
        .collect();
    let expecting = all.iter().any(|(_, pair)| pair.expected.is_some());
    let expected = |pair: &Contrast| match pair.expected {
        Some(Sign::Plus) => Cell::text("above"),
        Some(Sign::Minus) => Cell::text("below"),
        None => Cell::Missing,
    };
    let table = tables::Table::of("contrasts", "The declared contrasts", all)
        .text("Outcome", |(panel, _)| format!("{}{}", panel.title, of_group(panel)))
        .text("Contrast", |(_, pair)| {
            let label = |id| run.design.label(id);
            format!("{} − {}", label(pair.first), label(pair.second))
        })
        .and_if(expecting, |table| table.left("Expected", |(_, pair)| expected(pair)))
        .right("Mean difference", |(_, pair)| Cell::number(pair.mean_difference, 2))
        .left("Test", |(panel, pair)| paired(panel, pair).map_or(Cell::Missing, Cell::Marked))
        .noted("*p* adjusted after Holm over the contrasts of an outcome; those within groups of people are one family of their own.");
    if !expecting {
        return table;
    }
    table.noted("Expected: where the design, or the places of the two on the dial and what aggression does to the measure, say so.")
}

fn nearer_table(run: &Run) -> Option<tables::Table> {
    let label = run.label(run.analysis.nearer.first()?.condition);
    let rows = &run.analysis.nearer;
    let title = format!("Is {label} nearer to the participant's own drive?");
    let table = tables::Table::of("nearer", title, rows)
        .text("Measure", |r| &r.title)
        .text("Than", |r| run.design.label(r.than))
        .right("*n*", |r| Cell::count(r.n))
        .right("Nearer", |r| Cell::count(r.nearer))
        .right("Tied", |r| Cell::count(r.tied))
        .right("Farther", |r| Cell::count(r.farther))
        .right("Rank-biserial *r*", |r| Cell::bounded(r.effect, 2))
        .right("2.5%", |r| Cell::bounded(r.interval.map(|i| i.0), 2))
        .right("97.5%", |r| Cell::bounded(r.interval.map(|i| i.1), 2))
        .right("*p*_{Holm}", |r| Cell::p(r.p_holm))
        .noted(format!(
            "Wilcoxon’s signed ranks of |{label} − baseline| against |condition − baseline|: above 0 {label} is nearer; ties count for neither. \
             *p* adjusted after Holm over all {} rows.",
            rows.len()
        ));
    Some(table)
}

/// How far the car at 0 on the dial lies from the person on average; `None` where there is none.
fn bias_table(run: &Run) -> Option<tables::Table> {
    let label = run.label(run.analysis.reproduction.first()?.condition);
    let all = run.analysis.reproduction.iter();
    let rows = all.filter_map(|r| Some((r, r.bias.as_ref()?)));
    let title = format!("{label} minus the own drive, on average");
    let table = tables::Table::of("bias", title, rows)
        .text("Measure", |(r, b)| with_unit(&r.title, &b.unit))
        .right("*n*", |(_, b)| Cell::count(b.n))
        .right("*M*", |(_, b)| Cell::number(Some(b.mean), 2))
        .right("5%", |(_, b)| Cell::number(b.interval.map(|i| i.0), 2))
        .right("95%", |(_, b)| Cell::number(b.interval.map(|i| i.1), 2))
        .right("*t*", |(_, b)| Cell::number(b.t, 2))
        .right("*p*_{Holm}, differs", |(_, b)| Cell::p(b.p_holm))
        .right("Same within ±", |(_, b)| Cell::number(Some(b.same_within), 2))
        .text("By", |(_, b)| if b.declared { "declared" } else { "half an SD" })
        .right("*p*, same", |(_, b)| Cell::p(b.p_equivalent))
        .text("Same?", |(_, b)| b.verdict.words())
        .noted(
            "90% intervals, which lie within the bounds where both one-sided tests are below .05; paired *t* tests against no difference, Holm over the measures; then two one-sided *t* tests against the \
             bounds (the larger *p*; all measures have to hold, so it is not adjusted). Both may hold: different, and by too little to count. Half an \
             SD: half the standard deviation between people’s own drives, where the design declares no bound.",
        );
    Some(table)
}

/// What was measured and answered, by condition.
fn descriptives_table(run: &Run) -> tables::Table {
    let title = "What was measured and answered, by condition";
    tables::Table::of("descriptives", title, &run.analysis.descriptives)
        .text("Outcome", |d| with_unit(&d.title, &d.unit))
        .text("Condition", |d| run.design.label(d.condition))
        .right("*n*", |d| Cell::count(d.n))
        .right("*M*", |d| Cell::number(d.mean, 2))
        .right("*SD*", |d| Cell::number(d.sd, 2))
        .right("*Mdn*", |d| Cell::number(d.median, 2))
        .noted("As measured and answered, not as differences; everybody with a value, so *n* may differ from that of a test.")
}

fn panel(run: &Run, panel: &Panel) -> DifferencePanel {
    let axis = match (panel.differences_from, panel.unit.as_str()) {
        (None, "") => panel.title.clone(),
        (None, unit) => capital(unit),
        (Some(from), unit) => with_unit(&format!("Difference from {}", run.label(from)), unit),
    };
    let pair = |p: &Contrast| {
        Some(PairTest {
            first: p.first,
            second: p.second,
            p_holm: p.p_holm?,
            effect: p.effect.as_ref().and_then(|e| e.value),
        })
    };
    DifferencePanel {
        title: format!("{}{}", panel.title, of_group(panel)),
        axis,
        conditions: panel.conditions.clone(),
        rows: panel.rows.clone(),
        omnibus: omnibus(panel, true),
        pairs: panel.contrasts.iter().filter_map(pair).collect(),
        reference: panel.same,
        range: panel.range,
    }
}

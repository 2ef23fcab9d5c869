//! Who prefers what, and what goes with it.

use super::{Run, printed};
use crate::error::StudyError;
use maveric_analysis::{Correlation, HomophilyRow, MixedRow};
use maveric_report::{
    apa,
    claims::LedgerRow,
    figures::{
        family::{Family, FamilyPanel, family},
        preference::{Preferences, ScalePreference, preference},
    },
    html::Section,
    tables::{Cell, Table},
};

/// `None` for a study that declared no family and in which nobody can prefer another style.
pub(super) fn section_homophily(
    run: &Run,
    ledger: &[LedgerRow],
) -> Result<Option<Section>, StudyError> {
    let a = &run.analysis;
    if a.homophily.is_empty() && a.preferences.is_empty() && a.similarity.is_empty() {
        return Ok(None);
    }
    let tested = a.homophily.iter().filter(|r| r.correlation.p.is_some());
    let tested = tested.count();
    let below = |p: fn(&HomophilyRow) -> Option<f64>| {
        let low = |row: &&HomophilyRow| p(row).is_some_and(|p| p < 0.05);
        a.homophily.iter().filter(low).count()
    };
    let (low, holm, bh) = (
        below(|r| r.correlation.p),
        below(|r| r.p_holm),
        below(|r| r.p_bh),
    );
    let mut figures = Vec::new();
    if let Some(bars) = bars(run) {
        figures.push(preference(&bars, &run.context)?);
    }
    if let Some(input) = forest(run, tested) {
        figures.push(family(&input, &run.context)?);
    }
    let family = run.design.homophily().map(|h| h.factors.join(", "));
    let shown = if ledger.is_empty() {
        "those below .05"
    } else {
        "the pairs that the claims name and those below .05 here"
    };
    let intro = (tested > 0).then(|| {
        format!(
            "{tested} correlations of a factor with a rating difference were tested (the declared family: {}): {low} are below .05 as printed ({:.0} would be by \
             chance), {bh} with the false discovery rate controlled (Benjamini and Hochberg), {holm} after Holm. The table shows {shown}, uncorrected.",
            family.unwrap_or_default(),
            0.05 * tested as f64
        )
    });
    Ok(Some(Section {
        title: "Who wants to be driven as they drive?".to_owned(),
        intro: intro.into_iter().collect(),
        figures,
        tables: std::iter::once(correlations(run, ledger))
            .chain(mixed(run))
            .collect(),
    }))
}

/// The pairs of the family that the claims name or that are below .05 here, then similarity.
fn correlations(run: &Run, ledger: &[LedgerRow]) -> Table {
    let a = &run.analysis;
    let shown = |row: &&HomophilyRow| {
        let key = format!("{}.r", row.key());
        row.correlation.p.is_some_and(|p| p < 0.05) || ledger.iter().any(|l| l.claim.key == key)
    };
    let family = a.homophily.iter().filter(shown).map(|row| {
        let key = format!("{}.r", row.key());
        let words = (row.title.as_str(), dependent(run, row));
        (words, &row.correlation, None::<&Correlation>, key)
    });
    let similarity = a.similarity.iter().map(|row| {
        let key = format!("similarity.{}.r", row.rating);
        let words = ("Perceived similarity", row.title.clone());
        (words, &row.pooled, Some(&row.within), key)
    });
    let title = "Personality, driving style and similarity against ratings";
    Table::of("correlations", title, family.chain(similarity))
        .text("Independent", |(words, ..)| words.0)
        .text("Dependent", |(words, ..)| words.1.clone())
        .left("Here", |(_, here, ..)| Cell::said(here.statement().as_ref()))
        .left("Here, repeated measures", |(.., repeated, _)| {
            Cell::said(repeated.and_then(Correlation::statement).as_ref())
        })
        .left("Paper", |(.., key)| Cell::said(printed(ledger, key).as_ref()))
        .noted(format!(
            "*n* = {} participants. Pearson’s *r* where assumptions hold, else Spearman’s *ρ*; *p* values are not adjusted. Rows with more \
             pairs than participants repeat each participant once a condition: *r*_{{rm}} takes that into account. Paper: its own, real \
             participants.",
            a.participants
        ))
}

/// What a factor is held against.
fn dependent(run: &Run, row: &HomophilyRow) -> String {
    format!(
        "{} − {}, {}",
        run.design.label(row.own),
        run.design.label(row.versus),
        row.rating_title
    )
}

/// Who rated another style above their own; `None` where nobody could.
fn bars(run: &Run) -> Option<Preferences> {
    let rated = run.analysis.preferences.iter().filter(|p| p.n > 0);
    let first = rated.clone().next()?;
    Some(Preferences {
        own: first.own,
        others: first.others.iter().map(|o| o.condition).collect(),
        scales: rated
            .map(|p| ScalePreference {
                scale: p.title.clone(),
                n: p.n,
                less_is_better: p.less_is_better,
                above: p.others.iter().map(|o| o.above).collect(),
            })
            .collect(),
    })
}

/// Ratings on the shift of the dial: what the four answers of a person say together; `None` where it was not fitted.
fn mixed(run: &Run) -> Option<Table> {
    let fitted = &run.analysis.mixed;
    let unit = fitted.first()?.unit_points;
    let of = |row: &MixedRow, name: &str| row.model.as_ref()?.fixed.get(name).cloned();
    let estimate =
        |row: &MixedRow, name: &str| Cell::number(of(row, name).map(|found| found.estimate), 2);
    let interval = |row: &MixedRow, name: &str| {
        let ends = of(row, name).and_then(|found| found.ci_low.zip(found.ci_high));
        ends.map_or(Cell::Missing, |(low, high)| {
            Cell::text(format!(
                "{} to {}",
                apa::number(low, 2),
                apa::number(high, 2)
            ))
        })
    };
    let p = |row: &MixedRow, name: &str| {
        let p = of(row, name).and_then(|found| found.p);
        p.map_or(Cell::Missing, |p| {
            Cell::Marked(apa::p(p).markup().to_owned())
        })
    };
    let sd = |row: &MixedRow| row.model.as_ref()?.random_sd.get("shift").copied();
    let mut table = Table::of("mixed", "Ratings on the shift of the dial", fitted)
        .text("Rating", |row| &row.title)
        .right("Shift", |row| estimate(row, "shift"))
        .right("95% CI", |row| interval(row, "shift"))
        .left("Test", |row| p(row, "shift"))
        .right("Shift²", |row| estimate(row, "shift_squared"))
        .right("95% CI", |row| interval(row, "shift_squared"))
        .left("Test", |row| p(row, "shift_squared"))
        .right("*SD* of the shift over people", |row| Cell::number(sd(row), 2))
        .noted(format!(
            "Linear mixed models (REML, Satterthwaite’s degrees of freedom), intercept and shift at random over people; one unit is {unit} points of {} upwards. A negative shift² means that a rating falls on either side of the own style.",
            run.style_label()
        ));
    let missing = fitted
        .iter()
        .filter_map(|r| Some(format!("{}: {}.", r.title, r.why_not.as_ref()?)));
    table.notes.extend(missing);
    Some(table)
}

/// The declared family as a forest; `None` where there is none.
fn forest(run: &Run, tested: usize) -> Option<Family> {
    let found = &run.analysis.homophily;
    let mut factors: Vec<&HomophilyRow> = Vec::new();
    let mut ratings: Vec<&HomophilyRow> = Vec::new();
    let mut series = Vec::new();
    for row in found {
        if !factors.iter().any(|f| f.factor == row.factor) {
            factors.push(row);
        }
        if !ratings.iter().any(|r| r.rating == row.rating) {
            ratings.push(row);
        }
        if !series.contains(&row.versus) {
            series.push(row.versus);
        }
    }
    let cell = |factor: &HomophilyRow, rating: &HomophilyRow, versus| {
        let fits = |r: &&HomophilyRow| {
            r.factor == factor.factor && r.rating == rating.rating && r.versus == versus
        };
        let row = found.iter().find(fits)?;
        let (low, high) = row.simultaneous?;
        Some([row.correlation.r?, low, high])
    };
    let panel = |rating: &&HomophilyRow| FamilyPanel {
        title: rating.rating_title.clone(),
        cells: factors
            .iter()
            .map(|f| series.iter().map(|v| cell(f, rating, *v)).collect())
            .collect(),
    };
    let own = run.label(found.first()?.own);
    Some(Family {
        rows: factors.iter().map(|f| f.title.clone()).collect(),
        panels: ratings.iter().map(panel).collect(),
        what: format!(
            "Each trait against how much better {own} was rated than the condition named above. Intervals hold for all {tested} tests of the \
             declared family at once (95%, Šidák)."
        ),
        participants: run.analysis.participants,
        series,
    })
}

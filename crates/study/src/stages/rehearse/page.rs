//! The page of a rehearsal: its figures and tables.

use super::{Cell, Part, Rehearsal, RehearseOptions, tables};
use crate::{
    error::StudyError,
    mean::mean,
    stages::report::{
        card::{card, number, percent, plot},
        page_of,
    },
};
use maveric_analysis::{Verdict, verdict::within};
use maveric_report::{
    Card, Context, Figure, Report,
    figures::{
        curves::{CurvePanel, CurvePoint, Curves, curves},
        false_positives::{FalsePositives, PartRates, false_positives},
        intervals::IntervalRow,
    },
    html::Section,
};
use maveric_stats::{Proportion, proportion};

/// The tests whose power is drawn: of each part that which most studies found, at the largest size and the planted effects.
fn drawn(found: &Rehearsal) -> Vec<(String, String)> {
    let largest = |c: &&Cell| (c.effect_scale - 1.0).abs() < 1e-12;
    let Some(cell) = found.cells.iter().rfind(largest).or(found.cells.last()) else {
        return Vec::new();
    };
    let best = |part: Part| {
        let mut of_part = cell.tests.iter().filter(|t| t.part == part);
        let first = of_part.next()?;
        let most = of_part.fold(
            first,
            |best, t| if t.rejected > best.rejected { t } else { best },
        );
        Some((most.key.clone(), format!("{}: {}", part.title(), most.key)))
    };
    Part::ALL.into_iter().filter_map(best).collect()
}

pub(super) fn page(found: &Rehearsal, options: &RehearseOptions) -> Result<Report, StudyError> {
    let context = Context::synthetic(options.seed);
    let sections = if found.is_null() {
        let sections = found
            .cells
            .iter()
            .take(1)
            .map(|cell| null_section(cell, &context));
        sections.collect::<Result<Vec<_>, _>>()?
    } else {
        vec![Section {
            title: "Power".to_owned(),
            intro: vec![
                "Effects × 1 are those planted in study_data/effects.toml and study_data/population.toml. They are made up, at about the \
                 sizes that the paper reports: this says what the paper’s design can show if effects are of that size, and nothing about people."
                    .to_owned(),
            ],
            figures: power_figure(found, options, &context)?,
            tables: tables::power_tables(found),
        }]
    };
    let title = if found.is_null() {
        "How often do the tests find what is not there?"
    } else {
        "How many people would it have needed?"
    };
    let subtitle = format!(
        "Synthetic participants: {} studies of each size and scale of the effects, at the level of measures and ratings, not driven",
        options.studies
    );
    let method = "Measures and ratings are drawn from a fitted population and analysed by the code that analyses a run; docs/null-and-power.md gives the generator and its sources.";
    Ok(Report {
        cards: if found.is_null() {
            found.cells.first().map(null_cards).unwrap_or_default()
        } else {
            power_card(found).into_iter().collect()
        },
        sections,
        ..page_of(
            (title, subtitle),
            &context,
            method,
            (options.seed, &options.command),
        )
    })
}

/// What counts as the level of the tests.
const LEVEL: f64 = 0.05;
/// What a study should find of what is there.
const POWER: f64 = 0.8;

/// Is a family kept at its level, and are single tests?
fn null_cards(cell: &Cell) -> Vec<Card> {
    let ends = |p: &Option<Proportion>| p.as_ref().map(Proportion::ends);
    let families = || cell.families.iter();
    let verdicts = families().map(|f| within(cell.studies, ends(&f.any_holm), (0.0, LEVEL)));
    let mut kept = card(
        "families",
        "Is anything found where there is nothing?",
        Verdict::all(verdicts.collect::<Vec<_>>()),
    );
    let worst = families().filter_map(|f| Some((f, f.any_holm.as_ref()?)));
    let worst = worst.max_by(|a, b| a.1.estimate.total_cmp(&b.1.estimate));
    let plain = families()
        .filter_map(|f| Some(f.any_uncorrected.as_ref()?.estimate))
        .reduce(f64::max);
    kept.answer = worst.map_or_else(String::new, |(f, rate)| {
        format!(
            "In at most {} of {} empty studies after Holm ({}); uncorrected, in up to {}.",
            percent(Some(rate.estimate)),
            cell.studies,
            f.family,
            percent(plain)
        )
    });
    "Shown, that is: kept, if in every family the rate of studies with anything below .05 after Holm is at most 5% (Wilson’s 95% interval); fails \
     if in one it is above."
        .clone_into(&mut kept.rule);
    kept.number = worst.and_then(|(f, rate)| {
        number(
            format!("most: {}, {}", f.family, percent(Some(rate.estimate))),
            "0%",
            "5%, the level that was asked for",
        )
    });
    let rows = families().map(|f| IntervalRow::share(f.family.clone(), f.any_holm.as_ref()));
    kept.plot = plot(
        "Studies with a false finding (%)",
        "After Holm; Wilson’s 95% CI",
        Some(5.0),
        rows.take(30).collect(),
    );
    "The people and their answers are made up: real ones may break what the tests assume in other ways."
        .clone_into(&mut kept.doubt);
    kept.see = Some("figure-false-positives".to_owned());
    let tests: Vec<_> = cell
        .tests
        .iter()
        .filter_map(|t| Some((t, t.rate.as_ref()?)))
        .collect();
    let above = tests.iter().filter(|(_, r)| r.low > LEVEL).count();
    let expected = 0.025 * tests.len() as f64;
    let share = proportion(above, tests.len().max(1), 0.95).ok();
    let mut single = card(
        "single",
        "Is each test as strict as it says?",
        within(tests.len(), ends(&share), (0.0, LEVEL)),
    );
    single.answer = format!(
        "Of {} tests, {above} are clearly above 5%; chance alone would make {expected:.0} look so.",
        tests.len()
    );
    "Shown if the share of tests whose own interval lies above 5% is at most 5% (Wilson’s 95% interval); fails if above."
        .clone_into(&mut single.rule);
    let most = tests
        .iter()
        .max_by(|a, b| a.1.estimate.total_cmp(&b.1.estimate));
    single.number = most.and_then(|(t, r)| {
        number(
            format!("most: {}, {}", t.key, percent(Some(r.estimate))),
            "0%",
            "5%",
        )
    });
    let rows = tables::by_part(cell).into_iter().map(|(part, tests)| {
        let rates: Vec<f64> = tests
            .iter()
            .filter_map(|t| t.rate.map(|r| 100.0 * r.estimate))
            .collect();
        let ends = rates
            .iter()
            .copied()
            .reduce(f64::min)
            .zip(rates.iter().copied().reduce(f64::max));
        IntervalRow::new(part.title(), mean(&rates), ends)
    });
    single.plot = plot(
        "Studies with *p* < .05 (%)",
        "Mean of the tests of a part, lowest to highest",
        Some(5.0),
        rows.collect(),
    );
    "Tests of one study share people, so they are not independent.".clone_into(&mut single.doubt);
    single.see = Some("figure-false-positives".to_owned());
    vec![kept, single]
}

/// Would a study of the largest size find what was planted?
fn power_card(found: &Rehearsal) -> Option<Card> {
    let planted = |c: &&Cell| (c.effect_scale - 1.0).abs() < 1e-12;
    let cell = found.cells.iter().rfind(planted).or(found.cells.last())?;
    let rows: Vec<(String, Proportion)> = drawn(found)
        .into_iter()
        .filter_map(|(key, title)| Some((title, cell.tests.iter().find(|t| t.key == key)?.rate?)))
        .collect();
    let verdicts = rows
        .iter()
        .map(|(_, r)| within(cell.studies, Some(r.ends()), (POWER, f64::INFINITY)));
    let mut asked = card(
        "power",
        format!("Would {} people show what was planted?", cell.participants),
        Verdict::all(verdicts.collect::<Vec<_>>()),
    );
    let enough = rows.iter().filter(|(_, r)| r.low >= POWER).count();
    asked.answer = format!(
        "For {enough} of {} questions at least four studies of five would; of each question its best test was taken.",
        rows.len()
    );
    "Shown if for every part of the analysis the test that finds most has *p* < .05 in at least 80% of studies (Wilson’s 95% interval); fails if \
     for one of them fewer do."
        .clone_into(&mut asked.rule);
    let weakest = rows
        .iter()
        .min_by(|a, b| a.1.estimate.total_cmp(&b.1.estimate));
    asked.number = weakest.and_then(|(title, r)| {
        number(
            format!("weakest: {title}, {}", percent(Some(r.estimate))),
            "5%, what nothing at all would give",
            "100%",
        )
    });
    let drawn = rows
        .iter()
        .map(|(title, r)| IntervalRow::share(title.clone(), Some(r)));
    asked.plot = plot(
        "Power (%)",
        "Uncorrected; Wilson’s 95% CI",
        Some(80.0),
        drawn.collect(),
    );
    "The planted sizes are made up, at about what the paper reports: with smaller ones power is less."
        .clone_into(&mut asked.doubt);
    asked.see = Some("figure-power-curves".to_owned());
    Some(asked)
}

fn null_section(cell: &Cell, context: &Context) -> Result<Section, StudyError> {
    let parts = tables::by_part(cell)
        .into_iter()
        .map(|(part, tests)| PartRates {
            name: part.title().to_owned(),
            rates: tests
                .iter()
                .filter_map(|t| t.rate.map(|r| r.estimate))
                .collect(),
        });
    let families = cell.families.iter().filter_map(|f| {
        let holm = f.any_holm?;
        Some((f.family.clone(), holm.estimate, (holm.low, holm.high)))
    });
    let input = FalsePositives {
        parts: parts.collect(),
        families: families.collect(),
        studies: cell.studies,
        participants: cell.participants,
    };
    Ok(Section {
        title: "False positives".to_owned(),
        intro: vec![
            "No condition differs from another, no trait tells anything of a rating, no order, no halo: what is below .05 is there by chance. \
             A test of ranks cannot reach every level: with 24 people and ties its true level may lie a little below .05."
                .to_owned(),
        ],
        figures: vec![false_positives(&input, context)?],
        tables: tables::null_tables(cell),
    })
}

fn power_figure(
    found: &Rehearsal,
    options: &RehearseOptions,
    context: &Context,
) -> Result<Vec<Figure>, StudyError> {
    let shown: Vec<f64> = options.effect_scales.iter().copied().take(5).collect();
    let points = |scale: f64, key: &str| -> Vec<CurvePoint> {
        let rates = tables::curve(&found.cells, scale, key).into_iter();
        rates
            .map(|(n, r)| CurvePoint {
                x: n as f64,
                y: r.estimate,
                low: r.low,
                high: r.high,
            })
            .collect()
    };
    let panels: Vec<CurvePanel> = drawn(found)
        .into_iter()
        .map(|(key, title)| CurvePanel {
            title,
            y: "Power".to_owned(),
            curves: shown.iter().map(|scale| points(*scale, &key)).collect(),
        })
        .filter(|panel| panel.curves.iter().any(|c| !c.is_empty()))
        .collect();
    if panels.is_empty() {
        return Ok(Vec::new());
    }
    let reached: Vec<String> = found
        .signs
        .iter()
        .filter_map(|row| Some(format!("{}: {:.0} people.", row.text, row.n_for_80?)))
        .collect();
    let input = Curves {
        name: "power-curves".to_owned(),
        title: "Power by number of participants".to_owned(),
        caption: format!(
            "Share of {} synthetic studies with *p* < .05 (uncorrected), 95% intervals; dashed: .8.",
            options.studies
        ),
        alt: format!(
            "For a power of .8 at the planted sizes: {}",
            reached.join(" ")
        ),
        x: "Participants".to_owned(),
        curves: shown.iter().map(|s| format!("effects × {s}")).collect(),
        rule: Some(0.8),
        range: Some((0.0, 1.0)),
        panels,
    };
    Ok(vec![curves(&input, context)?])
}

//! The page of a rehearsal: its figures and tables.

use super::{Cell, Rehearsal, RehearseOptions, tables};
use crate::{
    error::StudyError,
    mean::mean,
    stages::report::{
        card::{card, number, percent, plot, share_row},
        page_of,
    },
};
use maveric_analysis::Verdict;
use maveric_rehearsal::{ALPHA, Judge, POWER};
use maveric_report::{
    Card, Context, Figure, Report,
    figures::{
        curves::{CurvePanel, CurvePoint, Curves, curves},
        false_positives::{FalsePositives, PartRates, false_positives},
        intervals::IntervalRow,
    },
    html::Section,
};

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
                "Effects × 1 are those that the made-up people were given, at about the sizes that the paper reports: this says what this design \
                 can show if effects are of that size, and nothing about people."
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
            null_cards(found)
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

/// Is a family kept at its level, and are single tests?
fn null_cards(found: &Rehearsal) -> Vec<Card> {
    let (Some(cell), [of_families, of_tests]) = (found.cells.first(), &found.findings[..]) else {
        return Vec::new();
    };
    let families = || cell.families.iter();
    let mut kept = card(of_families, "Is anything found where there is nothing?");
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
    let above = tests.iter().filter(|(_, r)| r.low > ALPHA).count();
    let expected = 0.025 * tests.len() as f64;
    let mut single = card(of_tests, "Is each test as strict as it says?");
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
    let (cell, finding) = (found.largest()?, found.findings.first()?);
    let (judge, parts) = (cell.judge(), finding.parts.as_slice());
    let what = match judge {
        Judge::Hypotheses => "what the design declares",
        Judge::BestTests => "what was planted",
    };
    let scale = if (cell.effect_scale - 1.0).abs() < 1e-12 {
        String::new()
    } else {
        format!(", with effects × {}", cell.effect_scale)
    };
    let mut asked = card(
        finding,
        format!("Would {} people show {what}{scale}?", cell.participants),
    );
    let enough = finding.count(Verdict::Shown);
    asked.answer = match (&judge, parts) {
        (Judge::Hypotheses, [only]) => {
            let share = percent(only.estimate);
            format!("“{}” would be shown in {share} of studies.", only.of)
        }
        (Judge::Hypotheses, rows) => format!(
            "{enough} of {} declared hypotheses would be shown in at least four studies of five.",
            rows.len()
        ),
        (Judge::BestTests, rows) => format!(
            "The design declares no hypothesis. For {enough} of {} parts of the analysis at least four studies of five would find something, by \
             the best test of each.",
            rows.len()
        ),
    };
    let rule = match judge {
        Judge::Hypotheses => {
            "Shown if every declared hypothesis is shown, by its own rule, in at least 80% of studies (Wilson’s 95% interval); fails if one is \
             shown in fewer."
        }
        Judge::BestTests => {
            "Shown if for every part of the analysis the test that finds most has *p* < .05 in at least 80% of studies (Wilson’s 95% interval); \
             fails if for one of them fewer do."
        }
    };
    rule.clone_into(&mut asked.rule);
    let weakest = finding.least(|part| part.estimate);
    let weakest = weakest.filter(|part| part.estimate.is_some());
    asked.number = weakest.and_then(|part| {
        number(
            format!("weakest: {}, {}", part.of, percent(part.estimate)),
            "at most 5%, what nothing at all would give",
            "100%",
        )
    });
    let drawn = parts.iter().map(|part| share_row(part.of.clone(), part));
    let corrected = match judge {
        Judge::Hypotheses => "By each hypothesis’s own rule",
        Judge::BestTests => "Uncorrected",
    };
    asked.plot = plot(
        "Power (%)",
        &format!("{corrected}; Wilson’s 95% CI"),
        Some(100.0 * POWER),
        drawn.collect(),
    );
    let doubt = match judge {
        Judge::Hypotheses => {
            "The planted sizes are made up, at about what the paper reports: with smaller ones power is less."
        }
        Judge::BestTests => {
            "The best of many tests flatters: declare a hypothesis and rehearse again. The planted sizes are made up."
        }
    };
    doubt.clone_into(&mut asked.doubt);
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
    let points = |scale: f64,
                  rate: &dyn Fn(&Cell) -> Option<maveric_stats::Proportion>|
     -> Vec<CurvePoint> {
        let rates = tables::curve(&found.cells, scale, rate).into_iter();
        rates
            .map(|(n, r)| CurvePoint {
                x: n as f64,
                y: r.estimate,
                low: r.low,
                high: r.high,
            })
            .collect()
    };
    let panel =
        |title: String, rate: &dyn Fn(&Cell) -> Option<maveric_stats::Proportion>| CurvePanel {
            title,
            y: "Power".to_owned(),
            curves: shown.iter().map(|scale| points(*scale, rate)).collect(),
        };
    let mut panels: Vec<CurvePanel> = Vec::new();
    if let Some(cell) = found.largest() {
        panels.extend(
            cell.hypotheses
                .iter()
                .enumerate()
                .map(|(i, h)| panel(h.says.clone(), &|c| c.hypotheses.get(i)?.shown)),
        );
        panels.extend(cell.best_tests().into_iter().map(|test| {
            let title = format!("{}: {}", test.part.title(), test.key);
            panel(title, &|c| tables::rate_of(c, &test.key))
        }));
    }
    panels.retain(|panel| panel.curves.iter().any(|c| !c.is_empty()));
    if panels.is_empty() {
        return Ok(Vec::new());
    }
    let declared = found.largest().is_some_and(|c| !c.hypotheses.is_empty());
    let reached: Vec<String> = found
        .signs
        .iter()
        .filter_map(|row| Some(format!("{}: {:.0} people.", row.text, row.n_for_80?)))
        .collect();
    let input = Curves {
        name: "power-curves".to_owned(),
        title: "Power by number of participants".to_owned(),
        caption: format!(
            "Share of {} synthetic studies{}, 95% intervals; dashed: .8.",
            options.studies,
            if declared {
                " in which a declared hypothesis is shown by its own rule, then of those in which the best test of each part has *p* < .05 (uncorrected)"
            } else {
                " with *p* < .05 (uncorrected), by the best test of each part"
            }
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

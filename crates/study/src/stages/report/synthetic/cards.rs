//! The answers that a study's page opens with, from its typed results.

use super::{Run, enumerated, said};
use crate::stages::report::answers::{card, interval, number, percent, plot};
use maveric_analysis::{
    Contrast, Judged, Nearer, Panel, Reproduction, Verdict,
    verdict::{FEWEST, directed, within},
};
use maveric_domain::{ConditionId, design::Sign};
use maveric_report::{
    Card, apa,
    claims::{LedgerRow, verdict_counts},
    figures::intervals::{IntervalRow, Intervals},
    markup,
    tables::Reliability,
};
use maveric_stats::{Adjustment, proportion};

/// A card a question, in the order in which a reader asks: what was declared first, then does it work, for whom, can it be trusted.
pub(super) fn cards(
    run: &Run,
    reliabilities: &[Reliability],
    ledger: Option<&[LedgerRow]>,
) -> Vec<Card> {
    let declared = run.analysis.hypotheses.iter().enumerate();
    let mut found: Vec<Card> = declared.map(|(i, h)| hypothesis(run, i, h)).collect();
    found.extend(own_style(run));
    found.extend(nearer(run));
    found.extend(expected(run, true));
    found.extend(expected(run, false));
    if found.is_empty() {
        found.extend(conditions(run));
    }
    found.extend(line(run, reliabilities));
    found.extend(across(run));
    found.extend(preferred(run));
    found.extend(homophily(run));
    found.extend(ledger.map(against_the_paper));
    found
}

fn hypothesis(run: &Run, i: usize, h: &Judged) -> Card {
    let mut found = card(&format!("hypothesis-{}", i + 1), h.says.clone(), h.verdict);
    let (first, second) = (run.label(h.first), run.label(h.second));
    found.answer = match h.mean_difference {
        Some(d) => {
            let way = if d < 0.0 { "below" } else { "above" };
            format!(
                "On average {first} lies {} {way} {second} ({} people).",
                apa::number(d.abs(), 2),
                h.n
            )
        }
        None => format!("{} people have both values.", h.n),
    };
    found.rule = format!("{}. Declared with the study.", capital(&h.rule));
    let row = IntervalRow::new(
        format!("{} − {}", markup::plain(&first), markup::plain(&second)),
        h.mean_difference,
        h.interval,
    );
    found.plot = plot("Mean difference", "95% CI", Some(0.0), vec![row]).map(|p| Intervals {
        bounds: h.bounds,
        ..p
    });
    found.number = number(
        format!(
            "mean difference {}{}",
            h.mean_difference
                .map_or_else(|| "not known".to_owned(), |d| apa::number(d, 2)),
            interval(h.interval, 2)
        ),
        "0, no difference",
        "none: a difference has no upper end",
    );
    "The interval is of this contrast alone; the p of the rule is corrected over all contrasts of the outcome."
        .clone_into(&mut found.doubt);
    found.see = Some("table-contrasts".to_owned());
    found.tests =
        h.p.map(|p| apa::p(p).markup().to_owned())
            .into_iter()
            .collect();
    found
}

/// Does the car at 0 on the dial drive as the person does?
fn own_style(run: &Run) -> Option<Card> {
    let rows = &run.analysis.reproduction;
    let label = run.label(rows.first()?.condition);
    let verdicts = rows
        .iter()
        .map(|r| r.bias.as_ref().map_or(Verdict::NotAsked, |b| b.verdict));
    let mut found = card(
        "own-style",
        format!("Does {} drive as its driver does?", markup::plain(&label)),
        Verdict::all(verdicts),
    );
    let same = |r: &&Reproduction| r.bias.as_ref().is_some_and(|b| b.verdict == Verdict::Shown);
    let off: Vec<String> = rows
        .iter()
        .filter(|r| !same(r))
        .filter_map(|r| {
            let b = r.bias.as_ref()?;
            let unit = if b.unit.is_empty() {
                String::new()
            } else {
                format!(" {}", b.unit)
            };
            let more = if b.mean < 0.0 { "less" } else { "more" };
            Some(format!(
                "{} {}{unit} {more}",
                r.title.to_lowercase(),
                apa::number(b.mean.abs(), 2)
            ))
        })
        .collect();
    let count = rows.iter().filter(same).count();
    found.answer = if off.is_empty() {
        format!(
            "On average it is as fast, as close and as busy as its driver, in all {count} measures."
        )
    } else {
        format!(
            "In {count} of {} measures it is the same on average; not shown for {}.",
            rows.len(),
            enumerated(&off)
        )
    };
    "Shown if for every measure two one-sided *t* tests place the mean difference within what counts as none (both *p* < .05); fails if one \
     places a mean outside. What counts as none is declared in the design, else half a standard deviation between people’s own drives."
        .clone_into(&mut found.rule);
    let worst = rows.iter().filter(|r| r.mean.is_some());
    let worst = worst.min_by(|a, b| a.mean.unwrap_or(1.0).total_cmp(&b.mean.unwrap_or(1.0)));
    found.number = worst.and_then(|r| {
        number(
            format!(
                "least accurate: {}, {}",
                r.title.to_lowercase(),
                percent(r.mean)
            ),
            format!(
                "guessing the average driver, {}",
                percent(r.population_mean)
            ),
            r.second_drive.map_or_else(
                || "a second drive, of which there is none here".to_owned(),
                |s| format!("the driver’s own second drive, {}", percent(Some(s))),
            ),
        )
    });
    let scaled = rows.iter().map(|r| {
        let b = r.bias.as_ref();
        let scale = b.map_or(1.0, |b| b.same_within);
        IntervalRow::new(
            r.title.clone(),
            b.map(|b| b.mean / scale),
            b.and_then(|b| b.interval)
                .map(|(low, high)| (low / scale, high / scale)),
        )
    });
    found.plot = plot(
        "Difference from the own drive (1: as much as counts as none)",
        "Mean of car − driver, ordinary 95% CI",
        Some(0.0),
        scaled.collect(),
    )
    .map(|p| Intervals {
        bounds: Some((-1.0, 1.0)),
        ..p
    });
    "A mean can be right while persons are not: accuracy person by person, its floor and its ceiling stand in the table."
        .clone_into(&mut found.doubt);
    found.see = Some("table-accuracy".to_owned());
    let accuracy: Vec<String> = rows
        .iter()
        .map(|r| format!("{} {}", r.title.to_lowercase(), percent(r.mean)))
        .collect();
    found.tests = vec![format!("Accuracy of {label}: {}", accuracy.join(", "))];
    found.tests.extend(rows.iter().filter_map(|r| {
        let b = r.bias.as_ref()?;
        let t = apa::t(b.t?, b.df as f64, b.p?, Adjustment::None, None);
        let equivalent = apa::p(b.p_equivalent?);
        Some(format!(
            "{}: *M* = {}{}, {}; equivalence within ±{}: {}",
            r.title,
            apa::number(b.mean, 2),
            interval(b.interval, 2),
            t.markup(),
            apa::number(b.same_within, 2),
            equivalent.markup()
        ))
    }));
    Some(found)
}

/// Is it nearer to its driver than the other cars are?
fn nearer(run: &Run) -> Option<Card> {
    let rows = &run.analysis.nearer;
    let label = run.label(rows.first()?.condition);
    let verdict = |r: &Nearer| directed(r.n, r.effect, r.p_holm, Sign::Plus);
    let mut found = card(
        "nearer",
        format!(
            "Is {} nearer to its driver than the other cars?",
            markup::plain(&label)
        ),
        Verdict::all(rows.iter().map(verdict)),
    );
    let shown = rows.iter().filter(|r| verdict(r) == Verdict::Shown).count();
    let [near, tied, far] = rows.iter().fold([0; 3], |[a, b, c], r| {
        [a + r.nearer, b + r.tied, c + r.farther]
    });
    let all = (near + tied + far).max(1) as f64;
    let share = |part: usize| format!("{:.0}%", 100.0 * part as f64 / all);
    found.answer = format!(
        "In {shown} of {} comparisons; over people and comparisons it is nearer in {}, as near in {}, farther in {}.",
        rows.len(),
        share(near),
        share(tied),
        share(far)
    );
    "Shown if in every comparison |car − driver| is the smaller by Wilcoxon’s signed ranks (*p* < .05 after Holm over all of them); \
     fails if in one it is the larger by the same rule. The direction is that of the ranks; ties count for neither."
        .clone_into(&mut found.rule);
    let weakest = rows
        .iter()
        .min_by(|a, b| a.effect.unwrap_or(1.0).total_cmp(&b.effect.unwrap_or(1.0)));
    found.number = weakest.and_then(|r| {
        number(
            format!(
                "weakest: {} against {}, rank-biserial {}",
                r.title.to_lowercase(),
                run.label(r.than),
                r.effect
                    .map_or_else(|| "not known".to_owned(), |e| apa::bounded(e, 2))
            ),
            "0, as often farther",
            "1, nearer for everybody",
        )
    });
    let mut shown_rows: Vec<&Nearer> = Vec::new();
    for row in rows {
        let lower = |a: &Nearer, b: &Nearer| a.effect.unwrap_or(1.0) < b.effect.unwrap_or(1.0);
        match shown_rows.iter_mut().find(|s| s.measure == row.measure) {
            Some(known) if lower(row, known) => *known = row,
            Some(_) => {}
            None => shown_rows.push(row),
        }
    }
    let shown_rows = shown_rows
        .into_iter()
        .map(|r| IntervalRow::new(r.title.clone(), r.effect, r.interval));
    found.plot = plot(
        "Rank-biserial *r* (above 0: nearer)",
        "95% CI; of each measure the comparison that is least clear",
        Some(0.0),
        shown_rows.collect(),
    );
    "A car that is nearer may still be far: see how far off it is on average."
        .clone_into(&mut found.doubt);
    found.see = Some("table-nearer".to_owned());
    found.tests = rows
        .iter()
        .filter_map(|r| {
            Some(format!(
                "{}, {}: nearer/tied/farther {}/{}/{}, {}",
                r.title,
                run.label(r.than),
                r.nearer,
                r.tied,
                r.farther,
                apa::p_holm(r.p_holm?).markup()
            ))
        })
        .collect();
    Some(found)
}

/// The panels of everybody with a contrast of which a direction was expected: measures, or ratings.
fn directed_panels(run: &Run, measured: bool) -> Vec<(&Panel, Vec<&Contrast>)> {
    let whole = run.analysis.panels.iter().filter(|p| p.group.is_none());
    whole
        .filter(|p| p.outcome.contains('.') != measured)
        .map(|p| {
            (
                p,
                p.contrasts
                    .iter()
                    .filter(|c| c.expected.is_some())
                    .collect::<Vec<_>>(),
            )
        })
        .filter(|(_, contrasts)| !contrasts.is_empty())
        .collect()
}

/// Of these contrasts the one between the places that lie furthest apart on the dial.
fn widest<'a>(run: &Run, contrasts: &[&'a Contrast]) -> Option<&'a Contrast> {
    let dial = |id: ConditionId| {
        run.design
            .condition(id)
            .and_then(maveric_domain::design::Condition::dial)
            .unwrap_or(0.0)
    };
    let apart = |c: &Contrast| (dial(c.first) - dial(c.second)).abs();
    contrasts
        .iter()
        .copied()
        .max_by(|a, b| apart(a).total_cmp(&apart(b)))
}

/// Do the conditions differ the way that was expected: in what was measured, or in what people said?
fn expected(run: &Run, measured: bool) -> Option<Card> {
    let panels = directed_panels(run, measured);
    let first = widest(run, &panels.first()?.1)?;
    let all = || {
        panels
            .iter()
            .flat_map(|(p, cs)| cs.iter().map(move |c| (*p, *c)))
    };
    let judge = |(p, c): (&Panel, &Contrast)| {
        c.expected.map_or(Verdict::NotAsked, |sign| {
            directed(p.n, c.mean_difference, c.p_holm, sign)
        })
    };
    let verdicts: Vec<Verdict> = all().map(judge).collect();
    let (name, question) = match (measured, run.design.style().is_some()) {
        (true, true) => (
            "dial",
            "Does turning the dial change the driving as it says?",
        ),
        (true, false) => (
            "expected",
            "Do the conditions drive the way that was expected?",
        ),
        (false, _) => ("noticed", "Do people feel the difference that was meant?"),
    };
    let mut found = card(name, question, Verdict::all(verdicts.iter().copied()));
    let right = all().filter(|(_, c)| c.mean_difference.and_then(Sign::of) == c.expected);
    let count = |v: Verdict| verdicts.iter().filter(|found| **found == v).count();
    found.answer = format!(
        "{} of {} differences lie the expected way, {} of them clearly; {} clearly the other way.",
        right.count(),
        verdicts.len(),
        count(Verdict::Shown),
        count(Verdict::Fails)
    );
    let from = if run.design.style().is_some() {
        "What is expected follows from the places on the dial or stands in the design."
    } else {
        "What is expected stands in the design."
    };
    found.rule = format!(
        "Shown if every contrast with an expected direction lies that way with *p* < .05 (two-sided, Holm over the contrasts of its outcome); fails \
         if one lies the other way by the same rule. {from}"
    );
    let share = |c: &Contrast| {
        let [above, tied, below] = c.people;
        let hits = if c.expected == Some(Sign::Plus) {
            above
        } else {
            below
        };
        let n = above + tied + below;
        let p = proportion(hits, n, 0.95).ok().filter(|_| n >= FEWEST)?;
        Some((100.0 * p.estimate, (100.0 * p.low, 100.0 * p.high)))
    };
    let rows = panels.iter().filter_map(|(p, contrasts)| {
        let found = share(widest(run, contrasts)?);
        let (estimate, ends) = found.unzip();
        Some(IntervalRow::new(p.title.clone(), estimate, ends))
    });
    let pair = format!(
        "{} against {}",
        run.label(first.first),
        run.label(first.second)
    );
    let rows: Vec<IntervalRow> = rows.collect();
    let lowest = rows.iter().filter_map(|r| Some((r, r.estimate?)));
    let lowest = lowest.min_by(|a, b| a.1.total_cmp(&b.1));
    found.number = lowest.and_then(|(row, share)| {
        number(
            format!(
                "{pair}: {} as expected for {share:.0}% of people",
                row.label.to_lowercase()
            ),
            "50%, a coin",
            "100%, everybody",
        )
    });
    found.plot = plot(
        "People for whom it lies the expected way (%)",
        &format!("{pair}; Wilson’s 95% CI"),
        Some(50.0),
        rows,
    );
    found.doubt = doubt_of_the_dial(run)
        .filter(|_| measured)
        .unwrap_or_else(|| {
            "The same people saw every condition: an answer may follow what came before it."
                .to_owned()
        });
    let steps = measured && !super::embedding::steps(run).is_empty();
    found.see = Some(
        if steps {
            "table-dial-steps"
        } else {
            "table-contrasts"
        }
        .to_owned(),
    );
    found.tests = panels.iter().map(|(p, _)| over_conditions(p)).collect();
    found.tests.extend(all().filter_map(|(p, c)| {
        Some(format!(
            "{}, {} − {}: {}",
            p.title,
            run.label(c.first),
            run.label(c.second),
            super::conditions::paired(p, c)?
        ))
    }));
    Some(found)
}

/// The test over the conditions, in words.
fn over_conditions(panel: &Panel) -> String {
    format!(
        "{} over the conditions: {}",
        panel.title,
        super::conditions::omnibus(panel, false)
    )
}

/// How often the end of the scale cut a step short.
fn doubt_of_the_dial(run: &Run) -> Option<String> {
    let asked = run
        .conditions
        .iter()
        .filter(|c| c.moved_points.is_some_and(|m| m.abs() > 0.0) || c.clamped);
    let (cut, all) = asked.fold((0, 0), |(cut, all), c| {
        (cut + usize::from(c.clamped), all + 1)
    });
    (all > 0).then(|| {
        format!("The end of the scale cut {cut} of {all} steps short: those people were moved by less than was asked for.")
    })
}

/// Do the conditions differ at all? Where nothing else was expected of them.
fn conditions(run: &Run) -> Option<Card> {
    let panels: Vec<&Panel> = run
        .analysis
        .panels
        .iter()
        .filter(|p| p.group.is_none())
        .collect();
    let differs = |p: &Panel| {
        let clear = p
            .contrasts
            .iter()
            .any(|c| c.p_holm.is_some_and(|p| p < 0.05));
        match (p.n, clear) {
            (0, _) => Verdict::NotAsked,
            (n, _) if n < FEWEST => Verdict::TooFew,
            (_, true) => Verdict::Shown,
            _ => Verdict::NotShown,
        }
    };
    let verdicts: Vec<Verdict> = panels.iter().map(|p| differs(p)).collect();
    let clear: Vec<String> = panels
        .iter()
        .zip(&verdicts)
        .filter(|(_, v)| **v == Verdict::Shown)
        .map(|(p, _)| p.title.to_lowercase())
        .collect();
    let mut found = card(
        "differ",
        "Do the conditions differ?",
        Verdict::any(verdicts),
    );
    found.answer = if clear.is_empty() {
        format!("In none of {} outcomes clearly.", panels.len())
    } else {
        format!(
            "In {} of {} outcomes: {}.",
            clear.len(),
            panels.len(),
            enumerated(&clear)
        )
    };
    "Shown if in one outcome a declared contrast has *p* < .05 after Holm over the contrasts of that outcome; outcomes are not corrected \
     for one another."
        .clone_into(&mut found.rule);
    "Nothing was declared of which way they should differ, so any difference counts."
        .clone_into(&mut found.doubt);
    found.see = Some("table-contrasts".to_owned());
    found.tests = panels.iter().map(|p| over_conditions(p)).collect();
    (!panels.is_empty()).then_some(found)
}

/// Does the learned style hold what the driver's score says?
fn line(run: &Run, reliabilities: &[Reliability]) -> Option<Card> {
    let a = &run.analysis;
    let score =
        |line: &maveric_analysis::AggressionLine| line.rows.last().map(|r| r.correlation.clone());
    let with = a.line.as_ref().and_then(score);
    let without = a.line_without_adb.as_ref().and_then(score);
    let decides = without.as_ref().or(with.as_ref())?;
    let mut found = card(
        "style",
        format!("Does driving alone tell the {}?", run.style_label()),
        directed(decides.n, decides.r, decides.p, Sign::Plus),
    );
    let r = decides.r.unwrap_or(0.0);
    found.answer = format!(
        "Of {} people, the style that was learned from a drive alone explains {:.0}% of how their scores differ.",
        decides.n,
        100.0 * r * r
    );
    format!(
        "Shown if the position on the line of {} goes with the score (*p* < .05) although the score took no part in the fit; fails if it goes \
         against it.",
        run.style_label()
    )
    .clone_into(&mut found.rule);
    let row = |label: &str, c: &maveric_analysis::Correlation| {
        IntervalRow::new(label, c.r, c.ci_low.zip(c.ci_high))
    };
    let style = run.design.style()?;
    let wanted = style.score.to_string();
    let alpha = reliabilities
        .iter()
        .find(|r| r.id == wanted)
        .and_then(|r| r.alpha);
    let ceiling = alpha.filter(|a| *a > 0.0).map(f64::sqrt);
    let mut rows: Vec<IntervalRow> = without
        .iter()
        .map(|c| row("Fitted without the score", c))
        .collect();
    rows.extend(with.iter().map(|c| row("Fitted with it", c)));
    for row in &mut rows {
        (row.floor, row.ceiling) = (Some(0.0), ceiling);
    }
    found.plot = plot("Correlation with the score", "95% CI", Some(0.0), rows);
    found.number = number(
        format!(
            "*r* = {}{}",
            apa::bounded(r, 2),
            interval(decides.ci_low.zip(decides.ci_high), 2)
        ),
        "0, driving tells nothing",
        match (ceiling, alpha) {
            (Some(c), Some(alpha)) => format!(
                "{}, the root of the score’s α of {}",
                apa::bounded(c, 2),
                apa::bounded(alpha, 2)
            ),
            _ => "1: the score’s reliability is not known here".to_owned(),
        },
    );
    "Fitted with the score the correlation is partly built in; what a line holds need not be what the car does with it."
        .clone_into(&mut found.doubt);
    found.see = Some("table-embedding-line".to_owned());
    found.tests = [("without the score", &without), ("with the score", &with)]
        .into_iter()
        .filter_map(|(how, c)| {
            Some(format!(
                "Position on the line of {}, fitted {how}: {}",
                run.style_label(),
                said(c.as_ref()?)
            ))
        })
        .collect();
    Some(found)
}

/// Does moving across the dial change a habit that the dial leaves alone?
fn across(run: &Run) -> Option<Card> {
    let kept = &run.analysis.kept;
    let label = run.label(kept.first()?.across);
    let verdicts = kept
        .iter()
        .map(|k| directed(k.points.len(), k.circular_r, k.circular_p_holm, Sign::Plus));
    let mut found = card(
        "across",
        format!(
            "Does {} change a habit other than aggression?",
            markup::plain(&label)
        ),
        Verdict::any(verdicts.collect::<Vec<_>>()),
    );
    let clear = |k: &&maveric_analysis::Kept| k.circular_p_holm.is_some_and(|p| p < 0.05);
    let titles: Vec<String> = kept
        .iter()
        .filter(clear)
        .map(|k| k.title.to_lowercase())
        .collect();
    found.answer = if titles.is_empty() {
        format!(
            "None of {} habits clearly follows where a person was moved to.",
            kept.len()
        )
    } else {
        format!(
            "Where a person was moved to tells how this changes: {}.",
            enumerated(&titles)
        )
    };
    "Shown if the change of at least one habit goes with cosine and sine of the angle of the move (*p* < .05, Holm over the habits)."
        .clone_into(&mut found.rule);
    let rows = kept.iter().map(|k| {
        let mut row = IntervalRow::new(k.title.clone(), k.circular_r, None);
        row.floor = chance(k.points.len());
        row
    });
    found.plot = plot(
        "Multiple *R* with the angle",
        "No interval",
        Some(0.0),
        rows.collect(),
    );
    let strongest = kept.iter().max_by(|a, b| {
        a.circular_r
            .unwrap_or(0.0)
            .total_cmp(&b.circular_r.unwrap_or(0.0))
    })?;
    found.number = number(
        format!(
            "{}: *R* = {}",
            strongest.title.to_lowercase(),
            strongest
                .circular_r
                .map_or_else(|| "n/a".to_owned(), |r| apa::bounded(r, 2))
        ),
        chance(strongest.points.len()).map_or_else(
            || "not known".to_owned(),
            |c| format!("{}, what chance gives on average", apa::bounded(c, 2)),
        ),
        "1",
    );
    "An angle has no natural zero: a correlation with the bare angle, as the paper has it, depends on where counting starts."
        .clone_into(&mut found.doubt);
    found.see = Some("figure-perpendicular".to_owned());
    found.tests = kept
        .iter()
        .filter_map(|k| {
            let p = apa::p_holm(k.circular_p_holm?);
            Some(format!(
                "{}: *R* = {}, {}",
                k.title,
                apa::bounded(k.circular_r?, 2),
                p.markup()
            ))
        })
        .collect();
    Some(found)
}

/// Multiple R of two predictors that tell nothing, on average: √(2 / (n − 1)).
fn chance(n: usize) -> Option<f64> {
    (n > 3).then(|| (2.0 / (n as f64 - 1.0)).sqrt())
}

/// Would people rather be driven as they drive?
fn preferred(run: &Run) -> Option<Card> {
    let rated: Vec<_> = run
        .analysis
        .preferences
        .iter()
        .filter(|p| p.n > 0)
        .collect();
    let first = rated.first()?;
    let all = || {
        rated
            .iter()
            .flat_map(|p| p.others.iter().map(move |o| (*p, o)))
    };
    let ends = |o: &maveric_analysis::Above| o.share.as_ref().map(|s| (s.low, s.high));
    let verdicts = all().map(|(p, o)| within(p.n, ends(o), (0.0, 0.5)));
    let mut found = card(
        "preferred",
        "Do people prefer their own style?",
        Verdict::all(verdicts.collect::<Vec<_>>()),
    );
    let shares: Vec<String> = first
        .others
        .iter()
        .enumerate()
        .map(|(at, o)| {
            let above: usize = rated
                .iter()
                .filter_map(|p| p.others.get(at))
                .map(|o| o.above)
                .sum();
            let n: usize = rated.iter().map(|p| p.n).sum();
            format!(
                "{} in {:.0}%",
                run.label(o.condition),
                100.0 * above as f64 / n.max(1) as f64
            )
        })
        .collect();
    found.answer = format!(
        "Over {} ratings, people put another style above their own: {}.",
        rated.len(),
        enumerated(&shares)
    );
    "Shown if for every rating fewer than half put another style above their own (Wilson’s 95% interval below 50%); fails if for one of \
     them more than half do."
        .clone_into(&mut found.rule);
    let rows = all().map(|(p, o)| {
        let share = o.share.as_ref();
        IntervalRow::new(
            format!("{}, {}", p.title, run.design.label(o.condition)),
            share.map(|s| 100.0 * s.estimate),
            share.map(|s| (100.0 * s.low, 100.0 * s.high)),
        )
    });
    found.plot = plot(
        "Put the other style above their own (%)",
        "Wilson’s 95% CI",
        Some(50.0),
        rows.take(8).collect(),
    );
    let most = all().filter_map(|(p, o)| Some((p, o, o.share.as_ref()?.estimate)));
    let most = most.max_by(|a, b| a.2.total_cmp(&b.2));
    found.number = most.and_then(|(p, o, share)| {
        number(
            format!(
                "most: {} by {}, {}",
                run.label(o.condition),
                p.title.to_lowercase(),
                percent(Some(share))
            ),
            "50%, a coin",
            "0%, everybody prefers their own",
        )
    });
    "A tie counts as not above. A rating of one ride says little of a preference: the mixed model takes all rides of a person together."
        .clone_into(&mut found.doubt);
    found.see = Some("figure-preference".to_owned());
    found.tests = all()
        .filter_map(|(p, o)| {
            let s = o.share.as_ref()?;
            Some(format!(
                "{}, {}: {} of {}, {}{}",
                p.title,
                run.label(o.condition),
                o.above,
                p.n,
                percent(Some(s.estimate)),
                interval(Some((100.0 * s.low, 100.0 * s.high)), 0)
            ))
        })
        .collect();
    Some(found)
}

/// Does what people are like tell whose style they want?
fn homophily(run: &Run) -> Option<Card> {
    let rows = &run.analysis.homophily;
    let tested: Vec<_> = rows.iter().filter(|r| r.p_holm.is_some()).collect();
    if rows.is_empty() {
        return None;
    }
    let clear = |p: Option<f64>| p.is_some_and(|p| p < 0.05);
    let verdicts = tested.iter().map(|r| match r.correlation.n {
        n if n < FEWEST => Verdict::TooFew,
        _ if clear(r.p_holm) => Verdict::Shown,
        _ => Verdict::NotShown,
    });
    let mut found = card(
        "personality",
        "Does personality tell which style one wants?",
        Verdict::any(verdicts.collect::<Vec<_>>()),
    );
    let kept = tested.iter().filter(|r| clear(r.p_holm)).count();
    let low = tested.iter().filter(|r| clear(r.correlation.p)).count();
    found.answer = format!(
        "Of {} declared pairs of a trait and a rating, {kept} hold when all are counted; {low} look clear alone, where {:.0} would by chance.",
        tested.len(),
        0.05 * tested.len() as f64
    );
    "Shown if one correlation of the declared family has *p* < .05 after Holm over the whole family.".clone_into(&mut found.rule);
    let mut strongest = tested.clone();
    let size = |r: &maveric_analysis::HomophilyRow| r.correlation.r.unwrap_or(0.0).abs();
    strongest.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let named = strongest.iter().take(5).map(|r| {
        let label = format!("{} / {}", r.title, r.rating_title);
        IntervalRow::new(label, r.correlation.r, r.simultaneous)
    });
    found.plot = plot(
        "Correlation",
        "The five strongest, with intervals that hold for all at once (95%)",
        Some(0.0),
        named.collect(),
    );
    let top = strongest.first()?;
    found.number = number(
        format!(
            "strongest: {} and {}, {}",
            top.title.to_lowercase(),
            top.rating_title.to_lowercase(),
            said(&top.correlation)
        ),
        "0, nothing to tell",
        "1",
    );
    format!(
        "With {} people only correlations above about ±{} could hold in a family of this size.",
        run.analysis.participants,
        tested
            .iter()
            .filter_map(|r| r.simultaneous.map(|(low, high)| 0.5 * (high - low)))
            .reduce(f64::max)
            .map_or_else(|| ".7".to_owned(), |half| apa::bounded(half, 2))
    )
    .clone_into(&mut found.doubt);
    found.see = Some("figure-family".to_owned());
    found.tests = strongest
        .iter()
        .take(5)
        .filter_map(|r| {
            let holm = apa::p_holm(r.p_holm?);
            Some(format!(
                "{} / {} ({} − {}): {}, {}",
                r.title,
                r.rating_title,
                run.label(r.own),
                run.label(r.versus),
                said(&r.correlation),
                holm.markup()
            ))
        })
        .collect();
    Some(found)
}

/// How many numbers of the paper come out here, of those that could differ.
fn against_the_paper(ledger: &[LedgerRow]) -> Card {
    use maveric_report::claims::Verdict as Claimed;
    let counts = verdict_counts(ledger);
    let count = |v: Claimed| counts.get(&v).copied().unwrap_or(0);
    let (agree, same, differ) = (
        count(Claimed::Agrees),
        count(Claimed::SameDirection),
        count(Claimed::Differs),
    );
    let could = agree + same + differ;
    let share = proportion(agree, could, 0.95).ok();
    let ends = share.as_ref().map(|s| (s.low, s.high));
    let mut found = card(
        "paper",
        "Do the paper’s numbers come out here?",
        within(could, ends, (0.5, 1.0)),
    );
    found.answer = format!(
        "Of {could} that could differ, {agree} agree, {same} point the same way, {differ} differ; {} were set or tuned to be so and are not counted.",
        count(Claimed::ByDesign) + count(Claimed::Tuned)
    );
    "Shown if more than half of those that could differ agree (Wilson’s 95% interval above 50%); fails if fewer do.".clone_into(&mut found.rule);
    found.number = number(format!("{agree} of {could} agree"), "half", "all of them");
    found.plot = plot(
        "Agree, of those that could differ (%)",
        "Wilson’s 95% CI",
        Some(50.0),
        vec![IntervalRow::new(
            "Agree",
            share.as_ref().map(|s| 100.0 * s.estimate),
            ends.map(|(low, high)| (100.0 * low, 100.0 * high)),
        )],
    );
    "The paper’s participants are real people; where ours are made up, agreement says that the method can do it, and is no replication. \
     Claims share data, so the interval is too narrow."
        .clone_into(&mut found.doubt);
    found.see = Some("ledger".to_owned());
    found
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

//! Does the car at 0 on the dial drive as its driver does, and nearer than the other cars?

use super::super::{Run, enumerated};
use crate::stages::report::card::{card, interval, number, percent, plot};
use maveric_analysis::{Finding, Nearer, Verdict};
use maveric_report::figures::intervals::{IntervalRow, Intervals};
use maveric_report::{Card, apa, markup};
use maveric_stats::Adjustment;

/// Does the car at 0 on the dial drive as the person does?
pub(super) fn own_style(run: &Run, finding: &Finding) -> Option<Card> {
    let rows = &run.analysis.reproduction;
    let label = run.label(rows.first()?.condition);
    let mut found = card(
        finding,
        format!("Does {} drive as its driver does?", markup::plain(&label)),
    );
    let judged = rows.iter().zip(&finding.parts);
    let off: Vec<String> = judged
        .filter(|(_, part)| part.verdict != Verdict::Shown)
        .filter_map(|(r, _)| {
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
    let count = finding.count(Verdict::Shown);
    found.answer = if off.is_empty() {
        format!(
            "On average it drives as its driver does in every measure asked: {}.",
            enumerated(
                &rows
                    .iter()
                    .map(|r| r.title.to_lowercase())
                    .collect::<Vec<_>>()
            )
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
        "Mean of car − driver, 90% CI: it lies between the lines where both one-sided tests are below .05",
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
pub(super) fn nearer(run: &Run, finding: &Finding) -> Option<Card> {
    let rows = &run.analysis.nearer;
    let label = run.label(rows.first()?.condition);
    let mut found = card(
        finding,
        format!(
            "Is {} nearer to its driver than the other cars?",
            markup::plain(&label)
        ),
    );
    let shown = finding.count(Verdict::Shown);
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

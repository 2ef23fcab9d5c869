//! What the learned style holds: the score, and habits beside it.

use super::data::Study;
use crate::{
    card::{Drawn, tested_card},
    texts::{Texts, value},
    words,
};
use maveric_analysis::{AggressionLine, Correlation, Finding, Kept, Verdict};
use maveric_report::{Card, ReportError, figures::intervals::IntervalRow};
use minijinja::context;
use std::f64::consts::FRAC_PI_4;

/// Does the learned style hold what the driver's score says?
pub(super) fn line(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Option<Card>, ReportError> {
    let score = |line: &Option<AggressionLine>| {
        let line = line.as_ref()?;
        line.rows.last().map(|row| row.correlation.clone())
    };
    let with = score(&study.analysis.line);
    let without = score(&study.analysis.line_without_adb);
    let Some(decides) = without.as_ref().or(with.as_ref()) else {
        return Ok(None);
    };
    let alpha = study.alpha.filter(|alpha| *alpha > 0.0);
    let ceiling = alpha.map(f64::sqrt);
    let r = decides.r.unwrap_or(0.0);
    let values = context! {
        style => words::style(study.design),
        n => decides.n,
        r,
        explained => 100.0 * r * r,
        interval => value(&decides.ci.ends()),
        alpha,
        ceiling,
    };
    let (mut rows, mut tests) = (Vec::new(), Vec::new());
    let fits: [(&str, &str, &Option<Correlation>); 2] =
        [("without", "test_without", &without), ("with", "test_with", &with)];
    for (label, test, fit) in fits {
        let Some(fit) = fit else { continue };
        let label = texts.say("style", label, &values)?;
        rows.push(IntervalRow {
            floor: Some(0.0),
            ceiling,
            ..IntervalRow::new(label, fit.r, fit.ci.ends())
        });
        let fit = context! { correlation => words::correlation(fit), ..values.clone() };
        tests.push(texts.say("style", test, &fit)?);
    }
    let drawn = Drawn::beside(0.0, rows);
    tested_card(texts, finding, &values, Some(drawn), tests).map(Some)
}

/// Mean of the multiple R of two predictors that tell nothing: √π / 2 · Γ((n − 1) / 2) / Γ(n / 2), since R² is then Beta(1, (n − 3) / 2).
fn chance(n: usize) -> Option<f64> {
    let (first, mean) = if n % 2 == 1 { (3, 1.0) } else { (4, FRAC_PI_4) };
    let two_more = |mean: f64, n: usize| mean * (n as f64 - 1.0) / n as f64;
    (n > 3).then(|| (first..n).step_by(2).fold(mean, two_more))
}

/// Does moving across the dial change a habit that the dial leaves alone?
pub(super) fn across(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Option<Card>, ReportError> {
    let kept = &study.analysis.kept;
    let size = |k: &Kept| k.circular_r.unwrap_or(0.0);
    let strongest = kept.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
    let Some(strongest) = strongest else {
        return Ok(None);
    };
    let judged = kept.iter().zip(&finding.parts);
    let clear = judged.filter(|(_, part)| part.verdict == Verdict::Shown);
    let clear: Vec<String> = clear.map(|(habit, _)| habit.title.to_lowercase()).collect();
    let values = context! {
        label => study.label(strongest.across),
        clear,
        all => kept.len(),
        strongest => value(strongest),
        chance => chance(strongest.points.len()),
    };
    let rows = kept.iter().map(|k| IntervalRow {
        floor: chance(k.points.len()),
        ..IntervalRow::new(k.title.clone(), k.circular_r, None)
    });
    let tested = kept.iter().filter(|k| k.circular_r.is_some() && k.circular_p_holm.is_some());
    let tests = tested.map(|k| texts.say("across", "test", &value(k)));
    let drawn = Drawn::beside(0.0, rows);
    let tests = tests.collect::<Result<_, _>>()?;
    tested_card(texts, finding, &values, Some(drawn), tests).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_gives_the_mean_of_r_over_people_whom_the_angle_tells_nothing_of() {
        assert_eq!(chance(3), None);
        // Of four people R² is Beta(1, 1/2), of five it is uniform.
        for (n, mean) in [(4, FRAC_PI_4), (5, 2.0 / 3.0), (24, 0.264_189)] {
            let found = chance(n).unwrap();
            assert!((found - mean).abs() < 1e-6, "{n}: {found}");
        }
    }
}

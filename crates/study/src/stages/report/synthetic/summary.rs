//! What a reader should take away, a line each.

use super::{
    Run,
    conditions::{of_group, omnibus},
    percent, said,
};
use maveric_analysis::{Judged, Panel, Verdict};
use maveric_domain::design::Sign;
use maveric_report::{
    apa,
    claims::{LedgerRow, verdict_counts},
};

/// The findings in the order of the questions: first what was predicted.
pub(super) fn summary(run: &Run, ledger: Option<&[LedgerRow]>) -> Vec<String> {
    let a = &run.analysis;
    let mut lines: Vec<String> = a.hypotheses.iter().map(|h| judged(run, h)).collect();
    if let Some(line) = &a.line {
        let along: Vec<String> = line
            .rows
            .iter()
            .map(|r| format!("{} ({})", r.title.to_lowercase(), said(&r.correlation)))
            .collect();
        lines.push(format!(
            "*Style in the embedding.* Position on the line of {} goes with {}.",
            run.style_label(),
            along.join(", ")
        ));
    }
    if let Some(first) = a.reproduction.first() {
        let accuracy: Vec<String> = a
            .reproduction
            .iter()
            .map(|r| format!("{} {}", r.title.to_lowercase(), percent(r.mean)))
            .collect();
        lines.push(format!(
            "*Accuracy of {}.* {}.",
            run.label(first.condition),
            super::capital(&accuracy.join(", "))
        ));
    }
    let clear = |p: Option<f64>| p.is_some_and(|p| p < 0.05);
    if let Some(first) = a.nearer.first() {
        let nearer = a.nearer.iter();
        let nearer = nearer.filter(|r| clear(r.p_holm) && r.share.is_some_and(|s| s > 0.5));
        lines.push(format!(
            "*Nearer than the others.* {} is nearer to the baseline than another condition in {} of {} comparisons (Holm, .05).",
            run.label(first.condition),
            nearer.count(),
            a.nearer.len()
        ));
    }
    lines.extend(expected(&a.panels));
    for panel in &a.panels {
        lines.push(format!(
            "*{}*{} over the conditions: {}.",
            panel.title,
            of_group(panel),
            omnibus(panel, false)
        ));
    }
    if !a.homophily.is_empty() {
        let tested = a.homophily.iter().filter(|r| r.correlation.p.is_some());
        let low = a.homophily.iter().filter(|r| clear(r.correlation.p));
        let kept = a.homophily.iter().filter(|r| clear(r.p_holm));
        lines.push(format!(
            "*Homophily.* Of {} correlations of a factor with a rating difference, {} are below .05 and {} after Holm.",
            tested.count(),
            low.count(),
            kept.count()
        ));
    }
    if let Some(ledger) = ledger {
        let counted: Vec<String> = verdict_counts(ledger)
            .iter()
            .map(|(v, n)| format!("{n} {}", v.of_several()))
            .collect();
        let odd = ledger
            .iter()
            .filter(|r| r.own_figures.is_some_and(|c| !c.agrees()));
        lines.push(format!(
            "*Beside the claims.* Of {} numbers: {}. {} of these claims disagree with other numbers of theirs.",
            ledger.len(),
            counted.join(", "),
            odd.count()
        ));
    }
    lines
}

fn judged(run: &Run, h: &Judged) -> String {
    let what = match h.verdict {
        Verdict::Shown => "shown",
        Verdict::NotShown => "not shown",
        Verdict::Fails => "fails: the data say the opposite",
        Verdict::NotAsked => "not answered: nobody has a value of it",
        Verdict::TooFew => "not judged: too few people",
    };
    let mut why = vec![format!(
        "{} minus {}, *n* = {}",
        run.label(h.first),
        run.label(h.second),
        h.n
    )];
    if let Some(difference) = h.mean_difference {
        why.push(format!("mean difference {}", apa::number(difference, 2)));
    }
    if let Some(p) = h.p {
        why.push(apa::p(p).markup().to_owned());
    }
    format!(
        "*{}*: {what} ({}). The rule: {}.",
        h.says.trim_end_matches('.'),
        why.join(", "),
        h.rule
    )
}

/// How many contrasts of which a direction was expected lie that way.
fn expected(panels: &[Panel]) -> Option<String> {
    let (mut all, mut right, mut clear, mut wrong) = (0, 0, 0, 0);
    for contrast in panels.iter().flat_map(|p| &p.contrasts) {
        let (Some(expected), Some(difference)) = (contrast.expected, contrast.mean_difference)
        else {
            continue;
        };
        all += 1;
        let same = Sign::of(difference) == Some(expected);
        let sure = contrast.p_holm.is_some_and(|p| p < 0.05);
        right += usize::from(same);
        clear += usize::from(same && sure);
        wrong += usize::from(!same && sure);
    }
    (all > 0).then(|| {
        format!(
            "*The expected way.* {right} of {all} contrasts with an expected direction lie that way, {clear} of them after Holm at .05; {wrong} lie the \
             other way after Holm."
        )
    })
}

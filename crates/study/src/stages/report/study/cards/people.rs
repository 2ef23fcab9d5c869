//! What people want: their own style or another, and whether their traits tell.

use super::super::{Run, correlation_words, enumerated};
use crate::stages::report::card::{card, interval, number, percent, plot};
use maveric_analysis::Finding;
use maveric_report::figures::intervals::IntervalRow;
use maveric_report::{Card, apa};

/// Would people rather be driven as they drive?
pub(super) fn preferred(run: &Run, finding: &Finding) -> Option<Card> {
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
    let mut found = card(finding, "Do people prefer their own style?");
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
        let label = format!("{}, {}", p.title, run.design.label(o.condition));
        IntervalRow::share(label, o.share.as_ref())
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
                interval(Some(s.percent().ends()), 0)
            ))
        })
        .collect();
    Some(found)
}

/// Does what people are like tell whose style they want?
pub(super) fn homophily(run: &Run, finding: &Finding) -> Option<Card> {
    let rows = &run.analysis.homophily;
    let tested: Vec<_> = rows.iter().filter(|r| r.p_holm.is_some()).collect();
    let clear = |p: Option<f64>| p.is_some_and(|p| p < 0.05);
    let mut found = card(finding, "Does personality tell which style one wants?");
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
            correlation_words(&top.correlation)
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
                correlation_words(&r.correlation),
                holm.markup()
            ))
        })
        .collect();
    Some(found)
}

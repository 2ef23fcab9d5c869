//! Cards from findings: the one place where a verdict becomes what a page shows.

use maveric_analysis::{Finding, Part, Verdict};
use maveric_report::{
    Card, CardNumber, Tone, apa,
    figures::intervals::{IntervalRow, Intervals},
};

/// How a verdict looks.
fn tone(verdict: Verdict) -> Tone {
    match verdict {
        Verdict::Shown => Tone::Good,
        Verdict::NotShown => Tone::Open,
        Verdict::Fails => Tone::Bad,
        Verdict::NotAsked | Verdict::TooFew => Tone::Silent,
    }
}

/// A card of a finding, with its question in words; the rest is filled in by whoever asks.
pub(crate) fn card(finding: &Finding, question: impl Into<String>) -> Card {
    Card {
        name: finding.question.to_string(),
        question: question.into(),
        answer: String::new(),
        tone: tone(finding.verdict),
        verdict: finding.verdict.words().to_owned(),
        rule: String::new(),
        number: None,
        plot: None,
        doubt: String::new(),
        see: None,
        tests: Vec::new(),
    }
}

/// A number with its floor and its ceiling.
#[expect(
    clippy::unnecessary_wraps,
    reason = "what a card may have is an option, and closures give one"
)]
pub(crate) fn number(
    value: impl Into<String>,
    floor: impl Into<String>,
    ceiling: impl Into<String>,
) -> Option<CardNumber> {
    Some(CardNumber {
        value: value.into(),
        floor: floor.into(),
        ceiling: ceiling.into(),
    })
}

/// Rows on an axis, with the value of no effect.
#[expect(
    clippy::unnecessary_wraps,
    reason = "what a card may have is an option, and closures give one"
)]
pub(crate) fn plot(
    axis: &str,
    what: &str,
    nothing: Option<f64>,
    rows: Vec<IntervalRow>,
) -> Option<Intervals> {
    Some(Intervals {
        axis: axis.to_owned(),
        rows,
        nothing,
        bounds: None,
        what: what.to_owned(),
    })
}

/// A share that was judged, as a row of an axis in %.
pub(crate) fn share_row(label: impl Into<String>, part: &Part) -> IntervalRow {
    let percent = |(low, high): (f64, f64)| (100.0 * low, 100.0 * high);
    IntervalRow::new(
        label,
        part.estimate.map(|share| 100.0 * share),
        part.interval.map(percent),
    )
}

/// A card of what must never happen, and how large a `share` of it would look the same.
pub(crate) fn must_not_happen(finding: &Finding, question: &str, share: &str) -> Card {
    let part = finding.parts.first();
    let ceiling = part.and_then(|part| part.interval).map_or_else(
        || "not known".to_owned(),
        |(_, high)| {
            let high = percent(Some(high));
            format!("a true {share} up to {high} would look the same")
        },
    );
    let n = part.map_or(0, |part| part.n);
    let hits = part.and_then(|part| part.estimate).unwrap_or(0.0) * n as f64;
    let mut card = card(finding, question);
    card.number = number(
        format!("{hits:.0} of {n}"),
        "none: any number counts",
        ceiling,
    );
    card
}

/// `86.9%`, with a true minus; `no value` where there is none.
pub(crate) fn percent(share: Option<f64>) -> String {
    share.map_or_else(
        || "no value".to_owned(),
        |v| format!("{}%", apa::number(100.0 * v, 1)),
    )
}

/// `[0.12, 0.34]`, or nothing.
pub(crate) fn interval(ends: Option<(f64, f64)>, decimals: usize) -> String {
    ends.map_or_else(String::new, |(low, high)| {
        format!(
            " [{}, {}]",
            apa::number(low, decimals),
            apa::number(high, decimals)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_analysis::Question;

    #[test]
    fn every_verdict_has_its_own_words_and_silence_looks_like_nothing_else() {
        use Verdict::{Fails, NotAsked, NotShown, Shown, TooFew};
        let all = [Shown, NotShown, Fails, NotAsked, TooFew];
        let cards = all.map(|verdict| {
            let finding = Finding {
                verdict,
                ..Finding::every(Question::Nearer, Vec::new())
            };
            card(&finding, "Is it?")
        });
        let words: Vec<&str> = cards.iter().map(|c| c.verdict.as_str()).collect();
        assert_eq!(
            words,
            ["shown", "not shown", "fails", "not asked", "too few to say"]
        );
        let tones = cards.map(|c| c.tone);
        assert_eq!(
            tones,
            [
                Tone::Good,
                Tone::Open,
                Tone::Bad,
                Tone::Silent,
                Tone::Silent
            ]
        );
    }
}

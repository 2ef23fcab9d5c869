//! Cards from verdicts: the one place where a verdict becomes what a page shows.

use maveric_analysis::{Verdict, verdict::within};
use maveric_report::{
    Card, CardNumber, Tone, apa,
    figures::intervals::{IntervalRow, Intervals},
};
use maveric_stats::proportion;

/// How a verdict looks.
fn tone(verdict: Verdict) -> Tone {
    match verdict {
        Verdict::Shown => Tone::Good,
        Verdict::NotShown => Tone::Open,
        Verdict::Fails => Tone::Bad,
        Verdict::NotAsked | Verdict::TooFew => Tone::Silent,
    }
}

/// A card of a question with its verdict; the rest is filled in by whoever asks.
pub(crate) fn card(name: &str, question: impl Into<String>, verdict: Verdict) -> Card {
    Card {
        name: name.to_owned(),
        question: question.into(),
        answer: String::new(),
        tone: tone(verdict),
        verdict: verdict.words().to_owned(),
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

/// A card of what must never happen, which came `hits` times in `n`: it fails at once, and else says up to which `share` it might be all
/// the same; and the ends of that share.
pub(crate) fn must_not_happen(
    (name, question): (&str, &str),
    (hits, n): (usize, usize),
    share: &str,
) -> (Card, Option<(f64, f64)>) {
    let ends = proportion(hits, n, 0.95).ok().map(|s| s.ends());
    let verdict = match hits {
        0 => within(n, ends, (0.0, 1.0)),
        _ => Verdict::Fails,
    };
    let ceiling = ends.map_or_else(
        || "not known".to_owned(),
        |(_, high)| {
            let high = percent(Some(high));
            format!("a true {share} up to {high} would look the same")
        },
    );
    let mut found = card(name, question, verdict);
    found.number = number(format!("{hits} of {n}"), "none: any number counts", ceiling);
    (found, ends)
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

    #[test]
    fn every_verdict_has_its_own_words_and_silence_looks_like_nothing_else() {
        use Verdict::{Fails, NotAsked, NotShown, Shown, TooFew};
        let all = [Shown, NotShown, Fails, NotAsked, TooFew];
        let cards = all.map(|v| card("x", "Does it?", v));
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

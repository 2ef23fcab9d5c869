//! A card of a finding: its words from a file of texts, its tone from the verdict.

use crate::texts::Texts;
use maveric_analysis::{Finding, Part, Question, Verdict};
use maveric_report::{
    Card, CardNumber, ReportError, Tone,
    figures::intervals::{IntervalRow, Intervals},
};
use minijinja::{Value, context};

fn tone(verdict: Verdict) -> Tone {
    match verdict {
        Verdict::Shown => Tone::Good,
        Verdict::NotShown => Tone::Open,
        Verdict::Fails => Tone::Bad,
        Verdict::NotAsked | Verdict::TooFew | Verdict::NotTested | Verdict::NotTestable => {
            Tone::Silent
        }
    }
}

/// What is drawn on a card: rows, the value of no effect, and what the rule asks for.
pub(crate) struct Drawn {
    pub(crate) rows: Vec<IntervalRow>,
    pub(crate) nothing: Option<f64>,
    pub(crate) bounds: Option<(f64, f64)>,
}

impl Drawn {
    /// Rows beside the value of no effect, where there is one.
    pub(crate) fn beside(
        nothing: impl Into<Option<f64>>,
        rows: impl IntoIterator<Item = IntervalRow>,
    ) -> Self {
        Self { rows: rows.into_iter().collect(), nothing: nothing.into(), bounds: None }
    }

    /// The same with what the rule asks for.
    pub(crate) fn within(self, bounds: impl Into<Option<(f64, f64)>>) -> Self {
        let bounds = bounds.into();
        Self { bounds, ..self }
    }
}

/// The card of a finding: `question`, `answer`, `rule`, `value` with `floor` and `ceiling`, `axis` and `what` of its picture, `doubt` and
/// `see` are texts of its table; without a value it has no number.
pub(crate) fn card(
    texts: &Texts,
    finding: &Finding,
    values: &Value,
    drawn: Option<Drawn>,
) -> Result<Card, ReportError> {
    let name = finding.question.to_string();
    let table = match finding.question {
        Question::Hypothesis(_) => "hypothesis",
        Question::Primary(_) => "primary",
        _ => &name,
    };
    let text = |key: &str| texts.say(table, key, values);
    let value = text("value")?;
    let number = if value.is_empty() {
        None
    } else {
        Some(CardNumber { value, floor: text("floor")?, ceiling: text("ceiling")? })
    };
    let plot = match drawn {
        None => None,
        Some(drawn) => Some(Intervals {
            axis: text("axis")?,
            rows: drawn.rows,
            nothing: drawn.nothing,
            bounds: drawn.bounds,
            what: text("what")?,
        }),
    };
    Ok(Card {
        question: text("question")?,
        answer: text("answer")?,
        tone: tone(finding.verdict),
        verdict: finding.verdict.words().to_owned(),
        rule: text("rule")?,
        number,
        plot,
        doubt: text("doubt")?,
        see: Some(text("see")?).filter(|see| !see.is_empty()),
        tests: Vec::new(),
        name,
    })
}

/// The same with the tests behind it.
pub(crate) fn tested_card(
    texts: &Texts,
    finding: &Finding,
    values: &Value,
    drawn: Option<Drawn>,
    tests: Vec<String>,
) -> Result<Card, ReportError> {
    Ok(Card { tests, ..card(texts, finding, values, drawn)? })
}

/// Of what must never happen: how often it came (`hits` of `n`), and the largest share that would look the same (`most`).
pub(crate) fn counted(finding: &Finding) -> Value {
    let part = finding.parts.first();
    let n = part.map_or(0, |part| part.n);
    let share = part.and_then(|part| part.estimate).unwrap_or(0.0);
    let most = part.and_then(|part| part.interval).map(|(_, high)| high);
    context! { hits => share * n as f64, n, most }
}

/// A share that was judged, as a row of an axis in %.
pub(crate) fn share_row(label: impl Into<String>, part: &Part) -> IntervalRow {
    let percent = |(low, high): (f64, f64)| (100.0 * low, 100.0 * high);
    IntervalRow::new(label, part.estimate.map(|share| 100.0 * share), part.interval.map(percent))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_verdict_has_its_own_words_and_silence_looks_like_nothing_else() {
        use Verdict::{Fails, NotAsked, NotShown, NotTestable, NotTested, Shown, TooFew};
        let text = "[nearer]\nquestion = \"Is {{ it }}?\"\n";
        let texts = Texts::read("nearer.toml", text).unwrap();
        let verdicts = [Shown, NotShown, Fails, NotAsked, TooFew, NotTested, NotTestable];
        let cards = verdicts.map(|verdict| {
            let finding = Finding { verdict, ..Finding::every(Question::Nearer, Vec::new()) };
            card(&texts, &finding, &context! { it => "it" }, None).unwrap()
        });
        let words: Vec<&str> = cards.iter().map(|c| c.verdict.as_str()).collect();
        assert_eq!(
            words,
            [
                "shown",
                "not shown",
                "fails",
                "not asked",
                "too few to say",
                "not tested",
                "not testable"
            ]
        );
        assert_eq!(cards[0].question, "Is it?");
        let tones = cards.map(|c| c.tone);
        assert_eq!(
            tones,
            [
                Tone::Good,
                Tone::Open,
                Tone::Bad,
                Tone::Silent,
                Tone::Silent,
                Tone::Silent,
                Tone::Silent,
            ]
        );
    }

    #[test]
    fn a_value_that_a_text_asks_for_and_nobody_gives_is_named() {
        let texts = Texts::read("nearer.toml", "[nearer]\nanswer = \"{{ n }} people\"\n").unwrap();
        let finding = Finding::every(Question::Nearer, Vec::new());
        let error = card(&texts, &finding, &context! {}, None).unwrap_err();
        assert!(error.to_string().contains("nearer.toml, nearer.answer"), "{error}");
    }
}

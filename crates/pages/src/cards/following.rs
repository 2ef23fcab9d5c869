//! The answers of an evaluation on recorded driving.

use crate::{
    card::{Drawn, card, counted, tested_card},
    texts::{Texts, value},
};
use maveric_analysis::{Finding, Question};
use maveric_following::{Compared, FollowingEvaluation};
use maveric_report::{Card, ReportError, figures::intervals::IntervalRow};
use minijinja::{Value, context};

/// What the cards are made from.
#[derive(Debug, Clone)]
pub struct Following<'a> {
    pub found: &'a FollowingEvaluation,
    /// Each way of knowing the driver beside the same for everybody.
    pub personal: Vec<&'a Compared>,
}

impl Following<'_> {
    /// A card a finding.
    ///
    /// # Errors
    /// [`ReportError::Template`] for a text that asks for a value which is not given.
    pub fn cards(&self, findings: &[Finding]) -> Result<Vec<Card>, ReportError> {
        let texts = Texts::read("following.toml", include_str!("../../texts/following.toml"))?;
        let mut cards = Vec::new();
        for finding in findings {
            cards.extend(match finding.question {
                Question::Personal => Some(self.personal(&texts, finding)?),
                Question::Reached => Some(self.reached(&texts, finding)?),
                _ => None,
            });
        }
        Ok(cards)
    }

    /// What of a pair a text may say.
    fn pair(&self, pair: &Compared) -> Value {
        context! {
            method => pair.method.label(),
            beside => pair.beside.label(),
            interval => value(&pair.low_m.zip(pair.high_m)),
            n => self.found.people(),
            ..value(pair)
        }
    }

    fn personal(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let (mut counts, mut rows, mut tests) = (Vec::new(), Vec::new(), Vec::new());
        for pair in &self.personal {
            let values = self.pair(pair);
            let say = |what| texts.say("personal", what, &values);
            let interval = pair.low_m.zip(pair.high_m);
            rows.push(IntervalRow::new(say("row")?, Some(pair.mean_m), interval));
            counts.push(say("counts")?);
            tests.push(say("test")?);
        }
        let values = context! {
            counts,
            first => self.personal.first().map(|pair| self.pair(pair)),
        };
        let drawn = Drawn::beside(0.0, rows);
        tested_card(texts, finding, &values, Some(drawn), tests)
    }

    fn reached(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let values = context! { label => self.found.driven.label(), ..counted(finding) };
        card(texts, finding, &values, None)
    }
}

//! The answers of an evaluation on recorded driving.

use crate::{
    card::{Drawn, card, counted, tested_card},
    texts::{Texts, value},
};
use maveric_analysis::{Finding, Question};
use maveric_following::{Compared, FollowingEvaluation, FollowingMethod, Knows, MethodMean};
use maveric_report::{Card, ReportError, figures::intervals::IntervalRow};
use minijinja::{Value, context};

/// What the cards are made from.
#[derive(Debug, Clone)]
pub struct Following<'a> {
    /// The evaluation.
    pub found: &'a FollowingEvaluation,
    /// What was learned beside each of its peers.
    pub peers: Vec<&'a Compared>,
    /// Each way of knowing the driver beside the same for everybody.
    pub personal: Vec<&'a Compared>,
    /// Methods that were learned by a network.
    pub networks: &'a [FollowingMethod],
    /// What is driven by default.
    pub driven: FollowingMethod,
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
                Question::Better => Some(self.better(&texts, finding)?),
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

    /// Rows and tests of pairs.
    fn pairs(
        &self,
        texts: &Texts,
        name: &str,
        pairs: &[&Compared],
    ) -> Result<(Drawn, Vec<String>), ReportError> {
        let (mut rows, mut tests) = (Vec::new(), Vec::new());
        for pair in pairs {
            let values = self.pair(pair);
            let label = texts.say(name, "row", &values)?;
            let interval = pair.low_m.zip(pair.high_m);
            rows.push(IntervalRow::new(label, Some(pair.mean_m), interval));
            tests.push(texts.say(name, "test", &values)?);
        }
        let drawn = Drawn::beside(0.0, rows);
        Ok((drawn, tests))
    }

    fn better(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let means = &self.found.means;
        let best = |fits: &dyn Fn(&MethodMean) -> bool| {
            let fitting = means.iter().filter(|m| fits(m));
            fitting.min_by(|a, b| a.gap_rmse_m.total_cmp(&b.gap_rmse_m))
        };
        let say = |mean: Option<&MethodMean>| {
            let values = context! {
                label => mean.map(|m| m.method.label()),
                error => mean.map(|m| m.gap_rmse_m),
            };
            texts.say("better", "method", &values)
        };
        let holds_0 = |(low, high): (f64, f64)| low < 0.0 && high > 0.0;
        let values = context! {
            ours => say(self.found.mean(FollowingMethod::ClosedLoopShrunken))?,
            peer => say(best(&|m| m.method.knows() == Knows::Driver && !self.networks.contains(&m.method)))?,
            for_all => say(best(&|m| m.method.knows() == Knows::Population))?,
            fitted => say(best(&|m| m.method.knows() == Knows::Test))?,
            tie => self.peers.iter().any(|p| p.low_m.zip(p.high_m).is_some_and(holds_0)),
            n => self.found.people(),
        };
        let (drawn, tests) = self.pairs(texts, "better", &self.peers)?;
        tested_card(texts, finding, &values, Some(drawn), tests)
    }

    fn personal(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let pairs = self.personal.iter();
        let counts = pairs.map(|pair| texts.say("personal", "counts", &self.pair(pair)));
        let values = context! {
            counts => counts.collect::<Result<Vec<_>, _>>()?,
            first => self.personal.first().map(|pair| self.pair(pair)),
        };
        let (drawn, tests) = self.pairs(texts, "personal", &self.personal)?;
        tested_card(texts, finding, &values, Some(drawn), tests)
    }

    fn reached(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let values = context! { label => self.driven.label(), ..counted(finding) };
        card(texts, finding, &values, None)
    }
}

//! The answers of a validation: of every model the finding, of the first the picture.

use crate::{
    card::{Drawn, card, share_row},
    texts::{Texts, value},
};
use maveric_analysis::{Finding, Part, Question, Verdict};
use maveric_rehearsal::{
    findings::{deciding, over_models},
    validation::{Agreement, Dial, Fidelity, Identification, Reading, mean},
};
use maveric_report::{Card, ReportError, figures::intervals::IntervalRow};
use maveric_stats::proportion;
use minijinja::context;

/// What the cards are made from.
#[derive(Debug, Clone)]
pub struct Validation<'a> {
    /// How like their drivers the cars are, model by model.
    pub fidelity: Vec<&'a [Fidelity]>,
    /// How the first model's drivers are told apart.
    pub identity: &'a [Identification],
    /// What the first model's dial does.
    pub dial: &'a [Dial],
    /// How the first model's readings go with the score.
    pub line: &'a [Agreement],
    pub drivers: usize,
    pub collisions: u32,
    /// Moments nearer than the safety rule allows.
    pub near: u32,
    /// Points by which the dial was turned.
    pub points: f64,
}

impl Validation<'_> {
    /// A card a finding.
    ///
    /// # Errors
    /// [`ReportError::Template`] for a text that asks for a value which is not given.
    pub fn cards(&self, findings: &[Finding]) -> Result<Vec<Card>, ReportError> {
        let texts = Texts::read("validation.toml", include_str!("../../texts/validation.toml"))?;
        let mut cards = Vec::new();
        for finding in findings {
            cards.extend(match finding.question {
                Question::OwnStyle => Some(self.like_its_driver(&texts, finding)?),
                Question::Recognised => self.recognised(&texts, finding)?,
                Question::Dial => Some(self.dial_turned(&texts, finding)?),
                Question::Style => self.style(&texts, finding)?,
                Question::Safe => Some(self.safe(&texts, finding)?),
                _ => None,
            });
        }
        Ok(cards)
    }

    fn models(&self) -> usize {
        self.fidelity.len()
    }

    fn like_its_driver(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let first = self.fidelity.first().copied().unwrap_or_default();
        let row = |(k, f): (usize, &Fidelity)| {
            let over = |of: fn(&Fidelity) -> Option<f64>| {
                over_models(self.fidelity.iter().map(|m| m.get(k).and_then(of)))
            };
            let mean = |of| over(of).map(|(mean, _)| 100.0 * mean);
            let car = over(|f| f.mimic);
            IntervalRow {
                floor: mean(|f| f.population_mean),
                ceiling: mean(|f| f.test_retest),
                ..IntervalRow::new(
                    f.title,
                    car.map(|(mean, _)| 100.0 * mean),
                    car.filter(|_| self.models() > 1)
                        .map(|(_, (low, high))| (100.0 * low, 100.0 * high)),
                )
            }
        };
        let rows: Vec<IntervalRow> = first.iter().enumerate().map(row).collect();
        let average = |of: fn(&IntervalRow) -> Option<f64>| {
            let values: Vec<f64> = rows.iter().filter_map(of).collect();
            mean(&values).map(|value| value / 100.0)
        };
        let as_near = |r: &&IntervalRow| r.estimate.zip(r.ceiling).is_some_and(|(e, c)| e >= c);
        let values = context! {
            is_shown => finding.verdict == Verdict::Shown,
            above => rows.iter().filter(as_near).count(),
            measures => rows.len(),
            models => self.models(),
            drivers => self.drivers,
            mean => average(|r| r.estimate),
            floor => average(|r| r.floor),
            ceiling => average(|r| r.ceiling),
        };
        let drawn = Drawn::beside(None, rows);
        card(texts, finding, &values, Some(drawn))
    }

    fn recognised(&self, texts: &Texts, finding: &Finding) -> Result<Option<Card>, ReportError> {
        let Some(shown) = deciding(self.identity) else {
            return Ok(None);
        };
        let percent = |i: &Identification| (100.0 * i.low, 100.0 * i.high);
        let values = context! {
            models => self.models(),
            interval => value(&percent(shown)),
            chance => 1.0 / shown.n.max(1) as f64,
            ..value(shown)
        };
        let mut rows = Vec::new();
        for i in self.identity {
            let label = texts.say("recognised", "row", &value(i))?;
            rows.push(IntervalRow {
                floor: Some(100.0 / i.n.max(1) as f64),
                ..IntervalRow::new(label, Some(100.0 * i.rate), Some(percent(i)))
            });
        }
        let drawn = Drawn::beside(None, rows);
        card(texts, finding, &values, Some(drawn)).map(Some)
    }

    fn dial_turned(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let rows = self.dial.iter();
        let rows = rows.flat_map(|d| [(d, "+", &d.aggressive), (d, "−", &d.cautious)]);
        let rows = rows.map(|(d, sign, right)| {
            let share = proportion(right.right, right.n, 0.95).ok();
            let label = format!("{} {sign}{}", d.title, self.points);
            IntervalRow::share(label, share.as_ref())
        });
        let rows: Vec<IntervalRow> = rows.collect();
        let share = |row: &IntervalRow| row.estimate.unwrap_or(f64::INFINITY);
        let known = rows.iter().filter(|row| row.estimate.is_some());
        let least = known.min_by(|a, b| share(a).total_cmp(&share(b)));
        let most_turn = |part: &Part| part.estimate.is_some_and(|share| share > 0.5);
        let values = context! {
            models => self.models(),
            is_shown => finding.verdict == Verdict::Shown,
            most => finding.parts.iter().all(most_turn),
            least => least.map(value),
        };
        let drawn = Drawn::beside(50.0, rows);
        card(texts, finding, &values, Some(drawn))
    }

    fn style(&self, texts: &Texts, finding: &Finding) -> Result<Option<Card>, ReportError> {
        let alone = |a: &&Agreement| a.reading == Reading::WithoutScore;
        let Some(shown) = self.line.iter().find(alone) else {
            return Ok(None);
        };
        let values = context! {
            models => self.models(),
            n => shown.n,
            explained => 100.0 * shown.adb.unwrap_or(0.0).powi(2),
            reading => shown.reading.title(),
            r => shown.adb,
            interval => value(&shown.adb_interval),
        };
        let rows = self.line.iter();
        let rows = rows.map(|a| IntervalRow::new(a.reading.title(), a.adb, a.adb_interval));
        let drawn = Drawn::beside(0.0, rows);
        card(texts, finding, &values, Some(drawn)).map(Some)
    }

    fn safe(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let values = context! {
            models => self.models(),
            collisions => self.collisions,
            near => self.near,
            ..crate::card::counted(finding)
        };
        let label = texts.say("safe", "row", &values)?;
        let rows = finding.parts.iter().map(|part| share_row(&label, part));
        let drawn = Drawn::beside(0.0, rows);
        card(texts, finding, &values, Some(drawn))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_rehearsal::{findings, validation::Right};

    /// What the card says of a dial that turns so many of twelve drivers the right way upwards, and all of them downwards.
    fn answer(right: usize, models: usize) -> String {
        let turned = |right: usize| Right { n: 12, right, ..Right::default() };
        let dial = [Dial {
            title: "Mean velocity",
            aggressive: turned(right),
            cautious: turned(12),
            ..Dial::default()
        }];
        let validation = Validation {
            fidelity: vec![&[][..]; models],
            identity: &[],
            dial: &dial,
            line: &[],
            drivers: 12,
            collisions: 0,
            near: 0,
            points: 15.0,
        };
        let finding = findings::dial(&[&dial[..]]);
        let cards = validation.cards(&[finding]).unwrap();
        cards[0].answer.clone()
    }

    #[test]
    fn the_dial_turns_most_drivers_only_where_it_was_shown() {
        assert_eq!(
            answer(12, 1),
            "For most drivers in every measure; least for mean velocity +15 (100% of drivers)."
        );
        let seven = answer(7, 1);
        assert!(
            seven.starts_with("For more than half of these") && seven.contains("not clearly more"),
            "{seven}"
        );
        let five = answer(5, 2);
        assert_eq!(
            five,
            "Not in every measure for most drivers; least for mean velocity +15 (42% of drivers, first model)."
        );
    }
}

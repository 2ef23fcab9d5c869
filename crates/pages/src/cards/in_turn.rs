//! The answers about people who were left out in turn, and the words of their tables.

use crate::{
    card::{Drawn, card, share_row},
    texts::{Texts, value},
};
use maveric_analysis::{Finding, Question};
use maveric_domain::ConditionId;
use maveric_rehearsal::leave_out::{By, Direction, Order, ReadOrder, Whose};
use maveric_report::{Card, ReportError, figures::intervals::IntervalRow};
use minijinja::{Value, context};

/// What the cards are made from: of each table its id and what was found.
pub struct InTurn<'a> {
    /// Orders, those that a verdict rests on.
    pub orders: Vec<(&'a str, &'a Order)>,
    pub identity: Vec<(&'a str, &'a [Whose])>,
    pub directions: Vec<(&'a str, &'a Direction)>,
    /// What a role is called.
    pub label: &'a dyn Fn(ConditionId) -> String,
}

/// A text of a table or of the page, with its values.
///
/// # Errors
/// [`ReportError::Template`] for a text that asks for a value which is not given.
pub fn text(part: &str, key: &str, values: &Value) -> Result<String, ReportError> {
    let file = include_str!("../../texts/in_turn_tables.toml");
    Texts::read("in_turn_tables.toml", file)?.say(part, key, values)
}

impl InTurn<'_> {
    /// A card a finding.
    ///
    /// # Errors
    /// [`ReportError::Template`] for a text that asks for a value which is not given.
    pub fn cards(&self, findings: &[Finding]) -> Result<Vec<Card>, ReportError> {
        let texts = Texts::read("in_turn.toml", include_str!("../../texts/in_turn.toml"))?;
        let mut cards = Vec::new();
        for finding in findings {
            cards.extend(match finding.question {
                Question::Order => Some(self.order(&texts, finding)?),
                Question::BeyondSpeed => Some(self.beyond_speed(&texts, finding)?),
                Question::Recognised => Some(self.recognised(&texts, finding)?),
                Question::Direction => Some(self.direction(&texts, finding)?),
                _ => None,
            });
        }
        Ok(cards)
    }

    fn listed(&self, roles: &[ConditionId]) -> String {
        let labels: Vec<String> = roles.iter().map(|role| (self.label)(*role)).collect();
        crate::words::listed(&labels)
    }

    fn of_order(&self, id: &str, order: &Order) -> Value {
        let [line, speed, gap] = By::ALL.map(|by| order.by(by));
        let right = |read: Option<&ReadOrder>| read.map_or(0, |r| r.right);
        let n = |read: Option<&ReadOrder>| read.map_or(0, |r| r.n);
        let beyond = line.and_then(|l| l.beyond_speed);
        let mean = |read: Option<&ReadOrder>| read.and_then(|r| Some(r.difference?.mean));
        context! {
            id,
            higher => (self.label)(order.asked.higher),
            lower => self.listed(&order.asked.lower),
            right => right(line), n => n(line),
            speed_right => right(speed), speed_n => n(speed),
            gap_right => right(gap), gap_n => n(gap),
            chance => order.chance,
            p => line.and_then(|l| l.p),
            line => mean(line), speed => mean(speed),
            mean => beyond.map(|b| b.mean),
            interval => value(&beyond.and_then(|b| b.low.zip(b.high))),
        }
    }

    fn orders(&self) -> Value {
        let rows = self.orders.iter();
        let rows: Vec<Value> = rows.map(|(id, order)| self.of_order(id, order)).collect();
        context! { first => rows.first().cloned(), rows }
    }

    fn order(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let rows = finding.parts.iter();
        let drawn = Drawn::beside(0.0, rows.map(|part| share_row(&part.of, part)));
        card(texts, finding, &self.orders(), Some(drawn))
    }

    fn beyond_speed(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let row = |part: &maveric_analysis::Part| {
            IntervalRow::new(&part.of, part.estimate, part.interval)
        };
        let drawn = Drawn::beside(0.0, finding.parts.iter().map(row));
        card(texts, finding, &self.orders(), Some(drawn))
    }

    fn direction(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let values_of = |(id, d): &(&str, &Direction)| {
            context! {
                id => *id,
                n => d.n,
                driven => d.driven, dial => d.dial, drawn => d.drawn,
                speed => d.speed, speed_and_gap => d.speed_and_gap,
                p => d.p,
            }
        };
        let rows: Vec<Value> = self.directions.iter().map(values_of).collect();
        let drawn = self.directions.iter().flat_map(|(_, d)| {
            let person = |p: &maveric_rehearsal::leave_out::PersonDirection| {
                IntervalRow::new(p.participant.to_string(), p.cosine, None)
            };
            d.people.iter().map(person)
        });
        let drawn = Drawn::beside(0.0, drawn.take(30));
        let values = context! { first => rows.first().cloned() };
        card(texts, finding, &values, Some(drawn))
    }

    fn recognised(&self, texts: &Texts, finding: &Finding) -> Result<Card, ReportError> {
        let mut rows = Vec::new();
        for (id, all) in &self.identity {
            let by = |by: By| all.iter().find(|w| w.by == by);
            let Some(style) = by(By::Line) else { continue };
            rows.push(context! {
                id => *id,
                sought => (self.label)(style.sought),
                among => (self.label)(style.among),
                hits => style.hits, n => style.n, chance => style.chance,
                speed_hits => by(By::Speed).map_or(0, |w| w.hits),
                gap_hits => by(By::TimeGap).map_or(0, |w| w.hits),
            });
        }
        let chance = self.identity.first().and_then(|(_, all)| all.first());
        let parts = finding.parts.iter();
        let drawn = Drawn::beside(
            chance.map(|w| 100.0 * w.chance),
            parts.map(|part| share_row(&part.of, part)),
        );
        let values = context! { first => rows.first().cloned(), rows };
        card(texts, finding, &values, Some(drawn))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_rehearsal::leave_out::{Asked, Mean};

    fn order(right: usize, n: usize) -> Order {
        let read = |by, right| ReadOrder {
            by,
            n,
            right,
            share: maveric_stats::proportion_exact(right, n, 0.95).ok(),
            p: Some(0.016),
            p_below: Some(1.0),
            difference: None,
            beyond_speed: Some(Mean { n, mean: 0.4, low: Some(-0.1), high: Some(0.9), dz: None }),
        };
        Order {
            asked: Asked {
                higher: "sporty".parse().unwrap(),
                lower: vec!["calm".parse().unwrap()],
            },
            chance: 0.5,
            readings: vec![read(By::Line, right), read(By::Speed, 5), read(By::TimeGap, 3)],
            people: Vec::new(),
            permutations: 1000,
            uncounted: Vec::new(),
        }
    }

    #[test]
    fn the_cards_count_the_line_beside_speed_and_time_gap_and_call_roles_by_their_labels() {
        let order = order(6, 6);
        let label = |id: ConditionId| format!("“{id}”");
        let made = InTurn {
            orders: vec![("order", &order)],
            identity: Vec::new(),
            directions: Vec::new(),
            label: &label,
        };
        let findings = [
            maveric_rehearsal::findings::ordered(&[&order]),
            maveric_rehearsal::findings::beyond_speed(&[&order]),
        ];
        let cards = made.cards(&findings).unwrap();
        let said = &cards[0].answer;
        assert!(
            said.contains("“sporty” above “calm”: 6 of 6") && said.contains("5 of 6 by mean speed"),
            "{said}"
        );
        assert_eq!((cards[0].verdict.as_str(), cards[1].verdict.as_str()), ("shown", "not shown"));
        assert_eq!(cards[0].see.as_deref(), Some("table-in-turn-order"));
    }

    #[test]
    fn every_text_of_the_tables_is_a_template_of_known_values() {
        let values = context! { higher => "a", lower => "b", n => 5, people => 6, seen => true, chance => 0.5, permutations => 0 };
        let note = text("order", "note", &values).unwrap();
        assert!(
            note.contains("5 of 6 people") && note.contains("seen while the method was made"),
            "{note}"
        );
        assert!(note.contains("not asked for"), "{note}");
        assert!(text("order", "note", &context! {}).is_err());
    }
}

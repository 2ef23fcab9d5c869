//! The templates of `texts/`: tables of texts, filled with values.

use maveric_analysis::{Correlation, Verdict};
use maveric_report::{ReportError, apa, markup};
use minijinja::{Environment, UndefinedBehavior, Value, syntax::SyntaxConfig, value::Serde};
use std::collections::BTreeMap;

use crate::words;

/// A file of `texts/`: card by card, its texts by their keys.
pub(crate) struct Texts {
    file: &'static str,
    cards: BTreeMap<String, BTreeMap<String, String>>,
}

pub(crate) fn failed(reason: String) -> ReportError {
    ReportError::Template { reason }
}

impl Texts {
    /// Reads a file that is compiled in.
    pub(crate) fn read(file: &'static str, text: &str) -> Result<Self, ReportError> {
        let cards = toml::from_str(text).map_err(|e| failed(format!("{file}: {e}")))?;
        Ok(Self { file, cards })
    }

    /// One text with its values: the card's own, else that of the card that it is `like`; empty where there is neither.
    pub(crate) fn say(&self, card: &str, key: &str, values: &Value) -> Result<String, ReportError> {
        let texts = self.cards.get(card);
        let texts = texts.ok_or_else(|| failed(format!("{} has no `{card}`", self.file)))?;
        let alike = || self.cards.get(texts.get("like")?)?.get(key);
        let Some(text) = texts.get(key).or_else(alike) else {
            return Ok(String::new());
        };
        let filled = environment().render_str(text, values);
        filled.map_err(|e| failed(format!("{}, {card}.{key}: {e:#}", self.file)))
    }
}

/// A document that is compiled in, with its values; a line that is a statement of the template alone leaves nothing behind.
pub(crate) fn document(file: &str, text: &str, values: Value) -> Result<String, ReportError> {
    let mut syntax = SyntaxConfig::builder();
    syntax.trim_blocks(true).lstrip_blocks(true);
    syntax.keep_trailing_newline(true);
    let failed = |e: minijinja::Error| failed(format!("{file}: {e:#}"));
    let mut environment = environment();
    environment.set_syntax(syntax.build().map_err(failed)?);
    environment.render_str(text, values).map_err(failed)
}

/// An environment with the filters that texts use.
pub(crate) fn environment() -> Environment<'static> {
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    let written = |value: Option<f64>, write: fn(f64, usize) -> String, decimals: Option<usize>| {
        value.map_or_else(|| "not known".to_owned(), |value| write(value, decimals.unwrap_or(2)))
    };
    environment.add_filter("number", move |value: Option<f64>, decimals: Option<usize>| {
        written(value, apa::number, decimals)
    });
    environment.add_filter("bounded", move |value: Option<f64>, decimals: Option<usize>| {
        written(value, apa::bounded, decimals)
    });
    environment.add_filter("percent", words::percent);
    environment.add_filter(
        "interval",
        |ends: Option<Vec<f64>>, decimals: usize, bounded: Option<bool>| {
            let ends = ends.and_then(|ends| Some((*ends.first()?, *ends.get(1)?)));
            words::interval(ends, decimals, bounded.unwrap_or(false))
        },
    );
    environment.add_filter("p", |p: Option<f64>| p.map(|p| apa::p(p).markup().to_owned()));
    environment.add_filter("or_dash", |value: Option<f64>, decimals: usize| {
        value.map_or_else(|| "–".to_owned(), |value| apa::number(value, decimals))
    });
    environment.add_filter("shortest", |number: f64| number.to_string());
    environment.add_filter("points", words::points);
    environment.add_filter("verdict", |verdict: Serde<Verdict>| verdict.words());
    environment.add_filter("cell", cell);
    environment.add_filter("ends", ends);
    environment.add_filter("with_unit", |title: &str, unit: &str| words::with_unit(title, unit));
    environment.add_filter("literal", |text: &str| markup::literal(text));
    environment.add_filter("statement", |correlation: Serde<Option<Correlation>>| {
        let statement = correlation.0.as_ref().and_then(Correlation::statement);
        statement.map(|statement| statement.markup().to_owned())
    });
    environment.add_filter("correlation", |correlation: Serde<Correlation>| {
        words::correlation(&correlation)
    });
    environment.add_filter("p_holm", |p: f64| apa::p_holm(p).markup().to_owned());
    environment.add_filter("listed", |all: Vec<String>| words::listed(&all));
    environment.add_filter("plain", |text: String| markup::plain(&text));
    environment.add_filter("capital", |text: String| words::capital(&text));
    environment
}

/// A text as a cell of Markdown shows it: no mark-up of its own, and one line.
fn cell(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '|' => out.push_str("\\|"),
            '\n' | '\r' | '\t' => out.push(' '),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

/// `0.12 to 0.34` of a pair, or of what has `low` and `high`; `bounded` numbers lose the zero before the point. None where an end is none.
fn ends(
    of: &Value,
    decimals: usize,
    bounded: Option<bool>,
) -> Result<Option<String>, minijinja::Error> {
    let end = |key: &str, at: usize| match of.get_attr(key)? {
        end if end.is_undefined() => of.get_item(&Value::from(at)),
        end => Ok(end),
    };
    if of.is_none() {
        return Ok(None);
    }
    let (low, high) = (end("low", 0)?, end("high", 1)?);
    if low.is_none() || high.is_none() {
        return Ok(None);
    }
    let write = words::written(bounded.unwrap_or(false));
    let [low, high] = [f64::try_from(low)?, f64::try_from(high)?].map(|end| write(end, decimals));
    Ok(Some(format!("{low} to {high}")))
}

/// Whatever can be written, as a value of a text.
pub(crate) fn value<T: serde::Serialize + ?Sized>(of: &T) -> Value {
    Value::from(Serde(of))
}

#[cfg(test)]
mod tests {
    use super::*;
    use minijinja::context;

    const FILES: [(&str, &str); 6] = [
        ("ablation.toml", include_str!("../texts/ablation.toml")),
        ("following.toml", include_str!("../texts/following.toml")),
        ("in_turn.toml", include_str!("../texts/in_turn.toml")),
        ("rehearsal.toml", include_str!("../texts/rehearsal.toml")),
        ("study.toml", include_str!("../texts/study.toml")),
        ("validation.toml", include_str!("../texts/validation.toml")),
    ];

    #[test]
    fn every_text_is_a_template_and_every_card_asks_answers_and_says_its_rule() {
        for (file, text) in FILES {
            let texts = Texts::read(file, text).unwrap();
            for (card, keys) in &texts.cards {
                for (key, text) in keys {
                    let read = environment().template_from_str(text).map(|_| ());
                    read.unwrap_or_else(|e| panic!("{file}, {card}.{key}: {e:#}"));
                }
                let alike = keys.get("like").and_then(|like| texts.cards.get(like));
                for key in ["question", "answer", "rule", "doubt", "see"] {
                    let has = |keys: &BTreeMap<String, String>| keys.contains_key(key);
                    assert!(has(keys) || alike.is_some_and(has), "{file}, {card}: {key}");
                }
            }
        }
    }

    #[test]
    fn numbers_are_written_as_apa_writes_them_and_what_is_not_known_says_so() {
        let text = "[card]\na = \"{{ r | bounded(2) }}{{ ends | interval(1) }}{{ within | interval(2, true) }}, {{ x | number(1) }}, {{ x | percent }}, {{ all | listed }}\"\n";
        let texts = Texts::read("t.toml", text).unwrap();
        let all = ["a", "b", "c"].map(str::to_owned).to_vec();
        let known = context! { r => -0.456, ends => value(&Some((-1.0, 2.0))), within => vec![-0.5, 0.5], x => 0.25, all => all.clone() };
        let said = texts.say("card", "a", &known).unwrap();
        assert_eq!(said, "−.46 [−1.0, 2.0] [−.50, .50], 0.2, 25.0%, a, b and c");
        let none = None::<f64>;
        let unknown = context! { r => none, ends => value(&None::<(f64, f64)>), within => none, x => none, all };
        let said = texts.say("card", "a", &unknown).unwrap();
        assert_eq!(said, "not known, not known, no value, a, b and c");
        assert!(texts.say("other", "a", &unknown).is_err());
    }
}

//! What one test gives: JSON, sentences, report and figure.

use super::{
    input::Show,
    pictures::Picture,
    printed::{self, Printed},
};
use maveric_report::markup;
use maveric_stats::apa::{Statement, Statements};
use serde_json::Value;

/// Level of a test, and what its intervals leave out.
pub(super) const ALPHA: f64 = 0.05;

/// What one test gives.
pub struct Ran {
    pub(super) value: Value,
    pub(super) said: Vec<(String, Statement)>,
    pub(super) printed: Printed,
    pub(super) picture: Option<Picture>,
}

impl Ran {
    /// A result that says itself; its sentences stand in the JSON as `apa`.
    pub(super) fn of<T: serde::Serialize + Statements>(found: &T, printed: Printed) -> Self {
        let said = found.statements();
        let mut value = plain(found);
        if let Value::Object(object) = &mut value {
            let texts = said
                .iter()
                .map(|(name, s)| (name.clone(), s.to_string().into()));
            object.insert("apa".to_owned(), Value::Object(texts.collect()));
        }
        Self {
            value,
            said,
            printed,
            picture: None,
        }
    }

    /// A result whose report is its numbers.
    pub(super) fn plainly<T: serde::Serialize + Statements>(found: &T) -> Self {
        let said = found.statements();
        let several = said.len() > 1;
        let sentence = |(name, said): (String, Statement)| {
            if several {
                format!("{}: {}", markup::literal(&name), said.markup())
            } else {
                said.markup().to_owned()
            }
        };
        let sentences = said.into_iter().map(sentence).collect();
        Self::of(found, printed::plain(&plain(found), sentences))
    }

    /// Numbers that are not said in a sentence.
    pub(super) fn numbers(value: Value) -> Self {
        Self {
            printed: printed::plain(&value, Vec::new()),
            said: Vec::new(),
            picture: None,
            value,
        }
    }

    pub(super) fn drawn(mut self, picture: Picture) -> Self {
        self.picture = Some(picture);
        self
    }

    pub(super) fn lines(&self, show: Show) -> Vec<String> {
        match show {
            Show::Report => self.printed.text(),
            Show::Latex => self.printed.latex(),
            Show::Markdown => self.printed.markdown(),
            Show::Apa if self.said.len() == 1 => vec![self.said[0].1.to_string()],
            Show::Apa => self
                .said
                .iter()
                .map(|(name, s)| format!("{name}: {s}"))
                .collect(),
        }
    }
}

/// A result as JSON.
pub(super) fn plain(found: &impl serde::Serialize) -> Value {
    serde_json::to_value(found).unwrap_or_default()
}

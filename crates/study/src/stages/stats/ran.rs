//! What one test gives: JSON, sentences, report and figure.

use super::{
    input::Show,
    pictures::Picture,
    printed::{self, Printed},
};
use maveric_report::tables::Table;
use maveric_stats::apa::{Statement, Statements};
use serde_json::Value;

/// Level of a test, and what its intervals leave out.
pub(super) const ALPHA: f64 = 0.05;

pub struct Ran {
    pub(super) value: Value,
    pub(super) statements: Vec<(String, Statement)>,
    pub(super) printed: Printed,
    pub(super) picture: Option<Picture>,
}

impl Ran {
    /// A result that says itself; its sentences stand in the JSON as `apa`.
    pub(super) fn new<T: serde::Serialize + Statements>(result: &T, printed: Printed) -> Self {
        let statements = result.statements();
        let mut value = plain(result);
        if let Value::Object(object) = &mut value {
            let texts = statements.iter().map(|(name, s)| (name.clone(), s.to_string().into()));
            object.insert("apa".to_owned(), Value::Object(texts.collect()));
        }
        Self { value, statements, printed, picture: None }
    }

    /// A result whose report is its numbers.
    pub(super) fn plainly<T: serde::Serialize + Statements>(result: &T) -> Self {
        let sentences = match &result.statements()[..] {
            [(_, only)] => vec![only.markup().to_owned()],
            _ => printed::named_sentences(result),
        };
        Self::new(result, printed::plain(&plain(result), sentences))
    }

    /// Numbers that are not said in a sentence.
    pub(super) fn numbers(value: Value) -> Self {
        Self {
            printed: printed::plain(&value, Vec::new()),
            statements: Vec::new(),
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
            Show::Report => self.printed.written(Table::to_text),
            Show::Latex => self.printed.latex(),
            Show::Markdown => self.printed.written(Table::to_markdown),
            Show::Apa if self.statements.len() == 1 => vec![self.statements[0].1.to_string()],
            Show::Apa => self.statements.iter().map(|(name, s)| format!("{name}: {s}")).collect(),
        }
    }
}

pub(super) fn plain(result: &impl serde::Serialize) -> Value {
    serde_json::to_value(result).unwrap_or_default()
}

//! Parameters: `[params]`, `--set`, and `{name}` in the text of a stage.

use std::collections::{BTreeMap, BTreeSet};

use crate::PipelineError;
use crate::error::{FileProblem, nearest};
use crate::shell::Script;

/// The type that a parameter's value has in the file; `--set` may not change it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ParamKind {
    Text,
    Integer,
    Float,
    Boolean,
    /// A text in which braces are braces.
    Literal,
}

impl ParamKind {
    pub(crate) fn described(self) -> &'static str {
        match self {
            Self::Text | Self::Literal => "a string",
            Self::Integer => "a whole number",
            Self::Float => "a number",
            Self::Boolean => "true or false",
        }
    }

    pub(crate) fn admits(self, value: &str) -> bool {
        match self {
            Self::Text | Self::Literal => true,
            Self::Integer => value.parse::<i64>().is_ok(),
            Self::Float => value.parse::<f64>().is_ok_and(f64::is_finite),
            Self::Boolean => matches!(value, "true" | "false"),
        }
    }
}

/// A parameter as written, braces and all.
#[derive(Debug, Clone)]
pub(crate) struct Param {
    pub(crate) kind: ParamKind,
    pub(crate) text: String,
}

/// All parameters of a pipeline, by name.
#[derive(Debug, Clone, Default)]
pub(crate) struct Params(pub(crate) BTreeMap<String, Param>);

/// What the text is into which values are put.
enum Text {
    /// A word, taken as it is.
    Plain,
    /// A shell's script.
    Script(Script),
}

impl Text {
    /// Notes the text up to the next value.
    fn passes(&mut self, text: &str) {
        if let Self::Script(script) = self {
            script.pass(text);
        }
    }

    fn quoted(&mut self, name: &str, value: String) -> Result<String, FileProblem> {
        match self {
            Self::Plain => Ok(value),
            Self::Script(script) => {
                let quoted = script.quoted(&value);
                quoted.ok_or_else(|| FileProblem::CannotQuote { name: name.to_owned(), value })
            }
        }
    }
}

/// Splits what follows `--set` at its first equals sign.
///
/// # Errors
/// [`PipelineError::OverrideForm`] if there is none, or nothing before it.
///
/// # Example
/// ```
/// # use maveric_pipeline::parse_override;
/// assert_eq!(parse_override("seed=7")?, ("seed".to_owned(), "7".to_owned()));
/// assert!(parse_override("seed").is_err());
/// # Ok::<(), maveric_pipeline::PipelineError>(())
/// ```
pub fn parse_override(text: &str) -> Result<(String, String), PipelineError> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.to_owned()))
        }
        _ => Err(PipelineError::OverrideForm { text: text.to_owned() }),
    }
}

impl Params {
    /// Replaces the value of a parameter that exists.
    pub(crate) fn set(&mut self, name: &str, value: &str) -> Result<(), PipelineError> {
        // What the caller provides stands in no file.
        let params = self.0.iter();
        let params = params.filter(|(_, p)| p.kind != ParamKind::Literal);
        let known: Vec<String> = params.map(|(name, _)| name.clone()).collect();
        let Some(param) = self.0.get_mut(name) else {
            return Err(PipelineError::UnknownOverride {
                name: name.to_owned(),
                nearest: nearest(name, known.iter().map(String::as_str)),
                known,
            });
        };
        if !param.kind.admits(value) {
            return Err(PipelineError::OverrideType {
                name: name.to_owned(),
                value: value.to_owned(),
                expected: param.kind.described(),
            });
        }
        value.clone_into(&mut param.text);
        Ok(())
    }

    /// Adds a parameter that the caller provides, unless there is one of the name.
    pub(crate) fn provide(&mut self, name: &str, value: &str) {
        let (kind, text) = (ParamKind::Literal, value.to_owned());
        let param = Param { kind, text };
        self.0.entry(name.to_owned()).or_insert(param);
    }

    /// The parameter with which a path begins, at the bottom of those that begin each other.
    pub(crate) fn root_of(&self, path: &str) -> Option<String> {
        let mut name = leading(path)?;
        for _ in 0..self.0.len() {
            match leading(&self.0.get(name)?.text) {
                Some(next) => name = next,
                None => return Some(name.to_owned()),
            }
        }
        None // they begin each other in a circle, which is refused where they are used
    }

    /// `text` with each `{name}` replaced, and `{{name}}` by `{name}`; the names replaced,
    /// also inside other parameters, join `used`. Braces around anything else stay.
    pub(crate) fn substitute(
        &self,
        text: &str,
        used: &mut BTreeSet<String>,
    ) -> Result<String, FileProblem> {
        self.substitute_within(text, used, &mut Vec::new(), &mut Text::Plain)
    }

    /// The same in a shell's script, each value quoted for the place where it stands.
    pub(crate) fn substitute_in_script(
        &self,
        text: &str,
        used: &mut BTreeSet<String>,
    ) -> Result<String, FileProblem> {
        let mut script = Text::Script(Script::default());
        self.substitute_within(text, used, &mut Vec::new(), &mut script)
    }

    fn substitute_within(
        &self,
        text: &str,
        used: &mut BTreeSet<String>,
        open: &mut Vec<String>,
        kind: &mut Text,
    ) -> Result<String, FileProblem> {
        let mut result = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(brace) = rest.find('{') {
            kind.passes(&rest[..brace]);
            result.push_str(&rest[..brace]);
            rest = &rest[brace..];
            if let Some(name) = rest.strip_prefix("{{").and_then(|r| name_before(r, "}}")) {
                kind.passes(name);
                result.extend(["{", name, "}"]);
                rest = &rest[name.len() + 4..];
            } else if let Some(name) = name_before(&rest[1..], "}") {
                let value = self.value(name, used, open)?;
                let is_first = result.is_empty() && value.is_empty();
                if is_first
                    && matches!(kind, Text::Plain)
                    && rest[name.len() + 2..].starts_with('/')
                {
                    let name = name.to_owned();
                    return Err(FileProblem::EmptyStart { name });
                }
                result.push_str(&kind.quoted(name, value)?);
                rest = &rest[name.len() + 2..];
            } else {
                kind.passes("{");
                result.push('{');
                rest = &rest[1..];
            }
        }
        result.push_str(rest);
        Ok(result)
    }

    fn value(
        &self,
        name: &str,
        used: &mut BTreeSet<String>,
        open: &mut Vec<String>,
    ) -> Result<String, FileProblem> {
        let param = self.0.get(name).ok_or_else(|| FileProblem::UnknownParameter {
            name: name.to_owned(),
            nearest: nearest(name, self.0.keys().map(String::as_str)),
        })?;
        if open.iter().any(|outer| outer == name) {
            return Err(FileProblem::CircularParameter { name: name.to_owned() });
        }
        if param.kind == ParamKind::Literal {
            used.insert(name.to_owned());
            return Ok(param.text.clone());
        }
        open.push(name.to_owned());
        let value = self.substitute_within(&param.text, used, open, &mut Text::Plain)?;
        open.pop();
        used.insert(name.to_owned());
        Ok(value)
    }
}

/// Whether `name` can name a parameter, a stage or a pipeline: it must do as a file name.
pub(crate) fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphanumeric())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

/// The parameter with which a text begins.
fn leading(text: &str) -> Option<&str> {
    name_before(text.strip_prefix('{')?, "}")
}

fn name_before<'a>(text: &'a str, end: &str) -> Option<&'a str> {
    let (name, _) = text.split_once(end)?;
    is_name(name).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params(pairs: &[(&str, &str)]) -> Params {
        let param = |text: &str| Param { kind: ParamKind::Text, text: text.to_owned() };
        Params(pairs.iter().map(|(k, v)| ((*k).to_owned(), param(v))).collect())
    }

    #[test]
    fn a_parameter_may_use_another_and_both_count_as_used() {
        let mut used = BTreeSet::new();
        let params = params(&[("out", "data"), ("drives", "{out}/drives")]);
        let text = params.substitute("{drives}/a.csv", &mut used).unwrap();
        assert_eq!(text, "data/drives/a.csv");
        assert_eq!(used.into_iter().collect::<Vec<_>>(), ["drives", "out"]);
    }

    #[test]
    fn braces_that_hold_no_name_stay() {
        let params = params(&[("a", "1")]);
        let substituted = |text| params.substitute(text, &mut BTreeSet::new()).unwrap();
        assert_eq!(substituted("awk '{print $1}' {a}"), "awk '{print $1}' 1");
        assert_eq!(substituted("{{a}} {if(x){y;}} {"), "{a} {if(x){y;}} {");
    }

    #[test]
    fn a_parameter_that_contains_itself_is_an_error() {
        let params = params(&[("a", "{b}"), ("b", "{a}")]);
        let result = params.substitute("{a}", &mut BTreeSet::new());
        assert!(matches!(result, Err(FileProblem::CircularParameter { .. })));
    }

    #[test]
    fn a_number_cannot_be_set_to_a_word() {
        let mut params = params(&[]);
        let kind = ParamKind::Integer;
        let text = "1".to_owned();
        params.0.insert("seed".to_owned(), Param { kind, text });
        assert!(params.set("seed", "two").is_err());
        assert!(params.set("seed", "2").is_ok());
        let error = params.set("sed", "2").unwrap_err();
        assert_eq!(error.suggestion().as_deref(), Some("did you mean `seed`?"));
    }
}

//! What can be wrong with a study's file.

use crate::nearest::nearest;

pub(super) type Checked<T> = Result<T, DesignError>;

/// A design that is refused: which key, what stands there, what would be possible.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DesignError {
    /// The text is no TOML, a key is not known, or a value is of another kind.
    #[error("{place}{problem}")]
    Toml {
        /// `line 3: `, or nothing where the place is not known.
        place: String,
        /// What the reader said.
        problem: String,
        /// The nearest known key.
        nearest: Option<String>,
    },
    /// A value that is not possible.
    #[error("`{key}`: found {found}, expected {expected}")]
    Key {
        /// The key, dots between its parts: `condition.calm.car`.
        key: String,
        /// What stands there.
        found: String,
        /// What would be possible.
        expected: String,
        /// The nearest possible word.
        nearest: Option<String>,
    },
}

impl DesignError {
    /// A value that is not possible.
    #[expect(clippy::needless_pass_by_value, reason = "a number or a text as it is at hand")]
    pub fn key(key: impl Into<String>, found: impl ToString, expected: impl Into<String>) -> Self {
        Self::Key {
            key: key.into(),
            found: found.to_string(),
            expected: expected.into(),
            nearest: None,
        }
    }

    /// A word that is none of those that are possible; the nearest is suggested.
    pub fn word<'a>(
        key: impl Into<String>,
        found: &str,
        possible: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let possible: Vec<&str> = possible.into_iter().collect();
        let quoted: Vec<String> = possible.iter().map(|w| format!("`{w}`")).collect();
        let expected = match quoted.as_slice() {
            [] => "nothing: there is none".to_owned(),
            [one] => one.clone(),
            many => format!("one of {}", many.join(", ")),
        };
        Self::Key {
            key: key.into(),
            found: format!("`{found}`"),
            expected,
            nearest: nearest(found, possible).map(str::to_owned),
        }
    }

    /// The next step, where one is known.
    pub fn suggestion(&self) -> Option<String> {
        let (Self::Toml { nearest, .. } | Self::Key { nearest, .. }) = self;
        nearest.as_ref().map(|word| format!("did you mean `{word}`?"))
    }

    /// As the TOML reader says it, with the nearest of the keys that it lists.
    pub(crate) fn from_toml(text: &str, error: &toml::de::Error) -> Self {
        let place = error.span().map_or_else(String::new, |span| {
            let line = text[..span.start.min(text.len())].matches('\n').count() + 1;
            format!("line {line}: ")
        });
        let problem = error.message().to_owned();
        let words: Vec<&str> = problem.split('`').skip(1).step_by(2).collect();
        let nearest = match words.as_slice() {
            [found, possible @ ..] if problem.starts_with("unknown") => {
                nearest(found, possible.iter().copied()).map(str::to_owned)
            }
            _ => None,
        };
        Self::Toml { place, problem, nearest }
    }
}

/// Refuses a value that is not possible; as [`DesignError::key`].
pub(super) fn refuse<T>(
    key: impl Into<String>,
    found: impl ToString,
    expected: impl Into<String>,
) -> Checked<T> {
    Err(DesignError::key(key, found, expected))
}

//! Why a number does not exist.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Reasons by name of the result, such as `mauchly.W`; a name stands for all below it.
///
/// Every `None` of a result has a reason here.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Reasons(BTreeMap<String, String>);

impl Reasons {
    /// The reason why `name`, or a prefix of it up to a dot, has no value.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.iter()
            .find(|(key, _)| {
                name.strip_prefix(key)
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
            })
            .map(|(_, reason)| reason)
    }

    /// Names and reasons, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(k, v)| (k.as_str(), v.as_str()))
    }

    /// Whether every number exists.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn note(&mut self, name: &str, reason: impl Into<String>) {
        self.0
            .entry(name.to_owned())
            .or_insert_with(|| reason.into());
    }

    pub(crate) fn note_all(&mut self, names: &[&str], reason: &str) {
        for name in names {
            self.note(name, reason);
        }
    }

    /// Takes over `inner`, each name below `prefix`.
    pub(crate) fn absorb(&mut self, prefix: &str, inner: Self) {
        for (key, reason) in inner.0 {
            let name = match (prefix.is_empty(), key.is_empty()) {
                (true, _) => key,
                (_, true) => prefix.to_owned(),
                _ => format!("{prefix}.{key}"),
            };
            self.0.entry(name).or_insert(reason);
        }
    }
}

/// A p in a sentence: `p = .032`, `p < .001`.
pub(crate) fn p_words(p: f64) -> String {
    if p < 0.001 {
        return "p < .001".to_owned();
    }
    format!("p = {}", format!("{p:.3}").trim_start_matches('0'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_prefix_answers_for_all_below_it_but_not_beside_it() {
        let mut reasons = Reasons::default();
        reasons.note("paired.a|b", "constant");
        assert_eq!(reasons.get("paired.a|b.t"), Some("constant"));
        assert_eq!(reasons.get("paired.a|bc.t"), None);
    }
}

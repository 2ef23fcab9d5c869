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
                name.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
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
        self.0.entry(name.to_owned()).or_insert_with(|| reason.into());
    }

    pub(crate) fn note_all(&mut self, names: &[&str], reason: &str) {
        for name in names {
            self.note(name, reason);
        }
    }

    /// The same for parts of one result, such as `wilcoxon.A|B`.
    pub(crate) fn note_below(&mut self, result: &str, parts: &[&str], reason: &str) {
        for part in parts {
            self.note(&format!("{result}.{part}"), reason);
        }
    }

    /// The same for both ends of intervals: `ci` stands for `ci_low` and `ci_high`.
    pub(crate) fn note_ends(&mut self, intervals: &[&str], reason: &str) {
        for interval in intervals {
            self.note(&format!("{interval}_low"), reason);
            self.note(&format!("{interval}_high"), reason);
        }
    }

    /// A result; its reasons are taken over, each name below `prefix`.
    pub(crate) fn result<T>(&mut self, prefix: &str, (result, inner): (T, Self)) -> T {
        self.absorb(prefix, inner);
        result
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

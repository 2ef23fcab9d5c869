//! What a stage is made from: one list that is hashed and that explains.

use std::collections::BTreeMap;

use crate::content::{Hasher, add_texts};
use crate::place::Program;
use crate::{PipelineError, Reason, Stage};

/// Everything that a stage's outputs depend on, gathered in one traversal.
///
/// Two manifests are equal exactly when their digests are, and where they differ the
/// difference is a [`Reason`]: nothing is hashed that cannot be named.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct Manifest(BTreeMap<FactKind, BTreeMap<String, String>>);

/// The kinds of facts in a manifest.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum FactKind {
    /// `line`: the command line with all parameters in place.
    Command,
    /// Version of the program's command, by the command.
    Version,
    /// Value of each parameter in use, by its name.
    Parameter,
    /// Content of each input, by its path: a hash, for a directory with its number of files.
    Input,
}

const COMMAND_LINE: &str = "line";

impl Manifest {
    /// Lists what `stage` would be made from now, `files` being its share of a directory.
    /// An input that is not there has no entry.
    pub(crate) fn list(
        stage: &Stage,
        files: &[String],
        program: Option<&Program>,
        hasher: &Hasher<'_>,
    ) -> Result<Self, PipelineError> {
        let mut manifest = Self::without_any_input(stage, program);
        manifest.add_inputs(&stage.inputs, hasher)?;
        manifest.add_inputs(files, hasher)?;
        Ok(manifest)
    }

    fn without_any_input(stage: &Stage, program: Option<&Program>) -> Self {
        let mut manifest = Self::default();
        let command = crate::shell::quoted(&stage.command);
        manifest.add(FactKind::Command, COMMAND_LINE, command);
        if let Some(program) = program.filter(|program| program.name == stage.command[0]) {
            let command = stage.command.get(1).map_or("", String::as_str);
            if let Some(version) = program.versions.get(command) {
                let name = format!("{} {command}", program.name);
                manifest.add(FactKind::Version, &name, version.clone());
            }
        }
        if let Some(version) = &stage.version {
            manifest.add(FactKind::Version, &stage.family, version.clone());
        }
        for (name, value) in &stage.params {
            manifest.add(FactKind::Parameter, name, value.clone());
        }
        manifest
    }

    /// Adds the content of each input; one that is not there has no entry.
    fn add_inputs(
        &mut self,
        inputs: impl IntoIterator<Item = impl AsRef<str>>,
        hasher: &Hasher<'_>,
    ) -> Result<(), PipelineError> {
        for input in inputs {
            if let Some(content) = hasher.input(input.as_ref())? {
                self.add(FactKind::Input, input.as_ref(), content);
            }
        }
        Ok(())
    }

    /// The same with other names for the inputs.
    pub(crate) fn with_inputs_renamed(mut self, rename: impl Fn(&str) -> String) -> Self {
        if let Some(inputs) = self.0.get_mut(&FactKind::Input) {
            let renamed = std::mem::take(inputs).into_iter();
            *inputs = renamed.map(|(path, content)| (rename(&path), content)).collect();
        }
        self
    }

    /// The same without the inputs that `is_open` picks.
    pub(crate) fn without_inputs(mut self, is_open: impl Fn(&str) -> bool) -> Self {
        if let Some(inputs) = self.0.get_mut(&FactKind::Input) {
            inputs.retain(|path, _| !is_open(path));
            // A list that never had one has no such kind.
            if inputs.is_empty() {
                self.0.remove(&FactKind::Input);
            }
        }
        self
    }

    /// Takes over the inputs of `now` that `is_open` picks.
    pub(crate) fn with_inputs(mut self, now: &Self, is_open: impl Fn(&str) -> bool) -> Self {
        for (path, content) in now.facts(FactKind::Input) {
            if is_open(path) {
                self.add(FactKind::Input, path, content.to_owned());
            }
        }
        self
    }

    /// The facts of one kind, by name.
    pub fn facts(&self, kind: FactKind) -> impl Iterator<Item = (&str, &str)> {
        let facts = self.0.get(&kind).into_iter().flatten();
        facts.map(|(name, value)| (name.as_str(), value.as_str()))
    }

    /// The inputs that are not the same in both, in order.
    pub(crate) fn inputs_apart(&self, now: &Self) -> Vec<String> {
        let apart = self.changes(now, FactKind::Input).into_iter();
        apart.map(|(path, _)| path).collect()
    }

    /// Whether it names this input.
    pub(crate) fn has_input(&self, path: &str) -> bool {
        let inputs = self.0.get(&FactKind::Input);
        inputs.is_some_and(|inputs| inputs.contains_key(path))
    }

    /// The hash of the whole list, as 64 hexadecimal digits.
    pub fn digest(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        for (kind, facts) in &self.0 {
            for (name, value) in facts {
                hasher.update(&[*kind as u8]);
                add_texts(&mut hasher, [name.as_str(), value.as_str()]);
            }
        }
        hasher.finalize().to_hex().to_string()
    }

    /// Why a stage made from `self` must be made again from `now`; empty if it need not.
    pub(crate) fn differences(&self, now: &Self) -> Vec<Reason> {
        let mut reasons = Vec::new();
        for (name, change) in self.changes(now, FactKind::Parameter) {
            let (before, now) = change;
            reasons.push(Reason::ParameterChanged { name, before, now });
        }
        // A parameter in the command line has already been named: the line as a whole is
        // given only where no parameter explains it.
        if reasons.is_empty() {
            for (_, (before, now)) in self.changes(now, FactKind::Command) {
                let (before, now) = (before.unwrap_or_default(), now.unwrap_or_default());
                reasons.push(Reason::CommandChanged { before, now });
            }
        }
        for (command, (before, now)) in self.changes(now, FactKind::Version) {
            reasons.push(Reason::VersionChanged { command, before, now });
        }
        for (path, (before, now)) in self.changes(now, FactKind::Input) {
            reasons.push(match (before, now) {
                (None, _) => Reason::InputAdded { path },
                (_, None) => Reason::InputRemoved { path },
                (Some(before), Some(now)) => Reason::InputChanged { path, before, now },
            });
        }
        reasons
    }

    fn add(&mut self, kind: FactKind, name: &str, value: String) {
        self.0.entry(kind).or_default().insert(name.to_owned(), value);
    }

    /// The facts of a kind that differ, by name, as they were and as they are.
    fn changes(&self, now: &Self, kind: FactKind) -> BTreeMap<String, Change> {
        let mut changes: BTreeMap<String, Change> = BTreeMap::new();
        for (name, value) in self.facts(kind) {
            changes.entry(name.to_owned()).or_default().0 = Some(value.to_owned());
        }
        for (name, value) in now.facts(kind) {
            changes.entry(name.to_owned()).or_default().1 = Some(value.to_owned());
        }
        changes.retain(|_, (before, now)| before != now);
        changes
    }
}

type Change = (Option<String>, Option<String>);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn manifest(facts: &[(FactKind, &str, &str)]) -> Manifest {
        let mut manifest = Manifest::default();
        for (kind, name, value) in facts {
            manifest.add(*kind, name, (*value).to_owned());
        }
        manifest
    }

    #[test]
    fn a_parameter_is_named_instead_of_the_whole_command_line() {
        let before = manifest(&[
            (FactKind::Command, COMMAND_LINE, "x 1"),
            (FactKind::Parameter, "seed", "1"),
        ]);
        let now = manifest(&[
            (FactKind::Command, COMMAND_LINE, "x 2"),
            (FactKind::Parameter, "seed", "2"),
        ]);
        let reasons = before.differences(&now);
        assert_eq!(reasons.len(), 1);
        assert_eq!(reasons[0].to_string(), "parameter `seed` changed from 1 to 2");
    }

    #[test]
    fn without_its_only_input_a_list_is_as_if_it_had_never_had_one() {
        let line = (FactKind::Command, COMMAND_LINE, "x");
        let one = manifest(&[line, (FactKind::Input, "a.txt", "00")]);
        let without = |path: &str| one.clone().without_inputs(|input| input == path);
        assert_eq!(without("a.txt"), manifest(&[line]));
        assert_eq!(without("b.txt"), one);
    }

    fn any_manifest() -> impl Strategy<Value = Manifest> {
        let kind = prop_oneof![
            Just(FactKind::Command),
            Just(FactKind::Version),
            Just(FactKind::Parameter),
            Just(FactKind::Input),
        ];
        let fact = (kind, "[ab]{0,2}", "[ab]{0,2}");
        prop::collection::vec(fact, 0..4).prop_map(|facts| {
            let mut manifest = Manifest::default();
            for (kind, name, value) in facts {
                manifest.add(kind, &name, value);
            }
            manifest
        })
    }

    proptest! {
        #[test]
        fn a_digest_differs_exactly_when_a_difference_can_be_named(
            a in any_manifest(), b in any_manifest()
        ) {
            prop_assert_eq!(a.digest() != b.digest(), !a.differences(&b).is_empty());
        }
    }
}

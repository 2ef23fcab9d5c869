//! A pipeline put together in code: what the file would say.

use crate::{Pipeline, PipelineError, Settings};
use std::path::Path;

/// A stage of a pipeline that no file describes. Braces in it are braces.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NewStage {
    /// Fit for a file name, and of no other stage.
    pub name: String,
    /// The command, word by word.
    pub command: Vec<String>,
    /// Files and folders that it reads, relative to the root.
    pub inputs: Vec<String>,
    /// Files and folders that it makes.
    pub outputs: Vec<String>,
}

impl NewStage {
    /// A stage that runs a command.
    pub fn new<'a>(name: &str, command: impl IntoIterator<Item = &'a str>) -> Self {
        Self {
            name: name.to_owned(),
            command: command.into_iter().map(str::to_owned).collect(),
            ..Self::default()
        }
    }

    /// The same, reading these.
    #[must_use]
    pub fn reads<'a>(mut self, inputs: impl IntoIterator<Item = &'a str>) -> Self {
        self.inputs.extend(inputs.into_iter().map(str::to_owned));
        self
    }

    /// The same, making these.
    #[must_use]
    pub fn makes<'a>(mut self, outputs: impl IntoIterator<Item = &'a str>) -> Self {
        self.outputs.extend(outputs.into_iter().map(str::to_owned));
        self
    }

    fn table(&self) -> toml::Value {
        let text = |s: &String| toml::Value::String(s.replace('{', "{{").replace('}', "}}"));
        let list = |texts: &[String]| toml::Value::Array(texts.iter().map(text).collect());
        let mut table = toml::Table::new();
        table.insert("name".to_owned(), text(&self.name));
        table.insert("cmd".to_owned(), list(&self.command));
        table.insert("inputs".to_owned(), list(&self.inputs));
        table.insert("outputs".to_owned(), list(&self.outputs));
        toml::Value::Table(table)
    }
}

impl Pipeline {
    /// The pipeline of some stages; by the same rules as one that is read from a file.
    ///
    /// # Errors
    /// As [`Pipeline::parse`]; they name places in [`Pipeline::text`].
    pub fn from_stages(
        name: &str,
        stages: &[NewStage],
        root: &Path,
    ) -> Result<Self, PipelineError> {
        let mut file = toml::Table::new();
        file.insert("name".to_owned(), toml::Value::String(name.to_owned()));
        let stages = stages.iter().map(NewStage::table).collect();
        file.insert("stage".to_owned(), toml::Value::Array(stages));
        let path = root.join(format!("{name}.toml"));
        Self::parse(&file.to_string(), &path, root, &Settings::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_of_code_are_those_of_a_file_and_braces_stay() {
        let stages = [
            NewStage::new("a", ["sh", "-c", "echo ${x} {y} > a"]).makes(["a"]),
            NewStage::new("b", ["cp", "a", "b"])
                .reads(["a"])
                .makes(["b"]),
        ];
        let made = Pipeline::from_stages("two", &stages, Path::new(".")).unwrap();
        assert_eq!(made.stages().len(), 2);
        assert_eq!(made.stages()[0].command[2], "echo ${x} {y} > a");
        let twice = [stages[0].clone(), stages[0].clone()];
        assert!(Pipeline::from_stages("two", &twice, Path::new(".")).is_err());
    }
}

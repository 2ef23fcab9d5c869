//! The pipeline file: TOML in, stages out, with their parameters put in.
//!
//! ```toml
//! name = "paper"                 # names the pipeline in its ledger
//!
//! [params]                       # strings, decimal numbers, booleans; `--set` replaces them
//! out = "data"
//! model = "{out}/model.json"     # a parameter may use another
//!
//! [[stage]]
//! name = "train"
//! cmd = ["maveric", "train", "--drives", "{out}/drives", "--out", "{model}"]
//! inputs = ["{out}/drives"]      # files or whole directories
//! outputs = ["{model}"]          # made by no other stage
//! summary = true                 # its standard output ends the run
//! inputs_help = "where to get the drives, said when they are missing"
//! ```
//!
//! `{{name}}` stands for the text `{name}`; braces around anything that is no name stay.
//! Unknown keys are errors.

mod tables;
mod value;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use toml::de::DeTable;

use crate::PipelineError;
use crate::error::FileProblem;
use tables::{read_params, read_stages};
use value::{Located, check_keys, check_name, required, string};

const TOP_KEYS: &[&str] = &["name", "params", "stage"];
const TOP: &str = "the pipeline";

/// A pipeline as its file describes it, with every `{parameter}` replaced.
///
/// Only [`Pipeline::read`] and [`Pipeline::parse`] make one, so that its stages are known
/// to have unique names, commands, and paths in one spelling.
#[derive(Debug, Clone)]
pub struct Pipeline {
    name: String,
    path: PathBuf,
    overrides: BTreeMap<String, String>,
    stages: Vec<Stage>,
}

/// One step: a command line, what it reads and what it makes.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Stage {
    /// Its name, fit for a file name.
    pub name: String,
    /// Program and arguments; never empty.
    pub command: Vec<String>,
    /// Files or whole directories that it reads, relative to the root.
    pub inputs: Vec<String>,
    /// Files or whole directories that it makes, relative to the root.
    pub outputs: Vec<String>,
    /// The parameters that stand in its command or paths, with their values.
    pub params: BTreeMap<String, String>,
    /// Whether its standard output belongs to the summary at the end of a run.
    pub summary: bool,
    /// How to get its inputs, said when one is missing.
    pub inputs_help: Option<String>,
}

impl Pipeline {
    /// Reads a pipeline file; `overrides` are `--set` pairs, of which the last one wins.
    ///
    /// # Errors
    /// [`PipelineError::Unreadable`] if there is no such text file, otherwise as
    /// [`Pipeline::parse`].
    pub fn read(path: &Path, overrides: &[(String, String)]) -> Result<Self, PipelineError> {
        let text = std::fs::read_to_string(path).map_err(|source| PipelineError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&text, path, overrides)
    }

    /// Reads a pipeline from text; `path` is only named in messages.
    ///
    /// # Errors
    /// [`PipelineError::Malformed`] with the position, or one of the errors of overrides.
    ///
    /// # Example
    /// ```
    /// # use maveric_pipeline::Pipeline;
    /// let text = r#"
    /// name = "greeting"
    /// [params]
    /// who = "world"
    /// [[stage]]
    /// name = "greet"
    /// cmd = ["sh", "-c", "echo {who} > hello.txt"]
    /// outputs = ["hello.txt"]
    /// "#;
    /// let pipeline = Pipeline::parse(text, "greeting.toml".as_ref(), &[])?;
    /// assert_eq!(pipeline.stages()[0].command[2], "echo world > hello.txt");
    /// # Ok::<(), maveric_pipeline::PipelineError>(())
    /// ```
    pub fn parse(
        text: &str,
        path: &Path,
        overrides: &[(String, String)],
    ) -> Result<Self, PipelineError> {
        let located = |at: Located| at.into_error(text, path);
        let document = DeTable::parse(text).map_err(|error| {
            located(Located {
                at: error.span().map_or(0, |span| span.start),
                problem: FileProblem::Syntax {
                    message: error.message().to_owned(),
                },
            })
        })?;
        let table = document.get_ref();
        check_keys(table, TOP, TOP_KEYS).map_err(located)?;
        let name = required(table, "name", TOP, 0).map_err(located)?;
        let (name_text, at) = (string("name", name).map_err(located)?, name.span().start);
        check_name(&name_text, at).map_err(located)?;
        let mut params = read_params(table).map_err(located)?;
        for (key, value) in overrides {
            params.set(key, value)?;
        }
        let stages = read_stages(table, &params, text).map_err(located)?;
        Ok(Self {
            name: name_text,
            path: path.to_owned(),
            overrides: overrides.iter().cloned().collect(),
            stages,
        })
    }

    /// The pipeline's name, fit for a file name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file that it was read from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its stages, in the order of the file.
    pub fn stages(&self) -> &[Stage] {
        &self.stages
    }

    /// What `--set` replaced.
    pub fn overrides(&self) -> &BTreeMap<String, String> {
        &self.overrides
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Pipeline, PipelineError> {
        Pipeline::parse(text, Path::new("p.toml"), &[])
    }

    fn message(text: &str) -> String {
        let error = parsed(text).unwrap_err();
        let help = error
            .suggestion()
            .map_or_else(String::new, |help| format!(" ({help})"));
        format!("{error}{help}")
    }

    const STAGE_A: &str =
        "name = 'p'\n[params]\nseed = 1_000\nrate = 2.50\n[[stage]]\nname = 'a'\n";

    #[test]
    fn numbers_are_put_in_as_written() {
        let text = format!("{STAGE_A}cmd = ['x', '{{seed}}', '{{rate}}']");
        let pipeline = parsed(&text).unwrap();
        assert_eq!(pipeline.stages()[0].command, ["x", "1000", "2.50"]);
        assert_eq!(pipeline.stages()[0].params["seed"], "1000");
    }

    #[test]
    fn an_override_replaces_a_value_and_is_kept() {
        let text = format!("{STAGE_A}cmd = ['x', '{{seed}}']");
        let overrides = [("seed".to_owned(), "7".to_owned())];
        let pipeline = Pipeline::parse(&text, Path::new("p.toml"), &overrides).unwrap();
        assert_eq!(pipeline.stages()[0].command, ["x", "7"]);
        assert_eq!(pipeline.overrides()["seed"], "7");
    }

    #[test]
    fn an_unknown_key_has_its_position_and_the_key_that_was_meant() {
        assert_eq!(
            message(&format!("{STAGE_A}cmd = ['x']\ninptus = []")),
            "p.toml:8:1: unknown key `inptus` in [[stage]] (did you mean `inputs`?)"
        );
    }

    #[test]
    fn an_unknown_parameter_has_its_position_and_the_name_that_was_meant() {
        assert_eq!(
            message(&format!("{STAGE_A}cmd = ['x', '{{sed}}']")),
            "p.toml:7:13: `{sed}` stands for a parameter, and [params] has no `sed` \
             (did you mean `seed`?)"
        );
    }

    #[test]
    fn other_mistakes_are_named_where_they_stand() {
        let cases = [
            ("name = 'p'", "p.toml:1:1: the pipeline has no [[stage]]"),
            ("", "p.toml:1:1: the pipeline lacks `name`"),
            (
                "name = 'p'\n[[stage]]\nname = 'a'",
                "p.toml:2:1: [[stage]] lacks `cmd`",
            ),
            (
                "name = 'p'\n[[stage]]\nname = 'a'\ncmd = 'ls'",
                "p.toml:4:7: `cmd` is a string, expected an array of strings",
            ),
            (
                "name = 'p'\n[[stage]]\nname = 'a'\ncmd = ['x']\noutputs = ['a/..']",
                "p.toml:5:12: `a/..` cannot be an input or output: it names no file or \
                 directory below the root",
            ),
            (
                "name = 'p'\n[[stage]]\nname = 'a'\ncmd = ['x']\n[[stage]]\nname = 'a'\ncmd = ['x']",
                "p.toml:6:8: a second stage `a`; the first is on line 3",
            ),
            (
                "name = 'a/b'",
                "p.toml:1:8: `a/b` cannot be a name: letters, digits, `_` and `-`, the first a \
                 letter or digit",
            ),
        ];
        for (text, expected) in cases {
            assert_eq!(message(text), expected);
        }
        assert!(message("name = 'p").starts_with("p.toml:1:"));
    }
}

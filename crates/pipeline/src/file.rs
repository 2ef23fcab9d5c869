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
//! A stage may be one of many: `foreach = "table.csv"` makes one for each row, with the
//! columns in braces, `matrix = { seed = [1, 2], method = ["a", "b"] }` one for each
//! combination, and `shards = 4` cuts it in four.
//!
//! `{{name}}` stands for the text `{name}`; braces around anything that is no name stay.
//! Unknown keys are errors.

mod fan;
pub(crate) mod keys;
mod schema;
mod tables;
mod value;

pub use schema::schema;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use toml::de::DeTable;

use crate::error::FileProblem;
use crate::{PipelineError, Stage};
use keys::TOP_KEYS;
use tables::{read_params, read_stages};
use value::{Located, check_keys, check_name, required, string};

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

impl Pipeline {
    /// Reads a pipeline file; `overrides` are `--set` pairs, of which the last one wins, and
    /// tables for `foreach` are looked for below `root`.
    ///
    /// # Errors
    /// [`PipelineError::Unreadable`] if there is no such text file, otherwise as
    /// [`Pipeline::parse`].
    pub fn read(
        path: &Path,
        root: &Path,
        overrides: &[(String, String)],
    ) -> Result<Self, PipelineError> {
        let text = std::fs::read_to_string(path).map_err(|source| PipelineError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&text, path, root, overrides)
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
    /// let pipeline = Pipeline::parse(text, "greeting.toml".as_ref(), ".".as_ref(), &[])?;
    /// assert_eq!(pipeline.stages()[0].command[2], "echo world > hello.txt");
    /// # Ok::<(), maveric_pipeline::PipelineError>(())
    /// ```
    pub fn parse(
        text: &str,
        path: &Path,
        root: &Path,
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
        let stages = read_stages(table, &params, root, text).map_err(located)?;
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
        Pipeline::parse(text, Path::new("p.toml"), Path::new("."), &[])
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
        let pipeline =
            Pipeline::parse(&text, Path::new("p.toml"), Path::new("."), &overrides).unwrap();
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

    fn in_folder(table: &str, stage: &str) -> Result<Pipeline, PipelineError> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("t.csv"), table).unwrap();
        let text = format!("name = 'p'\n[params]\nseed = 1\n[[stage]]\nname = 'fit'\n{stage}");
        Pipeline::parse(&text, Path::new("p.toml"), folder.path(), &[])
    }

    fn names(pipeline: &Pipeline) -> Vec<&str> {
        pipeline.stages().iter().map(|s| s.name.as_str()).collect()
    }

    #[test]
    fn a_table_gives_a_stage_for_each_distinct_use_of_its_columns() {
        let table = "who,day,note\nann,1,x y\nann,2,{odd}\nbob b,1,\n";
        let stage = "foreach = 't.csv'\ncmd = ['x', '{who}', '{seed}']\noutputs = ['{who}.txt']";
        let pipeline = in_folder(table, stage).unwrap();
        assert_eq!(names(&pipeline), ["fit.ann", "fit.bob_b"]);
        let bob = &pipeline.stages()[1];
        assert_eq!(
            (bob.family.as_str(), bob.command[1].as_str()),
            ("fit", "bob b")
        );
        assert_eq!(bob.row.as_ref().map(|row| row.line), Some(4));
        assert_eq!(bob.params["who"], "bob b");
        let stage = "foreach = 't.csv'\ncmd = ['x', '{who}', '{note}']";
        let pipeline = in_folder(table, stage).unwrap();
        assert_eq!(
            names(&pipeline),
            ["fit.ann.x_y", "fit.ann._odd_", "fit.bob_b."]
        );
        assert_eq!(pipeline.stages()[1].command[2], "{odd}");
    }

    #[test]
    fn a_matrix_gives_all_combinations_and_shards_cut_each() {
        let stage = "matrix = { z = [1, 2.5], a = ['k'] }\nshards = 2\nover = 'd/*.csv'\n\
                     cmd = ['x', '{z}', '{a}', '{shard}/{shards}', '{files}']";
        let pipeline = in_folder("", stage).unwrap();
        assert_eq!(
            names(&pipeline),
            ["fit.1.k.0", "fit.1.k.1", "fit.2.5.k.0", "fit.2.5.k.1"]
        );
        let last = &pipeline.stages()[3];
        assert_eq!(last.command[1..], ["2.5", "k", "1/2", "{files}"]);
        assert_eq!(last.arguments(&["d/1.csv".to_owned()])[3..], ["d/1.csv"]);
        assert_eq!(last.reads().collect::<Vec<_>>(), ["d"]);
    }

    #[test]
    fn a_fan_out_that_cannot_be_is_refused_where_it_stands() {
        let cases = [
            (
                "foreach = 'u.csv'\ncmd = ['x']",
                "p.toml:6:11: cannot read the table `u.csv`",
            ),
            (
                "foreach = 't.csv'\ncmd = ['x']",
                "uses no column of its table",
            ),
            ("foreach = 't.csv'\ncmd = ['{wo}']", "did you mean `who`"),
            (
                "matrix = { seed = [1] }\ncmd = ['{seed}']",
                "`seed` is also a parameter",
            ),
            (
                "matrix = { a = [] }\ncmd = ['{a}']",
                "p.toml:6:16: `a` is an array",
            ),
            (
                "shards = 0\ncmd = ['x']",
                "`shards` is an integer, expected a whole number",
            ),
            (
                "over = 'd'\ncmd = ['x']",
                "[[stage]] with `over` lacks `shards`",
            ),
            (
                "shards = 2\nover = '*/d'\ncmd = ['x']",
                "`*/d` cannot be dealt out",
            ),
            (
                "shards = 2\nover = 'd'\ncmd = ['a{files}']",
                "`{files}` must be a word of its own",
            ),
            (
                "shards = 2\nmatrix = {a=['é','ü']}\ncmd = ['{a}{shard}']",
                "a second stage",
            ),
            (
                "foreach = 't.csv'\nmatrix = {a=[1]}\ncmd = ['x']",
                "both `foreach` and `matrix`",
            ),
        ];
        for (stage, expected) in cases {
            let error = in_folder("who\nann\n", stage).unwrap_err();
            let help = error.suggestion().unwrap_or_default();
            let message = format!("{error} ({help})");
            assert!(message.contains(expected), "{message}");
        }
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

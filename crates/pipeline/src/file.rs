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
//! `extends = "other.toml"` takes over the stages and parameters of another file, from the
//! folder of this one: what this file has in `[params]` replaces values there, a `[[stage]]`
//! replaces the whole stage of its name or comes after all of them.
//!
//! `{{name}}` stands for the text `{name}`; braces around anything that is no name stay. Inside
//! the script of a shell (`["sh", "-c", SCRIPT]`) a value is quoted for the shell.
//! Unknown keys are errors.

mod commands;
mod fan;
pub(crate) mod keys;
mod layers;
mod schema;
mod tables;
mod value;

pub use commands::{CommandFiles, Commands};
pub use schema::schema;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::{PipelineError, Stage};
use commands::add_what_is_there;
use layers::{Layer, check_added, merged_params, merged_stages, move_roots, with_layers};
use tables::{Surroundings, read_stages};
use value::{check_name, required, string};

/// What a run gives to a pipeline or changes in it.
#[derive(Debug, Clone, Default)]
pub struct Settings {
    /// `--set` pairs, of which the last one wins.
    pub set: Vec<(String, String)>,
    /// The name of a variant: every parameter with which outputs begin gets `-NAME`, so that
    /// it stands beside what is run without.
    pub variant: Option<String>,
    /// Parameters that stages may use and that the file need not have.
    pub provided: BTreeMap<String, String>,
    /// A program whose commands say themselves what they read and write.
    pub commands: Option<Commands>,
}

/// A pipeline as its file describes it, with every `{parameter}` replaced.
///
/// Only [`Pipeline::read`] and [`Pipeline::parse`] make one, so that its stages are known
/// to have unique names, commands, and paths in one spelling.
#[derive(Debug, Clone)]
pub struct Pipeline {
    name: String,
    path: PathBuf,
    overrides: BTreeMap<String, String>,
    variant: Option<String>,
    text: String,
    stages: Vec<Stage>,
}

impl Pipeline {
    /// Reads a pipeline file; tables for `foreach` are looked for below `root`.
    ///
    /// # Errors
    /// [`PipelineError::Unreadable`] if there is no such text file, otherwise as
    /// [`Pipeline::parse`].
    pub fn read(path: &Path, root: &Path, settings: &Settings) -> Result<Self, PipelineError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| PipelineError::Unreadable { path: path.to_owned(), source })?;
        Self::parse(&text, path, root, settings)
    }

    /// Reads a pipeline from text; `path` is named in messages, and files that the text
    /// extends are looked for beside it.
    ///
    /// # Errors
    /// [`PipelineError::Malformed`] with the position, or one of the errors of settings.
    ///
    /// # Example
    /// ```
    /// # use maveric_pipeline::{Pipeline, Settings};
    /// let text = r#"
    /// name = "greeting"
    /// [params]
    /// who = "world"
    /// [[stage]]
    /// name = "greet"
    /// cmd = ["sh", "-c", "echo {who} > hello.txt"]
    /// outputs = ["hello.txt"]
    /// "#;
    /// let settings = Settings::default();
    /// let pipeline = Pipeline::parse(text, "greeting.toml".as_ref(), ".".as_ref(), &settings)?;
    /// assert_eq!(pipeline.stages()[0].command[2], "echo world > hello.txt");
    /// # Ok::<(), maveric_pipeline::PipelineError>(())
    /// ```
    pub fn parse(
        text: &str,
        path: &Path,
        root: &Path,
        settings: &Settings,
    ) -> Result<Self, PipelineError> {
        with_layers(path, text, &[], &mut |layers| Self::assemble(layers, path, root, settings))
    }

    fn assemble(
        layers: &[Layer<'_>],
        path: &Path,
        root: &Path,
        settings: &Settings,
    ) -> Result<Self, PipelineError> {
        let top = layers[0];
        let name = required(top.table, "name", "the pipeline", 0).map_err(|at| top.error(at))?;
        let text = string("name", name).map_err(|at| top.error(at))?;
        check_name(&text, name.span().start).map_err(|at| top.error(at))?;
        let mut params = merged_params(layers)?;
        for (name, value) in &settings.provided {
            params.provide(name, value);
        }
        for (key, value) in &settings.set {
            params.set(key, value)?;
        }
        let entries = merged_stages(layers)?;
        let commands = settings.commands;
        let surroundings = Surroundings { root, commands };
        let (mut stages, mut if_there) = read_stages(&entries, &params, surroundings)?;
        if let Some(variant) = &settings.variant {
            move_roots(&entries, &stages, &mut params, variant)?;
            (stages, if_there) = read_stages(&entries, &params, surroundings)?;
        }
        check_added(layers, &stages)?;
        add_what_is_there(&mut stages, if_there, root);
        Ok(Self {
            name: text,
            path: path.to_owned(),
            overrides: settings.set.iter().cloned().collect(),
            variant: settings.variant.clone(),
            text: top.text.to_owned(),
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

    /// The text of its own file, without what that extends.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The variant that it is, if it is one.
    pub fn variant(&self) -> Option<&str> {
        self.variant.as_deref()
    }

    /// What `--set` replaced.
    pub fn overrides(&self) -> &BTreeMap<String, String> {
        &self.overrides
    }
}

#[cfg(test)]
mod tests;

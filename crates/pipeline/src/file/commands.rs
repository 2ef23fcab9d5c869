//! Commands that say themselves what they read and write, in the place of `inputs` and `outputs`.

use super::value::{Located, Value};
use crate::error::FileProblem;
use crate::paths::{normalise, with_ancestors};
use crate::stage::{FILES, Stage};
use path_slash::PathExt as _;
use std::collections::BTreeSet;
use std::path::Path;

/// A program that knows the files of its own commands: a stage that calls it needs neither `inputs` nor `outputs`.
#[derive(Debug, Clone, Copy)]
pub struct Commands {
    /// The first word of a stage's `cmd` that means this program.
    pub program: &'static str,
    /// What a command reads and writes, by the words after the program's name, run in the folder that comes first; none of a
    /// command whose files it does not know. An error says why the words are no such command.
    pub files: fn(&Path, &[String]) -> Result<Option<CommandFiles>, String>,
}

/// What a command reads and writes; paths from the folder where it runs.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CommandFiles {
    /// Files or whole directories that it reads.
    pub inputs: Vec<String>,
    /// Those that it reads if they are there: inputs where a stage makes them or they stand on the disk.
    pub if_there: Vec<String>,
    /// Files or whole directories that it makes.
    pub outputs: Vec<String>,
}

impl Commands {
    /// The files of a stage's command, paths in one spelling.
    pub(super) fn files_of(
        self,
        root: &Path,
        command: &[String],
        at: usize,
    ) -> Result<Option<CommandFiles>, Located> {
        let call = command.split_first();
        let Some((_, words)) = call.filter(|(program, _)| program.as_str() == self.program) else {
            return Ok(None);
        };
        let files = (self.files)(root, words)
            .map_err(|message| FileProblem::NoCommand { message }.located(at))?;
        let Some(files) = files else { return Ok(None) };
        let above = std::path::absolute(root).unwrap_or_else(|_| root.to_owned());
        let spelled = |paths: Vec<String>| {
            let mut spelled: Vec<String> = Vec::new();
            for path in paths.into_iter().filter(|path| path != FILES) {
                let below = Path::new(&path).strip_prefix(&above);
                let below = below.map_or(path.clone(), |p| p.to_slash_lossy().into_owned());
                let Some(path) = normalise(&below) else {
                    return Err(FileProblem::BadPath { path }.located(at));
                };
                if !spelled.contains(&path) {
                    spelled.push(path);
                }
            }
            Ok(spelled)
        };
        Ok(Some(CommandFiles {
            inputs: spelled(files.inputs)?,
            if_there: spelled(files.if_there)?,
            outputs: spelled(files.outputs)?,
        }))
    }
}

impl CommandFiles {
    /// Refuses a list of a pipeline file that says something else.
    pub(super) fn check(
        &self,
        key: &'static str,
        value: Option<&Value<'_>>,
        written: &[String],
    ) -> Result<(), Located> {
        let Some(value) = value else { return Ok(()) };
        let (must, others) = match key {
            "inputs" => (&self.inputs, &self.if_there[..]),
            _ => (&self.outputs, &[][..]),
        };
        let lacks = must.iter().filter(|path| !written.contains(path));
        let known = |path: &&String| must.contains(path) || others.contains(path);
        let strange = written.iter().filter(|path| !known(path));
        let (lacks, strange): (Vec<_>, Vec<_>) =
            (lacks.cloned().collect(), strange.cloned().collect());
        if lacks.is_empty() && strange.is_empty() {
            return Ok(());
        }
        Err(FileProblem::OtherFiles { key, lacks, strange }.located(value.span().start))
    }

    /// Whether a path is in any of its own.
    pub(super) fn has_in_path(&self, text: &str) -> bool {
        let lists = [&self.inputs, &self.if_there, &self.outputs];
        lists.into_iter().flatten().any(|path| path.contains(text))
    }
}

/// Adds to each stage what it reads if it is there: made by another stage, or on the disk.
pub(super) fn add_what_is_there(stages: &mut [Stage], if_there: Vec<Vec<String>>, root: &Path) {
    let outputs = stages.iter().flat_map(|stage| &stage.outputs).cloned();
    let outputs: BTreeSet<String> = outputs.collect();
    for (stage, paths) in stages.iter_mut().zip(if_there) {
        for path in paths {
            let folder = format!("{path}/");
            let inside = outputs.range(folder.clone()..).next();
            let is_made = with_ancestors(&path).any(|above| outputs.contains(above))
                || inside.is_some_and(|first| first.starts_with(&folder));
            let makes_it = stage.outputs.iter().any(|output| {
                with_ancestors(&path).any(|above| above == output) || output.starts_with(&folder)
            });
            if !makes_it && !stage.inputs.contains(&path) && (is_made || root.join(&path).exists())
            {
                stage.inputs.push(path);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pipeline, PipelineError, Settings};

    /// `tool copy FROM TO [IF_THERE]`
    fn copies(_: &Path, words: &[String]) -> Result<Option<CommandFiles>, String> {
        let list = |word: Option<&String>| word.cloned().into_iter().collect();
        match words.first().map(String::as_str) {
            Some("copy") if words.len() < 3 => Err("copy needs FROM and TO".to_owned()),
            Some("copy") => Ok(Some(CommandFiles {
                inputs: list(words.get(1)),
                if_there: list(words.get(3)),
                outputs: list(words.get(2)),
            })),
            _ => Ok(None),
        }
    }

    fn read(stages: &str, root: &Path, variant: Option<&str>) -> Result<Vec<Stage>, PipelineError> {
        let text =
            format!("name = \"p\"\n[params]\nout = \"made\"\nmodel = \"{{out}}/model\"\n{stages}");
        let settings = Settings {
            variant: variant.map(str::to_owned),
            commands: Some(Commands { program: "tool", files: copies }),
            ..Settings::default()
        };
        let pipeline = Pipeline::parse(&text, "p.toml".as_ref(), root, &settings)?;
        Ok(pipeline.stages().to_vec())
    }

    fn stage(name: &str, words: &str) -> String {
        let words: Vec<String> = words.split(' ').map(|word| format!("\"{word}\"")).collect();
        format!("[[stage]]\nname = \"{name}\"\ncmd = [{}]\n", words.join(", "))
    }

    #[test]
    fn inputs_and_outputs_follow_from_a_command_that_is_known() {
        let here = Path::new(".");
        let stages = read(&stage("a", "tool copy in.csv {out}/./a.csv"), here, None).unwrap();
        assert_eq!(stages[0].inputs, ["in.csv"]);
        assert_eq!(stages[0].outputs, ["made/a.csv"]);
        let other = read(&stage("a", "tool other in.csv {out}/a.csv"), here, None).unwrap();
        assert!(other[0].inputs.is_empty() && other[0].outputs.is_empty());
        let whole = std::path::absolute(here).unwrap().join("a.csv");
        let below =
            read(&stage("a", &format!("tool copy in.csv {}", whole.to_slash_lossy())), here, None);
        assert_eq!(below.unwrap()[0].outputs, ["a.csv"]);
        let wrong = read(&stage("a", "tool copy in.csv"), here, None).unwrap_err();
        assert_eq!(wrong.to_string(), "p.toml:5:1: copy needs FROM and TO");
    }

    #[test]
    fn a_list_that_says_them_too_and_differs_is_refused() {
        let here = Path::new(".");
        let with = |lists: &str| read(&(stage("a", "tool copy x y z") + lists), here, None);
        assert!(with("inputs = [\"x\"]\noutputs = [\"./y\"]").is_ok());
        assert!(with("inputs = [\"x\", \"z\"]").is_ok(), "z is read if it is there");
        let said = |lists: &str| with(lists).unwrap_err().to_string();
        assert_eq!(
            said("inputs = [\"z\"]"),
            "p.toml:8:10: `inputs` is not what the command reads: it lacks x"
        );
        assert_eq!(
            said("outputs = [\"y\", \"more\"]"),
            "p.toml:8:11: `outputs` is not what the command writes: it has more"
        );
    }

    #[test]
    fn what_is_read_if_there_is_an_input_where_it_is_made_or_stands_on_the_disk() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("notes"), "x").unwrap();
        let inputs = |if_there: &str| {
            let two = stage("a", "tool copy x {out}/drives")
                + &stage("b", &format!("tool copy x y {if_there}"));
            read(&two, folder.path(), None).unwrap()[1].inputs.clone()
        };
        assert_eq!(inputs("notes"), ["x", "notes"]);
        assert_eq!(inputs("made/drives/a.csv"), ["x", "made/drives/a.csv"]);
        assert_eq!(inputs("made"), ["x", "made"], "another stage makes a part of it");
        assert_eq!(inputs("nowhere"), ["x"]);
        assert_eq!(inputs("y"), ["x"], "its own output");
    }

    #[test]
    fn a_variant_moves_outputs_that_follow_from_a_command() {
        let here = Path::new(".");
        let two = stage("a", "tool copy x {model}") + &stage("b", "tool copy {model} {out}/b");
        let moved = read(&two, here, Some("b")).unwrap();
        assert_eq!(moved[0].outputs, ["made-b/model"]);
        assert_eq!(moved[1].inputs, ["made-b/model"]);
        assert_eq!(moved[1].outputs, ["made-b/b"]);
        let fixed = read(&stage("a", "tool copy x fixed/y"), here, Some("b")).unwrap_err();
        assert!(matches!(fixed, PipelineError::NoRoot { .. }), "{fixed}");
    }
}

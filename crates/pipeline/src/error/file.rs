//! What is wrong within a pipeline file.

use super::{
    MOST_STAGES,
    words::{did_you_mean, listing},
};
use path_slash::PathExt as _;
use std::path::PathBuf;

/// What is wrong at one place of a pipeline file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileProblem {
    /// Not TOML.
    #[error("{message}")]
    Syntax {
        /// The parser's words.
        message: String,
    },
    /// A key that the table does not have.
    #[error("unknown key `{key}` in {table}")]
    UnknownKey {
        /// The key that was found.
        key: String,
        /// The table, as it is written in the file.
        table: &'static str,
        /// The most similar key, if one is similar.
        nearest: Option<String>,
        /// The keys that the table may have.
        known: Vec<&'static str>,
    },
    /// A key that must be there and is not.
    #[error("{table} lacks `{key}`")]
    MissingKey {
        /// The key, without its table.
        key: &'static str,
        /// The table, as it is written in the file.
        table: &'static str,
    },
    /// A value of another type.
    #[error("`{key}` is {found}, expected {expected}")]
    WrongType {
        /// The key, as it is written in the file.
        key: String,
        /// The type that was found, with its article.
        found: String,
        /// The type that is needed.
        expected: &'static str,
    },
    /// A name that cannot be one.
    #[error("`{name}` cannot be a name: letters, digits, `_` and `-`, the first a letter or digit")]
    BadName {
        /// The name that was found.
        name: String,
    },
    /// Two stages of one name.
    #[error("a second stage `{name}`; the first is on line {first_line}")]
    DuplicateStage {
        /// What both are called.
        name: String,
        /// Where the first one stands.
        first_line: usize,
    },
    /// A pipeline without stages.
    #[error("the pipeline has no [[stage]]")]
    NoStages,
    /// A `{name}` without such a parameter.
    #[error("`{{{name}}}` stands for a parameter, and [params] has no `{name}`")]
    UnknownParameter {
        /// The name between the braces.
        name: String,
        /// The most similar parameter.
        nearest: Option<String>,
    },
    /// A parameter whose value contains itself.
    #[error("parameter `{name}` contains itself")]
    CircularParameter {
        /// The parameter.
        name: String,
    },
    /// A parameter that a file adds to those that it extends, and that is of no use.
    #[error("`{name}` is no parameter of what this file extends, and no stage uses it")]
    UnusedParameter {
        /// The parameter.
        name: String,
        /// The most similar parameter.
        nearest: Option<String>,
    },
    /// A file to be extended that cannot be read.
    #[error("cannot read {}, which this file extends: {message}", path.to_slash_lossy())]
    NoBase {
        /// The file.
        path: PathBuf,
        /// What the system said.
        message: String,
    },
    /// A file that extends itself, at once or through others.
    #[error("{} extends itself", path.to_slash_lossy())]
    ExtendsItself {
        /// The file.
        path: PathBuf,
    },
    /// More stages than can be meant.
    #[error("the fan-out gives {stages} stages, at most {MOST_STAGES} are possible")]
    TooManyStages {
        /// How many there would be.
        stages: u64,
    },
    /// A value that cannot be quoted where it stands in a shell's script.
    #[error("`{{{name}}}` is `{value}`, which cannot be quoted safely at this place of the script")]
    CannotQuote {
        /// The parameter.
        name: String,
        /// The parameter's value, unquoted.
        value: String,
    },
    /// A cell that stands in a path and is no id.
    #[error(
        "column `{column}` of `{table}` makes a path, and line {line} has `{value}`: expected an id of letters, digits, `.`, `-` and `_`, without `..`"
    )]
    NotAnId {
        /// The heading of its column.
        column: String,
        /// The cell.
        value: String,
        /// The table, relative to the root.
        table: String,
        /// The line of the table's file, from 1.
        line: u64,
    },
    /// A stage without a command line.
    #[error("stage `{stage}` has an empty `cmd`")]
    EmptyCommand {
        /// Its name in the pipeline file.
        stage: String,
    },
    /// A stage that fans out twice.
    #[error("the stage has both `foreach` and `matrix`")]
    TwoFanOuts,
    /// A table for `foreach` that cannot be read.
    #[error("cannot read the table `{path}`: {message}")]
    Table {
        /// The table, relative to the root.
        path: String,
        /// What is wrong with it.
        message: String,
    },
    /// A `foreach` whose stages would all be the same.
    #[error("the stage uses no column of its table: {}", listing(columns))]
    NoColumnUsed {
        /// The columns that it could use.
        columns: Vec<String>,
    },
    /// A name that would mean two things.
    #[error("`{name}` is also a parameter")]
    AlsoParameter {
        /// The name of a column, of a list of the matrix, or of the shards' own.
        name: String,
    },
    /// Files to be dealt out that cannot be named so.
    #[error(
        "`{path}` cannot be dealt out: it is no directory, nor a directory and names with one `*`"
    )]
    BadOver {
        /// The path as written.
        path: String,
    },
    /// `{{files}}` beside other text.
    #[error("`{{files}}` must be a word of its own: it stands for several arguments")]
    FilesInsideWord,
    /// Words that are no command of the program whose own they are.
    #[error("{message}")]
    NoCommand {
        /// What the program says.
        message: String,
    },
    /// A list of files that is not that of the command.
    #[error("`{key}` is not what the command {}: {}", if *key == "inputs" { "reads" } else { "writes" }, apart(lacks, strange))]
    OtherFiles {
        /// `inputs` or `outputs`.
        key: &'static str,
        /// Paths that it lacks.
        lacks: Vec<String>,
        /// Paths that it has and the command does not.
        strange: Vec<String>,
    },
    /// A parameter with which a path begins and that has no text.
    #[error(
        "`{{{name}}}` is empty, so that a path that begins with it would lie in the root of the disk"
    )]
    EmptyStart {
        /// The parameter.
        name: String,
    },
    /// An input or output that would take in everything.
    #[error("`{path}` cannot be an input or output: it names no file or directory below the root")]
    BadPath {
        /// The path as written.
        path: String,
    },
}

impl FileProblem {
    pub(super) fn suggestion(&self) -> Option<String> {
        match self {
            Self::UnknownKey { nearest, known, .. } => did_you_mean(nearest.as_ref())
                .or_else(|| Some(format!("known keys: {}", known.join(", ")))),
            Self::UnknownParameter { nearest, name } => did_you_mean(nearest.as_ref())
                .or_else(|| Some(format!("for the braces themselves, write `{{{{{name}}}}}`"))),
            Self::Table { .. } => Some(
                "a fan-out needs its table before the run; if a stage makes it, put the stages \
                 before it into a pipeline of their own"
                    .to_owned(),
            ),
            Self::UnusedParameter { nearest, .. } => did_you_mean(nearest.as_ref()),
            Self::CannotQuote { name, .. } => Some(format!(
                "pass it to the script as an argument: [\"sh\", \"-c\", \"... \\\"$1\\\" ...\", \"sh\", \"{{{name}}}\"]"
            )),
            Self::OtherFiles { .. } => Some(
                "leave out `inputs` and `outputs` of this stage: they follow from its command"
                    .to_owned(),
            ),
            Self::TwoFanOuts => Some("write the combinations into the table".to_owned()),
            _ => None,
        }
    }
}

fn apart(lacks: &[String], strange: &[String]) -> String {
    let named = |what: &str, paths: &[String]| {
        (!paths.is_empty()).then(|| format!("{what} {}", listing(paths)))
    };
    let parts = [named("it lacks", lacks), named("it has", strange)];
    parts.into_iter().flatten().collect::<Vec<_>>().join(" and ")
}

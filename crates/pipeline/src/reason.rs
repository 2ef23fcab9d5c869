//! Why a stage runs, in sentences.

use std::fmt;

/// One reason why a stage is not up to date.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Reason {
    /// The caller insisted.
    Forced,
    /// The ledger knows no finished run.
    NeverRun,
    /// Its last run was begun and did not end well.
    Unfinished,
    /// A stage that makes one of its inputs runs first.
    Upstream {
        /// That stage.
        stage: String,
    },
    /// The command line changed, and not by a parameter.
    CommandChanged {
        /// The line of the last run.
        before: String,
        /// The line now.
        now: String,
    },
    /// A parameter of the stage has another value, is new or is no longer used.
    ParameterChanged {
        /// The parameter, as the pipeline file calls it.
        name: String,
        /// The value of the last run; `None` if it was not in use.
        before: Option<String>,
        /// The value now; `None` if it is no longer in use.
        now: Option<String>,
    },
    /// The program computes something else now.
    VersionChanged {
        /// Program and command.
        command: String,
        /// The version of the last run.
        before: Option<String>,
        /// The version now.
        now: Option<String>,
    },
    /// An input has another content.
    InputChanged {
        /// Relative to the root.
        path: String,
        /// Its content at the last run.
        before: String,
        /// Its content now.
        now: String,
    },
    /// An input is new.
    InputAdded {
        /// Relative to the root.
        path: String,
    },
    /// An input of the last run is gone.
    InputRemoved {
        /// Relative to the root.
        path: String,
    },
    /// Something in what it reads was made by a run, and the pipeline no longer makes it.
    InputNoLongerMade {
        /// Relative to the root.
        path: String,
    },
    /// An input is not there and no stage makes it: the stage cannot run.
    InputMissing {
        /// Relative to the root.
        path: String,
    },
    /// An output is not there.
    OutputMissing {
        /// Relative to the root.
        path: String,
    },
    /// An output is not what the stage had made.
    OutputEdited {
        /// Relative to the root.
        path: String,
    },
    /// A file in an output was made by no run.
    Foreign {
        /// Relative to the root.
        path: String,
    },
    /// The last run did not have this output.
    OutputAdded {
        /// Relative to the root.
        path: String,
    },
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Forced => write!(f, "it was asked for by force"),
            Self::NeverRun => write!(f, "there is no record of a finished run"),
            Self::Unfinished => write!(f, "its last run did not finish"),
            Self::Upstream { stage } => write!(f, "stage `{stage}` runs before it"),
            Self::CommandChanged { before, now } => {
                write!(f, "the command changed from `{before}` to `{now}`")
            }
            Self::ParameterChanged { name, before, now } => match (before, now) {
                (Some(before), Some(now)) => {
                    write!(f, "parameter `{name}` changed from {before} to {now}")
                }
                (None, Some(now)) => write!(f, "parameter `{name}` ({now}) is new in the stage"),
                (_, None) => write!(f, "parameter `{name}` is no longer in the stage"),
            },
            Self::VersionChanged { command, before, now } => {
                let version = |v: &Option<String>| v.clone().unwrap_or_else(|| "none".to_owned());
                let (before, now) = (version(before), version(now));
                write!(f, "`{command}` changed from version {before} to {now}")
            }
            Self::InputChanged { path, before, now } => match (files(before), files(now)) {
                (Some(before), Some(now)) if before != now => {
                    write!(f, "input `{path}` changed: it had {before}, it has {now}")
                }
                _ => write!(f, "input `{path}` changed"),
            },
            Self::InputAdded { path } => write!(f, "input `{path}` is new"),
            Self::InputRemoved { path } => write!(f, "input `{path}` is no longer there"),
            Self::InputNoLongerMade { path } => {
                write!(f, "`{path}`, which it read, is no longer made by any stage")
            }
            Self::InputMissing { path } => {
                write!(f, "input `{path}` does not exist and no stage makes it")
            }
            Self::OutputMissing { path } => write!(f, "output `{path}` is not there"),
            Self::OutputEdited { path } => {
                write!(f, "output `{path}` is not as the stage had left it")
            }
            Self::Foreign { path } => write!(f, "`{path}` was made by no run"),
            Self::OutputAdded { path } => write!(f, "output `{path}` is new"),
        }
    }
}

/// The number of files in a directory's content.
fn files(content: &str) -> Option<&str> {
    content.split_once(" in ").map(|(_, files)| files)
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn every_reason_is_a_sentence_with_what_it_is_about() {
        let text = |t: &str| t.to_owned();
        let some = |t: &str| Some(t.to_owned());
        let path = || "data/in".to_owned();
        let parameter =
            |before, now| Reason::ParameterChanged { name: "seed".to_owned(), before, now };
        let input = |before: &str, now: &str| Reason::InputChanged {
            path: "data/in".to_owned(),
            before: before.to_owned(),
            now: now.to_owned(),
        };
        for (reason, sentence) in [
            (Reason::Forced, "it was asked for by force"),
            (Reason::NeverRun, "there is no record of a finished run"),
            (Reason::Unfinished, "its last run did not finish"),
            (Reason::Upstream { stage: text("draw") }, "stage `draw` runs before it"),
            (
                Reason::CommandChanged { before: text("a 1"), now: text("a 2") },
                "the command changed from `a 1` to `a 2`",
            ),
            (parameter(some("1"), some("2")), "parameter `seed` changed from 1 to 2"),
            (parameter(None, some("2")), "parameter `seed` (2) is new in the stage"),
            (parameter(some("1"), None), "parameter `seed` is no longer in the stage"),
            (
                Reason::VersionChanged { command: text("x y"), before: None, now: some("2") },
                "`x y` changed from version none to 2",
            ),
            (input("aa", "bb"), "input `data/in` changed"),
            (input("aa in 1 file", "bb in 1 file"), "input `data/in` changed"),
            (
                input("aa in 1 file", "bb in 2 files"),
                "input `data/in` changed: it had 1 file, it has 2 files",
            ),
            (Reason::InputAdded { path: path() }, "input `data/in` is new"),
            (Reason::InputRemoved { path: path() }, "input `data/in` is no longer there"),
            (
                Reason::InputNoLongerMade { path: path() },
                "`data/in`, which it read, is no longer made by any stage",
            ),
            (
                Reason::InputMissing { path: path() },
                "input `data/in` does not exist and no stage makes it",
            ),
            (Reason::OutputMissing { path: path() }, "output `data/in` is not there"),
            (
                Reason::OutputEdited { path: path() },
                "output `data/in` is not as the stage had left it",
            ),
            (Reason::Foreign { path: path() }, "`data/in` was made by no run"),
            (Reason::OutputAdded { path: path() }, "output `data/in` is new"),
        ] {
            assert_eq!(reason.to_string(), sentence);
        }
    }
}

//! The commit in which a file stands as it is, so that nobody can change it unseen.

use crate::error::StudyError;
use path_slash::PathExt as _;
use std::{
    io::ErrorKind,
    path::Path,
    process::{Command, Output},
};

/// What stands for a commit where there is no git to ask.
pub(super) const UNKNOWN: &str = "unknown";

/// Where a file stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Stands {
    /// As it is in this commit.
    In(String),
    /// Nobody can say: there is no git on this machine.
    NoGit,
    /// In no commit as it is, and why.
    Nowhere(String),
}

impl Stands {
    /// Asks git about a file; `git` is the program's name.
    pub(super) fn ask_git(file: &Path, git: &str) -> Self {
        let folder = file.parent().filter(|f| !f.as_os_str().is_empty());
        let name = file.file_name().unwrap_or_default();
        let ask = |words: &[&str]| -> std::io::Result<Output> {
            let mut command = Command::new(git);
            command.arg("-C").arg(folder.unwrap_or(Path::new(".")));
            command.args(words).arg("--").arg(name).output()
        };
        let stdout = |output: std::io::Result<Output>| match output {
            Err(error) if error.kind() == ErrorKind::NotFound => Err(Self::NoGit),
            Err(error) => Err(Self::Nowhere(format!("git cannot be asked: {error}"))),
            Ok(output) if output.status.success() => {
                Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
            }
            Ok(output) => {
                let why = String::from_utf8_lossy(&output.stderr);
                let why = why.lines().next().unwrap_or("git does not say why");
                Err(Self::Nowhere(format!("git knows no commit of it: {why}")))
            }
        };
        let log = stdout(ask(&["log", "-1", "--abbrev=12", "--format=%h"]));
        let changed = || stdout(ask(&["status", "--porcelain"]));
        match log.and_then(|commit| Ok((commit, changed()?))) {
            Err(other) => other,
            Ok((commit, _)) if commit.is_empty() => {
                Self::Nowhere("it was never committed".to_owned())
            }
            Ok((commit, changed)) if changed.is_empty() => Self::In(commit),
            Ok((commit, _)) => Self::Nowhere(format!("it was changed since commit {commit}")),
        }
    }

    /// The commit of `file`, where the test part may be opened under it.
    ///
    /// # Errors
    /// [`StudyError::BadFile`] for a file that stands in no commit as it is.
    pub(super) fn checked(self, file: &Path) -> Result<Self, StudyError> {
        match self {
            Self::Nowhere(why) => {
                let path = file.to_slash_lossy();
                let problem = format!(
                    "{why}, expected rules that are committed before the test part is opened"
                );
                let help = format!(
                    "commit them as they are, `git add {path}` and `git commit`, and run it again"
                );
                Err(StudyError::file(file, problem).with_help(help))
            }
            stands => Ok(stands),
        }
    }

    /// As a list of looks has it.
    pub(super) fn text(&self) -> String {
        match self {
            Self::In(commit) => commit.clone(),
            Self::NoGit | Self::Nowhere(_) => UNKNOWN.to_owned(),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A repository in `folder` with all of its files committed; false where there is no git.
    pub(in super::super) fn commit(folder: &Path) -> bool {
        let git = |words: &[&str]| {
            let mut command = Command::new("git");
            command.arg("-C").arg(folder);
            command.args(["-c", "user.name=A", "-c", "user.email=a@example.org"]);
            command.args(["-c", "commit.gpgsign=false"]);
            command.args(words).output()
        };
        if git(&["init", "-q"]).is_err() {
            return false;
        }
        for words in [&["add", "-A"][..], &["commit", "-q", "-m", "x"]] {
            let output = git(words).unwrap();
            assert!(output.status.success(), "{output:?}");
        }
        true
    }

    #[test]
    fn rules_stand_in_a_commit_only_as_they_were_committed() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("rules.toml");
        std::fs::write(&file, "title = \"x\"\n").unwrap();
        let stands = || Stands::ask_git(&file, "git");
        if stands() == Stands::NoGit {
            return;
        }
        let refused = |wanted: &str| {
            let error = stands().checked(&file).unwrap_err();
            assert!(error.to_string().contains(wanted), "{error}");
            assert!(error.suggestion().unwrap().contains("git commit"));
            assert_eq!(stands().text(), UNKNOWN);
        };
        refused("git knows no commit of it");
        assert!(commit(folder.path()));
        let Stands::In(first) = stands().checked(&file).unwrap() else {
            panic!("{:?}", stands());
        };
        assert_eq!(first.len(), 12);
        std::fs::write(&file, "title = \"y\"\n").unwrap();
        refused(&format!("it was changed since commit {first}"));
        let other = folder.path().join("other.toml");
        std::fs::write(&other, "").unwrap();
        let other = Stands::ask_git(&other, "git");
        assert_eq!(other, Stands::Nowhere("it was never committed".to_owned()));
    }

    #[test]
    fn without_git_the_commit_is_unknown_and_nothing_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("rules.toml");
        let stands = Stands::ask_git(&file, "a-git-that-is-not-there");
        assert_eq!(stands, Stands::NoGit);
        assert_eq!(stands.checked(&file).unwrap().text(), UNKNOWN);
    }
}

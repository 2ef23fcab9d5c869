//! What has to be there before a run: files and folders that a design names under `[files]` (by their usual names they may be yet to come), and people.

use crate::{design::DesignFile, error::StudyError, gate::nobody_listed};
use maveric_domain::design::{Files, Mappings};
use path_slash::PathExt as _;
use std::path::Path;

const LOGS: &str = "mend the path, which starts at the folder of the design; where logs are yet to come, make the folder";
const MAPPING: &str = "mend the path, which starts at the folder of the design, or write the file: `maveric inspect --suggest-mapping` proposes one";
const ANSWERS: &str = "mend the path, which starts at the folder of the design, or take away what was made of other answers: `maveric clean`";

/// Refuses logs and mappings that a design names and that are not there, and answers that are not while there are `results` of others: nothing
/// that was made of something else then counts as theirs.
///
/// # Errors
/// [`StudyError`] naming the design's file, the key, the path and what to do.
pub fn check_named_files(study: &DesignFile, results: &Path) -> Result<(), StudyError> {
    let (files, usual) = (study.design.files(), Files::default());
    let mut named = vec![("files.logs".to_owned(), &files.logs, LOGS)];
    match &files.mapping {
        Mappings::One(file) => named.push(("files.mapping".to_owned(), file, MAPPING)),
        Mappings::Rigs(rigs) => {
            for (rig, number) in rigs.iter().zip(1..) {
                let key = format!("files.mapping[{number}]");
                named.push((format!("{key}.logs"), &rig.logs, LOGS));
                let file = rig.file.as_ref();
                named.extend(file.map(|file| (format!("{key}.file"), file, MAPPING)));
            }
        }
    }
    if results.join("scores.csv").is_file() {
        named.push(("files.answers".to_owned(), &files.answers, ANSWERS));
    }
    let is_usual = |path: &Path| {
        let mapping = matches!(&usual.mapping, Mappings::One(file) if file == path);
        mapping || path == usual.logs || path == usual.answers
    };
    let absent = |path: &Path| !is_usual(path) && !study.resolve(path).exists();
    match named.into_iter().find(|(_, path, _)| absent(path)) {
        None => Ok(()),
        Some((key, path, help)) => Err(study.wrong(
            format!("`{key}` names {}, which is not there", path.to_slash_lossy()),
            Some(help.to_owned()),
        )),
    }
}

/// Refuses a table of people without a row, which lets nobody in.
///
/// # Errors
/// [`StudyError`] naming the table and what to do; for a table that cannot be read.
pub fn check_people(study: &DesignFile) -> Result<(), StudyError> {
    let table = study.people_file(None);
    if table.is_file() && study.people(None)?.enrolled.is_empty() {
        return Err(nobody_listed(&table));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of a study with these files under `[files]`, of which these are there.
    fn said(files: &str, there: &[&str]) -> String {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        for name in there {
            std::fs::create_dir_all(file(name).parent().unwrap()).unwrap();
            std::fs::write(file(name), "").unwrap();
        }
        let text =
            format!("[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[files]\n{files}\n");
        std::fs::write(file("study.toml"), text).unwrap();
        let study = DesignFile::read(&file("study.toml")).unwrap();
        let checked = check_named_files(&study, &file("results"));
        checked.map_or_else(|error| error.to_string(), |()| String::new())
    }

    #[test]
    fn what_is_named_and_not_there_is_refused_by_its_key_and_path() {
        for (files, words) in [
            ("logs = \"logz\"", "`files.logs` names logz, which is not there"),
            ("mapping = \"map.toml\"", "`files.mapping` names map.toml,"),
            (
                "mapping = [{ logs = \"logs\" }, { logs = \"rig2\", file = \"rig2.toml\" }]",
                "`files.mapping[2].logs` names rig2,",
            ),
            (
                "mapping = [{ logs = \"logs\", file = \"rig1.toml\" }]",
                "`files.mapping[1].file` names rig1.toml,",
            ),
        ] {
            let error = said(files, &[]);
            assert!(error.contains(words), "{error}");
        }
        assert_eq!(said("logs = \"raw\"\nmapping = \"map.toml\"", &["raw/a.csv", "map.toml"]), "");
    }

    #[test]
    fn what_has_its_usual_name_may_be_yet_to_come() {
        assert_eq!(said("logs = \"logs\"\nmapping = \"mapping.toml\"", &[]), "");
        assert_eq!(said("", &["results/scores.csv"]), "");
    }

    #[test]
    fn answers_may_be_yet_to_come_until_there_are_scores_of_others() {
        let answers = "answers = \"surveys/may.csv\"";
        assert_eq!(said(answers, &[]), "");
        let error = said(answers, &["results/scores.csv"]);
        assert!(error.contains("`files.answers` names surveys/may.csv,"), "{error}");
        assert_eq!(said(answers, &["results/scores.csv", "surveys/may.csv"]), "");
    }
}

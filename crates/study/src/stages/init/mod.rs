//! `init`: the folder of a study of one's own.

use crate::{
    atomic_write::atomic_write_bytes,
    error::StudyError,
    outcome::{Outcome, Watch},
};
use serde::Serialize;
use std::path::PathBuf;

/// Folders that start empty.
const FOLDERS: [&str; 3] = ["logs/study1", "logs/study2", "surveys"];

/// The header that the table of people starts with.
const PARTICIPANTS: &str = "participant,study,population,age,gender,professional,order\n";

/// A file of this project, below a new study's folder.
macro_rules! shipped {
    ($name:literal, $path:literal) => {
        (
            $name,
            include_str!(concat!("../../../../../study_data/", $path)),
        )
    };
    ($path:literal) => {
        shipped!($path, $path)
    };
}

/// Name and text of every file.
const FILES: [(&str, &str); 16] = [
    ("README.md", include_str!("README.md")),
    ("pipelines/study.toml", include_str!("study.toml")),
    ("mappings/study1.toml", include_str!("mapping_study1.toml")),
    ("mappings/study2.toml", include_str!("mapping_study2.toml")),
    ("surveys/columns.toml", include_str!("columns.toml")),
    ("participants.csv", PARTICIPANTS),
    shipped!("scenario.toml", "scenarios/paper.toml"),
    shipped!("claims.toml"),
    shipped!("scales/adb.toml"),
    shipped!("scales/mdsi.toml"),
    shipped!("scales/mini_ipip.toml"),
    shipped!("scales/jian_trust.toml"),
    shipped!("scales/rosas.toml"),
    shipped!("scales/godspeed_intelligence.toml"),
    shipped!("scales/similarity.toml"),
    shipped!("scales/aggressiveness.toml"),
];

/// What to make.
#[derive(Debug, Clone)]
pub struct InitOptions {
    /// The study's folder; not there yet, or empty.
    pub folder: PathBuf,
}

/// What was made.
#[derive(Debug, Clone, Serialize)]
pub struct Initialised {
    /// Files written, below the folder.
    pub files: Vec<String>,
}

/// Makes the folder of a study: a pipeline from raw logs and answers to the report, the scales, mappings to fill in, and a README that says
/// what goes where.
///
/// # Errors
/// [`StudyError::BadFile`] for a folder with something in it: nothing is overwritten; [`StudyError::Io`].
pub fn init(options: &InitOptions, watch: Watch<'_>) -> Result<Outcome<Initialised>, StudyError> {
    let folder = &options.folder;
    if folder.exists() {
        let mut entries = std::fs::read_dir(folder).map_err(StudyError::read(folder))?;
        if entries.next().is_some() {
            return Err(StudyError::BadFile {
                path: folder.clone(),
                problem: "is not empty, expected a new or an empty folder".to_owned(),
                help: Some("choose another name; nothing is overwritten".to_owned()),
            });
        }
    }
    for name in FOLDERS {
        let path = folder.join(name);
        std::fs::create_dir_all(&path).map_err(StudyError::write(&path))?;
    }
    for (name, text) in FILES {
        watch.check()?;
        atomic_write_bytes(&folder.join(name), text.as_bytes())?;
    }
    let pipeline = folder.join("pipelines/study.toml");
    let summary = vec![
        format!("a study's folder: {}", folder.display()),
        format!(
            "read {}, fill it in, then: maveric run {}",
            folder.join("README.md").display(),
            pipeline.display()
        ),
    ];
    Ok(Outcome {
        value: Initialised {
            files: FILES.iter().map(|(name, _)| (*name).to_owned()).collect(),
        },
        summary,
        warnings: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{collections::BTreeSet, path::Path};

    #[test]
    fn every_shipped_scale_is_there() {
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/scales");
        let names = std::fs::read_dir(shipped)
            .unwrap()
            .map(|e| format!("scales/{}", e.unwrap().file_name().to_string_lossy()));
        let written: BTreeSet<String> = FILES
            .iter()
            .filter(|(n, _)| n.starts_with("scales/"))
            .map(|(n, _)| (*n).to_owned())
            .collect();
        assert_eq!(names.collect::<BTreeSet<String>>(), written);
    }
}

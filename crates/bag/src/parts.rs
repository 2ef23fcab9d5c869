//! Recordings that were split over several files: a folder as rosbag2 writes it.

use crate::error::BagError;
use std::path::{Path, PathBuf};

/// What rosbag2 writes beside its files once it closes a recording.
const METADATA: &str = "metadata.yaml";
/// Number of parts at which a number in a name is no count of parts.
const MOST_PARTS: u64 = 10_000;

/// The files of a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parts {
    /// In their order.
    pub files: Vec<PathBuf>,
    /// Names of those that are not there.
    pub missing: Vec<String>,
}

/// Whether a folder is one recording: it says so, or its files carry its name and numbers from 0 on, as when the
/// recording was killed before it could.
pub fn is_split(path: &Path) -> bool {
    if !path.is_dir() {
        return false;
    }
    let files = numbered(path);
    if path.join(METADATA).is_file() {
        return !files.is_empty();
    }
    let folder = name_of(path);
    let named = |(number, file): &(Option<u64>, PathBuf)| {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        number.is_some_and(|number| stem == format!("{folder}_{number}"))
    };
    files.first().is_some_and(|f| f.0 == Some(0)) && files.iter().all(named)
}

/// The files of a recording, in the order of their numbers; itself if it is a file.
///
/// # Errors
/// [`BagError::Io`] where the folder cannot be read.
pub fn parts_of(path: &Path) -> Result<Parts, BagError> {
    if !path.is_dir() {
        return Ok(Parts { files: vec![path.to_owned()], missing: Vec::new() });
    }
    let metadata = path.join(METADATA);
    let listed = match std::fs::read_to_string(&metadata) {
        Ok(text) => listed(&text),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(e) => return Err(BagError::io(&metadata, e)),
    };
    let there = numbered(path);
    if listed.is_empty() {
        let folder = name_of(path);
        // A name tells of at most so many parts that are not there: a number may be a date.
        let last = there.iter().filter_map(|f| f.0).max().unwrap_or(0);
        let absent = (0..last.min(MOST_PARTS)).filter(|n| !there.iter().any(|f| f.0 == Some(*n)));
        return Ok(Parts {
            missing: if is_split(path) && !metadata.is_file() {
                absent.map(|n| format!("{folder}_{n}.mcap")).collect()
            } else {
                Vec::new()
            },
            files: there.into_iter().map(|f| f.1).collect(),
        });
    }
    let (files, missing) =
        listed.into_iter().partition::<Vec<String>, _>(|name| path.join(name).is_file());
    Ok(Parts { files: files.into_iter().map(|name| path.join(name)).collect(), missing })
}

fn name_of(folder: &Path) -> String {
    // `.` and `..` have a name as well.
    let folder = std::fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The names below `relative_file_paths:` of a rosbag2 metadata file, without their folders.
fn listed(text: &str) -> Vec<String> {
    let mut lines = text.lines().map(str::trim);
    if !lines.any(|line| line == "relative_file_paths:") {
        return Vec::new();
    }
    let name = |line: &str| {
        let path = line.strip_prefix('-')?.trim().trim_matches(['"', '\'']);
        let name = path.rsplit(['/', '\\']).next()?;
        let mcap = Path::new(name).extension()? == "mcap";
        mcap.then(|| name.to_owned())
    };
    lines.map_while(name).collect()
}

/// The `.mcap` files of a folder with the numbers at the end of their names, in that order.
fn numbered(folder: &Path) -> Vec<(Option<u64>, PathBuf)> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let files = entries.filter_map(|e| e.ok().map(|e| e.path()));
    let mut files: Vec<(Option<u64>, PathBuf)> = files
        .filter(|f| f.extension().is_some_and(|e| e == "mcap"))
        .map(|f| {
            let stem = f.file_stem().unwrap_or_default().to_string_lossy();
            let number = stem.rsplit_once('_').and_then(|(_, n)| n.parse().ok());
            (number, f)
        })
        .collect();
    files.sort();
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_read_without_folders_and_ends_where_it_ends() {
        let text = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - run/run_0.mcap\n    - \"run_1.mcap\"\n  duration:\n    - x.mcap\n";
        assert_eq!(listed(text), ["run_0.mcap", "run_1.mcap"]);
        assert!(listed("version: 5").is_empty());
    }

    #[test]
    fn a_folder_is_one_recording_if_it_says_so_or_its_files_carry_its_name() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("run");
        std::fs::create_dir(&folder).unwrap();
        let touch = |name: &str| std::fs::write(folder.join(name), "").unwrap();
        assert!(!is_split(&folder));
        (0..12).for_each(|i| touch(&format!("run_{i}.mcap")));
        assert!(is_split(&folder));
        let parts = parts_of(&folder).unwrap();
        assert_eq!(parts.files[10], folder.join("run_10.mcap"));
        assert!(parts.missing.is_empty());
        std::fs::remove_file(folder.join("run_3.mcap")).unwrap();
        assert!(is_split(&folder));
        assert_eq!(parts_of(&folder).unwrap().missing, ["run_3.mcap"]);
        touch("other.mcap");
        assert!(!is_split(&folder));
        std::fs::write(folder.join(METADATA), "relative_file_paths:\n- run_1.mcap\n- gone.mcap\n")
            .unwrap();
        assert!(is_split(&folder));
        let parts = parts_of(&folder).unwrap();
        assert_eq!(parts.files, [folder.join("run_1.mcap")]);
        assert_eq!(parts.missing, ["gone.mcap"]);
    }

    #[test]
    fn a_number_in_a_name_that_may_be_a_date_names_only_so_many_missing_parts() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("run");
        std::fs::create_dir(&folder).unwrap();
        let touch = |name: &str| std::fs::write(folder.join(name), "").unwrap();
        touch("run_0.mcap");
        touch("run_20240131.mcap");
        touch("notes_3.txt");
        assert!(is_split(&folder));
        let parts = parts_of(&folder).unwrap();
        assert_eq!(parts.files, [folder.join("run_0.mcap"), folder.join("run_20240131.mcap")]);
        assert_eq!(parts.missing.len() as u64, MOST_PARTS - 1);
        assert_eq!(parts.missing[0], "run_1.mcap");
        // Without the first it is no recording that was split, only a folder.
        std::fs::remove_file(folder.join("run_0.mcap")).unwrap();
        assert!(!is_split(&folder));
        let parts = parts_of(&folder).unwrap();
        assert_eq!((parts.files.len(), parts.missing.len()), (1, 0));
        // Its list says what belongs to it; an empty one nothing.
        std::fs::write(folder.join(METADATA), "version: 5\n").unwrap();
        assert!(is_split(&folder));
        let parts = parts_of(&folder).unwrap();
        assert_eq!((parts.files.len(), parts.missing.len()), (1, 0));
        std::fs::remove_file(folder.join("run_20240131.mcap")).unwrap();
        assert!(!is_split(&folder));
        // A file is itself.
        let file = folder.join("notes_3.txt");
        assert!(!is_split(&file));
        let parts = parts_of(&file).unwrap();
        assert_eq!((parts.files, parts.missing), (vec![file], Vec::new()));
    }
}

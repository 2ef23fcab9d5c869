//! Recordings that were split over several files: a folder as rosbag2 writes it.

use crate::error::IngestError;
use std::path::{Path, PathBuf};

/// What rosbag2 writes beside its files once it closes a recording.
const METADATA: &str = "metadata.yaml";

/// Whether a folder is one recording: it says so, or its files carry its name and numbers from 0 on, as when the
/// recording was killed before it could.
pub(crate) fn is_split(path: &Path) -> bool {
    if !path.is_dir() {
        return false;
    }
    let files = numbered(path);
    if path.join(METADATA).is_file() {
        return files
            .iter()
            .any(|f| f.1.extension().is_some_and(|e| e == "mcap"));
    }
    let folder = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let named = |(i, (number, file)): (usize, &(Option<u64>, PathBuf))| {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        *number == Some(i as u64) && stem == format!("{folder}_{i}")
    };
    !files.is_empty() && files.iter().enumerate().all(named)
}

/// The files of a recording, in the order of their numbers; itself if it is a file.
///
/// # Errors
/// [`IngestError::NotFound`] for a file that the recording names and the folder lacks.
pub(crate) fn parts_of(path: &Path) -> Result<Vec<PathBuf>, IngestError> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let metadata = path.join(METADATA);
    let listed = match std::fs::read_to_string(&metadata) {
        Ok(text) => listed(&text),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(e) => return Err(IngestError::io(&metadata, e)),
    };
    if listed.is_empty() {
        return Ok(numbered(path).into_iter().map(|f| f.1).collect());
    }
    let files = listed.iter().map(|name| path.join(name));
    files
        .map(|file| {
            if file.is_file() {
                Ok(file)
            } else {
                Err(IngestError::NotFound { path: file })
            }
        })
        .collect()
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
        assert_eq!(parts[10], folder.join("run_10.mcap"));
        touch("other.mcap");
        assert!(!is_split(&folder));
        std::fs::write(
            folder.join(METADATA),
            "relative_file_paths:\n- run_1.mcap\n- gone.mcap\n",
        )
        .unwrap();
        assert!(is_split(&folder));
        assert!(matches!(
            parts_of(&folder),
            Err(IngestError::NotFound { .. })
        ));
    }
}

//! What stands in the places of a stage's outputs: made by runs, or by nobody that we know.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::content::Hasher;
use crate::ledger::{Ledger, Left, Made};
use crate::paths::with_ancestors;
use crate::{Graph, PipelineError, Stage};

/// How folders begin that hold what was moved out of a stage's way.
pub const ASIDE: &str = "moved-aside-";

/// A file below an output; the output itself for the empty name.
fn join(output: &str, within: &str) -> String {
    if within.is_empty() { output.to_owned() } else { format!("{output}/{within}") }
}

/// The files that are about to be replaced and that no run is known to have made.
#[derive(Debug, Default)]
pub(crate) struct Unknown {
    /// No run made them.
    pub(crate) foreign: Vec<String>,
    /// They lie in directories of a run that was cut off: it made them, or somebody put them there.
    pub(crate) unsure: Vec<String>,
}

/// Of a file, whether a run made it; the greatest of what several runs say counts.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Origin {
    Foreign,
    Unsure,
    Made,
}

/// The files where `stage` has or had its outputs that none of the runs `keys` is known to have made.
pub(crate) fn unknown(
    stage: &Stage,
    keys: &[String],
    ledger: &Ledger,
    hasher: &Hasher<'_>,
) -> Result<Unknown, PipelineError> {
    // Of each output what is a run's.
    let outputs = keys.iter().flat_map(|key| ledger.made_by(key));
    let outputs: Vec<(&str, Made<'_>)> = outputs.collect();
    let origin = |path: &str| {
        let by_one = |(output, what): &(&str, Made<'_>)| {
            let within = path.strip_prefix(output)?;
            let is_below = within.is_empty() || within.starts_with('/');
            let within = within.trim_start_matches('/');
            is_below.then(|| match what {
                Made::Open(_) if within.is_empty() => Origin::Made,
                Made::Files(files) | Made::Open(files)
                    if files.binary_search_by(|f| (**f).cmp(within)).is_ok() =>
                {
                    Origin::Made
                }
                Made::Open(_) => Origin::Unsure,
                Made::Files(_) => Origin::Foreign,
            })
        };
        let origins = outputs.iter().filter_map(by_one);
        origins.max().unwrap_or(Origin::Foreign)
    };
    // What an earlier run of the stage was about to make elsewhere goes, too.
    let earlier = keys.iter().filter(|key| ledger.stage_of(key) == Some(stage.name.as_str()));
    let open = earlier.filter_map(|key| ledger.left.get(key));
    let open = open.flat_map(|left| &left.open);
    let mut unknown = Unknown::default();
    let mut unsure = BTreeSet::new();
    for output in stage.outputs.iter().chain(open) {
        for within in hasher.names(output)?.unwrap_or_default() {
            let path = join(output, &within);
            match origin(&path) {
                Origin::Foreign => unknown.foreign.push(path),
                Origin::Unsure => {
                    unsure.insert(path);
                }
                Origin::Made => {}
            }
        }
    }
    unknown.unsure = unsure.into_iter().collect();
    Ok(unknown)
}

/// Moves files beside the outputs in which they stand, into a folder with today's date that
/// no stage reads; the folder of each, relative to the root.
pub(crate) fn move_aside(
    paths: &[String],
    graph: &Graph<'_>,
    root: &Path,
) -> Result<Vec<String>, PipelineError> {
    let today = today();
    let mut folders: Vec<String> = Vec::new();
    for path in paths {
        let above = with_ancestors(path).skip(1);
        let free = above.into_iter().find(|above| graph.is_free(above));
        let (base, rest) = match free {
            Some(base) => (format!("{base}/"), &path[base.len() + 1..]),
            None if path.starts_with('/') => ("/".to_owned(), &path[1..]),
            None => (String::new(), path.as_str()),
        };
        let numbers = std::iter::once(String::new()).chain((2..).map(|n: u32| format!("-{n}")));
        let mut folders_of_today = numbers.map(|n| format!("{base}{ASIDE}{today}{n}"));
        let is_taken = |folder: &String| root.join(folder).join(rest).symlink_metadata().is_ok();
        let folder = folders_of_today.find(|folder| !is_taken(folder));
        let folder = folder.unwrap_or_default();
        let (from, to) = (root.join(path), root.join(&folder).join(rest));
        if let Some(folder) = to.parent() {
            fs::create_dir_all(folder).map_err(PipelineError::io("create", folder))?;
        }
        move_to(&from, &to).map_err(PipelineError::io("move aside", &from))?;
        if !folders.contains(&folder) {
            folders.push(folder);
        }
    }
    Ok(folders)
}

/// Moves a file or a link, also onto another disk: an output folder may be a link to one.
fn move_to(from: &Path, to: &Path) -> io::Result<()> {
    match fs::rename(from, to) {
        Err(error) if error.kind() == io::ErrorKind::CrossesDevices => {
            copy(from, to)?;
            fs::remove_file(from)
        }
        renamed => renamed,
    }
}

/// Copies a file; a link as a link.
fn copy(from: &Path, to: &Path) -> io::Result<()> {
    #[cfg(unix)]
    if from.is_symlink() {
        return std::os::unix::fs::symlink(fs::read_link(from)?, to);
    }
    fs::copy(from, to).map(drop)
}

/// Removes what stands in a stage's outputs, all of which is its own, and what else it had
/// made before; nothing of anybody else.
pub(crate) fn clear(stage: &Stage, past: &Left, root: &Path) -> Result<(), PipelineError> {
    let failed = |path: &Path| PipelineError::io("remove the old", path.to_owned());
    for output in stage.outputs.iter().chain(&past.open) {
        let full = root.join(output);
        // A link to a directory elsewhere is a person's choice and stays.
        let is_link = full.symlink_metadata().is_ok_and(|m| m.is_symlink());
        if is_link && full.is_dir() {
            let entries = fs::read_dir(&full).map_err(failed(&full))?;
            for entry in entries {
                let path = entry.map_err(failed(&full))?.path();
                remove(&path).map_err(failed(&path))?;
            }
        } else {
            remove(&full).map_err(failed(&full))?;
        }
    }
    for (output, files) in &past.files {
        remove_files(output, files, root)?;
    }
    for output in &stage.outputs {
        if let Some(folder) = root.join(output).parent() {
            fs::create_dir_all(folder).map_err(PipelineError::io("create", folder))?;
        }
    }
    Ok(())
}

/// Removes files of an output and the directories, up to the output itself, that are empty
/// then; whether the output is gone.
pub(crate) fn remove_files(
    output: &str,
    files: &[String],
    root: &Path,
) -> Result<bool, PipelineError> {
    for within in files {
        let path = join(output, within);
        let full = root.join(&path);
        if full.symlink_metadata().is_ok_and(|m| !m.is_dir()) {
            fs::remove_file(&full).map_err(PipelineError::io("remove the old", &full))?;
        }
        for folder in with_ancestors(&path).skip(1) {
            // One that is not empty stays, and so do those above it.
            if folder.len() < output.len() || fs::remove_dir(root.join(folder)).is_err() {
                break;
            }
        }
    }
    let full = root.join(output);
    let _ = fs::remove_dir(&full); // one that was made empty
    Ok(full.symlink_metadata().is_err())
}

/// Removes a file, a link or a whole directory; nothing there is fine.
pub(crate) fn remove(path: &Path) -> io::Result<()> {
    let result = match fs::symlink_metadata(path) {
        Ok(metadata) if metadata.is_dir() => fs::remove_dir_all(path),
        Ok(_) => fs::remove_file(path),
        Err(error) => Err(error),
    };
    match result {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

/// The date in Greenwich, as `2026-11-22`.
fn today() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let days = since.map_or(0, |since| since.as_secs() / 86_400);
    date(i64::try_from(days).unwrap_or(0))
}

/// The date so many days after 1 January 1970.
///
/// # Source
/// H. Hinnant, "chrono-compatible low-level date algorithms", `civil_from_days`.
fn date(days: i64) -> String {
    let shifted = days + 719_468;
    let era = shifted.div_euclid(146_097);
    let day_of_era = shifted.rem_euclid(146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = (month_from_march + 2) % 12 + 1;
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

/// Where the folders for what is moved aside may stand.
impl Graph<'_> {
    /// Whether no stage reads or makes `path` or anything above it.
    fn is_free(&self, path: &str) -> bool {
        let stages = self.pipeline().stages();
        let mut paths =
            stages.iter().flat_map(|s| s.reads().chain(s.outputs.iter().map(String::as_str)));
        !paths.any(|used| with_ancestors(path).any(|above| above == used))
    }
}

/// A path as it is told of, relative to the root.
pub(crate) fn shortened(paths: &[String]) -> String {
    let shown: Vec<&str> = paths.iter().take(3).map(String::as_str).collect();
    match paths.len() - shown.len() {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_have_their_dates() {
        for (days, expected) in
            [(0, "1970-01-01"), (59, "1970-03-01"), (11_016, "2000-02-29"), (20_779, "2026-11-22")]
        {
            assert_eq!(date(days), expected);
        }
    }

    /// `/dev/shm` is another disk than that of temporary files, where there is one.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_file_and_a_link_are_moved_onto_another_disk_too() {
        let to = tempfile::tempdir().unwrap();
        let from = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir());
        let from = from.unwrap();
        fs::write(from.path().join("file"), "mine").unwrap();
        std::os::unix::fs::symlink("nowhere", from.path().join("link")).unwrap();
        for name in ["file", "link"] {
            move_to(&from.path().join(name), &to.path().join(name)).unwrap();
        }
        assert_eq!(fs::read_dir(from.path()).unwrap().count(), 0);
        let file = fs::read_to_string(to.path().join("file")).unwrap();
        assert_eq!(file, "mine");
        let link = fs::read_link(to.path().join("link")).unwrap();
        assert_eq!(link, Path::new("nowhere"));
        copy(&to.path().join("file"), &to.path().join("again")).unwrap();
        copy(&to.path().join("link"), &from.path().join("link")).unwrap();
        assert!(to.path().join("again").is_file() && from.path().join("link").is_symlink());
        assert!(move_to(&from.path().join("gone"), &to.path().join("gone")).is_err());
    }

    #[test]
    fn only_the_files_named_go_and_the_directories_that_they_leave_empty() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().to_owned();
        for file in ["out/a/1", "out/a/b/2", "out/c/3", "out/c/mine", "beside"] {
            let path = root.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        let files = ["a/1", "a/b/2", "c/3", "gone"].map(str::to_owned);
        assert!(!remove_files("out", &files, &root).unwrap());
        assert!(!root.join("out/a").exists() && root.join("out/c/mine").exists());
        fs::remove_file(root.join("out/c/mine")).unwrap();
        assert!(remove_files("out", &[], &root).is_ok_and(|gone| !gone));
        assert!(remove_files("out", &["c/mine".to_owned()], &root).is_ok());
        assert!(root.join("beside").exists());
    }
}

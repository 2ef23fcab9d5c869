//! Files that stages write beside their outputs.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::own::ASIDE;
use crate::paths::with_ancestors;
use crate::{Graph, Place};

/// File systems stamp times in ticks of up to 10 ms.
const TICK: Duration = Duration::from_millis(20);

/// What stands in the root and beside the outputs, looked at once before the first stage
/// runs and once after the last: looking around each stage would cost more than short
/// stages do.
pub(crate) struct Surroundings {
    folders: BTreeMap<PathBuf, BTreeMap<OsString, Look>>,
    /// Paths that stages make or that hold what they make.
    made: BTreeSet<PathBuf>,
}

/// Size and time of a file; of a directory only that it is there.
type Look = Option<(u64, SystemTime)>;

impl Surroundings {
    pub(crate) fn of(graph: &Graph<'_>, place: &Place) -> Self {
        let stages = || graph.ordered().flat_map(|stage| &stage.outputs);
        let made = stages().flat_map(|output| with_ancestors(output));
        let made: BTreeSet<PathBuf> = made.map(|path| place.root.join(path)).collect();
        let parent = |output: &String| place.root.join(output).parent().map(Path::to_owned);
        let folders: BTreeSet<PathBuf> = stages()
            .filter_map(parent)
            .chain([place.root.clone()])
            .collect();
        let outputs: BTreeSet<PathBuf> = stages().map(|output| place.root.join(output)).collect();
        let folders = folders
            .into_iter()
            .filter(|folder| !outputs.contains(folder));
        Self {
            folders: folders
                .map(|folder| (folder.clone(), looks(&folder)))
                .collect(),
            made,
        }
    }

    /// The files that are new or changed and that no stage makes, with the time of each.
    pub(crate) fn changes(&self, place: &Place) -> Vec<(PathBuf, Option<SystemTime>)> {
        let mut changes = Vec::new();
        for (folder, before) in &self.folders {
            for (name, look) in looks(folder) {
                let path = folder.join(&name);
                let known = before.get(&name) == Some(&look) || self.made.contains(&path);
                let ours = || place.is_ours(&path) || name.to_string_lossy().starts_with(ASIDE);
                if !known && !ours() {
                    changes.push((path, look.map(|(_, time)| time)));
                }
            }
        }
        changes
    }
}

/// Whether a file with this time can have been written between `start` and `end`.
pub(crate) fn is_between(time: SystemTime, start: SystemTime, end: SystemTime) -> bool {
    start.checked_sub(TICK).is_none_or(|start| time >= start)
        && end.checked_add(TICK).is_none_or(|end| time <= end)
}

fn looks(folder: &Path) -> BTreeMap<OsString, Look> {
    let Ok(entries) = fs::read_dir(folder) else {
        return BTreeMap::new(); // a stage will make it
    };
    let look = |entry: fs::DirEntry| {
        let metadata = entry.metadata().ok()?;
        let time = metadata.modified().ok()?;
        let file = !metadata.is_dir();
        Some((entry.file_name(), file.then_some((metadata.len(), time))))
    };
    entries.flatten().filter_map(look).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn a_file_was_written_between_two_times_a_tick_more_or_less() {
        let at = |ms: u64| SystemTime::UNIX_EPOCH + Duration::from_millis(ms);
        for (time, expected) in [
            (979, false),
            (980, true),
            (1000, true),
            (2020, true),
            (2021, false),
        ] {
            assert_eq!(is_between(at(time), at(1000), at(2000)), expected, "{time}");
        }
    }

    #[test]
    fn what_is_new_or_changed_beside_the_outputs_and_nobody_s_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        let pipeline =
            crate::testing::pipeline(&[("a", &[], &["data/out.csv"]), ("b", &[], &["all"])]);
        let graph = Graph::new(&pipeline).unwrap();
        let place = Place::below(root);
        let write = |path: &str, text: &str| {
            let path = root.join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        write("data/old.txt", "1");
        write("same.txt", "1");
        let before = Surroundings::of(&graph, &place);
        assert!(before.changes(&place).is_empty());
        write("data/out.csv", "made");
        write("all/one.csv", "made");
        write(".pipeline/lock", "ours");
        write(&format!("{ASIDE}x"), "put aside");
        write("data/new.txt", "2");
        write("data/old.txt", "12");
        write("beside.txt", "2");
        let mut found: Vec<PathBuf> = before.changes(&place).into_iter().map(|c| c.0).collect();
        found.sort();
        let expected = ["beside.txt", "data/new.txt", "data/old.txt"].map(|path| root.join(path));
        assert_eq!(found, expected);
    }
}

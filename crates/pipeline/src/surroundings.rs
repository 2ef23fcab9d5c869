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
                let ours = place.is_ours(&path) || name.to_string_lossy().starts_with(ASIDE);
                if !known && !ours {
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

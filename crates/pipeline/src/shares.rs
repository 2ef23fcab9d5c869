//! The files of a directory, dealt out over the shards of a stage.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use crate::PipelineError;
use crate::look::{is_settled, nanos_since_epoch};
use crate::stage::Share;

/// Directories that were dealt out, so that a thousand shards do not list theirs a thousand
/// times.
#[derive(Clone, Default)]
pub(crate) struct Shares(Arc<Mutex<BTreeMap<Kind, Dealt>>>);

/// A directory, a pattern of names, and how many shards.
type Kind = (String, String, u32);

#[derive(Clone)]
struct Dealt {
    /// When the directory had changed last.
    changed: SystemTime,
    files: Arc<Vec<Vec<String>>>,
}

impl Shares {
    /// The paths of the share's files as they are now, relative to the root, in order.
    pub(crate) fn files(&self, share: &Share, root: &Path) -> Result<Vec<String>, PipelineError> {
        let kind = (share.folder.clone(), share.pattern.clone(), share.shards);
        let changed = fs::metadata(root.join(&share.folder)).and_then(|m| m.modified());
        let now = SystemTime::now();
        let settled = |time: SystemTime| is_settled(&[nanos_since_epoch(time)], now);
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let dealt = match known.get(&kind) {
            Some(dealt) if changed.as_ref().is_ok_and(|c| *c == dealt.changed) => dealt.clone(),
            _ => {
                let files = Arc::new(deal(share, root)?);
                let dealt = Dealt {
                    changed: changed.as_ref().map_or(SystemTime::UNIX_EPOCH, |c| *c),
                    files,
                };
                if changed.is_ok_and(settled) {
                    known.insert(kind, dealt.clone());
                }
                dealt
            }
        };
        Ok(dealt.files[share.shard as usize].clone())
    }
}

/// The files of every share.
fn deal(share: &Share, root: &Path) -> Result<Vec<Vec<String>>, PipelineError> {
    let folder = root.join(&share.folder);
    let mut shares = vec![Vec::new(); share.shards as usize];
    let failed = || PipelineError::io("read the directory", &folder);
    let entries = match fs::read_dir(&folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(shares),
        entries => entries.map_err(failed())?,
    };
    for entry in entries {
        let entry = entry.map_err(failed())?;
        let Ok(name) = entry.file_name().into_string() else {
            return Err(PipelineError::NameNotText { path: entry.path() });
        };
        let kind = entry.file_type().map_err(failed())?;
        // A link counts as what it leads to.
        if share.matches(&name) && (kind.is_file() || kind.is_symlink() && entry.path().is_file()) {
            shares[share.shard_of(&name) as usize].push(format!("{}/{name}", share.folder));
        }
    }
    for files in &mut shares {
        files.sort();
    }
    Ok(shares)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_in_one_share_and_keeps_it_when_others_come() {
        let folder = tempfile::tempdir().unwrap();
        let write = |i: usize| fs::write(folder.path().join(format!("{i}.txt")), "").unwrap();
        (0..40).for_each(write);
        fs::write(folder.path().join("notes.md"), "").unwrap();
        let known = Shares::default();
        let shares = || {
            let share = |shard| Share {
                folder: ".".to_owned(),
                pattern: "*.txt".to_owned(),
                shard,
                shards: 3,
            };
            [0, 1, 2].map(|shard| known.files(&share(shard), folder.path()).unwrap())
        };
        std::thread::sleep(std::time::Duration::from_millis(50));
        let before = shares();
        assert_eq!(before.iter().map(Vec::len).sum::<usize>(), 40);
        assert!(before.iter().all(|share| share.len() > 4));
        assert_eq!(known.0.lock().unwrap().len(), 1, "listed once");
        write(40);
        let after = shares();
        let changed = before.iter().zip(&after).filter(|(a, b)| a != b);
        assert_eq!(changed.count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_file_whose_name_is_no_text_is_not_left_out_in_silence() {
        use std::os::unix::ffi::OsStrExt;
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(std::ffi::OsStr::from_bytes(b"\xff.txt")), "").unwrap();
        let share = Share { folder: ".".to_owned(), pattern: "*".to_owned(), shard: 0, shards: 1 };
        let error = Shares::default().files(&share, folder.path()).unwrap_err();
        assert!(error.to_string().contains("is not UTF-8 text"), "{error}");
    }
}

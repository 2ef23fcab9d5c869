//! A hidden folder in which outputs are made that appear together.

use crate::error::StudyError;
use std::{fs::File, path::Path};
use tempfile::TempDir;

/// A hidden folder on the disk of `out`, in the nearest folder above that exists; it goes when it is dropped.
pub(crate) struct Aside {
    /// Held as long as the folder is in use: it says so to others, whatever ends this program.
    _lock: File,
    folder: TempDir,
}

impl Aside {
    const PREFIX: &str = ".maveric-aside-";
    const LOCK: &str = "in-use";
    /// How far above `out` a call that was killed may have left its folder: `out` was made since.
    const LEVELS: usize = 4;

    /// Makes the folder, and removes those that killed calls left behind.
    pub(crate) fn new(out: &Path) -> Result<Self, StudyError> {
        let out = std::path::absolute(out).map_err(StudyError::write(out))?;
        let exists = out.ancestors().find(|folder| folder.is_dir());
        let place = exists.unwrap_or(&out);
        out.ancestors().take(Self::LEVELS).for_each(Self::remove_left_behind);
        let folder = tempfile::Builder::new()
            .prefix(Self::PREFIX)
            .tempdir_in(place)
            .map_err(StudyError::write(place))?;
        // Locked before it has its name, so that nobody finds it free; where the disk knows no locks nobody takes one.
        let (fresh, lock) = (folder.path().join("new"), folder.path().join(Self::LOCK));
        let file = File::create(&fresh).map_err(StudyError::write(&fresh))?;
        let _ = file.try_lock();
        std::fs::rename(&fresh, &lock).map_err(StudyError::write(&lock))?;
        Ok(Self { _lock: file, folder })
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Removes folders of other calls whose lock nobody holds any more. What cannot be removed stays: it does no harm.
    fn remove_left_behind(place: &Path) {
        for entry in std::fs::read_dir(place).into_iter().flatten().flatten() {
            let folder = entry.path();
            let ours = entry.file_name().to_string_lossy().starts_with(Self::PREFIX);
            if let Ok(lock) = File::options().write(true).open(folder.join(Self::LOCK))
                && ours
                && lock.try_lock().is_ok()
            {
                let _ = std::fs::remove_dir_all(&folder);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_call_left_goes_at_the_next_one_and_what_another_call_uses_stays() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        std::fs::create_dir(&out).unwrap();
        let name = |name: &str| format!("{}{name}", Aside::PREFIX);
        let (left, used) = (out.join(name("left")), folder.path().join(name("used")));
        for aside in [&left, &used] {
            std::fs::create_dir(aside).unwrap();
            std::fs::write(aside.join(Aside::LOCK), "").unwrap();
        }
        let lock = File::open(used.join(Aside::LOCK)).unwrap();
        lock.try_lock().unwrap();
        let aside = Aside::new(&out).unwrap();
        assert!(!left.exists() && used.exists() && aside.path().is_dir());
        let made = aside.path().to_owned();
        drop(aside);
        assert!(!made.exists());
    }
}

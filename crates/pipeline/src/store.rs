//! Where files are kept under names.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::PipelineError;
use crate::atomic_write::{Durability, atomic_write, atomic_write_bytes};

/// A folder of files under names.
pub(crate) struct Store {
    folder: PathBuf,
}

impl Store {
    /// Opens a folder, which need not be there.
    ///
    /// # Errors
    /// [`PipelineError::Io`] for a URL.
    pub(crate) fn open(folder: &Path) -> Result<Self, PipelineError> {
        if folder.to_str().is_some_and(|text| text.contains("://")) {
            let error =
                io::Error::new(io::ErrorKind::InvalidInput, "a cache is a folder, not a URL");
            return Err(PipelineError::io("open", folder)(error));
        }
        Ok(Self { folder: folder.to_owned() })
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The bytes of a name; none where there is nothing, or nothing that can be read.
    pub(crate) fn read(&self, name: &str) -> Option<Vec<u8>> {
        fs::read(self.path(name)).ok()
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), PipelineError> {
        atomic_write_bytes(&self.path(name), bytes, Durability::Written)
    }

    /// Brings a file; `false` where there is nothing of this name.
    pub(crate) fn fetch(&self, name: &str, target: &Path) -> Result<bool, PipelineError> {
        match copy(&self.path(name), target) {
            // Something else may have its name: that is no file that was kept.
            Err(_) if !self.path(name).is_file() => Ok(false),
            copied => copied.map(|_| true).map_err(PipelineError::io("write", target)),
        }
    }

    /// Keeps a file, unless its name is taken: names are those of contents.
    pub(crate) fn send(
        &self,
        from: &Path,
        name: &str,
        executable: bool,
    ) -> Result<(), PipelineError> {
        let target = self.path(name);
        if target.is_file() {
            return Ok(());
        }
        let failed = || PipelineError::io("write into the cache", &target);
        atomic_write(&target, Durability::Written, |file| {
            let copied = fs::File::open(from).and_then(|mut from| io::copy(&mut from, file));
            copied.map(drop).map_err(failed())
        })?;
        set_mode(&target, executable).map_err(failed())
    }

    pub(crate) fn remove(&self, name: &str) {
        let _ = fs::remove_file(self.path(name));
    }
}

/// Copies what is in a file, not who may read it.
fn copy(from: &Path, to: &Path) -> io::Result<u64> {
    let mut from = fs::File::open(from)?;
    io::copy(&mut from, &mut fs::File::create(to)?)
}

#[cfg(unix)]
pub(crate) fn is_executable(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    fs::metadata(path).is_ok_and(|metadata| metadata.permissions().mode() & 0o100 != 0)
}

#[cfg(not(unix))]
pub(crate) fn is_executable(_path: &Path) -> bool {
    false
}

/// A cache for all must be readable for all, whatever the umask of who fills it.
#[cfg(unix)]
fn set_mode(path: &Path, executable: bool) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let mode = if executable { 0o755 } else { 0o644 };
    fs::set_permissions(path, fs::Permissions::from_mode(mode))
}

#[cfg(not(unix))]
fn set_mode(_path: &Path, _executable: bool) -> io::Result<()> {
    Ok(())
}

/// Whoever may read the file may run it, too.
#[cfg(unix)]
pub(crate) fn make_executable(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let mode = fs::metadata(path)?.permissions().mode();
    let mode = mode | ((mode & 0o444) >> 2);
    fs::set_permissions(path, fs::Permissions::from_mode(mode))
}

#[cfg(not(unix))]
pub(crate) fn make_executable(_path: &Path) -> io::Result<()> {
    Ok(())
}

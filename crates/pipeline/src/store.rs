//! Where files are kept under names: a folder, or a bucket on object storage.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::PipelineError;
use crate::atomic_write::{Durability, atomic_write, atomic_write_bytes};
#[cfg(feature = "object-store")]
use crate::bucket::Bucket;

/// A folder, or a bucket by its URL.
pub(crate) enum Store {
    Folder(PathBuf),
    #[cfg(feature = "object-store")]
    Bucket(Bucket),
}

impl Store {
    /// Opens `place`: what has `://` in it is on object storage.
    ///
    /// # Errors
    /// [`PipelineError::Io`] for a URL that cannot be used, or where the program was built without object storage.
    pub(crate) fn open(place: &Path) -> Result<Self, PipelineError> {
        match place.to_str().filter(|text| is_url(text)) {
            None => Ok(Self::Folder(place.to_owned())),
            #[cfg(feature = "object-store")]
            Some(url) => Bucket::open(url)
                .map(Self::Bucket)
                .map_err(PipelineError::io("open", place)),
            #[cfg(not(feature = "object-store"))]
            Some(_) => Err(PipelineError::io("open", place)(without_object_storage())),
        }
    }

    /// What an error calls a name.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        match self {
            Self::Folder(folder) => folder.join(name),
            #[cfg(feature = "object-store")]
            Self::Bucket(bucket) => bucket.url(name).into(),
        }
    }

    /// The bytes of a name; none where there is nothing, or nothing that can be read.
    pub(crate) fn read(&self, name: &str) -> Option<Vec<u8>> {
        match self {
            Self::Folder(folder) => fs::read(folder.join(name)).ok(),
            #[cfg(feature = "object-store")]
            Self::Bucket(bucket) => bucket.read(name).ok().flatten(),
        }
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), PipelineError> {
        match self {
            Self::Folder(folder) => {
                atomic_write_bytes(&folder.join(name), bytes, Durability::Written)
            }
            #[cfg(feature = "object-store")]
            Self::Bucket(bucket) => {
                let target = self.path(name);
                let written = bucket.write(name, bytes);
                written.map_err(PipelineError::io("write", &target))
            }
        }
    }

    /// Whether there is something of this name.
    fn has(&self, name: &str) -> bool {
        match self {
            Self::Folder(folder) => folder.join(name).is_file(),
            #[cfg(feature = "object-store")]
            Self::Bucket(bucket) => bucket.stamp(name).is_ok_and(|stamp| stamp.is_some()),
        }
    }

    /// Brings a file; `false` where there is nothing of this name.
    pub(crate) fn fetch(&self, name: &str, target: &Path) -> Result<bool, PipelineError> {
        let fetched = match self {
            Self::Folder(folder) => match copy(&folder.join(name), target) {
                // Something else may have its name: that is no file that was kept.
                Err(_) if !folder.join(name).is_file() => Ok(false),
                copied => copied.map(|_| true),
            },
            #[cfg(feature = "object-store")]
            Self::Bucket(bucket) => bucket.fetch(name, target),
        };
        fetched.map_err(PipelineError::io("write", target))
    }

    /// Keeps a file, unless its name is taken: names are those of contents.
    pub(crate) fn send(
        &self,
        from: &Path,
        name: &str,
        executable: bool,
    ) -> Result<(), PipelineError> {
        if self.has(name) {
            return Ok(());
        }
        let target = self.path(name);
        let failed = || PipelineError::io("write into the cache", &target);
        match self {
            Self::Folder(_) => {
                atomic_write(&target, Durability::Written, |file| {
                    let copied =
                        fs::File::open(from).and_then(|mut from| io::copy(&mut from, file));
                    copied.map(drop).map_err(failed())
                })?;
                set_mode(&target, executable).map_err(failed())
            }
            #[cfg(feature = "object-store")]
            Self::Bucket(bucket) => bucket.send(from, name).map_err(failed()),
        }
    }

    pub(crate) fn remove(&self, name: &str) {
        match self {
            Self::Folder(folder) => drop(fs::remove_file(folder.join(name))),
            #[cfg(feature = "object-store")]
            Self::Bucket(bucket) => drop(bucket.remove(name)),
        }
    }
}

/// Copies what is in a file, not who may read it.
fn copy(from: &Path, to: &Path) -> io::Result<u64> {
    let mut from = fs::File::open(from)?;
    io::copy(&mut from, &mut fs::File::create(to)?)
}

/// Whether a place is on object storage.
pub(crate) fn is_url(place: &str) -> bool {
    place.contains("://")
}

#[cfg(not(feature = "object-store"))]
pub(crate) fn without_object_storage() -> io::Error {
    let what =
        "this program was built without object storage: build it with `--features object-store`";
    io::Error::new(io::ErrorKind::Unsupported, what)
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

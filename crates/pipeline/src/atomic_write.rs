//! Files that appear whole or not at all.

use std::io::Write;
use std::path::Path;

use crate::PipelineError;

/// Whether a write must have reached the disk before the call returns.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Durability {
    /// Survives a power cut.
    Synced,
    /// Survives the death of this process, which is enough where losing it only costs work.
    Written,
}

/// Writes beside `path`, then renames; creates the directory if need be.
///
/// # Errors
/// [`PipelineError::Io`] if the directory or the file cannot be written.
pub(crate) fn write(
    path: &Path,
    content: &[u8],
    durability: Durability,
) -> Result<(), PipelineError> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder).map_err(PipelineError::io("create", folder))?;
    let failed = || PipelineError::io("write", path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(".writing-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the umask
    let mut file = builder.tempfile_in(folder).map_err(failed())?;
    file.write_all(content).map_err(failed())?;
    if durability == Durability::Synced {
        file.as_file().sync_all().map_err(failed())?;
    }
    file.persist(path)
        .map_err(|error| failed()(error.error))
        .map(drop)
}

//! How much the disk has left on which the seat keeps what people give.

use std::path::Path;

/// Below so many bytes the experimenter is warned: hours of driving by many people, and whatever else is written there.
pub(crate) const LITTLE: u64 = 2 << 30;

/// Bytes that may still be written where `path` is; none where the system does not say.
#[cfg(unix)]
pub(crate) fn left(path: &Path) -> Option<u64> {
    let disk = nix::sys::statvfs::statvfs(path).ok()?;
    // Of how many bits these are is the system's.
    Some((disk.blocks_available() as f64 * disk.fragment_size() as f64) as u64)
}

/// As on other systems, which say it: nobody knows.
#[cfg(not(unix))]
pub(crate) fn left(_: &Path) -> Option<u64> {
    None
}

/// Bytes in GB, to a tenth below 100.
pub(crate) fn in_gb(bytes: u64) -> String {
    let gb = bytes as f64 / 1e9;
    if gb < 100.0 { format!("{gb:.1}") } else { format!("{gb:.0}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_says_what_its_disk_has_left_and_nowhere_says_nothing() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(left(folder.path()).is_some(), cfg!(unix));
        assert_eq!(left(&folder.path().join("not there")), None);
        assert_eq!(in_gb(12_340_000_000), "12.3");
        assert_eq!(in_gb(512_600_000_000), "513");
    }
}

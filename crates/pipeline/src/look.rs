//! By what a file that nobody has touched is known, and from when on.

use std::fs::Metadata;
use std::time::{SystemTime, UNIX_EPOCH};

/// File systems stamp times in ticks of up to 10 ms: a file changed this lately could
/// change again without looking changed, so its hash is not remembered.
const SETTLED_AFTER_NS: i64 = 25_000_000;
/// The same where times are whole seconds, as on ext3 and HFS+, or every other second, as on FAT.
const SETTLED_AFTER_WHOLE_SECONDS_NS: i64 = 2 * SECOND_NS + SETTLED_AFTER_NS;
pub(crate) const SECOND_NS: i64 = 1_000_000_000;

/// What tells an untouched file: if all of it is the same, the content is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Look {
    pub(crate) size: u64,
    pub(crate) modified_ns: i64,
    /// Of the file's record: also moves when a copy keeps the time of its original.
    pub(crate) changed_ns: i64,
    inode: u64,
}

impl Look {
    #[cfg(unix)]
    pub(crate) fn from_metadata(metadata: &Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        let ns = |seconds: i64, ns: i64| seconds.saturating_mul(SECOND_NS).saturating_add(ns);
        Self {
            size: metadata.len(),
            modified_ns: ns(metadata.mtime(), metadata.mtime_nsec()),
            changed_ns: ns(metadata.ctime(), metadata.ctime_nsec()),
            inode: metadata.ino(),
        }
    }

    /// Windows has no time of a change to what is known of a file, and no stable number of it here: when it was made stands for it.
    #[cfg(not(unix))]
    pub(crate) fn from_metadata(metadata: &Metadata) -> Self {
        let modified_ns = metadata.modified().map_or(i64::MAX, nanos_since_epoch);
        let made_ns = metadata.created().map_or(0, nanos_since_epoch);
        Self {
            size: metadata.len(),
            modified_ns,
            changed_ns: modified_ns,
            inode: made_ns.cast_unsigned(),
        }
    }

    /// A time in the future never counts as settled, so a wrong clock costs time only.
    pub(crate) fn is_settled_at(&self, now: SystemTime) -> bool {
        is_settled(&[self.modified_ns, self.changed_ns], now)
    }
}

/// Whether what has these times, in nanoseconds since 1970, could no longer change without looking changed.
pub(crate) fn is_settled(times_ns: &[i64], now: SystemTime) -> bool {
    let wait = if times_ns.iter().all(|time| time % SECOND_NS == 0) {
        SETTLED_AFTER_WHOLE_SECONDS_NS
    } else {
        SETTLED_AFTER_NS
    };
    let last = times_ns.iter().max().copied().unwrap_or(i64::MAX);
    nanos_since_epoch(now) > last.saturating_add(wait)
}

pub(crate) fn nanos_since_epoch(time: SystemTime) -> i64 {
    time.duration_since(UNIX_EPOCH)
        .map_or(0, |since| i64::try_from(since.as_nanos()).unwrap_or(i64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_settled_some_ticks_after_its_last_change_and_never_in_the_future() {
        let at = |ns: i64| UNIX_EPOCH + std::time::Duration::from_nanos(ns.cast_unsigned());
        let ago =
            |modified_ns: i64, changed_ns: i64| Look { size: 1, modified_ns, changed_ns, inode: 1 };
        let last = 5_000_000_001;
        for look in [ago(last, last), ago(last, 1), ago(1, last)] {
            let settles = last + SETTLED_AFTER_NS;
            assert!(look.is_settled_at(at(settles + 1)));
            assert!(!look.is_settled_at(at(settles)));
            assert!(!look.is_settled_at(at(0)));
        }
        assert!(!ago(i64::MAX, 1).is_settled_at(at(i64::MAX - 1)));
    }

    #[test]
    fn where_times_are_whole_seconds_a_file_is_settled_after_two_of_them() {
        let at = |ns: i64| UNIX_EPOCH + std::time::Duration::from_nanos(ns.cast_unsigned());
        let (last, soon) = (5 * SECOND_NS, SETTLED_AFTER_NS + 1);
        assert!(!is_settled(&[last, last], at(last + soon)));
        assert!(!is_settled(&[last, last], at(last + 2 * SECOND_NS)));
        assert!(is_settled(&[last, last], at(last + 2 * SECOND_NS + soon)));
        // The time that an archive had kept says nothing about the disk.
        assert!(is_settled(&[SECOND_NS, last + 1], at(last + 1 + soon)));
    }
}

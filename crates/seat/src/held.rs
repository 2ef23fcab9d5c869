//! What several threads share.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a lock guards, also after a panic elsewhere: it is changed in one go, made anew, or rolled back.
pub(crate) fn held<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

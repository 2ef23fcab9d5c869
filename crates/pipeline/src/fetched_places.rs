//! What `[fetch]` of a pipeline names.

use std::collections::BTreeMap;

/// What `[fetch]` of a pipeline names: the places of files and their URLs.
pub(crate) type Places = BTreeMap<String, String>;

/// Whether `path` is below the root and in one spelling, and `url` is one.
pub(crate) fn is_allowed(path: &str, url: &str) -> bool {
    crate::store::is_url(url)
        && !path.starts_with('/')
        && !path.starts_with("..")
        && crate::paths::normalise(path).as_deref() == Some(path)
}

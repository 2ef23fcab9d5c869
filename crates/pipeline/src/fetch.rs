//! Inputs that lie on object storage: fetched before a run, so that stages see files.

use std::collections::BTreeMap;
use std::path::Path;

use crate::{Pipeline, PipelineError, Place};

/// What `[fetch]` of a pipeline names: the places of files and their URLs.
pub(crate) type Places = BTreeMap<String, String>;

/// Whether `path` is below the root and in one spelling, and `url` is one.
pub(crate) fn is_allowed(path: &str, url: &str) -> bool {
    crate::store::is_url(url)
        && !path.starts_with('/')
        && !path.starts_with("..")
        && crate::paths::normalise(path).as_deref() == Some(path)
}

/// What was fetched, by the place at which it is seen: file → what its object was then.
#[cfg(feature = "object-store")]
type Fetched = BTreeMap<String, BTreeMap<String, crate::bucket::Stamp>>;

/// Fetches what `[fetch]` names and has changed there or is not here; what was fetched and is there no longer goes.
///
/// # Errors
/// [`PipelineError::Io`] that names the URL or the file.
#[cfg(feature = "object-store")]
pub(crate) fn fetch(pipeline: &Pipeline, place: &Place) -> Result<(), PipelineError> {
    use crate::atomic_write::{Durability, atomic_write_bytes};
    use crate::bucket::Bucket;
    use std::fs;

    if pipeline.fetch().is_empty() {
        return Ok(());
    }
    let memory = place.fetched();
    let before: Fetched = fs::read(&memory)
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok())
        .unwrap_or_default();
    let mut now = Fetched::new();
    for (seen, url) in pipeline.fetch() {
        let failed = || PipelineError::io("fetch", Path::new(url));
        let bucket = Bucket::open(url).map_err(failed())?;
        let listed = bucket.list().map_err(failed())?;
        if listed.is_empty() {
            return Err(failed()(std::io::Error::new(
                std::io::ErrorKind::NotFound,
                "there is nothing",
            )));
        }
        let known = before.get(seen);
        let kept = now.entry(seen.clone()).or_default();
        for (name, stamp) in listed {
            let odd = |part: &str| matches!(part, "" | "." | "..") || part.contains('\\');
            if !name.is_empty() && name.split('/').any(odd) {
                let what = format!("the object `{name}` would be a file elsewhere");
                return Err(failed()(std::io::Error::other(what)));
            }
            let file = match name.as_str() {
                "" => place.root.join(seen),
                name => place.root.join(seen).join(name),
            };
            let complete = fs::metadata(&file).is_ok_and(|m| m.is_file() && m.len() == stamp.bytes);
            let same = known.and_then(|known| known.get(&name)) == Some(&stamp);
            if !(complete && same) {
                let folder = file.parent().unwrap_or(&place.root);
                fs::create_dir_all(folder).map_err(PipelineError::io("create", folder))?;
                let beside = tempfile::Builder::new()
                    .prefix(".writing-")
                    .tempfile_in(folder);
                let beside = beside
                    .map_err(PipelineError::io("write", &file))?
                    .into_temp_path();
                bucket.fetch(&name, &beside).map_err(failed())?;
                crate::store::set_mode(&beside, false)
                    .map_err(PipelineError::io("write", &file))?;
                let placed = beside.persist(&file);
                placed.map_err(|e| PipelineError::io("write", &file)(e.error))?;
            }
            kept.insert(name, stamp);
        }
        for name in known.into_iter().flatten().map(|(name, _)| name) {
            if !kept.contains_key(name) {
                let _ = fs::remove_file(place.root.join(seen).join(name));
            }
        }
    }
    let json =
        serde_json::to_vec(&now).map_err(|e| PipelineError::io("write", &memory)(e.into()))?;
    atomic_write_bytes(&memory, &json, Durability::Written)
}

/// Says that nothing can be fetched where something is to be.
///
/// # Errors
/// [`PipelineError::Io`] that names the URL.
#[cfg(not(feature = "object-store"))]
pub(crate) fn fetch(pipeline: &Pipeline, _place: &Place) -> Result<(), PipelineError> {
    match pipeline.fetch().values().next() {
        None => Ok(()),
        Some(url) => {
            let failed = PipelineError::io("fetch", Path::new(url));
            Err(failed(crate::store::without_object_storage()))
        }
    }
}

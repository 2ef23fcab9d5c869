//! Object storage: S3 and what speaks as it does, Google's, Azure's, through `object_store`.
//!
//! Credentials and endpoints come from the environment, as the providers' own programs take them
//! (`AWS_ACCESS_KEY_ID`, `AWS_ENDPOINT_URL`, …).

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::Arc;

use object_store::path::Path as Key;
use object_store::{ObjectStore, ObjectStoreExt, PutPayload, parse_url_opts};
use tokio::runtime::Runtime;

/// Bytes that are asked for or sent at once: memory does not follow the size of files.
const PART: u64 = 8 << 20;

/// What lies below a URL.
pub(crate) struct Bucket {
    url: String,
    store: Arc<dyn ObjectStore>,
    base: Key,
    runtime: Runtime,
}

/// What tells one content of an object from another without reading it.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Stamp {
    pub(crate) bytes: u64,
    version: String,
}

impl From<object_store::ObjectMeta> for Stamp {
    fn from(meta: object_store::ObjectMeta) -> Self {
        let modified = || meta.last_modified.to_rfc3339();
        Self {
            bytes: meta.size,
            version: meta.e_tag.clone().unwrap_or_else(modified),
        }
    }
}

impl Bucket {
    pub(crate) fn open(url: &str) -> io::Result<Self> {
        let parsed = url::Url::parse(url).map_err(io::Error::other)?;
        let given = std::env::vars_os()
            .filter_map(|(key, value)| Some((key.into_string().ok()?, value.into_string().ok()?)));
        let (store, base) = parse_url_opts(&parsed, given).map_err(io::Error::other)?;
        let mut runtime = tokio::runtime::Builder::new_multi_thread();
        Ok(Self {
            url: url.trim_end_matches('/').to_owned(),
            store: store.into(),
            base,
            runtime: runtime.worker_threads(1).enable_all().build()?,
        })
    }

    /// The URL of a name.
    pub(crate) fn url(&self, name: &str) -> String {
        if name.is_empty() {
            return self.url.clone();
        }
        format!("{}/{name}", self.url)
    }

    fn key(&self, name: &str) -> Key {
        self.base.parts().chain(Key::from(name).parts()).collect()
    }

    /// What an object is, without its content; none where there is none.
    pub(crate) fn stamp(&self, name: &str) -> io::Result<Option<Stamp>> {
        let head = self.runtime.block_on(self.store.head(&self.key(name)));
        there(head.map(Stamp::from))
    }

    pub(crate) fn read(&self, name: &str) -> io::Result<Option<Vec<u8>>> {
        let key = self.key(name);
        let bytes = self
            .runtime
            .block_on(async { self.store.get(&key).await?.bytes().await });
        there(bytes.map(Into::into))
    }

    /// Brings an object into a file; `false` where there is none.
    pub(crate) fn fetch(&self, name: &str, target: &Path) -> io::Result<bool> {
        let Some(stamp) = self.stamp(name)? else {
            return Ok(false);
        };
        let (key, mut file) = (self.key(name), File::create(target)?);
        let mut start = 0;
        while start < stamp.bytes {
            let range = start..stamp.bytes.min(start + PART);
            let part = self
                .runtime
                .block_on(self.store.get_range(&key, range.clone()));
            file.write_all(&part.map_err(io::Error::other)?)?;
            start = range.end;
        }
        Ok(true)
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let payload = PutPayload::from(bytes.to_vec());
        let put = self
            .runtime
            .block_on(self.store.put(&self.key(name), payload));
        put.map(drop).map_err(io::Error::other)
    }

    /// Sends a file, which appears whole when all of it has been sent.
    pub(crate) fn send(&self, from: &Path, name: &str) -> io::Result<()> {
        let mut file = File::open(from)?;
        let mut next = || {
            let mut part = Vec::new();
            Read::by_ref(&mut file).take(PART).read_to_end(&mut part)?;
            io::Result::Ok(part)
        };
        let first = next()?;
        if (first.len() as u64) < PART {
            return self.write(name, &first);
        }
        let key = self.key(name);
        self.runtime.block_on(async {
            let mut upload = self
                .store
                .put_multipart(&key)
                .await
                .map_err(io::Error::other)?;
            let mut part = first;
            while !part.is_empty() {
                let sent = upload.put_part(PutPayload::from(part)).await;
                if let Err(error) = sent {
                    // What has been sent is of no use to anybody.
                    let _ = upload.abort().await;
                    return Err(io::Error::other(error));
                }
                part = next()?;
            }
            upload.complete().await.map(drop).map_err(io::Error::other)
        })
    }

    pub(crate) fn remove(&self, name: &str) -> io::Result<()> {
        let gone = self.runtime.block_on(self.store.delete(&self.key(name)));
        gone.map_err(io::Error::other)
    }

    /// The objects below the URL by their names from there on; the one that it is itself has an empty name.
    pub(crate) fn list(&self) -> io::Result<Vec<(String, Stamp)>> {
        if let Some(stamp) = self.stamp("")? {
            return Ok(vec![(String::new(), stamp)]);
        }
        let mut files = Vec::new();
        let mut folders = vec![self.base.clone()];
        while let Some(folder) = folders.pop() {
            let listed = self
                .runtime
                .block_on(self.store.list_with_delimiter(Some(&folder)));
            let listed = listed.map_err(io::Error::other)?;
            folders.extend(listed.common_prefixes);
            for object in listed.objects {
                let parts = object.location.prefix_match(&self.base);
                let parts: Vec<String> = parts
                    .into_iter()
                    .flatten()
                    .map(|p| p.as_ref().to_owned())
                    .collect();
                files.push((parts.join("/"), Stamp::from(object)));
            }
        }
        files.sort_by(|a, b| a.0.cmp(&b.0));
        Ok(files)
    }
}

/// An answer, or none where there is no such object.
fn there<T>(answer: object_store::Result<T>) -> io::Result<Option<T>> {
    match answer {
        Ok(found) => Ok(Some(found)),
        Err(object_store::Error::NotFound { .. }) => Ok(None),
        Err(error) => Err(io::Error::other(error)),
    }
}

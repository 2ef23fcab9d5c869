//! What may be written where: never over an input, a link, a device, a pipe, a read-only file or a file of another kind.

use crate::error::StudyError;
use maveric_pipeline::while_held;
use std::{
    fmt, fs,
    io::{self, Read as _},
    path::{Path, PathBuf},
};

/// Files that a command reads out of a folder, by their extensions: such a file there is an input.
const READ_FROM_FOLDERS: [&str; 3] = ["parquet", "toml", "mcap"];

/// Refuses outputs that are inputs of the same command, by whatever path they are named, and two outputs that are one file.
///
/// # Errors
/// [`StudyError::BadFile`] naming the output.
pub(crate) fn spare_inputs<'a>(
    inputs: impl IntoIterator<Item = &'a Path>,
    outputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), StudyError> {
    let inputs: Vec<PathBuf> = inputs.into_iter().map(place).collect();
    let mut taken: Vec<PathBuf> = Vec::new();
    for output in outputs {
        let there = place(output);
        let of_folder = there.exists()
            && there.parent().is_some_and(|folder| {
                let kind = there.extension().unwrap_or_default();
                let read = READ_FROM_FOLDERS.iter().any(|e| kind == *e);
                read && inputs.iter().any(|input| input == folder)
            });
        let problem = if of_folder || inputs.contains(&there) {
            "is an input of this command, so it is not written over"
        } else if taken.contains(&there) {
            "is named for two outputs"
        } else {
            taken.push(there);
            continue;
        };
        return Err(StudyError::file(output, problem).with_help("give the output another name"));
    }
    Ok(())
}

/// A path as the disk knows it; one that is not there yet below its folder.
fn place(path: &Path) -> PathBuf {
    if let Ok(there) = path.canonicalize() {
        return there;
    }
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    match (absolute.parent().map(Path::canonicalize), absolute.file_name()) {
        (Some(Ok(folder)), Some(name)) => folder.join(name),
        _ => absolute,
    }
}

/// What kind of file something is, by its first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Recording,
    /// A recording of a made-up person's drive.
    Synthetic,
    /// A recording of the simulated car.
    Automated,
    Parquet,
    Model,
    Png,
    Pdf,
    Svg,
    Html,
    Json,
    Text,
    Empty,
    Unknown,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Recording => "a recording (MCAP)",
            Self::Synthetic => "the recording of a made-up drive",
            Self::Automated => "the recording of an automated drive",
            Self::Parquet => "Parquet",
            Self::Model => "a model",
            Self::Png => "a picture (PNG)",
            Self::Pdf => "PDF",
            Self::Svg => "a picture (SVG)",
            Self::Html => "a page (HTML)",
            Self::Json => "JSON",
            Self::Text => "text",
            Self::Empty => "an empty file",
            Self::Unknown => "a file of an unknown kind",
        })
    }
}

impl Kind {
    /// Bytes at the start of a file that tell its kind.
    const HEAD: u64 = 1024;

    /// The kind of a file that begins with `head`.
    pub(crate) fn from_head(head: &[u8]) -> Self {
        let magic: [(&[u8], Self); 5] = [
            (b"\x89MCAP", Self::Recording),
            (b"PAR1", Self::Parquet),
            (b"maveric-model", Self::Model),
            (b"\x89PNG", Self::Png),
            (b"%PDF", Self::Pdf),
        ];
        if let Some((_, kind)) = magic.iter().find(|(magic, _)| head.starts_with(magic)) {
            // Our own recordings say in their first record who drives.
            let holds = |text: &[u8]| head.windows(text.len()).any(|w| w == text);
            return match kind {
                Self::Recording if holds(b"driven_by\x09\0\0\0synthetic") => Self::Synthetic,
                Self::Recording if holds(b"driven_by\x09\0\0\0automated") => Self::Automated,
                kind => *kind,
            };
        }
        let text = match std::str::from_utf8(head) {
            Ok(text) => text,
            // A character may be cut by the end of what was read.
            Err(e) if e.error_len().is_none() => {
                std::str::from_utf8(&head[..e.valid_up_to()]).unwrap_or_default()
            }
            Err(_) => return Self::Unknown,
        };
        let text = text.trim_start().to_ascii_lowercase();
        if text.is_empty() {
            return Self::Empty;
        }
        if text.contains('\0') {
            return Self::Unknown;
        }
        // `[` begins a table of TOML as well, with a letter or another `[` behind it.
        let list = text.strip_prefix('[').map(|rest| rest.trim_start().chars().next());
        let list =
            list.is_some_and(|c| c.is_none_or(|c| "{\"-]".contains(c) || c.is_ascii_digit()));
        if text.starts_with("<svg") || text.starts_with("<?xml") {
            Self::Svg
        } else if text.starts_with("<!doctype html") || text.starts_with("<html") {
            Self::Html
        } else if text.starts_with('{') || list {
            Self::Json
        } else {
            Self::Text
        }
    }

    fn read(mut file: impl io::Read) -> io::Result<Self> {
        let mut head = Vec::new();
        file.by_ref().take(Self::HEAD).read_to_end(&mut head)?;
        Ok(Self::from_head(&head))
    }
}

/// Refuses to write `path` where something other than a plain file that may be written stands there.
///
/// # Errors
/// [`StudyError::BadFile`] with what stands there.
pub(crate) fn refuse_unusual(path: &Path) -> Result<(), StudyError> {
    let there = match fs::symlink_metadata(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(e) => return Err(StudyError::write(path)(e)),
        Ok(there) => there,
    };
    let kind = there.file_type();
    let what = if kind.is_dir() {
        "a folder"
    } else if kind.is_symlink() {
        "a link"
    } else if !kind.is_file() {
        "a device or a pipe"
    } else if there.permissions().readonly() {
        "a file that may only be read"
    } else {
        return Ok(());
    };
    let problem = format!("is {what}, expected a new file or one to replace");
    Err(StudyError::file(path, problem).with_help("give the output another name"))
}

/// Refuses to replace `path` by what `fresh` reads where that is of another kind.
///
/// # Errors
/// [`StudyError::BadFile`] with both kinds.
pub(crate) fn refuse_other_kind(path: &Path, fresh: impl io::Read) -> Result<(), StudyError> {
    let former = match fs::File::open(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
        opened => opened.and_then(Kind::read).map_err(StudyError::read(path))?,
    };
    let new = Kind::read(fresh).map_err(StudyError::write(path))?;
    if former == new || former == Kind::Empty || new == Kind::Empty {
        return Ok(());
    }
    let problem = format!("is {former}, and {new} would be written over it");
    let help = "give the output another name, or remove the file";
    Err(StudyError::file(path, problem).with_help(help))
}

/// Renames a file that was written aside into its place, by the rules of this module.
///
/// # Errors
/// [`StudyError::BadFile`], [`StudyError::Io`]; what stood there before stays as it was.
pub(crate) fn put_in_place(fresh: &Path, path: &Path) -> Result<(), StudyError> {
    refuse_unusual(path)?;
    let file = fs::File::open(fresh).map_err(StudyError::read(fresh))?;
    refuse_other_kind(path, file)?;
    while_held(fresh, |fresh| fs::rename(fresh, path).map_err(|error| (error, fresh)))
        .map_err(StudyError::write(path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atomic_write::atomic_write_bytes;

    #[test]
    fn kinds_are_told_by_the_first_bytes() {
        let of = |text: &str| Kind::from_head(text.as_bytes());
        assert_eq!(of("[study]\ntitle = 1"), Kind::Text);
        assert_eq!(of("[[stage]]"), Kind::Text);
        assert_eq!(of("[\n  {"), Kind::Json);
        assert_eq!(of("{\"a\": 1}"), Kind::Json);
        assert_eq!(of("a,b\n1,2"), Kind::Text);
        assert_eq!(of("<!DOCTYPE html>"), Kind::Html);
        assert_eq!(of("<svg xmlns"), Kind::Svg);
        assert_eq!(of("a\0b"), Kind::Unknown);
        assert_eq!(Kind::from_head(b"\x89MCAP0\r\n"), Kind::Recording);
        assert_eq!(Kind::from_head(&[0xff, 0x00]), Kind::Unknown);
        // A letter that the end of what was read cuts.
        assert_eq!(Kind::from_head(&[b'a', 0xc3]), Kind::Text);
    }

    #[test]
    fn an_output_that_is_an_input_is_refused_by_whatever_path() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("drives")).unwrap();
        for name in ["a.csv", "drives/d.parquet"] {
            fs::write(at(name), "x").unwrap();
        }
        let refused = |input: &str, output: &str| {
            spare_inputs([&*at(input)], [&*at(output)])
                .err()
                .is_some_and(|e| e.to_string().contains("is an input"))
        };
        assert!(refused("a.csv", "a.csv"));
        assert!(refused("drives/../a.csv", "a.csv"));
        assert!(refused("drives", "drives/d.parquet"));
        assert!(!refused("drives", "drives/new.parquet"));
        assert!(!refused("drives", "drives/table.csv"));
        assert!(!refused("a.csv", "b.csv"));
        let one = at("one");
        let twice = spare_inputs([], [&*one, &*one]).unwrap_err();
        assert!(twice.to_string().contains("two outputs"), "{twice}");
    }

    #[cfg(unix)]
    #[test]
    fn links_pipes_read_only_files_and_other_kinds_are_never_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let refused = |name: &str, bytes: &[u8], why: &str| {
            let error = atomic_write_bytes(&at(name), bytes).unwrap_err();
            assert!(error.to_string().contains(why), "{error}");
        };
        fs::write(at("target"), "target").unwrap();
        std::os::unix::fs::symlink(at("target"), at("link")).unwrap();
        refused("link", b"new", "a link");
        assert_eq!(fs::read(at("target")).unwrap(), b"target");
        fs::write(at("mine"), "mine").unwrap();
        let mut permissions = fs::metadata(at("mine")).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(at("mine"), permissions).unwrap();
        refused("mine", b"new", "may only be read");
        refused(".", b"new", "folder");
        let _socket = std::os::unix::net::UnixListener::bind(at("socket")).unwrap();
        refused("socket", b"new", "a device or a pipe");
        fs::write(at("log"), b"\x89MCAP0\r\n and more").unwrap();
        refused("log", b"\x89PNG", "is a recording (MCAP), and a picture (PNG)");
        assert!(fs::read(at("log")).unwrap().ends_with(b"more"));
        fs::write(at("table"), "a,b\n1,2\n").unwrap();
        refused("log", b"\x89MCAP0\r\ndriven_by\x09\0\0\0synthetic", "made-up drive");
        refused("table", b"{\"a\": 1}", "is text, and JSON");
        atomic_write_bytes(&at("table"), b"a,b\n3,4\n").unwrap();
        assert_eq!(fs::read(at("table")).unwrap(), b"a,b\n3,4\n");
        let left: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
        assert_eq!(left.len(), 6, "{left:?}");
    }
}

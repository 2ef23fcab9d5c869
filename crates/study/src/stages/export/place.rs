//! The folder that is given away: new, or wholly an earlier export.

use super::ro_crate::Given;
use crate::{
    aside::Aside,
    deciding::hash_of,
    error::StudyError,
    tables::{Table, TableName, write_rows},
};
use path_slash::PathExt as _;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

/// The list of an export's files, itself not in it: with their sizes and checksums, for whoever is given them.
const LIST: &str = "files.csv";

/// A folder under way: it is made beside its place and appears whole.
pub(super) struct Place {
    out: PathBuf,
    /// The folder as it was named.
    shown: PathBuf,
    aside: Aside,
}

impl Place {
    /// Looks at the folder to write.
    ///
    /// # Errors
    /// [`StudyError::BadFile`] where it holds anything that no earlier export wrote; nothing is changed.
    pub(super) fn new(out: &Path) -> Result<Self, StudyError> {
        let shown = out.to_owned();
        let out = std::path::absolute(out).map_err(StudyError::write(out))?;
        refuse_used(&out)?;
        let aside = Aside::new(out.parent().unwrap_or(&out))?;
        let place = Self { out, shown, aside };
        let fresh = place.fresh();
        fs::create_dir(&fresh).map_err(StudyError::write(&fresh))?;
        Ok(place)
    }

    pub(super) fn fresh(&self) -> PathBuf {
        self.aside.path().join("export")
    }

    /// The files that are there so far: path, size, BLAKE3.
    pub(super) fn given(&self) -> Result<Vec<Given>, StudyError> {
        let fresh = self.fresh();
        let mut given = Vec::new();
        for name in files(&fresh)? {
            let path = fresh.join(&name);
            let bytes = fs::read(&path).map_err(StudyError::read(&path))?;
            given.push(Given { file: name, bytes: bytes.len(), blake3: hash_of(&bytes) });
        }
        Ok(given)
    }

    /// Warns of people of the earlier export who are not among those `now`; not where it was made with another key, or there is none.
    pub(super) fn gone(&self, now: impl Fn(&str) -> bool) -> Result<Option<String>, StudyError> {
        let mut former = BTreeSet::new();
        for name in ["participants.csv", "surveys.csv"] {
            let path = self.out.join(name);
            if path.is_file() {
                let listed = Table::read(&path)?.text("participant")?;
                former.extend(listed.into_iter().flatten());
            }
        }
        let gone = former.iter().filter(|name| !now(name)).count();
        let some = gone > 0 && gone < former.len();
        Ok(some.then(|| {
            format!(
                "{gone} people of the export that stood in {} are not in this one: whoever was given the earlier one has them still, and has to \
                 be asked to delete it",
                self.shown.to_slash_lossy()
            )
        }))
    }

    /// Lists the files and puts the folder in its place; an earlier export goes.
    ///
    /// # Errors
    /// [`StudyError::Io`]; an earlier export stays as it was.
    pub(super) fn take(self) -> Result<(), StudyError> {
        let fresh = self.fresh();
        let given = self.given()?;
        write_rows(TableName::Files, &fresh.join(LIST), &given)?;
        let former = self.aside.path().join("former");
        let used = self.out.exists();
        let beside = self.out.parent().unwrap_or(&self.out);
        fs::create_dir_all(beside).map_err(StudyError::write(beside))?;
        if used {
            fs::rename(&self.out, &former).map_err(StudyError::write(&self.out))?;
        }
        fs::rename(&fresh, &self.out).map_err(|e| {
            if used {
                let _ = fs::rename(&former, &self.out);
            }
            StudyError::write(&self.out)(e)
        })
    }
}

/// Refuses a folder with anything in it that no earlier export wrote.
fn refuse_used(out: &Path) -> Result<(), StudyError> {
    if !out.exists() {
        return Ok(());
    }
    let present = files(out)?;
    let list = out.join(LIST);
    let mut ours = BTreeSet::from([LIST.to_owned()]);
    if list.is_file() {
        let listed: Vec<Option<String>> = Table::read(&list)?.text("file")?;
        ours.extend(listed.into_iter().flatten());
    }
    let Some(foreign) = present.iter().find(|name| !ours.contains(*name)) else {
        return Ok(());
    };
    let problem =
        format!("holds `{foreign}`, which no export wrote: it would be given away with the rest");
    let help = "export into a new folder, or into one of an earlier export";
    Err(StudyError::file(out, problem).with_help(help))
}

/// Everything in a folder that is no folder itself, by its path below it with `/` between, sorted.
pub(super) fn files(folder: &Path) -> Result<Vec<String>, StudyError> {
    let mut names = Vec::new();
    let mut folders = vec![(folder.to_owned(), String::new())];
    while let Some((folder, below)) = folders.pop() {
        for entry in fs::read_dir(&folder).map_err(StudyError::read(&folder))? {
            let entry = entry.map_err(StudyError::read(&folder))?;
            let name = format!("{below}{}", entry.file_name().to_string_lossy());
            let kind = entry.file_type().map_err(StudyError::read(entry.path()))?;
            if kind.is_dir() {
                folders.push((entry.path(), name + "/"));
            } else {
                names.push(name);
            }
        }
    }
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exported(out: &Path, names: &[&str]) -> Result<(), StudyError> {
        let place = Place::new(out)?;
        for name in names {
            let path = place.fresh().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, name).unwrap();
        }
        place.take()
    }

    #[test]
    fn an_export_takes_the_place_of_an_earlier_one_and_of_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("given");
        exported(&out, &["logs/P1.mcap", "logs/P2.mcap", "people.csv"]).unwrap();
        exported(&out, &["logs/P1.mcap", "people.csv"]).unwrap();
        let left = files(&out).unwrap();
        assert_eq!(left, ["files.csv", "logs/P1.mcap", "people.csv"]);
        let list = fs::read_to_string(out.join(LIST)).unwrap();
        let hash = blake3::hash(b"people.csv").to_hex();
        assert!(list.contains(&format!("people.csv,10,{hash}")), "{list}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);

        fs::write(out.join("logs/raw.mcap"), "somebody").unwrap();
        let error = exported(&out, &["people.csv"]).unwrap_err().to_string();
        assert!(error.contains("`logs/raw.mcap`, which no export wrote"), "{error}");
        assert_eq!(files(&out).unwrap().len(), 4);
        let error = exported(folder.path(), &["people.csv"]).unwrap_err();
        assert!(error.to_string().contains("no export wrote"), "{error}");
    }
}

//! `design freeze`: what was declared, when, and what differs from it since.

use crate::{
    atomic_write::{atomic_write_bytes, read_text},
    deciding::{deciding_files, hash_of},
    design::DesignFile,
    error::StudyError,
    named::{is_number, without},
    once::count as counted,
    outcome::Outcome,
    stages,
};
use maveric_domain::design::is_day;
use maveric_pages::{DECLARED, PageTexts};
use path_slash::PathExt as _;
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// Name of a frozen design, beside the design.
pub const LOCK_FILE: &str = "study.lock";

/// A design as it was on a day, with everything else that decides a number.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frozen {
    /// The day, as `2026-11-22`.
    pub date: String,
    pub version: String,
    /// BLAKE3 of the design's text.
    pub hash: String,
    /// BLAKE3 of all the rest of this file: what to register where others keep the date.
    pub seal: String,
    /// Files of answers and of the study's own measures that were there already; none ought to be.
    pub answers: usize,
    /// Logs that were there already; none ought to be.
    pub logs: usize,
    pub design: String,
    /// BLAKE3 of every other file that decides a number, by its path from the study's folder.
    pub files: BTreeMap<String, String>,
    /// Version of each command's numbers.
    pub stages: BTreeMap<String, String>,
}

impl Frozen {
    /// The seal that belongs to what stands in the lock.
    fn seal(&self) -> Result<String, toml::ser::Error> {
        let rest = Self { seal: String::new(), ..self.clone() };
        let text = toml::to_string(&rest)?;
        Ok(hash_of(text.as_bytes()))
    }

    /// Why the lock cannot be what `design freeze` wrote; none if it can.
    fn forgery(&self) -> Option<&'static str> {
        if self.hash != hash_of(self.design.as_bytes()) {
            return Some("its hash is not that of the design in it");
        }
        if self.seal().ok().as_ref() != Some(&self.seal) {
            return Some("its seal is not that of what stands in it");
        }
        (!is_day(&self.date)).then_some("its date is no day")
    }
}

/// Writes `study.lock` beside the design; `date` is today's.
///
/// # Errors
/// [`StudyError`] if the design or a file that decides cannot be read, the design was frozen before, or the file cannot be written.
pub fn freeze(design: Option<&Path>, date: &str) -> Result<Outcome<Frozen>, StudyError> {
    let study = DesignFile::find(design)?;
    let Some(path) = &study.path else {
        let problem = "the paper's design is built in and cannot be frozen";
        let help = "name a study's own: --design study.toml";
        return Err(StudyError::not_possible(problem).with_help(help));
    };
    let lock = path.with_file_name(LOCK_FILE);
    if lock.exists() {
        let problem = "the design was frozen before";
        let help = "a changed key or file is declared under `[amendments]` with its reason; the lock stays";
        return Err(StudyError::file(lock, problem).with_help(help));
    }
    study.declarable()?;
    let text = read_text(path)?;
    let files = study.design.files();
    let measures = Some(&files.measures).filter(|_| !study.design.measures().is_empty());
    let tables = [&files.answers].into_iter().chain(measures);
    let tables = tables.filter(|path| study.resolve(path).is_file());
    let cannot = |e| StudyError::file(&lock, format!("cannot be written: {e}"));
    let mut frozen = Frozen {
        date: date.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        hash: hash_of(text.as_bytes()),
        seal: String::new(),
        answers: tables.count(),
        logs: count(&study.resolve(&files.logs)),
        design: text,
        files: deciding_files(&study)?,
        stages: stages::versions(),
    };
    frozen.seal = frozen.seal().map_err(cannot)?;
    let toml = toml::to_string(&frozen).map_err(cannot)?;
    atomic_write_bytes(&lock, toml.as_bytes())?;
    let mut warnings = Vec::new();
    if frozen.answers + frozen.logs > 0 {
        warnings.push(format!(
            "{} logs and {} files of answers or measures are there already: the page will say so",
            frozen.logs, frozen.answers
        ));
    }
    let summary = vec![
        format!(
            "frozen on {date}: {} (the design, {} other files that decide, the versions of {} commands)",
            lock.to_slash_lossy(),
            frozen.files.len(),
            frozen.stages.len()
        ),
        format!(
            "seal {}: register it where others keep the date; a file of your own is no time stamp",
            frozen.seal
        ),
    ];
    Ok(Outcome::new(frozen, summary, warnings))
}

fn count(folder: &Path) -> usize {
    let mut folders = vec![folder.to_owned()];
    let mut files = 0;
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(&folder).into_iter().flatten().flatten().map(|e| e.path()) {
            if path.is_dir() {
                folders.push(path);
            } else {
                files += 1;
            }
        }
    }
    files
}

/// What the page says of the declaration: that nothing differs, or one sentence a difference, and of what the lock vouches; nothing where
/// the design was never frozen.
pub(crate) fn declared(study: &DesignFile) -> Result<Vec<String>, StudyError> {
    let Some(path) = &study.path else {
        return Ok(Vec::new());
    };
    let lock = path.with_file_name(LOCK_FILE);
    if !lock.is_file() {
        return Ok(Vec::new());
    }
    let bad = |path: &Path| {
        let path = path.to_owned();
        move |e: toml::de::Error| StudyError::file(&path, e.to_string())
    };
    let frozen: Frozen = toml::from_str(&read_text(&lock)?).map_err(bad(&lock))?;
    let texts = PageTexts::new(DECLARED, &frozen)?.with(&BTreeMap::from([("lock", LOCK_FILE)]));
    if let Some(why) = frozen.forgery() {
        return Ok(vec![texts.with(&BTreeMap::from([("why", why)])).text("forged")?]);
    }
    let before: toml::Table = toml::from_str(&frozen.design).map_err(bad(&lock))?;
    let now: toml::Table = toml::from_str(&read_text(path)?).map_err(bad(path))?;
    let (before, now) = (leaves(before), leaves(now));
    let mut changes = Changes {
        texts: &texts,
        reasons: study.design.amendments(),
        hidden: hidden(before.keys().chain(now.keys())),
        sentences: Vec::new(),
    };
    changes.add("key", &before, &now)?;
    for list in BY_NAME {
        changes.count(list, &before, &now)?;
    }
    changes.add("file", &frozen.files, &deciding_files(study)?)?;
    changes.add("command", &frozen.stages, &stages::versions())?;
    let mut sentences = changes.sentences;
    let changed = !sentences.is_empty();
    if !changed {
        sentences.push(texts.text("as_declared")?);
    }
    let seal = texts.with(&BTreeMap::from([("changed", changed)]));
    sentences.push(seal.text("sealed")?);
    if frozen.answers + frozen.logs > 0 {
        sentences.push(texts.text("already")?);
    }
    Ok(sentences)
}

/// A list of the design that leaves people or drives out by name, and what it counts. No sentence names one of them.
type ByName = (&'static str, &'static str, &'static str);

const BY_NAME: [ByName; 2] =
    [("exclude.people.", "person", "people"), ("exclude.drives.", "drive", "drives")];

/// Whom and what these keys name, longer ones first: a drive's id holds its person's. A number is a word of many texts.
fn hidden<'a>(keys: impl Iterator<Item = &'a String>) -> Vec<String> {
    let named = |key: &String| {
        BY_NAME.iter().find_map(|(list, ..)| key.strip_prefix(list).map(str::to_owned))
    };
    let named: BTreeSet<String> = keys.filter_map(named).filter(|id| !is_number(id)).collect();
    let mut named: Vec<String> = named.into_iter().collect();
    named.sort_by_key(|id| std::cmp::Reverse(id.len()));
    named
}

/// What differs from the declaration, a sentence each.
struct Changes<'a> {
    texts: &'a PageTexts,
    reasons: &'a BTreeMap<String, String>,
    /// Ids that no sentence has.
    hidden: Vec<String>,
    sentences: Vec<String>,
}

/// A difference, as its sentence names it.
#[derive(Serialize)]
struct Change<'a> {
    what: &'a str,
    key: &'a str,
    before: Option<String>,
    now: Option<String>,
    why: Option<String>,
}

impl Changes<'_> {
    /// The differences of keys, files or commands.
    fn add(
        &mut self,
        what: &str,
        before: &BTreeMap<String, String>,
        now: &BTreeMap<String, String>,
    ) -> Result<(), StudyError> {
        let keys: BTreeSet<&String> = before.keys().chain(now.keys()).collect();
        for key in keys {
            let by_name = BY_NAME.iter().any(|(list, ..)| key.starts_with(list));
            if by_name || key.starts_with("amendments.") || before.get(key) == now.get(key) {
                continue;
            }
            let change = Change {
                what,
                key,
                before: before.get(key).map(|value| self.nameless(value)),
                now: now.get(key).map(|value| self.nameless(value)),
                why: self.reason(key),
            };
            self.say(&change)?;
        }
        Ok(())
    }

    /// The difference of a list that names people or drives, as counts.
    fn count(
        &mut self,
        (list, one, many): ByName,
        before: &BTreeMap<String, String>,
        now: &BTreeMap<String, String>,
    ) -> Result<(), StudyError> {
        let keys: BTreeSet<&String> = before.keys().chain(now.keys()).collect();
        let differs = |key: &&String| key.starts_with(list) && before.get(*key) != now.get(*key);
        let changed: Vec<&String> = keys.into_iter().filter(differs).collect();
        if changed.is_empty() {
            return Ok(());
        }
        let named = |leaves: &BTreeMap<String, String>| {
            leaves.keys().filter(|key| key.starts_with(list)).count()
        };
        let (was, is) = (named(before), named(now));
        let others = if was == is { ", others or for other reasons" } else { "" };
        let reasons: Vec<Option<String>> = changed.iter().map(|key| self.reason(key)).collect();
        let unexplained = reasons.iter().filter(|why| why.is_none()).count();
        let given: BTreeSet<String> = reasons.into_iter().flatten().collect();
        let mut given: Vec<String> = given.into_iter().collect();
        if unexplained > 0 && !given.is_empty() {
            given.push(format!("no reason was given for {}", counted(unexplained, one, many)));
        }
        let change = Change {
            what: "key",
            key: list.trim_end_matches('.'),
            before: Some(counted(was, one, many)),
            now: Some(counted(is, one, many) + others),
            why: (!given.is_empty()).then(|| given.join("; ")),
        };
        self.say(&change)
    }

    fn say(&mut self, change: &Change<'_>) -> Result<(), StudyError> {
        let sentence = self.texts.with(change).text("changed")?;
        self.sentences.push(sentence);
        Ok(())
    }

    /// The reason that an amendment gives for a key or for what holds it.
    fn reason(&self, key: &str) -> Option<String> {
        let (_, why) = self.reasons.iter().find(|(k, _)| {
            let below = key.strip_prefix(k.as_str());
            below.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[', '/']))
        })?;
        Some(self.nameless(why))
    }

    /// A text without those who are left out by name.
    fn nameless(&self, text: &str) -> String {
        without(text, self.hidden.iter().map(String::as_str))
    }
}

/// The leaves of a file, each under its path.
fn leaves(table: toml::Table) -> BTreeMap<String, String> {
    fn add(path: &str, value: &toml::Value, leaves: &mut BTreeMap<String, String>) {
        match value {
            toml::Value::Table(table) => {
                for (key, value) in table {
                    let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                    add(&path, value, leaves);
                }
            }
            toml::Value::Array(rows) if rows.iter().all(toml::Value::is_table) => {
                for (at, row) in rows.iter().enumerate() {
                    let id = row.get("id").and_then(toml::Value::as_str);
                    let name = id
                        .map_or_else(|| format!("{path}[{}]", at + 1), |id| format!("{path}.{id}"));
                    add(&name, row, leaves);
                }
            }
            leaf => {
                leaves.insert(path.to_owned(), leaf.to_string());
            }
        }
    }
    let mut leaves = BTreeMap::new();
    add("", &toml::Value::Table(table), &mut leaves);
    leaves
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{fs, path::PathBuf};

    const STUDY: &str = "[study]\ntitle = \"Calm or sporty\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n\
                         [baseline]\nid = \"own\"\n[[hypothesis]]\nsays = \"Sporty is faster\"\noutcome = \"mean_velocity_mps\"\n\
                         contrast = [\"sporty\", \"calm\"]\ndirection = \"+\"\n[exclude]\ndrive_shorter_than_s = 300\n";

    /// A study's folder with a questionnaire, frozen.
    fn frozen() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        fs::write(&path, STUDY).unwrap();
        fs::create_dir(folder.path().join("scales")).unwrap();
        fs::write(folder.path().join("scales/comfort.toml"), "items = 3\n").unwrap();
        fs::write(folder.path().join("mapping.toml"), "[names]\n").unwrap();
        freeze(Some(&path), "2026-11-22").unwrap();
        (folder, path)
    }

    fn said(path: &Path) -> Vec<String> {
        declared(&DesignFile::read(path).unwrap()).unwrap()
    }

    #[test]
    fn the_test_and_the_contrast_of_a_primary_outcome_are_covered() {
        let (folder, path) = frozen();
        fs::remove_file(folder.path().join(LOCK_FILE)).unwrap();
        let primary = "[[outcome]]\nmeasure = \"mean_velocity_mps\"\nprimary = true\ntest = \"mixed\"\ncontrast = [\"sporty\", \"calm\"]\n";
        let declared = format!("{STUDY}{primary}");
        fs::write(&path, &declared).unwrap();
        let outcome = freeze(Some(&path), "2026-11-22").unwrap();
        assert!(outcome.summary[1].contains(&outcome.value.seal));
        assert_eq!(said(&path)[0], "*Analysed as declared on 2026-11-22.*");
        fs::write(&path, declared.replace("\"mixed\"", "\"ordinal\"")).unwrap();
        assert!(
            said(&path)[0].contains("`outcome[1].test`: was \"mixed\", is \"ordinal\""),
            "{:?}",
            said(&path)
        );
    }

    #[test]
    fn a_primary_outcome_whose_test_can_never_be_run_is_neither_frozen_nor_described() {
        let (folder, path) = frozen();
        let lock = folder.path().join(LOCK_FILE);
        let declared = |test: &str| {
            let _ = fs::remove_file(&lock);
            let primary = format!(
                "[[outcome]]\nmeasure = \"mean_velocity_mps\"\nprimary = true\ntest = \"{test}\"\ncontrast = [\"sporty\", \"calm\"]\n"
            );
            let text = format!("{STUDY}{primary}[[covariate]]\ncolumn = \"age\"\n");
            fs::write(&path, text).unwrap();
            let frozen = freeze(Some(&path), "2026-11-22").map(|_| ());
            let described = stages::declare::describe(Some(&path), None).map(|_| ());
            [frozen, described].map(|done| done.map_err(|e| e.to_string()))
        };
        assert_eq!(declared("mixed"), [Ok(()), Ok(())]);
        for refused in declared("friedman") {
            let refused = refused.unwrap_err();
            assert!(
                refused.contains("`outcome[1].test`") && refused.contains("[[covariate]] `age`"),
                "{refused}"
            );
        }
        assert!(!lock.exists());
    }

    #[test]
    fn a_change_after_freezing_is_said_with_its_reason() {
        let (_folder, path) = frozen();
        assert_eq!(said(&path)[0], "*Analysed as declared on 2026-11-22.*");
        assert!(said(&path)[1].starts_with("*Of what this vouches*: that the design, "));
        let amended = STUDY.replace("= 300", "= 200");
        fs::write(&path, &amended).unwrap();
        assert_eq!(
            said(&path)[0],
            "*Not as declared on 2026-11-22.* `exclude.drive_shorter_than_s`: was 300, is 200: no reason was given."
        );
        assert!(said(&path)[1].contains(": that all else of the design, "));
        let why = "[amendments]\n\"exclude.drive_shorter_than_s\" = \"the route was shorter\"\n";
        fs::write(&path, format!("{amended}{why}")).unwrap();
        assert!(said(&path)[0].ends_with("is 200: the route was shorter."));
        assert!(freeze(Some(&path), "2026-11-23").is_err());
    }

    #[test]
    fn people_excluded_since_are_counted_and_not_named() {
        let (_folder, path) = frozen();
        let excluded = "people = { P04 = \"P04 felt sick\", P05 = \"left\" }\ndrives = { P06-calm = \"cut off\" }\n";
        for (amendments, reason) in [
            ("", "no reason was given"),
            ("exclude = \"agreed on\"\n", "agreed on"),
            (
                "\"exclude.people.P04\" = \"P04 asked for it\"\n\"exclude.drives\" = \"no road\"\n",
                "… asked for it; no reason was given for 1 person",
            ),
        ] {
            fs::write(&path, format!("{STUDY}{excluded}[amendments]\n{amendments}")).unwrap();
            let all = said(&path);
            let wanted = format!("`exclude.people`: was 0 people, is 2 people: {reason}.");
            assert!(all[0].ends_with(&wanted), "{all:?}");
            assert!(all[1].contains("`exclude.drives`: was 0 drives, is 1 drive: "), "{all:?}");
            assert!(!all.concat().contains("P0"), "{all:?}");
        }
    }

    #[test]
    fn other_people_excluded_since_are_a_change() {
        let (folder, path) = frozen();
        fs::remove_file(folder.path().join(LOCK_FILE)).unwrap();
        let excluding =
            |who: &str| fs::write(&path, format!("{STUDY}people = {{ {who} = \"sick\" }}\n"));
        excluding("P04").unwrap();
        freeze(Some(&path), "2026-11-22").unwrap();
        excluding("P05").unwrap();
        let all = said(&path);
        let wanted = "`exclude.people`: was 1 person, is 1 person, others or for other reasons: ";
        assert!(all[0].contains(wanted) && !all.concat().contains("P0"), "{all:?}");
    }

    #[test]
    fn a_questionnaire_or_mapping_that_changed_is_not_as_declared() {
        let (folder, path) = frozen();
        fs::write(folder.path().join("scales/comfort.toml"), "items = 3\nreversed = [2]\n")
            .unwrap();
        fs::write(folder.path().join("scales/new.toml"), "items = 1\n").unwrap();
        fs::remove_file(folder.path().join("mapping.toml")).unwrap();
        let all = said(&path);
        assert!(
            !all.iter()
                .any(|s| s.contains("as declared on 2026-11-22.*") && s.starts_with("*Analysed"))
        );
        let of = |file: &str| all.iter().find(|s| s.contains(&format!("`{file}`"))).cloned();
        assert!(of("scales/comfort.toml").unwrap().contains("no reason was given"));
        assert!(of("scales/new.toml").unwrap().contains("was not there"));
        assert!(of("mapping.toml").unwrap().contains("is not there"));
        let why = "[amendments]\n\"scales\" = \"a reversed item was overlooked\"\n";
        fs::write(&path, format!("{STUDY}{why}")).unwrap();
        let of_scale = said(&path).into_iter().find(|s| s.contains("comfort.toml")).unwrap();
        assert!(of_scale.ends_with("a reversed item was overlooked."), "{of_scale}");
    }

    #[test]
    fn another_version_of_the_numbers_is_not_as_declared() {
        let (_folder, path) = frozen();
        let lock = path.with_file_name(LOCK_FILE);
        let mut before: Frozen = toml::from_str(&fs::read_to_string(&lock).unwrap()).unwrap();
        before.stages.insert("score".to_owned(), "0".to_owned());
        before.seal = before.seal().unwrap();
        fs::write(&lock, toml::to_string(&before).unwrap()).unwrap();
        assert!(said(&path)[0].contains("`maveric score`: was 0, is "), "{:?}", said(&path));
    }

    #[test]
    fn a_lock_that_was_changed_vouches_for_nothing() {
        let (_folder, path) = frozen();
        let lock = path.with_file_name(LOCK_FILE);
        let text = fs::read_to_string(&lock).unwrap();
        // The hypothesis turned round in both files; zeros for the hash; another day; no day.
        let turned = text.replace("direction = \\\"+\\\"", "direction = \\\"-\\\"");
        let turned = turned.replace("direction = \"+\"", "direction = \"-\"");
        assert_ne!(turned, text);
        let frozen: Frozen = toml::from_str(&text).unwrap();
        let zeros = text.replace(&frozen.hash, &"0".repeat(64));
        let earlier = text.replace("2026-11-22", "2025-11-22");
        let no_day = text.replace("2026-11-22", "yesterday");
        for changed in [turned, zeros, earlier, no_day] {
            fs::write(&lock, changed).unwrap();
            let all = said(&path);
            assert!(all.len() == 1 && all[0].contains("vouches for nothing"), "{all:?}");
        }
        fs::write(&lock, text).unwrap();
        assert!(said(&path)[0].starts_with("*Analysed as declared"));
    }
}

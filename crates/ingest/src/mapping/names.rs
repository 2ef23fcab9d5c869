//! Ids from file names.

use crate::{
    error::IngestError,
    quality::{Warning, WarningKind},
};
use maveric_domain::{
    ConditionId, DomainError, DriveId, DriveMeta, DrivenBy, Occasion, ParticipantId,
    occasion::first,
};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::Path};

/// How a file's name says whose drive it is.
///
/// `file` is a pattern for the name without its extension, such as `pair_{run}_f{place}`: each name in braces
/// takes what stands there, up to the text that follows. `drive`, `participant` and `condition` are put together from these,
/// from the name of the folder that the file lies in, and from columns of the table that hold one word throughout. Of several sessions, and
/// of several drives of a condition within one, `{session}` and `{trial}` say which it is: whole numbers from 1.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Names {
    /// Pattern of the file's name.
    pub file: String,
    /// Pattern of the folder's name.
    #[serde(default)]
    pub folder: Option<String>,
    /// How the names of files end that are parts of one recording, such as `_part{n}` where `{n}` is the part's number. The first part may
    /// lack it. What is left of the name is the recording's, and that of the drive.
    #[serde(default)]
    pub parts: Option<String>,
    /// Name in braces → column of the table that holds it.
    #[serde(default)]
    pub columns: BTreeMap<String, String>,
    /// The drive's id.
    pub drive: String,
    /// The participant's id.
    pub participant: String,
    /// The condition, the baseline or the role: an id, or put together like the others.
    #[serde(default = "own")]
    pub condition: String,
    /// What files call conditions → their ids.
    #[serde(default)]
    pub words: BTreeMap<String, ConditionId>,
    /// Who drove.
    #[serde(default = "human")]
    pub driven_by: DrivenBy,
}

/// What a drive is called of which nothing is said: the person's own style by hand.
fn own() -> String {
    "own".to_owned()
}

fn human() -> DrivenBy {
    DrivenBy::Human
}

impl Names {
    /// The name of the recording that a file of this name is a part of, and the part's number; none where the name has none.
    pub(crate) fn part<'a>(&self, stem: &'a str) -> (&'a str, Option<u64>) {
        let numbered = || {
            let (before, behind) = self.parts.as_deref()?.split_once(NUMBER)?;
            let stem = stem.strip_suffix(behind)?;
            let without = stem.trim_end_matches(|c: char| c.is_ascii_digit());
            let number = stem.get(without.len()..)?.parse().ok()?;
            Some((without.strip_suffix(before).filter(|r| !r.is_empty())?, Some(number)))
        };
        numbered().unwrap_or((stem, None))
    }

    /// What the name of a part of a recording is expected to be.
    pub(crate) fn name_of_part(&self, recording: &str, number: u64) -> String {
        let ending = self.parts.as_deref().unwrap_or_default();
        format!("{recording}{}", ending.replace(NUMBER, &number.to_string()))
    }

    /// What is wrong with them.
    pub(super) fn check(&self) -> Result<(), String> {
        match self.parts.as_deref().map(|parts| parts.split_once(NUMBER)) {
            Some(Some((before, behind)))
                if !before.is_empty()
                    && !before.ends_with(|c: char| c.is_ascii_digit())
                    && !behind.contains(['{', '}']) =>
            {
                Ok(())
            }
            None => Ok(()),
            Some(_) => Err(format!(
                "`names.parts` is `{}`, expected the end of a file's name with `{NUMBER}` for the part's number and a text before it, such as `_part{NUMBER}`",
                self.parts.as_deref().unwrap_or_default()
            )),
        }
    }
}

/// What stands for the number of a part.
const NUMBER: &str = "{n}";

/// Whose drive a file is; `within` names one of several drives of it, such as by the vehicle's `id`, and may stand in the templates.
///
/// Without names, or with a warning where the pattern does not fit, the file's own name is the drive and the participant: a person
/// in their own style by hand.
///
/// # Errors
/// [`IngestError::Refused`] where a template makes no id.
pub(crate) fn meta_of(
    path: &Path,
    names: Option<&Names>,
    within: &[(String, String)],
    warnings: &mut Vec<Warning>,
) -> Result<DriveMeta, IngestError> {
    // A folder's name has no extension.
    let stem = if path.is_dir() { path.file_name() } else { path.file_stem() };
    let stem = stem.unwrap_or_default().to_string_lossy();
    let stem = names.map_or(&*stem, |names| names.part(&stem).0);
    let refused = |source: DomainError| IngestError::Refused { path: path.to_owned(), source };
    if let Some(names) = names
        && let Some(mut captures) = capture(&names.file, stem)
        && let Some(of_folder) = in_folder(names, path)
    {
        captures.extend(of_folder);
        captures.extend(within.iter().map(|(k, v)| (k.as_str(), v.as_str())));
        let captures: Vec<Capture> = captures.iter().map(|(k, v)| (*k, safe(v))).collect();
        let meta = DriveMeta::new(
            DriveId::new(fill(&names.drive, &captures)).map_err(refused)?,
            ParticipantId::new(fill(&names.participant, &captures)).map_err(refused)?,
            condition(names, &captures).map_err(refused)?,
            names.driven_by,
        );
        return Ok(meta.on(occasion(&captures).map_err(refused)?));
    }
    let parts = within.iter().flat_map(|(_, v)| ["-".to_owned(), safe(v)]);
    let tail: String = parts.collect();
    let tail: String = tail.chars().take(MOST_ID - 1).collect();
    // The end tells drives of one file apart, so the file's name gives way.
    let mut id: String = safe(stem).chars().take(MOST_ID - tail.len()).collect();
    id.push_str(&tail);
    if id.is_empty() {
        "drive".clone_into(&mut id);
    }
    if names.is_some() {
        let what = "the file's name does not fit the mapping's pattern: it is the drive's name";
        warnings.push(Warning::new(path, WarningKind::Default, 1, what));
    }
    Ok(DriveMeta::new(
        DriveId::new(id.clone()).map_err(refused)?,
        ParticipantId::new(id).map_err(refused)?,
        own().parse().map_err(refused)?,
        human(),
    ))
}

/// Whose drive a log is by its own name and its folder's; `None` where these do not say it, because a name does not fit the pattern or columns of
/// the table say it.
pub fn named_after(path: &Path, names: &Names) -> Option<DriveMeta> {
    let mut warnings = Vec::new();
    let meta = meta_of(path, Some(names), &[], &mut warnings).ok()?;
    (warnings.is_empty() && names.columns.is_empty()).then_some(meta)
}

/// What stands in the places of the pattern of the folder's name; nothing without a pattern, none where it does not fit.
fn in_folder<'a>(names: &'a Names, path: &'a Path) -> Option<Vec<(&'a str, &'a str)>> {
    match &names.folder {
        None => Some(Vec::new()),
        Some(pattern) => capture(pattern, path.parent()?.file_name()?.to_str()?),
    }
}

/// A name in braces, and what stands there.
type Capture<'a> = (&'a str, String);

fn condition(names: &Names, captures: &[Capture<'_>]) -> Result<ConditionId, DomainError> {
    let word = fill(&names.condition, captures);
    let by_word = names.words.get(&word);
    by_word.map_or_else(|| word.parse(), |id| Ok(*id))
}

/// The session and the trial: what stands in the places of these names, the first where there is no such place.
fn occasion(captures: &[Capture<'_>]) -> Result<Occasion, DomainError> {
    let number = |kind: &'static str| match captures.iter().find(|(name, _)| *name == kind) {
        None => Ok(first()),
        Some((_, found)) => {
            found.parse().map_err(|_| DomainError::BadNumber { kind, found: found.clone() })
        }
    };
    Ok(Occasion { session: number("session")?, trial: number("trial")? })
}

/// Length of an id.
const MOST_ID: usize = 64;

/// A text with `_` for what an id may not hold.
fn safe(text: &str) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    text.chars().map(|c| if allowed(c) { c } else { '_' }).collect()
}

/// Whether `name` fits a pattern in which `*` stands for any characters.
pub(crate) fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((head, tail)) => name.strip_prefix(head).is_some_and(|rest| {
            let mut starts = rest.char_indices().map(|(i, _)| i).chain([rest.len()]);
            starts.any(|i| matches(tail, &rest[i..]))
        }),
    }
}

/// What stands in the places of a pattern's braces; none where the text does not fit.
fn capture<'a>(pattern: &'a str, text: &'a str) -> Option<Vec<(&'a str, &'a str)>> {
    let mut captures = Vec::new();
    let (literal, mut pattern) = pattern.split_once('{').unwrap_or((pattern, ""));
    let mut text = text.strip_prefix(literal)?;
    while let Some((name, rest)) = pattern.split_once('}') {
        let (literal, after) = rest.split_once('{').unwrap_or((rest, ""));
        let end = if after.is_empty() && !rest.contains('{') {
            // The last place reaches to the end.
            text.len().checked_sub(literal.len())?
        } else {
            text.find(literal)?
        };
        let value = text.get(..end).filter(|v| !v.is_empty())?;
        captures.push((name, value));
        text = text.get(end..)?.strip_prefix(literal)?;
        pattern = after;
    }
    text.is_empty().then_some(captures)
}

fn fill(template: &str, captures: &[Capture<'_>]) -> String {
    captures.iter().fold(template.to_owned(), |text, (name, value)| {
        text.replace(&format!("{{{name}}}"), value)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_takes_up_to_the_text_that_follows() {
        let found = capture("oa_{run}_f{place}_{car}", "oa_0407_p10_f2_Audi_A6").unwrap();
        assert_eq!(found, [("run", "0407_p10"), ("place", "2"), ("car", "Audi_A6")]);
        let found: Vec<Capture> = found.iter().map(|(k, v)| (*k, safe(v))).collect();
        assert_eq!(fill("{run}-{place}", &found), "0407_p10-2");
        assert_eq!(capture("oa_{run}_f{place}", "other"), None);
        assert_eq!(capture("fixed", "fixed"), Some(vec![]));
    }

    #[test]
    fn a_star_stands_for_any_characters() {
        assert!(matches("*manifest*.csv", "my_manifest_2.csv"));
        assert!(!matches("manifest.csv", "manifest2.csv"));
    }

    #[test]
    fn the_condition_may_stand_in_the_files_name_the_folders_or_the_table() {
        let read = |text: &str| toml::from_str::<Names>(text).unwrap();
        let of = |names: &Names, within: &[(String, String)]| {
            let mut warnings = Vec::new();
            let path = Path::new("logs/calm/P07_B.csv");
            let meta = meta_of(path, Some(names), within, &mut warnings).unwrap();
            let told = warnings.is_empty();
            (meta.drive.to_string(), meta.condition.to_string(), told)
        };
        let file = read(
            "file = \"{who}_{condition}\"\ndrive = \"{who}-{condition}\"\nparticipant = \"{who}\"\ncondition = \"{condition}\"\nwords = { B = \"sporty\" }",
        );
        assert_eq!(of(&file, &[]), ("P07-B".to_owned(), "sporty".to_owned(), true));
        let folder = read(
            "file = \"{who}_{_}\"\nfolder = \"{condition}\"\ndrive = \"{who}-{condition}\"\nparticipant = \"{who}\"\ncondition = \"{condition}\"",
        );
        assert_eq!(of(&folder, &[]), ("P07-calm".to_owned(), "calm".to_owned(), true));
        let column = read(
            "file = \"{who}_{_}\"\ncolumns = { condition = \"car\" }\ndrive = \"{who}-{condition}\"\nparticipant = \"{who}\"\ncondition = \"{condition}\"",
        );
        let within = [("condition".to_owned(), "normal".to_owned())];
        assert_eq!(of(&column, &within), ("P07-normal".to_owned(), "normal".to_owned(), true));
        let other = read(
            "file = \"{who}_{_}\"\nfolder = \"run-{condition}\"\ndrive = \"{who}\"\nparticipant = \"{who}\"",
        );
        assert!(!of(&other, &[]).2);
    }

    #[test]
    fn session_and_trial_are_whole_numbers_from_1_and_the_first_where_nothing_says_them() {
        let names = |folder: &str| -> Names {
            let text = format!(
                "file = \"{{who}}_{{condition}}_{{trial}}\"\n{folder}drive = \"{{who}}-{{condition}}-{{trial}}\"\n\
                 participant = \"{{who}}\"\ncondition = \"{{condition}}\""
            );
            toml::from_str(&text).unwrap()
        };
        let of = |path: &str, folder: &str| {
            let meta = meta_of(Path::new(path), Some(&names(folder)), &[], &mut Vec::new());
            meta.map(|meta| meta.occasion()).map_err(|e| {
                let cause = std::error::Error::source(&e).map(ToString::to_string);
                format!("{e} {}", cause.unwrap_or_default())
            })
        };
        let session = "folder = \"day{session}\"\n";
        let on = |session, trial| Occasion::new(session, trial);
        assert_eq!(of("day2/P1_calm_02.csv", session).ok(), on(2, 2));
        assert_eq!(of("day2/P1_calm_3.csv", "").ok(), on(1, 3));
        for (path, kind, found) in [
            ("day2/P1_calm_0.csv", "trial", "`0`"),
            ("day2/P1_calm_-1.csv", "trial", "`-1`"),
            ("dayB/P1_calm_1.csv", "session", "`B`"),
        ] {
            let told = of(path, session).unwrap_err();
            assert!(
                told.contains(kind) && told.contains(found) && told.contains("from 1"),
                "{told}"
            );
        }
    }

    #[test]
    fn a_name_with_blanks_becomes_a_safe_id() {
        let path = Path::new("logs/my drive #1.mcap");
        let meta = meta_of(path, None, &[], &mut Vec::new()).unwrap();
        assert_eq!(meta.drive.as_str(), "my_drive__1");
    }
}

//! `design describe` and `design freeze`: the design as what was declared before looking.

use super::sample_size::sample_size;
use crate::{
    atomic_write::{atomic_write_bytes, read_text},
    design::DesignFile,
    error::StudyError,
    outcome::Outcome,
};
use maveric_domain::{
    Design,
    design::{Car, Claim, Compare, Condition, Mappings, Sign},
};
use maveric_measures::objective;
use path_slash::PathExt as _;
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    fmt::Write as _,
    path::{Path, PathBuf},
};

/// Name of a frozen design, beside the design.
pub const LOCK_FILE: &str = "study.lock";

/// A design as it was on a day.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frozen {
    /// The day, as `2026-11-22`.
    pub date: String,
    /// Version of the program.
    pub version: String,
    /// BLAKE3 of all else that stands here; of the design's text alone where no versions of commands are listed.
    pub hash: String,
    /// Answer files that were there already; none ought to be.
    pub answers: usize,
    /// Logs that were there already; none ought to be.
    pub logs: usize,
    /// The design's text.
    pub design: String,
    /// Every other file that decides a number, from the design's folder → BLAKE3 of what it holds.
    #[serde(default)]
    pub files: BTreeMap<String, String>,
    /// Versions of the program's commands, which go up where their numbers change; none in locks that cover the design alone.
    #[serde(default)]
    pub stages: BTreeMap<String, String>,
}

impl Frozen {
    /// The hash that belongs to what stands here.
    fn seal(&self) -> String {
        let text = if self.files.is_empty() && self.stages.is_empty() {
            self.design.clone()
        } else {
            let counts = (self.answers, self.logs);
            let (files, stages) = (&self.files, &self.stages);
            format!(
                "{:?}",
                (
                    &self.date,
                    &self.version,
                    counts,
                    &self.design,
                    files,
                    stages
                )
            )
        };
        blake3::hash(text.as_bytes()).to_hex().to_string()
    }

    /// Reads a lock.
    ///
    /// # Errors
    /// [`StudyError`] if it is no lock, its date is none, or it was changed since it was written.
    fn read(path: &Path) -> Result<Self, StudyError> {
        let frozen: Self =
            toml::from_str(&read_text(path)?).map_err(|e| StudyError::file(path, e.to_string()))?;
        let bad = |problem: String| StudyError::BadFile {
            path: path.to_owned(),
            problem,
            help: Some("put back the lock that `maveric design freeze` wrote".to_owned()),
        };
        if !is_a_day(&frozen.date) {
            let expected = "expected a day such as 2026-01-31";
            return Err(bad(format!("`date`: found `{}`, {expected}", frozen.date)));
        }
        let sealed = frozen.seal();
        if sealed != frozen.hash {
            return Err(bad(format!(
                "was changed since it was written: `hash` is `{}`, that of what stands there is `{sealed}`",
                frozen.hash
            )));
        }
        Ok(frozen)
    }
}

/// Whether a text is a day, as `2026-01-31`.
fn is_a_day(text: &str) -> bool {
    text.len() == 10 && text.parse::<toml::value::Datetime>().is_ok()
}

/// Hashes of every file beside the design that decides a number, by their paths from the design's folder.
fn deciding_files(study: &DesignFile) -> Result<BTreeMap<String, String>, StudyError> {
    let (design, files) = (&study.design, study.design.files());
    let mut paths: Vec<PathBuf> = match &files.mapping {
        Mappings::One(file) => vec![file.clone()],
        Mappings::Rigs(rigs) => rigs.iter().filter_map(|rig| rig.file.clone()).collect(),
    };
    paths.extend([files.scenario.clone(), "pipelines/study.toml".into()]);
    let named = files.columns.iter().chain(&files.effects);
    paths.extend(named.chain(&files.claims).cloned());
    paths.extend(design.model().map(|model| model.file.clone()));
    for condition in design.conditions() {
        if let Some(Car::Embedding(file)) = &condition.car {
            paths.push(file.clone());
        }
    }
    let scales = study.resolve(&files.scales);
    for entry in std::fs::read_dir(&scales).into_iter().flatten() {
        let entry = entry.map_err(StudyError::read(&scales))?.path();
        if entry.extension().is_some_and(|e| e == "toml") {
            paths.extend(entry.file_name().map(|name| files.scales.join(name)));
        }
    }
    let mut hashes = BTreeMap::new();
    for path in paths {
        let file = study.resolve(&path);
        if file.is_file() {
            let bytes = std::fs::read(&file).map_err(StudyError::read(&file))?;
            let hash = blake3::hash(&bytes).to_hex().to_string();
            hashes.insert(path.to_slash_lossy().into_owned(), hash);
        }
    }
    Ok(hashes)
}

/// The names under which two lists differ, with what stands in each.
fn differences<'a>(
    before: &'a BTreeMap<String, String>,
    now: &'a BTreeMap<String, String>,
) -> Vec<(&'a String, Option<&'a String>, Option<&'a String>)> {
    let fresh = now.keys().filter(|k| !before.contains_key(*k));
    let names = before.keys().chain(fresh);
    let rows = names.map(|name| (name, before.get(name), now.get(name)));
    rows.filter(|(_, was, is)| was != is).collect()
}

/// A design in plain English.
#[derive(Debug, Clone, Serialize)]
pub struct Described {
    /// Markdown, a section a heading.
    pub text: String,
}

/// The design in plain English, under the headings of a preregistration. The power of its tests is what a rehearsal found: `power`, or
/// `rehearsal/rehearsal.json` beside the design.
///
/// # Errors
/// [`StudyError`] if the design or the rehearsal cannot be read, or the rehearsal is of other outcomes or conditions.
///
/// # Source
/// Headings: the OSF Preregistration template and AsPredicted.
pub fn describe(
    design: Option<&Path>,
    power: Option<&Path>,
) -> Result<Outcome<Described>, StudyError> {
    let study = DesignFile::find(design)?;
    let text = text(&study.design, sample_size(&study, power)?);
    Ok(Outcome {
        summary: text.lines().map(str::to_owned).collect(),
        value: Described { text },
        warnings: Vec::new(),
    })
}

/// Writes `study.lock` beside the design; `date` is today's.
///
/// # Errors
/// [`StudyError`] if the design cannot be read, was frozen before, or the file cannot be written.
pub fn freeze(design: Option<&Path>, date: &str) -> Result<Outcome<Frozen>, StudyError> {
    let study = DesignFile::find(design)?;
    let Some(path) = &study.path else {
        return Err(StudyError::NotPossible {
            problem: "the paper's design is built in and cannot be frozen".to_owned(),
            help: Some("name a study's own: --design study.toml".to_owned()),
        });
    };
    let lock = path.with_file_name(LOCK_FILE);
    if lock.exists() {
        return Err(StudyError::BadFile {
            path: lock,
            problem: "the design was frozen before".to_owned(),
            help: Some(
                "a changed key is declared under `[amendments]` with its reason; the lock stays"
                    .to_owned(),
            ),
        });
    }
    if !is_a_day(date) {
        return Err(StudyError::NotPossible {
            problem: format!("`date`: found `{date}`, expected a day such as 2026-01-31"),
            help: None,
        });
    }
    let text = read_text(path)?;
    let files = study.design.files();
    let mut frozen = Frozen {
        date: date.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        hash: String::new(),
        answers: usize::from(study.resolve(&files.answers).is_file()),
        logs: count(&study.resolve(&files.logs)),
        design: text,
        files: deciding_files(&study)?,
        stages: super::versions(),
    };
    frozen.hash = frozen.seal();
    let toml = toml::to_string(&frozen)
        .map_err(|e| StudyError::file(&lock, format!("cannot be written: {e}")))?;
    atomic_write_bytes(&lock, toml.as_bytes())?;
    let mut warnings = Vec::new();
    if frozen.answers + frozen.logs > 0 {
        warnings.push(format!(
            "{} logs and {} files of answers are there already: the page will say so",
            frozen.logs, frozen.answers
        ));
    }
    Ok(Outcome {
        summary: vec![
            format!("frozen on {date}: {}", lock.to_slash_lossy()),
            format!(
                "register its hash where others keep the day: {}",
                frozen.hash
            ),
        ],
        value: frozen,
        warnings,
    })
}

/// Files below a folder.
fn count(folder: &Path) -> usize {
    let mut folders = vec![folder.to_owned()];
    let mut found = 0;
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(&folder)
            .into_iter()
            .flatten()
            .flatten()
            .map(|e| e.path())
        {
            if path.is_dir() {
                folders.push(path);
            } else {
                found += 1;
            }
        }
    }
    found
}

/// What the page says of the declaration: one sentence, or one a difference; nothing where the design was never frozen.
///
/// # Errors
/// [`StudyError`] if the lock or the design cannot be read.
pub(crate) fn declared(study: &DesignFile) -> Result<Vec<String>, StudyError> {
    let Some(path) = &study.path else {
        return Ok(Vec::new());
    };
    let lock = path.with_file_name(LOCK_FILE);
    if !lock.is_file() {
        return Ok(Vec::new());
    }
    let bad = |path: &PathBuf| {
        let path = path.clone();
        move |e: toml::de::Error| StudyError::file(&path, e.to_string())
    };
    let frozen = Frozen::read(&lock)?;
    let before: toml::Table = toml::from_str(&frozen.design).map_err(bad(&lock))?;
    let now: toml::Table = toml::from_str(&read_text(path)?).map_err(bad(path))?;
    let (before, now) = (leaves(before), leaves(now));
    let mut changed = Vec::new();
    for key in before
        .keys()
        .chain(now.keys().filter(|k| !before.contains_key(*k)))
    {
        if key.starts_with("amendments.") || before.get(key) == now.get(key) {
            continue;
        }
        let value = |of: &BTreeMap<String, String>| {
            of.get(key)
                .cloned()
                .unwrap_or_else(|| "not there".to_owned())
        };
        let reason = study.design.amendments().iter().find(|(k, _)| {
            let below = key.strip_prefix(k.as_str());
            below.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        });
        let reason = reason.map_or("no reason was given", |(_, why)| why);
        changed.push(format!(
            "*Not as declared on {}.* `{key}`: was {}, is {}: {reason}.",
            frozen.date,
            value(&before),
            value(&now)
        ));
    }
    let whole = !frozen.stages.is_empty();
    if whole {
        for (name, was, is) in differences(&frozen.files, &deciding_files(study)?) {
            let what = match (was, is) {
                (_, None) => "is no longer there",
                (None, _) => "was not there",
                _ => "holds something else",
            };
            let why = study.design.amendments().get(name);
            let why = why.map_or("no reason was given", String::as_str);
            changed.push(format!(
                "*Not as declared on {}.* The file `{name}` {what}: {why}.",
                frozen.date
            ));
        }
        for (name, was, is) in differences(&frozen.stages, &super::versions()) {
            let version = |v: Option<&String>| v.map_or("none", String::as_str).to_owned();
            let (was, is) = (version(was), version(is));
            changed.push(format!(
                "*Not as declared on {}.* The program's command `{name}` was version {was}, is {is}.",
                frozen.date
            ));
        }
    }
    if changed.is_empty() {
        changed.push(format!("*Analysed as declared on {}.*", frozen.date));
    }
    let scope = if whole {
        "the design, the files beside it that decide a number and the versions of the program's commands"
    } else {
        "the design's text alone, made by an earlier version: not for scales, mapping or scenario"
    };
    changed.push(format!(
        "*The declaration* vouches for {scope}. A file of one's own is no time stamp: its hash, `{}`, shows the day where others registered it.",
        frozen.hash
    ));
    if frozen.answers + frozen.logs > 0 {
        changed.push(format!(
            "*When it was declared*, {} logs and {} files of answers were there already.",
            frozen.logs, frozen.answers
        ));
    }
    Ok(changed)
}

/// The leaves of a file, each under its path.
fn leaves(table: toml::Table) -> BTreeMap<String, String> {
    fn add(path: &str, value: &toml::Value, found: &mut BTreeMap<String, String>) {
        match value {
            toml::Value::Table(table) => {
                for (key, value) in table {
                    let path = if path.is_empty() {
                        key.clone()
                    } else {
                        format!("{path}.{key}")
                    };
                    add(&path, value, found);
                }
            }
            toml::Value::Array(rows) if rows.iter().all(toml::Value::is_table) => {
                for (at, row) in rows.iter().enumerate() {
                    let id = row.get("id").and_then(toml::Value::as_str);
                    let name = id.map_or_else(
                        || format!("{path}[{}]", at + 1),
                        |id| format!("{path}.{id}"),
                    );
                    add(&name, row, found);
                }
            }
            leaf => {
                found.insert(path.to_owned(), leaf.to_string());
            }
        }
    }
    let mut found = BTreeMap::new();
    add("", &toml::Value::Table(table), &mut found);
    found
}

fn text(design: &Design, sample_size: Vec<String>) -> String {
    let mut out = format!("# {}\n", design.title());
    let mut section = |title: &str, lines: Vec<String>| {
        let _ = write!(out, "\n## {title}\n\n");
        for line in lines {
            let _ = writeln!(out, "- {line}");
        }
    };
    section("Hypotheses", hypotheses(design));
    section(
        "Conditions",
        design
            .conditions()
            .iter()
            .map(|c| condition(design, c))
            .chain(baseline(design))
            .collect(),
    );
    section("Participants", people(design));
    section("Sample size", sample_size);
    section("Measured variables", outcomes(design));
    section("Analyses", analyses(design));
    section("Exclusions", exclusions(design));
    out
}

fn hypotheses(design: &Design) -> Vec<String> {
    let one = |h: &maveric_domain::design::Hypothesis| {
        let [first, second] = h.contrast.map(|c| design.label(c));
        let rule = match h.claim {
            Claim::Direction(sign) => format!(
                "{first} {} {second} (two-sided p < .05 after Holm)",
                if sign == Sign::Plus {
                    "lies above"
                } else {
                    "lies below"
                }
            ),
            Claim::Equivalent([low, high]) => {
                format!(
                    "{first} minus {second} lies between {low} and {high} (two one-sided tests)"
                )
            }
        };
        format!("{} In {}: {rule}.", sentence(&h.says), h.outcome)
    };
    let found: Vec<String> = design.hypotheses().iter().map(one).collect();
    or_none(
        found,
        "No hypothesis is declared: every analysis is exploratory.",
    )
}

fn sentence(text: &str) -> String {
    format!("{}.", text.trim().trim_end_matches('.'))
}

fn or_none(found: Vec<String>, none: &str) -> Vec<String> {
    if found.is_empty() {
        vec![none.to_owned()]
    } else {
        found
    }
}

fn condition(design: &Design, c: &Condition) -> String {
    let dial = design.style().map_or("the style", |s| s.label.as_str());
    let car = match &c.car {
        None => "driven by the laboratory's own car or rig; its recordings are read".to_owned(),
        Some(Car::Dial(0.0)) => "a car with the participant's own learned style".to_owned(),
        Some(Car::Dial(points)) => {
            format!(
                "a car with the participant's learned style moved by {points:+} points of {dial}"
            )
        }
        Some(Car::Across) => {
            format!("a car with a style that differs from the participant's, but not in {dial}")
        }
        Some(Car::Mean) => {
            "a car that drives as the average of the drivers learned from".to_owned()
        }
        Some(Car::Embedding(path)) => format!("a car with the style in {}", path.to_slash_lossy()),
        Some(_) => format!("a car whose {dial} the participant turns while riding"),
    };
    let levels: Vec<String> = c.levels.iter().map(|(f, l)| format!("{f}: {l}")).collect();
    let levels = if levels.is_empty() {
        String::new()
    } else {
        format!(" ({})", levels.join(", "))
    };
    format!("{} (`{}`): {car}{levels}.", c.label, c.id)
}

fn baseline(design: &Design) -> Option<String> {
    let baseline = design.baseline()?;
    Some(format!(
        "Baseline: {} (`{}`), from which the differences of measures are taken.",
        baseline.label, baseline.id
    ))
}

fn people(design: &Design) -> Vec<String> {
    let wanted = |cells: &Option<BTreeMap<String, String>>| {
        let cells = cells.as_ref()?.iter().map(|(k, v)| format!("{k} = {v}"));
        Some(cells.collect::<Vec<_>>().join(" and "))
    };
    let mut lines = Vec::new();
    if let Some(learn) = wanted(&design.people().learn) {
        lines.push(format!("Learned from: those with {learn}."));
    }
    lines.push(wanted(&design.people().test).map_or_else(
        || "Tested: everybody who is not learned from.".to_owned(),
        |test| format!("Tested: those with {test}."),
    ));
    for factor in design.factors() {
        lines.push(format!("Groups by `{}`.", factor.column));
    }
    lines
}

fn outcomes(design: &Design) -> Vec<String> {
    let one = |o: &maveric_domain::design::Outcome| {
        let id = o.id();
        let known = objective::find(&id);
        let label = o
            .label
            .clone()
            .or_else(|| known.map(|m| m.title.to_owned()));
        let what = known.map_or_else(String::new, |m| format!(": {}", m.description));
        let same = o.same_within.map_or_else(String::new, |w| {
            format!(" Differences of at most {w} count as none.")
        });
        match label {
            Some(label) => format!("{label} (`{id}`){what}{same}"),
            None => format!("`{id}`{what}{same}"),
        }
    };
    let found = design.outcomes().iter().map(one).collect();
    or_none(
        found,
        "All objective measures, and every scale that is asked after a condition.",
    )
}

fn analyses(design: &Design) -> Vec<String> {
    let compared = match design.compare() {
        Compare::All => "Every condition is compared with every other".to_owned(),
        Compare::Against(one) => format!("Every condition is compared with {}", design.label(*one)),
        Compare::Pairs(_) => {
            let pairs: Vec<String> = design
                .contrasts()
                .iter()
                .map(|[a, b]| format!("{} with {}", design.label(*a), design.label(*b)))
                .collect();
            format!("Compared are {}", pairs.join(", "))
        }
    };
    let mut lines = vec![format!(
        "{compared}, with Holm's correction over the contrasts of an outcome."
    )];
    lines.push(if design.conditions().len() > 2 {
        "Each outcome: repeated-measures ANOVA (degrees of freedom corrected after Greenhouse and Geisser or Huynh and Feldt) and paired t tests where the \
         residuals look normal (Shapiro-Wilk, .05), else Friedman's test and Wilcoxon's."
            .to_owned()
    } else {
        "Each outcome: a paired t test where the differences look normal (Shapiro-Wilk, .05), else Wilcoxon's test.".to_owned()
    });
    if !design.factors().is_empty() {
        lines.push("With groups, each outcome is tested within each group; the correction counts all groups.".to_owned());
    }
    if let Some(family) = design.homophily() {
        let ratings: Vec<String> = family.ratings.iter().map(ToString::to_string).collect();
        lines.push(format!(
            "One family of correlations: {} against the differences in {} between the own style and each shifted one, with Holm's correction and the false \
             discovery rate.",
            family.factors.join(", "),
            ratings.join(", ")
        ));
    }
    lines.push("Whatever else the page shows is exploratory.".to_owned());
    lines
}

fn exclusions(design: &Design) -> Vec<String> {
    let rules = design.exclude();
    let mut lines = Vec::new();
    if let Some(seconds) = rules.drive_shorter_than_s {
        lines.push(format!(
            "Drives shorter than {seconds} s, with what was said of them."
        ));
    }
    if rules.straight_lined {
        lines.push(
            "People who gave one answer to every item of a questionnaire that has reversed items."
                .to_owned(),
        );
    }
    if let Some(n) = rules.fewer_conditions_than {
        lines.push(format!("People with fewer than {n} conditions."));
    }
    for (who, why) in &rules.people {
        lines.push(format!("{who}: {}", sentence(why)));
    }
    for (drive, why) in &rules.drives {
        lines.push(format!("Drive {drive}: {}", sentence(why)));
    }
    lines.push(
        "A person without a value in a condition is left out of that outcome and named.".to_owned(),
    );
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    const STUDY: &str = "[study]\ntitle = \"Calm or sporty\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n\
                         [baseline]\nid = \"own\"\n[[hypothesis]]\nsays = \"Sporty is faster\"\noutcome = \"mean_velocity_mps\"\n\
                         contrast = [\"sporty\", \"calm\"]\ndirection = \"+\"\n[exclude]\ndrive_shorter_than_s = 300\n";

    #[test]
    fn a_design_reads_as_a_preregistration() {
        let text = text(&Design::from_toml(STUDY).unwrap(), Vec::new());
        for said in [
            "## Hypotheses\n\n- Sporty is faster. In mean_velocity_mps: sporty lies above calm",
            "- calm (`calm`): driven by the laboratory's own car",
            "Drives shorter than 300 s",
            "a paired t test",
        ] {
            assert!(text.contains(said), "{said} in {text}");
        }
    }

    #[test]
    fn a_change_after_freezing_is_said_with_its_reason() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        std::fs::write(&path, STUDY).unwrap();
        let frozen = freeze(Some(&path), "2026-11-22").unwrap().value;
        assert_eq!((frozen.answers, frozen.logs), (0, 0));
        let said = || declared(&DesignFile::read(&path).unwrap()).unwrap();
        assert_eq!(said()[0], "*Analysed as declared on 2026-11-22.*");
        assert!(said()[1].contains("no time stamp"));
        let amended = STUDY.replace("= 300", "= 200");
        std::fs::write(&path, &amended).unwrap();
        assert_eq!(
            said()[0],
            "*Not as declared on 2026-11-22.* `exclude.drive_shorter_than_s`: was 300, is 200: no reason was given."
        );
        let why = "[amendments]\n\"exclude.drive_shorter_than_s\" = \"the route was shorter\"\n";
        std::fs::write(&path, format!("{amended}{why}")).unwrap();
        assert!(said()[0].ends_with("is 200: the route was shorter."));
        assert!(freeze(Some(&path), "2026-11-23").is_err());
    }

    #[test]
    fn a_file_that_decides_a_number_is_covered_and_a_lock_changed_by_hand_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        let lock = folder.path().join(LOCK_FILE);
        let scale = folder.path().join("scales/comfort.toml");
        std::fs::create_dir_all(scale.parent().unwrap()).unwrap();
        std::fs::write(&path, STUDY).unwrap();
        std::fs::write(&scale, "reversed = []\n").unwrap();
        let study = DesignFile::read(&path).unwrap();
        assert!(freeze(Some(&path), "yesterday").is_err() && !lock.exists());
        freeze(Some(&path), "2026-11-22").unwrap();
        std::fs::write(&scale, "reversed = [1]\n").unwrap();
        assert_eq!(
            declared(&study).unwrap()[0],
            "*Not as declared on 2026-11-22.* The file `scales/comfort.toml` holds something else: no reason was given."
        );
        let text = std::fs::read_to_string(&lock).unwrap();
        for (from, to) in [
            ("\"+\"", "\"-\""),
            ("2026-11-22", "2026-11-21"),
            ("2026-11-22", "yesterday"),
        ] {
            assert!(text.contains(from), "{from} in {text}");
            std::fs::write(&lock, text.replace(from, to)).unwrap();
            assert!(declared(&study).is_err(), "{from} to {to}");
        }
    }

    #[test]
    fn a_lock_of_an_earlier_version_says_that_it_covers_the_design_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        std::fs::write(&path, STUDY).unwrap();
        let lock = Frozen {
            date: "2026-11-01".to_owned(),
            version: "0.1.0".to_owned(),
            hash: blake3::hash(STUDY.as_bytes()).to_hex().to_string(),
            answers: 0,
            logs: 0,
            design: STUDY.to_owned(),
            files: BTreeMap::new(),
            stages: BTreeMap::new(),
        };
        let lock = toml::to_string(&lock).unwrap();
        std::fs::write(folder.path().join(LOCK_FILE), lock).unwrap();
        let lines = declared(&DesignFile::read(&path).unwrap()).unwrap();
        assert_eq!(lines[0], "*Analysed as declared on 2026-11-01.*");
        assert!(lines[1].contains("the design's text alone"), "{lines:?}");
    }
}

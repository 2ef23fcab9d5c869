//! `init`: the folder of a study of one's own.

mod study_text;

use crate::{
    aside::Aside,
    atomic_write::atomic_write_bytes,
    design::DESIGN_FILE,
    error::StudyError,
    outcome::{Outcome, Watch},
    stage::{Files, Stage},
};
use maveric_domain::{
    ConditionId, Scale, ScoreRange,
    design::{DesignError, ScoreName},
};
use path_slash::PathExt as _;
use serde::Serialize;
use std::path::{Path, PathBuf};
use study_text::{DialledScore, Wanted, study_text};

const FOLDERS: [&str; 2] = ["logs", "surveys"];

/// Name and text of the files of every study, beside the questionnaires.
const FILES: [(&str, &str); 4] = [
    ("README.md", include_str!("init/README.md")),
    ("consent.md", include_str!("init/consent.md")),
    ("mapping.toml", include_str!("init/mapping.toml")),
    ("surveys/columns.toml", include_str!("init/columns.toml")),
];

/// The world: that of the seat where people drive, that of the paper where they are made up.
fn scenario(synthetic: bool) -> (&'static str, &'static str) {
    let text = if synthetic { maveric_data::SCENARIOS_PAPER } else { maveric_data::SCENARIOS_SEAT };
    ("scenario.toml", text)
}

/// Name and text of the questionnaires: all that are shipped.
fn scales() -> impl Iterator<Item = (&'static str, &'static str)> {
    let below = |(path, text): &(&'static str, &'static str)| {
        let name = path.strip_prefix("study_data/")?;
        name.starts_with("scales/").then_some((name, *text))
    };
    maveric_data::FILES.iter().filter_map(below)
}

/// Name and text of those that are asked for beside them.
fn further_scales(ids: &[String]) -> Result<Vec<(&'static str, &'static str)>, StudyError> {
    let below = |(path, text): &(&'static str, &'static str)| {
        let name = path.strip_prefix("study_data/further_")?;
        Some((name, *text))
    };
    let shipped: Vec<_> = maveric_data::FILES.iter().filter_map(below).collect();
    let scale = |id: &String| {
        let file = format!("scales/{id}.toml");
        let known = || {
            let names = shipped.iter().map(|(name, _)| *name);
            names.filter_map(|name| name.strip_prefix("scales/")?.strip_suffix(".toml"))
        };
        let shipped_scale = shipped.iter().find(|(name, _)| *name == file);
        shipped_scale.copied().ok_or_else(|| refused(DesignError::word("--scales", id, known())))
    };
    ids.iter().map(scale).collect()
}

/// A word that is refused, with what is possible.
#[expect(clippy::needless_pass_by_value, reason = "`map_err` gives it away")]
fn refused(error: DesignError) -> StudyError {
    StudyError::NotPossible { problem: error.to_string(), help: error.suggestion() }
}

const EFFECTS: (&str, &str) = ("effects.toml", maveric_data::EFFECTS);
/// Those of the paper's study.
const CLAIMS: (&str, &str) = ("claims.toml", maveric_data::CLAIMS);
/// What a person meets in the seat, for the paper's study: every scale that its design reads.
const PAPERS_PROTOCOL: &str = "
[protocol]                             # what a person meets in the seat (`maveric seat`); of no matter for logs of your own
consent = \"consent.md\"
before = [\"adb\", \"mini_ipip\", \"mdsi\"]  # the file of each needs `wording`
after = [\"aggressiveness\", \"rosas\", \"godspeed_intelligence\", \"jian_trust\", \"similarity\"]
# language = \"de\"                      # what the seat says by itself: en (default) or de
# withdraw_until = \"2027-01-31\"        # last day on which people can take back what they gave
";

/// Make the folder of a study of your own: its design, scales, a mapping, and what goes where
#[derive(Debug, Clone, Default, clap::Args)]
#[command(after_help = "\
Examples: maveric init my_study                                                     the paper's study, for recordings of your own
          maveric init --paper                                                      here, the paper's study as shipped: made-up people, ready to run
          maveric init my_study --conditions calm,normal,sporty --style none        cars of your own, only their logs are read
          maveric init my_study --conditions calm,sporty --style mdsi.risky         a dial of another score
          maveric init my_study --conditions calm,sporty --synthetic                to rehearse with made-up people")]
pub struct Init {
    /// The folder; not there yet, or empty; the one you stand in when not given
    #[arg(default_value = ".")]
    pub folder: PathBuf,
    /// The conditions, in the order of the page; the paper's study when not given
    #[arg(long, value_delimiter = ',', value_name = "IDS")]
    pub conditions: Vec<String>,
    /// The score that the dial turns, or none where every car was recorded; adb.total when not given
    #[arg(long, value_name = "none|SCALE.SUBSCALE", requires = "conditions")]
    pub style: Option<String>,
    /// Further questionnaires to put into scales/: acceptance, attention, demographics, misc, nasa_tlx, purpose, ssq, sts_ad
    #[arg(long, value_delimiter = ',', value_name = "IDS")]
    pub scales: Vec<String>,
    /// The people will be made up
    #[arg(long)]
    pub synthetic: bool,
    /// The paper's study as this program ships it, with made-up people: pipelines, design, scales, scenarios
    #[arg(long, conflicts_with_all = ["conditions", "style", "scales", "synthetic"])]
    pub paper: bool,
}

#[derive(Debug, Clone, Serialize)]
pub struct Initialised {
    /// Files written, below the folder.
    pub files: Vec<String>,
}

impl Stage for Init {
    const NAME: &'static str = "init";
    const FAILURE: &'static str = "could not make the study's folder";
    type Result = Initialised;

    fn files(&self, _root: &Path) -> Result<Files, StudyError> {
        Ok(Files::default().writes([&self.folder]))
    }

    /// Makes the folder of a study: its design to fill in, the scales, a mapping, and a README that says what goes where. Without
    /// conditions it is the paper's study, for recordings of one's own; as `paper`, what is shipped, in which the pipelines run.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Initialised>, StudyError> {
        let folder = &self.folder;
        let (design, people);
        let (files, folders) = if self.paper {
            (maveric_data::FILES.to_vec(), &[][..])
        } else {
            (design, people) = texts(self)?;
            let mut files = own_files(self, &design, people);
            files.extend(further_scales(&self.scales)?);
            (files, &FOLDERS[..])
        };
        std::fs::create_dir_all(folder).map_err(StudyError::write(folder))?;
        // What a killed call left of a folder goes here.
        let aside = Aside::new(folder)?;
        for entry in std::fs::read_dir(folder).map_err(StudyError::read(folder))? {
            if entry.map_err(StudyError::read(folder))?.path().file_name()
                != aside.path().file_name()
            {
                let problem = "is not empty, expected a new or an empty folder";
                let help = "choose another name; nothing is overwritten";
                return Err(StudyError::file(folder, problem).with_help(help));
            }
        }
        let fresh = aside.path().join("study");
        for name in folders {
            let path = fresh.join(name);
            std::fs::create_dir_all(&path).map_err(StudyError::write(&path))?;
        }
        for (name, text) in &files {
            watch.check()?;
            atomic_write_bytes(&fresh.join(name), text.as_bytes())?;
        }
        for entry in std::fs::read_dir(&fresh).map_err(StudyError::read(&fresh))? {
            let entry = entry.map_err(StudyError::read(&fresh))?;
            let place = folder.join(entry.file_name());
            std::fs::rename(entry.path(), &place).map_err(StudyError::write(&place))?;
        }
        let next = if self.paper {
            "there: maveric run, or small and quick maveric run pipelines/smoke.toml".to_owned()
        } else {
            let readme = folder.join("README.md");
            format!(
                "read {}, fill in {DESIGN_FILE} and the folder, then there: maveric run",
                readme.to_slash_lossy(),
            )
        };
        let summary = vec![format!("a study's folder: {}", folder.to_slash_lossy()), next];
        let value =
            Initialised { files: files.iter().map(|(name, _)| (*name).to_owned()).collect() };
        Ok(Outcome::new(value, summary, Vec::new()))
    }
}

/// The files of a study of one's own.
fn own_files<'a>(options: &Init, design: &'a str, people: &'a str) -> Vec<(&'a str, &'a str)> {
    let mut files: Vec<(&str, &str)> = FILES.into_iter().chain(scales()).collect();
    files.push(scenario(options.synthetic));
    files.push((DESIGN_FILE, design));
    files.push(("participants.csv", people));
    if options.synthetic || options.conditions.is_empty() {
        files.push(EFFECTS);
    }
    if options.conditions.is_empty() {
        files.push(CLAIMS);
    }
    files
}

/// The design, and the header of the table of people.
fn texts(options: &Init) -> Result<(String, &'static str), StudyError> {
    if options.conditions.is_empty() {
        let software = if options.synthetic {
            "software = \"table\""
        } else {
            "software = \"otree\" # the seat writes \"table\": then leave this and the next line out\ncolumns = \"surveys/columns.toml\""
        };
        let paper = maveric_data::DESIGNS_PAPER
            .replace("\"../scales\"", &format!("\"scales\"\n{software}"))
            .replace("../scenarios/paper.toml", "scenario.toml")
            .replace("../", "")
            .replace("synthetic = true ", &format!("synthetic = {} ", options.synthetic));
        return Ok((
            paper + PAPERS_PROTOCOL,
            "participant,study,population,age,gender,professional,order\n",
        ));
    }
    let mut conditions = Vec::new();
    for word in &options.conditions {
        let id: ConditionId = word.trim().parse()?;
        if conditions.contains(&id) {
            let twice = format!("`{id}` twice");
            return Err(refused(DesignError::key("--conditions", twice, "each once")));
        }
        conditions.push(id);
    }
    let style = match options.style.as_deref().unwrap_or("adb.total") {
        "none" => None,
        name => Some(score(name).map_err(refused)?),
    };
    let text = study_text(&Wanted {
        conditions: &conditions,
        style: style.as_ref(),
        sickness_after: options.scales.iter().any(|id| id == "ssq"),
        synthetic: options.synthetic,
    });
    let people = if style.is_some() {
        "participant,part,population,age,gender,professional,order\n"
    } else {
        "participant,population,age,gender,order\n"
    };
    Ok((text, people))
}

/// A score of a shipped scale, with its range and its name.
fn score(name: &str) -> Result<DialledScore, DesignError> {
    let scales: Vec<Scale> = scales().filter_map(|(_, text)| Scale::from_toml(text).ok()).collect();
    if let Ok(score) = name.parse::<ScoreName>()
        && let Some(scale) = scales.iter().find(|scale| score.scale == scale.id)
        && let Some(subscale) = scale.subscales.iter().find(|s| score.subscale == s.id)
        && let Ok(range) = ScoreRange::try_from(<[f64; 2]>::from(scale.score_range(subscale)))
    {
        return Ok(DialledScore {
            label: format!("{} score", subscale.title.to_lowercase()),
            range,
            score,
        });
    }
    let names: Vec<String> = scales.iter().flat_map(Scale::score_names).collect();
    let known = ["none"].into_iter().chain(names.iter().map(String::as_str));
    Err(DesignError::word("--style", name, known))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_papers_study_in_a_folder_of_its_own_is_a_design_with_files_below_it() {
        let (text, _) = texts(&Init::default()).unwrap();
        let design = maveric_domain::Design::from_toml(&text).unwrap();
        assert_eq!(design.files().scales, PathBuf::from("scales"));
        assert_eq!(design.files().claims, Some(PathBuf::from("claims.toml")));
        assert!(!design.synthetic() && !text.contains(".."));
        let protocol = design.protocol();
        let asked = || protocol.before.iter().chain(&protocol.after);
        let shipped: BTreeSet<String> =
            scales().filter_map(|(_, text)| Some(Scale::from_toml(text).ok()?.id)).collect();
        assert!(asked().all(|scale| shipped.contains(scale)), "{protocol:?}");
        assert!(protocol.before.contains(&"adb".to_owned()));
        assert_eq!(protocol.consent, Some(PathBuf::from("consent.md")));
    }

    #[test]
    fn a_call_that_was_killed_leaves_a_folder_in_which_the_next_one_works() {
        let folder = tempfile::tempdir().unwrap();
        let left = folder.path().join(".maveric-aside-left");
        std::fs::create_dir(&left).unwrap();
        std::fs::write(left.join("in-use"), "").unwrap();
        let options = Init { folder: folder.path().to_owned(), ..Init::default() };
        options.run(Watch::unwatched()).unwrap();
        let names: BTreeSet<String> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        assert!(names.contains(DESIGN_FILE) && names.iter().all(|n| !n.starts_with(".maveric")));
        let error = options.run(Watch::unwatched()).unwrap_err();
        assert!(error.to_string().contains("is not empty"), "{error}");
    }

    #[test]
    fn further_scales_stand_beside_the_others_and_an_unknown_one_is_named_with_the_nearest() {
        let files = further_scales(&["ssq".to_owned(), "nasa_tlx".to_owned()]).unwrap();
        let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["scales/ssq.toml", "scales/nasa_tlx.toml"]);
        assert!(files[0].1.contains("id = \"ssq\""));
        assert!(scales().all(|(name, _)| !names.contains(&name)));
        let error = further_scales(&["nasa_tlxx".to_owned()]).unwrap_err();
        assert!(error.suggestion().unwrap().contains("`nasa_tlx`"), "{error}");
    }

    #[test]
    fn a_style_that_no_scale_has_is_named_with_the_nearest() {
        let options = Init {
            conditions: vec!["calm".to_owned()],
            style: Some("mdsi.riskyy".to_owned()),
            ..Init::default()
        };
        let error = texts(&options).unwrap_err();
        assert!(error.to_string().contains("`--style`: found `mdsi.riskyy`"), "{error}");
        assert_eq!(error.suggestion().unwrap(), "did you mean `mdsi.risky`?");
    }
}

//! The pipeline that follows from a design: its stages as a pipeline file, to be run or to be changed.

use crate::{
    design::{DESIGN_FILE, DesignFile},
    stages::ingest::{Ingest, logs_of_study},
    tables::surveys::read_answered,
    texts,
};
use maveric_domain::{
    Design, Moment, Ride,
    design::{By, Condition, Software},
};
use minijinja::{Value, context};
use path_slash::PathExt as _;
use std::path::Path;

/// The text of the pipeline that brings a study up to date, from logs and answers to the page. Its paths start at the folder of
/// `study.toml`, where it runs.
///
/// There are only the stages that the design asks for: nothing is learned without a car that was learned, nothing simulated that
/// was recorded, nothing rated by people who exist. Where some data are there and others are not (no logs yet, no answers), what needs
/// the others is left out; before there are any, all stages stand in it.
pub fn design_pipeline(study: &DesignFile) -> String {
    let design = &study.design;
    let simulates = design.conditions().iter().any(Condition::simulated);
    let there = Data::for_study(study);
    let needs_model = design.needs_a_model() && there.logs;
    let simulates = simulates && there.logs;
    let by_hand = design.baseline().is_some_and(|b| b.by == By::Hand);
    // The answers that an export of made-up people has are ratings too.
    let made_up_ratings = design.synthetic()
        && simulates
        && by_hand
        && !is_rated(design, &study.resolve(&design.files().answers));
    let paths = paths(study, simulates);
    let given = paths.iter().map(|(name, _)| (*name, Value::from(true)));
    let values = context! {
        design => DESIGN_FILE,
        title => design.title().replace(['\n', '\r'], " "),
        software => Some(design.files().software).filter(|s| *s != Software::Table).map(Software::id),
        // What the seat draws and what a run draws are the same.
        seed => design.protocol().seed,
        simulates,
        logs => there.logs,
        answers_there => there.answers || needs_model,
        measures => there.logs || there.measures,
        needs_model,
        learns => needs_model && design.model().is_none(),
        style => design.style().is_some(),
        made_up_ratings,
        given => Value::from_pairs(given),
        paths,
    };
    texts::fill(texts::PIPELINE, values)
}

/// Which data of a study are there.
struct Data {
    logs: bool,
    answers: bool,
    measures: bool,
}

impl Data {
    /// Of a study without any everything is awaited: its first stage then says what it looked for.
    fn for_study(study: &DesignFile) -> Self {
        let (design, files) = (&study.design, study.design.files());
        let is_file = |path: &Path| study.resolve(path).is_file();
        // A mapping that is none is for the stage to say.
        let logs = logs_of_study(&Ingest::default(), study).map_or(true, |logs| !logs.is_empty());
        let there = Self {
            logs,
            answers: is_file(&files.answers),
            measures: !design.measures().is_empty() && is_file(&files.measures),
        };
        if there.logs || there.answers || there.measures {
            there
        } else {
            Self { logs: true, answers: true, measures: false }
        }
    }
}

/// Whether a table of answers has any that was given after a condition, and not after a role of its name; what is no such table is for the
/// stage to say.
fn is_rated(design: &Design, answers: &Path) -> bool {
    let answered = answers.is_file().then(|| read_answered(answers));
    let Some(Ok(answered)) = answered else {
        return false;
    };
    let is_rating = |moment: Moment| match moment {
        Moment::After(Ride { condition, .. }) => {
            design.condition(condition).is_some() && design.role(condition).is_none()
        }
        _ => false,
    };
    answered.answers.iter().any(|a| is_rating(a.moment))
}

/// A path as it stands in a pipeline file.
fn quoted(path: &Path) -> String {
    format!("{:?}", path.to_slash_lossy())
}

/// The files of the study by the names under which the stages know them; one that is not there and not needed is left out.
fn paths(study: &DesignFile, simulates: bool) -> Vec<(&'static str, String)> {
    let (design, files) = (&study.design, study.design.files());
    let there = |path: &Path| study.resolve(path).exists().then(|| quoted(path));
    let scenario = there(&files.scenario).filter(|_| simulates);
    let model = design.model().filter(|_| design.needs_a_model());
    let path_of = |file: &Option<std::path::PathBuf>| file.as_deref().map(quoted);
    let paths = [
        ("out", Some("\"results\"".to_owned())),
        ("report", Some("\"report\"".to_owned())),
        ("people", Some(quoted(&design.people().file))),
        ("answers", Some(quoted(&files.answers))),
        ("scales", Some(quoted(&files.scales))),
        ("scenario", scenario),
        ("model", model.map(|m| quoted(&m.file))),
        ("columns", path_of(&files.columns)),
        ("claims", path_of(&files.claims)),
        ("effects", path_of(&files.effects)),
    ];
    let paths = paths.into_iter();
    paths.filter_map(|(k, path)| Some((k, path?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(more: &str) -> toml::Table {
        let text = format!("[study]\ntitle = \"x\"\n{more}");
        let study = DesignFile { path: None, design: Design::from_toml(&text).unwrap() };
        toml::from_str(&design_pipeline(&study)).unwrap()
    }

    fn names(more: &str) -> Vec<String> {
        let written = written(more);
        let stages = written["stage"].as_array().unwrap().iter();
        let name = |stage: &toml::Value| stage["name"].as_str().unwrap().to_owned();
        stages.map(name).collect()
    }

    #[test]
    fn made_up_people_who_rated_already_are_not_asked_again() {
        let folder = tempfile::tempdir().unwrap();
        let text = "[study]\ntitle = \"x\"\nsynthetic = true\n[people]\nlearn = { study = 1 }\n[style]\nscore = \"adb.total\"\n\
                    [baseline]\nid = \"own\"\n[[condition]]\nid = \"calm\"\ncar = { dial = -15 }\n[[condition]]\nid = \"fast\"\ncar = { dial = 15 }\n[[role]]\nid = \"fast\"\n";
        let study = DesignFile {
            path: Some(folder.path().join(DESIGN_FILE)),
            design: Design::from_toml(text).unwrap(),
        };
        std::fs::create_dir_all(folder.path().join("logs")).unwrap();
        std::fs::create_dir_all(folder.path().join("surveys")).unwrap();
        std::fs::write(folder.path().join("logs/P1-own.mcap"), "").unwrap();
        let rates = |moment: &str| {
            let rows = format!("participant,moment,scale,item,answer\nP1,{moment},comfort,1,4\n");
            std::fs::write(folder.path().join("surveys/answers.csv"), rows).unwrap();
            let written: toml::Table = toml::from_str(&design_pipeline(&study)).unwrap();
            let mut stages = written["stage"].as_array().unwrap().iter();
            stages.any(|stage| stage["name"].as_str() == Some("rate"))
        };
        assert!(rates("pre"));
        // What was answered after a role of the same id rates no condition.
        assert!(rates("fast"));
        assert!(!rates("calm"));
    }

    #[test]
    fn a_study_of_recorded_cars_learns_and_simulates_nothing() {
        let conditions = "[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"";
        let styled = "[people]\nlearn = { part = \"learn\" }\n[style]\nscore = \"adb.total\"\n";
        for style in ["", styled] {
            assert_eq!(
                names(&format!("{style}{conditions}")),
                ["ingest", "score", "measure", "score-ratings", "stats", "report"]
            );
        }
    }

    #[test]
    fn both_tables_of_scores_know_who_has_which_drive() {
        let written = written("[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"");
        let scores = |stage: &&toml::Value| stage["cmd"][1].as_str() == Some("score");
        let stages = written["stage"].as_array().unwrap().iter().filter(scores);
        let knows = |stage: &toml::Value| {
            let mut words = stage["cmd"].as_array().unwrap().iter();
            words.any(|word| word.as_str() == Some("{out}/drives"))
        };
        assert_eq!(stages.map(knows).collect::<Vec<_>>(), [true, true]);
    }

    #[test]
    fn a_model_from_elsewhere_is_not_learned_again() {
        let study = "[model]\nfile = \"lab.maveric\"\n[baseline]\nid = \"own\"\n[[condition]]\nid = \"mean\"\ncar = { mean = true }";
        let found = names(study);
        assert!(
            !found.iter().any(|n| n == "train") && found.iter().any(|n| n == "simulate"),
            "{found:?}"
        );
        assert!(!found.iter().any(|n| n == "rate"), "real people rate for themselves");
    }

    #[test]
    fn made_up_people_rate_what_the_car_did_and_survey_software_is_read() {
        let study = "synthetic = true\n[files]\nsoftware = \"otree\"\n[people]\nlearn = { study = 1 }\n[style]\nscore = \"adb.total\"\n[baseline]\nid = \"own\"\n[[condition]]\nid = \"calm\"\ncar = { dial = -15 }";
        assert_eq!(
            names(study),
            [
                "import",
                "ingest",
                "score",
                "train",
                "personalize",
                "steer",
                "simulate",
                "measure",
                "rate",
                "score-ratings",
                "stats",
                "report"
            ]
        );
    }
}

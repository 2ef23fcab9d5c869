//! The pipeline that follows from a design: its stages as a pipeline file, to be run or to be changed.

use crate::design::{DESIGN_FILE, DesignFile};
use maveric_domain::design::{By, Condition, Mappings, Software};
use path_slash::PathExt as _;
use std::{fmt::Write as _, path::Path};

/// A stage of a pipeline file: words divided by blanks, parameters in braces.
struct Stage {
    name: &'static str,
    cmd: String,
    inputs: String,
    outputs: String,
}

fn stage(name: &'static str, cmd: &str, inputs: &str, outputs: &str) -> Stage {
    Stage {
        name,
        cmd: format!("maveric {cmd} --design {DESIGN_FILE}"),
        inputs: format!("{inputs} {DESIGN_FILE}"),
        outputs: outputs.to_owned(),
    }
}

impl Stage {
    /// With more of the command, and what it reads for that.
    fn and(mut self, cmd: &str, inputs: &str) -> Self {
        let _ = write!(self.cmd, " {cmd}");
        let _ = write!(self.inputs, " {inputs}");
        self
    }

    /// The same, if there is that to read.
    fn and_if(self, wanted: bool, cmd: &str, inputs: &str) -> Self {
        if wanted { self.and(cmd, inputs) } else { self }
    }

    fn write(&self, out: &mut String) {
        let list = |words: &str| {
            let quoted: Vec<String> = words.split_whitespace().map(|w| format!("{w:?}")).collect();
            quoted.join(", ")
        };
        let (name, cmd) = (self.name, list(&self.cmd));
        let (inputs, outputs) = (list(&self.inputs), list(&self.outputs));
        let _ = write!(
            out,
            "\n[[stage]]\nname = \"{name}\"\ncmd = [{cmd}]\ninputs = [{inputs}]\noutputs = [{outputs}]\n"
        );
    }
}

/// The text of the pipeline that brings a study up to date, from logs and answers to the page. Its paths start at the folder of
/// `study.toml`, where it runs.
///
/// There are only the stages that the design asks for: nothing is learned without a car that was learned, nothing simulated that
/// was recorded, nothing rated by people who exist.
pub fn design_pipeline(study: &DesignFile) -> String {
    let mut text = format!(
        "# What follows from {DESIGN_FILE}: {}\n\
         # `maveric run` writes it anew; to change it, save it as pipelines/study.toml, which is then what runs.\n\n\
         name = \"study\"\n\n[params]\n",
        study.design.title().replace(['\n', '\r'], " ")
    );
    let mut params: Vec<(&str, String)> = vec![("seed", "1".to_owned())];
    if simulates(study) {
        params.push(("duration", "600".to_owned()));
    }
    if learns(study) {
        params.extend([
            ("embedding_size", "3".to_owned()),
            ("epochs", "40".to_owned()),
        ]);
    }
    params.extend(
        paths(study)
            .into_iter()
            .map(|(k, path)| (k, format!("{path:?}"))),
    );
    for (key, value) in params {
        let _ = writeln!(text, "{key} = {value}");
    }
    for stage in stages(study) {
        stage.write(&mut text);
    }
    text.push_str("summary = true\n");
    text
}

fn simulates(study: &DesignFile) -> bool {
    study.design.conditions().iter().any(Condition::simulated)
}

fn learns(study: &DesignFile) -> bool {
    study.design.needs_a_model() && study.design.model().is_none()
}

/// The files of the study by the names under which the stages know them; one that is not there and not needed is left out.
fn paths(study: &DesignFile) -> Vec<(&'static str, String)> {
    let (design, files) = (&study.design, study.design.files());
    let text = |path: &Path| path.to_slash_lossy().into_owned();
    let mut paths = vec![
        ("out", "results".to_owned()),
        ("report", "report".to_owned()),
        ("people", text(&design.people().file)),
        ("answers", text(&files.answers)),
        ("scales", text(&files.scales)),
    ];
    let there = |path: &Path| study.resolve(path).exists();
    if there(&files.logs) {
        paths.push(("logs", text(&files.logs)));
    }
    match &files.mapping {
        Mappings::One(file) if there(file) => paths.push(("mapping", text(file))),
        _ => {}
    }
    if there(&files.scenario) && simulates(study) {
        paths.push(("scenario", text(&files.scenario)));
    }
    if let Some(model) = design.model().filter(|_| design.needs_a_model()) {
        paths.push(("model", text(&model.file)));
    }
    let optional = [
        ("columns", &files.columns),
        ("claims", &files.claims),
        ("effects", &files.effects),
    ];
    paths.extend(
        optional
            .into_iter()
            .filter_map(|(name, file)| Some((name, text(file.as_ref()?)))),
    );
    paths
}

fn stages(study: &DesignFile) -> Vec<Stage> {
    let design = &study.design;
    let known = paths(study);
    let has = |name: &str| known.iter().any(|(key, _)| *key == name);
    let mut stages = Vec::new();
    let answers = match design.files().software {
        Software::Table => "{answers}",
        software => {
            let from = if software == Software::Otree {
                "otree"
            } else {
                "jspsych"
            };
            let import = stage(
                "import",
                &format!(
                    "import {{answers}} --from {from} --scales {{scales}} --out {{out}}/answers.csv"
                ),
                "{answers} {scales}",
                "{out}/answers.csv",
            );
            stages.push(import.and_if(has("columns"), "--columns {columns}", "{columns}"));
            "{out}/answers.csv"
        }
    };
    let read: Vec<&str> = ["logs", "mapping"]
        .into_iter()
        .filter(|name| has(name))
        .collect();
    let read: Vec<String> = read.into_iter().map(|name| format!("{{{name}}}")).collect();
    let ingest = stage(
        "ingest",
        "ingest --out {out}/drives --keep-going",
        "{people}",
        "{out}/drives",
    );
    let mut ingest = ingest.and("", &read.join(" "));
    if let Mappings::Rigs(rigs) = &design.files().mapping {
        let apart = rigs
            .iter()
            .map(|r| &r.logs)
            .filter(|logs| !logs.starts_with(&design.files().logs));
        for path in apart.chain(rigs.iter().filter_map(|r| r.file.as_ref())) {
            ingest = ingest.and("", &path.to_slash_lossy());
        }
    }
    stages.push(ingest);
    let scores = |name: &str| {
        ["", "_reliabilities", "_items", "_exclusions"]
            .map(|part| format!("{{out}}/{name}{part}.csv"))
            .join(" ")
    };
    stages.push(stage(
        "score",
        &format!("score --surveys {answers} --participants {{people}} --scales {{scales}} --out {{out}}/scores.csv"),
        &format!("{answers} {{people}} {{scales}}"),
        &scores("scores"),
    ));
    let mut results =
        "{out}/measurements.parquet {out}/scores.csv {out}/rating_scores.csv {people}".to_owned();
    let mut shown = "{out}/analysis.json {out}/scores_reliabilities.csv {out}/scores_exclusions.csv \
                     {out}/rating_scores_reliabilities.csv {out}/rating_scores_exclusions.csv {out}/drives"
        .to_owned();
    if design.needs_a_model() {
        let model = if has("model") {
            "{model}"
        } else {
            "{out}/model.maveric"
        };
        let scored = |stage: Stage| {
            let styled = design.style().is_some();
            stage.and_if(styled, "--scores {out}/scores.csv", "{out}/scores.csv")
        };
        if learns(study) {
            let beside = "{out}/model_training.json {out}/model_embeddings.csv";
            stages.push(scored(stage(
                "train",
                "train --drives {out}/drives --participants {people} --out {out}/model.maveric --embedding-size {embedding_size} --epochs {epochs} --seed {seed}",
                "{out}/drives {people}",
                &format!("{model} {beside}"),
            )));
            let _ = write!(shown, " {beside}");
        }
        stages.push(scored(stage(
            "personalize",
            &format!("personalize --model {model} --drives {{out}}/drives --participants {{people}} --out {{out}}/embeddings.csv --seed {{seed}}"),
            &format!("{model} {{out}}/drives {{people}}"),
            "{out}/embeddings.csv",
        )));
        stages.push(stage(
            "steer",
            &format!("steer --model {model} --embeddings {{out}}/embeddings.csv --out {{out}}/conditions.csv --seed {{seed}}"),
            &format!("{model} {{out}}/embeddings.csv"),
            "{out}/conditions.csv",
        ));
        results.push_str(" {out}/embeddings.csv {out}/conditions.csv");
        let _ = write!(shown, " {model}");
        if simulates(study) {
            let simulate = stage(
                "simulate",
                &format!(
                    "simulate --model {model} --conditions {{out}}/conditions.csv --out {{out}}/av --duration {{duration}} --seed {{seed}}"
                ),
                &format!("{model} {{out}}/conditions.csv"),
                "{out}/av",
            );
            stages.push(simulate.and_if(has("scenario"), "--scenario {scenario}", "{scenario}"));
            shown.push_str(" {out}/av");
        }
    }
    let measure = stage(
        "measure",
        "measure --drives {out}/drives --participants {people} --out {out}/measurements.parquet",
        "{out}/drives {people}",
        "{out}/measurements.parquet",
    );
    let simulated = simulates(study);
    stages.push(measure.and_if(simulated, "--drives {out}/av/drives", "{out}/av"));
    let mut rated = answers;
    if design.synthetic() && simulates(study) && design.baseline().is_some_and(|b| b.by == By::Hand)
    {
        let rate = stage(
            "rate",
            "rate --measures {out}/measurements.parquet --participants {people} --scales {scales} --out {out}/ratings.csv --seed {seed}",
            "{out}/measurements.parquet {people} {scales}",
            "{out}/ratings.csv",
        );
        stages.push(rate.and_if(has("effects"), "--effects {effects}", "{effects}"));
        rated = "{out}/ratings.csv";
    }
    stages.push(stage(
        "score-ratings",
        &format!("score --surveys {rated} --moments after --participants {{people}} --scales {{scales}} --drives {{out}}/drives --out {{out}}/rating_scores.csv"),
        &format!("{rated} {{people}} {{scales}} {{out}}/drives"),
        &scores("rating_scores"),
    ));
    stages.push(stage(
        "stats",
        "stats study {out} --participants {people} --out {out}/analysis.json",
        &results,
        "{out}/analysis.json",
    ));
    let report = stage(
        "report",
        "report {out} --participants {people} --out {report} --param seed={seed} --command {command}",
        &format!("{shown} {results}"),
        "{report}",
    );
    // The page plays a drive by hand beside those of the car.
    let report = report.and_if(has("logs") && simulated, "", "{logs}");
    stages.push(report.and_if(has("claims"), "--claims {claims}", "{claims}"));
    stages
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::Design;

    fn names(more: &str) -> Vec<&'static str> {
        let text = format!("[study]\ntitle = \"x\"\n{more}");
        let study = DesignFile {
            path: None,
            design: Design::from_toml(&text).unwrap(),
        };
        let written = design_pipeline(&study);
        let stages = stages(&study);
        for stage in &stages {
            assert!(written.contains(&format!("name = \"{}\"", stage.name)));
        }
        stages.iter().map(|s| s.name).collect()
    }

    #[test]
    fn a_study_of_recorded_cars_learns_and_simulates_nothing() {
        assert_eq!(
            names("[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\""),
            [
                "ingest",
                "score",
                "measure",
                "score-ratings",
                "stats",
                "report"
            ]
        );
    }

    #[test]
    fn a_model_from_elsewhere_is_not_learned_again() {
        let study = "[model]\nfile = \"lab.maveric\"\n[baseline]\nid = \"own\"\n[[condition]]\nid = \"mean\"\ncar = { mean = true }";
        let found = names(study);
        assert!(
            !found.contains(&"train") && found.contains(&"simulate"),
            "{found:?}"
        );
        assert!(!found.contains(&"rate"), "real people rate for themselves");
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

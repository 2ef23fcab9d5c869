//! What an export is, for repositories: `ro-crate-metadata.json`, a Workflow Run RO-Crate.
//!
//! # Source
//! RO-Crate 1.1 (Soiland-Reyes et al. 2022) and Workflow Run RO-Crate 0.5 (Leo et al. 2024), profile Workflow Run Crate; without a run
//! of a pipeline, Process Run Crate.

use super::pseudonym::Ids;
use crate::stages::ingest::logs::Log;
use maveric_domain::Design;
use path_slash::PathExt as _;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Name of the file, which the standard gives.
pub(crate) const METADATA: &str = "ro-crate-metadata.json";
/// Name of the pipeline in an export.
pub(super) const PIPELINE: &str = "pipeline.toml";

/// What is said of an export beside its files.
#[derive(Debug, Clone, Default)]
pub struct About {
    /// The day on which it is given away, as YYYY-MM-DD.
    pub date: String,
    /// The licence under which, as the address of its text.
    pub licence: Option<String>,
    /// The version of the program.
    pub version: String,
    /// The run that the study's results came from.
    pub run: Option<PipelineRun>,
}

/// A pipeline and what was run of it.
#[derive(Debug, Clone, Default)]
pub struct PipelineRun {
    /// What the ledger of the run calls the pipeline.
    pub name: String,
    /// The pipeline file (TOML) as it was written.
    pub text: String,
    /// Parameters that the run had replaced.
    pub set: BTreeMap<String, String>,
    pub steps: Vec<Step>,
}

/// One stage of a run.
#[derive(Debug, Clone, Default)]
pub struct Step {
    pub name: String,
    pub command: String,
    /// Hash of each input, by its path in the study.
    pub inputs: BTreeMap<String, String>,
    /// Hash of each output, by its path in the study.
    pub outputs: BTreeMap<String, String>,
}

/// A file of the export.
#[derive(Debug, Serialize)]
pub(super) struct Given {
    pub(super) file: String,
    pub(super) bytes: usize,
    pub(super) blake3: String,
}

impl PipelineRun {
    /// Paths of the models that were learned or used.
    pub(super) fn models(&self) -> impl Iterator<Item = &str> {
        let files = self.steps.iter().flat_map(|s| s.inputs.keys().chain(s.outputs.keys()));
        files.map(String::as_str).filter(|path| path.ends_with(".maveric"))
    }

    /// The run without what `names` somebody, and how many paths and command lines that are.
    #[must_use]
    fn without(mut self, names: impl Fn(&str) -> bool) -> (Self, usize) {
        let mut left_out = 0;
        for step in &mut self.steps {
            for paths in [&mut step.inputs, &mut step.outputs] {
                let before = paths.len();
                paths.retain(|path, _| !names(path));
                left_out += before - paths.len();
            }
            if names(&step.command) {
                step.command.clear();
                left_out += 1;
            }
        }
        let before = self.steps.len();
        self.steps.retain(|step| !names(&step.name));
        left_out += before - self.steps.len();
        (self, left_out)
    }
}

/// What of a run is given away: nothing where the pipeline names somebody; else not the paths and commands that do, nor a log's own
/// path, whose name may be anybody's.
pub(super) fn cleared(
    run: PipelineRun,
    ids: &Ids,
    logs: &[Log],
    warnings: &mut Vec<String>,
) -> Option<PipelineRun> {
    if ids.named_in(&run.text) || run.set.values().any(|value| ids.named_in(value)) {
        let warning = "the pipeline names somebody, so it and its run are not in the export";
        warnings.push(warning.to_owned());
        return None;
    }
    let logs: Vec<_> = logs.iter().map(|log| log.path.to_slash_lossy()).collect();
    let is_log = |text: &str| logs.iter().any(|log| text.contains(log.as_ref()));
    let (run, left_out) = run.without(|text| is_log(text) || ids.named_in(text));
    if left_out > 0 {
        warnings.push(format!(
            "{left_out} paths and commands of the run name somebody and are not in {METADATA}"
        ));
    }
    Some(run)
}

fn reference(id: &str) -> Value {
    json!({ "@id": id })
}

/// One reference stands alone, as the standard has it; several are a list.
fn references<'a>(ids: impl IntoIterator<Item = &'a str>) -> Value {
    let mut list: Vec<Value> = ids.into_iter().map(reference).collect();
    match list.len() {
        1 => list.remove(0),
        _ => list.into(),
    }
}

/// The metadata of an export with these files.
pub(super) fn metadata(design: &Design, about: &About, files: &[Given]) -> Value {
    const WORKFLOW: &str = "https://w3id.org/workflowhub/workflow-ro-crate/1.0";
    const PROFILES: [(&str, &str, &str); 3] = [
        ("https://w3id.org/ro/wfrun/process/0.5", "Process Run Crate", "0.5"),
        ("https://w3id.org/ro/wfrun/workflow/0.5", "Workflow Run Crate", "0.5"),
        (WORKFLOW, "Workflow RO-Crate", "1.0"),
    ];
    let profiles = if about.run.is_some() { &PROFILES[..] } else { &PROFILES[..1] };
    // The metadata of a workflow keep to its own profile too.
    let standards = ["https://w3id.org/ro/crate/1.1"].into_iter();
    let standards = standards.chain(about.run.as_ref().map(|_| WORKFLOW));
    let licence = about.licence.as_deref().unwrap_or("#no-licence");
    let mut steps: Vec<Value> = Vec::new();
    let mut mentioned = vec!["#export".to_owned()];
    let title = design.title();
    let authors = design.authors().iter().enumerate();
    let authors: Vec<Value> = authors
        .map(|(n, name)| json!({ "@id": format!("#author-{}", n + 1), "@type": "Person", "name": name }))
        .collect();
    let mut root = json!({
        "@id": "./",
        "@type": "Dataset",
        "name": title,
        "description": format!(
            "{title}: design, logs, people, answers and outcomes of a driving study under pseudonyms, without dates, places and free text. \
             Written by maveric {}.",
            about.version
        ),
        "datePublished": about.date,
        "license": reference(licence),
        "conformsTo": references(profiles.iter().map(|p| p.0)),
        "hasPart": references(files.iter().map(|f| f.file.as_str())),
    });
    if let Some(run) = &about.run {
        root["mainEntity"] = reference(PIPELINE);
        steps = actions(run, &mut mentioned);
    }
    if !authors.is_empty() {
        let ids = authors.iter().filter_map(|author| author["@id"].as_str());
        root["author"] = references(ids);
    }
    root["mentions"] = references(mentioned.iter().map(String::as_str));
    let mut graph = vec![
        json!({
            "@id": METADATA,
            "@type": "CreativeWork",
            "about": reference("./"),
            "conformsTo": references(standards),
        }),
        root,
        licence_of(about),
        json!({
            "@id": "#maveric",
            "@type": "SoftwareApplication",
            "name": "maveric",
            "softwareVersion": about.version,
            "version": about.version,
            "url": "https://arxiv.org/abs/2301.08595",
        }),
        json!({
            "@id": "#export",
            "@type": "CreateAction",
            "name": "maveric export",
            "description": "The study's files under pseudonyms.",
            "instrument": reference("#maveric"),
            "endTime": about.date,
            "result": references(files.iter().map(|f| f.file.as_str()).filter(|f| *f != PIPELINE)),
        }),
    ];
    graph.extend(profiles.iter().map(|(id, name, version)| {
        json!({ "@id": id, "@type": "CreativeWork", "name": name, "version": version })
    }));
    graph.extend(files.iter().map(|file| entity(file, about, licence)));
    graph.extend(authors);
    graph.extend(steps);
    json!({ "@context": "https://w3id.org/ro/crate/1.1/context", "@graph": graph })
}

fn licence_of(about: &About) -> Value {
    match &about.licence {
        Some(url) => {
            json!({ "@id": url, "@type": "CreativeWork", "name": url, "description": url })
        }
        None => json!({
            "@id": "#no-licence",
            "@type": "CreativeWork",
            "name": "no licence given",
            "description": "Those who give this away have not said under which licence: ask them.",
        }),
    }
}

fn entity(given: &Given, about: &About, licence: &str) -> Value {
    let path = given.file.as_str();
    let ending = path.rsplit('.').next().unwrap_or_default();
    let format = match ending {
        "csv" => "text/csv",
        "toml" => "application/toml",
        "md" => "text/markdown",
        "parquet" => "application/vnd.apache.parquet",
        "mcap" => "application/octet-stream",
        _ => "text/plain",
    };
    let mut file = json!({
        "@id": path,
        "@type": "File",
        "name": path,
        "contentSize": given.bytes.to_string(),
        "encodingFormat": format,
        "identifier": format!("blake3:{}", given.blake3),
    });
    if path == "README.md" {
        file["about"] = reference("./");
    }
    if let (true, Some(run)) = (path == PIPELINE, &about.run) {
        file["@type"] = json!(["File", "SoftwareSourceCode", "ComputationalWorkflow"]);
        file["name"] = json!(format!("Pipeline {}", run.name));
        file["description"] = json!("What brings the study's results up to date, stage by stage.");
        file["programmingLanguage"] = reference("#pipeline-language");
        file["license"] = reference(licence);
        file["version"] = json!(about.version);
        file["url"] = json!("https://arxiv.org/abs/2301.08595");
    }
    file
}

/// The run as a whole, each stage of it, and what they read and made.
fn actions(run: &PipelineRun, mentioned: &mut Vec<String>) -> Vec<Value> {
    let mut entities = vec![json!({
        "@id": "#pipeline-language",
        "@type": "ComputerLanguage",
        "name": "maveric pipeline",
        "url": "https://toml.io",
        "identifier": "https://toml.io",
    })];
    let mut files: BTreeMap<&str, &str> = BTreeMap::new();
    let mut outputs = Vec::new();
    let local_references = |paths: std::collections::btree_map::Keys<'_, String, String>| {
        let ids: Vec<String> = paths.map(|path| format!("#{path}")).collect();
        references(ids.iter().map(String::as_str))
    };
    for step in &run.steps {
        let id = format!("#stage-{}", step.name);
        for (path, hash) in step.inputs.iter().chain(&step.outputs) {
            files.insert(path, hash);
        }
        outputs.extend(step.outputs.keys().map(|path| format!("#{path}")));
        entities.push(json!({
            "@id": id,
            "@type": "CreateAction",
            "name": format!("Stage {}", step.name),
            "description": step.command,
            "instrument": reference("#maveric"),
            "actionStatus": "http://schema.org/CompletedActionStatus",
            "object": local_references(step.inputs.keys()),
            "result": local_references(step.outputs.keys()),
        }));
        mentioned.push(id);
    }
    entities.push(json!({
        "@id": "#run",
        "@type": "CreateAction",
        "name": format!("Run of pipeline {}", run.name),
        "description": "All stages, in the order in which each needs the others.",
        "instrument": reference(PIPELINE),
        "actionStatus": "http://schema.org/CompletedActionStatus",
        "result": references(outputs.iter().map(String::as_str)),
    }));
    mentioned.push("#run".to_owned());
    // They are not given away: who has the study can hold them against these hashes.
    entities.extend(files.iter().map(|(path, hash)| {
        json!({
            "@id": format!("#{path}"),
            "@type": "CreativeWork",
            "name": path,
            "identifier": format!("blake3:{hash}"),
            "description": "In the study's own folder; not given away.",
        })
    }));
    entities
}

#[cfg(test)]
mod tests {
    use super::{super::pseudonym::Pseudonyms, *};
    use maveric_domain::ParticipantId;

    #[test]
    fn paths_that_name_somebody_are_left_out_and_counted() {
        let ids = ["P1", "anna"].map(|id| ParticipantId::new(id).unwrap());
        let ids = Ids::new(&Pseudonyms::default(), &ids.map(String::from).into());
        let names = |text: &str| ids.named_in(text);
        assert!(names("logs/P1-own.mcap") && names("anna"));
        assert!(!names("logs/P12.mcap") && !names("results/annals.csv"));
        let step = Step {
            name: "ingest".to_owned(),
            command: "maveric ingest logs/anna.mcap".to_owned(),
            inputs: [
                ("logs/anna.mcap".to_owned(), "1".to_owned()),
                ("study.toml".to_owned(), "2".to_owned()),
            ]
            .into(),
            outputs: [("results/drives".to_owned(), "3".to_owned())].into(),
        };
        let run = PipelineRun { steps: vec![step], ..PipelineRun::default() };
        let mut warnings = Vec::new();
        let run = cleared(run, &ids, &[], &mut warnings);
        assert!(warnings[0].starts_with("2 paths and commands"), "{warnings:?}");
        let design = Design::from_toml(
            "[study]\ntitle = \"A study\"\nauthors = [\"A. Author\"]\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"",
        );
        let about = About { run, ..About::default() };
        let text = metadata(&design.unwrap(), &about, &[]).to_string();
        assert!(!text.contains("anna") && text.contains("blake3:3"), "{text}");
        assert!(text.contains("\"author\":{\"@id\":\"#author-1\"}"), "{text}");
        let named =
            PipelineRun { text: "maveric ingest logs/anna".to_owned(), ..PipelineRun::default() };
        assert!(cleared(named, &ids, &[], &mut warnings).is_none());
        let set_to = |value: &str| PipelineRun {
            set: [("logs".to_owned(), value.to_owned())].into(),
            ..PipelineRun::default()
        };
        assert!(cleared(set_to("logs/anna"), &ids, &[], &mut warnings).is_none());
        assert!(cleared(set_to("logs"), &ids, &[], &mut warnings).is_some());
    }
}

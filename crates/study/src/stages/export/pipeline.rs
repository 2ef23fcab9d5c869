//! The pipeline that is given away: with what was set for its run and, where it follows from the design, with the files of the export.

use super::ro_crate::PipelineRun;
use crate::{
    design::{DESIGN_FILE, DesignFile},
    design_pipeline::design_pipeline,
};
use maveric_domain::Design;
use std::{collections::BTreeMap, path::Path};
use toml::{Table, Value};

/// Whether a run's pipeline is the one that follows from the study's design; beside the study stands the design that is given away.
pub(super) fn follows_from(study: Option<(&DesignFile, &Design)>, run: &PipelineRun) -> bool {
    study.is_some_and(|(study, _)| design_pipeline(study) == run.text)
}

/// The text of a run's pipeline for the folder `out`, which has everything else of the export.
pub(super) fn text(
    run: &PipelineRun,
    study: Option<(&DesignFile, &Design)>,
    out: &Path,
) -> Result<String, toml::ser::Error> {
    let follows = study.filter(|_| follows_from(study, run));
    let anew = follows.map(|(_, given)| {
        design_pipeline(&DesignFile { path: Some(out.join(DESIGN_FILE)), design: given.clone() })
    });
    with_settings(anew.unwrap_or_else(|| run.text.clone()), &run.set)
}

/// The text with these values of its parameters; where there are none it stays to the letter, else its comments go.
fn with_settings(text: String, set: &BTreeMap<String, String>) -> Result<String, toml::ser::Error> {
    let (false, Ok(mut pipeline)) = (set.is_empty(), toml::from_str::<Table>(&text)) else {
        return Ok(text);
    };
    let params = pipeline.entry("params").or_insert_with(|| Table::new().into());
    if let Value::Table(params) = params {
        for (key, value) in set {
            let value = like(value, params.get(key));
            params.insert(key.clone(), value);
        }
    }
    let keys: Vec<&str> = set.keys().map(String::as_str).collect();
    let head = format!("# As set for the run: {}.\n", keys.join(", "));
    Ok(head + &toml::to_string(&pipeline)?)
}

/// What `--set` said as a value of the kind that was there; a parameter of a file that this one extends is read as it is written.
fn like(value: &str, before: Option<&Value>) -> Value {
    let words = || Value::from(value);
    if before.is_some_and(Value::is_str) {
        return words();
    }
    let read = toml::from_str::<Table>(&format!("value = {value}"));
    read.ok().and_then(|mut table| table.remove("value")).unwrap_or_else(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_set_is_what_the_given_pipeline_has_and_the_rest_stays() {
        let text =
            "# Mine\nname = \"mine\"\n[params]\nduration = 600\nheads = \"linear\"\nseed = 1\n";
        let set = |pairs: &[(&str, &str)]| {
            let pairs = pairs.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned()));
            with_settings(text.to_owned(), &pairs.collect()).unwrap()
        };
        assert_eq!(set(&[]), text);
        let given = set(&[("duration", "240"), ("heads", "paper"), ("of_another", "1,2")]);
        assert!(given.starts_with("# As set for the run: duration, "), "{given}");
        let read: Table = toml::from_str(&given).unwrap();
        let params = &read["params"];
        assert_eq!(params["duration"].as_integer(), Some(240));
        assert_eq!(params["heads"].as_str(), Some("paper"));
        assert_eq!(params["seed"].as_integer(), Some(1));
        assert_eq!(params["of_another"].as_str(), Some("1,2"));
    }

    #[test]
    fn a_pipeline_that_follows_from_the_design_has_the_files_of_the_export_and_one_of_its_own_stays()
     {
        let design = |files: &str| {
            let text = format!(
                "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n{files}"
            );
            Design::from_toml(&text).unwrap()
        };
        let study = DesignFile {
            path: None,
            design: design("[files]\nanswers = \"theirs/answers.csv\"\n"),
        };
        let given = design("[files]\nanswers = \"surveys.csv\"\n");
        let out = tempfile::tempdir().unwrap();
        let of = |text: String| {
            let run = PipelineRun { text, ..PipelineRun::default() };
            super::text(&run, Some((&study, &given)), out.path()).unwrap()
        };
        let designed = of(design_pipeline(&study));
        assert!(
            designed.contains("answers = \"surveys.csv\"") && !designed.contains("theirs"),
            "{designed}"
        );
        let own = "name = \"own\"\n# theirs/answers.csv\n";
        assert_eq!(of(own.to_owned()), own);
    }
}

//! A run's folder and what a study brings along: the readers of what several commands read, and the names of files beside others.

use crate::{
    atomic_write::{files_ending, if_there, read_text},
    design::DesignFile,
    error::StudyError,
    stage::Files,
    tables::{
        collected::{NOT_ADMITTED, NOT_AGREED, STOPPED, consents_of_study},
        conditions::read_conditions,
        drives::kept_out,
        embeddings::read_embeddings,
        keys::composed,
        measurements::{one_drive_a_condition, read_measurements},
        own_measures::read_own_measurements,
        read_rows,
        surveys::{Answered, read_answered, read_scores},
    },
};
use maveric_analysis::{Driven, Person, Stopped, StudyData, Tables};
use maveric_domain::{
    Answer, Design, DriveId, ParticipantId, ProbeAnswer, Ride, Scale, Score, Seconds,
    design::{ScoreName, Software},
};
use maveric_measures::survey::score_probes;
use maveric_model::{Model, model_file};
use maveric_participants::Effects;
use maveric_simulator::Scenario;
use serde::Deserialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// Tables of answers among the results.
const ANSWERS: [&str; 3] = ["surveys.csv", "answers.csv", "ratings.csv"];

/// Name of the measurements among a run's results.
pub(crate) const MEASUREMENTS: &str = "measurements.parquet";

/// Name of the model among a run's results.
pub const MODEL_FILE: &str = "model.maveric";

/// File beside the model that holds the training's report.
pub fn training_path(model: &Path) -> PathBuf {
    beside(model, "_training.json")
}

/// File beside the model that holds the training embeddings.
pub fn embeddings_path(model: &Path) -> PathBuf {
    beside(model, "_embeddings.csv")
}

/// The file beside `out` that holds the reliabilities.
pub fn reliabilities_path(out: &Path) -> PathBuf {
    beside(out, "_reliabilities.csv")
}

/// The file beside `out` that holds each item's part in its subscale.
pub fn items_path(out: &Path) -> PathBuf {
    beside(out, "_items.csv")
}

/// The file beside `out` that holds the answers to each item in each condition.
pub fn item_means_path(out: &Path) -> PathBuf {
    beside(out, "_item_means.csv")
}

/// The file beside `out` that holds the means of the study's own measures.
pub fn own_path(out: &Path) -> PathBuf {
    beside(out, "_own.csv")
}

/// The file beside the measurements with presses, a row a ride.
pub(crate) fn presses_path(measurements: &Path) -> PathBuf {
    beside(measurements, "_presses.csv")
}

/// The file beside the measurements with the moments around presses.
pub(crate) fn press_moments_path(measurements: &Path) -> PathBuf {
    beside(measurements, "_press_moments.csv")
}

/// The file beside `out` that lists what was left out: who, what, why.
pub fn exclusions_path(out: &Path) -> PathBuf {
    beside(out, "_exclusions.csv")
}

fn beside(out: &Path, suffix: &str) -> PathBuf {
    let stem = out.file_stem().unwrap_or_default().to_string_lossy();
    out.with_file_name(format!("{stem}{suffix}"))
}

/// Reads a trained model.
///
/// # Errors
/// [`StudyError`] naming the file, if it is no model, damaged, or of another version.
pub fn read_model(path: &Path) -> Result<Model, StudyError> {
    if path.is_dir() {
        return Err(StudyError::file(path, "is a folder, expected a model file"));
    }
    let bytes = std::fs::read(path).map_err(StudyError::read(path))?;
    model_file::from_bytes(&bytes).map_err(|e| {
        let help = e.suggestion().unwrap_or("train a model with `maveric train`");
        StudyError::file(path, e.to_string()).with_help(help)
    })
}

/// Reads every scale definition of a folder, ordered by file name.
///
/// # Errors
/// [`StudyError`] if there is none, or naming the file that does not define a scale.
pub fn read_scales(folder: &Path) -> Result<Vec<Scale>, StudyError> {
    let paths = files_ending(folder, "toml")?;
    if paths.is_empty() {
        let problem = "holds no questionnaire definitions (*.toml)";
        return Err(StudyError::file(folder, problem));
    }
    let read = |path: &PathBuf| {
        Scale::from_toml(&composed(&read_text(path)?))
            .map_err(|e| StudyError::file(path, e.to_string()))
    };
    paths.iter().map(read).collect()
}

/// Lowest and highest value of a score, by its scale's definition; none where no scale has it.
pub(crate) fn score_range(scales: &[Scale], score: &ScoreName) -> Option<(f64, f64)> {
    let scale = scales.iter().find(|s| s.id == score.scale)?;
    let mut subscales = scale.subscales.iter();
    Some(scale.score_range(subscales.find(|s| s.id == score.subscale)?))
}

/// Reads the sizes of the effects.
pub(crate) fn read_effects(path: &Path) -> Result<Effects, StudyError> {
    effects_of(path, &read_text(path)?)
}

/// The sizes of the effects on the answers to these questionnaires: what is not asked is not answered.
pub(crate) fn read_effects_on(path: &Path, scales: &[Scale]) -> Result<Effects, StudyError> {
    let mut effects = read_effects(path)?;
    let is_asked = |id: &String| scales.iter().any(|s| s.id == *id);
    effects.answers.retain(|id, _| is_asked(id));
    effects.ratings.retain(|id, _| is_asked(id));
    Ok(effects)
}

/// The sizes of the effects in a file's text.
pub(crate) fn effects_of(path: &Path, text: &str) -> Result<Effects, StudyError> {
    let effects: Effects = toml::from_str(text)
        .map_err(|e| StudyError::file(path, format!("not a file of effects: {e}")))?;
    effects.check().map_err(|e| StudyError::file(path, e.to_string()))?;
    Ok(effects)
}

/// Reads a scenario, or takes the paper's, at the length asked for.
///
/// # Errors
/// [`StudyError`] naming the file and the key.
pub fn read_scenario(path: Option<&Path>, duration_s: Option<f64>) -> Result<Scenario, StudyError> {
    let scenario = match path {
        None => Scenario::paper(),
        Some(path) => scenario_of(path, &read_text(path)?)?,
    };
    match duration_s {
        None => Ok(scenario),
        Some(seconds) => Ok(scenario.with_duration(Seconds(seconds))?),
    }
}

/// Reads the scenario that people drive and ride in the seat, or takes the seat's own.
///
/// # Errors
/// [`StudyError`] naming the file and the key.
pub fn read_seat_scenario(path: Option<&Path>) -> Result<Scenario, StudyError> {
    match path {
        None => scenario_of(Path::new("seat.toml"), maveric_data::SCENARIOS_SEAT),
        Some(path) => read_scenario(Some(path), None),
    }
}

fn scenario_of(path: &Path, text: &str) -> Result<Scenario, StudyError> {
    toml::from_str(text).map_err(|e| StudyError::file(path, format!("not a scenario: {e}")))
}

/// Reads the tables that a pipeline left in a folder; `participants` names who took part, else as [`DesignFile::people_of`].
///
/// # Errors
/// [`StudyError`] if one cannot be read, or as [`StudyData::new`].
pub(crate) fn read_study(
    folder: &Path,
    study: &DesignFile,
    participants: Option<&Path>,
) -> Result<StudyData, StudyError> {
    let people = study.people_of(folder, participants)?.enrolled;
    let design = &study.design;
    let measurements = folder.join(MEASUREMENTS);
    let measured = if_there(&measurements, read_measurements)?;
    // Before there are drives nothing was learned of any.
    let driven = !measured.is_empty();
    let learned = driven && design.needs_a_model();
    let own = own_means(&measurements, design);
    let of_design = measured.iter().filter(|d| design.knows(d.meta.condition));
    one_drive_a_condition(&measurements, of_design)?;
    let scales = read_scales(&study.resolve(&design.files().scales))?;
    let stopped = study.stopped()?;
    let answered = answered(folder, study, &stopped)?;
    let mut post = if_there(&folder.join("rating_scores.csv"), read_scores)?;
    post.extend(of_stopped(&stopped, &scales, &answered, study)?);
    let tables = Tables {
        people: people
            .into_iter()
            .map(|p| Person {
                id: p.id,
                learned: p.learned_from,
                tested: p.tested,
                order: p.order,
                columns: p.cells,
            })
            .collect(),
        measurements: measured,
        own: own.map_or_else(|| Ok(Vec::new()), |own| if_there(&own, read_own_measurements))?,
        embeddings: read_made(&folder.join("embeddings.csv"), learned, read_embeddings)?,
        conditions: read_made(&folder.join("conditions.csv"), learned, read_conditions)?,
        pre: if_there(&folder.join("scores.csv"), read_scores)?,
        post,
        scales,
        answers: answered.answers,
        durations_s: durations(folder)?,
        kept_out: drives_kept_out(folder)?,
        stopped,
        not_admitted: study.not_admitted()?,
        consents: study.consents()?,
        not_agreed: study.not_agreed()?,
    };
    let rides = if_there(&presses_path(&measurements), read_rows)?;
    let moments = if_there(&press_moments_path(&measurements), read_rows)?;
    Ok(StudyData::new(design, tables)?.with_presses(rides, moments))
}

/// The files with what [`read_study`] reads, for paths from `root`.
pub(crate) fn study_files(
    files: Files,
    root: &Path,
    folder: &Path,
    study: &DesignFile,
    participants: Option<&Path>,
) -> Files {
    let design = &study.design;
    let measurements = folder.join(MEASUREMENTS);
    let tables =
        ["embeddings.csv", "conditions.csv", "scores.csv", "rating_scores.csv", "drives", "av"];
    let mut files = files
        .reads([study.resolve(&design.files().scales)])
        .reads_if_there(own_means(&measurements, design))
        .reads_if_there([presses_path(&measurements), press_moments_path(&measurements)])
        .reads_if_there([measurements])
        .reads_if_there(tables.map(|name| folder.join(name)));
    files = match participants {
        Some(given) => files.reads([given]),
        None => files.reads_if_there([folder.join("participants.csv"), study.people_file(None)]),
    };
    let stopped = study.resolve(Path::new(STOPPED));
    let is_stopped = root.join(&stopped).is_file();
    files = files.reads_if_there([stopped]).reads_if_there([
        study.resolve(Path::new(NOT_ADMITTED)),
        study.resolve(&consents_of_study()),
        study.resolve(Path::new(NOT_AGREED)),
    ]);
    if design.exclude().judges_answers() || is_stopped {
        let answers = study.resolve(&design.files().answers);
        files = files
            .reads_if_there(Some(answers).filter(|_| design.files().software == Software::Table))
            .reads_if_there(ANSWERS.map(|name| folder.join(name)));
    }
    files
}

/// The means of the study's own measures among the results; none where the design declares no measure: what an earlier design made counts
/// no more.
fn own_means(measurements: &Path, design: &Design) -> Option<PathBuf> {
    (!design.measures().is_empty()).then(|| own_path(measurements))
}

/// What a stage of the design makes has to be there; what none makes need not.
fn read_made<T: Default>(
    path: &Path,
    is_made: bool,
    read: fn(&Path) -> Result<T, StudyError>,
) -> Result<T, StudyError> {
    if is_made { read(path) } else { if_there(path, read) }
}

/// Single answers, where they are read: those among the results, and the design's own table of them.
///
/// They are read where the design's rules judge sheets, or rides were stopped, of which nothing is scored among the results. (A table of
/// stopped rides without a row reads nothing, though [`study_files`] names the answers then too.)
fn answered(
    folder: &Path,
    study: &DesignFile,
    stopped: &[Stopped],
) -> Result<Answered, StudyError> {
    let mut answered = Answered::default();
    if !study.design.exclude().judges_answers() && stopped.is_empty() {
        return Ok(answered);
    }
    for table in answer_tables(folder, study) {
        let more = read_answered(&table)?;
        answered.answers.extend(more.answers);
        answered.probes.extend(more.probes);
    }
    Ok(answered)
}

/// Scores of the sheets about rides that were stopped, and of what was answered during them.
fn of_stopped(
    stopped: &[Stopped],
    scales: &[Scale],
    answered: &Answered,
    study: &DesignFile,
) -> Result<Vec<Score>, StudyError> {
    let was_stopped = |who: &ParticipantId, ride: Ride| {
        let mut theirs = stopped.iter().filter(|s| s.participant == *who);
        theirs.any(|s| s.ride() == ride)
    };
    let about = |a: &&Answer| a.moment.ride().is_some_and(|ride| was_stopped(&a.participant, ride));
    let answers: Vec<Answer> = answered.answers.iter().filter(about).cloned().collect();
    let during = |p: &&ProbeAnswer| was_stopped(&p.participant, p.ride);
    let probes: Vec<ProbeAnswer> = answered.probes.iter().filter(during).cloned().collect();
    let scales = study.design.with_dropped_items(scales.to_vec());
    let mut scores = maveric_measures::score(&scales, &answers, None)?.scores;
    scores.extend(score_probes(&scales, &probes)?);
    Ok(scores)
}

/// The tables of answers that are there: the design's own, and those among the results.
pub(crate) fn answer_tables(folder: &Path, study: &DesignFile) -> Vec<PathBuf> {
    let files = study.design.files();
    let own_table = Some(study.resolve(&files.answers));
    let own_table = own_table.filter(|_| files.software == Software::Table);
    let results = ANSWERS.map(|name| folder.join(name));
    let tables = own_table.into_iter().chain(results);
    tables.filter(|path| path.is_file()).collect()
}

/// What the design keeps out, from beside every list of drives among the results.
fn drives_kept_out(folder: &Path) -> Result<Vec<Driven>, StudyError> {
    let mut drives = Vec::new();
    for list in lists(folder) {
        drives.extend(kept_out(list.parent().unwrap_or(folder))?);
    }
    Ok(drives)
}

/// What of a list of drives says how long each took.
#[derive(Deserialize)]
struct Listed {
    drive: DriveId,
    duration_s: f64,
}

/// How long each drive took, from the lists of drives among the results.
pub(crate) fn durations(folder: &Path) -> Result<BTreeMap<DriveId, f64>, StudyError> {
    let mut durations = BTreeMap::new();
    for path in lists(folder) {
        let rows: Vec<Listed> = read_rows(&path)?;
        durations.extend(rows.into_iter().map(|row| (row.drive, row.duration_s)));
    }
    Ok(durations)
}

/// Every list of drives among the results, in order.
pub(crate) fn lists(folder: &Path) -> Vec<PathBuf> {
    let mut lists = Vec::new();
    let mut folders = vec![folder.join("drives"), folder.join("av")];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        for path in entries.map(|e| e.path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().is_some_and(|n| n == "drives.csv") {
                lists.push(path);
            }
        }
    }
    lists.sort();
    lists
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::{TableName, measurements::write_measurements};
    use maveric_domain::{DriveMeta, DrivenBy, MeasuredDrive};

    /// What is read of a study with a `[style]` whose two conditions have this car, and of whose results there are the drives alone.
    fn read_with(car: &str) -> Result<StudyData, StudyError> {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        write(
            "study.toml",
            &format!(
                "[study]\ntitle = \"t\"\n[people]\nlearn = {{ part = \"learn\" }}\n[style]\nscore = \"adb.total\"\n\
                 [[condition]]\nid = \"calm\"\ncar = {car}\n[[condition]]\nid = \"sporty\"\ncar = {car}\n"
            ),
        );
        write("scales/adb.toml", maveric_data::SCALES_ADB);
        write("participants.csv", "participant,part\nP01,test\nP02,test\nP03,test\n");
        let about = ["drive", "participant", "condition", "driven_by", "counted_s"];
        let entry = TableName::Measurements.entry();
        let measures = entry.always().filter(|name| !about.contains(name));
        let values: BTreeMap<String, Option<f64>> =
            measures.map(|name| (name.to_owned(), Some(25.0))).collect();
        let drive = |(who, condition): (&str, &str)| {
            let id = format!("{who}-{condition}");
            MeasuredDrive {
                meta: DriveMeta::named(id, who, condition, DrivenBy::Human).unwrap(),
                values: values.clone(),
                counted_s: None,
            }
        };
        let driven = ["P01", "P02", "P03"].map(|who| [(who, "calm"), (who, "sporty")]);
        let drives: Vec<MeasuredDrive> = driven.into_iter().flatten().map(drive).collect();
        let results = folder.path().join("results");
        write_measurements(&results.join(MEASUREMENTS), &drives).unwrap();
        let study = DesignFile::read(&folder.path().join("study.toml")).unwrap();
        read_study(&results, &study, None)
    }

    #[test]
    fn what_a_model_makes_has_to_be_there_where_a_car_that_was_learned_drives_and_nowhere_else() {
        let recorded = read_with("{ recorded = true }").unwrap();
        assert_eq!(recorded.participants.len(), 3);
        let error = read_with("{ mean = true }").unwrap_err();
        assert!(matches!(error, StudyError::Io { .. }), "{error}");
        assert!(error.to_string().contains("embeddings.csv"), "{error}");
    }

    #[test]
    fn means_of_own_measures_are_read_where_the_design_declares_measures() {
        let reads_means = |measures: &str| {
            let text = format!("[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n{measures}");
            let study = DesignFile {
                path: Some(PathBuf::from("study.toml")),
                design: Design::from_toml(&text).unwrap(),
            };
            let (root, results) = (Path::new(""), Path::new("results"));
            let files = study_files(Files::default(), root, results, &study, None);
            files.if_there.contains(&results.join("measurements_own.csv"))
        };
        assert!(reads_means("[[measure]]\nid = \"tor_s\"\nunit = \"s\"\n"));
        assert!(!reads_means(""));
    }
}

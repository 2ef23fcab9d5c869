//! The page of a study.

mod car;
mod conditions;
mod embedding;
mod homophily;
mod methods;
mod setting;
mod setup;
mod summary;
mod watch;

use super::{
    ReportOptions,
    inputs::{hashed, in_folder, parameter_files, shown_whole},
    keys::{made, results},
    people::People,
};
use crate::{
    atomic_write::{read_json, read_text},
    design::DesignFile,
    error::StudyError,
    outcome::Watch,
    stages::{
        generate::read_scenario,
        train::{MODEL_FILE, TrainingSummary, read_model, training_path},
    },
    tables::{
        Table as File,
        conditions::{ConditionRow, read_conditions},
        drives::read_drive,
        measurements::{MeasuredDrive, read_measurements},
    },
};
use car::section_car;
use conditions::{section_conditions, section_kept};
use embedding::{live, section_embedding};
use homophily::section_homophily;
use maveric_analysis::{AggressionLine as Line, Analysis, Correlation as Found};
use maveric_domain::DriveId;
use maveric_model::Model;
use maveric_report::{
    Context, Report,
    claims::{self, LedgerRow},
    html::{Methods, Provenance},
    tables::{Coefficient, Correlation, Exclusion},
};
use setting::{listed_exclusions, reliabilities, section_model, section_study};
use setup::setup;
use std::path::Path;
use summary::summary;

struct Run {
    analysis: Analysis,
    training: TrainingSummary,
    model: Model,
    measured: Vec<MeasuredDrive>,
    conditions: Vec<ConditionRow>,
    context: Context,
}

/// What the page is made from, beside the drives.
const READ: [&str; 12] = [
    "analysis.json",
    "model.maveric",
    "model_training.json",
    "model_embeddings.csv",
    "embeddings.csv",
    "conditions.csv",
    "measurements.parquet",
    "scores.csv",
    "scores_reliabilities.csv",
    "scores_exclusions.csv",
    "rating_scores_reliabilities.csv",
    "rating_scores_exclusions.csv",
];

pub(super) fn page(
    options: &ReportOptions,
    watch: Watch<'_>,
) -> Result<(Report, Vec<String>), StudyError> {
    let folder = options.results.as_path();
    let study = DesignFile::find(options.design.as_deref())?;
    let analysis: Analysis = read_json(&folder.join("analysis.json"))?;
    let training: TrainingSummary = read_json(&training_path(&folder.join(MODEL_FILE)))?;
    let measured = read_measurements(&folder.join("measurements.parquet"))?;
    let context = if analysis.synthetic {
        Context::synthetic(training.seed)
    } else {
        Context::real()
    };
    let run = Run {
        model: read_model(&folder.join(MODEL_FILE))?,
        conditions: read_conditions(&folder.join("conditions.csv"))?,
        analysis,
        training,
        measured,
        context,
    };
    let beside = folder.join("participants.csv");
    let participants = options.participants.as_deref().unwrap_or(&beside);
    let people = People::read(folder, participants, &run.measured, &study.design)?;
    // The drives by hand have a folder of their own, or stand with all others.
    let by_hand = Some(folder.join("drives/study2")).filter(|d| d.is_dir());
    let by_hand = by_hand.unwrap_or_else(|| folder.join("drives"));
    let list = File::read(&by_hand.join("drives.csv"))?;
    let durations = list.all_numbers("duration_s")?;
    let minutes = durations.iter().sum::<f64>() / durations.len() as f64 / 60.0;
    let first = list.ids::<DriveId>("drive")?.into_iter().next();
    let road = match first {
        Some(id) => *read_drive(&by_hand.join(format!("{id}.parquet")))?.road(),
        None => return Err(StudyError::file(list.path(), "lists no drive")),
    };
    let given = |key| {
        let mut all = options.parameters.iter();
        all.find(|(name, _)| name == key).map(|(_, value)| value)
    };
    let scenario = given("scenario").map(|path| read_scenario(Some(Path::new(path)), None));
    let scenario = scenario.transpose()?;
    let setup = setup(&run, &road, minutes, scenario.as_ref())?;
    let paper = claims::load(&read_text(&options.claims)?)?;
    let mut ledger = claims::join(&paper, &results(&run.analysis, &people, &setup))?;
    for row in ledger.iter_mut().filter(|row| row.ours.is_some()) {
        row.made = Some(made(&row.claim.key));
    }
    watch.check()?;
    let reliabilities = reliabilities(folder)?;
    let findings = findings(&run);
    let logs = watch::logs(folder, &run);
    let watched = watch::drives(&logs)?;
    let mut sections = vec![section_study(folder, &run, &people, &reliabilities)?];
    if let Some(scenario) = scenario.as_ref().filter(|_| run.analysis.synthetic) {
        let sources = given("population_sources").map(Path::new);
        let seed = run.training.seed;
        sections.push(section_car(scenario, sources, seed, &run.context)?);
    }
    sections.extend([
        section_model(&run)?,
        section_embedding(folder, &run, &ledger)?,
        section_conditions(&run, &ledger, &watched)?,
        section_kept(&run)?,
        section_homophily(&run, &ledger)?,
    ]);
    let exclusions: Vec<Exclusion> = run
        .analysis
        .exclusions
        .iter()
        .map(|e| Exclusion {
            who: e.who.clone(),
            what: e.what.clone(),
            why: e.why.clone(),
        })
        .chain(listed_exclusions(folder)?)
        .collect();
    let mut warnings = run.training.warnings.clone();
    if let Some(share) = run.analysis.beyond_training.filter(|s| *s > 0.0) {
        warnings.push(format!(
            "{:.0}% of the Aggressive and Cautious embeddings lie further out than any training driver's: the networks extrapolate there",
            100.0 * share
        ));
    }
    let made_up = if run.analysis.synthetic {
        "Synthetic participants: "
    } else {
        ""
    };
    let mut moving = Vec::from_iter(live(folder, &run)?);
    moving.extend(watch::player(watched));
    // Without its figure, a part that moves has nothing to stand for it on paper.
    let drawn = |name: &String| {
        sections
            .iter()
            .flat_map(|s| &s.figures)
            .any(|f| f.name == *name)
    };
    moving.retain(|live| drawn(&live.below));
    let files = parameter_files(&options.parameters);
    let shown = in_folder(folder, &READ).into_iter();
    let shown = shown.chain([participants.to_owned()]);
    let report = Report {
        title: "MAVERIC: personalised driving style".to_owned(),
        subtitle: format!(
            "{made_up}{} drives to learn from, {} participants who then sat through four AV conditions",
            run.training.drives, run.analysis.participants
        ),
        context: run.context.clone(),
        summary: summary(&run, &ledger),
        live: moving,
        sections,
        methods: Methods {
            text: methods::text(&run, &road, minutes),
            files: shown_whole(&files)?,
        },
        ledger: Some(ledger),
        exclusions,
        warnings,
        provenance: Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            seed: Some(run.training.seed),
            command: format!(
                "maveric run pipelines/{}.toml",
                folder.file_name().unwrap_or_default().to_string_lossy()
            ),
            parameters: options
                .parameters
                .iter()
                .map(|(name, value)| (format!("pipeline: {name}"), value.clone()))
                .chain(parameters(&run.training))
                .collect(),
            inputs: hashed(
                shown
                    .chain([options.claims.clone()])
                    .chain(files)
                    .chain(logs),
            )?,
        },
    };
    Ok((report, findings))
}

/// The settings of the training, as the page lists them.
pub(super) fn parameters(training: &TrainingSummary) -> Vec<(String, String)> {
    let settings = serde_json::to_value(&training.settings).unwrap_or_default();
    let mut list = Vec::new();
    flatten("training: ", &settings, &mut list);
    list
}

/// The leaves of a JSON value, each under its path.
fn flatten(path: &str, value: &serde_json::Value, list: &mut Vec<(String, String)>) {
    let Some(fields) = value.as_object() else {
        let text = value
            .as_str()
            .map_or_else(|| value.to_string(), str::to_owned);
        list.push((path.trim_end_matches('.').to_owned(), text));
        return;
    };
    for (name, value) in fields {
        flatten(&format!("{path}{name}."), value, list);
    }
}

fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "no value".to_owned(), |v| format!("{:.1}%", 100.0 * v))
}

fn said(c: &Found) -> String {
    match statement(c) {
        Some(s) => s.statement().markup().to_owned(),
        None => format!("not computed from {} pairs", c.n),
    }
}

fn statement(c: &Found) -> Option<Correlation> {
    let coefficient = match c.method.as_str() {
        "spearman" => Coefficient::Spearman,
        "rm_corr" => Coefficient::RepeatedMeasures,
        _ => Coefficient::Pearson,
    };
    Some(Correlation {
        coefficient,
        value: c.r?,
        df: c.df,
        p: c.p?,
    })
}

/// The ten lines that a run ends with.
fn findings(run: &Run) -> Vec<String> {
    let a = &run.analysis;
    let mut lines = Vec::new();
    if a.synthetic {
        lines.push(format!(
            "Synthetic participants: {} training drives, {} test participants, seed {}",
            run.training.drives, a.participants, run.training.seed
        ));
    }
    let accuracy: Vec<String> = a
        .accuracy
        .iter()
        .map(|r| format!("{} {}", r.title.to_lowercase(), percent(r.mean)))
        .collect();
    lines.push(format!("Mimic accuracy: {}", accuracy.join(", ")));
    let adb = |line: &Line| {
        line.rows
            .iter()
            .find(|r| r.measure == "adb")
            .map(|r| said(&r.correlation))
    };
    lines.push(format!(
        "Aggression line against ADB: {} (embedding fitted with the score), {} (without)",
        adb(&a.line).unwrap_or_default(),
        adb(&a.line_without_adb).unwrap_or_default()
    ));
    for panel in &a.panels {
        lines.push(format!(
            "{} over the conditions: {}",
            panel.title,
            conditions::omnibus(panel, false)
        ));
    }
    lines
}

fn printed(ledger: &[LedgerRow], key: &str) -> Option<Correlation> {
    let claim = &ledger.iter().find(|row| row.claim.key == key)?.claim;
    let coefficient = if claim.quantity == claims::Quantity::Rho {
        Coefficient::Spearman
    } else {
        Coefficient::Pearson
    };
    let printed = claim.printed_p.as_ref()?;
    // "< .001" is printed again as such, not as ".001".
    let p = if printed.bound == Some('<') {
        printed.value * 0.999
    } else {
        printed.value
    };
    Some(Correlation {
        coefficient,
        value: claim.printed.value,
        df: claim.df? as usize,
        p,
    })
}

fn capital(word: &str) -> String {
    let words = word.replace('_', "-");
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

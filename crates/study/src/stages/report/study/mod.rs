//! The page of a study.

mod car;
mod conditions;
mod embedding;
mod homophily;
mod learned;
mod manuscript;
mod methods;
mod nameless;
mod not_there;
mod run;
mod setting;
mod setup;
mod watch;

use super::{
    DrawReport,
    inputs::{READ, hashed, in_folder, parameter_files, shown_whole},
    keys::{made, results},
    people::People,
};
use crate::{
    atomic_write::read_text,
    design::DesignFile,
    error::StudyError,
    mean::mean,
    missing::missing,
    once::{names, together},
    outcome::Watch,
    run_folder::{durations, lists, read_scenario},
    stages::{freeze::declared, train::TrainingSummary},
    tables::{drives::read_drive, measurements::MeasuredDrive},
};
use car::section_car;
use conditions::{section_conditions, section_kept};
use embedding::{live, section_embedding};
use homophily::section_homophily;
use learned::section_model;
use maveric_domain::Road;
use maveric_pages::words::{correlation, listed, of_group, omnibus, percent};
use maveric_report::{
    Card, Report, apa,
    claims::{self, LedgerRow},
    html::{Methods, Provenance, Section},
    tables::Exclusion,
};
use nameless::Nameless;
pub(in crate::stages::report) use run::Run;
use setting::{Reliable, listed_exclusions, reliabilities, section_study};
use setup::setup;
use std::{collections::BTreeSet, path::Path};

pub(super) fn page(
    options: &DrawReport,
    watch: Watch<'_>,
) -> Result<(Report, Vec<String>), StudyError> {
    let folder = options.results.as_path();
    let study = DesignFile::find(options.design.as_deref())?;
    let run = Run::read(folder, &study)?;
    let beside = folder.join("participants.csv");
    let participants = options.participants.as_deref().unwrap_or(&beside);
    let people = People::read(
        folder,
        participants,
        &run.measured,
        (&study.design, &run.analysis.flow),
    )?;
    let (road, minutes) = driven(folder, &run)?;
    let given = |key| {
        let mut all = options.parameters.iter();
        all.find(|(name, _)| name == key).map(|(_, value)| value)
    };
    let scenario = given("scenario").map(|path| read_scenario(Some(Path::new(path)), None));
    let scenario = scenario.transpose()?;
    let own_claims = study.design.files().claims.as_ref();
    let claims = options
        .claims
        .clone()
        .or_else(|| own_claims.map(|c| study.resolve(c)));
    let ledger = match &claims {
        Some(path) => {
            let setup = setup(&run, road.as_ref(), minutes, scenario.as_ref())?;
            let claimed = claims::load(&read_text(path)?)?;
            let mut ledger = claims::join(&claimed, &results(&run, &people, &setup))?;
            for row in ledger.iter_mut().filter(|row| row.ours.is_some()) {
                row.made = Some(made(&row.claim.key));
            }
            Some(ledger)
        }
        None => None,
    };
    let claimed = ledger.as_deref().unwrap_or_default();
    watch.check()?;
    let reliabilities = reliabilities(folder, &run.scales)?;
    let findings = findings(&run);
    let logs = watch::logs(folder, &study, &run);
    let watched = watch::drives(&logs)?;
    let mut supplement = Vec::from_iter(section_model(&run)?);
    if let Some(scenario) = scenario.as_ref().filter(|_| run.analysis.synthetic) {
        let sources = given("population_sources").map(Path::new);
        let seed = run.seed().unwrap_or_default();
        supplement.push(section_car(scenario, sources, seed, &run.context)?);
    }
    let said = declared(&study)?;
    // What nobody declared is called what it is, once something was declared.
    let exploratory = |section: Section| Section {
        title: format!("Exploratory: {}", section.title),
        ..section
    };
    let undeclared = |section: Option<Section>| {
        if said.is_empty() {
            section
        } else {
            section.map(exploratory)
        }
    };
    let mut sections = vec![section_conditions(&run, claimed, &watched)?];
    sections.extend(undeclared(section_embedding(folder, &run, claimed)?));
    sections.extend(undeclared(section_kept(&run)?));
    sections.extend(section_homophily(&run, claimed)?);
    sections.push(section_study(folder, &run, &people, &reliabilities)?);
    let missing = missing(&study, folder, options.participants.as_deref())?;
    sections.extend(not_there::section_missing(&run, &missing)?);
    not_there::list(&options.out, &missing)?;
    let nameless = Nameless::of(&study, folder, participants)?;
    let exclusions = nameless.counted(left_out(&run).chain(listed_exclusions(folder)?));
    let exclusions = each_reason_once(exclusions);
    let mut warnings: Vec<String> = run
        .training
        .iter()
        .flat_map(|t| t.warnings.clone())
        .collect();
    if let Some(share) = run.analysis.beyond_training.filter(|s| *s > 0.0) {
        warnings.push(format!(
            "{:.0}% of the embeddings away from 0 on the dial lie further out than any training driver's: the networks extrapolate there",
            100.0 * share
        ));
    }
    let mut moving = Vec::from_iter(live(folder, &run)?);
    moving.extend(watch::player(&run, watched));
    // Without its figure, a part that moves has nothing to stand for it on paper.
    let drawn = |name: &String| {
        sections
            .iter()
            .chain(&supplement)
            .flat_map(|s| &s.figures)
            .any(|f| f.name == *name)
    };
    moving.retain(|live| drawn(&live.below));
    let files = parameter_files(&options.parameters);
    let shown = in_folder(folder, &READ).into_iter();
    let shown = shown.chain([run.model_file.clone(), participants.to_owned()]);
    let parameters = options
        .parameters
        .iter()
        .map(|(name, value)| (format!("pipeline: {name}"), value.clone()));
    let mut paragraphs = methods::text(&run, road.as_ref(), minutes);
    if let Some(balance) = &run.analysis.orders {
        let told = maveric_pages::orders(&study.design, balance)?;
        paragraphs.push(("Orders", told.join(" ")));
    }
    let report = Report {
        manuscript: Some(manuscript::manuscript(&run, &paragraphs, &reliabilities)),
        glossary: crate::stages::report::words::glossary(),
        cards: cards(&run, &reliabilities, ledger.as_deref())?,
        summary: said,
        live: moving,
        sections,
        supplement,
        methods: Methods {
            text: methods::on_page(&paragraphs),
            files: nameless.files(shown_whole(
                &study
                    .path
                    .iter()
                    .cloned()
                    .chain(files.clone())
                    .collect::<Vec<_>>(),
            )?),
        },
        ledger,
        exclusions,
        warnings,
        provenance: Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            seed: run.seed(),
            command: options.command.clone().unwrap_or_default(),
            parameters: parameters
                .chain(run.training.iter().flat_map(parameters_of))
                .collect(),
            inputs: hashed(
                shown
                    .chain(study.path.clone())
                    .chain(claims)
                    .chain(files)
                    .chain(logs),
            )?,
        },
        ..Report::new(study.design.title(), subtitle(&run), &run.context)
    };
    Ok((report, findings))
}

/// The road, and how long the baseline drives of those who were tested took, in minutes; of any drive where there is no baseline.
fn driven(folder: &Path, run: &Run) -> Result<(Option<Road>, Option<f64>), StudyError> {
    let durations = durations(folder)?;
    let baseline = run.design.baseline_id();
    let tested: BTreeSet<&str> = run
        .analysis
        .panels
        .iter()
        .flat_map(|p| &p.participants)
        .map(String::as_str)
        .collect();
    let mine = |d: &&MeasuredDrive| {
        tested.contains(d.meta.participant.as_str())
            && (baseline.is_none() || Some(d.meta.condition) == baseline)
    };
    let minutes: Vec<f64> = run
        .measured
        .iter()
        .filter(mine)
        .filter_map(|d| Some(durations.get(&d.meta.drive)? / 60.0))
        .collect();
    let mean = mean(&minutes);
    for drive in run.measured.iter().filter(mine) {
        let name = format!("{}.parquet", drive.meta.drive);
        let beside = lists(folder)
            .into_iter()
            .map(|list| list.with_file_name(&name));
        if let Some(path) = beside.into_iter().find(|p| p.is_file()) {
            return Ok((Some(*read_drive(&path)?.road()), mean));
        }
    }
    Ok((None, mean))
}

/// How many took part in what.
fn subtitle(run: &Run) -> String {
    let made_up = run.context.preface();
    let learned = run.training.as_ref().map_or_else(String::new, |t| {
        format!("{} drives to learn from, ", t.drives)
    });
    let conditions = run.design.conditions();
    let (count, s) = match conditions.len() {
        1 => ("one".to_owned(), ""),
        n => (in_words(n), "s"),
    };
    let labels: Vec<String> = conditions.iter().map(|c| run.label(c.id)).collect();
    format!(
        "{made_up}{learned}{} participants in {count} condition{s}: {}",
        run.analysis.participants,
        listed(&labels)
    )
}

/// A small number as a word.
fn in_words(n: usize) -> String {
    const WORDS: [&str; 10] = [
        "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine",
    ];
    WORDS
        .get(n)
        .map_or_else(|| n.to_string(), |w| (*w).to_owned())
}

/// The same said of several is one row of all of them.
fn each_reason_once(rows: Vec<Exclusion>) -> Vec<Exclusion> {
    let rows = rows.into_iter().map(|row| (row.who, (row.what, row.why)));
    let row = |(who, (what, why)): (Vec<String>, (String, String))| Exclusion {
        who: if who.len() > 1 {
            format!("{} ({} in all)", names(&who), who.len())
        } else {
            who.concat()
        },
        what,
        why,
    };
    together(rows).into_iter().map(row).collect()
}

/// Who and what the design leaves out, and who lacks a value where.
fn left_out(run: &Run) -> impl Iterator<Item = Exclusion> {
    let flow = &run.analysis.flow;
    let rows = flow.left_out.iter().map(|l| (l, "everything"));
    let rows = rows.chain(
        flow.drives
            .iter()
            .map(|l| (l, "everything, with what was said of it")),
    );
    let named = rows.map(|(l, what)| Exclusion {
        who: l.who.join(", "),
        what: what.to_owned(),
        why: l.why.clone(),
    });
    let lacking = run.analysis.exclusions.iter().map(|e| Exclusion {
        who: e.who.clone(),
        what: e.what.clone(),
        why: e.why.clone(),
    });
    named.chain(lacking)
}

/// The settings of the training, as the page lists them.
pub(super) fn parameters_of(training: &TrainingSummary) -> Vec<(String, String)> {
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

/// What the page opens with: its findings in words, and what the paper's ledger says.
fn cards(
    run: &Run,
    reliabilities: &[Reliable],
    ledger: Option<&[LedgerRow]>,
) -> Result<Vec<Card>, StudyError> {
    let alpha = run.design.style().and_then(|style| {
        let score = style.score.to_string();
        let of_score = reliabilities.iter().find(|r| r.id == score)?;
        of_score.found.alpha
    });
    let study = maveric_pages::cards::study::Study {
        design: &run.design,
        analysis: &run.analysis,
        conditions: &run.conditions,
        alpha,
        steps: !embedding::steps(run).is_empty(),
    };
    let mut cards = maveric_pages::cards::study::cards(&study)?;
    if let Some(ledger) = ledger {
        cards.push(maveric_pages::cards::study::against_the_paper(ledger)?);
    }
    Ok(cards)
}

/// The lines that a run ends with.
fn findings(run: &Run) -> Vec<String> {
    let a = &run.analysis;
    let mut lines = vec![subtitle(run)];
    if let Some(first) = a.reproduction.first() {
        let accuracy: Vec<String> = a
            .reproduction
            .iter()
            .map(|r| format!("{} {}", r.title.to_lowercase(), percent(r.mean)))
            .collect();
        let label = run.label(first.condition);
        lines.push(format!("Accuracy of {label}: {}", accuracy.join(", ")));
    }
    for line in [&a.line, &a.line_without_adb].into_iter().flatten() {
        if let Some(score) = line.rows.last() {
            let fitted = if line.adb_used { "with" } else { "without" };
            lines.push(format!(
                "Position on the line against {}: {} (embedding fitted {fitted} the score)",
                score.title,
                correlation(&score.correlation)
            ));
        }
    }
    for panel in &a.panels {
        lines.push(format!(
            "{}{} over the conditions: {}",
            panel.title,
            of_group(panel),
            omnibus(panel, false)
        ));
    }
    lines
}

/// The correlation that the paper printed.
fn printed(ledger: &[LedgerRow], key: &str) -> Option<apa::Statement> {
    let claim = &ledger.iter().find(|row| row.claim.key == key)?.claim;
    let write = match claim.quantity {
        claims::Quantity::Rho => apa::rho,
        _ => apa::r,
    };
    let printed = claim.printed_p.as_ref()?;
    // "< .001" is printed again as such, not as ".001".
    let p = if printed.bound == Some('<') {
        printed.value * 0.999
    } else {
        printed.value
    };
    Some(write(claim.printed.value, claim.df? as usize, p))
}

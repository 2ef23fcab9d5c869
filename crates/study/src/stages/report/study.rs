//! The page of a study.

mod car;
mod embedding;
mod items;
mod learned;
mod nameless;
mod not_there;
mod run;
mod setting;
mod setup;
mod watch;

use super::{
    DrawReport,
    inputs::{READ, hashed, in_folder, parameter_files, shown_whole},
    keys::{origin, results},
    people::People,
    scene,
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
    watching::WatchedDrive,
};
use car::section_car;
use embedding::{live, section_embedding};
use items::items_of_reduced;
use learned::section_model;
use maveric_domain::Road;
use maveric_model::Model;
use maveric_pages::glossary;
use maveric_pages::study::{Facts, Reliability, StudyPage, steps};
use maveric_report::{
    Card, Report,
    claims::{self, LedgerRow},
    html::{Live, Methods, Provenance, Section},
    tables::Exclusion,
};
use maveric_simulator::Scenario;
use nameless::Nameless;
pub(in crate::stages::report) use run::Run;
use setting::{listed_exclusions, reliabilities};
use setup::setup;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

pub(super) fn page(
    options: &DrawReport,
    watch: Watch<'_>,
) -> Result<(Report, Vec<String>), StudyError> {
    let folder = options.results.as_path();
    let study = DesignFile::find(options.design.as_deref())?;
    let mut run = Run::read(folder, &study)?;
    let beside = folder.join("participants.csv");
    let participants = options.participants.as_deref().unwrap_or(&beside);
    let people =
        People::read(folder, participants, &run.measured, (&study.design, &run.analysis.flow))?;
    let nameless = Nameless::read(&study, folder, participants)?;
    nameless.clear(&mut run.analysis.flow);
    let (road, minutes) = driven(folder, &run)?;
    let scenario = options.parameter("scenario");
    let scenario = scenario.map(|path| read_scenario(Some(Path::new(path)), None));
    let scenario = scenario.transpose()?;
    let own_claims = study.design.files().claims.as_ref();
    let own_claims = own_claims.map(|c| study.resolve(c));
    let claims = options.claims.clone().or(own_claims);
    let ledger = claims.as_ref().map(|path| {
        let setup = setup(&run, road.as_ref(), minutes, scenario.as_ref())?;
        ledger(path, &results(&run, &people, &setup))
    });
    let ledger = ledger.transpose()?;
    let facts = Facts {
        training: run.training.as_ref(),
        embedding_size: run.model.as_ref().map(Model::embedding_size),
        score_range: run.score_range(),
        posted_mps: road.map(|r| r.posted_speed_mps),
        road,
        minutes,
    };
    let claimed = ledger.as_deref().unwrap_or_default();
    let of_study = (&run.design, &run.analysis);
    let page = StudyPage::new(of_study, &run.context, claimed, &facts)?;
    watch.check()?;
    let scales = study.design.with_dropped_items(run.scales.clone());
    let reliabilities = reliabilities(folder, &scales)?;
    let logs = watch::logs(folder, &study, &run);
    let watched = watch::drives(&logs)?;
    let supplement = supplement(options, &run, scenario.as_ref(), &page)?;
    let declaration = declared(&study)?;
    let sample = Sample {
        people: &people,
        reliabilities: &reliabilities,
        is_declared: !declaration.is_empty(),
    };
    let mut sections = sections(folder, &run, &page, (&sample, &watched))?;
    let missing = missing(&study, folder, options.participants.as_deref())?;
    let missing = nameless.missing(missing);
    sections.extend(not_there::section_missing(&run, &missing)?);
    not_there::list(&options.out, &missing)?;
    let exclusions = nameless.counted(left_out(&run).chain(listed_exclusions(folder)?));
    let exclusions = each_reason_once(exclusions);
    let live = live(folder, &run)?.into_iter();
    let live = live.chain(watch::player(&run, watched));
    let live = with_figures(live, sections.iter().chain(&supplement));
    let files = parameter_files(&options.parameters);
    let shown = study.path.iter().chain(&files).cloned();
    let shown = nameless.files(shown_whole(&shown.collect::<Vec<_>>())?);
    let read = in_folder(folder, &READ).into_iter();
    let read = read
        .chain([run.model_file.clone(), participants.to_owned()])
        .chain(study.path.clone())
        .chain(claims)
        .chain(files)
        .chain(logs);
    let mut report = Report {
        glossary: glossary(),
        cards: cards(&run, &reliabilities, ledger.as_deref())?,
        summary: declaration,
        live,
        sections,
        supplement,
        methods: Methods { text: page.methods_on_page()?, files: shown },
        ledger: ledger.clone(),
        exclusions,
        warnings: warnings(&run, &page)?,
        provenance: Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            seed: run.seed(),
            command: options.command.clone().unwrap_or_default(),
            parameters: parameters(options, &run),
            inputs: hashed(read)?,
        },
        ..Report::new(study.design.title(), page.subtitle()?, &run.context)
    };
    let groups = people.groups();
    report.beside = page.manuscript(&report, &groups, &run.scales, &reliabilities)?;
    Ok((report, page.lines()?))
}

/// The parts that move whose figure is drawn: without it they have nothing to stand for them on paper.
fn with_figures<'a>(
    live: impl Iterator<Item = Live>,
    sections: impl Iterator<Item = &'a Section>,
) -> Vec<Live> {
    let figures = sections.flat_map(|section| &section.figures);
    let drawn: BTreeSet<&str> = figures.map(|figure| figure.name.as_str()).collect();
    live.filter(|live| drawn.contains(live.below.as_str())).collect()
}

/// The paper's claims in this file, each with our result and what made it.
fn ledger(path: &Path, ours: &BTreeMap<String, f64>) -> Result<Vec<LedgerRow>, StudyError> {
    let claimed = claims::load(&read_text(path)?)?;
    let mut ledger = claims::join(&claimed, ours)?;
    for row in ledger.iter_mut().filter(|row| row.ours.is_some()) {
        row.made = Some(origin(&row.claim.key));
    }
    Ok(ledger)
}

/// How the model was learned, and the car that made-up people drove.
fn supplement(
    options: &DrawReport,
    run: &Run,
    scenario: Option<&Scenario>,
    page: &StudyPage<'_>,
) -> Result<Vec<Section>, StudyError> {
    let mut supplement = Vec::from_iter(section_model(run, page)?);
    if let Some(scenario) = scenario.filter(|_| run.analysis.synthetic) {
        let sources = options.parameter("population_sources").map(Path::new);
        let seed = run.seed().unwrap_or_default();
        supplement.push(section_car(scenario, sources, seed, page)?);
    }
    Ok(supplement)
}

/// Who was asked what, and whether what is tested was declared before.
struct Sample<'a> {
    people: &'a People,
    reliabilities: &'a [Reliability],
    is_declared: bool,
}

/// The results, from the conditions to the setting.
fn sections(
    folder: &Path,
    run: &Run,
    page: &StudyPage<'_>,
    (sample, watched): (&Sample<'_>, &[WatchedDrive]),
) -> Result<Vec<Section>, StudyError> {
    // What nobody declared is called what it is, once something was declared.
    let undeclared = |section: Option<Section>| -> Result<Option<Section>, StudyError> {
        let Some(section) = section else {
            return Ok(None);
        };
        if !sample.is_declared {
            return Ok(Some(section));
        }
        let titled = BTreeMap::from([("title", &section.title)]);
        let title = page.texts.with(&titled).text("exploratory")?;
        Ok(Some(Section { title, ..section }))
    };
    let own_style = run.design.own_style();
    let mut conditions = run.design.conditions().iter();
    let shown = own_style.or(conditions.clone().next().map(|c| c.id));
    let drive = watched.iter().find(|d| Some(d.meta.condition) == shown);
    let drive = drive.and_then(watch::diagram);
    let items = items_of_reduced(folder, run)?;
    let mut sections = vec![page.conditions(drive.as_ref(), &items)?];
    sections.extend(undeclared(section_embedding(folder, run, page)?)?);
    sections.extend(undeclared(page.kept()?)?);
    sections.extend(page.homophily()?);
    sections.extend(page.presses()?);
    sections.extend(page.repeats()?);
    let view = own_style.or(conditions.find(|c| c.simulated()).map(|c| c.id));
    let view = scene::view(&folder.join("av/logs"), view)?;
    sections.push(page.setting(
        run.model.is_some(),
        view.as_ref(),
        &sample.people.groups(),
        sample.reliabilities,
    )?);
    Ok(sections)
}

/// What the training warned of, and whose styles lie beyond it.
fn warnings(run: &Run, page: &StudyPage<'_>) -> Result<Vec<String>, StudyError> {
    let training = run.training.iter();
    let mut warnings: Vec<String> = training.flat_map(|t| t.warnings.clone()).collect();
    if let Some(share) = run.analysis.beyond_training.filter(|s| *s > 0.0) {
        let texts = page.texts.with(&BTreeMap::from([("share", share)]));
        warnings.push(texts.text("beyond")?);
    }
    Ok(warnings)
}

/// Those of the pipeline and of the training.
fn parameters(options: &DrawReport, run: &Run) -> Vec<(String, String)> {
    let named = options.parameters.iter();
    let pipeline = named.map(|(name, value)| (format!("pipeline: {name}"), value.clone()));
    pipeline.chain(run.training.iter().flat_map(parameters_of)).collect()
}

/// The road, and how long the baseline drives of those who were tested took, in minutes; of any drive where there is no baseline.
fn driven(folder: &Path, run: &Run) -> Result<(Option<Road>, Option<f64>), StudyError> {
    let durations = durations(folder)?;
    let baseline = run.design.baseline_id();
    let tested: BTreeSet<&str> =
        run.analysis.panels.iter().flat_map(|p| &p.participants).map(String::as_str).collect();
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
        let beside = lists(folder).into_iter().map(|list| list.with_file_name(&name));
        if let Some(path) = beside.into_iter().find(|p| p.is_file()) {
            return Ok((Some(*read_drive(&path)?.road()), mean));
        }
    }
    Ok((None, mean))
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
    let rows = rows.chain(flow.drives.iter().map(|l| (l, nameless::WITH_WHAT_WAS_SAID)));
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
        let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
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
    reliabilities: &[Reliability],
    ledger: Option<&[LedgerRow]>,
) -> Result<Vec<Card>, StudyError> {
    let alpha = run.design.style().and_then(|style| {
        let score = style.score.to_string();
        reliabilities.iter().find(|r| r.id == score)?.alpha
    });
    let study = maveric_pages::cards::study::Study {
        design: &run.design,
        analysis: &run.analysis,
        conditions: &run.conditions,
        score_range: run.score_range(),
        alpha,
        steps: !steps(&run.design, &run.conditions).is_empty(),
    };
    let mut cards = maveric_pages::cards::study::cards(&study)?;
    if let Some(ledger) = ledger {
        cards.push(maveric_pages::cards::study::against_the_paper(ledger)?);
    }
    Ok(cards)
}

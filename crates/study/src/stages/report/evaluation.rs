//! The page of an evaluation on recorded driving.

use super::{
    DrawReport,
    inputs::{hashed, in_folder},
};
use crate::{
    atomic_write::read_json,
    design::DesignFile,
    error::StudyError,
    run_folder::{MODEL_FILE, training_path},
    stages::{
        evaluate::{
            findings,
            tables::{compared, errors as errors_of_methods, texts},
        },
        train::TrainingSummary,
    },
};
use maveric_following::{DriverEvaluation, FollowingEvaluation, FollowingMethod};
use maveric_pages::cards::following::Following;
use maveric_report::{
    Context, Report,
    figures::{
        car_following::{CarFollowing, Follower, FollowingSeries, car_following},
        following_errors::{FollowingErrors, ModelErrors, following_errors},
    },
    html::Provenance,
};
use std::collections::BTreeMap;

/// The methods that the figures show.
const SHOWN: [(FollowingMethod, Follower); 3] = [
    (FollowingMethod::IdmPopulation, Follower::IdmPopulation),
    (FollowingMethod::IdmPopulationOwnTimeGap, Follower::IdmOwnTimeGap),
    (FollowingMethod::IdmOwn, Follower::Idm),
];

pub(super) fn page(options: &DrawReport) -> Result<(Report, Vec<String>), StudyError> {
    let folder = options.results.as_path();
    let training_file = training_path(&folder.join(MODEL_FILE));
    if !training_file.is_file() {
        let problem = "holds following.json without model_training.json, of which the page of an evaluation is made too";
        let help = "`maveric train --out FOLDER/model.maveric` writes it, `maveric evaluate` prints its numbers without a page; pipelines/openacc.toml makes both files and the page";
        return Err(StudyError::file(folder, problem).with_help(help));
    }
    let evaluation: FollowingEvaluation = read_json(&folder.join("following.json"))?;
    let training: TrainingSummary = read_json(&training_file)?;
    let context = Context::real();
    let titled = options.design.as_deref().map(|path| DesignFile::find(Some(path)));
    let titled = titled.transpose()?.map(|d| d.design.title().to_owned());
    let texts = &texts(&evaluation, titled.as_deref())?;
    let data_set = match titled {
        Some(title) => title,
        None => texts.text("recorded")?,
    };
    let errors_of = |method| -> Vec<f64> {
        let gap_rmse_m = |d: &DriverEvaluation| d.gap_rmse_m(method);
        evaluation.drivers.iter().filter_map(gap_rmse_m).collect()
    };
    let errors = FollowingErrors {
        data_set: data_set.clone(),
        drivers: evaluation.drivers.iter().map(|d| d.driver.clone()).collect(),
        models: SHOWN
            .into_iter()
            .map(|(method, model)| ModelErrors { model, gap_rmse_m: errors_of(method) })
            .collect(),
    };
    let mut figures = vec![following_errors(&errors, &context)?];
    for driver in &evaluation.drivers {
        figures.push(car_following(&drives_of(driver, &data_set), &context)?);
    }
    let mut summary = vec![texts.text("driven")?];
    for reason in training.networks.iter().flat_map(|n| &n.left_out) {
        let texts = texts.with(&BTreeMap::from([("reason", reason)]));
        summary.push(texts.text("left_out")?);
    }
    let judged = findings::findings(&evaluation);
    let following =
        Following { found: &evaluation, personal: findings::beside_everybody(&evaluation) };
    let cards = following.cards(&judged)?;
    let lines = cards.iter().map(|card| {
        let parts =
            [("question", &card.question), ("verdict", &card.verdict), ("answer", &card.answer)];
        texts.with(&BTreeMap::from(parts)).text("card")
    });
    let mut findings: Vec<String> = lines.collect::<Result<_, _>>()?;
    findings.extend(summary.clone());
    let drives = figures.split_off(1);
    let [means, by_driver] = errors_of_methods(&evaluation, texts)?;
    let tables = vec![means, by_driver, compared(&evaluation, texts)?];
    let new = texts.page(&context, (training.seed, options.command.as_deref()))?;
    let inputs = ["following.json", "model.maveric", "model_training.json"];
    let report = Report {
        cards,
        summary,
        sections: vec![texts.section("following", figures, tables)?],
        supplement: vec![texts.section("drivers", drives, Vec::new())?],
        warnings: training.warnings.clone(),
        provenance: Provenance {
            parameters: super::study::parameters_of(&training),
            inputs: hashed(in_folder(folder, &inputs))?,
            ..new.provenance
        },
        ..new
    };
    Ok((report, findings))
}

/// A driver's recorded drive, and those simulated in its place.
fn drives_of(driver: &DriverEvaluation, data_set: &str) -> CarFollowing {
    let series = &driver.series;
    let recorded = FollowingSeries {
        follower: Follower::Recorded,
        gap_m: series.gap_m.clone(),
        speed_mps: series.ego_speed_mps.clone(),
    };
    let simulated = SHOWN.iter().filter_map(|(method, follower)| {
        let s = series.simulated.iter().find(|s| s.method == *method)?;
        Some(FollowingSeries {
            follower: *follower,
            gap_m: s.gap_m.clone(),
            speed_mps: s.speed_mps.clone(),
        })
    });
    CarFollowing {
        driver: driver.driver.clone(),
        data_set: data_set.to_owned(),
        time_s: series.time_s.clone(),
        series: std::iter::once(recorded).chain(simulated).collect(),
    }
}

//! The page of an evaluation on recorded driving.

use super::{
    DrawReport,
    inputs::{hashed, in_folder},
    page_of,
};
use crate::{
    atomic_write::read_json,
    design::DesignFile,
    error::StudyError,
    run_folder::{MODEL_FILE, training_path},
    stages::{
        evaluate::{
            findings::{self, NETWORKS},
            tables::{compared, following_table, shrinkage},
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
    html::{Provenance, Section},
    tables::{Cell, Table},
};

/// The methods that the figure of errors shows.
const COMPARED: [(FollowingMethod, Follower); 7] = [
    (FollowingMethod::ClosedLoopShrunken, Follower::ClosedLoop),
    (FollowingMethod::ClosedLoopMean, Follower::ClosedLoopMean),
    (FollowingMethod::FollowingDistanceOwn, Follower::Model),
    (
        FollowingMethod::FollowingDistanceMean,
        Follower::MeanEmbedding,
    ),
    (
        FollowingMethod::ConstantTimeGapOwn,
        Follower::ConstantTimeGap,
    ),
    (FollowingMethod::IdmOwn, Follower::Idm),
    (FollowingMethod::IdmFloor, Follower::Floor),
];

/// The methods whose drives the figures of single drivers show.
const SHOWN: [(FollowingMethod, Follower); 4] = [
    (FollowingMethod::ClosedLoopShrunken, Follower::ClosedLoop),
    (FollowingMethod::FollowingDistanceOwn, Follower::Model),
    (
        FollowingMethod::FollowingDistanceMean,
        Follower::MeanEmbedding,
    ),
    (FollowingMethod::IdmOwn, Follower::Idm),
];

pub(super) fn page(options: &DrawReport) -> Result<(Report, Vec<String>), StudyError> {
    let folder = options.results.as_path();
    let found: FollowingEvaluation = read_json(&folder.join("following.json"))?;
    let training: TrainingSummary = read_json(&training_path(&folder.join(MODEL_FILE)))?;
    let context = Context::real();
    let titled = options
        .design
        .as_deref()
        .map(|path| DesignFile::find(Some(path)));
    let titled = titled.transpose()?.map(|d| d.design.title().to_owned());
    let data_set = titled
        .clone()
        .unwrap_or_else(|| format!("{} recorded drivers", found.drivers.len()));
    let drivers: Vec<String> = found.drivers.iter().map(|d| d.driver.clone()).collect();
    let errors_of = |method| -> Vec<f64> {
        let of = |d: &DriverEvaluation| d.gap_rmse_m(method);
        found.drivers.iter().filter_map(of).collect()
    };
    let errors = FollowingErrors {
        data_set: data_set.clone(),
        drivers: drivers.clone(),
        models: COMPARED
            .into_iter()
            .filter(|(method, _)| found.mean(*method).is_some())
            .map(|(method, model)| ModelErrors {
                model,
                gap_rmse_m: errors_of(method),
            })
            .collect(),
    };
    let mut figures = vec![following_errors(&errors, &context)?];
    for driver in &found.drivers {
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
        let input = CarFollowing {
            driver: driver.driver.clone(),
            data_set: data_set.clone(),
            time_s: series.time_s.clone(),
            series: std::iter::once(recorded).chain(simulated).collect(),
        };
        figures.push(car_following(&input, &context)?);
    }
    let mut summary = shrinkage(&found);
    summary.push(format!(
        "Driven by default, as chosen once on fit rows of other people: {}.",
        found.driven.label()
    ));
    summary.extend(
        training
            .networks
            .iter()
            .flat_map(|n| &n.left_out)
            .map(|l| format!("Left out of the training: {l}.")),
    );
    let judged = findings::findings(&found);
    let following = Following {
        found: &found,
        peers: findings::beside_peers(&found),
        personal: findings::beside_everybody(&found),
        networks: &NETWORKS,
        driven: found.driven,
    };
    let cards = following.cards(&judged)?;
    let said = cards
        .iter()
        .map(|c| format!("{} {}: {}", c.question, c.verdict, c.answer));
    let findings: Vec<String> = said.chain(summary.clone()).collect();
    let drives = figures.split_off(1);
    let sections = vec![Section {
        title: "Car-following on the unseen last third".to_owned(),
        intro: vec![
            "Only the leader is recorded in these simulations: from the true gap and speed at the first unseen row, each model \
             drives to the end of the drive on its own. The network gives a following distance, which a controller \
             with gains fitted to the *other* drivers and the safety rule turns into acceleration. The network in closed \
             loop was trained through half a minute of its own simulated following and gives a controller its \
             parameters under the same rule. A car is not a \
             person, and a pair of vehicles is one meeting of two drivers."
                .to_owned(),
        ],
        figures,
        tables: vec![
            following_table(&found, &data_set),
            by_driver(&found),
            compared(&found),
        ],
    }];
    let title = titled.unwrap_or_else(|| "Car-following of recorded drivers".to_owned());
    let subtitle = format!(
        "{} drivers recorded on a road or track: speed and gap of each in closed loop over a last third that no fit has seen",
        drivers.len()
    );
    let method = "Networks learn from the first two thirds of each drive; an embedding is fitted to the same part; the last third \
         judges. What each method knows of a driver, and how, is in docs/real-data.md.";
    let new = page_of(
        (&title, subtitle),
        &context,
        method,
        (
            training.seed,
            options.command.as_deref().unwrap_or_default(),
        ),
    );
    let inputs = ["following.json", "model.maveric", "model_training.json"];
    let report = Report {
        cards,
        summary,
        sections,
        supplement: vec![Section {
            title: "Driver by driver".to_owned(),
            figures: drives,
            ..Section::default()
        }],
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

/// The gap's error of every driver by every method: one row a method, one column a driver.
fn by_driver(found: &FollowingEvaluation) -> Table {
    let table = Table::of(
        "following-by-driver",
        "The same, driver by driver",
        &found.means,
    )
    .text("Model", |mean| mean.method.label());
    let drivers = found.drivers.iter();
    drivers
        .fold(table, |table, driver| {
            table.right(&driver.driver, |mean| Cell::number(driver.gap_rmse_m(mean.method), 2))
        })
        .noted("Root-mean-square error of the gap in closed loop over the unseen last third, in m. No test.")
}

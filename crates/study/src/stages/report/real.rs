//! The page of an evaluation on recorded driving.

use super::{
    ReportOptions,
    inputs::{hashed, in_folder},
};
use crate::{
    atomic_write::read_json,
    error::StudyError,
    run_folder::{MODEL_FILE, training_path},
    stages::train::TrainingSummary,
};
use maveric_following::{
    DriverEvaluation, FollowingEvaluation, FollowingMethod, MethodMean, Shrinkage,
};
use maveric_report::{
    Context, Report,
    figures::{
        car_following::{CarFollowing, Follower, FollowingSeries, car_following},
        following_errors::{FollowingErrors, ModelErrors, following_errors},
    },
    html::{Methods, Provenance, Section},
    tables::{self, Cell, Column, FollowingRow, Table},
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

pub(super) fn page(options: &ReportOptions) -> Result<(Report, Vec<String>), StudyError> {
    let folder = options.results.as_path();
    let found: FollowingEvaluation = read_json(&folder.join("following.json"))?;
    let training: TrainingSummary = read_json(&training_path(&folder.join(MODEL_FILE)))?;
    let context = Context::real();
    let data_set = folder
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let rows: Vec<FollowingRow> = found
        .means
        .iter()
        .map(|m| FollowingRow {
            model: m.method.label().to_owned(),
            gap_rmse_m: Some(m.gap_rmse_m),
            gap_rmse_median_m: Some(m.gap_rmse_median_m),
            speed_rmse_mps: Some(m.speed_rmse_mps),
            gap_nrmse: Some(m.nrmse),
            mixed: Some(m.mixed),
            best: found.is_best(m.method),
            reached_zero: Some(m.reached_zero),
        })
        .collect();
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
    let mut summary = vec![format!(
        "{} drivers, recorded by instruments on a road or track; each one's last third was seen by no fit.",
        drivers.len()
    )];
    for (method, _) in SHOWN {
        if let Some(m) = found.mean(method) {
            summary.push(format!(
                "{}: gap {:.2} m, speed {:.2} m/s (RMSE in closed loop, mean over drivers); the simulated gap reached 0 for {} of {}.",
                m.method.label(),
                m.gap_rmse_m,
                m.speed_rmse_mps,
                m.reached_zero,
                m.drivers
            ));
        }
    }
    summary.extend(shrinkage(&found));
    if let Some(choice) = &found.driven {
        summary.push(format!(
            "Driven by default, as the best on the fit rows of those who were learned from: {}.",
            choice.method.label()
        ));
    }
    for (what, own, mean) in [
        (
            "F",
            FollowingMethod::FollowingDistanceOwn,
            FollowingMethod::FollowingDistanceMean,
        ),
        (
            "the network in closed loop",
            FollowingMethod::ClosedLoopOwn,
            FollowingMethod::ClosedLoopMean,
        ),
        (
            "the network in closed loop, shrunken,",
            FollowingMethod::ClosedLoopShrunken,
            FollowingMethod::ClosedLoopMean,
        ),
    ] {
        let harmed = found.harmed(own, mean);
        if found.mean(own).is_some() {
            summary.push(if harmed.is_empty() {
                format!("Personalising {what} harms no driver.")
            } else {
                format!("Personalising {what} harms {}.", harmed.join(", "))
            });
        }
    }
    summary.extend(
        training
            .networks
            .iter()
            .flat_map(|n| &n.left_out)
            .map(|l| format!("Left out of the training: {l}.")),
    );
    let findings = summary.clone();
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
            tables::following_errors(&rows, &data_set, drivers.len()),
            by_driver(&found),
            compared(&found),
        ],
    }];
    let report = Report {
        title: format!("Car-following of recorded drivers: {data_set}"),
        subtitle: "Prediction of each driver's speed and gap in closed loop, beside a constant time gap and IDM".to_owned(),
        context,
        summary,
        sections,
        live: Vec::new(),
        methods: Methods {
            text: vec![
                "Networks learn from the first two thirds of each drive; an embedding is fitted to the same part; the last third \
                 judges. What each method knows of a driver, and how, is in docs/real-data.md."
                    .to_owned(),
            ],
            files: Vec::new(),
        },
        ledger: None,
        exclusions: Vec::new(),
        warnings: training.warnings.clone(),
        provenance: Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            seed: Some(training.seed),
            command: options.command.clone(),
            parameters: super::synthetic::parameters_of(&training),
            inputs: hashed(in_folder(
                folder,
                &["following.json", "model.maveric", "model_training.json"],
            ))?,
        },
    };
    Ok((report, findings))
}

/// How much of what was fitted to a person was believed.
fn shrinkage(found: &FollowingEvaluation) -> Vec<String> {
    let one = |what: &str, s: &Shrinkage| {
        let strength = s
            .strength_s
            .map_or_else(|| "no bound".to_owned(), |k| format!("{k:.0} s"));
        format!(
            "Shrunken is the own {what} towards what people are like, by how far {} people moved between the halves of their fit \
             rows: strength {strength}; of a fit to {:.0} s {:.0} % is kept.",
            s.people,
            2.0 * s.half_s,
            100.0 * s.share(2.0 * s.half_s)
        )
    };
    let network = found.closed_loop.as_ref().and_then(|c| c.trained.first());
    std::iter::once(one("time gap", &found.time_gap_shrinkage))
        .chain(network.map(|n| one("embedding", &n.shrinkage)))
        .collect()
}

/// Two methods driver by driver.
fn compared(found: &FollowingEvaluation) -> Table {
    let rows = found.compared.iter().map(|pair| {
        vec![
            Cell::text(pair.method.label()),
            Cell::text(pair.beside.label()),
            Cell::number(Some(pair.mean_m), 2),
            Cell::number(pair.low_m, 2),
            Cell::number(pair.high_m, 2),
            Cell::number(Some(pair.median_m), 2),
            Cell::text(format!("{}/{}", pair.better, pair.worse)),
        ]
    });
    Table {
        name: "following-compared".to_owned(),
        title: "Two models driver by driver".to_owned(),
        columns: vec![
            Column::left("Model"),
            Column::left("less"),
            Column::right("Mean (m)"),
            Column::right("2.5 %"),
            Column::right("97.5 %"),
            Column::right("Median (m)"),
            Column::right("Nearer/further"),
        ],
        rows: rows.collect(),
        notes: vec![
            "Root-mean-square error of the gap under one model less that under the other. Interval of the mean: bootstrap, \
             drivers drawn with replacement; with a handful of drivers it is too narrow. A few drivers carry a mean: the median \
             and the counts say how many. No test."
                .to_owned(),
        ],
    }
}

/// The gap's error of every driver by every method: one row a method, one column a driver.
fn by_driver(found: &FollowingEvaluation) -> Table {
    let mut columns = vec![Column::left("Model")];
    columns.extend(found.drivers.iter().map(|d| Column::right(&d.driver)));
    let row = |mean: &MethodMean| {
        let errors = found.drivers.iter().map(|d| d.gap_rmse_m(mean.method));
        std::iter::once(Cell::text(mean.method.label()))
            .chain(errors.map(|e| Cell::number(e, 2)))
            .collect()
    };
    Table {
        name: "following-by-driver".to_owned(),
        title: "The same, driver by driver".to_owned(),
        columns,
        rows: found.means.iter().map(row).collect(),
        notes: vec!["Root-mean-square error of the gap in closed loop over the unseen last third, in m. No test.".to_owned()],
    }
}

//! The page of an evaluation on recorded driving.

use super::{
    ReportOptions,
    card::{card, interval, must_not_happen, number, plot},
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
use maveric_analysis::{Finding, Question};
use maveric_following::{
    Compared, DriverEvaluation, FollowingEvaluation, FollowingMethod, Knows, MethodMean,
};
use maveric_report::{
    Card, Context, Report, apa,
    figures::{
        car_following::{CarFollowing, Follower, FollowingSeries, car_following},
        following_errors::{FollowingErrors, ModelErrors, following_errors},
        intervals::IntervalRow,
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

pub(super) fn page(options: &ReportOptions) -> Result<(Report, Vec<String>), StudyError> {
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
    if let Some(choice) = &found.driven {
        summary.push(format!(
            "Driven by default, as the best on the fit rows of those who were learned from: {}.",
            choice.method.label()
        ));
    }
    summary.extend(
        training
            .networks
            .iter()
            .flat_map(|n| &n.left_out)
            .map(|l| format!("Left out of the training: {l}.")),
    );
    let judged = findings::findings(&found);
    let words = |finding: &Finding| match finding.question {
        Question::Better => Some(better(&found, finding)),
        Question::Personal => Some(personal(&found, finding)),
        Question::Reached => Some(reached(&found, finding)),
        _ => None,
    };
    let cards: Vec<Card> = judged.iter().filter_map(words).collect();
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
        (training.seed, &options.command),
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

/// Lowest mean error among the methods that know so much.
fn best(found: &FollowingEvaluation, knows: Knows) -> Option<&MethodMean> {
    let of = found.means.iter().filter(|m| m.method.knows() == knows);
    of.min_by(|a, b| a.gap_rmse_m.total_cmp(&b.gap_rmse_m))
}

fn compared_row(pair: &Compared) -> IntervalRow {
    IntervalRow::new(
        format!("{} − {}", pair.method.label(), pair.beside.label()),
        Some(pair.mean_m),
        pair.low_m.zip(pair.high_m),
    )
}

fn paired(pair: &Compared) -> String {
    let ends = interval(pair.low_m.zip(pair.high_m), 2);
    format!(
        "{} − {}: {} m{ends}, nearer/further {}/{}",
        pair.method.label(),
        pair.beside.label(),
        apa::number(pair.mean_m, 2),
        pair.better,
        pair.worse
    )
}

/// What was learned against the best of its peers, whichever that is.
fn better(found: &FollowingEvaluation, finding: &Finding) -> Card {
    let n = found.drivers.len();
    let peers = findings::beside_peers(found);
    let mut asked = card(
        finding,
        "Does it follow more like the driver than a simple law would?",
    );
    let ours = found.mean(FollowingMethod::ClosedLoopShrunken);
    let peer = found
        .means
        .iter()
        .filter(|m| m.method.knows() == Knows::Driver && !NETWORKS.contains(&m.method));
    let peer = peer.min_by(|a, b| a.gap_rmse_m.total_cmp(&b.gap_rmse_m));
    let said = |m: Option<&MethodMean>| {
        m.map_or_else(
            || "not tried".to_owned(),
            |m| format!("{} {} m", m.method.label(), apa::number(m.gap_rmse_m, 2)),
        )
    };
    let overlap = peers.iter().any(|p| {
        p.low_m
            .zip(p.high_m)
            .is_some_and(|(low, high)| low < 0.0 && high > 0.0)
    });
    asked.answer = format!(
        "Mean error of the gap: {}; best of the simple laws: {}{}.",
        said(ours),
        said(peer),
        if overlap {
            ", a tie by its interval"
        } else {
            ""
        }
    );
    "Shown if against every law that it is held beside the interval of the mean difference, drivers drawn with replacement, lies below 0; fails if \
     against one it lies above. Below six drivers nothing is said."
        .clone_into(&mut asked.rule);
    asked.number = number(
        said(ours),
        format!(
            "the best that is the same for everybody, {}",
            said(best(found, Knows::Population))
        ),
        format!(
            "fitted to what it is judged by, {}",
            said(best(found, Knows::Test))
        ),
    );
    asked.plot = plot(
        "Difference of the gap’s error (m)",
        "95% CI, bootstrap over drivers",
        Some(0.0),
        peers.iter().map(|p| compared_row(p)).collect(),
    );
    format!("With {n} drivers an interval from drawing drivers is too narrow, and a few drivers carry a mean.").clone_into(&mut asked.doubt);
    asked.see = Some("table-following-compared".to_owned());
    asked.tests = peers.iter().map(|p| paired(p)).collect();
    asked
}

/// Does knowing the driver help, by each way of knowing?
fn personal(found: &FollowingEvaluation, finding: &Finding) -> Card {
    let n = found.drivers.len();
    let pairs = findings::beside_everybody(found);
    let mut asked = card(finding, "Does knowing the driver help?");
    let counts: Vec<String> = pairs
        .iter()
        .map(|p| {
            format!(
                "{}: {} of {n} nearer, {} further off",
                p.method.label(),
                p.better,
                p.worse
            )
        })
        .collect();
    asked.answer = format!("{}.", counts.join("; "));
    "Shown if for every way of knowing the driver the error is below that of the same method for everybody (interval of the mean difference below 0); \
     fails if for one it is above. Below six drivers nothing is said."
        .clone_into(&mut asked.rule);
    asked.number = pairs.first().and_then(|p| {
        number(
            format!("{}: {} m", p.method.label(), apa::number(p.mean_m, 2)),
            "0, the same for everybody",
            "none: an error cannot be less than 0",
        )
    });
    asked.plot = plot(
        "Own less everybody’s (m)",
        "95% CI, bootstrap over drivers",
        Some(0.0),
        pairs.iter().map(|p| compared_row(p)).collect(),
    );
    "A pair of vehicles is one meeting of two drivers: what differs may be the leader, the road or the day."
        .clone_into(&mut asked.doubt);
    asked.see = Some("table-following-by-driver".to_owned());
    asked.tests = pairs.iter().map(|p| paired(p)).collect();
    asked
}

/// Did what is driven by default ever run into the leader?
fn reached(found: &FollowingEvaluation, finding: &Finding) -> Card {
    let driven = findings::driven(found);
    let mean = found.mean(driven);
    let (hits, n) = mean.map_or((0, 0), |m| (m.reached_zero, m.drivers));
    let mut asked = must_not_happen(finding, "Does it stay behind the leader?", "share");
    asked.answer = format!(
        "What is driven by default ({}) reached the leader in {hits} of {n} drives.",
        driven.label()
    );
    "Shown if the simulated gap reaches 0 in no drive; fails if in one. Below six drivers nothing is said unless one does.".clone_into(&mut asked.rule);
    "The recorded leader does not react to who follows.".clone_into(&mut asked.doubt);
    asked.see = Some("table-following-errors".to_owned());
    asked
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::evaluate::findings::tests::found;

    fn of(
        found: &FollowingEvaluation,
        words: fn(&FollowingEvaluation, &Finding) -> Card,
        at: usize,
    ) -> Card {
        words(found, &findings::findings(found)[at])
    }

    #[test]
    fn the_best_of_the_peers_stands_beside_ours_whoever_is_ahead() {
        let card = of(&found(8, 0.2, 1.8), better, 0);
        assert!(
            card.answer.contains("3.00 m") && card.answer.contains("IDM, own 2.00 m"),
            "{}",
            card.answer
        );
        let (floor, ceiling) = (format!("{:?}", card.number), "1.00 m");
        assert!(
            floor.contains("2.80 m") && floor.contains(ceiling),
            "the population's and the fitted law too: {floor}"
        );
        let tie = of(&found(8, -1.0, 1.0), better, 0);
        assert!(
            tie.answer.contains("a tie by its interval"),
            "{}",
            tie.answer
        );
    }

    #[test]
    fn drivers_are_counted_and_not_named() {
        let card = of(&found(8, 0.2, 1.8), personal, 1);
        assert!(
            card.answer.contains("1 of 8 nearer, 7 further off"),
            "{}",
            card.answer
        );
        assert!(!card.answer.contains("D1"));
    }
}

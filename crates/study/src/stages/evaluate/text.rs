//! The tables of an evaluation as lines of text.

use super::tables::{compared, following_table, shrinkage};
use maveric_following::{ClosedLoopSeed, ClosedLoopStudy, FollowingEvaluation, FollowingMethod};
use maveric_report::tables::{Cell, Table};

/// What stands in the table of drivers.
const BY_DRIVER: [(FollowingMethod, &str); 10] = [
    (FollowingMethod::IdmOwn, "IDM own"),
    (FollowingMethod::IdmPopulationOwnTimeGap, "IDM own T"),
    (FollowingMethod::IdmPopulationShrunkenTimeGap, "IDM shr T"),
    (FollowingMethod::IdmPopulation, "IDM pop."),
    (FollowingMethod::FollowingDistanceOwn, "F own"),
    (FollowingMethod::FollowingDistanceMean, "F mean"),
    (FollowingMethod::ClosedLoopOwn, "net own"),
    (FollowingMethod::ClosedLoopShrunken, "net shr"),
    (FollowingMethod::ClosedLoopMean, "net mean"),
    (FollowingMethod::IdmFloor, "floor"),
];

pub(super) fn lines(found: &FollowingEvaluation) -> Vec<String> {
    let of = |table: Table| table.to_text().lines().map(str::to_owned).collect();
    let whose = format!("{} recorded drivers", found.drivers.len());
    let blocks: [Vec<String>; 7] = [
        of(following_table(found, &whose)),
        driven(found),
        of(drivers(found)),
        if found.compared.is_empty() {
            Vec::new()
        } else {
            of(compared(found))
        },
        shrinkage(found),
        found.closed_loop.as_ref().map_or_else(Vec::new, seeds),
        harmed(found),
    ];
    let blocks: Vec<String> = blocks
        .iter()
        .filter(|lines| !lines.is_empty())
        .map(|lines| lines.join("\n"))
        .collect();
    blocks.join("\n\n").lines().map(str::to_owned).collect()
}

/// What the program drives with.
fn driven(found: &FollowingEvaluation) -> Vec<String> {
    vec![format!(
        "driven by default, as chosen once on fit rows of other people: {}",
        found.driven.label()
    )]
}

fn drivers(found: &FollowingEvaluation) -> Table {
    let table = Table::of("drivers", "RMSE of the gap (m)", &found.drivers)
        .text("Driver", |driver| &driver.driver);
    let tried = BY_DRIVER.into_iter();
    let tried = tried.filter(|(method, _)| found.mean(*method).is_some());
    let all = tried.fold(table, |table, (method, head)| {
        table.right(head, |driver| Cell::number(driver.gap_rmse_m(method), 2))
    });
    all.done()
}

fn seeds(study: &ClosedLoopStudy) -> Vec<String> {
    let all: Vec<[f64; 3]> = study.seeds.iter().map(ClosedLoopSeed::gap_rmse_m).collect();
    let range = |at: usize| {
        let values = || all.iter().map(|seed| seed[at]);
        let mean = values().sum::<f64>() / all.len() as f64;
        let low = values().fold(f64::INFINITY, f64::min);
        let high = values().fold(f64::NEG_INFINITY, f64::max);
        format!("{mean:.2} m ({low:.2} to {high:.2})")
    };
    let mut lines = vec![format!(
        "each of {} training seeds alone: own embedding {}, shrunken {}, mean {}",
        all.len(),
        range(0),
        range(1),
        range(2)
    )];
    if let Some(strangers) = &study.strangers {
        let [own, shrunken, mean] = strangers.gap_rmse_m();
        lines.push(format!(
            "the first seed, each driver by a network trained on the others alone: own {own:.2} m, shrunken {shrunken:.2} m, mean {mean:.2} m"
        ));
    }
    lines
}

fn harmed(found: &FollowingEvaluation) -> Vec<String> {
    use FollowingMethod as M;
    [
        ("F", M::FollowingDistanceOwn, M::FollowingDistanceMean),
        (
            "network in closed loop",
            M::ClosedLoopOwn,
            M::ClosedLoopMean,
        ),
        (
            "network in closed loop, shrunken",
            M::ClosedLoopShrunken,
            M::ClosedLoopMean,
        ),
    ]
    .into_iter()
    .filter(|(_, own, _)| found.mean(*own).is_some())
    .map(|(what, own, mean)| {
        let names = found.harmed(own, mean);
        let (count, of) = (names.len(), found.drivers.len());
        let names = if names.is_empty() {
            String::new()
        } else {
            format!(": {}", names.join(", "))
        };
        format!("harmed by personalising, {what}: {count} of {of}{names}")
    })
    .collect()
}

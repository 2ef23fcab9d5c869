//! The tables of an evaluation as lines of text.

use maveric_following::{
    ClosedLoopSeed, ClosedLoopStudy, Compared, FollowingEvaluation, FollowingMethod, MethodMean,
    Shrinkage,
};

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
    let blocks = [
        means(found),
        driven(found),
        drivers(found),
        compared(&found.compared),
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

/// What the program drives with, and how it was chosen.
fn driven(found: &FollowingEvaluation) -> Vec<String> {
    let Some(choice) = &found.driven else {
        return Vec::new();
    };
    let row = |m: &MethodMean| format!("{} {:.2} m", m.method.label(), m.gap_rmse_m);
    let each: Vec<String> = choice.means.iter().map(row).collect();
    vec![
        format!("driven by default: {}", choice.method.label()),
        format!(
            "chosen on the fit rows of those who were learned from, their last third after the first two: {}",
            each.join("; ")
        ),
    ]
}

fn compared(pairs: &[Compared]) -> Vec<String> {
    if pairs.is_empty() {
        return Vec::new();
    }
    let mut lines = vec![
        "difference of the gap's RMSE, driver by driver, in m: mean [95 %, drivers drawn with replacement], median; nearer/further off"
            .to_owned(),
    ];
    for pair in pairs {
        let interval = match (pair.low_m, pair.high_m) {
            (Some(low), Some(high)) => format!("[{low:.2}, {high:.2}]"),
            _ => "[no interval]".to_owned(),
        };
        lines.push(format!(
            "{} less {}: {:.2} {interval}, {:.2}; {}/{}",
            pair.method.label(),
            pair.beside.label(),
            pair.mean_m,
            pair.median_m,
            pair.better,
            pair.worse
        ));
    }
    lines
}

/// How much of what was fitted to a person was believed.
fn shrinkage(found: &FollowingEvaluation) -> Vec<String> {
    let one = |what: &str, s: &Shrinkage| {
        let strength = s.strength_s.map_or_else(
            || "without bound: their halves differ as much as they do".to_owned(),
            |k| format!("{k:.0} s"),
        );
        format!(
            "shrinkage of {what}, by how far {} people moved between halves of {:.0} s: strength {strength}; of a fit to {:.0} s \
             {:.0} % is kept",
            s.people,
            s.half_s,
            2.0 * s.half_s,
            100.0 * s.share(2.0 * s.half_s)
        )
    };
    let mut lines = vec![one(
        "the own time gap (its logarithm)",
        &found.time_gap_shrinkage,
    )];
    let network = found.closed_loop.as_ref();
    if let Some(first) = network.and_then(|study| study.trained.first()) {
        lines.push(one("the own embedding (first seed)", &first.shrinkage));
    }
    lines
}

fn means(found: &FollowingEvaluation) -> Vec<String> {
    let mut lines = vec![format!(
        "{:45} {:>7} {:>7} {:>9} {:>6} {:>6} {:>9}",
        "mean over drivers", "gap m", "median", "speed m/s", "NRMSE", "mixed", "reached 0"
    )];
    for row in &found.means {
        let mark = if found.is_best(row.method) { '*' } else { ' ' };
        lines.push(format!(
            "{:45} {:6.2}{mark} {:7.2} {:9.2} {:6.3} {:6.3} {:>9}",
            row.method.label(),
            row.gap_rmse_m,
            row.gap_rmse_median_m,
            row.speed_rmse_mps,
            row.nrmse,
            row.mixed,
            format!("{}/{}", row.reached_zero, row.drivers)
        ));
    }
    lines.push(
        "* best of those that know the driver's first two thirds, and of those that are the same for everybody".to_owned(),
    );
    lines
}

fn drivers(found: &FollowingEvaluation) -> Vec<String> {
    let tried: Vec<_> = BY_DRIVER
        .into_iter()
        .filter(|(method, _)| found.mean(*method).is_some())
        .collect();
    let name = |driver: &str| driver.chars().count();
    let wide = found.drivers.iter().map(|d| name(&d.driver)).max();
    let wide = wide.unwrap_or(0).max("RMSE of the gap, m".len());
    let heads: Vec<String> = tried
        .iter()
        .map(|(_, head)| format!(" {head:>9}"))
        .collect();
    let heads = heads.concat();
    let mut lines = vec![format!("{:wide$}{heads}", "RMSE of the gap, m")];
    for driver in &found.drivers {
        let gaps = tried
            .iter()
            .filter_map(|(method, _)| driver.gap_rmse_m(*method));
        let cells: Vec<String> = gaps.map(|gap| format!(" {gap:9.2}")).collect();
        lines.push(format!("{:wide$}{}", driver.driver, cells.concat()));
    }
    lines
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

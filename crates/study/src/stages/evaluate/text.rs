//! The tables of an evaluation as lines of text.

use maveric_following::{
    ClosedLoopSeed, ClosedLoopStudy, FollowingEvaluation, FollowingMethod, Predicted,
};

/// What stands in the table of drivers.
const BY_DRIVER: [(FollowingMethod, &str); 8] = [
    (FollowingMethod::IdmOwn, "IDM own"),
    (FollowingMethod::IdmPopulationOwnTimeGap, "IDM own T"),
    (FollowingMethod::IdmPopulation, "IDM pop."),
    (FollowingMethod::FollowingDistanceOwn, "F own"),
    (FollowingMethod::FollowingDistanceMean, "F mean"),
    (FollowingMethod::ClosedLoopOwn, "net own"),
    (FollowingMethod::ClosedLoopMean, "net mean"),
    (FollowingMethod::IdmFloor, "floor"),
];

pub(super) fn lines(found: &FollowingEvaluation) -> Vec<String> {
    let mut lines = means(found);
    lines.push(String::new());
    lines.extend(drivers(found));
    if let Some(study) = &found.closed_loop {
        lines.push(String::new());
        lines.extend(seeds(study));
    }
    lines.push(String::new());
    lines.extend(harmed(found));
    lines.push(String::new());
    lines.extend(open_loop(found));
    lines
}

fn means(found: &FollowingEvaluation) -> Vec<String> {
    let mut lines = vec![format!(
        "{:45} {:>7} {:>9} {:>6} {:>6} {:>9}",
        "mean over drivers", "gap m", "speed m/s", "NRMSE", "mixed", "reached 0"
    )];
    for row in &found.means {
        let mark = if found.is_best(row.method) { '*' } else { ' ' };
        lines.push(format!(
            "{:45} {:6.2}{mark} {:9.2} {:6.3} {:6.3} {:>9}",
            row.method.label(),
            row.gap_rmse_m,
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
    let all: Vec<(f64, f64)> = study.seeds.iter().map(ClosedLoopSeed::gap_rmse_m).collect();
    let range = |of: fn(&(f64, f64)) -> f64| {
        let values = || all.iter().map(of);
        let mean = values().sum::<f64>() / all.len() as f64;
        let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
            (l.min(x), h.max(x))
        });
        format!("{mean:.2} m ({low:.2} to {high:.2})")
    };
    let (own, mean) = study.strangers.gap_rmse_m();
    vec![
        format!(
            "network in closed loop over {} training seeds: own embedding {}, mean embedding {}",
            all.len(),
            range(|s| s.0),
            range(|s| s.1)
        ),
        format!(
            "the same, each driver by a network trained on the others alone: own embedding {own:.2} m, mean embedding {mean:.2} m"
        ),
    ]
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

fn open_loop(found: &FollowingEvaluation) -> Vec<String> {
    let mut lines = vec![
        "without driving, the recorded past as input (proves nothing about driving): RMSE"
            .to_owned(),
    ];
    for row in &found.open_loop {
        let unit = match row.predicted {
            Predicted::Speed => "m/s",
            Predicted::Gap => "m",
        };
        let what = match row.predicted {
            Predicted::Speed => "speed from",
            Predicted::Gap => "gap from",
        };
        if let Some(mean) = row.mean {
            lines.push(format!(
                "{:45} {mean:6.2} {unit}",
                format!("{what} {}", row.by)
            ));
        }
    }
    lines
}

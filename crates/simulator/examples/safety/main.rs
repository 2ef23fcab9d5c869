//! Drives random scenarios of every kind with planners of every style, and prints what went wrong and why.
//!
//! `cargo run --release -p maveric-simulator --example safety -- 10000`
#![expect(clippy::print_stdout, reason = "an example shows its result")]

mod random;

use maveric_simulator::{CollisionCause, Driver, RolloutReport, SimulatorError, rollout};
use random::{KINDS, planner, scenario};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What one drive came to.
struct Outcome {
    report: RolloutReport,
    km: f64,
    causes: Vec<CollisionCause>,
}

fn drive(kind: &str, number: u64) -> Result<Outcome, SimulatorError> {
    let scenario = scenario(kind, number)?;
    let mut planner = planner(kind, number);
    let controllers = &scenario.settings().controllers;
    let driven = rollout(&scenario, Driver::Automated(&mut planner, controllers), number)?;
    let own_fault = driven.collisions.iter().filter(|c| c.cause == CollisionCause::AssumptionsHeld);
    for collision in own_fault {
        println!("{kind} {number}: vehicle {} at {:.2} s", collision.vehicle.0, collision.time_s);
    }
    let x_m = &driven.recording.ego().x_m;
    Ok(Outcome {
        report: driven.report,
        km: (x_m[x_m.len() - 1] - x_m[0]) / 1000.0,
        causes: driven.collisions.iter().map(|c| c.cause).collect(),
    })
}

/// Memory that the process has held at most, in MiB, where the system says so.
fn peak_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib / 1024.0)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let drives: u64 = std::env::args().nth(1).map_or(Ok(700), |n| n.parse())?;
    let start = std::time::Instant::now();
    let each = drives.div_ceil(KINDS.len() as u64);
    println!(
        "| kind | drives | km | braked | changes held | given up | s inside the safe distance a drive, mean and most | least share of it | collisions where the assumptions held | where not |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let mut total = 0;
    for kind in KINDS {
        let outcomes: Vec<Outcome> = (0..each)
            .into_par_iter()
            .map(|number| drive(kind, number))
            .collect::<Result<_, _>>()?;
        let sum = |count: fn(&RolloutReport) -> u32| -> u32 {
            outcomes.iter().map(|o| count(&o.report)).sum()
        };
        let inside: Vec<f64> = outcomes.iter().map(|o| o.report.inside_safe_distance_s).collect();
        let km: f64 = outcomes.iter().map(|o| o.km).sum();
        let mut causes: BTreeMap<CollisionCause, u32> = BTreeMap::new();
        for cause in outcomes.iter().flat_map(|o| &o.causes) {
            *causes.entry(*cause).or_default() += 1;
        }
        let held = causes.remove(&CollisionCause::AssumptionsHeld).unwrap_or(0);
        total += held;
        let others: Vec<String> = causes.iter().map(|(c, n)| format!("{c:?} {n}")).collect();
        println!(
            "| {kind} | {each} | {km:.0} | {} | {} | {} | {:.2}, {:.1} | {:.2} | {held} | {} |",
            sum(|r| r.interventions),
            sum(|r| r.held_changes),
            sum(|r| r.given_up_changes),
            inside.iter().sum::<f64>() / each as f64,
            inside.iter().copied().fold(0.0, f64::max),
            outcomes.iter().map(|o| o.report.least_safe_distance_share).fold(1.0, f64::min),
            if others.is_empty() { "0".to_owned() } else { others.join(", ") },
        );
        if let Some(mib) = peak_mib() {
            eprintln!("{kind}: {:.0} s, peak memory {mib:.0} MiB", start.elapsed().as_secs_f64());
        }
    }
    println!("{total} collisions where the assumptions held");
    Ok(())
}

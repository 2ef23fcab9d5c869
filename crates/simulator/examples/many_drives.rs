//! Many drives of a scenario at once, each by another synthetic person: time a drive, collisions, memory.
//!
//! `cargo run --release -p maveric-simulator --example many_drives -- study_data/scenarios/dense.toml 1000`
//! (scenario, number of people, and which is the first: 0)
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_domain::{LatentTraits, stream_seed};
use maveric_simulator::{Driver, DriverParams, Scenario, SimulatorError, rollout};
use peak_alloc::PeakAlloc;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use std::{
    error::Error,
    sync::atomic::{AtomicU64, Ordering},
    time::Instant,
};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// What a drive came to.
struct Done {
    person: u64,
    seconds: f64,
    collisions: u32,
    violations: u32,
    changes: u32,
    others: usize,
}

fn drive(scenario: &Scenario, person: u64) -> Result<Done, SimulatorError> {
    let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(1, &["person", &person.to_string()]));
    let traits = LatentTraits::draw(|| StandardNormal.sample(&mut rng));
    let params = DriverParams::draw(&traits, person, person);
    let start = Instant::now();
    let driven = rollout(scenario, Driver::Human(&params), person)?;
    Ok(Done {
        person,
        seconds: start.elapsed().as_secs_f64(),
        collisions: driven.report.collisions,
        violations: driven.report.rule_violations,
        changes: driven.report.started_changes,
        others: driven.recording.others().len(),
    })
}

/// Drives people `from..to` on all cores; what they did, in any order.
fn drives(scenario: &Scenario, from: u64, to: u64) -> Result<Vec<Done>, SimulatorError> {
    let next = AtomicU64::new(from);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let worker = || -> Result<Vec<Done>, SimulatorError> {
        let mut done = Vec::new();
        loop {
            let person = next.fetch_add(1, Ordering::Relaxed);
            if person >= to {
                return Ok(done);
            }
            done.push(drive(scenario, person)?);
        }
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..cores).map(|_| scope.spawn(worker)).collect();
        let mut outcomes = Vec::new();
        for thread in threads {
            outcomes.extend(thread.join().expect("a worker does not panic")?);
        }
        Ok(outcomes)
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("expected a scenario file")?;
    let count: u64 = arguments.next().map_or(Ok(1000), |text| text.parse())?;
    let first: u64 = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let text = std::fs::read_to_string(&path).map_err(|e| format!("{path}: {e}"))?;
    let scenario: Scenario = toml::from_str(&text).map_err(|e| format!("{path}: {e}"))?;
    let start = Instant::now();
    let (mut seconds, mut collisions, mut violations) = (Vec::new(), 0, 0);
    let (mut changes, mut others) = (0, 0);
    for tenth in 0..10 {
        MEMORY.reset_peak_usage();
        let (from, to) = (count * tenth / 10, count * (tenth + 1) / 10);
        for done in drives(&scenario, first + from, first + to)? {
            if done.collisions > 0 {
                println!("person {}: {} collisions", done.person, done.collisions);
            }
            seconds.push(done.seconds);
            collisions += done.collisions;
            violations += done.violations;
            changes += done.changes;
            others += done.others;
        }
        println!("after {:4} drives: peak {:.1} MB", seconds.len(), MEMORY.peak_usage_as_mb());
    }
    let elapsed = start.elapsed().as_secs_f64();
    seconds.sort_by(f64::total_cmp);
    let n = seconds.len();
    let (fastest, median) =
        seconds.first().zip(seconds.get(n / 2)).ok_or("expected at least 10 drives")?;
    println!(
        "{n} drives in {elapsed:.1} s; one: fastest {:.1} ms, median {:.1} ms",
        1e3 * fastest,
        1e3 * median
    );
    println!(
        "collisions {collisions}, rule violations {violations}; a drive: {:.1} lane changes, {:.0} others seen",
        f64::from(changes) / n as f64,
        others as f64 / n as f64
    );
    Ok(())
}

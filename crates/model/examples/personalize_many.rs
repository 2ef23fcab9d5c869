//! Personalises many made-up drivers, each made, fitted and forgotten: time rises with their number, memory does not.
//!
//! `cargo run --release -p maveric-model --example personalize_many [DRIVERS] [SECONDS]`: 1,000 drivers of 60 s each
//! unless told otherwise.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

#[path = "../tests/support/drives.rs"]
mod drives;

use maveric_model::{HeadsKind, ModelError, Personalizer, TrainSettings, TrainingDrive, train};
use rayon::prelude::*;
use std::{ops::ControlFlow, time::Instant};

fn main() -> Result<(), ModelError> {
    let mut arguments = std::env::args()
        .skip(1)
        .filter_map(|a| a.parse::<u32>().ok());
    let drivers = arguments.next().unwrap_or(1000);
    let seconds = arguments.next().unwrap_or(60);
    let recorded = drives::drivers_apart(6, 300.0);
    let given: Vec<_> = recorded.iter().map(TrainingDrive::from).collect();
    let params = TrainSettings {
        heads: HeadsKind::Linear,
        ..TrainSettings::default()
    };
    let model = train(&given, &params, 1, &mut |_| ControlFlow::Continue(()))?.model;
    let personalizer = Personalizer::new(&model);

    let begun = Instant::now();
    let fit = |driver: u32| -> Result<f64, ModelError> {
        let share = f64::from(driver % 1000) / 1000.0;
        let habits = drives::Habits {
            speed_mps: 26.0 + 8.0 * share,
            time_gap_s: 2.2 - 1.2 * share,
            passes: true,
        };
        let drive = drives::drive(&format!("D{driver}"), &habits, f64::from(seconds));
        Ok(personalizer.fit(&drive, None)?.readings as f64)
    };
    let total = (0..drivers)
        .into_par_iter()
        .map(fit)
        .try_reduce(|| 0.0, |a, b| Ok(a + b))?;
    let took = begun.elapsed().as_secs_f64();
    println!(
        "{drivers} drivers of {seconds} s in {took:.2} s: {:.0} a second; {:.1} events each; peak memory {}",
        f64::from(drivers) / took,
        total / f64::from(drivers),
        peak_memory().unwrap_or("unknown here".to_owned())
    );
    Ok(())
}

/// What the system says of this process, where it says so (Linux).
fn peak_memory() -> Option<String> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM"))?;
    Some(
        line.split_whitespace()
            .skip(1)
            .collect::<Vec<_>>()
            .join(" "),
    )
}

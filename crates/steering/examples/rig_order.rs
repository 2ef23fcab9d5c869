//! In which share of made-up people the aggressive drive still lies above the calm one, as the rig sees less and less of the same drives.
//!
//! `cargo run --release -p maveric-steering --example rig_order [PEOPLE] [APART]`: 200 people, whose aggressiveness is moved by
//! 1.9 SD to either side of their own, as professionals do in their roles.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

#[path = "../tests/support/rig.rs"]
mod rig;

use maveric_domain::Sees;
use maveric_simulator::Scenario;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let people = arguments.next().map_or(Ok(200), |n| n.parse::<usize>())?;
    let apart = arguments.next().map_or(Ok(1.9), |n| n.parse::<f64>())?;
    let scenario = Scenario::paper();
    let model = rig::learned(36, 1.9, &scenario)?;
    let pairs = (0..people).map(|i| rig::calm_and_aggressive(i, apart, &scenario));
    let pairs: Vec<_> = pairs.collect::<Result<_, _>>()?;
    println!(
        "| what the rig has lost | order holds | points apart | as if everything were seen | points | by mean speed |"
    );
    println!("|---|---|---|---|---|---|");
    for (step, lost) in rig::STEPS.iter().enumerate() {
        let now = rig::order(&pairs, &model, step, rig::seen_by(step))?;
        let before = rig::order(&pairs, &model, step, Sees::ALL)?;
        println!(
            "| {lost} | {:.1} % | {:.1} | {:.1} % | {:.1} | {:.1} % |",
            100.0 * now.holds,
            now.median_points,
            100.0 * before.holds,
            before.median_points,
            100.0 * now.by_speed
        );
    }
    Ok(())
}

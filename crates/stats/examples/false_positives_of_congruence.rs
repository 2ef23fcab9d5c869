//! How often a top seems to lie near people's own, or not to move with it, where it lies just at the bound, and where there is none.
//!
//! `cargo run --release -p maveric-stats --example false_positives_of_congruence [TABLES]`; 5,000 of each kind by default.
//!
//! People differ in their level and in where their top lies (SD of 3 points), and get used to the rides. The bound is 5 points; the movement is
//! that over ± 1 SD of the table's own.
#![expect(clippy::print_stdout, reason = "an example shows its table on the terminal")]

mod support;

use maveric_stats::{
    CongruenceData, Predictor, RatioTest, StatsError, congruence, mean, proportion,
    standard_deviation,
};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use support::{normal, tables_or};

const ALPHA: f64 = 0.05;
const BOUND: f64 = 5.0;

/// What is true of a table.
#[derive(Clone, Copy)]
struct Truth {
    top: f64,
    /// Of the top, over ± 1 SD of own.
    movement: f64,
    /// What liking falls a squared point.
    bend: f64,
    /// What it rises a point, where it does not bend.
    line: f64,
}

fn is_within(test: &RatioTest) -> Option<bool> {
    Some(test.p_lower?.max(test.p_upper?) < ALPHA)
}

/// Whether the top seems to be near, and to stay.
fn one(
    seed: u64,
    people: usize,
    places: &[f64],
    truth: Truth,
) -> Result<Option<(bool, bool)>, StatsError> {
    let mut generator = Pcg64::new(u128::from(seed), 1);
    let person_points: Vec<f64> = (0..people).map(|_| 8.0 * normal(&mut generator)).collect();
    let (Some(middle), Some(sd)) = (mean(&person_points), standard_deviation(&person_points))
    else {
        return Ok(None);
    };
    let (mut subjects, mut periods) = (Vec::new(), Vec::new());
    let (mut liking, mut distances, mut owns) = (Vec::new(), Vec::new(), Vec::new());
    for (person, own) in person_points.iter().enumerate() {
        let level = 4.0 + 0.6 * normal(&mut generator) + 0.03 * own;
        let drift = truth.movement * (own - middle) / (2.0 * sd);
        let best = truth.top + drift + 3.0 * normal(&mut generator);
        let line = truth.line + 0.02 * normal(&mut generator);
        for (place, moved) in places.iter().enumerate() {
            let period = (place + person) % places.len();
            let slope = if truth.bend > 0.0 { 0.0 } else { line };
            let value = level - truth.bend * (moved - best).powi(2) + slope * moved;
            subjects.push(person.to_string());
            periods.push(Some(period.to_string()));
            liking.push(Some(value + 0.1 * period as f64 + 0.7 * normal(&mut generator)));
            distances.push(Some(*moved));
            owns.push(Some(*own));
        }
    }
    let data = CongruenceData {
        subjects: &subjects,
        liking: &liking,
        moved: &distances,
        own: &owns,
        beside: &[("period", Predictor::Factor(&periods))],
    };
    let result = congruence(&data, BOUND)?;
    Ok(is_within(&result.turn).zip(is_within(&result.movement)))
}

fn main() -> Result<(), StatsError> {
    let tables = tables_or(5_000);
    let bent = Truth { top: 0.0, movement: 0.0, bend: 0.01, line: 0.0 };
    let kinds = [
        ("top at the bound", Truth { top: BOUND, ..bent }),
        ("moves by the bound", Truth { movement: BOUND, ..bent }),
        ("both", Truth { top: BOUND, movement: -BOUND, ..bent }),
        ("flat", Truth { bend: 0.0, ..bent }),
        ("a line", Truth { bend: 0.0, line: 0.05, ..bent }),
        ("a bottom", Truth { bend: -0.004, ..bent }),
        ("near and stays", bent),
    ];
    println!("share of tables: near; stays; both, with its 95 % interval; tables with tests");
    let three = [-15.0, 0.0, 15.0];
    let five = [-15.0, -7.5, 0.0, 7.5, 15.0];
    for (people, places) in [(6, &three[..]), (12, &three), (24, &three), (24, &five), (48, &three)]
    {
        for (name, truth) in kinds {
            let tests: Vec<Option<(bool, bool)>> = (0..tables)
                .into_par_iter()
                .map(|seed| one(seed, people, places, truth))
                .collect::<Result<_, _>>()?;
            let there: Vec<(bool, bool)> = tests.into_iter().flatten().collect();
            let share = |holds: &dyn Fn(&(bool, bool)) -> bool| {
                proportion(there.iter().filter(|t| holds(t)).count(), there.len(), 0.95)
            };
            let (near, stays, both) = (share(&|t| t.0)?, share(&|t| t.1)?, share(&|t| t.0 && t.1)?);
            let (low, high) = both.ends();
            println!(
                "{people} people, {} places, {name:<18} {:.3}  {:.3}  {:.3} [{low:.3}, {high:.3}]  {}",
                places.len(),
                near.estimate,
                stays.estimate,
                both.estimate,
                there.len()
            );
        }
    }
    Ok(())
}

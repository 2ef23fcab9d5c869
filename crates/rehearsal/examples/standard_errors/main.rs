//! Whether the standard errors of styles hold: people who drive twice are personalised from each drive alone.
//!
//! `cargo run -p maveric-rehearsal --example standard_errors -- FILE linear 500 101` learns linear heads (or `paper`, its networks) from
//! the 30 people of study 101 whose habits FILE gives, and prints how many coordinates of 500 others lie where their first drive expects
//! them: with errors of the drive alone, and with errors of the person, for whom those who are learned from drive twice.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

#[path = "../made_up/mod.rs"]
mod made_up;

use made_up::{Wrong, errors::errors, people_of};
use maveric_rehearsal::validation::ShareOfPeople;

/// People who are learned from, as in the paper.
const LEARNERS: usize = 30;

fn percent(share: Option<ShareOfPeople>) -> String {
    let Some(ShareOfPeople { estimate, interval }) = share else {
        return "none".to_owned();
    };
    let (low, high) = interval.unwrap_or((f64::NAN, f64::NAN));
    let [estimate, low, high] = [estimate, low, high].map(|x| 100.0 * x);
    format!("{estimate:.1} % [{low:.1}, {high:.1}]")
}

fn main() -> Result<(), Wrong> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let [path, heads, people, seed] = words[..] else {
        return Err("give: FILE linear|paper PEOPLE SEED".into());
    };
    let sizes = (LEARNERS, people.parse()?);
    let errors = errors(&people_of(path)?, heads.parse()?, sizes, seed.parse()?)?;
    for (what, held) in [("drive", errors.of_drive), ("person", errors.of_person)] {
        println!(
            "{path}, {heads}, errors of the {what}: within 1 {}, within 2 {}; {} people, {} left out, {} coordinates, {} silent",
            percent(held.within_1),
            percent(held.within_2),
            held.people,
            held.left_out,
            held.coordinates,
            held.silent
        );
    }
    if let Some(days) = errors.days {
        println!("SD of a person's days {:.2?}", days.sd());
    }
    Ok(())
}

//! Whether the standard errors of styles hold: people who drive twice are personalised from each drive alone.
//!
//! `cargo run -p maveric-rehearsal --example standard_errors -- FILE linear 500 101` learns linear heads (or `paper`, its networks) from
//! the 30 people of study 101 whose habits FILE gives, and prints how many coordinates of 500 others lie where their first drive expects
//! them: with errors of the drive alone, and with errors of the person, for whom those who are learned from drive twice.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

#[path = "../made_up/mod.rs"]
mod made_up;

use made_up::{Wrong, again, cohort, driven, people_of, scores};
use maveric_domain::Drive;
use maveric_model::{
    Heads, HeadsKind, TrainSettings, TrainingDrive, learn_days, personalize, train,
};
use maveric_participants::{Part, PlannedDrive};
use maveric_rehearsal::validation::{Held, Known, ShareOfPeople, held};
use maveric_simulator::Scenario;
use std::ops::ControlFlow;

/// People who are learned from, as in the paper.
const LEARNERS: usize = 30;

fn share(share: Option<ShareOfPeople>) -> String {
    let Some(ShareOfPeople { estimate, interval }) = share else {
        return "none".to_owned();
    };
    let (low, high) = interval.unwrap_or((f64::NAN, f64::NAN));
    format!(
        "{:.1} % [{:.1}, {:.1}]",
        100.0 * estimate,
        100.0 * low,
        100.0 * high
    )
}

fn main() -> Result<(), Wrong> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let [path, heads, people, seed] = words[..] else {
        return Err("give: FILE linear|paper PEOPLE SEED".into());
    };
    let (who, scenario) = (people_of(path)?, Scenario::paper());
    let (people, seed): (usize, u64) = (people.parse()?, seed.parse()?);
    let cohort = cohort(LEARNERS, people, seed)?;
    let scores = scores(&cohort, seed)?;
    let learns = |d: &PlannedDrive| d.part == Part::Learn;
    let (learned, tested): (Vec<_>, Vec<_>) = cohort.drives.iter().cloned().partition(learns);
    let drives = driven(&learned, &who, &scenario, seed, |d| d)?;
    let training: Vec<TrainingDrive<'_>> = drives
        .iter()
        .map(|drive| TrainingDrive {
            drive,
            adb: scores(drive),
        })
        .collect();
    let settings = TrainSettings {
        heads: match heads {
            "linear" => HeadsKind::Linear,
            "paper" => HeadsKind::Paper,
            other => return Err(format!("`{other}` is no kind of heads: linear or paper").into()),
        },
        ..TrainSettings::default()
    };
    let go_on = &mut |_: &_| ControlFlow::Continue(());
    let alone = train(&training, &settings, seed, go_on)?.model;
    let own: Vec<PlannedDrive> = learned.into_iter().filter(|d| !d.role).collect();
    let second = driven(&again(&own)?, &who, &scenario, seed, |d| d)?;
    let owner = |a: &Drive, b: &Drive| a.meta().participant == b.meta().participant;
    let twice: Vec<[&Drive; 2]> = second
        .iter()
        .filter_map(|s| Some([drives.iter().find(|d| owner(d, s))?, s]))
        .collect();
    let knowing = learn_days(&alone, &training, 1.0, &twice, seed)?;
    for (errors, model) in [("of the drive", &alone), ("of the person", &knowing)] {
        let prior = matches!(model.heads(), Heads::Linear(_));
        let known = |planned: &[_]| {
            driven(planned, &who, &scenario, seed, |drive| {
                let found = personalize(model, &drive, None).ok()?;
                let d = found.embedding.size();
                let rows = found
                    .covariance?
                    .chunks_exact(d)
                    .map(<[f64]>::to_vec)
                    .collect();
                Some((found.embedding.coordinates().to_vec(), rows))
            })
        };
        let first: Vec<Option<Known>> = known(&tested)?;
        let Held {
            people,
            left_out,
            coordinates,
            silent,
            within_1,
            within_2,
        } = held(&first, &known(&again(&tested)?)?, prior, 1)?;
        println!(
            "{path}, {heads}, errors {errors}: within 1 {}, within 2 {}; {people} people, {left_out} left out, {coordinates} coordinates, {silent} silent{}",
            share(within_1),
            share(within_2),
            model
                .days()
                .map_or(String::new(), |d| format!("; days {:.2?}", d.sd()))
        );
    }
    Ok(())
}

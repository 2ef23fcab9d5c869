//! Made-up people who drive: the same as `maveric generate` makes, without files.

#![allow(dead_code, reason = "each example uses what it needs of it")]

pub(crate) mod errors;

use maveric_domain::{
    Design, DomainError, Drive, DriveId, DriveMeta, DrivenBy, Moment, Scale, ScoreRange,
    StyleScore, stream_seed,
};
use maveric_participants::{Cohort, CohortSettings, Effects, PlannedDrive, answer_before};
use maveric_simulator::{Driver, People, Scenario, rollout};
use std::{error::Error, thread};

pub(crate) type Wrong = Box<dyn Error + Send + Sync>;

/// `learn` people who are learned from and `test` who are tested.
pub(crate) fn cohort(learn: usize, test: usize, seed: u64) -> Result<Cohort, Wrong> {
    let design = Design::from_toml(maveric_data::DESIGNS_PAPER)?;
    Ok(Cohort::draw(learn, test, seed, &CohortSettings::default(), &design)?)
}

/// The people of a file: a population, or those of a scenario.
pub(crate) fn people_of(path: &str) -> Result<People, Wrong> {
    let text = std::fs::read_to_string(path)?;
    let of_scenario = |_| {
        let scenario: Scenario = toml::from_str(&text)?;
        Ok(People::Drivers(Box::new(scenario.settings().drivers.clone())))
    };
    toml::from_str(&text).or_else(of_scenario)
}

/// The ADB score that belongs to a drive of these people: their own, or that of the role which they drove.
pub(crate) fn scores(
    cohort: &Cohort,
    seed: u64,
) -> Result<impl Fn(&Drive) -> Option<StyleScore>, Wrong> {
    let scale = Scale::from_toml(maveric_data::SCALES_ADB)?;
    let mut effects: Effects = toml::from_str(maveric_data::EFFECTS)?;
    // Answers to questionnaires that nobody is asked here.
    effects.answers.clear();
    let scales = [scale];
    let answers = answer_before(cohort, &scales, &effects, seed)?;
    let scores = maveric_measures::score(&scales, &answers, None)?.scores;
    let roles: Vec<DriveId> =
        cohort.drives.iter().filter(|d| d.role).map(|d| d.drive.clone()).collect();
    Ok(move |drive: &Drive| {
        let meta = drive.meta();
        let moment =
            if roles.contains(&meta.drive) { Moment::after(meta.condition) } else { Moment::Pre };
        let total = scores.iter().find(|s| {
            s.participant == meta.participant && s.moment == moment && s.subscale == "total"
        });
        ScoreRange::ADB.score(total?.value?).ok()
    })
}

/// The same drives on another day.
pub(crate) fn again(planned: &[PlannedDrive]) -> Result<Vec<PlannedDrive>, DomainError> {
    let again = |d: &PlannedDrive| {
        Ok(PlannedDrive { drive: DriveId::new(format!("{}-again", d.drive))?, ..d.clone() })
    };
    planned.iter().map(again).collect()
}

/// Drives every drive and gives what `read` makes of it, in their order, on all cores.
pub(crate) fn driven<T: Send>(
    planned: &[PlannedDrive],
    people: &People,
    scenario: &Scenario,
    seed: u64,
    read: impl Fn(Drive) -> T + Sync,
) -> Result<Vec<T>, Wrong> {
    all_cores(planned, |planned| Ok(read(drive(planned, people, scenario, seed)?)))
}

/// `work` of every item, in their order, on all cores.
pub(crate) fn all_cores<I: Sync, T: Send>(
    items: &[I],
    work: impl Fn(&I) -> Result<T, Wrong> + Sync,
) -> Result<Vec<T>, Wrong> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let chunk = items.len().div_ceil(cores).max(1);
    thread::scope(|scope| {
        let parts: Vec<_> = items
            .chunks(chunk)
            .map(|part| scope.spawn(|| part.iter().map(&work).collect::<Result<Vec<T>, Wrong>>()))
            .collect();
        let mut results = Vec::with_capacity(items.len());
        for part in parts {
            results.extend(part.join().map_err(|_| "a drive stopped")??);
        }
        Ok(results)
    })
}

fn drive(
    planned: &PlannedDrive,
    people: &People,
    scenario: &Scenario,
    seed: u64,
) -> Result<Drive, Wrong> {
    let person = stream_seed(seed, &[planned.participant.as_str(), "person"]);
    let day = stream_seed(seed, &[planned.drive.as_str(), "day"]);
    let world = stream_seed(seed, &[planned.drive.as_str(), "world"]);
    let who = people.draw(&planned.traits, person, day);
    let driven = rollout(scenario, Driver::from(&who), world)?;
    let meta = DriveMeta::new(
        planned.drive.clone(),
        planned.participant.clone(),
        planned.condition,
        DrivenBy::Synthetic,
    );
    Ok(Drive::from_recording(meta, &driven.recording)?)
}

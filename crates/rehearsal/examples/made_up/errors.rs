//! Whether the standard errors of styles hold for people who drive twice.

use super::{Wrong, again, cohort, driven, scores};
use maveric_domain::Drive;
use maveric_model::{
    Days, Heads, HeadsKind, TrainSettings, TrainingDrive, learn_days, personalize, train,
};
use maveric_participants::{Part, PlannedDrive};
use maveric_rehearsal::validation::{Held, Known, held};
use maveric_simulator::{People, Scenario};
use std::ops::ControlFlow;

/// Errors that are of the drive alone, and of the person, for whom those learned from drive twice.
pub(crate) struct Errors {
    pub(crate) of_drive: Held,
    pub(crate) of_person: Held,
    pub(crate) days: Option<Days>,
}

/// Learns from `learners` people and asks `tested` others.
pub(crate) fn errors(
    who: &People,
    heads: HeadsKind,
    (learners, tested): (usize, usize),
    seed: u64,
) -> Result<Errors, Wrong> {
    let scenario = Scenario::paper();
    let cohort = cohort(learners, tested, seed)?;
    let scores = scores(&cohort, seed)?;
    let learns = |d: &PlannedDrive| d.part == Part::Learn;
    let (learned, tested): (Vec<_>, Vec<_>) = cohort.drives.iter().cloned().partition(learns);
    let drives = driven(&learned, who, &scenario, seed, |d| d)?;
    let training: Vec<TrainingDrive<'_>> =
        drives.iter().map(|drive| TrainingDrive { drive, adb: scores(drive) }).collect();
    let settings = TrainSettings { heads, ..TrainSettings::default() };
    let go_on = &mut |_: &_| ControlFlow::Continue(());
    let alone = train(&training, &settings, seed, go_on)?.model;
    let own_drives: Vec<PlannedDrive> = learned.into_iter().filter(|d| !d.role).collect();
    let second = driven(&again(&own_drives)?, who, &scenario, seed, |d| d)?;
    let owner = |a: &Drive, b: &Drive| a.meta().participant == b.meta().participant;
    let twice: Vec<[&Drive; 2]> =
        second.iter().filter_map(|s| Some([drives.iter().find(|d| owner(d, s))?, s])).collect();
    let knowing = learn_days(&alone, &training, 1.0, &twice, seed)?;
    let [of_drive, of_person] = [&alone, &knowing].map(|model| {
        let prior = matches!(model.heads(), Heads::Linear(_));
        let known = |planned: &[_]| {
            driven(planned, who, &scenario, seed, |drive| {
                let fit = personalize(model, &drive, None).ok()?;
                let d = fit.embedding.size();
                let covariance = fit.covariance?;
                let rows = covariance.chunks_exact(d).map(<[f64]>::to_vec).collect();
                Some((fit.embedding.coordinates().to_vec(), rows))
            })
        };
        let first: Vec<Option<Known>> = known(&tested)?;
        Ok::<Held, Wrong>(held(&first, &known(&again(&tested)?)?, prior, 1)?)
    });
    Ok(Errors { of_drive: of_drive?, of_person: of_person?, days: knowing.days().cloned() })
}

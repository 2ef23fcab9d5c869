//! A model of made-up people, trained on first use and kept, for a seat without a study.

use crate::{error::SeatError, files::Files, seat::SeatSettings, steps::Texts};
use maveric_domain::{Design, ScoreRange};
use maveric_model::{FreeSpeed, HeadsKind};
use maveric_study::{
    Stage as _, Watch,
    atomic_write::atomic_write_bytes,
    run_folder::read_seat_scenario,
    stages::{
        generate::Generate,
        ingest::Ingest,
        init::Init,
        score::{Moments, ScoreAnswers},
        train::Train,
    },
};
use std::path::Path;

/// Made-up people who are learned from.
const PEOPLE: usize = 20;
/// Length of their drives, in s.
const DRIVES_S: f64 = 300.0;
/// What the kept model is called; another version learns anew.
const MODEL: &str = concat!("made-up-", env!("CARGO_PKG_VERSION"), ".maveric");

/// The demonstration as a study: a drive of three minutes, a ride in the own style, a ride in which the dial may be turned.
const DESIGN: &str = r#"
[study]
title = "The seat"
[model]
file = "made-up.maveric"
made_up = true
[style]
score = "adb.total"
[[condition]]
id = "own-style"
car = { dial = 0, recorded = true }
[[condition]]
id = "dial"
car = { free = true }
[baseline]
id = "own"
[protocol]
steps = ["controls", "drive", "rides"]
drive_s = 180
ride_s = 90
thanks = "thanks.md"
"#;

const THANKS: &str = "You drove, were learned from and rode.\n\nThe model that read your style learned from made-up people: what it says of \
you is a demonstration, not a finding. Nothing that you did left this computer.\n\nA study of your own: `maveric init my_study`, then \
`maveric seat my_study`.";

/// What the demonstration is opened with; its model is trained if it is not in `cache`.
///
/// # Errors
/// [`SeatError::Study`] if the model cannot be trained or kept.
pub fn settings(cache: &Path, jobs: usize, watch: Watch<'_>) -> Result<SeatSettings, SeatError> {
    let design = Design::from_toml(DESIGN)
        .map_err(|e| SeatError::Protocol { problem: e.to_string(), help: e.suggestion() })?;
    Ok(SeatSettings {
        design,
        scales: Vec::new(),
        in_others: Vec::new(),
        texts: Texts { thanks: Some(THANKS.to_owned()), ..Texts::default() },
        scenario: read_seat_scenario(None)?,
        model: Some(model(cache, jobs, watch)?),
        made_up_model: true,
        range: Some(ScoreRange::ADB),
        files: Files::nowhere(),
        password: None,
    })
}

/// The model, from `cache` if it is there.
fn model(cache: &Path, jobs: usize, watch: Watch<'_>) -> Result<Vec<u8>, SeatError> {
    let kept = cache.join(MODEL);
    if let Ok(bytes) = std::fs::read(&kept)
        && maveric_model::model_file::from_bytes(&bytes).is_ok()
    {
        return Ok(bytes);
    }
    std::fs::create_dir_all(cache).map_err(|source| SeatError::io(cache, source))?;
    let work = cache.join(format!("work-{}", std::process::id()));
    let trained = train_in(&work, jobs, watch);
    // What was made on the way is of no further use, whether it came to a model or not.
    let _ = std::fs::remove_dir_all(&work);
    let bytes = trained?;
    atomic_write_bytes(&kept, &bytes)?;
    Ok(bytes)
}

fn train_in(work: &Path, jobs: usize, watch: Watch<'_>) -> Result<Vec<u8>, SeatError> {
    let folder = work.join("study");
    let study = Init { folder: folder.clone(), synthetic: true, ..Init::default() };
    study.run(watch)?;
    let design = Some(folder.join("study.toml"));
    let people = Generate {
        design: design.clone(),
        out: None,
        scenario: None,
        population: None,
        scales: None,
        effects: None,
        learn: PEOPLE,
        test: 0,
        duration_s: Some(DRIVES_S),
        repeat_drives: false,
        seed: 1,
        jobs,
    };
    people.run(watch)?;
    let drives =
        Ingest { design: design.clone(), out: folder.join("drives"), jobs, ..Ingest::default() };
    drives.run(watch)?;
    let study = maveric_study::DesignFile::find(design.as_deref())?;
    let files = study.design.files();
    let scores = ScoreAnswers {
        design: design.clone(),
        surveys: vec![study.resolve(&files.answers)],
        participants: None,
        scales: None,
        drives: Vec::new(),
        moments: Moments::All,
        out: folder.join("scores.csv"),
    };
    scores.run(watch)?;
    let out = folder.join("model.maveric");
    let model = Train {
        design,
        participants: None,
        drives: folder.join("drives"),
        again: None,
        scores: Some(folder.join("scores.csv")),
        out: out.clone(),
        heads: HeadsKind::Linear,
        free_speed: FreeSpeed::Absolute,
        embedding_size: 3,
        epochs: 40,
        fit_fraction: 1.0,
        seed: 1,
        jobs,
        validation_fraction: 0.0,
        patience: 0,
    };
    model.run(watch)?;
    std::fs::read(&out).map_err(|source| SeatError::Io { path: out, source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        plan::{Riding, Styles, of_design},
        steps::Step,
    };

    #[test]
    fn the_demonstration_is_a_study_of_a_drive_and_two_rides() {
        let design = Design::from_toml(DESIGN).unwrap();
        let riding = Riding { order: &[0, 1], styles: &Styles::new(), range: ScoreRange::ADB };
        let steps = of_design(&design, &[], &Texts::default(), "P001", Some(riding)).unwrap();
        let [
            Step::Controls,
            Step::Drive { seconds, .. },
            Step::Ride { turns: None, .. },
            Step::Ride { turns: Some(5.0), .. },
            Step::Aftercare { .. },
            Step::Thanks { .. },
        ] = &steps[..]
        else {
            panic!("{steps:?}");
        };
        assert!((seconds - 180.0).abs() < 1e-12);
    }
}

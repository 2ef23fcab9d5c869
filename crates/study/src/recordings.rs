//! A study's recordings as they were told and measured.

use crate::{
    design::DesignFile,
    error::StudyError,
    gate::Gate,
    style_scores::StyleScores,
    tables::{drives::drives_in, surveys::read_scores},
};
use maveric_domain::{ConditionId, Drive, ScoreRange, StyleScore};
use maveric_measures::objective::{self, median_time_gap_s};
use maveric_rehearsal::leave_out::Drove;
use std::path::Path;

/// Fewest people that can be left out in turn: two are learned from.
const FEWEST_PEOPLE: usize = 3;

/// Whether one of so many people can be left out in turn; why not otherwise.
pub(crate) fn enough(people: usize) -> Result<(), String> {
    if people < FEWEST_PEOPLE {
        return Err(format!(
            "{people} people drove in the roles asked for, expected at least {FEWEST_PEOPLE}"
        ));
    }
    Ok(())
}

#[derive(Debug)]
pub(crate) struct Recorded {
    pub(crate) drive: Drive,
    pub(crate) drove: Drove,
}

/// All of a study, by person, then role, the first drive in a role before the one that repeats it.
#[derive(Debug)]
pub(crate) struct Recordings {
    pub(crate) rows: Vec<Recorded>,
    /// The scale of their points.
    pub(crate) range: ScoreRange,
}

impl Recordings {
    pub(crate) fn drove(&self) -> Vec<Drove> {
        self.rows.iter().map(|r| r.drove.clone()).collect()
    }

    /// The labels that drives have, repeats of a role among them.
    pub(crate) fn labels(&self) -> Vec<ConditionId> {
        let labels = self.rows.iter().map(|r| r.drive.meta().condition);
        let labels: std::collections::BTreeSet<ConditionId> = labels.collect();
        labels.into_iter().collect()
    }
}

/// Reads the drives of a folder that people drove by hand in a role or as baseline. A drive's score is its role's or, without one, what
/// its driver answered by a table of `scores`.
///
/// # Errors
/// [`StudyError`] for a drive or a table that cannot be read, a design without a style, or no drive in a role.
pub(crate) fn read(
    study: &DesignFile,
    (folder, scores): (&Path, Option<&Path>),
    warnings: &mut Vec<String>,
) -> Result<Recordings, StudyError> {
    let design = &study.design;
    if design.style().is_none() {
        return Err(study.wrong(
            "no `[style]`, so there is no line on which drives have an order",
            Some("say which score the style is read as: [style] score = \"adb.total\"".to_owned()),
        ));
    }
    let gate = Gate::where_listed(study, None)?;
    let scores = scores.map(read_scores).transpose()?.unwrap_or_default();
    let scores = StyleScores::of(scores, Some(study))?;
    let baseline = design.baseline_id();
    let mut rows = Vec::new();
    for drive in drives_in(folder)? {
        let drive = drive?;
        let meta = drive.meta();
        let label = meta.condition;
        let role = match design.role(label) {
            Some(role) => role.id,
            None if Some(label) == baseline => label,
            None => continue,
        };
        let time = &drive.rows().time_s;
        let duration_s = time.last().copied().unwrap_or(0.0);
        if let Some(why) = gate.drive(meta, duration_s) {
            warnings.push(format!("{}: left out, {}", meta.drive, why.reason));
            continue;
        }
        let score = scores.of_drive(&drive, Some(study), baseline)?;
        let speed = objective::find("mean_velocity_mps").and_then(|m| m.of(&drive));
        let drove = Drove {
            drive: meta.drive.clone(),
            participant: meta.participant.clone(),
            role,
            points: score.map(StyleScore::points),
            speed_mps: speed,
            time_gap_s: median_time_gap_s(&drive),
        };
        rows.push(Recorded { drive, drove });
    }
    if rows.is_empty() {
        let problem = "holds no drive in a role of the design";
        let help = format!(
            "{} knows {}; [[role]] declares more, and [names] of the mapping says whose and which drive a log is",
            study.name(),
            ConditionId::listed(&design.labels())
        );
        return Err(StudyError::file(folder, problem).with_help(help));
    }
    rows.sort_by(|a, b| {
        let key = |r: &Recorded| {
            let label = r.drive.meta().condition;
            (r.drove.role, label != r.drove.role, label)
        };
        let who = a.drove.participant.cmp(&b.drove.participant);
        who.then(key(a).cmp(&key(b))).then_with(|| a.drove.drive.cmp(&b.drove.drive))
    });
    Ok(Recordings { rows, range: scores.scale() })
}

#[cfg(test)]
pub(crate) mod testing {
    use crate::tables::drives::write_drive;
    use maveric_domain::{Drive, DriveMeta, DrivenBy, LatentTraits, Recording, Seconds};
    use maveric_simulator::{Driver, DriverParams, Scenario, rollout};
    use std::sync::OnceLock;

    const DESIGN: &str = r#"
[study]
title = "Calm and sporty"
[style]
score = "adb.total"
range = [11, 55]
[[role]]
id = "calm"
score = 20
[[role]]
id = "sporty"
score = 45
[[role]]
id = "calm-again"
repeats = "calm"
[[role]]
id = "asleep"
score = 15
"#;

    fn recorded(who: usize, aggressiveness: f64, seed: u64) -> Recording {
        let scenario = Scenario::paper().with_duration(Seconds(150.0)).unwrap();
        let traits = LatentTraits {
            aggressiveness,
            spacing: 0.3 * (who as f64 - 2.0),
            ..LatentTraits::default()
        };
        let person = DriverParams::draw(&traits, who as u64, seed);
        rollout(&scenario, Driver::Human(&person), seed).unwrap().recording
    }

    fn drive(who: usize, role: &str, aggressiveness: f64, seed: u64) -> Drive {
        let meta = DriveMeta::named(
            format!("P{who}-{role}"),
            format!("P{who}"),
            role,
            DrivenBy::Synthetic,
        )
        .unwrap();
        Drive::from_recording(meta, &recorded(who, aggressiveness, seed)).unwrap()
    }

    /// The same drive with nobody else on the road.
    pub(crate) fn alone(drive: &Drive, who: usize, aggressiveness: f64, seed: u64) -> Drive {
        let all = recorded(who, aggressiveness, seed);
        let recording = Recording::new(
            *all.road(),
            all.rate_hz(),
            all.time_s().to_vec(),
            all.segment().to_vec(),
            all.ego().clone(),
            Vec::new(),
        );
        Drive::from_recording(drive.meta().clone(), &recording.unwrap()).unwrap()
    }

    /// Six people, calm, sporty and calm again, made once for all tests.
    pub(crate) fn drives() -> &'static [Drive] {
        static DRIVES: OnceLock<Vec<Drive>> = OnceLock::new();
        DRIVES.get_or_init(|| {
            let of = |who: usize| {
                let seed = 10 * who as u64;
                [
                    drive(who, "calm", -1.5, seed),
                    drive(who, "sporty", 1.5, seed + 1),
                    drive(who, "calm-again", -1.5, seed + 2),
                ]
            };
            (0..6).flat_map(of).collect()
        })
    }

    /// A study in a folder with these drives.
    pub(crate) fn study<'a>(drives: impl IntoIterator<Item = &'a Drive>) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("study.toml"), DESIGN).unwrap();
        for drive in drives {
            write_drive(&folder.path().join("drives"), drive).unwrap();
        }
        folder
    }
}

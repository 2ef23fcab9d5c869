//! A study's recordings as they were told and measured.

use super::rules::Table;
use crate::{
    design::DesignFile,
    error::StudyError,
    gate::Gate,
    run_folder::adb_of,
    style_scale::{StyleScale, instructed, style_scores},
    tables::{drives::read_drives, surveys::read_scores},
};
use maveric_domain::{ConditionId, Drive};
use maveric_measures::objective::{self, median_time_gap_s};
use maveric_rehearsal::leave_out::Drove;
use std::path::Path;

/// A recording.
#[derive(Debug)]
pub(super) struct Recorded {
    pub(super) drive: Drive,
    pub(super) drove: Drove,
}

/// All of a study, by person, then role, the first drive in a role before the one that repeats it.
#[derive(Debug)]
pub(super) struct Recordings {
    pub(super) rows: Vec<Recorded>,
}

impl Recordings {
    pub(super) fn drove(&self) -> Vec<Drove> {
        self.rows.iter().map(|r| r.drove.clone()).collect()
    }

    /// The labels that drives have, repeats of a role among them.
    pub(super) fn labels(&self) -> Vec<ConditionId> {
        let labels = self.rows.iter().map(|r| r.drive.meta().condition);
        let labels: std::collections::BTreeSet<ConditionId> = labels.collect();
        labels.into_iter().collect()
    }

    /// What a table reads.
    pub(super) fn of(&self, table: &Table) -> Vec<&Recorded> {
        let is_of = |r: &&Recorded| {
            let meta = r.drive.meta();
            let of_people = table.people.is_empty() || table.people.contains(&meta.participant);
            of_people && table.roles().any(|role| role == meta.condition)
        };
        self.rows.iter().filter(is_of).collect()
    }
}

/// Reads the drives of `run` that people drove by hand in a role or as baseline. A drive's score is its role's or, without one, what
/// its driver answered.
///
/// # Errors
/// [`StudyError`] for a drive or a table that cannot be read, a design without a style, or no drive in a role.
pub(super) fn read(
    study: &DesignFile,
    run: &Path,
    scale: StyleScale,
    warnings: &mut Vec<String>,
) -> Result<Recordings, StudyError> {
    let design = &study.design;
    if design.style().is_none() {
        return Err(study.wrong(
            "no `[style]`, so there is no line on which drives have an order",
            Some("say which score the style is read as: [style] score = \"adb.total\"".to_owned()),
        ));
    }
    let folder = run.join("drives");
    let gate = Gate::where_listed(study, None)?;
    let scores = run.join("scores.csv");
    let scores = if scores.is_file() {
        read_scores(&scores)?
    } else {
        Vec::new()
    };
    let (scores, _) = style_scores(scores, study.path.as_deref())?;
    let baseline = design.baseline_id();
    let mut rows = Vec::new();
    for drive in read_drives(&folder)? {
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
        let told = instructed(&drive, Some(study), scale)?;
        let score = told.or(adb_of(&drive, &scores, baseline)?);
        let speed = objective::find("mean_velocity_mps").and_then(|m| m.of(&drive));
        let drove = Drove {
            drive: meta.drive.clone(),
            participant: meta.participant.clone(),
            role,
            points: score.map(|score| scale.outward(score.points())),
            speed_mps: speed,
            time_gap_s: median_time_gap_s(&drive),
        };
        rows.push(Recorded { drive, drove });
    }
    if rows.is_empty() {
        let labels: Vec<ConditionId> = design.labels();
        return Err(StudyError::BadFile {
            path: folder,
            problem: "holds no drive in a role of the design".to_owned(),
            help: Some(format!(
                "{} knows {}; [[role]] declares more, and [names] of the mapping says whose and which drive a log is",
                study.name(),
                ConditionId::listed(&labels)
            )),
        });
    }
    rows.sort_by(|a, b| {
        let key = |r: &Recorded| {
            let label = r.drive.meta().condition;
            (r.drove.role, label != r.drove.role, label)
        };
        let who = a.drove.participant.cmp(&b.drove.participant);
        who.then(key(a).cmp(&key(b)))
            .then_with(|| a.drove.drive.cmp(&b.drove.drive))
    });
    Ok(Recordings { rows })
}

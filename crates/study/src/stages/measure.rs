//! `measure`: the objective measures, a row a drive.

use crate::{
    design::DesignFile,
    error::StudyError,
    gate::{Gate, counted},
    once::{count, told_once},
    outcome::{Outcome, Watch},
    presses::{PressTables, Presses, events_path},
    run_folder::{own_path, press_moments_path, presses_path},
    stage::{Files, Stage},
    tables::{
        TableName,
        drives::drives_in,
        measurements::{MeasuredDrive, write_measurements},
        own_measures::{OwnMeasures, read_own_measures},
        write_rows,
    },
};
use maveric_domain::{ConditionId, DriveId, ParticipantId};
use maveric_measures::objective::{self, Comparable, Exposure, comparable};
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

/// Measure drives: the objective measures, a row a drive; and average the study's own measures
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric measure --drives drives/study2 --drives av/drives --out measurements.parquet"
)]
pub struct Measure {
    /// Folder of drives; may be given more than once, and left out where the study has measures of its own
    #[arg(long)]
    pub drives: Vec<PathBuf>,
    /// Design of the study (TOML); study.toml of the folder one stands in when not given. Without either nothing is left out
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Who takes part; the design's table when not given
    #[arg(long)]
    pub participants: Option<PathBuf>,
    /// Table to write (CSV or Parquet by its name); NAME_own.csv goes beside it where the study has measures of its own
    #[arg(long)]
    pub out: PathBuf,
}

/// What was measured.
#[derive(Debug, Clone, Serialize)]
pub struct Measured {
    /// Number of drives.
    pub drives: usize,
    /// The measures: code names, in order.
    pub measures: Vec<&'static str>,
    /// How many drives have no value, a measure each, in that order.
    pub missing: Vec<usize>,
    /// Values of the study's own measures: means, a person and condition each.
    pub own: usize,
}

impl Stage for Measure {
    const NAME: &'static str = "measure";
    const FAILURE: &'static str = "could not measure";
    type Result = Measured;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let design = self.design.as_deref();
        let files = Files::default()
            .reads(&self.drives)
            .reads_people(root, design, self.participants.as_deref())
            .writes([&self.out]);
        let study = DesignFile::below(root, design);
        let seat = study.as_ref().map(events_path);
        let files = match seat.filter(|events| events.is_file()) {
            Some(events) => files
                .reads([events])
                .writes([presses_path(&self.out), press_moments_path(&self.out)]),
            None => files,
        };
        Ok(match study.filter(|s| !s.design.measures().is_empty()) {
            Some(study) => files
                .reads_if_there([study.resolve(&study.design.files().measures)])
                .writes([own_path(&self.out)]),
            None => files,
        })
    }

    /// Measures every drive of the folders.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Measured>, StudyError> {
        let study = DesignFile::here(self.design.as_deref())?;
        let measures = measures_of(study.as_ref());
        let names: Vec<&'static str> = measures.iter().map(|m| m.name).collect();
        let gate = study
            .as_ref()
            .map(|study| Gate::of(study, self.participants.as_deref()))
            .transpose()?;
        let own = self.average_own(study.as_ref())?;
        let presses = study.as_ref().map(Presses::of).transpose()?.flatten();
        let mut pressed = PressTables::default();
        let (mut rows, mut left_out, mut exposures) = (Vec::new(), Vec::new(), Vec::new());
        let mut from: BTreeMap<DriveId, &PathBuf> = BTreeMap::new();
        for (done, folder) in self.drives.iter().enumerate() {
            for drive in drives_in(folder)? {
                let drive = drive?;
                watch.check()?;
                if let Some(first) = from.insert(drive.meta().drive.clone(), folder) {
                    return Err(StudyError::BadFile {
                        path: folder.clone(),
                        problem: format!(
                            "holds drive {}, which {} holds too",
                            drive.meta().drive,
                            first.to_slash_lossy()
                        ),
                        help: Some(
                            "measure each drive once: leave out one of the folders or files"
                                .to_owned(),
                        ),
                    });
                }
                let duration_s = drive.rows().time_s.last().copied().unwrap_or(0.0);
                let why = gate
                    .as_ref()
                    .and_then(|g| g.drive(drive.meta(), duration_s));
                if let Some(why) = why {
                    left_out.push((drive.meta().drive.clone(), why));
                    continue;
                }
                let values = measures
                    .iter()
                    .map(|m| (m.name.to_owned(), m.of(&drive)))
                    .collect();
                rows.push(MeasuredDrive {
                    meta: drive.meta().clone(),
                    values,
                    counted_s: None,
                });
                exposures.push((done, Exposure::of(&drive)));
                if let Some(presses) = &presses {
                    pressed.add(presses, &drive);
                }
            }
            watch.step(done + 1, self.drives.len(), "folders measured")?;
        }
        let compared = |condition: ConditionId| {
            study.as_ref().is_none_or(|study| {
                let design = &study.design;
                design.baseline_id() == Some(condition) || design.condition(condition).is_some()
            })
        };
        let parts = comparable_parts(&rows, &exposures, compared);
        let cut = count_in_parts(&self.drives, &measures, &parts, &mut rows, watch)?;
        write_measurements(&self.out, &rows)?;
        let pressed = presses.map(|_| pressed.write(&self.out)).transpose()?;
        let missing: Vec<usize> = names
            .iter()
            .map(|name| rows.iter().filter(|r| r.values[*name].is_none()).count())
            .collect();
        let mut warnings: Vec<String> = measures
            .iter()
            .zip(&missing)
            .filter(|(_, count)| **count > 0)
            .map(|(m, count)| {
                format!(
                    "{count} of {} drives have no {}: {}",
                    rows.len(),
                    m.title.to_lowercase(),
                    m.why_missing
                )
            })
            .collect();
        warnings.extend(cut);
        let out = left_out.iter();
        let out = out.map(|(drive, why)| (drive.to_string(), why.to_string()));
        warnings.extend(told_once("drive", out));
        warnings.extend(own.warnings);
        let mut summary = vec![format!(
            "{} drives measured: {}",
            rows.len(),
            self.out.to_slash_lossy()
        )];
        summary.extend(counted(
            ["drive", "drives"],
            left_out.iter().map(|(_, why)| why),
        ));
        summary.extend(pressed.map(|(rides, presses)| {
            format!(
                "{} in {} of the seat: {}",
                count(presses, "press", "presses"),
                count(rides, "ride", "rides"),
                presses_path(&self.out).to_slash_lossy()
            )
        }));
        summary.extend(own.summary);
        Ok(Outcome {
            value: Measured {
                drives: rows.len(),
                measures: names,
                missing,
                own: own.value,
            },
            summary,
            warnings,
        })
    }
}

impl Measure {
    /// Averages the study's own measures over sessions and trials and writes the means; how many these are.
    fn average_own(&self, study: Option<&DesignFile>) -> Result<Outcome<usize>, StudyError> {
        let declared = study.filter(|s| !s.design.measures().is_empty());
        let Some(study) = declared else {
            if self.drives.is_empty() {
                return Err(StudyError::NotPossible {
                    problem: "nothing to measure: no folder of drives, and the study declares no [[measure]] of its own"
                        .to_owned(),
                    help: Some("name a folder of drives with --drives".to_owned()),
                });
            }
            return Ok(Outcome {
                value: 0,
                summary: Vec::new(),
                warnings: Vec::new(),
            });
        };
        let table = study.resolve(&study.design.files().measures);
        let table = table.to_slash_lossy();
        let mut warnings = Vec::new();
        let own = read_own_measures(study, self.participants.as_deref())?.unwrap_or_else(|| {
            warnings.push(format!(
                "{table} is not there: nobody has a value of the study's own measures"
            ));
            OwnMeasures::default()
        });
        if !own.undeclared.is_empty() {
            warnings.push(format!(
                "{table}: columns that no [[measure]] declares are not read: {}",
                own.undeclared.join(", ")
            ));
        }
        if own.later > 0 {
            warnings.push(format!(
                "{table}: {} of later sessions, which are in no mean: the first session is compared",
                count(own.later, "row is", "rows are")
            ));
        }
        let out = own_path(&self.out);
        write_rows(TableName::OwnMeasurements, &out, &own.measurements)?;
        let averaged = own.measurements.iter().filter(|m| m.n > 1).count();
        let summary = vec![format!(
            "{} of the study's own measures ({averaged} of them means of several sessions or trials): {}",
            count(own.measurements.len(), "value", "values"),
            out.to_slash_lossy()
        )];
        Ok(Outcome {
            value: own.measurements.len(),
            summary,
            warnings,
        })
    }
}

/// The measures of the method, those beyond it that the design names, and what was met.
fn measures_of(study: Option<&DesignFile>) -> Vec<&'static objective::Measure> {
    let named = |m: &&objective::Measure| study.is_some_and(|s| s.design.names(m.name));
    let further = objective::further().iter().filter(named);
    let measures = objective::all().iter().chain(further);
    measures.chain(objective::met()).collect()
}

/// A drive that is not compared whole: its row, its folder, and the part of it that is.
type Part = (usize, usize, Comparable);

/// The drives of people whose drives differ in length, of those that are compared with each other.
fn comparable_parts(
    rows: &[MeasuredDrive],
    exposures: &[(usize, Exposure)],
    compared: impl Fn(ConditionId) -> bool,
) -> Vec<Part> {
    let mut people: BTreeMap<&ParticipantId, Vec<usize>> = BTreeMap::new();
    for (at, row) in rows.iter().enumerate() {
        if compared(row.meta.condition) {
            people.entry(&row.meta.participant).or_default().push(at);
        }
    }
    let mut parts = Vec::new();
    for drives in people.values() {
        let of: Vec<Exposure> = drives.iter().map(|&at| exposures[at].1.clone()).collect();
        let found = drives.iter().zip(comparable(&of));
        let cut = found.filter(|(_, part)| *part != Comparable::Whole);
        parts.extend(cut.map(|(&at, part)| (at, exposures[at].0, part)));
    }
    parts
}

/// Takes counts and extremes from the comparable part of each of these drives; says in a sentence each what was cut and what has no value.
fn count_in_parts(
    folders: &[PathBuf],
    measures: &[&objective::Measure],
    parts: &[Part],
    rows: &mut [MeasuredDrive],
    watch: Watch<'_>,
) -> Result<Vec<String>, StudyError> {
    let grows: Vec<_> = measures.iter().filter(|m| m.grows).collect();
    let of: BTreeMap<DriveId, (usize, Comparable)> = parts
        .iter()
        .map(|(at, _, part)| (rows[*at].meta.drive.clone(), (*at, *part)))
        .collect();
    let mut too_little = Vec::new();
    let needed: BTreeSet<usize> = parts.iter().map(|(_, folder, _)| *folder).collect();
    for folder in needed {
        let folder = &folders[folder];
        for drive in drives_in(folder)? {
            let drive = drive?;
            watch.check()?;
            let Some(&(at, part)) = of.get(&drive.meta().drive) else {
                continue;
            };
            let piece = match part {
                Comparable::Whole => continue,
                Comparable::Until(end_s) => {
                    rows[at].counted_s = Some(end_s);
                    let time_s = &drive.rows().time_s;
                    let end = time_s[0] + end_s;
                    drive.slice(0, time_s.partition_point(|&t| t <= end)).ok()
                }
                Comparable::TooLittle { left_s, of_s } => {
                    too_little.push(format!(
                        "drive {}: {left_s:.0} s of the {of_s:.0} s of the person’s shortest drive are left once their drives have met as many \
                         lead vehicles, expected at least 80 %: it has no count and no smallest gap",
                        drive.meta().drive
                    ));
                    None
                }
            };
            for measure in &grows {
                let value = piece.as_ref().and_then(|piece| measure.of(piece));
                rows[at].values.insert(measure.name.to_owned(), value);
            }
        }
    }
    let cut = parts.len() - too_little.len();
    let people: BTreeSet<_> = parts.iter().map(|p| &rows[p.0].meta.participant).collect();
    let mut said = Vec::new();
    if !parts.is_empty() {
        let titles: Vec<String> = grows.iter().map(|m| m.title.to_lowercase()).collect();
        said.push(format!(
            "{} drives that differ in length: {} are taken from the part of each that is as long and meets as many lead vehicles \
             (`counted_s`; {cut} of {} drives)",
            count(people.len(), "person has", "people have"),
            titles.join(" and "),
            rows.len()
        ));
    }
    said.extend(too_little);
    Ok(said)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::{drives::write_drive, measurements::read_measurements};
    use maveric_domain::{Drive, DriveMeta, DrivenBy, EgoTrack, Recording, Road};
    use std::sync::atomic::AtomicBool;

    /// A drive that moves to the passing lane and back again at each of these times.
    fn drive(who: &str, condition: &str, seconds: f64, passes_s: &[f64]) -> Drive {
        let n = (seconds * 20.0) as usize;
        let time_s: Vec<f64> = (0..n).map(|i| i as f64 / 20.0).collect();
        let step = |t: f64, from: f64| {
            let s = ((t - from) / 4.0).clamp(0.0, 1.0);
            3.66 * s * s * (3.0 - 2.0 * s)
        };
        let pass = |t: f64| {
            passes_s
                .iter()
                .map(|p| step(t, *p) - step(t, p + 10.0))
                .sum()
        };
        let ego = EgoTrack {
            length_m: 4.7,
            x_m: time_s.iter().map(|t| 30.0 * t).collect(),
            y_m: time_s.iter().map(|&t| pass(t)).collect(),
            speed_mps: vec![30.0; n],
        };
        let recording =
            Recording::new(Road::PAPER, 20.0, time_s, vec![0; n], ego, Vec::new()).unwrap();
        let meta = DriveMeta::named(
            format!("{who}-{condition}"),
            who,
            condition,
            DrivenBy::Human,
        )
        .unwrap();
        Drive::from_recording(meta, &recording).unwrap()
    }

    #[test]
    fn lane_changes_of_a_long_drive_are_counted_over_the_time_of_the_persons_short_one() {
        let folder = tempfile::tempdir().unwrap();
        let drives = folder.path().join("drives");
        for made in [
            drive("P01", "own", 100.0, &[20.0]),
            drive("P01", "car", 200.0, &[20.0, 60.0, 120.0, 160.0]),
            drive("P02", "own", 200.0, &[20.0, 120.0]),
            drive("P02", "car", 200.0, &[20.0, 60.0, 120.0]),
        ] {
            write_drive(&drives, &made).unwrap();
        }
        let out = folder.path().join("measurements.parquet");
        let options = Measure {
            design: None,
            participants: None,
            drives: vec![drives],
            out: out.clone(),
        };
        let (quiet, go_on) = (|_: usize, _: usize, _: &str| (), AtomicBool::new(false));
        let outcome = options.run(Watch::new(&quiet, &go_on)).unwrap();
        let counted: Vec<(String, Option<f64>, bool)> = read_measurements(&out)
            .unwrap()
            .into_iter()
            .map(|row| {
                let count = row.values["lane_changes"];
                (row.meta.drive.to_string(), count, row.counted_s.is_some())
            })
            .collect();
        let row = |drive: &str, count, cut| (drive.to_owned(), Some(count), cut);
        assert_eq!(
            counted,
            [
                row("P01-car", 4.0, true),
                row("P01-own", 2.0, true),
                row("P02-car", 6.0, false),
                row("P02-own", 4.0, false),
            ]
        );
        let said = outcome
            .warnings
            .iter()
            .find(|w| w.contains("differ in length"));
        assert!(said.unwrap().starts_with("1 person has drives"), "{said:?}");
    }
}

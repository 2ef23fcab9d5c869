//! `measure`: the objective measures, a row a drive.

use crate::{
    design::DesignFile,
    error::StudyError,
    gate::{Gate, counted},
    once::{count, told_once},
    outcome::{Outcome, Watch, all_cores, for_each_on},
    presses::{PressTables, Presses, events_path, is_pressed_in_seat},
    run_folder::{own_path, press_moments_path, presses_path},
    stage::{Files, Stage},
    tables::{
        TableName,
        drives::{drive_paths, read_drive},
        measurements::{MeasuredDrive, write_measurements},
        own_measures::{OwnMeasures, read_of_rides},
        write_rows,
    },
};
use maveric_analysis::{Rule, Why};
use maveric_domain::{ConditionId, DriveId, Moment, ParticipantId, Ride};
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
    /// Design of the study (TOML); study.toml of the current directory when not given. Without either nothing is left out
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Who takes part; the design's table when not given
    #[arg(long)]
    pub participants: Option<PathBuf>,
    /// Table to write (CSV or Parquet by its name); NAME_own.csv goes beside it where the study has measures of its own
    #[arg(long)]
    pub out: PathBuf,
}

#[derive(Debug, Clone, Serialize)]
pub struct Measured {
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
        let seat = study.as_ref().filter(|s| is_pressed_in_seat(root, s));
        let files = match seat {
            Some(study) => files
                .reads([events_path(study)])
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
        let gate = study.as_ref();
        let gate = gate.map(|study| Gate::new(study, self.participants.as_deref()));
        let gate = gate.transpose()?;
        let averaged = self.average_own(study.as_ref(), gate.as_ref())?;
        let presses = study.as_ref().map(Presses::read).transpose()?.flatten();
        let (mut met, left_out) = self.drives(gate.as_ref(), &measures, presses.as_ref(), watch)?;
        let compared = |condition: ConditionId| {
            study.as_ref().is_none_or(|study| {
                let design = &study.design;
                design.baseline_id() == Some(condition) || design.condition(condition).is_some()
            })
        };
        let parts = comparable_parts(&met, compared);
        let cut = count_in_parts(&measures, &parts, &mut met, watch)?;
        let mut pressed = PressTables::default();
        let mut rows = Vec::new();
        for drive in met {
            pressed.extend(drive.pressed);
            rows.push(drive.row);
        }
        write_measurements(&self.out, &rows)?;
        let pressed = presses.map(|_| pressed.write(&self.out)).transpose()?;
        let missing = |m: &&objective::Measure| {
            let without = rows.iter().filter(|row| row.values[m.name].is_none());
            without.count()
        };
        let missing: Vec<usize> = measures.iter().map(missing).collect();
        let uncounted = parts.iter().filter(|(_, part)| part.is_too_little());
        let uncounted: BTreeSet<usize> = uncounted.map(|(at, _)| *at).collect();
        let mut warnings = why_missing(&measures, &rows, &uncounted);
        warnings.extend(cut);
        let out = left_out.iter();
        let out = out.map(|(drive, why)| (drive.to_string(), why.to_string()));
        warnings.extend(told_once("drive", out));
        warnings.extend(averaged.warnings);
        let mut summary =
            vec![format!("{} drives measured: {}", rows.len(), self.out.to_slash_lossy())];
        summary.extend(counted(["drive", "drives"], left_out.iter().map(|(_, why)| why)));
        summary.extend(pressed.map(|(rides, presses)| {
            format!(
                "{} in {} of the seat: {}",
                count(presses, "press", "presses"),
                count(rides, "ride", "rides"),
                presses_path(&self.out).to_slash_lossy()
            )
        }));
        summary.extend(averaged.summary);
        let value = Measured {
            drives: rows.len(),
            measures: measures.iter().map(|m| m.name).collect(),
            missing,
            own: averaged.value,
        };
        Ok(Outcome::new(value, summary, warnings))
    }
}

/// A drive that is let in, as it was measured.
struct Met {
    path: PathBuf,
    row: MeasuredDrive,
    exposure: Exposure,
    pressed: PressTables,
}

/// Drives that a rule left out, and why.
type LeftOut = Vec<(DriveId, Why)>;

impl Measure {
    /// Measures the drives of all folders, about one a thread in memory at a time.
    fn drives(
        &self,
        gate: Option<&Gate>,
        measures: &[&objective::Measure],
        presses: Option<&Presses>,
        watch: Watch<'_>,
    ) -> Result<(Vec<Met>, LeftOut), StudyError> {
        let folders = self.drives.iter().map(|folder| drive_paths(folder));
        let paths: Vec<PathBuf> = folders.collect::<Result<Vec<_>, _>>()?.concat();
        let measured = for_each_on(all_cores(), &paths, watch, "drives measured", |path| {
            let drive = read_drive(path)?;
            let meta = drive.meta();
            let duration_s = drive.rows().time_s.last().copied().unwrap_or(0.0);
            let out = gate.and_then(|g| g.drive(meta, duration_s));
            if let Some(why) = out {
                return Ok(Err((meta.drive.clone(), why)));
            }
            let mut pressed = PressTables::default();
            if let Some(times) = presses.and_then(|p| p.during(&drive)) {
                pressed.add(times, &drive);
            }
            let value = |m: &&objective::Measure| (m.name.to_owned(), m.of(&drive));
            Ok(Ok(Met {
                path: path.clone(),
                row: MeasuredDrive {
                    meta: meta.clone(),
                    values: measures.iter().map(value).collect(),
                    counted_s: None,
                },
                exposure: Exposure::from_drive(&drive),
                pressed,
            }))
        })?;
        let mut from: BTreeMap<&DriveId, &Path> = BTreeMap::new();
        for (drive, path) in measured.iter().zip(&paths) {
            let id = match drive {
                Ok(met) => &met.row.meta.drive,
                Err((id, _)) => id,
            };
            let folder = path.parent().unwrap_or(path);
            if let Some(first) = from.insert(id, folder) {
                let problem =
                    format!("holds drive {id}, which {} holds too", first.to_slash_lossy());
                let help = "measure each drive once: leave out one of the folders or files";
                return Err(StudyError::file(folder, problem).with_help(help));
            }
        }
        let (mut met, mut left_out) = (Vec::new(), Vec::new());
        for drive in measured {
            match drive {
                Ok(drive) => met.push(drive),
                Err(out) => left_out.push(out),
            }
        }
        Ok((met, left_out))
    }

    /// Averages the study's own measures over sessions and trials and writes the means of what is let in; how many these are.
    fn average_own(
        &self,
        study: Option<&DesignFile>,
        gate: Option<&Gate>,
    ) -> Result<Outcome<usize>, StudyError> {
        let declared = study.filter(|s| !s.design.measures().is_empty());
        let Some(study) = declared else {
            if self.drives.is_empty() {
                let problem = "nothing to measure: no folder of drives, and the study declares no [[measure]] of its own";
                let help = "name a folder of drives with --drives";
                return Err(StudyError::not_possible(problem).with_help(help));
            }
            return Ok(Outcome::new(0, Vec::new(), Vec::new()));
        };
        let table = study.resolve(&study.design.files().measures);
        let table = table.to_slash_lossy();
        let mut warnings = Vec::new();
        // Where each ride is left out, the mean is, and is counted as left out.
        let keeps = |who: &ParticipantId, ride: Ride| {
            let why = gate.and_then(|gate| gate.answer(who, Moment::After(ride)));
            why.is_none_or(|why| why.rule == Rule::UnknownOccasion)
                || gate.is_some_and(|gate| gate.condition(who, ride.condition).is_some())
        };
        let means = read_of_rides(study, self.participants.as_deref(), &keeps)?;
        let mut means = means.unwrap_or_else(|| {
            warnings.push(format!(
                "{table} is not there: nobody has a value of the study's own measures"
            ));
            OwnMeasures::default()
        });
        let mut left_out = Vec::new();
        means.measurements.retain(|m| {
            let why = gate.and_then(|gate| gate.condition(&m.participant, m.condition));
            let is_let_in = why.is_none();
            left_out.extend(why);
            is_let_in
        });
        if !means.undeclared.is_empty() {
            warnings.push(format!(
                "{table}: columns that no [[measure]] declares are not read: {}",
                means.undeclared.join(", ")
            ));
        }
        if means.later > 0 {
            warnings.push(format!(
                "{table}: {} of later sessions, which are in no mean: the first session is compared",
                count(means.later, "row is", "rows are")
            ));
        }
        let out = own_path(&self.out);
        write_rows(TableName::OwnMeasurements, &out, &means.measurements)?;
        let averaged = means.measurements.iter().filter(|m| m.n > 1).count();
        let mut summary = vec![format!(
            "{} of the study's own measures ({averaged} of them means of several sessions or trials): {}",
            count(means.measurements.len(), "value", "values"),
            out.to_slash_lossy()
        )];
        summary.extend(counted(["value", "values"], &left_out));
        Ok(Outcome::new(means.measurements.len(), summary, warnings))
    }
}

/// The measures of the method, those beyond it that the design names, and what was met.
fn measures_of(study: Option<&DesignFile>) -> Vec<&'static objective::Measure> {
    let named = |m: &&objective::Measure| study.is_some_and(|s| s.design.names(m.name));
    let further = objective::further().iter().filter(named);
    let measures = objective::all().iter().chain(further);
    measures.chain(objective::met()).collect()
}

/// How many drives have no value of each measure, and why that may be; of those of which too little is comparable each has its own sentence.
fn why_missing(
    measures: &[&objective::Measure],
    rows: &[MeasuredDrive],
    uncounted: &BTreeSet<usize>,
) -> Vec<String> {
    let warning = |m: &&objective::Measure| {
        let without = rows.iter().enumerate().filter(|(at, row)| {
            row.values[m.name].is_none() && !(m.grows && uncounted.contains(at))
        });
        let count = without.count();
        let sentence = || {
            format!(
                "{count} of {} drives have no {}: {}",
                rows.len(),
                m.title.to_lowercase(),
                m.why_missing
            )
        };
        (count > 0).then(sentence)
    };
    measures.iter().filter_map(warning).collect()
}

/// A drive that is not compared whole, and the part of it that is.
type Part = (usize, Comparable);

/// The drives of people whose drives differ in length, of those that are compared with each other.
fn comparable_parts(met: &[Met], compared: impl Fn(ConditionId) -> bool) -> Vec<Part> {
    let mut people: BTreeMap<&ParticipantId, Vec<usize>> = BTreeMap::new();
    for (at, drive) in met.iter().enumerate() {
        let meta = &drive.row.meta;
        if compared(meta.condition) {
            people.entry(&meta.participant).or_default().push(at);
        }
    }
    let mut parts = Vec::new();
    for drives in people.values() {
        let exposures = drives.iter().map(|&at| met[at].exposure.clone());
        let exposures: Vec<Exposure> = exposures.collect();
        let drive_parts = drives.iter().copied().zip(comparable(&exposures));
        parts.extend(drive_parts.filter(|(_, part)| *part != Comparable::Whole));
    }
    parts
}

/// Takes counts and extremes from the comparable part of each of these drives; says in a sentence each what was cut and what has no value.
fn count_in_parts(
    measures: &[&objective::Measure],
    parts: &[Part],
    met: &mut [Met],
    watch: Watch<'_>,
) -> Result<Vec<String>, StudyError> {
    let grows: Vec<_> = measures.iter().filter(|m| m.grows).collect();
    let mut in_order: Vec<&Part> = parts.iter().collect();
    in_order.sort_by_key(|part| part.0);
    let values = for_each_on(all_cores(), &in_order, watch, "drives counted", |part| {
        let piece = match part.1 {
            Comparable::Until(end_s) => {
                let drive = read_drive(&met[part.0].path)?;
                let time_s = &drive.rows().time_s;
                let end = time_s[0] + end_s;
                drive.slice(0, time_s.partition_point(|&t| t <= end)).ok()
            }
            Comparable::Whole | Comparable::TooLittle { .. } => None,
        };
        let value = |m: &&&objective::Measure| piece.as_ref().and_then(|piece| m.of(piece));
        Ok(grows.iter().map(value).collect::<Vec<_>>())
    })?;
    let mut too_little = Vec::new();
    for ((at, part), values) in in_order.into_iter().zip(values) {
        let row = &mut met[*at].row;
        match part {
            Comparable::Whole => continue,
            Comparable::Until(end_s) => row.counted_s = Some(*end_s),
            Comparable::TooLittle { left_s, of_s } => too_little.push(format!(
                "drive {}: {left_s:.0} s of the {of_s:.0} s of the person’s shortest drive are left once their drives have met as many \
                 lead vehicles, expected at least 80 %: it has no count and no smallest gap",
                row.meta.drive
            )),
        }
        let named = grows.iter().map(|m| m.name.to_owned());
        row.values.extend(named.zip(values));
    }
    let cut = parts.len() - too_little.len();
    let people: BTreeSet<_> = parts.iter().map(|p| &met[p.0].row.meta.participant).collect();
    let mut sentences = Vec::new();
    if !parts.is_empty() {
        let titles: Vec<String> = grows.iter().map(|m| m.title.to_lowercase()).collect();
        sentences.push(format!(
            "{} drives that differ in length: {} are taken from the part of each that is as long and meets as many lead vehicles \
             (`counted_s`; {cut} of {} drives)",
            count(people.len(), "person has", "people have"),
            titles.join(" and "),
            met.len()
        ));
    }
    sentences.extend(too_little);
    Ok(sentences)
}

#[cfg(test)]
mod tests;

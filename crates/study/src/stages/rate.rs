//! `rate`: synthetic participants rate what each condition did.

use crate::{
    design::DesignFile,
    error::StudyError,
    once::count,
    outcome::{Outcome, Watch},
    presses::{PressTables, events_path, is_pressed_in_seat},
    run_folder::{press_moments_path, presses_path, read_effects, read_effects_on, read_scales},
    stage::{Files, Stage},
    tables::{
        drives::drives_in,
        measurements::{MeasuredDrive, one_drive_a_condition, read_measurements},
        participants::read_participants,
        surveys::write_answers,
    },
};
use maveric_domain::{
    Answer, ConditionId, Design, DrivenBy, MeasureValues, Moment, ParticipantId, ProbeAnswer, Ride,
    Scale,
    design::{Condition, Probe},
    occasion::is_first,
    spread,
};
use maveric_measures::seconds_of;
use maveric_participants::{
    Effects, Participant, PressModel, answer_at_random, presses_during, probes_at_random,
};
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

/// Let the synthetic participants rate what each condition did
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric rate --measures measurements.parquet --participants participants.csv --out ratings.csv"
)]
pub struct Rate {
    /// Design of the study (TOML); study.toml of the current directory when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Measurements of own and AV drives
    #[arg(long)]
    pub measures: PathBuf,
    /// The synthetic participants
    #[arg(long)]
    pub participants: PathBuf,
    /// Sizes of the effects (TOML); the design's when not given, else as shipped
    #[arg(long)]
    pub effects: Option<PathBuf>,
    /// Folder of questionnaire definitions; the design's when not given
    #[arg(long)]
    pub scales: Option<PathBuf>,
    /// Drives of the car (folder with drives.parquet), on which people press where the effects say when
    #[arg(long, value_name = "DIR")]
    pub drives: Option<PathBuf>,
    /// Answers to write
    #[arg(long)]
    pub out: PathBuf,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

#[derive(Debug, Clone, Serialize)]
pub struct Ratings {
    pub participants: usize,
    pub answers: usize,
    /// What they pressed on the rides; none where the effects do not say when.
    pub presses: Option<usize>,
}

impl Rate {
    /// The tables of what is pressed, for paths from `root`; none where the effects do not say when, or a seat wrote down what was.
    fn pressed_tables(&self, root: &Path, effects: &Path) -> Vec<PathBuf> {
        let effects = read_effects(&root.join(effects));
        let says = effects.is_ok_and(|effects| effects.presses.is_some());
        let study = DesignFile::below(root, self.design.as_deref());
        let in_seat = study.is_some_and(|study| is_pressed_in_seat(root, &study));
        if says && !in_seat && self.drives.is_some() {
            vec![presses_path(&self.measures), press_moments_path(&self.measures)]
        } else {
            Vec::new()
        }
    }

    /// Lets those who are tested press on their rides; how many rides and presses there are.
    fn press(
        &self,
        model: Option<&PressModel>,
        tested: &BTreeSet<ParticipantId>,
    ) -> Result<Option<(usize, usize)>, StudyError> {
        let Some((model, folder)) = model.zip(self.drives.as_ref()) else {
            return Ok(None);
        };
        let mut tables = PressTables::default();
        for drive in drives_in(folder)? {
            let drive = drive?;
            let meta = drive.meta();
            let (who, ride) = (&meta.participant, meta.ride());
            if meta.driven_by == DrivenBy::Automated && tested.contains(who) {
                let seconds = seconds_of(&drive);
                let times = presses_during(who, ride, &seconds, model, self.seed);
                tables.add(&times, &drive);
            }
        }
        tables.write(&self.measures).map(Some)
    }
}

impl Stage for Rate {
    const NAME: &'static str = "rate";
    const FAILURE: &'static str = "could not rate";
    type Result = Ratings;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let study = DesignFile::below_or_paper(root, self.design.as_deref())?;
        let effects = study.effects_file(self.effects.as_deref());
        Ok(Files::default()
            .reads([&self.measures, &self.participants, &effects])
            .reads([study.scales_folder(self.scales.as_deref())])
            .reads(&self.drives)
            .reads_design(self.design.as_deref())
            .writes([&self.out])
            .writes(self.pressed_tables(root, &effects)))
    }

    /// Lets each synthetic participant who is tested rate the conditions that they sat through and that the car drove; a condition
    /// that was recorded elsewhere has no made-up ratings.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Ratings>, StudyError> {
        let drives = read_measurements(&self.measures)?;
        one_drive_a_condition(&self.measures, &drives)?;
        let study = DesignFile::find(self.design.as_deref())?;
        let tested = study.people(Some(&self.participants))?.tested();
        let people = read_participants(&self.participants, &study.design)?;
        let scales = read_scales(&study.scales_folder(self.scales.as_deref()))?;
        let effects = study.effects_file(self.effects.as_deref());
        let asking = Asking::new(&study, &scales, &effects, &drives, self.seed)?;
        let mut sheets = Sheets::default();
        for person in people.iter().filter(|p| tested.contains(&p.id)) {
            watch.check()?;
            asking.ask(person, &drives, &mut sheets)?;
        }
        if sheets.raters == 0 {
            let problem = format!(
                "no participant of {} has an own drive in {}",
                self.participants.to_slash_lossy(),
                self.measures.to_slash_lossy()
            );
            let help =
                "measure the drives of the same study: --drives drives/study2 --drives av/drives";
            return Err(StudyError::not_possible(problem).with_help(help));
        }
        write_answers(&self.out, &sheets.answers, &sheets.probes)?;
        let mut summary = vec![format!(
            "{} synthetic participants rated their conditions: {}",
            sheets.raters,
            self.out.to_slash_lossy()
        )];
        let mut warnings = sheets.warnings;
        let mut model = asking.effects.presses.as_ref();
        if model.is_some() && is_pressed_in_seat(Path::new(""), &study) {
            model = None;
            warnings.push(format!(
                "{} says what was pressed: no presses are made up",
                events_path(&study).to_slash_lossy()
            ));
        }
        let pressed = self.press(model, &tested)?;
        summary.extend(pressed.map(|(rides, presses)| {
            format!(
                "{} on {} of made-up people: {}",
                count(presses, "press", "presses"),
                count(rides, "ride", "rides"),
                presses_path(&self.measures).to_slash_lossy()
            )
        }));
        let value = Ratings {
            participants: sheets.raters,
            answers: sheets.answers.len(),
            presses: pressed.map(|(_, presses)| presses),
        };
        Ok(Outcome::new(value, summary, warnings))
    }
}

#[derive(Default)]
struct Sheets {
    answers: Vec<Answer>,
    probes: Vec<ProbeAnswer>,
    warnings: Vec<String>,
    raters: usize,
}

/// What is asked, and how it is answered.
struct Asking<'a> {
    design: &'a Design,
    baseline: ConditionId,
    scales: &'a [Scale],
    effects: Effects,
    /// Of measures over the drives by hand.
    spread: BTreeMap<String, f64>,
    /// Asked on the way, and how often, in s.
    probe: Option<(&'a Scale, f64)>,
    seed: u64,
}

impl<'a> Asking<'a> {
    fn new(
        study: &'a DesignFile,
        scales: &'a [Scale],
        effects: &Path,
        drives: &[MeasuredDrive],
        seed: u64,
    ) -> Result<Self, StudyError> {
        let design = &study.design;
        let Some(baseline) = design.baseline_id() else {
            return Err(study.wrong(
                "`baseline`: found none, expected a drive by hand that people compare the car with",
                Some("add [baseline] with the id of that drive, such as id = \"own\"".to_owned()),
            ));
        };
        let effects = read_effects_on(effects, scales)?;
        let probe = design.protocol().probe.as_ref();
        let probe = probe.map(|probe| {
            let scale = scales.iter().find(|scale| scale.id == probe.scale);
            let missing = || {
                study.wrong(
                    format!("`protocol.probe.scale`: `{}`, and no scale has that id", probe.scale),
                    Some("write it into the folder of --scales".to_owned()),
                )
            };
            Ok::<_, StudyError>((scale.ok_or_else(missing)?, probe.every_s))
        });
        let probe = probe.transpose()?;
        let by_hand = drives.iter().filter(|d| drove_first(d, baseline));
        let by_hand: Vec<&MeasureValues> = by_hand.map(|d| &d.values).collect();
        Ok(Self { design, baseline, scales, effects, spread: spread(&by_hand), probe, seed })
    }

    /// The rides of a person that the car drove: each session and each round of rides in the person's order.
    fn rides(&self, person: &Participant) -> Vec<Ride> {
        let simulated =
            |id: &&ConditionId| self.design.condition(**id).is_some_and(Condition::simulated);
        let order = person.order.iter().filter(simulated);
        let mut rides: Vec<Ride> =
            order.flat_map(|&condition| self.design.rides(condition)).collect();
        rides.sort_by_key(|ride| ride.occasion);
        rides
    }

    /// Adds what a person says of each ride, on the way and after it.
    fn ask(
        &self,
        person: &Participant,
        drives: &[MeasuredDrive],
        sheets: &mut Sheets,
    ) -> Result<(), StudyError> {
        let theirs = drives.iter().filter(|d| d.meta.participant == person.id);
        let theirs: Vec<&MeasuredDrive> = theirs.collect();
        let Some(by_hand) = theirs.iter().find(|d| drove_first(d, self.baseline)) else {
            sheets.warnings.push(format!("participant {}: no own drive, so no ratings", person.id));
            return Ok(());
        };
        let rides = self.rides(person);
        let driven = rides.iter().filter_map(|ride| {
            let drive = theirs.iter().find(|d| d.meta.ride() == *ride)?;
            Some((*ride, *drive))
        });
        let driven: Vec<(Ride, &MeasuredDrive)> = driven.collect();
        let missing = rides.len() - driven.len();
        if missing > 0 {
            let [one, several] = if self.design.repeats() {
                ["ride was", "rides were"]
            } else {
                ["condition was", "conditions were"]
            };
            sheets.warnings.push(format!(
                "participant {}: {} not driven, so not rated",
                person.id,
                count(missing, one, several)
            ));
        }
        let (who, rate) = (&person.id, self.effects.missing_rate);
        if let Some((scale, every_s)) = self.probe {
            for (ride, drive) in &driven {
                // Made-up rides are as long as the design says that a ride is.
                let length_s = drive.counted_s.unwrap_or(self.design.protocol().ride_s);
                let asked_s = Probe::asked_s(every_s, length_s);
                let given = probes_at_random(who, *ride, scale, asked_s, rate, self.seed);
                sheets.probes.extend(given);
            }
        }
        let trials = driven.iter().map(|(ride, drive)| (*ride, drive.values.clone()));
        let trials: Vec<(Ride, MeasureValues)> = trials.collect();
        let rated = maveric_participants::rate(
            person,
            &by_hand.values,
            &trials,
            &self.spread,
            self.scales,
            &self.effects,
            self.seed,
        )?;
        let warnings = rated.warnings.iter().map(ToString::to_string);
        sheets.warnings.extend(warnings);
        sheets.answers.extend(rated.answers);
        for (ride, _) in &trials {
            let unknown = self.effects.unknown_of(self.design, self.scales);
            let given = answer_at_random(who, Moment::After(*ride), unknown, rate, self.seed);
            sheets.answers.extend(given);
        }
        sheets.raters += 1;
        Ok(())
    }
}

/// What a ride is held against is how the person drove first.
fn drove_first(drive: &MeasuredDrive, baseline: ConditionId) -> bool {
    drive.meta.condition == baseline && is_first(&drive.meta.session)
}

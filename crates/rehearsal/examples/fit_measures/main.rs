//! What drives of a population look like, measure by measure: the file that `maveric rehearse --population` draws from, fitted to drives.
//!
//! `cargo run -p maveric-rehearsal --example fit_measures -- FILE 200 1` lets 200 people whose habits FILE gives drive (seed 1), learns
//! linear heads from 30 others, drives the car as each of the 200 at 0, +15, -15 and across, and prints the file.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

#[path = "../made_up/mod.rs"]
mod made_up;

use made_up::{Wrong, all_cores, cohort, driven, people_of, scores};
use maveric_domain::{Drive, Embedding, StyleScore, stream_seed};
use maveric_model::{
    TrainSettings, TrainingDrive, personalize,
    style_space::{LinearHead, PerpendicularEllipse},
    train,
};
use maveric_participants::{Part, Participant, PlannedDrive, Trait};
use maveric_rehearsal::{
    DrawnMeasure, MeasureModel, PopulationModel, Round, Step,
    validation::{MEASURES, Values, values},
};
use maveric_simulator::{Driver, Scenario, rollout};
use maveric_steering::ModelPlanner;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng as _;
use rand_pcg::Pcg64Mcg;
use std::ops::ControlFlow;

const LEARNERS: usize = 30;
/// ADB points of a step of the dial.
const POINTS: f64 = 15.0;
const TRAITS: [Trait; 3] = [Trait::Aggressiveness, Trait::Spacing, Trait::Pace];

/// One person: traits, own drive and the car's four, place on the line without and with the score.
struct Seen {
    traits: [f64; 3],
    own: Values,
    /// In the own style, at +15, at -15, and across.
    car: [Values; 4],
    angle: f64,
    line: [f64; 2],
    adb: f64,
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn covariance(x: &[f64], y: &[f64]) -> f64 {
    let (mx, my) = (mean(x), mean(y));
    let products = x.iter().zip(y).map(|(a, b)| (a - mx) * (b - my));
    products.sum::<f64>() / (x.len().max(2) - 1) as f64
}

fn sd(values: &[f64]) -> f64 {
    covariance(values, values).sqrt()
}

fn rounded(value: f64) -> f64 {
    (1000.0 * value).round() / 1000.0
}

/// Slopes by least squares, and the SD of what they leave.
fn least_squares<const K: usize>(rows: &[([f64; K], f64)]) -> Result<([f64; K], f64), Wrong> {
    let x = DMatrix::from_fn(rows.len(), K, |i, j| rows[i].0[j]);
    let y = DVector::from_fn(rows.len(), |i, _| rows[i].1);
    let solved = (x.transpose() * &x).cholesky().ok_or("too few people")?;
    let slopes = solved.solve(&(x.transpose() * &y));
    let left = y - x * &slopes;
    let left_sd = (left.norm_squared() / (rows.len() - K) as f64).sqrt();
    Ok((std::array::from_fn(|j| slopes[j]), left_sd))
}

fn see(path: &str, n: usize, seed: u64) -> Result<Vec<Seen>, Wrong> {
    let (who, scenario) = (people_of(path)?, Scenario::paper());
    let cohort = cohort(LEARNERS, n, seed)?;
    let score = scores(&cohort, seed)?;
    let learns = |d: &PlannedDrive| d.part == Part::Learn;
    let (learned, tested): (Vec<_>, Vec<_>) = cohort.drives.iter().cloned().partition(learns);
    let drives = driven(&learned, &who, &scenario, seed, |d| d)?;
    let training = drives.iter().map(|drive| TrainingDrive { drive, adb: score(drive) });
    let training: Vec<TrainingDrive<'_>> = training.collect();
    let go_on = &mut |_: &_| ControlFlow::Continue(());
    let model = train(&training, &TrainSettings::default(), seed, go_on)?.model;
    let axis = LinearHead::aggression(&model)?;
    let ellipse = PerpendicularEllipse::of(&model)?;
    let own_drives = driven(&tested, &who, &scenario, seed, |d| d)?;
    let see = |drive: &Drive| -> Result<Seen, Wrong> {
        let id = &drive.meta().participant;
        let person: &Participant = cohort.find(id).ok_or("nobody of the cohort")?;
        let adb = score(drive);
        let plain = personalize(&model, drive, None)?.embedding;
        let known = personalize(&model, drive, adb)?.embedding;
        let labels = [id.as_str(), "across"];
        let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(seed, &labels));
        let across = ellipse.sample(&known, &mut rng)?;
        let style = [
            ("mimic", known.clone()),
            ("up", axis.shift(&known, POINTS)?.embedding),
            ("down", axis.shift(&known, -POINTS)?.embedding),
            ("across", across.embedding),
        ];
        let ride = |(name, style): &(&str, Embedding)| -> Result<Values, Wrong> {
            let controllers = &scenario.settings().controllers;
            let mut planner = ModelPlanner::new(&model, style, controllers)?;
            let controllers = planner.controllers();
            let world = stream_seed(seed, &[id.as_str(), name, "world"]);
            let car = Driver::Automated(&mut planner, &controllers);
            let driven = rollout(&scenario, car, world)?;
            let recording = &driven.recording;
            Ok(values(&Drive::from_recording(drive.meta().clone(), recording)?))
        };
        let car: Result<Vec<Values>, Wrong> = style.iter().map(ride).collect();
        Ok(Seen {
            traits: TRAITS.map(|t| person.latent(t)),
            own: values(drive),
            car: car?.try_into().map_err(|_| "four drives of the car")?,
            angle: across.angle_rad,
            line: [axis.position(&plain)?, axis.position(&known)?],
            adb: adb.map_or(f64::NAN, StyleScore::points),
        })
    };
    all_cores(&own_drives, see)
}

/// In SDs of own drives, as the file has it.
fn standardised(m: &DrawnMeasure, value: f64) -> f64 {
    if m.log {
        let square = libm::log(1.0 + (m.sd / m.mean).powi(2));
        (libm::log(value.max(1e-6)) - libm::log(m.mean) + 0.5 * square) / square.sqrt()
    } else {
        (value - m.mean) / m.sd
    }
}

fn fit_measure(m: &mut DrawnMeasure, k: usize, seen: &[Seen], shared: f64) -> Result<f64, Wrong> {
    let own_values: Vec<f64> = seen.iter().filter_map(|s| s.own[k]).collect();
    (m.mean, m.sd) = (rounded(mean(&own_values)), rounded(sd(&own_values)));
    m.missing = rounded(1.0 - own_values.len() as f64 / seen.len() as f64);
    let z = |value: Option<f64>| value.map(|v| standardised(m, v));
    let of_traits: Vec<([f64; 3], f64)> =
        seen.iter().filter_map(|s| Some((s.traits, z(s.own[k])?))).collect();
    let (loadings, _) = least_squares(&of_traits)?;
    // Of those with all drives: error in the own style, and what each setting adds to it.
    let complete: Vec<(f64, [f64; 3], f64)> = seen
        .iter()
        .filter_map(|s| {
            let mimic = z(s.car[0][k])?;
            let moved = [z(s.car[1][k])? - mimic, z(s.car[2][k])? - mimic, z(s.car[3][k])? - mimic];
            Some((mimic - z(s.own[k])?, moved, s.angle))
        })
        .collect();
    let error: Vec<f64> = complete.iter().map(|c| c.0).collect();
    let moved = |i: usize| -> Vec<f64> { complete.iter().map(|c| c.1[i]).collect() };
    let (up, down) = (moved(0), moved(1));
    let of_angle = |c: &(f64, [f64; 3], f64)| ([libm::cos(c.2), libm::sin(c.2)], c.1[2]);
    let rows: Vec<([f64; 2], f64)> = complete.iter().map(of_angle).collect();
    let ([cosine, sine], left) = least_squares(&rows)?;
    let error_sd = sd(&error);
    // Two drives of the car differ by their own errors as well.
    let roads = 2.0 * error_sd * error_sd * (1.0 - shared);
    let beyond = |sd: f64| rounded((sd * sd - roads).max(0.0).sqrt());
    let step = |values: &[f64]| Step { step: rounded(mean(values)), sd: beyond(sd(values)) };
    m.loadings = TRAITS.into_iter().zip(loadings.map(rounded)).collect();
    (m.bias, m.error_sd) = (rounded(mean(&error)), rounded(error_sd));
    (m.up, m.down) = (step(&up), step(&down));
    m.across = Round { cosine: rounded(cosine), sine: rounded(sine), sd: beyond(left) };
    // cov(error, error + moved) over var(error).
    let settings = [&up, &down];
    let common = settings.map(|moved| 1.0 + covariance(&error, moved) / error_sd.powi(2));
    Ok(mean(&common))
}

fn fit(model: &mut PopulationModel, seen: &[Seen]) -> Result<(), Wrong> {
    // What the errors share decides how much of a step's scatter is the errors'.
    for last in [false, true] {
        let mut common = Vec::new();
        for (k, name) in MEASURES.iter().enumerate() {
            if let Some(MeasureModel::Drawn(m)) = model.measures.get_mut(*name) {
                common.push(fit_measure(m, k, seen, model.shared)?);
            }
        }
        if !last {
            model.shared = rounded(mean(&common).clamp(0.0, 1.0));
        }
    }
    let place = |name: &str| MEASURES.iter().position(|m| *m == name);
    for (k, name) in MEASURES.iter().enumerate() {
        let Some(MeasureModel::Derived(m)) = model.measures.get_mut(*name) else {
            continue;
        };
        let (metres, speed) = place(&m.metres).zip(place(&m.velocity)).ok_or("no such measure")?;
        let ratio = |s: &Seen| Some(s.own[k]? / (s.own[metres]? / s.own[speed]?));
        let ratios: Vec<f64> = seen.iter().filter_map(ratio).collect();
        m.factor = rounded(mean(&ratios));
        m.scatter = rounded(sd(&ratios) / mean(&ratios));
    }
    let plain: Vec<f64> = seen.iter().map(|s| s.line[0]).collect();
    let adb: Vec<f64> = seen.iter().map(|s| s.adb).collect();
    let (centre, unit) = (mean(&plain), sd(&plain));
    let (adb_mean, adb_sd) = (mean(&adb), sd(&adb));
    let of_traits = |s: &Seen| (s.traits, (s.line[0] - centre) / unit);
    let (loadings, _) = least_squares(&seen.iter().map(of_traits).collect::<Vec<_>>())?;
    model.line.loadings = TRAITS.into_iter().zip(loadings.map(rounded)).collect();
    let towards = |s: &Seen| {
        let to_score = (s.adb - adb_mean) / adb_sd - (s.line[0] - centre) / unit;
        ([to_score], (s.line[1] - s.line[0]) / unit)
    };
    let ([weight], _) = least_squares(&seen.iter().map(towards).collect::<Vec<_>>())?;
    model.line.adb_weight = rounded(weight.clamp(0.0, 1.0));
    Ok(())
}

fn main() -> Result<(), Wrong> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let [path, n, seed] = words[..] else {
        return Err("give: FILE PEOPLE SEED".into());
    };
    let mut model = PopulationModel::from_toml(maveric_data::POPULATION)?;
    fit(&mut model, &see(path, n.parse()?, seed.parse()?)?)?;
    let command =
        format!("cargo run -p maveric-rehearsal --example fit_measures -- {path} {n} {seed}");
    let text = toml::to_string(&model)?;
    PopulationModel::from_toml(&text)?;
    println!(
        "{}{text}",
        HEAD.replace("{path}", path).replace("{n}", n).replace("{command}", &command)
    );
    Ok(())
}

/// What the file says of itself.
const HEAD: &str = "\
# What drives of the people of {path} look like, measure by measure, without driving: `maveric rehearse --population FILE`.
#
# Written by the command
#   {command}
# Own drives and those of the car are of {n} people, least squares; population.toml says what each key is. Limits, and whether a measure is a
# count or its logarithm is normal, are as there.

";

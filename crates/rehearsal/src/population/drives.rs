//! The drives of one person by hand and by the car, drawn measure by measure.

use super::{DrawnMeasure, MeasureModel, PopulationModel, Round};
use maveric_domain::{
    MeasureValues,
    design::{Car, Condition},
    stream_seed,
};
use maveric_participants::{Participant, Trait};
use rand::{RngExt as _, SeedableRng as _};
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64;
use std::collections::BTreeMap;

/// The measures of a person's own drive and of drives of the car.
#[derive(Debug, Clone)]
pub struct Drives {
    pub own: MeasureValues,
    /// By the car, in the order asked for.
    pub trials: Vec<MeasureValues>,
}

/// What the car is set to do in a trial.
#[derive(Debug, Clone, Copy)]
pub enum CarSetting<'a> {
    /// A shift of the dial, in units of the population's step; 0 is the person's own style.
    Shift(f64),
    /// A move to this angle round the ellipse.
    Round(f64),
    Mean,
    /// Somebody else's style, as their own car drives it.
    Lent {
        donor: &'a Participant,
        /// How far it is moved along the dial, as of [`CarSetting::Shift`].
        shift: f64,
    },
    /// None: the person drives by hand once more, as far from the first drive as a ride in their own style is, but without a car's bias.
    ByHand,
}

impl CarSetting<'_> {
    /// A study's condition without somebody else's style; the angle is used by a move across the dial alone.
    pub fn for_condition(condition: &Condition, angle: f64, step: f64) -> Self {
        match condition.car {
            Some(Car::Across) => Self::Round(angle),
            Some(Car::Mean) => Self::Mean,
            _ => Self::Shift(condition.dial().unwrap_or(0.0) / step),
        }
    }
}

pub(super) fn stream(seed: u64, labels: &[&str]) -> Pcg64 {
    Pcg64::seed_from_u64(stream_seed(seed, labels))
}

fn normal(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}

impl PopulationModel {
    /// Own drive and trials of a person. Each value depends on the seed, the person, the measure and the trial's `label` alone.
    pub fn drives(
        &self,
        person: &Participant,
        trials: &[(&str, CarSetting<'_>)],
        seed: u64,
    ) -> Drives {
        let id = person.id.as_str();
        let mut drives =
            Drives { own: MeasureValues::new(), trials: vec![MeasureValues::new(); trials.len()] };
        for (name, measure) in &self.measures {
            let MeasureModel::Drawn(m) = measure else {
                continue;
            };
            let mut rng = own_stream(person, name, seed);
            let own_habit = Habit::drawn(m, person, &mut rng);
            let shown = m.shown(own_habit.value, &mut rng);
            drives.own.insert(name.clone(), shown);
            for ((label, setting), values) in trials.iter().zip(&mut drives.trials) {
                let mut rng = stream(seed, &[id, "trial", name, label]);
                let error = self.shared.sqrt() * own_habit.common
                    + (1.0 - self.shared).sqrt() * normal(&mut rng);
                let driven = match setting {
                    CarSetting::Mean => Habit::AVERAGE,
                    CarSetting::Lent { donor, .. } => {
                        Habit::drawn(m, donor, &mut own_stream(donor, name, seed))
                    }
                    CarSetting::Shift(_) | CarSetting::Round(_) | CarSetting::ByHand => own_habit,
                };
                let moved = m.moved(*setting, driven.differs, &mut rng)
                    + self.other_style * self.apart(m, own_habit, driven);
                let by_hand = matches!(setting, CarSetting::ByHand);
                let bias = if by_hand { 0.0 } else { m.bias };
                let value = m.shown(own_habit.value + bias + moved + m.error_sd * error, &mut rng);
                values.insert(name.clone(), value);
            }
        }
        for (name, measure) in &self.measures {
            let MeasureModel::Derived(m) = measure else {
                continue;
            };
            let labels = std::iter::once("own").chain(trials.iter().map(|(label, _)| *label));
            let sets = std::iter::once(&mut drives.own).chain(&mut drives.trials);
            for (label, values) in labels.zip(sets) {
                let mut rng = stream(seed, &[id, "derived", name, label]);
                let value_of = |name: &String| values.get(name).copied().flatten();
                let scatter = 1.0 + m.scatter * normal(&mut rng);
                let value = value_of(&m.metres)
                    .zip(value_of(&m.velocity))
                    .map(|(d, v)| m.factor * d / v * scatter);
                values.insert(name.clone(), value);
            }
        }
        drives
    }

    /// By how much a car in the one style differs from one in the other on the mean over rides, in SDs over people.
    fn apart(&self, measure: &DrawnMeasure, own: Habit, other: Habit) -> f64 {
        let by_error = measure.error_sd * self.shared.sqrt();
        other.value - own.value + by_error * (other.common - own.common)
    }

    /// Positions on the line of people with these standardised ADB scores: without and with the score in the fit.
    pub fn positions(&self, person: &Participant, adb: f64, seed: u64) -> (f64, f64) {
        let mut rng = stream(seed, &[person.id.as_str(), "line"]);
        let position = explained(&self.line.loadings, person, &mut rng);
        let w = self.line.adb_weight;
        (position, (1.0 - w) * position + w * adb)
    }

    /// The angle of a person's Perpendicular condition, evenly over the circle.
    pub fn angle(person: &Participant, seed: u64) -> f64 {
        let mut rng = stream(seed, &[person.id.as_str(), "angle"]);
        rng.random_range(-std::f64::consts::PI..std::f64::consts::PI)
    }
}

/// What the own drive of a person is drawn by, in a measure.
fn own_stream(person: &Participant, measure: &str, seed: u64) -> Pcg64 {
    stream(seed, &[person.id.as_str(), "own drive", measure])
}

/// A style as a measure shows it.
#[derive(Debug, Clone, Copy)]
struct Habit {
    /// Of the own drive, in SDs over people.
    value: f64,
    /// What the car's errors in this style have in common, of variance 1.
    common: f64,
    /// By how much its dial is steeper or flatter upwards and downwards, of variance 1.
    differs: [f64; 2],
}

impl Habit {
    const AVERAGE: Self = Self { value: 0.0, common: 0.0, differs: [0.0; 2] };

    /// Of a person, from the start of [`own_stream`].
    fn drawn(measure: &DrawnMeasure, person: &Participant, rng: &mut Pcg64) -> Self {
        Self {
            value: explained(&measure.loadings, person, rng),
            common: normal(rng),
            differs: [normal(rng), normal(rng)],
        }
    }
}

/// Loadings · traits + noise, of variance 1.
fn explained(loadings: &BTreeMap<Trait, f64>, person: &Participant, rng: &mut Pcg64) -> f64 {
    let known: f64 = loadings.iter().map(|(name, l)| l * person.latent(*name)).sum();
    let squares: f64 = loadings.values().map(|l| l * l).sum();
    known + (1.0 - squares).max(0.0).sqrt() * normal(rng)
}

impl DrawnMeasure {
    /// Change at this setting from the style that it starts from, whose dial is steeper or flatter by `differs`.
    pub(super) fn moved(&self, setting: CarSetting<'_>, differs: [f64; 2], rng: &mut Pcg64) -> f64 {
        match setting {
            CarSetting::Shift(shift) | CarSetting::Lent { shift, .. } => {
                if shift >= 0.0 {
                    shift * (self.up.step + self.up.sd * differs[0])
                } else {
                    -shift * (self.down.step + self.down.sd * differs[1])
                }
            }
            CarSetting::Mean | CarSetting::ByHand => 0.0,
            CarSetting::Round(angle) => {
                let Round { cosine, sine, sd } = self.across;
                cosine * libm::cos(angle) + sine * libm::sin(angle) + sd * normal(rng)
            }
        }
    }

    /// From SDs to the measure's unit.
    pub(super) fn shown(&self, z: f64, rng: &mut Pcg64) -> Option<f64> {
        if self.missing > 0.0 && rng.random_bool(self.missing) {
            return None;
        }
        let value = if self.log {
            let square = libm::log(1.0 + (self.sd / self.mean).powi(2));
            libm::exp(libm::log(self.mean) - 0.5 * square + square.sqrt() * z)
        } else {
            self.mean + self.sd * z
        };
        let value = if self.whole { value.round() } else { value };
        Some(value.clamp(self.low, self.high))
    }
}

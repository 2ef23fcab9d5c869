//! What drives look like, measure by measure: the generator of studies that are not driven.

use crate::error::RehearsalError;
use maveric_domain::{
    MeasureValues,
    design::{Car, Condition},
    stream_seed,
};
use maveric_participants::{Participant, Trait};
use rand::{RngExt as _, SeedableRng as _};
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// `study_data/population.toml`: see there for what each number is and where it comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PopulationModel {
    /// Part of the car's error that a person's conditions have in common, 0 to 1.
    pub shared: f64,
    /// The position on the aggression line.
    pub line: LineModel,
    /// The measures, by code name.
    pub measures: BTreeMap<String, MeasureModel>,
    /// Effect: how far the car goes from a person's own style towards another, the average or a lent one; 1 is all the way. Not in the
    /// file.
    #[serde(skip, default = "all_the_way")]
    pub other_style: f64,
}

fn all_the_way() -> f64 {
    1.0
}

/// The position on the aggression line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LineModel {
    /// Effect: loadings on traits; squares add up to at most 1.
    pub loadings: BTreeMap<Trait, f64>,
    /// Effect: weight of the standardised ADB score in the fit with it, 0 to 1.
    pub adb_weight: f64,
}

/// How a measure of a drive is made up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum MeasureModel {
    /// Drawn from the person's traits and chance.
    Drawn(Box<DrawnMeasure>),
    /// A gap in seconds, from one in metres.
    Derived(DerivedMeasure),
}

/// A measure that is drawn. The unit of all but `mean` and `sd` is one SD over people.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawnMeasure {
    /// Mean of own drives.
    pub mean: f64,
    /// Standard deviation of own drives over people.
    pub sd: f64,
    /// Whether its logarithm is normal.
    #[serde(default)]
    pub log: bool,
    /// Whether it is a count.
    #[serde(default)]
    pub whole: bool,
    /// Share of drives without a value.
    #[serde(default)]
    pub missing: f64,
    /// Loadings on traits; squares add up to at most 1.
    pub loadings: BTreeMap<Trait, f64>,
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
    /// Mean error of the car.
    pub bias: f64,
    /// Standard deviation of the car's error.
    pub error_sd: f64,
    /// Effect: a step up the dial.
    pub up: Step,
    /// Effect: a step down the dial.
    pub down: Step,
    /// Effect: a move across the dial.
    pub across: Round,
}

/// A move along the line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// Mean change.
    pub step: f64,
    /// Standard deviation of it over people.
    pub sd: f64,
}

/// A move round the ellipse.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Round {
    /// Change with the cosine of the angle.
    pub cosine: f64,
    /// Change with its sine.
    pub sine: f64,
    /// Standard deviation of what the angle does not explain.
    pub sd: f64,
}

/// A gap in seconds: `factor` · metres / velocity · (1 + `scatter` · N).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DerivedMeasure {
    /// Code name of the gap in metres.
    pub metres: String,
    /// Code name of the velocity.
    pub velocity: String,
    /// Near 1.
    pub factor: f64,
    /// Standard deviation of what is left.
    pub scatter: f64,
}

/// The measures of a person's own drive and of drives of the car.
#[derive(Debug, Clone)]
pub struct Drives {
    /// By hand.
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
    /// The average style.
    Mean,
    /// Somebody else's style, as their own car drives it.
    Lent {
        /// Whose.
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

fn stream(seed: u64, labels: &[&str]) -> Pcg64 {
    Pcg64::seed_from_u64(stream_seed(seed, labels))
}

fn normal(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}

impl PopulationModel {
    /// Parses and checks a population.
    ///
    /// # Errors
    /// [`RehearsalError::Population`] naming the key and what is wrong with it.
    pub fn from_toml(text: &str) -> Result<Self, RehearsalError> {
        let bad = |problem: String| RehearsalError::Population(problem);
        let model: Self = toml::from_str(text).map_err(|e| bad(e.to_string()))?;
        model.check().map_err(bad)?;
        Ok(model)
    }

    fn check(&self) -> Result<(), String> {
        let within = |name: String, value: f64, low: f64, high: f64| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(format!("`{name}` is {value}, expected {low} to {high}"))
            }
        };
        within("shared".to_owned(), self.shared, 0.0, 1.0)?;
        within("line.adb_weight".to_owned(), self.line.adb_weight, 0.0, 1.0)?;
        let squares = |l: &BTreeMap<Trait, f64>| l.values().map(|v| v * v).sum::<f64>();
        within(
            "line.loadings (sum of squares)".to_owned(),
            squares(&self.line.loadings),
            0.0,
            1.0,
        )?;
        if self.measures.is_empty() {
            return Err("holds no measures".to_owned());
        }
        for (name, measure) in &self.measures {
            let key = |field: &str| format!("measures.{name}.{field}");
            match measure {
                MeasureModel::Drawn(m) => {
                    within(key("sd"), m.sd, 1e-9, 1e6)?;
                    within(key("mean"), m.mean, if m.log { 1e-9 } else { -1e6 }, 1e6)?;
                    within(key("missing"), m.missing, 0.0, 0.9)?;
                    within(
                        key("loadings (sum of squares)"),
                        squares(&m.loadings),
                        0.0,
                        1.0,
                    )?;
                    within(key("low"), m.low, -1e6, m.high)?;
                    within(key("error_sd"), m.error_sd, 0.0, 10.0)?;
                    for (field, value) in [
                        ("bias", m.bias),
                        ("up.step", m.up.step),
                        ("down.step", m.down.step),
                        ("across.cosine", m.across.cosine),
                        ("across.sine", m.across.sine),
                    ] {
                        within(key(field), value, -10.0, 10.0)?;
                    }
                    for (field, value) in [
                        ("up.sd", m.up.sd),
                        ("down.sd", m.down.sd),
                        ("across.sd", m.across.sd),
                    ] {
                        within(key(field), value, 0.0, 10.0)?;
                    }
                }
                MeasureModel::Derived(m) => {
                    within(key("factor"), m.factor, 1e-3, 1e3)?;
                    within(key("scatter"), m.scatter, 0.0, 0.2)?;
                    for other in [&m.metres, &m.velocity] {
                        if !matches!(self.measures.get(other), Some(MeasureModel::Drawn(_))) {
                            return Err(format!(
                                "`measures.{name}` needs `{other}`, which is not a drawn measure of the file"
                            ));
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// The same people and errors with every effect times `factor`; 0 is a world in which all conditions are alike.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        let squares: f64 = scaled.line.loadings.values().map(|l| l * l).sum();
        // A loading cannot explain more than there is.
        let most = if squares > 0.0 {
            0.97 / squares.sqrt()
        } else {
            1.0
        };
        scaled
            .line
            .loadings
            .values_mut()
            .for_each(|l| *l *= factor.min(most));
        scaled.line.adb_weight = (scaled.line.adb_weight * factor).min(1.0);
        for measure in scaled.measures.values_mut() {
            if let MeasureModel::Drawn(m) = measure {
                for step in [&mut m.up, &mut m.down] {
                    step.step *= factor;
                    step.sd *= factor;
                }
                m.across.cosine *= factor;
                m.across.sine *= factor;
                m.across.sd *= factor;
            }
        }
        scaled.other_style *= factor;
        scaled
    }

    /// Own drive and trials of a person. Each value depends on the seed, the person, the measure and the trial's `label` alone.
    pub fn drives(
        &self,
        person: &Participant,
        trials: &[(&str, CarSetting<'_>)],
        seed: u64,
    ) -> Drives {
        let id = person.id.as_str();
        let mut drives = Drives {
            own: MeasureValues::new(),
            trials: vec![MeasureValues::new(); trials.len()],
        };
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
                let value = m.shown(
                    own_habit.value + bias + moved + m.error_sd * error,
                    &mut rng,
                );
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
    const AVERAGE: Self = Self {
        value: 0.0,
        common: 0.0,
        differs: [0.0; 2],
    };

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
    let known: f64 = loadings
        .iter()
        .map(|(name, l)| l * person.latent(*name))
        .sum();
    let squares: f64 = loadings.values().map(|l| l * l).sum();
    known + (1.0 - squares).max(0.0).sqrt() * normal(rng)
}

impl DrawnMeasure {
    /// Change at this setting from the style that it starts from, whose dial is steeper or flatter by `differs`.
    fn moved(&self, setting: CarSetting<'_>, differs: [f64; 2], rng: &mut Pcg64) -> f64 {
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
    fn shown(&self, z: f64, rng: &mut Pcg64) -> Option<f64> {
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

#[cfg(test)]
mod tests;

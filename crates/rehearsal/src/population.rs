//! What drives look like, measure by measure: the generator of studies that are not driven.

mod drives;

pub use drives::{CarSetting, Drives};

use crate::error::RehearsalError;
use maveric_participants::Trait;
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
    pub low: f64,
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
                    within(key("loadings (sum of squares)"), squares(&m.loadings), 0.0, 1.0)?;
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
                    for (field, value) in
                        [("up.sd", m.up.sd), ("down.sd", m.down.sd), ("across.sd", m.across.sd)]
                    {
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
        let most = if squares > 0.0 { 0.97 / squares.sqrt() } else { 1.0 };
        scaled.line.loadings.values_mut().for_each(|l| *l *= factor.min(most));
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
}

#[cfg(test)]
mod tests;

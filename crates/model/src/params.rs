//! Settings of training and personalising, checked once.

use crate::{
    error::ModelError,
    losses::{LossWeights, MutualInformationLoss},
    model::HeadsKind,
    network::Architecture,
    windows::WindowSettings,
};
use serde::{Deserialize, Serialize};

/// What can be set about training, as in a file; [`TrainParams`] is the checked form.
///
/// # Source
/// Calibration section 3; sizes from method section 3.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrainSettings {
    /// Which heads learn: linear ones, or the paper's networks, which all settings but the size and the share are about.
    pub heads: HeadsKind,
    /// Numbers in an embedding.
    pub embedding_size: usize,
    /// Units of each hidden layer.
    pub hidden_units: usize,
    /// Hidden layers of F, C, V and M.
    pub hidden_layers: usize,
    /// Units of the encoders' hidden layer.
    pub encoder_units: usize,
    /// Numbers in each code of a window.
    pub encoding_size: usize,
    /// Length of a window, in s.
    pub window_s: f64,
    /// Samples of a window a second.
    pub window_rate_hz: f64,
    /// d_x enters as asinh(d_x / this); 0: as it is.
    pub gap_scale_m: f64,
    /// Rows taken a second; rows at which a lane change is being started are all taken besides.
    pub row_rate_hz: f64,
    /// Only this first share of every drive's rows is used.
    pub fit_fraction: f64,
    /// Passes over the rows.
    pub epochs: usize,
    /// Rows of a batch, about.
    pub batch_size: usize,
    /// Adam's rate for the weights at the start; it falls to 0 along a cosine.
    pub learning_rate: f64,
    /// Adam's rate for the embeddings at the start; it falls likewise. 0: every embedding is zero, the networks know
    /// no drivers.
    pub embedding_learning_rate: f64,
    /// Added to a weight's gradient, times the weight; biases and embeddings have none.
    pub weight_decay: f64,
    /// Largest norm of the whole gradient.
    pub gradient_clip: f64,
    /// SD of the offset and of the slope added to every standardised signal of a window.
    pub window_noise: f64,
    /// What each loss counts for.
    pub loss_weights: LossWeights,
    /// How L5 compares M's normal with `w`.
    pub mutual_information_loss: MutualInformationLoss,
    /// Whether embeddings are whitened over the training drives afterwards.
    pub whiten: bool,
    /// This last share of every drive's rows is kept back by a run of its own that measures how good the losses,
    /// C's probabilities and the predictions are on rows not learned from; 0: no such run.
    pub validation_fraction: f64,
    /// That run stops when its validation loss has not improved for this many epochs, and its best epoch counts;
    /// 0: it goes to the last one.
    pub patience: usize,
    /// Whether the model is then trained on all rows, for the epochs that counted; else it is that run's.
    pub refit: bool,
}

impl Default for TrainSettings {
    fn default() -> Self {
        let windows = WindowSettings::default();
        Self {
            heads: HeadsKind::Linear,
            embedding_size: 3,
            hidden_units: 64,
            hidden_layers: 2,
            encoder_units: 64,
            encoding_size: 16,
            window_s: windows.window_s,
            window_rate_hz: windows.window_rate_hz,
            gap_scale_m: windows.gap_scale_m.unwrap_or(0.0),
            row_rate_hz: 1.0,
            fit_fraction: 1.0,
            epochs: 40,
            batch_size: 512,
            learning_rate: 2e-3,
            embedding_learning_rate: 0.05,
            weight_decay: 1e-4,
            gradient_clip: 25.0,
            window_noise: 0.1,
            loss_weights: LossWeights::default(),
            mutual_information_loss: MutualInformationLoss::default(),
            whiten: true,
            validation_fraction: 0.15,
            patience: 0,
            refit: true,
        }
    }
}

impl TrainSettings {
    /// What the paper states, literally, where it states anything: the plain sum of the losses, signals as they
    /// are, no noise, no whitening. Everything else is as by default.
    pub fn paper() -> Self {
        Self {
            heads: HeadsKind::Paper,
            gap_scale_m: 0.0,
            window_noise: 0.0,
            loss_weights: LossWeights::PAPER,
            whiten: false,
            ..Self::default()
        }
    }

    /// The sizes of the networks.
    pub fn architecture(&self) -> Architecture {
        Architecture {
            embedding_size: self.embedding_size,
            hidden_units: self.hidden_units,
            hidden_layers: self.hidden_layers,
            encoder_units: self.encoder_units,
            encoding_size: self.encoding_size,
            window_steps: self.windows().steps(),
        }
    }

    /// Length and rate of a window.
    pub fn windows(&self) -> WindowSettings {
        WindowSettings {
            window_s: self.window_s,
            window_rate_hz: self.window_rate_hz,
            gap_scale_m: (self.gap_scale_m > 0.0).then_some(self.gap_scale_m),
        }
    }
}

fn check(
    name: &'static str,
    found: f64,
    fits: bool,
    expected: &'static str,
) -> Result<(), ModelError> {
    if found.is_finite() && fits {
        Ok(())
    } else {
        Err(ModelError::BadSetting {
            name,
            found,
            expected,
        })
    }
}

fn between(name: &'static str, found: usize, low: usize, high: usize) -> Result<(), ModelError> {
    let expected = match (low, high) {
        (1, 64) => "1 to 64",
        (1, 4096) => "1 to 4096",
        (1, 8) => "1 to 8",
        _ => "1 to 1000000",
    };
    check(name, found as f64, (low..=high).contains(&found), expected)
}

fn above_zero(name: &'static str, found: f64) -> Result<(), ModelError> {
    check(name, found, found > 0.0, "a finite number above 0")
}

fn not_below_zero(name: &'static str, found: f64) -> Result<(), ModelError> {
    check(name, found, found >= 0.0, "a finite number, 0 or above")
}

fn share(name: &'static str, found: f64) -> Result<(), ModelError> {
    check(name, found, found > 0.0 && found <= 1.0, "above 0, up to 1")
}

/// Checked [`TrainSettings`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(try_from = "TrainSettings", into = "TrainSettings")]
pub struct TrainParams(TrainSettings);

impl TrainParams {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`ModelError::BadSetting`] naming the first setting outside its range.
    pub fn new(settings: TrainSettings) -> Result<Self, ModelError> {
        let s = &settings;
        between("embedding_size", s.embedding_size, 1, 64)?;
        between("hidden_units", s.hidden_units, 1, 4096)?;
        between("hidden_layers", s.hidden_layers, 1, 8)?;
        between("encoder_units", s.encoder_units, 1, 4096)?;
        between("encoding_size", s.encoding_size, 1, 4096)?;
        between("epochs", s.epochs, 1, 1_000_000)?;
        between("batch_size", s.batch_size, 1, 1_000_000)?;
        above_zero("window_s", s.window_s)?;
        above_zero("window_rate_hz", s.window_rate_hz)?;
        let steps = s.windows().steps();
        check(
            "window_s",
            s.window_s,
            (1..=1000).contains(&steps),
            "a length of 1 to 1000 samples",
        )?;
        not_below_zero("gap_scale_m", s.gap_scale_m)?;
        above_zero("row_rate_hz", s.row_rate_hz)?;
        share("fit_fraction", s.fit_fraction)?;
        above_zero("learning_rate", s.learning_rate)?;
        not_below_zero("embedding_learning_rate", s.embedding_learning_rate)?;
        not_below_zero("weight_decay", s.weight_decay)?;
        above_zero("gradient_clip", s.gradient_clip)?;
        not_below_zero("window_noise", s.window_noise)?;
        check(
            "validation_fraction",
            s.validation_fraction,
            (0.0..=0.5).contains(&s.validation_fraction),
            "0 to 0.5",
        )?;
        check(
            "patience",
            s.patience as f64,
            s.patience == 0 || s.validation_fraction > 0.0,
            "0 where `validation_fraction` is 0: there is no loss to stop by",
        )?;
        for (name, weight) in s.loss_weights.named() {
            not_below_zero(name, weight)?;
        }
        Ok(Self(settings))
    }

    /// The settings.
    pub fn settings(&self) -> &TrainSettings {
        &self.0
    }
}

impl TryFrom<TrainSettings> for TrainParams {
    type Error = ModelError;
    fn try_from(settings: TrainSettings) -> Result<Self, ModelError> {
        Self::new(settings)
    }
}

impl From<TrainParams> for TrainSettings {
    fn from(params: TrainParams) -> Self {
        params.0
    }
}

/// What can be set about personalising, as in a file; [`PersonalizeParams`] is the checked form.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PersonalizeSettings {
    /// Whether an ADB score, where there is one, is fitted too (L4).
    pub use_adb: bool,
    /// Only this first share of the drive's rows is used.
    pub fit_fraction: f64,
}

impl Default for PersonalizeSettings {
    fn default() -> Self {
        Self {
            use_adb: true,
            fit_fraction: 1.0,
        }
    }
}

/// Checked [`PersonalizeSettings`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(try_from = "PersonalizeSettings", into = "PersonalizeSettings")]
pub struct PersonalizeParams(PersonalizeSettings);

impl PersonalizeParams {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`ModelError::BadSetting`] naming the first setting outside its range.
    pub fn new(settings: PersonalizeSettings) -> Result<Self, ModelError> {
        share("fit_fraction", settings.fit_fraction)?;
        Ok(Self(settings))
    }

    /// The settings.
    pub fn settings(&self) -> &PersonalizeSettings {
        &self.0
    }
}

impl TryFrom<PersonalizeSettings> for PersonalizeParams {
    type Error = ModelError;
    fn try_from(settings: PersonalizeSettings) -> Result<Self, ModelError> {
        Self::new(settings)
    }
}

impl From<PersonalizeParams> for PersonalizeSettings {
    fn from(params: PersonalizeParams) -> Self {
        params.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_setting_is_an_error() {
        assert!(serde_json::from_str::<TrainParams>(r#"{"epoch": 3}"#).is_err());
        let params: TrainParams = serde_json::from_str(r#"{"epochs": 3}"#).unwrap();
        assert_eq!(params.settings().epochs, 3);
        assert_eq!(params.settings().batch_size, 512);
    }

    #[test]
    fn a_setting_outside_its_range_is_named() {
        let error = serde_json::from_str::<TrainParams>(r#"{"learning_rate": 0}"#).unwrap_err();
        assert!(
            error.to_string().contains("`learning_rate` is 0"),
            "{error}"
        );
        assert!(serde_json::from_str::<TrainParams>(r#"{"window_s": 1e9}"#).is_err());
        assert!(serde_json::from_str::<PersonalizeParams>(r#"{"fit_fraction": 1.5}"#).is_err());
    }
}

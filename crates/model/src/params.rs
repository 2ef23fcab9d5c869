//! Settings of training.

use crate::{
    error::ModelError,
    heads_kind::HeadsKind,
    losses::{LossWeights, MutualInformationLoss},
    network::Architecture,
    posted::FreeSpeed,
    rows::RowSettings,
    windows::WindowSettings,
};
use serde::{Deserialize, Serialize};

/// What can be set about training, as in a file; [`crate::train()`] checks it.
///
/// # Source
/// Calibration section 3; sizes from method section 3.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrainSettings {
    /// Which heads learn: linear ones, or the paper's networks, which all settings but the size and the share are about.
    pub heads: HeadsKind,
    /// How linear heads read a free speed.
    pub free_speed: FreeSpeed,
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
    /// This share of the people is kept back by a run of its own, and the epoch that is best for them counts: the networks are then
    /// trained on everybody for as many. 0, or fewer than three people: no such run.
    pub validation_fraction: f64,
    /// That run stops when its loss on people kept back has not improved for this many epochs; 0: it goes to the last one.
    pub patience: usize,
}

impl Default for TrainSettings {
    fn default() -> Self {
        let windows = WindowSettings::default();
        Self {
            heads: HeadsKind::Linear,
            free_speed: FreeSpeed::Absolute,
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
            validation_fraction: 0.15,
            patience: 0,
        }
    }
}

impl TrainSettings {
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

    pub(crate) fn row_settings(&self) -> RowSettings {
        RowSettings { row_rate_hz: self.row_rate_hz, windows: self.windows() }
    }

    /// Length and rate of a window.
    pub fn windows(&self) -> WindowSettings {
        WindowSettings {
            window_s: self.window_s,
            window_rate_hz: self.window_rate_hz,
            gap_scale_m: (self.gap_scale_m > 0.0).then_some(self.gap_scale_m),
        }
    }

    /// Whether every setting is within its range.
    ///
    /// # Errors
    /// [`ModelError::BadSetting`] naming the first that is not.
    pub fn check(&self) -> Result<(), ModelError> {
        let s = self;
        for (name, value, most, expected) in [
            ("embedding_size", s.embedding_size, 64, "1 to 64"),
            ("hidden_units", s.hidden_units, 4096, "1 to 4096"),
            ("hidden_layers", s.hidden_layers, 8, "1 to 8"),
            ("encoder_units", s.encoder_units, 4096, "1 to 4096"),
            ("encoding_size", s.encoding_size, 4096, "1 to 4096"),
            ("epochs", s.epochs, 1_000_000, "1 to 1000000"),
            ("batch_size", s.batch_size, 1_000_000, "1 to 1000000"),
            ("window_s", s.windows().steps(), 1000, "a length of 1 to 1000 samples"),
        ] {
            check(name, value as f64, (1..=most).contains(&value), expected)?;
        }
        for (name, value) in [
            ("window_s", s.window_s),
            ("window_rate_hz", s.window_rate_hz),
            ("row_rate_hz", s.row_rate_hz),
            ("learning_rate", s.learning_rate),
            ("gradient_clip", s.gradient_clip),
        ] {
            check(name, value, value > 0.0, "a finite number above 0")?;
        }
        let others = [
            ("gap_scale_m", s.gap_scale_m),
            ("embedding_learning_rate", s.embedding_learning_rate),
            ("weight_decay", s.weight_decay),
            ("window_noise", s.window_noise),
        ];
        for (name, value) in others.into_iter().chain(s.loss_weights.named()) {
            check(name, value, value >= 0.0, "a finite number, 0 or above")?;
        }
        share("fit_fraction", s.fit_fraction)?;
        let kept_back = s.validation_fraction;
        check("validation_fraction", kept_back, (0.0..=0.5).contains(&kept_back), "0 to 0.5")?;
        check(
            "patience",
            s.patience as f64,
            s.patience == 0 || kept_back > 0.0,
            "0 where `validation_fraction` is 0: there is no loss to stop by",
        )
    }
}

/// Whether a setting is a number that fits.
pub(crate) fn check(
    name: &'static str,
    value: f64,
    fits: bool,
    expected: &'static str,
) -> Result<(), ModelError> {
    if value.is_finite() && fits {
        Ok(())
    } else {
        Err(ModelError::BadSetting { name, found: value, expected })
    }
}

/// Whether a share leaves something on both sides.
pub(crate) fn part(name: &'static str, value: f64) -> Result<(), ModelError> {
    check(name, value, value > 0.0 && value < 1.0, "above 0, below 1")
}

/// Whether a share of a drive is one.
pub(crate) fn share(name: &'static str, value: f64) -> Result<(), ModelError> {
    check(name, value, value > 0.0 && value <= 1.0, "above 0, up to 1")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_setting_is_an_error() {
        assert!(serde_json::from_str::<TrainSettings>(r#"{"epoch": 3}"#).is_err());
        let settings: TrainSettings = serde_json::from_str(r#"{"epochs": 3}"#).unwrap();
        assert_eq!((settings.epochs, settings.batch_size), (3, 512));
        assert_eq!(settings.check(), Ok(()));
    }

    #[test]
    fn a_setting_outside_its_range_is_named() {
        let refused = |text: &str| {
            let settings: TrainSettings = serde_json::from_str(text).unwrap();
            settings.check().unwrap_err().to_string()
        };
        assert!(refused(r#"{"learning_rate": 0}"#).contains("`learning_rate` is 0"));
        assert!(refused(r#"{"window_s": 1e9}"#).contains("`window_s`"));
        assert!(refused(r#"{"fit_fraction": 1.5}"#).contains("`fit_fraction` is 1.5"));
        assert!(
            refused(r#"{"patience": 3, "validation_fraction": 0}"#).contains("`patience` is 3")
        );
    }
}

//! What was posted where people were learned from, and how a free speed is read beside it.

use crate::error::ModelError;
use maveric_domain::Drive;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// A limit this far outside those learned from, in m/s, is another one: limits are rounded to whole mph or 10 km/h.
const ROUNDED_MPS: f64 = 0.5;

/// How a free speed is read.
///
/// Neither reading is comparable by itself: people drive faster where more is allowed, and not by the same share.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FreeSpeed {
    /// In m/s, whatever is posted.
    #[default]
    Absolute,
    /// Relative to what is posted, as the speed in m/s that it is at the mean limit learned from.
    Posted,
}

impl FromStr for FreeSpeed {
    type Err = ModelError;

    fn from_str(text: &str) -> Result<Self, ModelError> {
        match text {
            "absolute" => Ok(Self::Absolute),
            "posted" => Ok(Self::Posted),
            _ => Err(ModelError::UnknownFreeSpeed { found: text.to_owned() }),
        }
    }
}

/// The limits of the drives that a model learned from, in m/s, and how their free speeds were read.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Posted {
    /// How free speeds are read.
    pub free_speed: FreeSpeed,
    /// Lowest limit.
    pub lowest_mps: f64,
    /// Highest limit.
    pub highest_mps: f64,
    /// Mean over the drives.
    pub mean_mps: f64,
}

impl Posted {
    /// The limits of these drives; `None` without a drive.
    pub(crate) fn learn<'a>(
        drives: impl Iterator<Item = &'a Drive>,
        free_speed: FreeSpeed,
    ) -> Option<Self> {
        let limits: Vec<f64> = drives.map(|d| d.road().posted_speed_mps).collect();
        let lowest_mps = limits.iter().copied().reduce(f64::min)?;
        let highest_mps = limits.iter().copied().reduce(f64::max)?;
        // Of one limit exactly that: a reading relative to it is then the speed itself.
        let mean_mps = if lowest_mps < highest_mps {
            limits.iter().sum::<f64>() / limits.len() as f64
        } else {
            lowest_mps
        };
        Some(Self { free_speed, lowest_mps, highest_mps, mean_mps })
    }

    /// What a free speed on a road with this limit is multiplied with to be read.
    pub(crate) fn factor(&self, posted_mps: f64) -> f64 {
        match self.free_speed {
            FreeSpeed::Absolute => 1.0,
            FreeSpeed::Posted => self.mean_mps / posted_mps,
        }
    }

    /// Whether a limit lies outside those learned from.
    pub fn unseen(&self, posted_mps: f64) -> bool {
        posted_mps < self.lowest_mps - ROUNDED_MPS || posted_mps > self.highest_mps + ROUNDED_MPS
    }

    /// Checks what was read from a file.
    pub(crate) fn check(&self) -> Result<(), ModelError> {
        let above = |x: f64| x.is_finite() && x > 0.0;
        if above(self.lowest_mps)
            && above(self.highest_mps)
            && (self.lowest_mps..=self.highest_mps).contains(&self.mean_mps)
        {
            return Ok(());
        }
        Err(ModelError::bad_file("the limits learned from are no speeds"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        heads_kind::HeadsKind,
        model::Habits,
        model_file,
        params::TrainSettings,
        personalize::personalize,
        test_drives::{Habits as Drives, drive_apart_on, drivers_apart},
        train::tests::trained,
    };
    use maveric_domain::Road;

    #[test]
    fn a_free_speed_is_read_absolutely_or_beside_what_is_posted() {
        let drives = drivers_apart(10, 300.0);
        let learn = |free_speed| {
            let settings =
                TrainSettings { heads: HeadsKind::Linear, free_speed, ..TrainSettings::default() };
            trained(&drives, &settings)
        };
        let [absolute, relative] = [FreeSpeed::Absolute, FreeSpeed::Posted].map(learn);
        let limit = Road::PAPER.posted_speed_mps;
        let driver = Drives { speed_mps: 29.0, time_gap_s: 1.5, passes: true };
        let at = |posted_speed_mps: f64| {
            let road = Road { posted_speed_mps, ..Road::PAPER };
            drive_apart_on(road, "new", &driver, 300.0)
        };
        let (here, other) = (at(limit), at(1.1 * limit));
        let place = |model: &_, drive: &_| personalize(model, drive, None).unwrap();
        // On the road learned from both say the same.
        let [here, too] = [&absolute, &relative].map(|model| place(model, &here));
        assert_eq!(here, too);
        assert!(!here.posted_unseen);
        // Where more is posted, the same speed is the same or a slower one.
        let [same, slower] = [&absolute, &relative].map(|model| place(model, &other));
        assert!(same.posted_unseen && slower.posted_unseen);
        assert_eq!(same.embedding, here.embedding);
        let free = |model: &_, at: &crate::Personalized, posted_mps: f64| {
            let habits = Habits::new(model, &at.embedding).unwrap();
            habits.free_speed_mps(Some(posted_mps)).unwrap()
        };
        assert!(free(&relative, &slower, limit) < free(&relative, &here, limit) - 1.0);
        // And it is driven as fast as it was.
        let again = free(&relative, &slower, 1.1 * limit);
        let was = free(&absolute, &same, 1.1 * limit);
        assert!((again / was - 1.0).abs() < 0.1, "{again} {was}");
        let bytes = model_file::to_bytes(&relative).unwrap();
        assert_eq!(model_file::from_bytes(&bytes).unwrap(), relative);
        assert!("mph".parse::<FreeSpeed>().is_err());
    }

    #[test]
    fn a_limit_is_unseen_outside_those_learned_from_and_not_for_its_rounding() {
        let posted = Posted {
            free_speed: FreeSpeed::Absolute,
            lowest_mps: 24.5872,
            highest_mps: 27.78,
            mean_mps: 26.0,
        };
        for (limit, unseen) in
            [(24.44, false), (26.0, false), (28.0, false), (33.33, true), (13.9, true)]
        {
            assert_eq!(posted.unseen(limit), unseen, "{limit}");
        }
        assert!(posted.check().is_ok());
        let bad = Posted { lowest_mps: 0.0, ..posted };
        assert!(bad.check().is_err());
    }
}

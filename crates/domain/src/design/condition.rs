//! Conditions, the baseline and roles.

use crate::condition::ConditionId;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, fmt, path::PathBuf, str::FromStr};

/// Something that people sit through, or drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// In file names, orders and answers.
    pub id: ConditionId,
    /// On the page.
    pub label: String,
    /// Place in the order of the page, from 0.
    pub place: usize,
    /// Colour, where one was chosen.
    pub color: Option<Color>,
    /// What the car does; none where it was yours and only its logs are read.
    pub car: Option<Car>,
    /// Whether it was driven elsewhere: logs are read, nothing is simulated.
    pub recorded: bool,
    /// Factor → level, where conditions cross factors.
    pub levels: BTreeMap<String, String>,
    /// Outcome → which way it is expected to turn, against the baseline.
    pub expected: BTreeMap<String, Sign>,
}

impl Condition {
    /// Whether the program drives it.
    pub fn simulated(&self) -> bool {
        self.car.as_ref().is_some_and(|car| *car != Car::Free) && !self.recorded
    }

    /// Its place on the dial, in points of the style; none off the dial.
    pub fn dial(&self) -> Option<f64> {
        match self.car {
            Some(Car::Dial(points)) => Some(points),
            _ => None,
        }
    }

    /// Whether it is in the person's own style: at 0 on the dial.
    pub fn in_own_style(&self) -> bool {
        self.dial() == Some(0.0)
    }

    /// Which way it lies from the person's own style on the dial; none for the own style and off the dial.
    pub fn side(&self) -> Option<Sign> {
        self.dial().and_then(Sign::of)
    }
}

/// What the car does in a condition.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Car {
    /// The person's style, shifted by so many points; 0 is the person's own.
    Dial(f64),
    /// The person's style, moved at right angles to the dial.
    Across,
    /// The average driver.
    Mean,
    /// A style from a file of embeddings.
    Embedding(PathBuf),
    /// Somebody else's style, moved along the dial to the person's own score.
    Matched(Matched),
    /// The person's own drive by hand once more, shown as automation.
    Replay,
    /// The person turns the dial while riding.
    Free,
}

/// Whose style is lent to the person.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matched {
    /// Who may lend theirs.
    pub from: Donors,
    /// How far donor and rider shall lie apart across the dial: least and most, in standard deviations of the people learned from.
    pub apart_sd: [f64; 2],
}

/// Who may lend their style.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Donors {
    /// The others who are tested, once ten of them have driven; until then those whom the model learned from.
    #[default]
    Tested,
    /// Those whom the model learned from.
    Learned,
}

impl Donors {
    /// So many of the tested must have driven before they lend their styles.
    pub const FROM: usize = 10;
}

/// Which way something goes.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Sign {
    /// Up.
    #[serde(rename = "+")]
    Plus,
    /// Down.
    #[serde(rename = "-")]
    Minus,
}

impl Sign {
    /// The sign of a number; none for 0 and for what is no number.
    pub fn of(number: f64) -> Option<Self> {
        if number > 0.0 {
            Some(Self::Plus)
        } else if number < 0.0 {
            Some(Self::Minus)
        } else {
            None
        }
    }

    /// 1 or -1.
    pub fn factor(self) -> f64 {
        match self {
            Self::Plus => 1.0,
            Self::Minus => -1.0,
        }
    }
}

impl std::ops::Mul for Sign {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self == other { Self::Plus } else { Self::Minus }
    }
}

/// A colour as `#rrggbb`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Color(pub [u8; 3]);

impl FromStr for Color {
    type Err = ();
    fn from_str(text: &str) -> Result<Self, ()> {
        let digits = text.strip_prefix('#').filter(|d| d.len() == 6).ok_or(())?;
        if !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            return Err(());
        }
        let mut bytes = [0; 3];
        for (byte, at) in bytes.iter_mut().zip([0, 2, 4]) {
            *byte = u8::from_str_radix(&digits[at..at + 2], 16).map_err(|_| ())?;
        }
        Ok(Self(bytes))
    }
}

impl fmt::Display for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

/// Who drives where the car does not.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum By {
    /// The person, by hand.
    #[default]
    Hand,
    /// A car of the laboratory's.
    Car,
}

/// The drive that differences are taken from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Baseline {
    /// In file names; may be a condition's.
    pub id: ConditionId,
    /// On the page.
    pub label: String,
    /// Who drove.
    pub by: By,
}

/// Drives by hand that were asked to be different: learned from, never tested.
#[derive(Debug, Clone, PartialEq)]
pub struct Role {
    /// In file names; may be a condition's.
    pub id: ConditionId,
    /// On the page.
    pub label: String,
    /// Who drove.
    pub by: By,
    /// The score that everybody's drive in it has, in points of the style, where it was the instruction that gave it; none where it
    /// was asked.
    pub score: Option<f64>,
    /// The role that it is driven once more.
    pub repeats: Option<ConditionId>,
}

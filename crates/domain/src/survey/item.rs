//! What an item asks for: a point of a scale, one of several answers, a number, or words.

use serde::{Deserialize, Serialize};

/// How an item is answered.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Boxes in a row, from the lowest answer to the highest.
    #[default]
    Likert,
    /// Boxes between two words; the box beside the left word is the lowest answer.
    Bipolar,
    /// A line to be touched; without an answer until it is.
    Slider,
    /// A level in words a line, from the lowest answer.
    Ladder,
    /// One of several answers that have no order.
    Choice,
    /// A whole number.
    Number,
    /// Words of one's own; never scored.
    Text,
}

impl Kind {
    /// Its name in a scale's file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Likert => "likert",
            Self::Bipolar => "bipolar",
            Self::Slider => "slider",
            Self::Ladder => "ladder",
            Self::Choice => "choice",
            Self::Number => "number",
            Self::Text => "text",
        }
    }

    /// Whether the answers are points of one scale: they can be reversed, and items of it have a reliability.
    pub fn rates(self) -> bool {
        matches!(self, Self::Likert | Self::Bipolar | Self::Slider | Self::Ladder)
    }

    /// Whether each answer has words of its own, its levels.
    pub fn has_levels(self) -> bool {
        matches!(self, Self::Ladder | Self::Choice)
    }
}

/// One item of a questionnaire, but for its words.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Item {
    /// How it is answered.
    pub kind: Kind,
    /// Lowest answer.
    pub min: i32,
    /// Highest answer.
    pub max: i32,
    /// From one answer to the next.
    pub step: i32,
    /// Whether it is scored as `min + max - answer`.
    #[serde(default)]
    pub reversed: bool,
    /// The answer of whoever reads it, where the item asks for that alone.
    #[serde(default)]
    pub expected: Option<i32>,
    /// Whether nobody is asked again for an answer.
    #[serde(default)]
    pub optional: bool,
}

impl Item {
    /// Whether this is a possible answer.
    pub fn takes(&self, answer: i32) -> bool {
        self.kind != Kind::Text
            && (self.min..=self.max).contains(&answer)
            && (answer - self.min) % self.step == 0
    }

    /// How many answers there are.
    pub fn points(&self) -> usize {
        ((self.max - self.min) / self.step) as usize + 1
    }

    /// Every answer, from the lowest.
    pub fn answers(&self) -> impl Iterator<Item = i32> + use<> {
        (self.min..=self.max).step_by(self.step as usize)
    }

    /// The possible answers in words.
    pub fn range(&self) -> String {
        let (min, max) = (self.min, self.max);
        match self.step {
            _ if self.kind == Kind::Text => "words".to_owned(),
            1 => format!("{min} to {max}"),
            step => format!("{min} to {max} by {step}"),
        }
    }

    /// Whether an answer shows that the item was not read.
    pub fn is_missed(&self, answer: i32) -> bool {
        self.expected.is_some_and(|expected| expected != answer)
    }
}

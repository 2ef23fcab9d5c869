//! The answer to one question: what a page opens with.

use crate::error::ReportError;
use crate::figures::intervals::{Intervals, intervals};
use crate::figures::{Context, Figure};

/// A question, its answer, and what makes it one. Labels and numbers: whoever fills it in has decided.
#[derive(Debug, Clone, PartialEq)]
pub struct Card {
    /// Stem of its anchor and picture: lower-case letters, digits, hyphens.
    pub name: String,
    /// The question. Plain text.
    pub question: String,
    /// A sentence that needs no statistics, with marks.
    pub answer: String,
    /// How the answer stands.
    pub tone: Tone,
    /// The same in words: `shown`, `not shown`. Plain text.
    pub verdict: String,
    /// What makes it so, fixed before the result. With marks.
    pub rule: String,
    /// The number with its floor and its ceiling.
    pub number: Option<CardNumber>,
    /// What is estimated, with intervals.
    pub plot: Option<Intervals>,
    /// Why one might doubt the answer. With marks.
    pub doubt: String,
    /// Id of what on the page answers that doubt: `table-accuracy`.
    pub see: Option<String>,
    /// The tests, as APA writes them. With marks.
    pub tests: Vec<String>,
}

/// How an answer stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// As asked.
    Good,
    /// Undecided.
    Open,
    /// The opposite.
    Bad,
    /// Not asked, or too few to say.
    Silent,
}

impl Tone {
    /// Class of its badge.
    pub(crate) fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Open => "half",
            Self::Bad => "bad",
            Self::Silent => "silent",
        }
    }
}

/// A number between what costs nothing and what cannot be beaten. With marks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CardNumber {
    /// The number and what it is: `mean accuracy 93.0%`.
    pub value: String,
    /// What costs nothing reaches: `guessing the average driver: 81.2%`.
    pub floor: String,
    /// What cannot be beaten: `a second drive of the same person: 95.1%`.
    pub ceiling: String,
}

impl Card {
    /// The interval plot as a figure of its own; `None` where there is nothing to draw.
    ///
    /// # Errors
    /// What [`intervals`] refuses.
    pub fn figure(&self, context: &Context) -> Result<Option<Figure>, ReportError> {
        let Some(plot) = self.plot.as_ref().filter(|p| p.has_values()) else {
            return Ok(None);
        };
        let name = format!("card-{}", self.name);
        intervals(&name, &self.question, plot, context).map(Some)
    }
}

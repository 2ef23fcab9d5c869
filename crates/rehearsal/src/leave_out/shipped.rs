//! What a model that was learned elsewhere says of people, and whether it says that it has met nobody like them.

use super::{Uncounted, share};
use crate::error::RehearsalError;
use maveric_domain::ParticipantId;
use maveric_stats::Proportion;
use serde::Serialize;

/// One person's two drives, as the model reads them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShippedPerson {
    pub participant: ParticipantId,
    /// On its line, the drive in the higher role less the ordinary one; none where one of them shows nothing.
    pub line: Option<f64>,
    /// Its standard error, the drives taken as independent; none where one of them leaves none.
    pub line_se: Option<f64>,
    /// Whether the ordinary drive is beyond what the model has met; none where it cannot say.
    pub ordinary_beyond: Option<bool>,
    /// Whether the other one is.
    pub higher_beyond: Option<bool>,
}

impl ShippedPerson {
    /// Whether one of the two drives is beyond; none where neither is known to be and one is not known.
    fn beyond(&self) -> Option<bool> {
        match (self.ordinary_beyond, self.higher_beyond) {
            (Some(true), _) | (_, Some(true)) => Some(true),
            (Some(false), Some(false)) => Some(false),
            _ => None,
        }
    }

    /// Whether the order is wrong, neither drive is known to be beyond, and the standard error does not cover it.
    fn wrong_and_sure(&self) -> bool {
        let wrong = self.line.is_some_and(|line| line <= 0.0) && self.beyond() != Some(true);
        super::wrong_and_sure(wrong, self.line, self.line_se)
    }
}

/// How often it is right, and how often it says that it cannot know.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Shipped {
    /// People with both drives on the line.
    pub n: usize,
    /// The higher drive is above, and neither is beyond.
    pub right_within: usize,
    /// The higher drive is above, and one of them is beyond.
    pub right_beyond: usize,
    /// The higher drive is not above, and neither is beyond: wrong, and nothing was said.
    pub wrong_within: usize,
    /// The higher drive is not above, and one of them is beyond.
    pub wrong_beyond: usize,
    /// People of whom the model cannot say whether they are beyond.
    pub unknown: usize,
    /// Ordinary drives of which it can say.
    pub ordinary: usize,
    /// Those among them that are beyond.
    pub ordinary_beyond: usize,
    /// Their share, with Clopper and Pearson's interval; none without such drives.
    pub share: Option<Proportion>,
    /// Whose order is wrong though nothing was said of it: neither drive is known to be beyond, and the interval of two standard errors
    /// does not hold 0.
    pub wrong_and_sure: Vec<ParticipantId>,
    /// People whom the model learned from.
    pub people_learned_from: usize,
    pub people: Vec<ShippedPerson>,
    pub uncounted: Vec<Uncounted>,
}

/// Counts people by whether they are read right and whether they are beyond, by a model that learned from so many people.
///
/// # Errors
/// [`RehearsalError::Stats`] where an interval has no ends.
pub fn shipped(
    people: Vec<ShippedPerson>,
    people_learned_from: usize,
    uncounted: Vec<Uncounted>,
) -> Result<Shipped, RehearsalError> {
    let count = |right: bool, beyond: Option<bool>| {
        let counts = |p: &&ShippedPerson| {
            p.line.is_some_and(|line| (line > 0.0) == right) && p.beyond() == beyond
        };
        people.iter().filter(counts).count()
    };
    let known: Vec<bool> = people.iter().filter_map(|p| p.ordinary_beyond).collect();
    let ordinary_beyond = known.iter().filter(|beyond| **beyond).count();
    Ok(Shipped {
        n: people.iter().filter(|p| p.line.is_some()).count(),
        right_within: count(true, Some(false)),
        right_beyond: count(true, Some(true)),
        wrong_within: count(false, Some(false)),
        wrong_beyond: count(false, Some(true)),
        unknown: count(true, None) + count(false, None),
        ordinary: known.len(),
        ordinary_beyond,
        share: share(ordinary_beyond, known.len())?,
        wrong_and_sure: people
            .iter()
            .filter(|p| p.wrong_and_sure())
            .map(|p| p.participant.clone())
            .collect(),
        people_learned_from,
        people,
        uncounted,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_are_counted_by_whether_they_are_read_right_and_whether_the_model_warns() {
        let person =
            |line: Option<f64>, ordinary: Option<bool>, higher: Option<bool>| ShippedPerson {
                participant: ParticipantId::new("P").unwrap(),
                line,
                line_se: None,
                ordinary_beyond: ordinary,
                higher_beyond: higher,
            };
        let (yes, no) = (Some(true), Some(false));
        let people = vec![
            person(Some(0.5), no, no),
            person(Some(0.5), no, yes),
            person(Some(-0.5), yes, None),
            person(Some(0.0), no, no),
            person(Some(0.2), no, None),
            person(None, yes, yes),
        ];
        let found = shipped(people, 30, Vec::new()).unwrap();
        assert_eq!((found.n, found.right_within, found.right_beyond, found.unknown), (5, 1, 1, 1));
        assert_eq!((found.wrong_within, found.wrong_beyond), (1, 1));
        assert_eq!((found.ordinary, found.ordinary_beyond), (6, 2));
        assert!(found.wrong_and_sure.is_empty(), "no standard error is known");
        let none = shipped(Vec::new(), 0, Vec::new()).unwrap();
        assert_eq!((none.n, none.share), (0, None));
    }

    #[test]
    fn a_wrong_order_is_named_where_neither_support_nor_its_standard_error_covers_it() {
        let person = |name: &str, line: f64, line_se: f64, beyond: Option<bool>| ShippedPerson {
            participant: ParticipantId::new(name).unwrap(),
            line: Some(line),
            line_se: Some(line_se),
            ordinary_beyond: beyond,
            higher_beyond: beyond,
        };
        let people = vec![
            person("right", 0.9, 0.1, Some(false)),
            person("covered", -0.9, 0.5, Some(false)),
            person("sure", -0.9, 0.4, Some(false)),
            person("told", -0.9, 0.1, Some(true)),
            person("unknown", -0.9, 0.1, None),
        ];
        let found = shipped(people, 0, Vec::new()).unwrap();
        let named: Vec<&str> = found.wrong_and_sure.iter().map(ParticipantId::as_str).collect();
        assert_eq!(named, ["sure", "unknown"]);
    }
}

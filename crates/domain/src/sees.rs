//! What a rig sees: a habit is read only where the log could have shown it.

use crate::error::DomainError;
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// What the sensors of a drive see; what they do not see is not known, rather than not there.
///
/// # Example
/// ```
/// use maveric_domain::Sees;
/// let camera: Sees = "ahead lanes".parse()?;
/// assert!(camera.ahead && camera.lanes && !camera.beside && !camera.behind);
/// assert_eq!(camera.to_string(), "ahead lanes");
/// # Ok::<(), maveric_domain::DomainError>(())
/// ```
#[expect(clippy::struct_excessive_bools, reason = "each is seen or not, whatever the others are")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sees {
    /// Who is ahead in ego's lane.
    pub ahead: bool,
    /// Who is beside ego, or ahead in the lanes beside its own.
    pub beside: bool,
    /// Who is behind ego, in any lane.
    pub behind: bool,
    /// In which lane ego is.
    pub lanes: bool,
}

impl Sees {
    /// Everything, as a simulation does and lists of all vehicles around.
    pub const ALL: Self = Self { ahead: true, beside: true, behind: true, lanes: true };
    /// Nothing but ego itself.
    pub const NOTHING: Self = Self { ahead: false, beside: false, behind: false, lanes: false };

    /// Who is ahead, and nothing else: a pair of cars.
    pub const LEAD: Self = Self { ahead: true, ..Self::NOTHING };

    /// Each thing that may be seen with its word, in the order of the words.
    fn words(self) -> [(&'static str, bool); 4] {
        [
            ("ahead", self.ahead),
            ("beside", self.beside),
            ("behind", self.behind),
            ("lanes", self.lanes),
        ]
    }

    /// Whether a vehicle that ego passes stays in sight: it is ahead, then beside, then behind in another lane.
    pub fn passing(self) -> bool {
        self == Self::ALL
    }
}

impl Default for Sees {
    fn default() -> Self {
        Self::ALL
    }
}

/// The words of what is seen, with blanks between; `nothing` for nothing.
impl fmt::Display for Sees {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seen = self.words().into_iter().filter(|(_, seen)| *seen);
        let words: Vec<&str> = seen.map(|(word, _)| word).collect();
        if words.is_empty() { f.write_str("nothing") } else { f.write_str(&words.join(" ")) }
    }
}

impl FromStr for Sees {
    type Err = DomainError;

    fn from_str(text: &str) -> Result<Self, DomainError> {
        let unknown = |found: &str| DomainError::UnknownWord {
            kind: "thing that a rig sees",
            found: found.to_owned(),
            expected: "ahead, beside, behind, lanes, or nothing alone",
        };
        if text.trim().is_empty() {
            return Err(unknown(""));
        }
        let mut sees = Self::NOTHING;
        for word in text.split_whitespace().filter(|_| text != "nothing") {
            let seen = match word {
                "ahead" => &mut sees.ahead,
                "beside" => &mut sees.beside,
                "behind" => &mut sees.behind,
                "lanes" => &mut sees.lanes,
                _ => return Err(unknown(word)),
            };
            *seen = true;
        }
        Ok(sees)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_as_they_are_written_and_no_others() {
        for bits in 0..16 {
            let sees = Sees {
                ahead: bits & 1 > 0,
                beside: bits & 2 > 0,
                behind: bits & 4 > 0,
                lanes: bits & 8 > 0,
            };
            assert_eq!(sees.to_string().parse::<Sees>().unwrap(), sees);
        }
        for odd in ["", " ", "above", "ahead nothing"] {
            assert!(odd.parse::<Sees>().is_err(), "{odd}");
        }
    }
}

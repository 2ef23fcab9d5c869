//! Who and which.

use crate::error::DomainError;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Whether a text of up to `longest` letters, digits, `_` or `-` can be a file's name everywhere: Windows keeps some for devices, and
/// programs take what begins with `-` for an option.
pub(crate) fn is_file_name(text: &str, longest: usize) -> bool {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b == b'-';
    let lower = text.to_ascii_lowercase();
    let device = match lower.as_bytes() {
        [b'c', b'o', b'm', number] | [b'l', b'p', b't', number] => number.is_ascii_digit(),
        _ => ["con", "prn", "aux", "nul"].contains(&lower.as_str()),
    };
    let is_option = text.starts_with('-');
    (1..=longest).contains(&text.len()) && text.bytes().all(plain) && !is_option && !device
}

fn checked(kind: &'static str, text: String) -> Result<String, DomainError> {
    if is_file_name(&text, 64) { Ok(text) } else { Err(DomainError::BadId { kind, found: text }) }
}

macro_rules! id {
    ($(#[$doc:meta])* $name:ident, $kind:literal) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(try_from = "String", into = "String")]
        pub struct $name(String);

        impl $name {
            /// Takes 1 to 64 letters, digits, `_` or `-`, not `-` first, and no name of a device of Windows: what is safe in a file name everywhere.
            ///
            /// # Errors
            /// [`DomainError::BadId`] for anything else.
            pub fn new(text: impl Into<String>) -> Result<Self, DomainError> {
                checked($kind, text.into()).map(Self)
            }

            /// The identifier as text.
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }
        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.0)
            }
        }
        impl TryFrom<String> for $name {
            type Error = DomainError;
            fn try_from(text: String) -> Result<Self, DomainError> {
                Self::new(text)
            }
        }
        impl From<$name> for String {
            fn from(id: $name) -> String {
                id.0
            }
        }
    };
}

id!(
    /// A participant of a study, such as `S2P07`.
    ParticipantId, "participant id"
);
id!(
    /// A drive, such as `S2P07-mimic`: also the stem of its files.
    DriveId, "drive id"
);

/// A vehicle other than ego within one recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct VehicleId(pub u32);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_cannot_leave_its_folder() {
        assert!(ParticipantId::new("../etc").is_err());
        assert!(DriveId::new("").is_err());
        assert!(ParticipantId::new("-x").is_err() && ParticipantId::new("x-").is_ok());
        for device in ["con", "NUL", "Com1", "lpt9"] {
            assert!(DriveId::new(device).is_err(), "{device}");
            assert!(crate::ConditionId::new(device).is_err(), "{device}");
        }
        assert!(DriveId::new("con1").is_ok() && DriveId::new("com10").is_ok());
        assert_eq!(DriveId::new("S1P01-own").unwrap().as_str(), "S1P01-own");
    }
}

//! Links that cannot be guessed.

use crate::error::SeatError;
use sha2::{Digest as _, Sha256};

/// 128 random bits, as 32 hexadecimal digits.
///
/// # Errors
/// [`SeatError::Random`] if the system has none.
pub(crate) fn new() -> Result<String, SeatError> {
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes).map_err(|e| SeatError::Random { problem: e.to_string() })?;
    Ok(hex(&bytes))
}

/// Whether a text could be a token: nothing else is looked up.
pub(crate) fn possible(text: &str) -> bool {
    text.len() == 32 && text.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
}

/// SHA-256, as hexadecimal digits.
pub(crate) fn sha256(text: &str) -> String {
    digest(text.as_bytes())
}

/// SHA-256 of bytes, as hexadecimal digits.
pub(crate) fn digest(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Whether two secrets are the same; how long it takes says nothing about where they differ.
pub(crate) fn same_secret(given: &str, expected: &str) -> bool {
    sha256(given) == sha256(expected)
}

fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_are_long_each_its_own_and_nothing_else_passes_for_one() {
        let (one, other) = (new().unwrap(), new().unwrap());
        assert!(possible(&one) && one != other);
        for text in ["", "../../etc/passwd", &one[1..], &one.to_uppercase(), &format!("{one}0")] {
            assert!(!possible(text) || text == one, "{text}");
        }
        assert!(same_secret("x", "x") && !same_secret("x", "y"));
    }
}

//! The world of somebody whom no server gives one.

use maveric_domain::stream_seed;

/// Root of every random choice of what somebody with this token drives at `what` (`practice`, or a condition), where the page has no
/// server: whoever takes in what was driven finds the same number.
pub fn world(token: &str, what: &str) -> u64 {
    stream_seed(0, &[token, what, "world"])
}

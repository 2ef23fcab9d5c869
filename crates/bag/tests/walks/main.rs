//! Recordings made here, whole and damaged in known ways: what is read of them, and what is said of the damage.
#![expect(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

mod accounts;
mod anywhere;
mod cut;
mod large;
mod made;
mod records;
mod streams;

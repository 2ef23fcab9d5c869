//! The seat: a driving study in a browser.
//!
//! [`Seat::open`] keeps people, answers and drives in one SQLite file; [`serve`] shows the page and takes in what it sends; a drive that
//! has ended is driven again from its record and written as a log ([`files`]). [`demo`] makes the model of made-up people.

mod above;
mod among_others;
mod assets;
pub mod carried;
pub mod demo;
pub mod error;
pub mod files;
mod finished;
mod intake;
mod lab;
mod origin;
mod parts;
mod person;
pub mod replay;
mod request;
mod seat;
mod serve;
mod sheet;
pub mod steps;
mod store;
mod tables;
mod token;
mod wire;

pub use error::SeatError;
pub use seat::{Seat, SeatSettings};
pub use serve::{Serving, run, serve};
pub use wire::Wire;

/// A password of 128 random bits.
///
/// # Errors
/// [`SeatError::Random`] if the system has none.
pub fn password() -> Result<String, SeatError> {
    token::new()
}

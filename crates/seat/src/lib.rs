//! The seat: a driving study in a browser.
//!
//! [`Seat::open`] keeps people, answers and drives in one SQLite file; [`serve`] shows the page and takes in what it sends; a drive that
//! has ended is driven again from its record and written as a log ([`files`]). [`demo`] makes the model of made-up people.
#![allow(clippy::missing_errors_doc)] // a part of the program: its errors are read, not matched on

mod above;
mod among_others;
mod asked_first;
mod assets;
mod between;
mod books;
mod collected;
mod connections;
mod consent;
mod crash;
mod decided;
pub mod demo;
mod disk;
mod drives;
mod entrance;
pub mod error;
mod escaped;
pub mod files;
mod finished;
mod forget;
mod guard;
mod held;
mod hindrance;
mod intake;
mod known;
mod lab;
mod language;
mod left_out;
mod lending;
mod lent;
mod let_in;
mod listed;
mod live;
mod markup;
mod moments;
mod needs;
mod origin;
mod parts;
mod payment;
mod person;
mod plan;
mod refusals;
mod repeated;
pub mod replay;
mod request;
mod screening;
mod seat;
mod servable;
mod serve;
mod sheet;
mod sheet_page;
pub mod steps;
mod store;
mod streamed;
mod tables;
mod token;
mod unnamed;
mod wire;
mod withdrawal;
mod words;

pub use error::SeatError;
pub use forget::{Forgotten, forget};
pub use hindrance::Hindrance;
pub use let_in::Invitation;
pub use payment::{Paid, paid};
pub use seat::{Seat, SeatSettings};
pub use serve::{Serving, run, serve};
pub use sheet_page::{SheetPages, write_sheet_pages};
pub use wire::Wire;
pub use words::Words;

/// A password of 128 random bits.
///
/// # Errors
/// [`SeatError::Random`] if the system has none.
pub fn password() -> Result<String, SeatError> {
    token::new()
}

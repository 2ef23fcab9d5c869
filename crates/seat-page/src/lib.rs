//! The seat: a person drives, is learned and rides, the same in a page and natively.
//!
//! A [`SeatDrive`] is ticked a hundred times a second with the [`Input`] of a person's hands, or rides with a [`Rider`]. What it is
//! given is recorded ([`Chunk`]); a [`Record`] of it drives again, byte for byte ([`replay`]). [`fit`] learns a style from what was driven.

#[cfg(target_arch = "wasm32")]
mod bindings;
mod digest;
mod drive;
pub mod error;
mod fit;
mod input;
mod keyboard;
mod practised;
mod record;
mod replay;
mod rider;

pub use digest::Digest;
pub use drive::{Driven, SeatDrive};
pub use error::SeatPageError;
pub use fit::{Fit, fit};
pub use input::{Input, Signal};
pub use keyboard::{Keyboard, Keys, Stick};
pub use practised::Practised;
pub use record::{Asked, Chunk, End, Event, Frames, Header, Held, Record};
pub use replay::{Replayed, replay};
pub use rider::Rider;

pub use maveric_steering::{Lending, RideStyle, Seed};

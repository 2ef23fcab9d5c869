#![doc = include_str!("../README.md")]

mod gipps;
mod helly;
mod idm;
mod mobil;
mod newell;
mod real;
mod rss;

pub use gipps::Gipps;
pub use helly::{Gains, Helly};
pub use idm::Idm;
pub use mobil::{Mobil, Sides};
pub use newell::newell_accel_mps2;
pub use real::Real;
pub use rss::{LateralRss, Rss, needed_braking_mps2};

/// Gap below which a law reads this gap, in m, so that a collision is a hard braking and not infinity.
pub const LEAST_GAP_M: f64 = 0.1;

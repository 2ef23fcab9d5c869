#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod idm;
mod mobil;
mod rss;

pub use idm::Idm;
pub use mobil::{Mobil, Sides};
pub use rss::{LateralRss, Rss, needed_braking_mps2};

/// Gap below which a law reads this gap, in m, so that a collision is a hard braking and not infinity.
pub const LEAST_GAP_M: f64 = 0.1;

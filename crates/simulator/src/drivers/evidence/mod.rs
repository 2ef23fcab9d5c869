//! People of a second kind, whom no network here was made for: they act when evidence has piled up.
//!
//! Where the usual synthetic people begin a pass at a time gap and merge back at another, these accumulate what speaks for passing
//! (speed that the lead costs, nearness) in a memory that leaks, act when it passes a threshold that falls as they wait, and merge
//! back at a distance in metres after a moment's hesitation. Five latents with bent loadings are behind it, a lane change has a
//! shape of its own, and nobody keeps quite to the middle of the lane.
//!
//! # Source
//! Ours. Evidence accumulation as a model of drivers' decisions: Markkula (2014), "Modeling driver control behavior in both routine and
//! near-accident driving"; the quintic course of a movement: Flash and Hogan (1985).

mod driver;
mod merging;
mod population;
mod sideways;
mod urge;

pub(crate) use driver::EvidenceDriver;
pub use population::{BentLaw, EvidenceParams, EvidencePopulation};

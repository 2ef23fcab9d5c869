//! Whether the items of a scale measure one thing, and whether a person's readings agree.

mod alpha;
mod icc;
mod omega;

pub use alpha::{Alpha, AlphaAnalysis, ItemDropped, ItemStatistics, alpha};
pub use icc::{Icc, icc};

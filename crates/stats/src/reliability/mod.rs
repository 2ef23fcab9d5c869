//! Whether the items of a scale measure one thing.

mod alpha;
mod omega;

pub use alpha::{Alpha, AlphaAnalysis, ItemDropped, ItemStatistics, alpha};

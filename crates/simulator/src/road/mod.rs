//! The road's course: how it bends, where it lies on a map, how fast it can be driven.

mod centre_line;
mod segment;

pub use centre_line::{CentreLine, MapPose};
pub use segment::Segment;

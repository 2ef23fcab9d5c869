//! Moving in style space: along the direction of aggression, and across it.

pub mod axis;
pub mod ellipse;
pub mod range;
pub mod shift;

pub use axis::AggressionAxis;
pub use ellipse::{Perpendicular, PerpendicularEllipse};
pub use range::share_outside_training;
pub use shift::{Shifted, shift};

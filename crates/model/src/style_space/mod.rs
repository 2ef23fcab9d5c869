//! Moving in style space: along the direction of aggression and of any other attribute, and across.

pub mod attribute;
pub mod axis;
pub mod ellipse;
pub mod move_along;
pub mod range;
pub mod shift;

pub use attribute::{AttributeHead, LinearHead};
pub use axis::AggressionAxis;
pub use ellipse::{Perpendicular, PerpendicularEllipse};
pub use move_along::{Moved, StyleMetric};
pub use range::share_outside_training;
pub use shift::{Shifted, shift};

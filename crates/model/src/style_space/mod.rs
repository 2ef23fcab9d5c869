//! Moving in style space: along the direction of aggression and of any other attribute, and across.

pub mod attribute;
pub mod ellipse;
pub mod head;
pub mod matched;
pub mod move_along;
pub mod range;

pub use attribute::AttributeHead;
pub use ellipse::{Perpendicular, PerpendicularEllipse};
pub use head::{LinearHead, Moved};
pub use matched::{Donor, MatchedStyle, Matching};
pub use move_along::StyleMetric;
pub use range::share_outside_training;

//! Heads: habits as events, each linear in the style.

mod family;
mod fit;
mod fitted;
mod following_gap;
mod free_speed;
mod head;
mod kept_back;
mod merge_back;
mod move_out;
mod pass;
mod passing_speed;
mod posterior;
mod situation;
mod style;
mod train;

pub use family::{Family, Outcome};
pub(crate) use fit::{DriveEvents, fit};
pub use fitted::FittedHead;
pub(crate) use fitted::OwnHead;
pub(crate) use fitted::check;
pub(crate) use following_gap::held_up;
pub(crate) use head::Shape;
pub(crate) use head::at;
pub use head::{Event, HEADS, Head, events_of};
pub use kept_back::KeptBack;
pub use posterior::Posterior;
pub(crate) use posterior::solve;
pub use style::StyleHead;
pub use train::HeadReport;
pub(crate) use train::{length_s, train_heads};

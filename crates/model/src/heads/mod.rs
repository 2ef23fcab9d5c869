//! Heads: habits as events, each linear in the style.

mod family;
mod fit;
mod fitted;
mod following_gap;
mod free_speed;
mod head;
mod kept_back;
mod list;
mod merge_back;
mod move_out;
mod pass;
mod passing_speed;
mod posterior;
mod report;
mod situation;
mod style;
mod support;
mod train;

pub use family::{Family, Outcome};
pub(crate) use fit::{DriveEvents, fit};
pub use fitted::FittedHead;
pub(crate) use fitted::OwnHead;
pub(crate) use fitted::check;
pub(crate) use following_gap::held_up;
pub(crate) use head::Shape;
pub use head::{Event, Head};
pub use kept_back::KeptBack;
pub(crate) use list::at;
pub use list::{HEADS, events_of};
pub(crate) use posterior::solve;
pub use report::HeadReport;
pub(crate) use style::ScoredStyle;
pub use style::{Posterior, StyleHead, score_line};
pub(crate) use support::Population;
pub use support::{BEYOND_P, Support};
pub(crate) use train::{LearnedFrom, learned_from, length_s, train_heads};

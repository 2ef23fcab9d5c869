//! The watch player: drives from above, side by side, with speed and gap over time.
//!
//! [`player`] makes a fragment for a page of one's own, [`watch_page`] a page that stands alone. The numbers travel
//! in the fragment as small integers (see [`POSITION_QUANTUM_M`], [`SPEED_QUANTUM_MPS`], [`GAP_QUANTUM_M`]) at
//! [`SAMPLES_PER_S`]; one script draws them between those instants. Without a script the fragment shows the time lines and a
//! table.

mod check;
mod drive;
mod fragment;
mod from_recording;
mod pack;
mod timeline;
mod view;

pub use drive::{CentreLine, ChangeSpan, InterventionSpan, PlayerDrive, Track, WatchPlayer};
pub use fragment::{PlayerFragment, player, watch_page};
pub use from_recording::PlayerMeta;
pub use pack::{GAP_QUANTUM_M, POSITION_QUANTUM_M, SAMPLES_PER_S, SPEED_QUANTUM_MPS};

/// How far cars are kept in the data and drawn, in m behind ego and ahead.
pub(crate) const SIGHT_M: (f64, f64) = (90.0, 150.0);

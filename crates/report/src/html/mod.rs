//! The page and the files around it, as bytes: whoever calls writes them.

mod files;
mod page;
pub mod player;
mod report;

pub use files::{RenderedFile, render};
pub use player::{
    CentreLine, ChangeSpan, InterventionSpan, PlayerDrive, PlayerFragment, PlayerMeta, Track,
    WatchPlayer, player, watch_page,
};
pub use report::{Input, Provenance, Report, Section};

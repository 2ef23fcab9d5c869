//! The page and the files around it, as bytes: whoever calls writes them.

mod files;
mod glossary;
mod ledger;
mod live;
mod page;
pub mod player;
mod report;
mod scripts;
mod space;
mod style;
mod template;

pub use files::render;
pub use live::{Live, LiveContent};
pub use player::{
    CentreLine, ChangeSpan, InterventionSpan, PlayerDrive, PlayerFragment, PlayerMeta, Track,
    WatchPlayer, player, watch_page,
};
pub use report::{Input, Methods, ParameterFile, Provenance, RenderedFile, Report, Section};
pub use space::{SpaceDrive, SpacePerson, StyleSpace};

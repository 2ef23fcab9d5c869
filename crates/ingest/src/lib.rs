#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod assemble;
mod centre_line;
mod clock;
mod csv;
mod differentiate;
mod drive_file;
mod error;
mod folder;
mod foreign;
mod inspect;
mod join_speeds;
mod lane_centres;
mod lanes;
mod log_files;
mod mapping;
mod median;
mod pair_rows;
mod parquet;
mod plausible;
mod provenance;
mod quality;
mod raw;
mod read_log;
mod read_table;
mod resample;
mod settings;
mod source;
mod speed_limits;
mod speed_windows;
mod split;
mod synchronise;
mod target;
mod tracks;

pub use maveric_bag::begins_ns;

pub use csv::{Csv, read_csv, short_rows};
pub use drive_file::{drive_frame, read_drive_from, write_drive_to};
pub use error::IngestError;
pub use inspect::{
    ChannelSummary, ColumnSummary, Gap, LogFormat, LogSummary, inspect, inspect_with,
    suggest_mapping,
};
pub use log_files::log_files;
pub use mapping::{
    AngleUnit, Directions, Forward, FrameKind, GapKind, Layout, LengthUnit, Long, LongColumns,
    Mapping, McapMapping, MessageMapping, Names, Pair, PairColumns, Platoon, PlatoonColumns, Point,
    RecordingMeta, RigSigns, RoadMapping, SeesMapping, Side, SpeedUnit, TableMapping, Tells,
    TimeUnit, Topics, TwistFrame, Units, named_after,
};
pub use parquet::{ParquetFile, is_parquet, parquet_bytes, read_parquet};
pub use provenance::Provenance;
pub use quality::{Warning, WarningKind};
pub use raw::mcap::decisions::{Decision, DecisionKind, read_decisions};
pub use raw::mcap::write::{Beside, write_mcap, write_mcap_with};
pub use raw::table::cells::parse_number;
pub use read_log::read_log;
pub use settings::{IngestSettings, Ingested};
pub use source::Source;
pub use split::log_parts;

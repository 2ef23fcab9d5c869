#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod ahead;
mod caught;
mod chunk;
mod codec;
mod container;
mod error;
mod json;
mod parts;
mod protobuf;
mod record;
mod ros2;
mod streams;
mod summary;
mod wanted;
mod writer;

pub use caught::caught;
pub use chunk::MOST_RECORD;
pub use codec::{Codec, OwnedSchema, plain_name};
pub use container::{Damage, Visitor, Walk, Walked, walk, walk_from};
pub use error::BagError;
pub use mcap::MAGIC;
pub use parts::{Parts, is_split, parts_of};
pub use record::{Channel, Message, Metadata, Record, Schema};
pub use ros2::cdr::Writer as CdrWriter;
pub use streams::{Stream, Streams, Take, read_streams};
pub use summary::{Announced, announced, attachment, begins_ns};
pub use wanted::name_number;
pub use writer::Writer;

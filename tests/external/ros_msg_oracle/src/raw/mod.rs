//! The reader of `maveric-ingest`, from its own source.

#[path = "../../../../../crates/ingest/src/raw/ros2/mod.rs"]
pub(crate) mod ros2;
#[path = "../../../../../crates/ingest/src/raw/wanted.rs"]
pub(crate) mod wanted;

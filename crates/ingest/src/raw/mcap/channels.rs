//! Channels: what each tells of a drive, and how it is decoded for that.

use super::roles::Reading;
use crate::mapping::MessageMapping;
use maveric_bag::{Channel, Codec, OwnedSchema};

/// How a channel is decoded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Decoder {
    /// What it tells, if anything that we use.
    pub(crate) reading: Option<Reading>,
    /// Takes what the role needs; passes over whole messages where there is no role.
    pub(crate) codec: Codec,
}

/// Compiles the decoder of a channel; `mapped` says what types mean that are not known.
///
/// # Errors
/// A sentence that says why this channel cannot be decoded.
pub(crate) fn decoder(
    channel: &Channel,
    schema: Option<&OwnedSchema>,
    mapped: &[MessageMapping],
) -> Result<Decoder, String> {
    let name = schema.map_or_else(String::new, |s| s.name.clone());
    let reading = Reading::of(&name, mapped);
    let paths = reading.as_ref().map_or(&[][..], |r| &r.paths);
    let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
    let codec = Codec::compile(channel, schema, &paths)?;
    Ok(Decoder { reading, codec })
}

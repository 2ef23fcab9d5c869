//! Channels: what each tells of a drive, how it is decoded for that, and when its messages came.

use super::roles::Reading;
use crate::mapping::MessageMapping;
use maveric_bag::{Channel, Codec, Message, OwnedSchema};
use std::sync::Arc;

/// How a channel is decoded.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Decoder {
    /// What it tells, if anything that we use.
    pub(crate) reading: Option<Reading>,
    /// Takes what the role needs; passes over whole messages where there is no role.
    pub(crate) codec: Codec,
}

/// Decoders by schema and encoding: channels of equal ones share theirs.
pub(crate) struct Decoders<'a> {
    /// What types mean that are not known.
    mapped: &'a [MessageMapping],
    compiled: Vec<Compiled>,
}

/// A schema, the encoding of messages, and what was made of them.
type Compiled = (Option<OwnedSchema>, String, Result<Arc<Decoder>, String>);

impl<'a> Decoders<'a> {
    pub(crate) fn new(mapped: &'a [MessageMapping]) -> Self {
        Self { mapped, compiled: Vec::new() }
    }

    /// The decoder of a channel, or a sentence that says why it cannot be decoded.
    pub(crate) fn for_channel(
        &mut self,
        channel: &Channel,
        schema: Option<&OwnedSchema>,
    ) -> Result<Arc<Decoder>, String> {
        let mut compiled = self.compiled.iter();
        let same = compiled.find(|(s, e, _)| s.as_ref() == schema && *e == channel.encoding);
        if let Some((_, _, decoder)) = same {
            return decoder.clone();
        }
        let name = schema.map_or("", |s| s.name.as_str());
        let reading = Reading::for_type(name, self.mapped);
        let paths = reading.as_ref().map_or(&[][..], |r| &r.paths);
        let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
        let codec = Codec::compile(channel, schema, &paths);
        let decoder = codec.map(|codec| Arc::new(Decoder { reading, codec }));
        let key = (schema.cloned(), channel.encoding.clone());
        self.compiled.push((key.0, key.1, decoder.clone()));
        decoder
    }
}

/// When a channel's messages came, and whether their definition fits them.
#[derive(Debug)]
pub(crate) struct Times {
    /// Times of receipt, in ns.
    pub(crate) log_ns: Vec<u64>,
    /// How many there were when the chunk began.
    pub(crate) mark: usize,
    /// Walks a whole message; why not, where that is so for the first one.
    pub(crate) whole: Result<Codec, String>,
}

impl Times {
    pub(crate) fn new(channel: &Channel, schema: Option<&OwnedSchema>) -> Self {
        Self { log_ns: Vec::new(), mark: 0, whole: Codec::compile(channel, schema, &[]) }
    }

    pub(crate) fn take(&mut self, message: Message<'_>) {
        if self.log_ns.is_empty()
            && let Ok(codec) = &self.whole
            && let Err(why) = codec.fits(message.data)
        {
            self.whole = Err(why);
        }
        self.log_ns.push(message.log_ns);
    }
}

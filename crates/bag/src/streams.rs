//! The streams of a recording, over all its files: what they declare, and who takes their messages.

use crate::{
    codec::{OwnedSchema, same_type},
    container::{Visitor, Walk, Walked, walk},
    error::BagError,
    record::{Channel, Message, Record},
};
use std::{collections::BTreeMap, path::PathBuf};

/// Takes the messages of one stream.
pub trait Take {
    /// The next message, which is the `nth` of the recording.
    fn take(&mut self, message: Message<'_>, nth: u32);
    /// A chunk begins: remember where you are.
    fn mark(&mut self);
    /// The chunk turned out to be damaged: forget its messages.
    fn roll_back(&mut self);
}

/// The messages of one topic and type.
#[derive(Debug)]
pub struct Stream<T> {
    /// As it was declared first.
    pub channel: Channel,
    /// What its bytes mean.
    pub schema: Option<OwnedSchema>,
    /// Who took its messages.
    pub taken: T,
}

/// What a recording holds.
#[derive(Debug)]
pub struct Streams<T> {
    /// In the order in which they were declared.
    pub streams: Vec<Stream<T>>,
    /// The library that wrote the file.
    pub writer: Option<String>,
    /// Named texts: the first of each name.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// What was found of each file.
    pub walked: Vec<Walked>,
    /// Least time of receipt, in ns.
    pub first_ns: Option<u64>,
    /// Messages whose channel nothing declares.
    pub undeclared: usize,
    /// Messages that are too long to be read.
    pub too_long: usize,
}

/// Reads a recording that is split over `parts`, in their order; `taker` makes who takes the messages of a stream.
///
/// Channels of equal topic, encoding and type are one stream, whichever file they are in and however many of them one file has:
/// every publisher may have a channel of its own. What a damaged chunk declares is believed only if nothing else declares it; if it was lost, the recording is read
/// again, knowing what its summary repeats.
///
/// # Errors
/// As [`walk`].
pub fn read_streams<T: Take>(
    parts: &[PathBuf],
    how: Walk,
    taker: impl FnMut(&Channel, Option<&OwnedSchema>) -> T,
) -> Result<Streams<T>, BagError> {
    streams_of(parts.len(), taker, |part, visitor| walk(&parts[part], how, visitor))
}

/// Reads streams of anything that can be walked part by part.
pub(crate) fn streams_of<T: Take, F: FnMut(&Channel, Option<&OwnedSchema>) -> T>(
    parts: usize,
    taker: F,
    walk: impl Fn(usize, &mut Collector<T, F>) -> Result<Walked, BagError>,
) -> Result<Streams<T>, BagError> {
    let walk_all = |collector: &mut Collector<T, F>| -> Result<Vec<Walked>, BagError> {
        (0..parts)
            .map(|part| {
                collector.begin(part);
                walk(part, collector)
            })
            .collect()
    };
    let mut collector = Collector::new(taker, Vec::new());
    let mut walked = walk_all(&mut collector)?;
    let known = |d: &Declared| !d.channels.is_empty() || !d.doubtful_channels.is_empty();
    if collector.read.undeclared > 0 && collector.declared.iter().any(known) {
        collector = Collector::new(collector.taker, collector.declared);
        walked = walk_all(&mut collector)?;
    }
    Ok(Streams { walked, ..collector.read })
}

/// What a file declares; declarations of damaged chunks are kept apart.
#[derive(Debug, Clone, Default)]
struct Declared {
    schemas: BTreeMap<u16, OwnedSchema>,
    channels: BTreeMap<u16, Channel>,
    doubtful_schemas: BTreeMap<u16, OwnedSchema>,
    doubtful_channels: BTreeMap<u16, Channel>,
}

/// Streams under way.
pub(crate) struct Collector<T, F> {
    taker: F,
    read: Streams<T>,
    /// Messages so far, with those that were rolled back.
    nth: u32,
    /// By file: what its messages may need before it comes.
    declared: Vec<Declared>,
    part: usize,
    /// Of the file that is being read, with the places of its channels' streams.
    schemas: BTreeMap<u16, OwnedSchema>,
    ids: BTreeMap<u16, usize>,
    /// Schemas and channels of the chunk that is being read, with the streams that these channels were before.
    fresh: (Vec<u16>, Vec<(u16, Option<usize>)>),
    mark: Mark,
}

/// How things stood when the chunk began.
#[derive(Debug, Clone, Copy, Default)]
struct Mark {
    first_ns: Option<u64>,
    undeclared: usize,
    too_long: usize,
    streams: usize,
}

impl<T: Take, F: FnMut(&Channel, Option<&OwnedSchema>) -> T> Collector<T, F> {
    fn new(taker: F, declared: Vec<Declared>) -> Self {
        Self {
            taker,
            read: Streams {
                streams: Vec::new(),
                writer: None,
                metadata: BTreeMap::new(),
                walked: Vec::new(),
                first_ns: None,
                undeclared: 0,
                too_long: 0,
            },
            nth: 0,
            declared,
            part: 0,
            schemas: BTreeMap::new(),
            ids: BTreeMap::new(),
            fresh: Default::default(),
            mark: Mark::default(),
        }
    }

    /// Starts a file: its channel numbers are its own.
    fn begin(&mut self, part: usize) {
        self.part = part;
        self.ids.clear();
        if self.declared.len() <= part {
            self.declared.resize(part + 1, Declared::default());
        }
        let mut known = self.declared[part].clone();
        for (id, schema) in std::mem::take(&mut known.doubtful_schemas) {
            known.schemas.entry(id).or_insert(schema);
        }
        for (id, channel) in std::mem::take(&mut known.doubtful_channels) {
            known.channels.entry(id).or_insert(channel);
        }
        self.schemas = known.schemas;
        known.channels.into_values().for_each(|c| self.declare(c));
    }

    fn declare(&mut self, channel: Channel) {
        let schema = self.schemas.get(&channel.schema_id);
        let id = channel.id;
        let same = self.read.streams.iter().position(|s| {
            s.channel.topic == channel.topic
                && s.channel.encoding == channel.encoding
                && match (&s.schema, schema) {
                    (Some(a), Some(b)) => a == b || same_type(&a.name, &b.name) && a.has_data(b),
                    (None, None) => true,
                    _ => false,
                }
        });
        let index = same.unwrap_or_else(|| {
            self.read.streams.push(Stream {
                taken: (self.taker)(&channel, schema),
                schema: schema.cloned(),
                channel,
            });
            self.read.streams.len() - 1
        });
        self.ids.insert(id, index);
    }
}

impl<T: Take, F: FnMut(&Channel, Option<&OwnedSchema>) -> T> Visitor for Collector<T, F> {
    fn record(&mut self, record: Record<'_>) {
        match record {
            Record::Other => {}
            Record::Header(_, library) => self.read.writer = Some(library),
            Record::Schema(schema) => {
                if !self.schemas.contains_key(&schema.id) {
                    let (id, schema) = (schema.id, OwnedSchema::from(schema));
                    self.declared[self.part].schemas.insert(id, schema.clone());
                    self.schemas.insert(id, schema);
                    self.fresh.0.push(id);
                }
            }
            Record::Channel(channel) => {
                let before = self.ids.get(&channel.id).copied();
                // A number that is declared again is that of the later channel from there on.
                let is_other = |&i: &usize| {
                    let known = &self.read.streams[i].channel;
                    known.topic != channel.topic || known.encoding != channel.encoding
                };
                if before.is_none_or(|i| is_other(&i)) {
                    self.fresh.1.push((channel.id, before));
                    let declared = &mut self.declared[self.part];
                    declared.channels.insert(channel.id, channel.clone());
                    self.declare(channel);
                }
            }
            Record::Message(message) => {
                let read = &mut self.read;
                read.first_ns = Some(read.first_ns.unwrap_or(message.log_ns).min(message.log_ns));
                self.nth = self.nth.saturating_add(1);
                let index = self.ids.get(&message.channel);
                match index.and_then(|&i| read.streams.get_mut(i)) {
                    Some(stream) => stream.taken.take(message, self.nth),
                    None => read.undeclared += 1,
                }
            }
            Record::Metadata(metadata) => {
                let named = self.read.metadata.entry(metadata.name);
                named.or_insert(metadata.values);
            }
        }
    }

    fn begin(&mut self) {
        self.schemas.clear();
        self.ids.clear();
    }

    fn passed_over(&mut self) {
        self.read.too_long += 1;
    }

    fn mark(&mut self) {
        self.fresh = Default::default();
        let read = &mut self.read;
        self.mark = Mark {
            first_ns: read.first_ns,
            undeclared: read.undeclared,
            too_long: read.too_long,
            streams: read.streams.len(),
        };
        read.streams.iter_mut().for_each(|s| s.taken.mark());
    }

    fn roll_back(&mut self) {
        let (mark, read) = (self.mark, &mut self.read);
        (read.first_ns, read.undeclared) = (mark.first_ns, mark.undeclared);
        read.too_long = mark.too_long;
        read.streams.truncate(mark.streams);
        read.streams.iter_mut().for_each(|s| s.taken.roll_back());
        // What a damaged chunk declares is believed only if nothing else does.
        let declared = &mut self.declared[self.part];
        let (schemas, channels) = std::mem::take(&mut self.fresh);
        for (id, before) in channels.into_iter().rev() {
            let channel = declared.channels.remove_entry(&id);
            // A stream of this chunk is gone as well.
            let before = before.and_then(|i| Some((i, self.read.streams.get(i)?)));
            if let Some((i, stream)) = before {
                self.ids.insert(id, i);
                declared.channels.insert(id, Channel { id, ..stream.channel.clone() });
            } else {
                self.ids.remove(&id);
                declared.doubtful_channels.extend(channel);
            }
        }
        for id in schemas {
            self.schemas.remove(&id);
            let schema = declared.schemas.remove_entry(&id);
            declared.doubtful_schemas.extend(schema);
        }
    }
}

//! Reads the drive of an MCAP recording.

use super::{
    channels::{Decoder, OwnedSchema, Role, decoder},
    choice::{Found, choose, parent},
    container::{Damage, Visitor, walk},
    metadata::{self, DriveRecord},
    record::{Channel, Message, Record},
    signals::{ego_sample, object_sample},
};
use crate::{
    error::IngestError,
    mapping::McapMapping,
    quality::{Warning, WarningKind},
    raw::{EgoSample, ObjectSample, RawDrive},
};
use std::{collections::BTreeMap, path::Path};

/// Reads the samples of ego and the others, and whose drive it is where the file says so.
///
/// Ego is the `Odometry` channel (one whose topic names ego, else the one with most messages), without one the
/// `PoseStamped` channel; the others come from the `ObjectArray` channel beside ego's topic, else any.
///
/// # Errors
/// As [`crate::read_log`].
pub(crate) fn read(
    path: &Path,
    mapping: Option<&McapMapping>,
    recover: bool,
) -> Result<(RawDrive, Option<DriveRecord>, Vec<Warning>), IngestError> {
    let mut collector = Collector::default();
    let mut damage = walk(path, recover, &mut collector)?;
    if collector.undeclared > 0 && !collector.streams.is_empty() {
        // The chunk that declared a channel is lost, but the summary repeats declarations: go again, knowing them.
        collector = collector.knowing();
        damage = walk(path, recover, &mut collector)?;
    }
    let mut warnings = damage_warnings(path, &damage, collector.first_ns);
    let record = match &collector.drive {
        Some(values) => Some(metadata::parse(path, values)?),
        None => None,
    };
    if collector.undeclared > 0 {
        let what = "messages belong to no channel that the file declares";
        warnings.push(Warning::new(
            path,
            WarningKind::BadMessage,
            collector.undeclared,
            what,
        ));
    }
    let streams: Vec<Stream> = collector.streams.into_values().collect();
    let found: Vec<Found<'_>> = streams.iter().map(Stream::found).collect();
    let choice = choose(path, mapping, &found)?;
    for stream in &streams {
        let topic = &stream.channel.topic;
        if let Err(why) = &stream.decoder {
            let what = format!("channel `{topic}` is refused: {why}");
            warnings.push(Warning::new(
                path,
                WarningKind::RefusedChannel,
                stream.messages,
                what,
            ));
        }
        if stream.bad > 0 {
            let what = format!("messages of `{topic}` do not fit their definition");
            warnings.push(Warning::new(
                path,
                WarningKind::BadMessage,
                stream.bad,
                what,
            ));
        }
    }
    if let Some(what) = &choice.others {
        warnings.push(Warning::new(path, WarningKind::Choice, 1, what.clone()));
    }
    let ego_among_objects = choice.objects.is_some_and(|i| {
        // `/carla/objects` holds ego too, `/carla/<role>/objects` does not.
        parent(&streams[i].channel.topic) != parent(&streams[choice.ego].channel.topic)
    });
    let mut streams: Vec<Option<Stream>> = streams.into_iter().map(Some).collect();
    let mut take = |i: usize| {
        streams
            .get_mut(i)
            .and_then(Option::take)
            .unwrap_or_default()
    };
    let drive = RawDrive {
        ego: take(choice.ego).ego,
        objects: choice.objects.map(&mut take).unwrap_or_default().objects,
        ego_length_m: record.as_ref().map(|r| r.ego_length_m),
        ego_among_objects,
    };
    Ok((drive, record, warnings))
}

/// Damage as warnings, with times since the first message.
pub(crate) fn damage_warnings(
    path: &Path,
    damage: &[Damage],
    first_ns: Option<u64>,
) -> Vec<Warning> {
    let seconds = |ns: u64| (i128::from(ns) - i128::from(first_ns.unwrap_or(0))) as f64 / 1e9;
    let warning = |d: &Damage| {
        let from = d.between_ns.0.map_or(0.0, seconds);
        let span = d.between_ns.1.map(|to| (from, seconds(to)));
        let what = match span {
            Some(_) => format!("byte {}: {}", d.at_byte, d.what),
            None => format!("byte {}: {}; nothing after {from:.3} s", d.at_byte, d.what),
        };
        Warning::new(path, WarningKind::Damage, 1, what).with_spans(span)
    };
    damage.iter().map(warning).collect()
}

#[derive(Debug)]
struct Stream {
    channel: Channel,
    type_name: String,
    decoder: Result<Decoder, String>,
    messages: usize,
    bad: usize,
    ego: Vec<EgoSample>,
    objects: Vec<ObjectSample>,
    /// Lengths of the four counters above when the chunk began.
    mark: [usize; 4],
}

impl Default for Stream {
    fn default() -> Self {
        Self {
            channel: Channel {
                id: 0,
                schema_id: 0,
                topic: String::new(),
                encoding: String::new(),
            },
            type_name: String::new(),
            decoder: Err(String::new()),
            messages: 0,
            bad: 0,
            ego: Vec::new(),
            objects: Vec::new(),
            mark: [0; 4],
        }
    }
}

impl Stream {
    fn new(channel: Channel, schema: Option<&OwnedSchema>) -> Self {
        Self {
            type_name: schema.map_or_else(String::new, |s| s.name.clone()),
            decoder: decoder(&channel, schema),
            channel,
            ..Self::default()
        }
    }

    fn found(&self) -> Found<'_> {
        Found {
            topic: &self.channel.topic,
            type_name: &self.type_name,
            messages: self.messages,
            role: self
                .decoder
                .as_ref()
                .map(|d| d.role)
                .map_err(String::as_str),
        }
    }

    fn take(&mut self, message: Message<'_>, row: &mut Vec<f64>) {
        self.messages += 1;
        let Ok(Decoder {
            role: Some(role),
            plan,
        }) = &self.decoder
        else {
            return;
        };
        let log_ns = i64::try_from(message.log_ns).unwrap_or(i64::MAX);
        let objects = &mut self.objects;
        let before = objects.len();
        let walked = plan.run(message.data, row, &mut |row| {
            objects.extend(object_sample(row, log_ns));
        });
        if walked.is_err() {
            // Half a message is none.
            objects.truncate(before);
            self.bad += 1;
        } else if *role != Role::Objects {
            self.ego.push(ego_sample(row, log_ns));
        }
    }
}

#[derive(Debug, Default)]
struct Collector {
    schemas: BTreeMap<u16, OwnedSchema>,
    streams: BTreeMap<u16, Stream>,
    drive: Option<BTreeMap<String, String>>,
    first_ns: Option<u64>,
    /// Messages whose channel was not known when they came.
    undeclared: usize,
    row: Vec<f64>,
}

impl Collector {
    /// A new collector that knows the declarations that this one met.
    fn knowing(self) -> Self {
        let streams = self.streams.into_iter().map(|(id, stream)| {
            let schema = self.schemas.get(&stream.channel.schema_id);
            (id, Stream::new(stream.channel, schema))
        });
        Self {
            streams: streams.collect(),
            schemas: self.schemas,
            ..Self::default()
        }
    }
}

impl Visitor for Collector {
    fn record(&mut self, record: Record<'_>) {
        match record {
            Record::Header(..) | Record::Other => {}
            Record::Schema(schema) => {
                self.schemas
                    .entry(schema.id)
                    .or_insert_with(|| schema.into());
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id);
                self.streams
                    .entry(channel.id)
                    .or_insert_with(|| Stream::new(channel, schema));
            }
            Record::Message(message) => {
                self.first_ns = Some(self.first_ns.unwrap_or(message.log_ns).min(message.log_ns));
                match self.streams.get_mut(&message.channel) {
                    Some(stream) => stream.take(message, &mut self.row),
                    None => self.undeclared += 1,
                }
            }
            Record::Metadata(metadata) => {
                if metadata.name == metadata::NAME {
                    self.drive = Some(metadata.values);
                }
            }
        }
    }

    fn mark(&mut self) {
        for s in self.streams.values_mut() {
            s.mark = [s.messages, s.bad, s.ego.len(), s.objects.len()];
        }
    }

    fn roll_back(&mut self) {
        for s in self.streams.values_mut() {
            [s.messages, s.bad, ..] = s.mark;
            s.ego.truncate(s.mark[2]);
            s.objects.truncate(s.mark[3]);
        }
    }
}

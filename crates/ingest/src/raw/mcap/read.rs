//! Reads the drive of an MCAP recording, in one file or split over several.

use super::{
    channels::{Decoder, decoder},
    choice::{Choice, Found, choose, parent},
    frames::Frames,
    metadata::{self, DriveRecord},
    roles::{Convention, Role},
    signals::{EgoRow, Objects, Receipt, ego_row, flatten, settle_speeds, turn},
};
use crate::{
    clock::one_clock,
    error::IngestError,
    mapping::{McapMapping, TwistFrame},
    quality::{Warning, WarningKind},
    raw::{EgoSample, ObjectSample, RawDrive, SpeedSample},
};
use maveric_bag::{
    Channel, Damage, MOST_RECORD, Message, OwnedSchema, Record, Visitor, Walk, same_type, walk,
};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

/// Reads the samples of ego and the others, and whose drive it is where the recording says so.
///
/// Ego is the `Odometry` channel (one whose topic names ego, else the one with most messages), without one a pose or a
/// fix with the speed of another channel, or the object that is known to be ego; the others come from the objects'
/// channel beside ego's topic, else any. Mapping and rig come before these rules. `parts` are the files, `path` is
/// what they are called by together.
///
/// # Errors
/// As [`crate::read_log`].
pub(crate) fn read(
    path: &Path,
    parts: &[PathBuf],
    mapping: Option<&McapMapping>,
    recover: bool,
) -> Result<(RawDrive, Option<DriveRecord>, Vec<Warning>), IngestError> {
    let mut collector = Collector::new(mapping);
    let mut damage = collector.walk_all(parts, recover)?;
    if collector.undeclared > 0 && collector.knows_more() {
        // The chunk that declared a channel is lost, but the summary repeats declarations: go again, knowing them.
        collector = collector.knowing();
        damage = collector.walk_all(parts, recover)?;
    }
    let mut warnings = Vec::new();
    for (part, damage) in parts.iter().zip(&damage) {
        warnings.extend(damage_warnings(part, damage, collector.first_ns));
    }
    let record = match collector.drive.as_ref().map(|v| metadata::parse(path, v)) {
        None => None,
        Some(Ok(record)) => Some(record),
        Some(Err(e)) if recover => {
            let what = format!("whose drive it is cannot be read: {e}");
            warnings.push(Warning::new(path, WarningKind::Damage, 1, what));
            None
        }
        Some(Err(e)) => return Err(e),
    };
    let undeclared = collector.undeclared;
    let mut warn = |kind, count: usize, what: String| {
        if count > 0 {
            warnings.push(Warning::new(path, kind, count, what));
        }
    };
    let what = "messages belong to no channel that the file declares".to_owned();
    warn(WarningKind::BadMessage, undeclared, what);
    let most = MOST_RECORD >> 20;
    let what = format!("messages of more than {most} MiB are passed over");
    warn(WarningKind::BadMessage, collector.too_long, what);
    let streams = collector.streams;
    let found: Vec<Found<'_>> = streams.iter().map(Stream::found).collect();
    let choice = choose(path, mapping, &found)?;
    for stream in &streams {
        let topic = &stream.channel.topic;
        if let Err(why) = &stream.decoder {
            let what = format!("channel `{topic}` is refused: {why}");
            // A channel without a message is refused as well.
            warn(WarningKind::RefusedChannel, stream.messages.max(1), what);
        }
        let why = stream.bad_why.as_deref().unwrap_or_default();
        let what = format!("messages of `{topic}` do not fit their definition: {why}");
        warn(WarningKind::BadMessage, stream.bad, what);
    }
    if let Some(what) = &choice.others {
        warn(WarningKind::Choice, 1, what.clone());
    }
    let drive = drive_of(path, streams, &choice, record.as_ref(), &mut warnings);
    Ok((drive, record, warnings))
}

/// The drive that chosen channels make.
fn drive_of(
    path: &Path,
    streams: Vec<Stream>,
    choice: &Choice,
    record: Option<&DriveRecord>,
    warnings: &mut Vec<Warning>,
) -> RawDrive {
    let topic = |i: usize| streams[i].channel.topic.as_str();
    // `/carla/objects` holds ego too, `/carla/<role>/objects` does not.
    let ego_among_objects = choice
        .objects
        .is_some_and(|i| parent(topic(i)) != parent(topic(choice.ego)));
    let told_from_objects = streams[choice.ego].role() == Some(Role::Objects);
    let frames = streams[choice.ego].frames;
    let is_fix = streams[choice.ego].role() == Some(Role::Fix);
    let identity = choice.identity.and_then(|i| streams[i].identity);
    let ego_id = choice.mapping.ego_object.or(identity);
    let mut streams: Vec<Option<Stream>> = streams.into_iter().map(Some).collect();
    let mut take = |i: Option<usize>| i.and_then(|i| streams.get_mut(i)?.take());
    let mut warn = |kind, count: usize, what: &str| {
        warnings.push(Warning::new(path, kind, count, what));
    };

    if let Some(frames) = frames {
        let (fixed, of_ego) = frames.names();
        let what = format!("ego is taken from the transforms from `{fixed}` to `{of_ego}`");
        warn(WarningKind::Choice, 1, &what);
    }
    let speeds = take(choice.speed).map(|s| s.ego).unwrap_or_default();
    let ego_stream = take(Some(choice.ego));
    let (mut ego, mut objects) = match ego_stream {
        Some(stream) if told_from_objects => (Vec::new(), stream.objects),
        Some(stream) => (
            stream.ego,
            take(choice.objects).map(|s| s.objects).unwrap_or_default(),
        ),
        None => (Vec::new(), Vec::new()),
    };
    if choice.mapping.left_handed == Some(true) {
        turn(&mut ego, &mut objects);
    }
    let mut ego_length_m = record.map(|r| r.ego_length_m);
    if let Some(id) = ego_id
        .filter(|_| told_from_objects || ego_among_objects || choice.mapping.ego_object.is_some())
    {
        let is_ego = |o: &&ObjectSample| o.id == id;
        ego_length_m = ego_length_m.or(objects
            .iter()
            .find(is_ego)
            .and_then(ObjectSample::known_length_m));
        if told_from_objects {
            ego = objects
                .iter()
                .filter(is_ego)
                .map(EgoRow::of_object)
                .collect();
            warn(
                WarningKind::Choice,
                ego.len(),
                &format!("ego is object {id} of the others' channel"),
            );
        }
        objects.retain(|o| o.id != id);
    }
    if let Some(what) = settle_speeds(&mut ego) {
        warn(WarningKind::Choice, ego.len(), what);
    }
    let mut ego: Vec<EgoSample> = ego.into_iter().map(|r| r.sample).collect();
    if is_fix {
        flatten(&mut ego);
    }
    let speeds = speeds.into_iter().filter_map(|r| {
        Some(SpeedSample {
            stamp_ns: r.sample.stamp_ns,
            log_ns: r.sample.log_ns,
            nth: r.sample.nth,
            speed_mps: r.sample.speed_mps?,
        })
    });
    let mut drive = RawDrive {
        ego,
        objects,
        speeds: speeds.collect(),
        ego_length_m,
        ego_among_objects: ego_among_objects && ego_id.is_none(),
        without_lateral: record.is_some_and(|r| r.without_lateral),
    };
    if let Some(what) = one_clock(&mut drive) {
        let count = drive.ego.len() + drive.objects.len() + drive.speeds.len();
        warn(WarningKind::ReceiveTime, count, what);
    }
    drive
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

impl EgoRow {
    fn of_object(object: &ObjectSample) -> Self {
        Self {
            sample: EgoSample {
                stamp_ns: object.stamp_ns,
                log_ns: object.log_ns,
                nth: object.nth,
                x_m: object.x_m,
                y_m: object.y_m,
                yaw_rad: None,
                speed_mps: Some(object.speed_mps),
            },
            twist: None,
        }
    }
}

#[derive(Debug)]
struct Stream {
    channel: Channel,
    schema: Option<OwnedSchema>,
    decoder: Result<Arc<Decoder>, String>,
    messages: usize,
    bad: usize,
    /// What was wrong with the first of them.
    bad_why: Option<String>,
    ego: Vec<EgoRow>,
    objects: Vec<ObjectSample>,
    making: Objects,
    identity: Option<u32>,
    /// Of transforms: the frames that ego's samples are between.
    frames: Option<Frames>,
    twist: Option<TwistFrame>,
    /// Lengths of the four counters above when the chunk began.
    mark: [usize; 4],
}

impl Stream {
    fn new(
        channel: Channel,
        schema: Option<&OwnedSchema>,
        decoder: Result<Arc<Decoder>, String>,
        mapping: Option<&McapMapping>,
    ) -> Self {
        Self {
            decoder,
            schema: schema.cloned(),
            channel,
            messages: 0,
            bad: 0,
            bad_why: None,
            ego: Vec::new(),
            objects: Vec::new(),
            making: Objects::default(),
            identity: None,
            frames: None,
            twist: mapping.and_then(|m| m.objects_twist),
            mark: [0; 4],
        }
    }

    /// Whether this is the channel of another file of the same recording.
    fn goes_on_as(&self, channel: &Channel, schema: Option<&OwnedSchema>) -> bool {
        self.channel.topic == channel.topic
            && self.channel.encoding == channel.encoding
            && match (&self.schema, schema) {
                (Some(a), Some(b)) => a == b || same_type(&a.name, &b.name) && a.has_data(b),
                (None, None) => true,
                _ => false,
            }
    }

    fn role(&self) -> Option<Role> {
        let decoder = self.decoder.as_ref().ok()?;
        decoder.reading.as_ref().map(|r| r.role)
    }

    fn found(&self) -> Found<'_> {
        Found {
            topic: &self.channel.topic,
            type_name: self.schema.as_ref().map_or("", |s| s.name.as_str()),
            // Most transforms are of no use: those of joints and sensors.
            messages: if self.role() == Some(Role::Frames) {
                self.ego.len()
            } else {
                self.messages
            },
            role: match &self.decoder {
                Ok(_) => Ok(self.role()),
                Err(why) => Err(why),
            },
        }
    }

    fn take(&mut self, message: Message<'_>, nth: u32, row: &mut Vec<f64>) {
        self.messages += 1;
        let Ok(decoder) = &self.decoder else { return };
        let Some(reading) = &decoder.reading else {
            return;
        };
        let receipt = Receipt {
            log_ns: i64::try_from(message.log_ns).unwrap_or(i64::MAX),
            nth,
        };
        let before = self.objects.len();
        let (objects, making, twist) = (&mut self.objects, &mut self.making, self.twist);
        let before_ego = self.ego.len();
        let (ego, frames, mark) = (&mut self.ego, &mut self.frames, &mut self.mark);
        let (role, convention): (Role, Convention) = (reading.role, reading.convention);
        let walked = decoder.codec.run(message.data, row, &mut |row| {
            if role == Role::Objects
                && let Some(object) = making.sample(row, receipt, convention, twist)
            {
                objects.push(object);
            }
            if role == Role::Frames
                && let Some(found) = Frames::of(row)
            {
                match *frames {
                    Some(taken) if taken < found => return,
                    Some(taken) if taken == found => {}
                    _ => {
                        // Better frames than those so far.
                        *frames = Some(found);
                        ego.clear();
                        mark[2] = 0;
                    }
                }
                ego.push(ego_row(row, receipt));
            }
        });
        if let Err(why) = walked {
            self.bad_why.get_or_insert(why);
            // Half a message is none.
            self.objects.truncate(before);
            self.ego.truncate(before_ego);
            self.bad += 1;
            return;
        }
        match role {
            Role::Objects | Role::Frames => {}
            Role::Identity => self.identity = row.first().map(|&id| id as u32),
            Role::Odometry | Role::Pose | Role::Fix | Role::Speed => {
                self.ego.push(ego_row(row, receipt));
            }
        }
    }
}

#[derive(Debug, Default)]
struct Collector<'a> {
    mapping: Option<&'a McapMapping>,
    /// Declarations of the file that is being read.
    schemas: BTreeMap<u16, OwnedSchema>,
    ids: BTreeMap<u16, usize>,
    /// Decoders of the file's schemas, by their numbers and the encoding of messages.
    decoders: BTreeMap<(u16, String), Result<Arc<Decoder>, String>>,
    /// Declarations of each file that its messages may need before they come.
    known: Vec<Declarations>,
    part: usize,
    streams: Vec<Stream>,
    drive: Option<BTreeMap<String, String>>,
    first_ns: Option<u64>,
    /// Messages so far, with those that were rolled back.
    nth: u32,
    /// Messages whose channel was not known when they came.
    undeclared: usize,
    /// Messages that are too long to be read, and how many there were when the chunk began.
    too_long: usize,
    mark_too_long: usize,
    row: Vec<f64>,
    /// Declarations of the chunk that is being read.
    fresh: (Vec<u16>, Vec<u16>),
    mark: (Option<u64>, usize, usize),
}

/// What a file declares; declarations of damaged chunks are kept apart.
#[derive(Debug, Clone, Default)]
struct Declarations {
    schemas: BTreeMap<u16, OwnedSchema>,
    channels: BTreeMap<u16, Channel>,
    doubtful_schemas: BTreeMap<u16, OwnedSchema>,
    doubtful_channels: BTreeMap<u16, Channel>,
}

impl<'a> Collector<'a> {
    fn new(mapping: Option<&'a McapMapping>) -> Self {
        Self {
            mapping,
            ..Self::default()
        }
    }

    fn walk_all(
        &mut self,
        parts: &[PathBuf],
        recover: bool,
    ) -> Result<Vec<Vec<Damage>>, IngestError> {
        let mut damage = Vec::with_capacity(parts.len());
        for (i, part) in parts.iter().enumerate() {
            self.begin(i);
            let how = Walk {
                recover,
                ..Walk::default()
            };
            damage.push(walk(part, how, self)?);
        }
        Ok(damage)
    }

    /// Starts a file: its channel numbers are its own.
    fn begin(&mut self, part: usize) {
        self.part = part;
        self.schemas.clear();
        self.ids.clear();
        self.decoders.clear();
        if self.known.len() <= part {
            self.known.resize(part + 1, Declarations::default());
            return;
        }
        let mut known = self.known[part].clone();
        for (id, schema) in std::mem::take(&mut known.doubtful_schemas) {
            known.schemas.entry(id).or_insert(schema);
        }
        for (id, channel) in std::mem::take(&mut known.doubtful_channels) {
            known.channels.entry(id).or_insert(channel);
        }
        self.schemas = known.schemas;
        for channel in known.channels.into_values() {
            self.declare(channel);
        }
    }

    fn declare(&mut self, channel: Channel) {
        let schema = self.schemas.get(&channel.schema_id);
        let id = channel.id;
        let same = self
            .streams
            .iter()
            .position(|s| s.goes_on_as(&channel, schema));
        // Within one file two channels of one topic stay two.
        let same = same.filter(|i| !self.ids.values().any(|j| j == i));
        let index = same.unwrap_or_else(|| {
            // Channels of one schema and encoding are decoded alike.
            let key = (channel.schema_id, channel.encoding.clone());
            let compile = || {
                let mapped = self.mapping.map_or(&[][..], |m| &m.messages);
                decoder(&channel, schema, mapped).map(Arc::new)
            };
            let decoder = self.decoders.entry(key).or_insert_with(compile).clone();
            let stream = Stream::new(channel, schema, decoder, self.mapping);
            self.streams.push(stream);
            self.streams.len() - 1
        });
        self.ids.insert(id, index);
    }

    fn knows_more(&self) -> bool {
        let any = |d: &Declarations| !d.channels.is_empty() || !d.doubtful_channels.is_empty();
        self.known.iter().any(any)
    }

    /// A new collector that knows the declarations that this one met.
    fn knowing(self) -> Self {
        Self {
            known: self.known,
            ..Self::new(self.mapping)
        }
    }
}

impl Visitor for Collector<'_> {
    fn record(&mut self, record: Record<'_>) {
        match record {
            Record::Header(..) | Record::Other => {}
            Record::Schema(schema) => {
                if !self.schemas.contains_key(&schema.id) {
                    let (id, schema) = (schema.id, OwnedSchema::from(schema));
                    self.known[self.part].schemas.insert(id, schema.clone());
                    self.schemas.insert(id, schema);
                    self.fresh.0.push(id);
                }
            }
            Record::Channel(channel) => {
                if !self.ids.contains_key(&channel.id) {
                    self.fresh.1.push(channel.id);
                    self.known[self.part]
                        .channels
                        .insert(channel.id, channel.clone());
                    self.declare(channel);
                }
            }
            Record::Message(message) => {
                self.first_ns = Some(self.first_ns.unwrap_or(message.log_ns).min(message.log_ns));
                self.nth = self.nth.saturating_add(1);
                let index = self.ids.get(&message.channel);
                match index.and_then(|&i| self.streams.get_mut(i)) {
                    Some(stream) => stream.take(message, self.nth, &mut self.row),
                    None => self.undeclared += 1,
                }
            }
            Record::Metadata(metadata) => {
                if metadata.name == metadata::NAME {
                    self.drive.get_or_insert(metadata.values);
                }
            }
        }
    }

    fn passed_over(&mut self) {
        self.too_long += 1;
    }

    fn mark(&mut self) {
        self.fresh = Default::default();
        self.mark = (self.first_ns, self.undeclared, self.streams.len());
        self.mark_too_long = self.too_long;
        for s in &mut self.streams {
            s.mark = [s.messages, s.bad, s.ego.len(), s.objects.len()];
        }
    }

    fn roll_back(&mut self) {
        let (first_ns, undeclared, streams) = self.mark;
        (self.first_ns, self.undeclared) = (first_ns, undeclared);
        self.too_long = self.mark_too_long;
        self.streams.truncate(streams);
        for s in &mut self.streams {
            [s.messages, s.bad, ..] = s.mark;
            s.ego.truncate(s.mark[2]);
            s.objects.truncate(s.mark[3]);
        }
        // What a damaged chunk declares is believed only if nothing else does.
        let known = &mut self.known[self.part];
        let (schemas, channels) = std::mem::take(&mut self.fresh);
        for id in channels {
            self.ids.remove(&id);
            known
                .doubtful_channels
                .extend(known.channels.remove_entry(&id));
        }
        for id in schemas {
            self.schemas.remove(&id);
            self.decoders.retain(|(schema, _), _| *schema != id);
            known
                .doubtful_schemas
                .extend(known.schemas.remove_entry(&id));
        }
    }
}

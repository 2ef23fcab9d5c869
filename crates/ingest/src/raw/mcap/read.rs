//! Reads the drive of an MCAP recording, in one file or split over several.

use super::{
    beside_ego::place_by_ego,
    candidate::Candidate,
    channels::{Decoder, Decoders, Times},
    choice::{Choice, choose, parent},
    frames::{FrameNames, Frames, Whose},
    metadata::{self, DriveRecord},
    signals::{EgoRow, Objects, Receipt, ego_row, flatten, settle_speeds, stamp_ns, turn},
    slots::Role,
};
use crate::{
    clock::one_clock,
    error::IngestError,
    mapping::{McapMapping, TwistFrame},
    quality::{Warning, WarningKind, report},
    raw::{ObjectSample, ObjectSamples, RawDrive, Sighting, Sightings, SpeedSample},
};
use maveric_bag::{
    Damage, MOST_RECORD, Message, Stream, Streams, Take, Walk, announced, read_streams,
};
use maveric_domain::Sees;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

/// Bytes of a file for each sample that room is made for before it is read: packed ones seldom take fewer.
const LEAST_SAMPLE: u64 = 16;

/// What was collected of a recording: its streams with the samples that they hold.
pub(crate) type Collected = Streams<Samples>;

/// Reads the samples of the channels that make the drive, in one pass over `parts`.
///
/// Which they are is chosen by what the files say of themselves at their ends, and only those are decoded; where they say nothing,
/// or what is found is not as they said, every channel that tells something of a drive is.
///
/// # Errors
/// [`IngestError::Bag`]: damage is one without `recover`.
pub(crate) fn collect(
    path: &Path,
    parts: &[PathBuf],
    mapping: Option<&McapMapping>,
    recover: bool,
) -> Result<Collected, IngestError> {
    if let Some(topics) = chosen(path, parts, mapping) {
        let collected = collect_from(parts, mapping, recover, false, Some(&topics))?;
        let candidates: Vec<Candidate<'_>> = collected.streams.iter().map(candidate).collect();
        let choice = choose(path, mapping, &candidates);
        let same = choice.is_ok_and(|c| topics_of(&c, &candidates).keys().eq(topics.keys()));
        let whole = collected.walked.iter().all(|w| w.damage.is_empty());
        if same && whole && collected.undeclared == 0 {
            return Ok(collected);
        }
    }
    collect_from(parts, mapping, recover, false, None)
}

/// Reads the samples of every channel that tells something of a drive, when its messages came and whether they fit.
///
/// # Errors
/// [`IngestError::Bag`].
pub(crate) fn collect_all(
    parts: &[PathBuf],
    mapping: Option<&McapMapping>,
) -> Result<Collected, IngestError> {
    collect_from(parts, mapping, true, true, None)
}

/// Role and number of messages by topic and type.
type Roles = BTreeMap<(String, String), (Result<Option<Role>, String>, u64)>;

/// Topics of the channels that make the drive, and how many messages each has.
type Chosen = BTreeMap<String, usize>;

/// The channels that make the drive, by what every part says of itself.
fn chosen(path: &Path, parts: &[PathBuf], mapping: Option<&McapMapping>) -> Option<Chosen> {
    let mut streams = Roles::new();
    let mut decoders = Decoders::new(mapping.map_or(&[][..], |m| &m.messages));
    for part in parts {
        for (channel, schema, count) in announced(part)? {
            let decoder = decoders.for_channel(&channel, schema.as_ref());
            let role = decoder.map(|d| d.reading.as_ref().map(|r| r.role));
            let name = schema.map_or_else(String::new, |s| s.name);
            let stream = streams.entry((channel.topic, name)).or_insert((role, 0));
            stream.1 += count;
        }
    }
    let candidates = streams
        .iter()
        .map(|((topic, type_name), (role, count))| Candidate {
            topic,
            type_name,
            messages: *count as usize,
            role: role.as_ref().copied().map_err(String::as_str),
        });
    let candidates: Vec<Candidate<'_>> = candidates.collect();
    let choice = choose(path, mapping, &candidates).ok()?;
    Some(topics_of(&choice, &candidates))
}

/// The topics of a choice.
fn topics_of(choice: &Choice, candidates: &[Candidate<'_>]) -> Chosen {
    let places = [
        Some(choice.ego),
        choice.objects,
        choice.speed,
        choice.identity,
    ];
    let picked = places.into_iter().flatten().map(|i| &candidates[i]);
    picked.map(|f| (f.topic.to_owned(), f.messages)).collect()
}

fn collect_from(
    parts: &[PathBuf],
    mapping: Option<&McapMapping>,
    recover: bool,
    times: bool,
    only: Option<&Chosen>,
) -> Result<Collected, IngestError> {
    // What files claim of themselves makes no more room than they are long.
    let lengths = parts.iter().filter_map(|p| Some(p.metadata().ok()?.len()));
    let most = lengths.sum::<u64>() / LEAST_SAMPLE;
    let announced = |topic: &str| only.and_then(|only| only.get(topic)).copied();
    let how = Walk {
        recover,
        hash: true,
        cancel: None,
    };
    let mut decoders = Decoders::new(mapping.map_or(&[][..], |m| &m.messages));
    let streams = read_streams(parts, how, |channel, schema| Samples {
        decoder: decoders.for_channel(channel, schema),
        messages: 0,
        bad: 0,
        bad_why: None,
        ego: Vec::new(),
        objects: ObjectSamples::default(),
        sightings: Sightings::default(),
        frame: FrameNames::default(),
        other_frames: 0,
        making: Objects::default(),
        identity: None,
        frames: None,
        twist: mapping.and_then(|m| m.objects_twist),
        row: Vec::new(),
        wanted: only.is_none_or(|only| only.contains_key(&channel.topic)),
        ahead: announced(&channel.topic).map(|messages| (messages, most as usize)),
        times: times.then(|| Times::new(channel, schema)),
        mark: [0; 5],
    })?;
    Ok(streams)
}

/// The samples of ego and the others, and whose drive it is where the recording says so.
///
/// Ego is the `Odometry` channel (one whose topic names ego, else the one with most messages), without one a pose or a
/// fix with the speed of another channel, or the object that is known to be ego; the others come from the objects'
/// channel beside ego's topic, else any. Mapping and rig come before these rules. `parts` are the files, `path` is
/// what they are called by together.
pub(crate) fn drive(
    path: &Path,
    parts: &[PathBuf],
    collected: Collected,
    mapping: Option<&McapMapping>,
    recover: bool,
) -> Result<(RawDrive, Option<DriveRecord>, Vec<Warning>), IngestError> {
    let mut warnings = Vec::new();
    for (part, walked) in parts.iter().zip(&collected.walked) {
        warnings.extend(damage_warnings(part, &walked.damage, collected.first_ns));
    }
    let record = collected.metadata.get(metadata::NAME);
    let record = match record.map(|v| metadata::parse(path, v)) {
        None => None,
        Some(Ok(record)) => Some(record),
        Some(Err(e)) if recover => {
            let what = format!("whose drive it is cannot be read: {e}");
            warnings.push(Warning::new(path, WarningKind::Damage, 1, what));
            None
        }
        Some(Err(e)) => return Err(e),
    };
    let bad = WarningKind::BadMessage;
    let what = "messages belong to no channel that the file declares";
    report(&mut warnings, path, bad, collected.undeclared, what);
    let most = MOST_RECORD >> 20;
    let what = format!("messages of more than {most} MiB are passed over");
    report(&mut warnings, path, bad, collected.too_long, &what);
    let streams = collected.streams;
    let candidates: Vec<Candidate<'_>> = streams.iter().map(candidate).collect();
    let choice = choose(path, mapping, &candidates)?;
    for stream in &streams {
        let (topic, samples) = (&stream.channel.topic, &stream.taken);
        if let Err(why) = &samples.decoder {
            let what = format!("channel `{topic}` is refused: {why}");
            // A channel without a message is refused as well.
            let count = samples.messages.max(1);
            warnings.push(Warning::new(path, WarningKind::RefusedChannel, count, what));
        }
        let why = samples.bad_why.as_deref().unwrap_or_default();
        let what = format!("messages of `{topic}` do not fit their definition: {why}");
        report(&mut warnings, path, bad, samples.bad, &what);
    }
    let chosen = |what| Warning::new(path, WarningKind::Choice, 1, what);
    warnings.extend(choice.others.as_ref().map(chosen));
    let drive = drive_of(path, streams, &choice, record.as_ref(), &mut warnings);
    Ok((drive, record, warnings))
}

/// What is known of a stream when choosing.
pub(crate) fn candidate(stream: &Stream<Samples>) -> Candidate<'_> {
    let samples = &stream.taken;
    let role = samples.role();
    Candidate {
        topic: &stream.channel.topic,
        type_name: stream.schema.as_ref().map_or("", |s| s.name.as_str()),
        // Most transforms are of no use: those of joints and sensors.
        messages: if role == Some(Role::Frames) {
            samples.ego.len()
        } else {
            samples.messages
        },
        role: match &samples.decoder {
            Ok(_) => Ok(role),
            Err(why) => Err(why),
        },
    }
}

/// The drive that chosen channels make.
fn drive_of(
    path: &Path,
    streams: Vec<Stream<Samples>>,
    choice: &Choice,
    record: Option<&DriveRecord>,
    warnings: &mut Vec<Warning>,
) -> RawDrive {
    let topic = |i: usize| streams[i].channel.topic.as_str();
    // `/carla/objects` holds ego too, `/carla/<role>/objects` does not.
    let ego_among_objects = choice
        .objects
        .is_some_and(|i| parent(topic(i)) != parent(topic(choice.ego)));
    let told_from_objects = streams[choice.ego].taken.role() == Some(Role::Objects);
    let frames = streams[choice.ego].taken.frames;
    let is_fix = streams[choice.ego].taken.role() == Some(Role::Fix);
    let identity = choice.identity.and_then(|i| streams[i].taken.identity);
    let ego_id = choice.mapping.ego_object.or(identity);
    let mut streams: Vec<Option<Samples>> = streams.into_iter().map(|s| Some(s.taken)).collect();
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
    let (mut ego, of_ego, others) = match ego_stream {
        Some(stream) if told_from_objects => (Vec::new(), None, Some(stream)),
        Some(stream) => (stream.ego, Some(stream.frame), take(choice.objects)),
        None => (Vec::new(), None, None),
    };
    let sees = seen(record, others.is_some());
    let mut others = Others::from_samples(others, of_ego, &mut warn);
    if choice.mapping.left_handed == Some(true) {
        turn(&mut ego, &mut others.objects);
    }
    let mut ego_length_m = record.map(|r| r.ego_length_m);
    if let Some(id) = ego_id
        .filter(|_| told_from_objects || ego_among_objects || choice.mapping.ego_object.is_some())
    {
        let its = || others.objects.iter().filter(|o| o.id == id);
        ego_length_m = ego_length_m.or_else(|| its().find_map(|o| o.known_length_m()));
        if told_from_objects {
            let row = |o: ObjectSample| EgoRow {
                sample: o.as_ego(),
                twist: None,
            };
            ego = its().map(row).collect();
            let what = format!("ego is object {id} of the others' channel");
            warn(WarningKind::Choice, ego.len(), &what);
        }
        others.objects.retain(|o| o.id != id);
    }
    if let Some(what) = settle_speeds(&mut ego) {
        warn(WarningKind::Choice, ego.len(), what);
    }
    let mut drive = RawDrive {
        ego: ego.into_iter().map(|r| r.sample).collect(),
        objects: others.objects,
        sightings: others.sightings,
        speeds: speeds.into_iter().filter_map(speed_sample).collect(),
        ego_length_m,
        ego_among_objects: ego_among_objects && ego_id.is_none(),
        sees,
        without_lateral: record.is_some_and(|r| r.without_lateral),
        pair: None,
    };
    if is_fix {
        flatten(&mut drive.ego);
    }
    if let Some(what) = one_clock(&mut drive) {
        let count = drive.ego.len() + drive.objects.len() + drive.speeds.len();
        warn(WarningKind::ReceiveTime, count, what);
    }
    if others.whose == Whose::Ego {
        place_by_ego(&mut drive);
    }
    drive
}

/// A speed of a channel of its own.
fn speed_sample(row: EgoRow) -> Option<SpeedSample> {
    Some(SpeedSample {
        stamp_ns: row.sample.stamp_ns,
        log_ns: row.sample.log_ns,
        nth: row.sample.nth,
        speed_mps: row.sample.speed_mps?,
    })
}

/// What a recording shows: whoever lists vehicles lists all around; without a list nobody is seen.
fn seen(record: Option<&DriveRecord>, lists_others: bool) -> Sees {
    match record {
        Some(record) => record.sees,
        None if lists_others => Sees::ALL,
        None => Sees {
            lanes: true,
            ..Sees::NOTHING
        },
    }
}

/// The others, in the frame that they are told in.
#[derive(Default)]
struct Others {
    objects: ObjectSamples,
    sightings: Sightings,
    whose: Whose,
}

impl Others {
    /// Of their stream, beside the frame of ego's; says what was chosen.
    fn from_samples(
        stream: Option<Samples>,
        of_ego: Option<FrameNames>,
        warn: &mut impl FnMut(WarningKind, usize, &str),
    ) -> Self {
        let Some(stream) = stream else {
            return Self::default();
        };
        let whose = of_ego.map_or(Whose::Fixed, |of_ego| stream.frame.beside(of_ego));
        let kind = WarningKind::Choice;
        if stream.other_frames > 0 {
            let what = "samples of others in another frame than the first of them are left out";
            warn(kind, stream.other_frames, what);
        }
        let mut others = Self {
            objects: stream.objects,
            sightings: stream.sightings,
            whose,
        };
        let what = match whose {
            Whose::Fixed => return others,
            Whose::Another => {
                "the others are said to be in another fixed frame than ego: they are taken to be in the same"
            }
            Whose::Ego => {
                "the others are in ego's own frame: they are placed by where ego is, and their speeds are differentiated"
            }
            Whose::Unknown => {
                "the others are left out: their frame is neither ego's nor one that stands still, so nobody knows where they are"
            }
        };
        warn(kind, others.objects.len(), what);
        if whose == Whose::Unknown {
            others.objects.truncate(0);
            others.sightings.truncate(0);
        }
        others
    }
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

/// The samples of one stream, and what was wrong with its messages.
#[derive(Debug)]
pub(crate) struct Samples {
    decoder: Result<Arc<Decoder>, String>,
    messages: usize,
    bad: usize,
    /// What was wrong with the first of them.
    bad_why: Option<String>,
    ego: Vec<EgoRow>,
    objects: ObjectSamples,
    /// When lists of others came, empty ones too.
    sightings: Sightings,
    /// Frames of its first sample.
    frame: FrameNames,
    /// Samples of others in another frame than the first.
    other_frames: usize,
    making: Objects,
    identity: Option<u32>,
    /// Of transforms: the frames that ego's samples are between.
    frames: Option<Frames>,
    twist: Option<TwistFrame>,
    row: Vec<f64>,
    /// Whether its messages are decoded.
    wanted: bool,
    /// Messages that are announced, and most samples that room is made for by that; none once it is made.
    ahead: Option<(usize, usize)>,
    /// When messages came, where that is wanted.
    pub(crate) times: Option<Times>,
    /// Messages, bad ones, samples of both kinds and lists of others when the chunk began.
    mark: [usize; 5],
}

impl Samples {
    fn role(&self) -> Option<Role> {
        let decoder = self.decoder.as_ref().ok()?;
        decoder.reading.as_ref().map(|r| r.role)
    }
}

impl Take for Samples {
    fn take(&mut self, message: Message<'_>, nth: u32) {
        self.messages += 1;
        if let Some(times) = &mut self.times {
            times.take(message);
        }
        let Ok(decoder) = &self.decoder else { return };
        if !self.wanted {
            return;
        }
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
        let (frame, other_frames) = (&mut self.frame, &mut self.other_frames);
        let (ego, frames, mark) = (&mut self.ego, &mut self.frames, &mut self.mark);
        let (role, convention) = (reading.role, reading.convention);
        let row = &mut self.row;
        let walked = decoder.codec.run(message.data, row, &mut |row| {
            if role == Role::Objects
                && let Some(object) = making.sample(row, receipt, convention, twist)
            {
                if frame.is_of(FrameNames::of_object(row)) {
                    objects.push(object);
                } else {
                    *other_frames += 1;
                }
            }
            if role == Role::Frames
                && let Some(sample_frames) = Frames::from_row(row)
            {
                match *frames {
                    Some(taken) if taken < sample_frames => return,
                    Some(taken) if taken == sample_frames => {}
                    _ => {
                        // Better frames than those so far.
                        *frames = Some(sample_frames);
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
            Role::Frames => {}
            Role::Objects => {
                let first = self.objects.stamp_ns.get(before).copied();
                let stamp_ns = first.unwrap_or_else(|| stamp_ns(row));
                self.sightings.push(Sighting {
                    stamp_ns,
                    log_ns: receipt.log_ns,
                    nth,
                });
            }
            Role::Identity => self.identity = row.first().map(|&id| id as u32),
            Role::Odometry | Role::Pose | Role::Fix | Role::Speed => {
                self.frame.is_of(FrameNames::of_ego(row));
                self.ego.push(ego_row(row, receipt));
            }
        }
        if let (1.., Some((messages, most))) = (self.ego.len() + self.objects.len(), self.ahead) {
            let room = |of_first: usize| most.min(messages.saturating_mul(of_first));
            self.ego.reserve_exact(room(self.ego.len()));
            self.objects.reserve_exact(room(self.objects.len()));
            self.ahead = None;
        }
    }

    fn mark(&mut self) {
        let samples = [self.ego.len(), self.objects.len(), self.sightings.len()];
        self.mark = [self.messages, self.bad, samples[0], samples[1], samples[2]];
        if let Some(times) = &mut self.times {
            times.mark = times.log_ns.len();
        }
    }

    fn roll_back(&mut self) {
        [self.messages, self.bad, ..] = self.mark;
        self.ego.truncate(self.mark[2]);
        self.objects.truncate(self.mark[3]);
        self.sightings.truncate(self.mark[4]);
        if self.sightings.is_empty() && self.ego.is_empty() {
            self.frame = FrameNames::default();
        }
        if let Some(times) = &mut self.times {
            times.log_ns.truncate(times.mark);
        }
    }
}

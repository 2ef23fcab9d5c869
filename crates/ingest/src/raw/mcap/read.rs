//! Reads the drive of an MCAP recording, in one file or split over several.

use super::{
    candidate::Candidate,
    channels::{Decoders, Times},
    choice::{Choice, choose},
    drive::drive_of,
    frames::FrameNames,
    metadata::{self, DriveRecord},
    samples::{Samples, candidate},
    signals::Objects,
    slots::Role,
};
use crate::{
    error::IngestError,
    mapping::McapMapping,
    quality::{Warning, WarningKind, report},
    raw::{ObjectSamples, RawDrive, Sightings},
};
use maveric_bag::{Damage, MOST_RECORD, Streams, Walk, announced, read_streams};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
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
    let candidates = streams.iter().map(|((topic, type_name), (role, count))| Candidate {
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
    let places = [Some(choice.ego), choice.objects, choice.speed, choice.identity];
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
    let how = Walk { recover, hash: true };
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

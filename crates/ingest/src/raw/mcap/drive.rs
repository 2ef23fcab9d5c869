//! The drive that the samples of chosen channels make.

use super::{
    beside_ego::place_by_ego,
    choice::{Choice, parent},
    frames::{FrameNames, Whose},
    metadata::DriveRecord,
    samples::Samples,
    signals::{EgoRow, flatten, settle_speeds, turn},
    slots::Role,
};
use crate::{
    clock::{leave_out_unset, one_clock},
    quality::{Warning, WarningKind},
    raw::{ObjectSample, ObjectSamples, RawDrive, Sightings, SpeedSample},
};
use maveric_bag::Stream;
use maveric_domain::Sees;
use std::path::Path;

/// The drive that chosen channels make.
pub(super) fn drive_of(
    path: &Path,
    streams: Vec<Stream<Samples>>,
    choice: &Choice,
    record: Option<&DriveRecord>,
    warnings: &mut Vec<Warning>,
) -> RawDrive {
    let topic = |i: usize| streams[i].channel.topic.as_str();
    // `/carla/objects` holds ego too, `/carla/<role>/objects` does not.
    let ego_among_objects =
        choice.objects.is_some_and(|i| parent(topic(i)) != parent(topic(choice.ego)));
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
            let row = |o: ObjectSample| EgoRow { sample: o.as_ego(), twist: None };
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
        sightings: Some(others.sightings).filter(|s| !s.is_empty()),
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
    let unset = leave_out_unset(&mut drive);
    if unset > 0 {
        let what = "messages are skipped: their header stamp is more than a day from the others, as if it was not set";
        warn(WarningKind::BadMessage, unset, what);
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
        None => Sees { lanes: true, ..Sees::NOTHING },
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
        let mut others = Self { objects: stream.objects, sightings: stream.sightings, whose };
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

//! What is kept of the messages of one channel while a recording is read.

use super::{
    candidate::Candidate,
    channels::{Decoder, Times},
    frames::{FrameNames, Frames},
    signals::{EgoRow, Objects, Receipt, ego_row, stamp_ns},
    slots::Role,
};
use crate::{
    mapping::TwistFrame,
    raw::{ObjectSamples, Sighting, Sightings},
};
use maveric_bag::{Message, Stream, Take};
use std::sync::Arc;

/// The samples of one stream, and what was wrong with its messages.
#[derive(Debug)]
pub(crate) struct Samples {
    pub(super) decoder: Result<Arc<Decoder>, String>,
    pub(super) messages: usize,
    pub(super) bad: usize,
    /// What was wrong with the first of them.
    pub(super) bad_why: Option<String>,
    pub(super) ego: Vec<EgoRow>,
    pub(super) objects: ObjectSamples,
    /// When lists of others came, empty ones too.
    pub(super) sightings: Sightings,
    /// Frames of its first sample.
    pub(super) frame: FrameNames,
    /// Samples of others in another frame than the first.
    pub(super) other_frames: usize,
    pub(super) making: Objects,
    pub(super) identity: Option<u32>,
    /// Of transforms: the frames that ego's samples are between.
    pub(super) frames: Option<Frames>,
    pub(super) twist: Option<TwistFrame>,
    pub(super) row: Vec<f64>,
    /// Whether its messages are decoded.
    pub(super) wanted: bool,
    /// Messages that are announced, and most samples that room is made for by that; none once it is made.
    pub(super) ahead: Option<(usize, usize)>,
    /// When messages came, where that is wanted.
    pub(crate) times: Option<Times>,
    /// Messages, bad ones, samples of both kinds and lists of others when the chunk began.
    pub(super) mark: [usize; 5],
}

impl Samples {
    pub(super) fn role(&self) -> Option<Role> {
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
        let receipt = Receipt { log_ns: i64::try_from(message.log_ns).unwrap_or(i64::MAX), nth };
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
                self.sightings.push(Sighting { stamp_ns, log_ns: receipt.log_ns, nth });
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

/// What is known of a stream when choosing.
pub(crate) fn candidate(stream: &Stream<Samples>) -> Candidate<'_> {
    let samples = &stream.taken;
    let role = samples.role();
    Candidate {
        topic: &stream.channel.topic,
        type_name: stream.schema.as_ref().map_or("", |s| s.name.as_str()),
        // Most transforms are of no use: those of joints and sensors.
        messages: if role == Some(Role::Frames) { samples.ego.len() } else { samples.messages },
        role: match &samples.decoder {
            Ok(_) => Ok(role),
            Err(why) => Err(why),
        },
    }
}

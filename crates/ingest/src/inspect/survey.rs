//! The channels of a recording: when their messages came and whether they can be decoded.

use super::{ChannelSummary, Gap};
use crate::{
    error::IngestError,
    raw::mcap::{
        channels::{Decoder, decoder},
        choice::Found,
        metadata,
    },
};
use maveric_bag::{
    Channel, Codec, Damage, Message, OwnedSchema, Record, Visitor, Walk, same_type, walk,
};
use std::{collections::BTreeMap, path::PathBuf};

/// Holes shorter than this many usual intervals between messages are jitter.
const GAP_INTERVALS: f64 = 5.0;
/// Holes shorter than this are bridged anyway, in s.
const GAP_S: f64 = 0.5;

#[derive(Debug)]
pub(super) struct Surveyed {
    channel: Channel,
    schema: Option<(String, String)>,
    decoder: Result<Decoder, String>,
    /// Walks a whole message, to see whether the definition fits it.
    whole: Result<Codec, String>,
    pub(super) log_ns: Vec<u64>,
    mark: usize,
}

impl Surveyed {
    fn new(channel: Channel, schema: Option<&OwnedSchema>) -> Self {
        Self {
            schema: schema.map(|s| (s.name.clone(), s.encoding.clone())),
            decoder: decoder(&channel, schema, &[]),
            whole: Codec::compile(&channel, schema, &[]),
            channel,
            log_ns: Vec::new(),
            mark: 0,
        }
    }

    fn take(&mut self, message: Message<'_>) {
        if self.log_ns.is_empty()
            && let Ok(codec) = &self.whole
            && let Err(why) = codec.fits(message.data)
        {
            self.whole = Err(why);
        }
        self.log_ns.push(message.log_ns);
    }

    fn type_name(&self) -> &str {
        self.schema.as_ref().map_or("", |s| s.0.as_str())
    }

    pub(super) fn found(&self) -> Found<'_> {
        Found {
            topic: &self.channel.topic,
            type_name: self.type_name(),
            messages: self.log_ns.len(),
            role: self
                .decoder
                .as_ref()
                .map(|d| d.reading.as_ref().map(|r| r.role))
                .map_err(String::as_str),
        }
    }

    /// Median interval between messages that did not come at one time, in s.
    fn interval_s(&self) -> Option<f64> {
        let mut steps: Vec<u64> = self
            .log_ns
            .windows(2)
            .map(|w| w[1].abs_diff(w[0]))
            .filter(|&d| d > 0)
            .collect();
        steps.sort_unstable();
        steps.get(steps.len() / 2).map(|&d| d as f64 / 1e9)
    }

    pub(super) fn gaps(&self, start_ns: u64) -> Vec<Gap> {
        let limit = (GAP_INTERVALS * self.interval_s().unwrap_or(0.0)).max(GAP_S);
        let since = |ns: u64| ns.saturating_sub(start_ns) as f64 / 1e9;
        let wide = |w: &&[u64]| w[1].saturating_sub(w[0]) as f64 / 1e9 > limit;
        let gap = |w: &[u64]| Gap {
            topic: self.channel.topic.clone(),
            from_s: since(w[0]),
            to_s: since(w[1]),
        };
        self.log_ns.windows(2).filter(wide).map(gap).collect()
    }

    pub(super) fn summary(self) -> ChannelSummary {
        let seconds = |ns: &u64| *ns as f64 / 1e9;
        ChannelSummary {
            type_name: self.type_name().to_owned(),
            schema_encoding: self
                .schema
                .as_ref()
                .map_or_else(String::new, |s| s.1.clone()),
            messages: self.log_ns.len(),
            rate_hz: self.interval_s().map(|s| 1.0 / s),
            first_s: self.log_ns.iter().min().map(seconds),
            last_s: self.log_ns.iter().max().map(seconds),
            decodable: self.whole.is_ok(),
            reason: self.whole.err(),
            topic: self.channel.topic,
            encoding: self.channel.encoding,
        }
    }
}

/// What one file declares.
#[derive(Debug, Clone, Default)]
struct Declared {
    schemas: BTreeMap<u16, OwnedSchema>,
    channels: BTreeMap<u16, Channel>,
}

#[derive(Debug, Default)]
pub(super) struct Survey {
    /// By file; the last one is being read.
    declared: Vec<Declared>,
    /// What the files declared when they were read before.
    known: Vec<Declared>,
    /// Place in `channels` of those of the file that is being read.
    ids: BTreeMap<u16, usize>,
    pub(super) channels: Vec<Surveyed>,
    pub(super) writer: Option<String>,
    pub(super) drive: Option<BTreeMap<String, String>>,
    /// Messages whose channel was not known when they came.
    undeclared: usize,
}

impl Survey {
    /// Surveys a recording over all its files; gives what is damaged in each.
    ///
    /// # Errors
    /// [`IngestError::Io`].
    pub(super) fn of(parts: &[PathBuf]) -> Result<(Self, Vec<Vec<Damage>>), IngestError> {
        let mut survey = Self::default();
        let mut damage = survey.walk_all(parts)?;
        if survey.undeclared > 0 && !survey.channels.is_empty() {
            // As when reading: a lost chunk may have declared channels that the summary repeats.
            survey = Self {
                known: survey.declared,
                ..Self::default()
            };
            damage = survey.walk_all(parts)?;
        }
        Ok((survey, damage))
    }

    fn walk_all(&mut self, parts: &[PathBuf]) -> Result<Vec<Vec<Damage>>, IngestError> {
        let mut damage = Vec::with_capacity(parts.len());
        for (i, part) in parts.iter().enumerate() {
            // Numbers of channels are a file's own.
            self.ids.clear();
            self.declared.push(Declared::default());
            let known = self.known.get(i).cloned().unwrap_or_default();
            for (id, schema) in known.schemas {
                self.schemas().insert(id, schema);
            }
            known.channels.into_values().for_each(|c| self.declare(c));
            let how = Walk {
                recover: true,
                ..Walk::default()
            };
            damage.push(walk(part, how, self)?);
        }
        Ok(damage)
    }

    fn schemas(&mut self) -> &mut BTreeMap<u16, OwnedSchema> {
        if self.declared.is_empty() {
            self.declared.push(Declared::default());
        }
        let last = self.declared.len() - 1;
        &mut self.declared[last].schemas
    }

    fn declare(&mut self, channel: Channel) {
        if self.ids.contains_key(&channel.id) {
            return;
        }
        let schema = self.schemas().get(&channel.schema_id).cloned();
        let type_name = schema.as_ref().map_or("", |s| s.name.as_str());
        let same = self.channels.iter().position(|c| {
            c.channel.topic == channel.topic
                && c.channel.encoding == channel.encoding
                && same_type(c.type_name(), type_name)
        });
        // Within one file two channels of one topic stay two.
        let same = same.filter(|i| !self.ids.values().any(|j| j == i));
        let index = same.unwrap_or_else(|| {
            self.channels
                .push(Surveyed::new(channel.clone(), schema.as_ref()));
            self.channels.len() - 1
        });
        self.ids.insert(channel.id, index);
        if let Some(declared) = self.declared.last_mut() {
            declared.channels.insert(channel.id, channel);
        }
    }
}

impl Visitor for Survey {
    fn record(&mut self, record: Record<'_>) {
        match record {
            Record::Other => {}
            Record::Header(_, library) => self.writer = Some(library),
            Record::Schema(schema) => {
                let id = schema.id;
                self.schemas().entry(id).or_insert_with(|| schema.into());
            }
            Record::Channel(channel) => self.declare(channel),
            Record::Message(message) => {
                let index = self.ids.get(&message.channel);
                match index.and_then(|&i| self.channels.get_mut(i)) {
                    Some(channel) => channel.take(message),
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

    fn passed_over(&mut self) {
        // Reading the drive says how many there are.
    }

    fn mark(&mut self) {
        for channel in &mut self.channels {
            channel.mark = channel.log_ns.len();
        }
    }

    fn roll_back(&mut self) {
        for channel in &mut self.channels {
            channel.log_ns.truncate(channel.mark);
        }
    }
}

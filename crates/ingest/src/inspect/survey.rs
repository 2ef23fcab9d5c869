//! The channels of a recording: when their messages came and whether they can be decoded.

use super::{ChannelSummary, Gap};
use crate::raw::mcap::{
    channels::{Codec, Decoder, OwnedSchema, decoder},
    choice::Found,
    container::Visitor,
    metadata,
    record::{Channel, Message, Record},
};
use std::collections::BTreeMap;

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

#[derive(Debug, Default)]
pub(super) struct Survey {
    schemas: BTreeMap<u16, OwnedSchema>,
    pub(super) channels: BTreeMap<u16, Surveyed>,
    pub(super) writer: Option<String>,
    pub(super) drive: Option<BTreeMap<String, String>>,
    /// Messages whose channel was not known when they came.
    pub(super) undeclared: usize,
}

impl Survey {
    /// A new survey that knows the declarations that this one met.
    pub(super) fn knowing(self) -> Self {
        let channels = self.channels.into_iter().map(|(id, c)| {
            let schema = self.schemas.get(&c.channel.schema_id);
            (id, Surveyed::new(c.channel, schema))
        });
        Self {
            channels: channels.collect(),
            schemas: self.schemas,
            ..Self::default()
        }
    }
}

impl Visitor for Survey {
    fn record(&mut self, record: Record<'_>) {
        match record {
            Record::Other => {}
            Record::Header(_, library) => self.writer = Some(library),
            Record::Schema(schema) => {
                self.schemas
                    .entry(schema.id)
                    .or_insert_with(|| schema.into());
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id);
                self.channels
                    .entry(channel.id)
                    .or_insert_with(|| Surveyed::new(channel, schema));
            }
            Record::Message(message) => match self.channels.get_mut(&message.channel) {
                Some(channel) => channel.take(message),
                None => self.undeclared += 1,
            },
            Record::Metadata(metadata) => {
                if metadata.name == metadata::NAME {
                    self.drive = Some(metadata.values);
                }
            }
        }
    }

    fn mark(&mut self) {
        self.channels
            .values_mut()
            .for_each(|c| c.mark = c.log_ns.len());
    }

    fn roll_back(&mut self) {
        self.channels
            .values_mut()
            .for_each(|c| c.log_ns.truncate(c.mark));
    }
}

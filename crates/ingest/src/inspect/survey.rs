//! The channels of a recording: when their messages came and whether they can be decoded.

use super::{ChannelSummary, Gap};
use crate::raw::mcap::{channels::Times, samples::Samples};
use maveric_bag::{OwnedSchema, Stream};

/// Holes shorter than this many usual intervals between messages are jitter.
const GAP_INTERVALS: f64 = 5.0;
/// Holes shorter than this are bridged anyway, in s.
const GAP_S: f64 = 0.5;

/// Median interval between messages that did not come at one time, in s.
fn interval_s(log_ns: &[u64]) -> Option<f64> {
    let steps = log_ns.windows(2).map(|w| w[1].abs_diff(w[0]));
    let mut steps: Vec<u64> = steps.filter(|&d| d > 0).collect();
    steps.sort_unstable();
    steps.get(steps.len() / 2).map(|&d| d as f64 / 1e9)
}

/// The holes of a channel that comes at a rate, in s since `start_ns`.
pub(super) fn gaps(topic: &str, log_ns: &[u64], start_ns: u64) -> Vec<Gap> {
    let limit = (GAP_INTERVALS * interval_s(log_ns).unwrap_or(0.0)).max(GAP_S);
    let since = |ns: u64| ns.saturating_sub(start_ns) as f64 / 1e9;
    let wide = |w: &&[u64]| w[1].saturating_sub(w[0]) as f64 / 1e9 > limit;
    let gap = |w: &[u64]| Gap { topic: topic.to_owned(), from_s: since(w[0]), to_s: since(w[1]) };
    log_ns.windows(2).filter(wide).map(gap).collect()
}

/// What is said of a channel.
pub(super) fn summary(stream: &Stream<Samples>, times: &Times) -> ChannelSummary {
    let seconds = |ns: &u64| *ns as f64 / 1e9;
    let schema = stream.schema.as_ref();
    let of_schema = |text: fn(&OwnedSchema) -> &String| schema.map(text).cloned();
    ChannelSummary {
        topic: stream.channel.topic.clone(),
        type_name: of_schema(|s| &s.name).unwrap_or_default(),
        encoding: stream.channel.encoding.clone(),
        schema_encoding: of_schema(|s| &s.encoding).unwrap_or_default(),
        messages: times.log_ns.len(),
        rate_hz: interval_s(&times.log_ns).map(|s| 1.0 / s),
        first_s: times.log_ns.iter().min().map(seconds),
        last_s: times.log_ns.iter().max().map(seconds),
        decodable: times.whole.is_ok(),
        reason: times.whole.as_ref().err().cloned(),
    }
}

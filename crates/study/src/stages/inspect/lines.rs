//! What is in a file, in lines for people.

use super::Inspected;
use maveric_ingest::LogSummary;

fn number(value: Option<f64>, unit: &str) -> String {
    value.map_or_else(|| "-".to_owned(), |v| format!("{v:.2}{unit}"))
}

pub(super) fn lines(content: &Inspected) -> Vec<String> {
    match content {
        Inspected::Log(log) => log_lines(log),
        Inspected::Drive {
            meta,
            rate_hz,
            rows,
            duration_s,
            segments,
            lead_rows,
            following_rows,
            lane_changes,
            sees,
            provenance,
        } => vec![
            format!(
                "drive {} of {}, {}, {}",
                meta.drive,
                meta.participant,
                meta.condition,
                meta.driven_by.as_str()
            ),
            format!("{rows} rows at {rate_hz} Hz, {duration_s:.1} s, {segments} segments"),
            format!(
                "{lead_rows} rows with a reference vehicle, {following_rows} following, {lane_changes} lane changes"
            ),
            format!("the rig sees: {sees}"),
            match provenance.get("source") {
                Some(source) => format!("made from {source}"),
                None => "made here, from no log".to_owned(),
            },
        ],
        Inspected::Model { heads, embedding_size, parameters, drives, learned, aggression } => {
            vec![
                format!(
                    "model with {heads} heads, embeddings of size {embedding_size}, {parameters} parameters, trained on {drives} drives"
                ),
                format!(
                    "learned: {}; {} score",
                    learned.join(", "),
                    if *aggression { "reads a" } else { "reads no" }
                ),
            ]
        }
    }
}

/// A line whose names from elsewhere make no further lines.
pub(super) fn one_line(line: &str) -> String {
    line.replace('\n', "\\n").replace('\r', "\\r")
}

fn log_lines(log: &LogSummary) -> Vec<String> {
    let mut lines = vec![format!(
        "{:?}, {} messages or rows over {}",
        log.format,
        log.rows,
        number(log.duration_s, " s")
    )];
    for c in &log.channels {
        let why = c.reason.as_ref().map(|r| format!("  not decodable: {r}")).unwrap_or_default();
        lines.push(format!(
            "{:44} {:44} {:6} messages {:>9}{why}",
            c.topic,
            c.type_name,
            c.messages,
            number(c.rate_hz, " Hz")
        ));
    }
    for c in &log.columns {
        lines.push(format!(
            "{:28} {:13} {:>7} filled {:>14} to {:<14} {}",
            c.name,
            c.kind,
            c.filled,
            number(c.least, ""),
            number(c.greatest, ""),
            c.meaning.as_deref().unwrap_or("not used")
        ));
    }
    lines.extend(
        log.gaps.iter().map(|g| format!("gap on {}: {:.2} to {:.2} s", g.topic, g.from_s, g.to_s)),
    );
    lines.extend(log.warnings.iter().map(|w| match w.count {
        1 => format!("note: {}", w.what),
        count => format!("note: {} ({count} times)", w.what),
    }));
    lines.extend(log.damage.iter().map(|d| format!("damage: {}", d.what)));
    lines.push(format!("would ingest: {}", log.would_ingest));
    lines
}

//! Memory: what a file claims is not allocated, and a long recording takes no more than its samples.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod generated;

use maveric_ingest::{IngestSettings, Mapping, read_log};
use peak_alloc::PeakAlloc;
use std::path::Path;

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

const MIB: f64 = 1024.0 * 1024.0;

/// Peak of memory while a log is read, beyond what was in use before, in MiB.
fn peak_mib(bytes: &[u8]) -> f64 {
    peak_of(bytes, None)
}

fn peak_of(bytes: &[u8], mapping: Option<&str>) -> f64 {
    let file = tempfile::Builder::new().suffix(".mcap").tempfile().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    let settings = IngestSettings {
        recover: true,
        mapping: mapping.map(|text| Mapping::from_toml(text, Path::new("m.toml")).unwrap()),
        ..IngestSettings::default()
    };
    let before = PEAK.current_usage();
    PEAK.reset_peak_usage();
    let _ = read_log(file.path(), &settings);
    (PEAK.peak_usage() as f64 - before as f64) / MIB
}

/// One test, because the peak is the whole program's.
#[test]
fn memory_follows_what_a_file_holds_and_not_what_it_claims() {
    let log = generated::log(1.0, 4);
    assert!(log.len() < 1 << 20);
    let whole = peak_mib(&log);
    assert!(whole < 20.0, "{whole} MiB");

    // A length of 2⁶² anywhere in the first and last kilobytes.
    let places = (8..1200).chain(log.len() - 1200..log.len() - 8);
    for at in places.step_by(71) {
        let mut bytes = log.clone();
        bytes[at..at + 8].copy_from_slice(&(1_u64 << 62).to_le_bytes());
        let peak = peak_mib(&bytes);
        assert!(peak < 64.0, "{peak} MiB with a huge length at {at}");
    }

    // A chunk that unpacks to far more than it is: 128 MiB of zeros.
    let zeros = zstd::bulk::compress(&vec![0; 128 << 20], 3).unwrap();
    let mut bomb = log[..8].to_vec();
    let mut chunk = vec![0; 16];
    chunk.extend((128_u64 << 20).to_le_bytes());
    chunk.extend([0; 4]);
    chunk.extend(4_u32.to_le_bytes());
    chunk.extend(b"zstd");
    chunk.extend((zeros.len() as u64).to_le_bytes());
    chunk.extend(zeros);
    bomb.push(6);
    bomb.extend((chunk.len() as u64).to_le_bytes());
    bomb.extend(chunk);
    let peak = peak_mib(&bomb);
    assert!(peak < 64.0, "{peak} MiB for a bomb");

    // What does not belong to the drive costs nothing, however long the recording is.
    // How far the thread that unpacks is ahead changes from reading to reading.
    let peaks = |minutes: f64| [0; 4].map(|_| peak_mib(&generated::log(minutes, 0)));
    let short = peaks(2.0).into_iter().fold(0.0, f64::max);
    let long = peaks(5.0).into_iter().fold(f64::INFINITY, f64::min);
    let samples = 3.0 * 60.0 * 50.0 * 600.0 / MIB;
    assert!(long - short < samples, "{short} and {long} MiB");

    // Channels share their schema and what is made of it, and a message gives no more rows than any rig sees.
    let text = format!("float64 x\n# {}\n", "x".repeat(4 << 20));
    let mut out = mcap::Writer::new(std::io::Cursor::new(Vec::new())).unwrap();
    let schema = out.add_schema("lab/msg/X", "ros2msg", text.as_bytes()).unwrap();
    let none = std::collections::BTreeMap::new();
    for i in 0..500 {
        out.add_channel(schema, &format!("/{i}"), "cdr", &none).unwrap();
    }
    let objects = out.add_schema("lab.Objects", "jsonschema", b"{}").unwrap();
    let channel_id = out.add_channel(objects, "/objects", "json", &none).unwrap();
    let head =
        mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 1, publish_time: 1 };
    let many = format!("{{\"cars\":[{}0]}}", "0,".repeat(8 << 20));
    out.write_to_known_channel(&head, many.as_bytes()).unwrap();
    out.finish().unwrap();
    let mapping = "[mcap]\n[[mcap.messages]]\ntype = \"lab.Objects\"\ntells = \"objects\"\nfields = { x = \"cars[].x\", y = \"cars[].y\", id = \"cars[].id\", speed = \"cars[].v\" }\n";
    let peak = peak_of(&out.into_inner().into_inner(), Some(mapping));
    assert!(peak < 160.0, "{peak} MiB for shared schemas and many rows");
}

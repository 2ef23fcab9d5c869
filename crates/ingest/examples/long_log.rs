//! Writes a log as large as asked and reads its drive: `long_log GIGABYTES [FILE]`; says how long that took and how much memory.
//!
//! Ego and eight others at 20 Hz among pictures of a quarter of a megabyte that nothing can pack; the file goes at the end.
#![expect(clippy::print_stdout, reason = "an example shows its result")]
#![expect(clippy::unwrap_used, reason = "an example stops at the first surprise")]

#[path = "../tests/generated/mod.rs"]
mod generated;

use maveric_bag::Writer;
use maveric_ingest::{IngestSettings, read_log};
use peak_alloc::PeakAlloc;
use std::{fs::File, path::PathBuf, time::Instant};

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

/// Bytes of a picture.
const PICTURE: usize = 256 << 10;

fn main() {
    let mut words = std::env::args().skip(1);
    let gigabytes: f64 = words.next().and_then(|w| w.parse().ok()).unwrap_or(0.1);
    let path = words.next().map_or_else(|| std::env::temp_dir().join("long.mcap"), PathBuf::from);
    let frames = (gigabytes * 1e9 / PICTURE as f64) as u32;

    let started = Instant::now();
    let mut bag = Writer::new(File::create(&path).unwrap(), "example").unwrap();
    let minute = generated::log(1.0, 8);
    let messages: Vec<mcap::Message<'_>> =
        mcap::MessageStream::new(&minute).unwrap().map(Result::unwrap).collect();
    let mut channels = std::collections::BTreeMap::new();
    for message in &messages {
        channels.entry(message.channel.id).or_insert_with(|| {
            let schema = message.channel.schema.as_ref().unwrap();
            let schema = (&*schema.name, &*schema.encoding, &*schema.data);
            bag.channel(&message.channel.topic, &message.channel.message_encoding, schema).unwrap()
        });
    }
    let camera = bag.channel("/camera", "x-raw", ("x/Raw", "x-raw", "")).unwrap();
    // The minute goes by slower: as many messages of it as there are pictures.
    let mut noise: u64 = 1;
    let mut picture = vec![0; PICTURE];
    for frame in 0..frames {
        for bytes in picture.chunks_exact_mut(8) {
            noise ^= noise << 13;
            noise ^= noise >> 7;
            noise ^= noise << 17;
            bytes.copy_from_slice(&noise.to_le_bytes());
        }
        let message = &messages[frame as usize * messages.len() / frames as usize];
        bag.message(camera, frame, message.log_time, &picture).unwrap();
        let first = frame as usize * messages.len() / frames as usize;
        let last = (frame as usize + 1) * messages.len() / frames as usize;
        for message in &messages[first..last] {
            let channel = channels[&message.channel.id];
            bag.message(channel, message.sequence, message.log_time, &message.data).unwrap();
        }
    }
    bag.finish().unwrap().sync_all().unwrap();
    let written = std::fs::metadata(&path).unwrap().len();
    println!("written: {written} bytes in {:.1} s", started.elapsed().as_secs_f64());

    PEAK.reset_peak_usage();
    let before = PEAK.current_usage();
    let started = Instant::now();
    let log = read_log(&path, &IngestSettings::default()).unwrap().remove(0);
    let peak = PEAK.peak_usage() - before;
    println!(
        "read: {} rows, {} tracks in {:.1} s, at most {:.1} MB at once; blake3 {}",
        log.recording.rows(),
        log.recording.others().len(),
        started.elapsed().as_secs_f64(),
        peak as f64 / 1e6,
        log.sources[0].blake3
    );
    std::fs::remove_file(&path).unwrap();
}

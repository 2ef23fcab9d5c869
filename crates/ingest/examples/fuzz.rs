//! Damages recordings at random and reads them, for as many seconds as asked: `fuzz TARGET SECONDS SEED`.
//!
//! `mcap` damages whole files, `msg` the message definitions in them, `cdr` the messages. Nothing may panic, give a number
//! that is none, or take more than 64 MiB for an input of at most 1 MiB. A failing input is written beside.
#![expect(clippy::print_stdout, reason = "an example shows its result")]
#![expect(clippy::unwrap_used, reason = "what cannot be made cannot be fuzzed")]

#[path = "../tests/generated/mod.rs"]
mod generated;

use maveric_ingest::{IngestSettings, inspect, read_log};
use mcap::{Compression, MessageStream, Schema, WriteOptions};
use peak_alloc::PeakAlloc;
use std::{
    borrow::Cow,
    io::Cursor,
    sync::Arc,
    time::{Duration, Instant},
};

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

const MOST_BYTES: usize = 64 << 20;

/// Numbers from a seed (SplitMix64), so that a run can be repeated.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    /// Changes some bytes: a flip, a run, a great number, a piece cut out, copied or put elsewhere.
    fn damage(&mut self, bytes: &mut Vec<u8>) {
        for _ in 0..=self.below(4) {
            let at = self.below(bytes.len());
            let n = (1 + self.below(64)).min(bytes.len() - at);
            match self.below(7) {
                0 => bytes[at] ^= 1 << self.below(8),
                1 => bytes[at..at + n].fill(self.next() as u8),
                2 => {
                    let great = [u64::MAX, 1 << 62, 1 << 31, 0xffff_ffff, 0][self.below(5)];
                    let n = n.min(8);
                    bytes[at..at + n].copy_from_slice(&great.to_le_bytes()[..n]);
                }
                3 => {
                    bytes.drain(at..at + n);
                }
                4 => {
                    let copy = bytes[at..at + n].to_vec();
                    let to = self.below(bytes.len());
                    bytes.splice(to..to, copy);
                }
                5 => bytes.truncate(at.max(1)),
                _ => bytes[at] = self.next() as u8,
            }
            if bytes.is_empty() {
                bytes.push(0);
            }
        }
    }
}

/// A log with its definitions or its messages damaged; the container around them is whole.
fn within(log: &[u8], chance: &mut Chance, definitions: bool) -> Vec<u8> {
    let options = WriteOptions::new().compression(None).use_chunks(false);
    let mut out = options.create(Cursor::new(Vec::new())).unwrap();
    let damaged_first = chance.below(2) == 0;
    let mut text: [Option<Arc<Schema<'_>>>; 2] = [None, None];
    for message in MessageStream::new(log).unwrap() {
        let mut message = message.unwrap();
        let which = usize::from(message.channel.topic.ends_with("objects"));
        if definitions {
            let changed = text[which].get_or_insert_with(|| {
                let mut schema = (**message.channel.schema.as_ref().unwrap()).clone();
                if damaged_first == (which == 0) {
                    chance.damage(schema.data.to_mut());
                }
                Arc::new(schema)
            });
            let mut channel = (*message.channel).clone();
            channel.schema = Some(changed.clone());
            message.channel = channel.into();
        } else if chance.below(4) == 0 {
            let mut data = message.data.to_vec();
            chance.damage(&mut data);
            message.data = Cow::Owned(data);
        }
        out.write(&message).unwrap();
    }
    out.finish().unwrap();
    out.into_inner().into_inner()
}

fn main() {
    let mut words = std::env::args().skip(1);
    let target = words.next().unwrap_or_else(|| "mcap".to_owned());
    let seconds = words.next().and_then(|w| w.parse().ok()).unwrap_or(10);
    let seed: u64 = words.next().and_then(|w| w.parse().ok()).unwrap_or(1);
    let mut chance = Chance(seed);
    let short = generated::log(0.05, 3);
    let plain = {
        let mut out = WriteOptions::new()
            .compression(None)
            .create(Cursor::new(Vec::new()))
            .unwrap();
        for message in MessageStream::new(&short).unwrap() {
            out.write(&message.unwrap()).unwrap();
        }
        out.finish().unwrap();
        out.into_inner().into_inner()
    };
    let small = {
        let options = WriteOptions::new()
            .compression(Some(Compression::Lz4))
            .chunk_size(Some(8192));
        let mut out = options.create(Cursor::new(Vec::new())).unwrap();
        for message in MessageStream::new(&short).unwrap() {
            out.write(&message.unwrap()).unwrap();
        }
        out.finish().unwrap();
        out.into_inner().into_inner()
    };
    let path =
        std::env::temp_dir().join(format!("maveric-fuzz-{target}-{}.mcap", std::process::id()));
    let end = Instant::now() + Duration::from_secs(seconds);
    let (mut runs, mut drives, mut most) = (0_u64, 0_u64, 0);
    while Instant::now() < end {
        let bytes = match target.as_str() {
            "msg" => within(&short, &mut chance, true),
            "cdr" => within(&short, &mut chance, false),
            _ => {
                let mut bytes = [&short, &plain, &small][chance.below(3)].clone();
                chance.damage(&mut bytes);
                bytes
            }
        };
        assert!(bytes.len() <= 1 << 20);
        std::fs::write(&path, &bytes).unwrap();
        let settings = IngestSettings {
            recover: chance.below(4) > 0,
            ..IngestSettings::default()
        };
        let before = PEAK.current_usage();
        PEAK.reset_peak_usage();
        let found = read_log(&path, &settings);
        if runs.is_multiple_of(8) {
            let _ = inspect(&path);
        }
        let peak = PEAK.peak_usage() - before;
        most = most.max(peak);
        assert!(peak <= MOST_BYTES, "{peak} bytes for {}", path.display());
        for drive in found.into_iter().flatten() {
            drives += 1;
            let ego = drive.recording.ego();
            let mut all = ego.x_m.iter().chain(&ego.y_m).chain(&ego.speed_mps);
            assert!(all.all(|v| v.is_finite()), "{}", path.display());
        }
        runs += 1;
    }
    let _ = std::fs::remove_file(&path);
    println!("{target}: {runs} inputs, {drives} drives, at most {most} bytes at once");
}

//! Damages logs at random and reads them, for as many seconds as asked: `fuzz TARGET SECONDS SEED [FOLDER]`.
//!
//! `mcap` damages whole files (also those of FOLDER), `msg` the message definitions in them, `cdr` the messages, `csv`
//! tables and their mappings. Nothing may panic, give a number that is none, or take more than 64 MiB for an input of at
//! most 1 MiB. A failing input stays in the folder for temporary files.
#![expect(clippy::print_stdout, reason = "an example shows its result")]
#![expect(clippy::unwrap_used, reason = "what cannot be made cannot be fuzzed")]

#[path = "../../bag/examples/support/chance.rs"]
mod chance;
#[path = "../tests/generated/mod.rs"]
mod generated;
#[path = "../tests/generated/tables.rs"]
mod tables;

use chance::Chance;
use maveric_ingest::{IngestSettings, Mapping, inspect_with, read_log, suggest_mapping};
use mcap::{Compression, MessageStream, Schema, WriteOptions};
use peak_alloc::PeakAlloc;
use std::{
    borrow::Cow,
    collections::BTreeMap,
    io::Cursor,
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, Instant},
};

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

const MOST_BYTES: usize = 64 << 20;

/// What definitions trip over.
const DEFINITION_WORDS: [&str; 24] = [
    "[]",
    "[<=3]",
    "[3]",
    "[0]",
    "[18446744073709551615]",
    "[4294967295]",
    "<=5",
    "float64 ",
    "float64[] ",
    "wstring ",
    "string<=8[<=2] ",
    "time ",
    "Header ",
    "/msg/",
    "\n",
    "# ",
    "=1\n",
    " 1.5\n",
    "\nMSG: nav_msgs/Odometry\n",
    "\n================================================================================\n",
    "nav_msgs/Odometry[] o\n",
    "IDL: ",
    "\0",
    "é",
];
/// How channels and their schemas may be encoded.
const ENCODINGS: [(&str, &str); 6] = [
    ("cdr", "ros2msg"),
    ("ros1", "ros1msg"),
    ("json", "jsonschema"),
    ("protobuf", "protobuf"),
    ("cdr", "ros2idl"),
    ("", ""),
];

impl Chance {
    /// Changes some bytes: a flip, a run, a great number, a piece cut out, copied or put elsewhere, a word.
    fn damage(&mut self, bytes: &mut Vec<u8>, words: &[&str]) {
        for _ in 0..=self.below(4) {
            let start = self.below(bytes.len());
            let n = (1 + self.below(64)).min(bytes.len() - start);
            match self.below(8) {
                0 => bytes[start] ^= 1 << self.below(8),
                1 => bytes[start..start + n].fill(self.next() as u8),
                2 => {
                    let great = [u64::MAX, 1 << 62, 1 << 31, 0xffff_ffff, 0][self.below(5)];
                    let n = n.min(8);
                    bytes[start..start + n].copy_from_slice(&great.to_le_bytes()[..n]);
                }
                3 => {
                    bytes.drain(start..start + n);
                }
                4 => {
                    let copy = bytes[start..start + n].to_vec();
                    let to = self.below(bytes.len());
                    bytes.splice(to..to, copy);
                }
                5 if self.below(4) == 0 => bytes.truncate(start.max(1)),
                6 if !words.is_empty() => {
                    let word = words[self.below(words.len())];
                    let end = start + self.below(2) * n.min(8);
                    bytes.splice(start..end, word.bytes());
                }
                _ => bytes[start] = self.next() as u8,
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
    let encoding = ENCODINGS[chance.below(4 * ENCODINGS.len()) % ENCODINGS.len()];
    let encoding = (chance.below(4) == 0).then_some(encoding);
    let mut channels = BTreeMap::new();
    for message in MessageStream::new(log).unwrap() {
        let mut message = message.unwrap();
        let which = usize::from(message.channel.topic.ends_with("objects"));
        let of_message = message.channel.clone();
        let changed = channels.entry(which).or_insert_with(|| {
            let mut schema: Schema<'_> = (**of_message.schema.as_ref().unwrap()).clone();
            if definitions && damaged_first == (which == 0) {
                chance.damage(schema.data.to_mut(), &DEFINITION_WORDS);
            }
            let mut channel = (*of_message).clone();
            if let Some((messages, of_schema)) = encoding {
                (channel.message_encoding, schema.encoding) = (messages.into(), of_schema.into());
            }
            channel.schema = Some(Arc::new(schema));
            Arc::new(channel)
        });
        message.channel = changed.clone();
        if !definitions && chance.below(4) == 0 {
            let mut data = message.data.to_vec();
            if chance.below(4) == 0 {
                // Another encapsulation: XCDR2, delimited, big-endian.
                data[1] = [0, 6, 7, 8, 9, 0x10, 0x15][chance.below(7)];
            }
            chance.damage(&mut data, &[]);
            message.data = Cow::Owned(data);
        }
        out.write(&message).unwrap();
    }
    out.finish().unwrap();
    out.into_inner().into_inner()
}

fn repacked(log: &[u8], options: WriteOptions) -> Vec<u8> {
    let mut out = options.create(Cursor::new(Vec::new())).unwrap();
    for message in MessageStream::new(log).unwrap() {
        out.write(&message.unwrap()).unwrap();
    }
    out.finish().unwrap();
    out.into_inner().into_inner()
}

/// Whole logs to damage.
fn seeds(short: &[u8], folder: Option<PathBuf>) -> Vec<Vec<u8>> {
    let lz4 = WriteOptions::new().compression(Some(Compression::Lz4));
    let mut seeds = vec![
        short.to_vec(),
        repacked(short, WriteOptions::new().compression(None)),
        repacked(short, lz4.chunk_size(Some(8192))),
    ];
    let entries = folder.into_iter().flat_map(|f| std::fs::read_dir(f).unwrap());
    let mut files: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    files.sort();
    let read = files.iter().map(|f| std::fs::read(f).unwrap());
    seeds.extend(read.filter(|bytes| bytes.len() < 1 << 19 && !bytes.is_empty()));
    seeds
}

/// What to read and by which mapping.
struct Input {
    bytes: Vec<u8>,
    name: String,
    mapping: Option<Mapping>,
}

fn table(chance: &mut Chance) -> Input {
    let which = chance.below(tables::MAPPINGS.len());
    let (mapping, name) = tables::MAPPINGS[which];
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
    let mut toml = std::fs::read(shipped.join(mapping)).unwrap();
    if chance.below(4) == 0 {
        chance.damage(&mut toml, &tables::WORDS);
    }
    let most = if chance.below(8) == 0 { 4000 } else { 60 };
    let rows = 2 + chance.below(most);
    let mut bytes = tables::table(which, rows as u32).into_bytes();
    chance.damage(&mut bytes, &tables::WORDS);
    Input {
        bytes,
        name: name.to_owned(),
        mapping: Mapping::from_toml(&String::from_utf8_lossy(&toml), Path::new("m.toml")).ok(),
    }
}

fn main() {
    let mut words = std::env::args().skip(1);
    let target = words.next().unwrap_or_else(|| "mcap".to_owned());
    let seconds = words.next().and_then(|w| w.parse().ok()).unwrap_or(10);
    let seed: u64 = words.next().and_then(|w| w.parse().ok()).unwrap_or(1);
    let mut chance = Chance(seed);
    let short = generated::log(0.02, 3);
    let seeds = seeds(&short, words.next().map(PathBuf::from));
    let folder = std::env::temp_dir().join(format!("maveric-fuzz-{target}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let end = Instant::now() + Duration::from_secs(seconds);
    let (mut runs, mut drives, mut most) = (0_u64, 0_u64, 0);
    while Instant::now() < end {
        let of_log = |bytes| Input { bytes, name: "input.mcap".to_owned(), mapping: None };
        let input = match target.as_str() {
            "msg" => of_log(within(&short, &mut chance, true)),
            "cdr" => of_log(within(&short, &mut chance, false)),
            "csv" => table(&mut chance),
            _ => {
                let mut bytes = seeds[chance.below(seeds.len())].clone();
                chance.damage(&mut bytes, &[]);
                of_log(bytes)
            }
        };
        assert!(input.bytes.len() <= 1 << 20);
        let path = folder.join(&input.name);
        std::fs::write(&path, &input.bytes).unwrap();
        let settings = IngestSettings {
            recover: chance.below(4) > 0,
            // A rate that a mapping asks for may cost what it costs.
            rate_hz: Some(20.0),
            mapping: input.mapping,
            ..IngestSettings::default()
        };
        let before = PEAK.current_usage();
        PEAK.reset_peak_usage();
        let logs = read_log(&path, &settings);
        if runs.is_multiple_of(8) {
            let _ = inspect_with(&path, &settings);
            let _ = suggest_mapping(&path);
        }
        let peak = PEAK.peak_usage().saturating_sub(before);
        most = most.max(peak);
        assert!(peak <= MOST_BYTES, "{peak} bytes for {}", path.display());
        for drive in logs.into_iter().flatten() {
            drives += 1;
            let ego = drive.recording.ego();
            let mut values = ego.x_m.iter().chain(&ego.y_m).chain(&ego.speed_mps);
            assert!(values.all(|v| v.is_finite()), "{}", path.display());
        }
        runs += 1;
        std::fs::remove_file(&path).unwrap();
    }
    let _ = std::fs::remove_dir_all(&folder);
    println!(
        "{target}, seed {seed}: {runs} inputs in {seconds} s, {drives} drives, at most {most} bytes at once"
    );
}

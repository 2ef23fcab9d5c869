//! Damages recordings at random and reads fields of them, for as many seconds as asked: `fuzz TARGET SECONDS SEED`.
//!
//! `json` and `protobuf` damage messages (and descriptors), `share` a recording of many channels that share schemas, in the
//! midst of its declarations. Nothing may panic, or take more than 64 MiB for an input of at most
//! 1 MiB. A failing input stays in the folder for temporary files.
#![expect(clippy::print_stdout, reason = "an example shows its result")]
#![expect(clippy::unwrap_used, reason = "what cannot be made cannot be fuzzed")]

#[path = "support/chance.rs"]
mod chance;

use chance::Chance;
use maveric_bag::{Channel, Codec, Message, OwnedSchema, Take, Walk, Writer, read_streams};
use peak_alloc::PeakAlloc;
use prost_reflect::prost::Message as _;
use prost_reflect::prost_types::{
    DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet,
    field_descriptor_proto::{Label, Type},
};
use std::{
    io::Cursor,
    time::{Duration, Instant},
};

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

const MOST_BYTES: usize = 64 << 20;

/// What texts and numbers trip over.
const WORDS: [&str; 18] = [
    "{",
    "}",
    "[",
    "]",
    ",",
    ":",
    "\"",
    "\\u",
    "[[[[[[[[",
    "{\"cars\":",
    "null",
    "true",
    "1e999",
    "-0",
    "NaN",
    "\"v\":3",
    "0,",
    "\u{feff}",
];

impl Chance {
    /// Changes some bytes: a flip, a great number, a piece cut out, copied or repeated, a word.
    fn damage(&mut self, bytes: &mut Vec<u8>) {
        for _ in 0..=self.below(4) {
            if bytes.is_empty() {
                bytes.push(0);
            }
            let start = self.below(bytes.len());
            let n = (1 + self.below(64)).min(bytes.len() - start);
            match self.below(7) {
                0 => bytes[start] ^= 1 << self.below(8),
                1 => {
                    let great = [u64::MAX, 1 << 62, 1 << 31, 0xffff_ffff, 0][self.below(5)];
                    let n = n.min(8);
                    bytes[start..start + n].copy_from_slice(&great.to_le_bytes()[..n]);
                }
                2 => drop(bytes.drain(start..start + n)),
                3 => {
                    let copy = bytes[start..start + n].repeat(1 + self.below(400));
                    let to = self.below(bytes.len());
                    bytes.splice(to..to, copy);
                }
                4 => bytes[start..start + n].fill(self.next() as u8),
                _ => {
                    let word = WORDS[self.below(WORDS.len())].repeat(1 + self.below(3));
                    bytes.splice(start..start, word.bytes());
                }
            }
        }
    }
}

fn descriptors() -> Vec<u8> {
    let field = |name: &str, number, ty: Type, of: Option<&str>, list: bool| FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        r#type: Some(ty as i32),
        type_name: of.map(str::to_owned),
        label: Some(if list { Label::Repeated } else { Label::Optional } as i32),
        ..FieldDescriptorProto::default()
    };
    let message = |name: &str, field| DescriptorProto {
        name: Some(name.to_owned()),
        field,
        ..DescriptorProto::default()
    };
    let car = vec![
        field("id", 1, Type::Sint32, None, false),
        field("v", 2, Type::Double, None, false),
        field("size", 3, Type::Double, None, true),
        field("name", 4, Type::String, None, false),
        field("car", 5, Type::Message, Some(".p.Car"), false),
    ];
    let scene = vec![
        field("cars", 1, Type::Message, Some(".p.Car"), true),
        field("speed", 2, Type::Float, None, false),
    ];
    let file = FileDescriptorProto {
        name: Some("p.proto".to_owned()),
        package: Some("p".to_owned()),
        message_type: vec![message("Car", car), message("Scene", scene)],
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    FileDescriptorSet { file: vec![file] }.encode_to_vec()
}

fn protobuf_message(i: u8) -> Vec<u8> {
    let mut car = vec![0x08, i, 0x11];
    car.extend(f64::from(i).to_le_bytes());
    car.extend([0x1a, 16]);
    car.extend([0; 16]);
    car.extend([0x22, 1, b'x', 0x2a, 2, 0x08, 7]);
    let mut scene = vec![0x15];
    scene.extend(2.5_f32.to_le_bytes());
    for _ in 0..2 {
        scene.extend([0x0a, car.len() as u8]);
        scene.extend(&car);
    }
    scene
}

/// A recording of one channel whose messages, and sometimes whose schema, are damaged.
fn recording(chance: &mut Chance, protobuf: bool) -> Vec<u8> {
    let mut bag = Writer::new(Cursor::new(Vec::new()), "fuzz").unwrap();
    let (encoding, name, of, mut schema) = if protobuf {
        ("protobuf", "p.Scene", "protobuf", descriptors())
    } else {
        ("json", "lab.Scene", "jsonschema", b"{}".to_vec())
    };
    if chance.below(8) == 0 {
        chance.damage(&mut schema);
    }
    let channel = bag.channel("/t", encoding, (name, of, &schema)).unwrap();
    for i in 0..8 {
        let mut message = if protobuf {
            protobuf_message(i)
        } else {
            let cars = format!(
                "{{\"id\":{i},\"v\":1.5,\"size\":[1,2],\"name\":\"x\",\"car\":{{\"id\":7}}}}"
            );
            format!("{{\"speed\":2.5,\"cars\":[{cars},{cars}]}}").into_bytes()
        };
        if chance.below(2) == 0 {
            chance.damage(&mut message);
        }
        message.truncate(1 << 16);
        bag.message(channel, u32::from(i), u64::from(i), &message).unwrap();
    }
    bag.finish().unwrap().into_inner()
}

/// Many channels of few, large schemas, some bytes of it all damaged.
fn shared(chance: &mut Chance) -> Vec<u8> {
    let mut bag = Writer::new(Cursor::new(Vec::new()), "fuzz").unwrap();
    let texts: Vec<String> = (0..3)
        .map(|i| format!("float64 x\n# {}\n", i.to_string().repeat(1 << chance.below(17))))
        .collect();
    for i in 0..chance.below(300) {
        let text = &texts[chance.below(3)];
        let topic = if chance.below(9) == 0 { "/t".to_owned() } else { format!("/{i}") };
        let channel = bag.channel(&topic, "cdr", ("lab/msg/X", "ros2msg", text)).unwrap();
        let mut message = vec![0, 1, 0, 0];
        message.extend(1.5_f64.to_le_bytes());
        bag.message(channel, i as u32, i as u64, &message).unwrap();
    }
    let mut bytes = bag.finish().unwrap().into_inner();
    chance.damage(&mut bytes);
    bytes.truncate(1 << 20);
    bytes
}

/// Reads fields of the messages of one stream.
#[derive(Default)]
struct Fields {
    codec: Option<Codec>,
    row: Vec<f64>,
    numbers: u64,
}

impl Fields {
    /// Of the topic of each of `fields`, the path in its messages is decoded.
    fn of(fields: &[&str], channel: &Channel, schema: Option<&OwnedSchema>) -> Self {
        let paths: Vec<&str> = fields
            .iter()
            .filter_map(|field| field.strip_prefix(channel.topic.as_str())?.strip_prefix('.'))
            .collect();
        Self { codec: Codec::compile(channel, schema, &paths).ok(), ..Self::default() }
    }
}

impl Take for Fields {
    fn take(&mut self, message: Message<'_>, _: u32) {
        let Some(codec) = &self.codec else { return };
        let mut numbers = 0;
        let mut count = |row: &[f64]| numbers += row.len() as u64;
        // A message that does not fit is none.
        if codec.run(message.data, &mut self.row, &mut count).is_ok() {
            self.numbers += numbers + self.row.len() as u64;
        }
    }

    fn mark(&mut self) {}

    fn roll_back(&mut self) {}
}

fn main() {
    let mut words = std::env::args().skip(1);
    let target = words.next().unwrap_or_else(|| "json".to_owned());
    let seconds = words.next().and_then(|w| w.parse().ok()).unwrap_or(10);
    let seed: u64 = words.next().and_then(|w| w.parse().ok()).unwrap_or(1);
    let mut chance = Chance(seed);
    let fields: &[&str] = match target.as_str() {
        "share" => &["/t.x", "/1.x", "/2.x"],
        _ => &[
            "/t.speed?",
            "/t.cars[].id?",
            "/t.cars[].v?",
            "/t.cars[].size[1]?",
            "/t.cars[].name#?",
            "/t.cars[].car.id?",
        ],
    };
    let kept =
        std::env::temp_dir().join(format!("maveric-bag-fuzz-{target}-{}", std::process::id()));
    let end = Instant::now() + Duration::from_secs(seconds);
    let (mut runs, mut numbers, mut most) = (0_u64, 0_u64, 0);
    while Instant::now() < end {
        let input = match target.as_str() {
            "share" => shared(&mut chance),
            "protobuf" => recording(&mut chance, true),
            _ => recording(&mut chance, false),
        };
        std::fs::write(&kept, &input).unwrap();
        let how = Walk { recover: chance.below(4) > 0, ..Walk::default() };
        let before = PEAK.current_usage();
        PEAK.reset_peak_usage();
        let read = read_streams(std::slice::from_ref(&kept), how, |channel, schema| {
            Fields::of(fields, channel, schema)
        });
        let peak = PEAK.peak_usage().saturating_sub(before);
        most = most.max(peak);
        assert!(peak <= MOST_BYTES, "{peak} bytes for {}", kept.display());
        let streams = read.into_iter().flat_map(|read| read.streams);
        numbers += streams.map(|s| s.taken.numbers).sum::<u64>();
        runs += 1;
    }
    let _ = std::fs::remove_file(&kept);
    println!(
        "{target}, seed {seed}: {runs} inputs in {seconds} s, {numbers} numbers, at most {most} bytes at once"
    );
}

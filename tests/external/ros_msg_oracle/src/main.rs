//! The program's reading of ROS 2 messages against that of `re_ros_msg`, on definitions and messages made at random and on real
//! ones.
//!
//!     cargo run --release --manifest-path tests/external/ros_msg_oracle/Cargo.toml -- CASES [FOLDER OF MCAP FILES]
//!
//! A project of its own: as a dependency of the tests `re_ros_msg` would have polars built with other features. The reader is
//! the source of `maveric-bag` itself.

// The reader of `maveric-bag`, from its own source.
#[allow(dead_code, reason = "a part of the reader is used here")]
#[path = "../../../../crates/bag/src/ros2/mod.rs"]
mod ros2;
#[allow(dead_code, reason = "a part of the reader is used here")]
#[path = "../../../../crates/bag/src/wanted.rs"]
mod wanted;

use ros2::{
    definition::{Dialect, parse},
    plan::Plan,
};
use re_cdr::{BigEndian, CdrEndian, CdrReader, CdrWriter, LittleEndian};
use re_ros_msg::{
    MessageSchema,
    deserialize::{MapResolver, Value, decode_message, primitive_array::PrimitiveArray},
    message_spec::MessageSpecification,
};
use std::{collections::BTreeMap, fmt::Write as _, path::Path};

/// Numbers from a seed (SplitMix64).
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
        (self.next() % n as u64) as usize
    }
}

const NUMBERS: [&str; 13] = [
    "bool", "byte", "char", "uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64",
    "int64", "float32", "float64",
];

/// A field of a made-up message.
#[derive(Debug, Clone)]
struct Made {
    name: String,
    /// Of `NUMBERS`, then a string, a bounded string, and the messages before this one.
    kind: usize,
    count: Count,
}

#[derive(Debug, Clone, Copy)]
enum Count {
    One,
    Fixed(usize),
    Any,
    Bounded(usize),
}

const STRING: usize = NUMBERS.len();
const BOUNDED_STRING: usize = STRING + 1;
const MESSAGES: usize = STRING + 2;
/// How the messages that others are made of are called, in their headings and where they are used.
const NAMES: [(&str, &str); 3] = [("p/C", "C"), ("p/msg/B", "p/B"), ("p/msg/A", "p/A")];

/// Fields of a message that may hold the first `known` of the others.
fn made(chance: &mut Chance, known: usize) -> Vec<Made> {
    let n = 1 + chance.below(5);
    (0..n)
        .map(|i| Made {
            name: format!("f{i}"),
            kind: chance.below(MESSAGES + 3 * known),
            count: match chance.below(8) {
                0 => Count::Fixed(1 + chance.below(3)),
                1 => Count::Any,
                2 => Count::Bounded(3),
                _ => Count::One,
            },
        })
        .map(|m| Made {
            kind: if m.kind < MESSAGES {
                m.kind
            } else {
                MESSAGES + (m.kind - MESSAGES) % known
            },
            ..m
        })
        .collect()
}

/// The text of a message, with constants, defaults and comments strewn in.
fn text(fields: &[Made], chance: &mut Chance) -> String {
    let mut text = String::new();
    for field in fields {
        let base = match field.kind {
            STRING => "string".to_owned(),
            BOUNDED_STRING => "string<=9".to_owned(),
            kind if kind < STRING => NUMBERS[kind].to_owned(),
            kind => NAMES[kind - MESSAGES].1.to_owned(),
        };
        let count = match field.count {
            Count::One => String::new(),
            Count::Fixed(n) => format!("[{n}]"),
            Count::Any => "[]".to_owned(),
            Count::Bounded(n) => format!("[<={n}]"),
        };
        let number = (1..STRING).contains(&field.kind) && matches!(field.count, Count::One);
        let rest = match chance.below(5) {
            0 => "  # a comment = 3",
            1 if number => " 1",
            _ => "",
        };
        writeln!(text, "{base}{count} {}{rest}", field.name).unwrap();
        if chance.below(6) == 0 {
            text.push_str("\n# another\nint32 LIMIT=5\nuint8 OTHER = 7\n");
        }
    }
    text
}

/// Writes a value of a field, whose numbers are small or as the bytes fall.
fn write<BO: CdrEndian>(
    out: &mut CdrWriter<'_, BO>,
    fields: &[Made],
    others: &[Vec<Made>],
    chance: &mut Chance,
) {
    for field in fields {
        let n = match field.count {
            Count::One => 1,
            Count::Fixed(n) => n,
            Count::Any | Count::Bounded(_) => {
                let n = chance.below(4);
                out.write_sequence_length(n);
                n
            }
        };
        for _ in 0..n {
            let v = chance.next();
            match field.kind {
                0 => out.write_bool(v & 1 == 1),
                1..=3 => out.write_u8(v as u8),
                4 => out.write_i8(v as i8),
                5 => out.write_u16(v as u16),
                6 => out.write_i16(v as i16),
                7 => out.write_u32(v as u32),
                8 => out.write_i32(v as i32),
                9 => out.write_u64(v >> 11),
                10 => out.write_i64((v as i64) >> 11),
                11 => out.write_f32((v >> 40) as f32 / 7.0),
                12 => out.write_f64((v >> 11) as f64 / 3.0),
                STRING | BOUNDED_STRING => out.write_string(&"abcdefghi"[..chance.below(9)]),
                kind => write(out, &others[kind - MESSAGES], others, chance),
            }
        }
    }
}

/// Numbers by their paths; those within a sequence of messages by element.
#[derive(Debug, Default, PartialEq)]
struct Numbers {
    single: BTreeMap<String, f64>,
    rows: BTreeMap<String, Vec<f64>>,
}

impl Numbers {
    /// Takes the numbers of a value at `path`; `of_rows` within an element of the only sequence on the way.
    fn take(&mut self, path: &str, value: &Value, of_rows: bool) {
        let one = match value {
            Value::Bool(v) => f64::from(u8::from(*v)),
            Value::I8(v) => f64::from(*v),
            Value::U8(v) => f64::from(*v),
            Value::I16(v) => f64::from(*v),
            Value::U16(v) => f64::from(*v),
            Value::I32(v) => f64::from(*v),
            Value::U32(v) => f64::from(*v),
            Value::I64(v) => *v as f64,
            Value::U64(v) => *v as f64,
            Value::F32(v) => f64::from(*v),
            Value::F64(v) => *v,
            Value::PrimitiveArray(values) | Value::PrimitiveSeq(values) => {
                // The second element, where there is one.
                if let Some(v) = second(values) {
                    self.put(format!("{path}[1]"), v, of_rows);
                }
                return;
            }
            Value::Message(fields) => {
                for (name, value) in fields {
                    // Their name for the byte of a message without fields.
                    if name == "structure_needs_at_least_one_member" {
                        continue;
                    }
                    let path = if path.is_empty() {
                        name.clone()
                    } else {
                        format!("{path}.{name}")
                    };
                    self.take(&path, value, of_rows);
                }
                return;
            }
            Value::Sequence(values) if !of_rows => {
                for value in values {
                    self.take(&format!("{path}[]"), value, true);
                }
                return;
            }
            Value::String(_) | Value::Array(_) | Value::Sequence(_) => return,
        };
        self.put(path.to_owned(), one, of_rows);
    }

    fn put(&mut self, path: String, value: f64, of_rows: bool) {
        if of_rows {
            self.rows.entry(path).or_default().push(value);
        } else {
            self.single.insert(path, value);
        }
    }
}

fn second(values: &PrimitiveArray) -> Option<f64> {
    match values {
        PrimitiveArray::Bool(v) => v.get(1).map(|v| f64::from(u8::from(*v))),
        PrimitiveArray::I8(v) => v.get(1).map(|v| f64::from(*v)),
        PrimitiveArray::U8(v) => v.get(1).map(|v| f64::from(*v)),
        PrimitiveArray::I16(v) => v.get(1).map(|v| f64::from(*v)),
        PrimitiveArray::U16(v) => v.get(1).map(|v| f64::from(*v)),
        PrimitiveArray::I32(v) => v.get(1).map(|v| f64::from(*v)),
        PrimitiveArray::U32(v) => v.get(1).map(|v| f64::from(*v)),
        PrimitiveArray::I64(v) => v.get(1).map(|v| *v as f64),
        PrimitiveArray::U64(v) => v.get(1).map(|v| *v as f64),
        PrimitiveArray::F32(v) => v.get(1).map(|v| f64::from(*v)),
        PrimitiveArray::F64(v) => v.get(1).copied(),
        PrimitiveArray::String(_) => None,
    }
}

/// What `re_ros_msg` reads; none where it refuses.
fn theirs(schema: &MessageSchema, message: &[u8]) -> Option<Numbers> {
    let (head, bytes) = message.split_first_chunk::<4>()?;
    let named = |s| {
        let spec: &MessageSpecification = s;
        (spec.name.replace("/msg/", "/"), spec)
    };
    let all = schema.dependencies.iter().chain([&schema.spec]).map(named);
    let resolver = MapResolver::new(all);
    let value = if head[1] == 1 {
        let mut reader: CdrReader<'_, LittleEndian> = CdrReader::new(bytes);
        decode_message(&mut reader, &schema.spec, &resolver).ok()?
    } else {
        let mut reader: CdrReader<'_, BigEndian> = CdrReader::new(bytes);
        decode_message(&mut reader, &schema.spec, &resolver).ok()?
    };
    let mut numbers = Numbers::default();
    numbers.take("", &value, false);
    Some(numbers)
}

/// Says that our plans take the same numbers from a message; gives how many were compared.
fn compare(name: &str, text: &str, message: &[u8], expected: &Numbers) -> usize {
    let definitions = parse(name, text, Dialect::Ros2).unwrap();
    let plan = |wanted: &[&str]| Plan::compile(&definitions, wanted, Dialect::Ros2).unwrap();
    let same = |found: f64, expected: f64| found.to_bits() == expected.to_bits();

    let wanted: Vec<&str> = expected.single.keys().map(String::as_str).collect();
    let mut row = Vec::new();
    plan(&wanted).run(message, &mut row, &mut |_| {}).unwrap();
    for ((path, value), found) in expected.single.iter().zip(&row) {
        assert!(
            same(*found, *value),
            "{path}: {found}, {value} expected\n{text}"
        );
    }
    let mut compared = row.len();
    for (path, values) in &expected.rows {
        let mut found = Vec::new();
        let plan = plan(&[path]);
        plan.run(message, &mut row, &mut |row| found.push(row[0]))
            .unwrap();
        // Elements without the number that was asked for hold none.
        found.retain(|v| !v.is_nan());
        let values: Vec<f64> = values.iter().copied().filter(|v| !v.is_nan()).collect();
        assert_eq!(found.len(), values.len(), "{path}\n{text}");
        let all = found.iter().zip(&values).all(|(a, b)| same(*a, *b));
        assert!(all, "{path}: {found:?}, {values:?} expected\n{text}");
        compared += values.len();
    }
    // Walked to its end, a message leaves nothing over.
    let left = plan(&[]).run(message, &mut row, &mut |_| {}).unwrap();
    assert!(left < 8, "{left} bytes\n{text}");
    compared
}

/// Makes a message up, and gives how many numbers of it were compared.
fn made_up(seed: u64) -> usize {
    let chance = &mut Chance(seed);
    let mut others: Vec<Vec<Made>> = Vec::new();
    for known in 0..NAMES.len() {
        others.push(made(chance, known));
    }
    let root = made(chance, NAMES.len());
    let mut schema = text(&root, chance);
    for ((name, _), fields) in NAMES.iter().zip(&others) {
        let body = text(fields, chance);
        write!(schema, "{}\nMSG: {name}\n{body}", "=".repeat(80)).unwrap();
    }
    let mut body = Vec::new();
    let little = chance.below(2) == 1;
    if little {
        write(
            &mut CdrWriter::<LittleEndian>::new(&mut body),
            &root,
            &others,
            chance,
        );
    } else {
        write(
            &mut CdrWriter::<BigEndian>::new(&mut body),
            &root,
            &others,
            chance,
        );
    }
    let mut message = vec![0, u8::from(little), 0, 0];
    message.extend(body);
    let spec = MessageSchema::parse("p/msg/Root", &schema).unwrap();
    let expected = theirs(&spec, &message).unwrap_or_else(|| panic!("they refuse\n{schema}"));
    compare("p/msg/Root", &schema, &message, &expected)
}

/// Compares every message of every ROS 2 channel of the files in a folder.
fn real(folder: &Path) {
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "mcap"))
        .collect();
    files.sort();
    for path in files {
        let (mut messages, mut numbers, mut refused) = (0, 0, 0);
        let bytes = std::fs::read(&path).unwrap();
        for message in mcap::MessageStream::new(&bytes).into_iter().flatten() {
            // A damaged file ends for this reader where its damage begins.
            let Ok(message) = message else { break };
            let Some(schema) = message.channel.schema.as_ref() else {
                continue;
            };
            if message.channel.message_encoding != "cdr" || schema.encoding != "ros2msg" {
                continue;
            }
            let text = std::str::from_utf8(&schema.data).unwrap();
            let spec = MessageSchema::parse(&schema.name, text);
            if let Some(expected) = spec.ok().and_then(|s| theirs(&s, &message.data)) {
                numbers += compare(&schema.name, text, &message.data, &expected);
                messages += 1;
            } else {
                // Wide strings and messages without a field are not for it.
                refused += 1;
            }
        }
        let name = path.file_name().unwrap().to_string_lossy();
        println!(
            "{name}: {messages} messages, {numbers} numbers alike; {refused} that they refuse"
        );
    }
}

fn main() {
    let mut words = std::env::args().skip(1);
    let cases: u64 = words.next().map_or(1000, |w| w.parse().unwrap());
    let numbers: usize = (0..cases).map(made_up).sum();
    println!("made up: {cases} definitions and messages, {numbers} numbers alike");
    if let Some(folder) = words.next() {
        real(Path::new(&folder));
    }
}

//! A long recording as a CARLA rig writes it, for benchmarks and tests of memory.

use mcap::{Compression, WriteOptions, records::MessageHeader};
use std::{collections::BTreeMap, io::Cursor};

const ODOMETRY: &str = include_str!("../../src/raw/mcap/schemas/odometry.txt");
const OBJECTS: &str = include_str!("../../src/raw/mcap/schemas/object_array.txt");

/// `minutes` of odometry at 50 Hz and lists of `cars` objects at 20 Hz, in zstd chunks.
pub(crate) fn log(minutes: f64, cars: u32) -> Vec<u8> {
    let options = WriteOptions::new().compression(Some(Compression::Zstd));
    let mut out = options.create(Cursor::new(Vec::new())).unwrap();
    let mut channel = |topic: &str, name: &str, text: &str| {
        let schema = out.add_schema(name, "ros2msg", text.as_bytes()).unwrap();
        out.add_channel(schema, topic, "cdr", &BTreeMap::new()).unwrap()
    };
    let odometry = channel("/carla/hero/odometry", "nav_msgs/msg/Odometry", ODOMETRY);
    let objects = channel("/carla/hero/objects", "derived_object_msgs/msg/ObjectArray", OBJECTS);
    let mut send = |channel_id: u16, ms: u64, bytes: &[u8]| {
        let time = ms * 1_000_000;
        let head = MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
        out.write_to_known_channel(&head, bytes).unwrap();
    };
    let end = (minutes * 60_000.0) as u64;
    for ms in (0..end).step_by(10) {
        let t = ms as f64 / 1e3;
        if ms % 20 == 0 {
            let mut bytes = Cdr::header(ms);
            bytes.string("hero");
            bytes.pose(25.0 * t, 0.3 * (0.1 * t).sin());
            bytes.f64s(&[0.0; 36]);
            bytes.f64s(&[25.0 + 0.01 * (t * 1.7).sin(), 0.0, 0.0, 0.0, 0.0, 0.001 * t.cos()]);
            bytes.f64s(&[0.0; 36]);
            send(odometry, ms, &bytes.0);
        }
        if ms % 50 == 0 {
            let mut bytes = Cdr::header(ms);
            bytes.put(&cars.to_le_bytes());
            for car in 0..cars {
                let n = f64::from(car);
                bytes.stamp(ms);
                bytes.put(&car.to_le_bytes());
                bytes.0.extend([1, 1]);
                bytes.pose(25.0 * t + 20.0 * n - 60.0 + n * (0.05 * t).sin(), 3.66 * (n % 2.0));
                bytes.f64s(&[25.0 + 0.05 * n * (0.05 * t).cos(), 0.0, 0.0, 0.0, 0.0, 0.0]);
                bytes.f64s(&[0.0; 6]);
                bytes.put(&0_u32.to_le_bytes());
                bytes.0.push(1);
                bytes.put(&3_u32.to_le_bytes());
                bytes.f64s(&[4.5, 1.9, 1.5]);
                bytes.put(&0_u32.to_le_bytes());
                bytes.0.extend([6, 255]);
                bytes.put(&1_u32.to_le_bytes());
            }
            send(objects, ms, &bytes.0);
        }
    }
    out.finish().unwrap();
    out.into_inner().into_inner()
}

struct Cdr(Vec<u8>);

impl Cdr {
    fn header(ms: u64) -> Self {
        let mut bytes = Self(vec![0, 1, 0, 0]);
        bytes.stamp(ms);
        bytes
    }

    fn stamp(&mut self, ms: u64) {
        self.put(&((ms / 1000) as u32).to_le_bytes());
        self.put(&((ms % 1000 * 1_000_000) as u32).to_le_bytes());
        self.string("map");
    }

    fn put(&mut self, value: &[u8]) {
        while !(self.0.len() - 4).is_multiple_of(value.len()) {
            self.0.push(0);
        }
        self.0.extend(value);
    }

    fn f64s(&mut self, values: &[f64]) {
        for v in values {
            self.put(&v.to_le_bytes());
        }
    }

    fn pose(&mut self, x: f64, y: f64) {
        self.f64s(&[x, y, 0.0, 0.0, 0.0, 0.0, 1.0]);
    }

    fn string(&mut self, text: &str) {
        self.put(&(text.len() as u32 + 1).to_le_bytes());
        self.0.extend(text.bytes().chain([0]));
    }
}

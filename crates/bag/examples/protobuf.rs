//! A protobuf channel decoded by its plan, beside prost-reflect's messages of the same numbers: how long each takes a message.
//!
//! `cargo run --release -p maveric-bag --example protobuf`: eight objects with place, velocity and size, as simulators write them.
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "an example stops at what cannot be, and prints"
)]

use maveric_bag::{Channel, Codec, OwnedSchema, Schema};
use prost_reflect::{
    DescriptorPool, DynamicMessage, MessageDescriptor, Value,
    prost::Message,
    prost_types::{
        DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet,
        field_descriptor_proto::{Label, Type},
    },
};
use std::{hint::black_box, time::Instant};

const WANTED: [&str; 8] = [
    "seconds",
    "object[].id",
    "object[].position.x",
    "object[].position.y",
    "object[].velocity.x",
    "object[].velocity.y",
    "object[].yaw",
    "object[].length",
];
const PARTS: [&str; 4] = ["position", "velocity", "acceleration", "size"];
const ROUNDS: u32 = 500;

fn message(name: &str, fields: &[(&str, Type, &str)]) -> DescriptorProto {
    let label = |name: &str| match name {
        "object" => Label::Repeated,
        _ => Label::Optional,
    };
    let field = |(number, &(name, ty, of)): (i32, &(&str, Type, &str))| FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        r#type: Some(ty.into()),
        type_name: (!of.is_empty()).then(|| format!(".p.{of}")),
        label: Some(label(name).into()),
        ..FieldDescriptorProto::default()
    };
    DescriptorProto {
        name: Some(name.to_owned()),
        field: (1..).zip(fields).map(field).collect(),
        ..DescriptorProto::default()
    }
}

fn descriptors() -> Vec<u8> {
    let double = |name| (name, Type::Double, "");
    let part = |name| (name, Type::Message, "Vector");
    let mut object = vec![("id", Type::Uint64, ""), double("yaw"), double("length")];
    object.extend(PARTS.map(part));
    let scene = [("seconds", Type::Int64, ""), ("object", Type::Message, "Object")];
    let file = FileDescriptorProto {
        name: Some("p.proto".to_owned()),
        package: Some("p".to_owned()),
        message_type: vec![
            message("Vector", &["x", "y", "z"].map(double)),
            message("Object", &object),
            message("Scene", &scene),
        ],
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    FileDescriptorSet { file: vec![file] }.encode_to_vec()
}

fn scene(message_type: &MessageDescriptor, objects: u32) -> Vec<u8> {
    let kind = |name: &str| message_type.parent_pool().get_message_by_name(name).unwrap();
    let object = |id: u32| {
        let mut object = DynamicMessage::new(kind("p.Object"));
        object.set_field_by_name("id", Value::U64(u64::from(id) + 1));
        object.set_field_by_name("yaw", Value::F64(0.1));
        object.set_field_by_name("length", Value::F64(4.5));
        for (part, at) in PARTS.iter().zip(1_u32..) {
            let mut vector = DynamicMessage::new(kind("p.Vector"));
            for axis in ["x", "y", "z"] {
                vector.set_field_by_name(axis, Value::F64(f64::from(at + 10 * id)));
            }
            object.set_field_by_name(part, Value::Message(vector));
        }
        Value::Message(object)
    };
    let mut scene = DynamicMessage::new(message_type.clone());
    scene.set_field_by_name("seconds", Value::I64(1_700_000_000));
    scene.set_field_by_name("object", Value::List((0..objects).map(object).collect()));
    scene.encode_to_vec()
}

/// The number at a path below a message.
fn number(message: &DynamicMessage, path: &str) -> f64 {
    let (name, rest) = path.split_once('.').unwrap_or((path, ""));
    match &*message.get_field_by_name(name).unwrap() {
        Value::Message(below) => number(below, rest),
        Value::F64(v) => *v,
        Value::I64(v) => *v as f64,
        Value::U64(v) => *v as f64,
        _ => f64::NAN,
    }
}

fn reflected(message_type: &MessageDescriptor, bytes: &[u8], each: &mut dyn FnMut(&[f64])) {
    let message = DynamicMessage::decode(message_type.clone(), bytes).unwrap();
    let mut row = WANTED.map(|_| f64::NAN);
    row[0] = number(&message, WANTED[0]);
    let objects = message.get_field_by_name("object").unwrap();
    for object in objects.as_list().unwrap() {
        let object = object.as_message().unwrap();
        for (value, path) in row.iter_mut().zip(WANTED).skip(1) {
            *value = number(object, path.trim_start_matches("object[]."));
        }
        each(&row);
    }
}

fn main() {
    let data = descriptors();
    let pool = DescriptorPool::decode(&data[..]).unwrap();
    let message_type = pool.get_message_by_name("p.Scene").unwrap();
    let channel = Channel {
        id: 0,
        schema_id: 1,
        topic: "/scene".to_owned(),
        encoding: "protobuf".to_owned(),
    };
    let schema = OwnedSchema::from(Schema {
        id: 1,
        name: "p.Scene".to_owned(),
        encoding: "protobuf".to_owned(),
        data: &data,
    });
    let codec = Codec::compile(&channel, Some(&schema), &WANTED).unwrap();
    let bytes = scene(&message_type, 8);
    let mut row = Vec::new();
    let mut by_plan = |each: &mut dyn FnMut(&[f64])| codec.run(&bytes, &mut row, each).unwrap();
    let by_reflection = |each: &mut dyn FnMut(&[f64])| reflected(&message_type, &bytes, each);
    let (mut some, mut same) = (Vec::new(), Vec::new());
    by_plan(&mut |row| some.extend_from_slice(row));
    by_reflection(&mut |row| same.extend_from_slice(row));
    assert_eq!(some, same);
    let least_us = |decode: &mut dyn FnMut()| {
        let least = (0..50).map(|_| {
            let start = Instant::now();
            (0..ROUNDS).for_each(|_| decode());
            start.elapsed().as_secs_f64() * 1e6 / f64::from(ROUNDS)
        });
        least.fold(f64::INFINITY, f64::min)
    };
    let plan = least_us(&mut || by_plan(&mut |row| assert!(black_box(row).len() > 1)));
    let other = least_us(&mut || by_reflection(&mut |row| assert!(black_box(row).len() > 1)));
    println!(
        "8 objects, {} bytes: {plan:.2} us by the plan, {other:.2} us by reflection, {:.1} times as long",
        bytes.len(),
        other / plan
    );
}

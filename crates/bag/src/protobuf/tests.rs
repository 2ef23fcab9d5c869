use super::*;
use prost_reflect::prost::Message as _;
use prost_reflect::prost_types::{
    DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet,
    OneofDescriptorProto,
    field_descriptor_proto::{Label, Type},
};

fn field(name: &str, number: i32, ty: Type, of: &str, list: bool) -> FieldDescriptorProto {
    FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        r#type: Some(ty as i32),
        type_name: (!of.is_empty()).then(|| of.to_owned()),
        label: Some(if list { Label::Repeated } else { Label::Optional } as i32),
        ..FieldDescriptorProto::default()
    }
}

fn schema() -> Vec<u8> {
    let car = DescriptorProto {
        name: Some("Car".to_owned()),
        field: vec![
            field("id", 1, Type::Sint32, "", false),
            field("size", 2, Type::Double, "", true),
            field("name", 3, Type::String, "", false),
        ],
        ..DescriptorProto::default()
    };
    let scene = DescriptorProto {
        name: Some("Scene".to_owned()),
        field: vec![
            field("cars", 1, Type::Message, ".p.Car", true),
            field("speed", 2, Type::Float, "", false),
            field("lane", 3, Type::Int32, "", false),
        ],
        ..DescriptorProto::default()
    };
    let file = FileDescriptorProto {
        name: Some("p.proto".to_owned()),
        package: Some("p".to_owned()),
        message_type: vec![car, scene],
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    FileDescriptorSet { file: vec![file] }.encode_to_vec()
}

#[test]
fn numbers_are_taken_and_those_left_out_are_zero() {
    let wanted = ["speed", "lane", "cars[].id", "cars[].size[1]?"];
    let plan = Plan::compile("p.Scene", &schema(), &wanted).unwrap();
    let mut message = vec![0x0a, 20, 0x08, 3, 0x12, 16];
    message.extend(4.5_f64.to_le_bytes());
    message.extend(1.5_f64.to_le_bytes());
    message.extend([0x0a, 3, 0x1a, 1, b'x', 0x15]);
    message.extend(2.5_f32.to_le_bytes());
    let mut rows = Vec::new();
    plan.run(&message, &mut Vec::new(), &mut |r| rows.push(r.to_vec())).unwrap();
    assert_eq!(rows[0], [2.5, 0.0, -2.0, 1.5]);
    assert_eq!(rows[1][..3], [2.5, 0.0, 0.0]);
    assert!(rows[1][3].is_nan());
}

/// Descriptors of one message `p.Lead`, in a syntax, with the declared default of a field.
fn lead_schema(syntax: &str, field: FieldDescriptorProto, default: Option<&str>) -> Vec<u8> {
    let field = FieldDescriptorProto { default_value: default.map(str::to_owned), ..field };
    let in_oneof = field.oneof_index.is_some();
    let oneof = OneofDescriptorProto { name: Some("_speed".to_owned()), ..Default::default() };
    let lead = DescriptorProto {
        name: Some("Lead".to_owned()),
        field: vec![field],
        oneof_decl: if in_oneof { vec![oneof] } else { Vec::new() },
        ..DescriptorProto::default()
    };
    let file = FileDescriptorProto {
        name: Some("p.proto".to_owned()),
        package: Some("p".to_owned()),
        message_type: vec![lead],
        syntax: Some(syntax.to_owned()),
        ..FileDescriptorProto::default()
    };
    FileDescriptorSet { file: vec![file] }.encode_to_vec()
}

#[test]
fn unset_field_with_presence_is_missing() {
    let plain = field("speed", 1, Type::Double, "", false);
    let in_oneof = FieldDescriptorProto { oneof_index: Some(0), ..plain.clone() };
    let optional = FieldDescriptorProto { proto3_optional: Some(true), ..in_oneof.clone() };
    let empty = |syntax: &str, field: &FieldDescriptorProto, default, path: &str| {
        let schema = lead_schema(syntax, field.clone(), default);
        let mut row = Vec::new();
        let plan = Plan::compile("p.Lead", &schema, &[path]).unwrap();
        plan.run(&[], &mut row, &mut |_| {}).map(|()| row[0])
    };
    for (syntax, field) in [("proto3", &optional), ("proto3", &in_oneof), ("proto2", &plain)] {
        assert!(empty(syntax, field, None, "speed?").unwrap().is_nan(), "{syntax}");
        let error = empty(syntax, field, None, "speed").unwrap_err();
        assert!(error.contains("`speed`"), "{error}");
    }
    assert_eq!(empty("proto3", &plain, None, "speed").map(f64::to_bits), Ok(0));
    let declared = empty("proto2", &plain, Some("2.5"), "speed").unwrap();
    assert_eq!(declared.to_bits(), 2.5_f64.to_bits(), "the declared default");
}

#[test]
fn bad_bytes_an_unknown_type_and_a_missing_field_are_refused() {
    let plan = Plan::compile("p.Scene", &schema(), &["speed"]).unwrap();
    for bytes in [&[0x0a, 9][..], &[0x15, 1], &[0x13], &[0xff; 11]] {
        assert!(plan.run(bytes, &mut Vec::new(), &mut |_| {}).is_err());
    }
    let of = |name: &str, wanted: &[&str]| Plan::compile(name, &schema(), wanted).unwrap_err();
    assert!(of("p.None", &[]).contains("p.None"));
    assert!(of("p.Scene", &["height"]).contains("`height`"));
    assert!(Plan::compile("p.Scene", &[1, 2, 3], &[]).is_err());
    // The syntax is the last text of the set: one that does not exist panics within the library.
    let mut unknown = schema();
    let at = unknown.len() - "proto3".len();
    unknown[at..].copy_from_slice(b"[[[pro");
    assert!(Plan::compile("p.Scene", &unknown, &["speed"]).unwrap_err().contains("damaged"));
}

/// A message of one field of each kind of number, by its field number.
#[test]
fn every_kind_of_number_is_read_plain_packed_and_by_its_place() {
    let kinds = [
        (Type::Double, 1_u8, (-1.5_f64).to_le_bytes().to_vec(), -1.5),
        (Type::Float, 5, (-2.5_f32).to_le_bytes().to_vec(), -2.5),
        (Type::Fixed64, 1, (1_u64 << 63).to_le_bytes().to_vec(), 9_223_372_036_854_775_808.0),
        (Type::Sfixed64, 1, (-3_i64).to_le_bytes().to_vec(), -3.0),
        (Type::Fixed32, 5, u32::MAX.to_le_bytes().to_vec(), 4_294_967_295.0),
        (Type::Sfixed32, 5, (-4_i32).to_le_bytes().to_vec(), -4.0),
        (Type::Int32, 0, [&[0xff; 9][..], &[1]].concat(), -1.0),
        (Type::Int64, 0, vec![0xac, 0x02], 300.0),
        (Type::Uint32, 0, vec![0xac, 0x02], 300.0),
        (Type::Uint64, 0, [&[0xff; 9][..], &[1]].concat(), 18_446_744_073_709_551_615.0),
        (Type::Sint32, 0, vec![3], -2.0),
        (Type::Sint64, 0, vec![4], 2.0),
        (Type::Bool, 0, vec![1], 1.0),
    ];
    let mut fields = Vec::new();
    for (i, (ty, ..)) in (1..).zip(&kinds) {
        fields.push(field(&format!("one{i}"), i, *ty, "", false));
        fields.push(field(&format!("list{i}"), i + 50, *ty, "", true));
    }
    let file = FileDescriptorProto {
        name: Some("k.proto".to_owned()),
        package: Some("p".to_owned()),
        message_type: vec![DescriptorProto {
            name: Some("All".to_owned()),
            field: fields,
            ..DescriptorProto::default()
        }],
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    let schema = FileDescriptorSet { file: vec![file] }.encode_to_vec();
    let key = |number: u64, kind: u8| {
        let key = number << 3 | u64::from(kind);
        if key < 0x80 { vec![key as u8] } else { vec![key as u8 | 0x80, (key >> 7) as u8] }
    };
    for (i, (ty, kind, bytes, value)) in (1_u64..).zip(&kinds) {
        let wanted = [format!("one{i}"), format!("list{i}[0]?"), format!("list{i}[2]?")];
        let wanted: Vec<&str> = wanted.iter().map(String::as_str).collect();
        let plan = Plan::compile("p.All", &schema, &wanted).unwrap();
        let run = |message: &[u8]| {
            let mut row = Vec::new();
            plan.run(message, &mut row, &mut |_| panic!("no rows")).map(|()| row)
        };
        let one = [key(i, *kind), bytes.clone()].concat();
        let element = [key(i + 50, *kind), bytes.clone()].concat();
        let packed = [key(i + 50, 2), vec![3 * bytes.len() as u8], bytes.repeat(3)].concat();
        let found = run(&one).unwrap();
        assert_eq!(found[0].to_bits(), f64::to_bits(*value), "{ty:?}");
        assert!(found[1].is_nan() && found[2].is_nan());
        assert_eq!(run(&packed).unwrap(), [0.0, *value, *value], "{ty:?} packed");
        assert_eq!(run(&element.repeat(3)).unwrap(), [0.0, *value, *value], "{ty:?} apart");
        assert!(run(&element.repeat(2)).unwrap()[2].is_nan());
        // Another kind of bytes than the number's.
        let other = if *kind == 0 { 5 } else { 0 };
        let wrong = [key(i, other), vec![1; 4]].concat();
        assert!(run(&wrong).is_err(), "{ty:?}");
        assert!(run(&one[..one.len() - 1]).is_err(), "{ty:?} cut");
    }
}

#[test]
fn elements_are_taken_by_their_place_names_as_numbers_and_the_rest_as_rows() {
    let wanted = ["cars[0].id", "cars[1].name#", "cars[].size[0]?"];
    let plan = Plan::compile("p.Scene", &schema(), &wanted).unwrap();
    let car = |id: u8, name: u8, size: f64| {
        let mut car = vec![0x08, id, 0x1a, 1, name, 0x11];
        car.extend(size.to_le_bytes());
        [vec![0x0a, car.len() as u8], car].concat()
    };
    let message =
        [car(6, b'x', 1.0), car(8, b'y', 2.0), car(10, b'z', 3.0), car(12, b'z', 4.0)].concat();
    let mut rows = Vec::new();
    plan.run(&message, &mut Vec::new(), &mut |r| rows.push(r.to_vec())).unwrap();
    let y = name_number(b"y");
    assert_eq!(rows, [[3.0, y, 3.0], [3.0, y, 4.0]]);
    // A text is no number, and neither is a message.
    for path in ["cars[].name", "cars", "cars[].size"] {
        let error = Plan::compile("p.Scene", &schema(), &[path]).unwrap_err();
        assert!(error.contains(&format!("`{path}`")), "{error}");
    }
    assert!(Plan::compile("p.Scene", &schema(), &["height?", "speed"]).is_ok());
    let error = Plan::compile("p.Scene", &vec![0; MOST_SCHEMA + 1], &[]).unwrap_err();
    assert!(error.contains("262145 bytes"), "{error}");
}

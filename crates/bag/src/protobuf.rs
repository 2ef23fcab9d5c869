//! Protobuf messages: field numbers from the schema's descriptors, wanted numbers along the bytes, the rest passed over.

use super::{
    caught::caught,
    wanted::{Slots, Taken, Tree, all_matched, name_number},
};
use prost_reflect::{DescriptorPool, FieldDescriptor, Kind, MessageDescriptor};
use std::collections::BTreeMap;

/// Largest set of descriptors that is read, in bytes: unpacked they take some hundred times as much.
const MOST_SCHEMA: usize = 256 << 10;

/// Which numbers of a channel's messages are wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Plan {
    root: Node,
    slots: Slots,
}

/// What is wanted of a message, by field number.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
struct Node {
    fields: BTreeMap<u64, Field>,
    /// Slots of its own numbers, which are 0 where they are left out.
    numbers: Vec<usize>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Field {
    value: Value,
    /// Every element gives a row.
    each: bool,
    /// Slots by the element's place; place 0 alone where the field is not repeated.
    items: BTreeMap<usize, Vec<usize>>,
    repeated: bool,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Value {
    Number(Kind),
    /// Slots that take a text as [`name_number`].
    Name(Vec<usize>),
    /// What is wanted of an element, by its place; the last node serves all others.
    Messages(BTreeMap<usize, Node>, Option<Node>),
}

impl Plan {
    /// Compiles a plan that fills slot i with the number at path `wanted[i]`: paths as in a ROS message.
    ///
    /// # Errors
    /// A sentence that says why the schema cannot be used or which number it lacks.
    pub(crate) fn compile(name: &str, schema: &[u8], wanted: &[&str]) -> Result<Self, String> {
        if schema.len() > MOST_SCHEMA {
            return Err(format!(
                "its schema has {} bytes, expected at most {MOST_SCHEMA}",
                schema.len()
            ));
        }
        // A syntax that does not exist is a panic there.
        let pool = caught(|| DescriptorPool::decode(schema).map_err(|e| e.to_string()))
            .map_err(|e| format!("its schema is no set of descriptors: {e}"))?;
        let message = pool
            .get_message_by_name(name)
            .ok_or_else(|| format!("type `{name}` is not in its schema"))?;
        let tree = Tree::from_wanted(wanted);
        let mut matched = vec![false; wanted.len()];
        let root = node(&message, &tree, &mut matched);
        all_matched(name, wanted, &matched)?;
        let slots = Slots::from_wanted(wanted, &tree);
        Ok(Self { root, slots })
    }

    /// Reads a message: `row` is filled, and given to `each` for every element of the wanted sequence.
    ///
    /// # Errors
    /// A sentence, where the bytes do not fit.
    pub(crate) fn run(
        &self,
        message: &[u8],
        row: &mut Vec<f64>,
        each: &mut dyn FnMut(&[f64]),
    ) -> Result<(), String> {
        let mut taken = Taken::new(&self.slots);
        self.root
            .walk(message, &mut taken)
            .ok_or("its bytes are no protobuf message")?;
        self.slots.give(&mut taken, row, each)
    }
}

fn node(message: &MessageDescriptor, tree: &Tree, matched: &mut [bool]) -> Node {
    let mut fields = BTreeMap::new();
    let mut numbers = Vec::new();
    for (name, below) in &tree.fields {
        let Some(descriptor) = message.get_field_by_name(name) else {
            continue;
        };
        let field = field(&descriptor, below, matched);
        if let (Value::Number(_), false) = (&field.value, field.repeated) {
            numbers.extend(field.items.values().flatten());
        }
        fields.insert(u64::from(descriptor.number()), field);
    }
    Node { fields, numbers }
}

fn field(descriptor: &FieldDescriptor, tree: &Tree, matched: &mut [bool]) -> Field {
    let repeated = descriptor.is_list();
    let mut items = BTreeMap::new();
    let value = match descriptor.kind() {
        Kind::Message(message) if repeated => {
            let indexed = |(&i, t): (&usize, &Tree)| (i, node(&message, t, matched));
            let nodes = tree.items.iter().map(indexed).collect();
            let each = tree.each.as_deref().map(|t| node(&message, t, matched));
            Value::Messages(nodes, each)
        }
        Kind::Message(message) => {
            let one = node(&message, tree, matched);
            Value::Messages(BTreeMap::from([(0, one)]), None)
        }
        Kind::String if !repeated && !tree.names.is_empty() => {
            for &slot in &tree.names {
                matched[slot] = true;
            }
            Value::Name(tree.names.clone())
        }
        Kind::String | Kind::Bytes => Value::Messages(BTreeMap::new(), None),
        kind => {
            if repeated {
                items.extend(tree.items.iter().map(|(&i, t)| (i, t.slots.clone())));
            } else {
                items.insert(0, tree.slots.clone());
            }
            for &slot in items.values().flatten() {
                matched[slot] = true;
            }
            Value::Number(kind)
        }
    };
    Field {
        each: repeated && tree.each.is_some(),
        value,
        items,
        repeated,
    }
}

impl Node {
    /// Takes what is wanted of a message; none where its bytes do not fit.
    fn walk(&self, bytes: &[u8], taken: &mut Taken) -> Option<()> {
        taken.set_default(&self.numbers, 0.0);
        let mut wire = Wire(bytes);
        let mut places: BTreeMap<u64, usize> = BTreeMap::new();
        while !wire.0.is_empty() {
            let key = wire.varint()?;
            let (number, kind) = (key >> 3, key & 7);
            let piece = wire.piece(kind)?;
            if let Some(field) = self.fields.get(&number) {
                field.take(kind, piece, places.entry(number).or_default(), taken)?;
            }
        }
        Some(())
    }
}

impl Field {
    fn take(
        &self,
        kind: u64,
        piece: Piece<'_>,
        place: &mut usize,
        taken: &mut Taken,
    ) -> Option<()> {
        match (&self.value, piece) {
            (Value::Messages(nodes, each), Piece::Bytes(bytes)) => {
                let index = *place;
                *place += usize::from(self.repeated);
                if let Some(node) = nodes.get(&index) {
                    node.walk(bytes, taken)?;
                } else if let Some(node) = each
                    && self.each
                    && taken.begin_row()
                {
                    let walked = node.walk(bytes, taken);
                    taken.end_row();
                    walked?;
                }
                Some(())
            }
            (Value::Name(slots), Piece::Bytes(bytes)) => {
                taken.set(slots, name_number(bytes));
                Some(())
            }
            (Value::Number(declared), Piece::Bytes(bytes)) => {
                // Packed: numbers one after another.
                let mut packed = Wire(bytes);
                let kind = wire_kind(declared);
                while !packed.0.is_empty() {
                    let piece = packed.piece(kind)?;
                    self.number(declared, piece, place, taken)?;
                }
                Some(())
            }
            (Value::Number(declared), piece) if kind == wire_kind(declared) => {
                self.number(declared, piece, place, taken)
            }
            _ => None,
        }
    }

    fn number(
        &self,
        of: &Kind,
        piece: Piece<'_>,
        place: &mut usize,
        taken: &mut Taken,
    ) -> Option<()> {
        let value = value(of, piece)?;
        if let Some(slots) = self.items.get(place) {
            taken.set(slots, value);
        }
        *place += usize::from(self.repeated);
        Some(())
    }
}

/// How the bytes of a kind of number are marked.
fn wire_kind(kind: &Kind) -> u64 {
    match kind {
        Kind::Double | Kind::Fixed64 | Kind::Sfixed64 => 1,
        Kind::Float | Kind::Fixed32 | Kind::Sfixed32 => 5,
        _ => 0,
    }
}

fn value(kind: &Kind, piece: Piece<'_>) -> Option<f64> {
    let unzigzag = |v: u64| (v >> 1).cast_signed() ^ -((v & 1).cast_signed());
    Some(match (kind, piece) {
        (Kind::Double, Piece::Eight(b)) => f64::from_le_bytes(b),
        (Kind::Fixed64, Piece::Eight(b)) => u64::from_le_bytes(b) as f64,
        (Kind::Sfixed64, Piece::Eight(b)) => i64::from_le_bytes(b) as f64,
        (Kind::Float, Piece::Four(b)) => f64::from(f32::from_le_bytes(b)),
        (Kind::Fixed32, Piece::Four(b)) => f64::from(u32::from_le_bytes(b)),
        (Kind::Sfixed32, Piece::Four(b)) => f64::from(i32::from_le_bytes(b)),
        (Kind::Sint32 | Kind::Sint64, Piece::Varint(v)) => unzigzag(v) as f64,
        (Kind::Uint32 | Kind::Uint64 | Kind::Bool, Piece::Varint(v)) => v as f64,
        (_, Piece::Varint(v)) => v.cast_signed() as f64,
        _ => return None,
    })
}

enum Piece<'a> {
    Varint(u64),
    Eight([u8; 8]),
    Four([u8; 4]),
    Bytes(&'a [u8]),
}

/// Reads along the bytes of a message.
struct Wire<'a>(&'a [u8]);

impl<'a> Wire<'a> {
    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for i in 0..10 {
            let (&byte, rest) = self.0.split_first()?;
            self.0 = rest;
            value |= u64::from(byte & 0x7f) << (7 * i);
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (&value, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(value)
    }

    fn piece(&mut self, kind: u64) -> Option<Piece<'a>> {
        Some(match kind {
            0 => Piece::Varint(self.varint()?),
            1 => Piece::Eight(self.array()?),
            5 => Piece::Four(self.array()?),
            2 => {
                let length = usize::try_from(self.varint()?).ok()?;
                let (bytes, rest) = self.0.split_at_checked(length)?;
                self.0 = rest;
                Piece::Bytes(bytes)
            }
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prost_reflect::prost::Message as _;
    use prost_reflect::prost_types::{
        DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet,
        field_descriptor_proto::{Label, Type},
    };

    fn field(name: &str, number: i32, ty: Type, of: &str, list: bool) -> FieldDescriptorProto {
        FieldDescriptorProto {
            name: Some(name.to_owned()),
            number: Some(number),
            r#type: Some(ty as i32),
            type_name: (!of.is_empty()).then(|| of.to_owned()),
            label: Some(if list {
                Label::Repeated
            } else {
                Label::Optional
            } as i32),
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
        plan.run(&message, &mut Vec::new(), &mut |r| rows.push(r.to_vec()))
            .unwrap();
        assert_eq!(rows[0], [2.5, 0.0, -2.0, 1.5]);
        assert_eq!(rows[1][..3], [2.5, 0.0, 0.0]);
        assert!(rows[1][3].is_nan());
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
        assert!(
            Plan::compile("p.Scene", &unknown, &["speed"])
                .unwrap_err()
                .contains("damaged")
        );
    }

    /// A message of one field of each kind of number, by its field number.
    #[test]
    fn every_kind_of_number_is_read_plain_packed_and_by_its_place() {
        let kinds = [
            (Type::Double, 1_u8, (-1.5_f64).to_le_bytes().to_vec(), -1.5),
            (Type::Float, 5, (-2.5_f32).to_le_bytes().to_vec(), -2.5),
            (
                Type::Fixed64,
                1,
                (1_u64 << 63).to_le_bytes().to_vec(),
                9_223_372_036_854_775_808.0,
            ),
            (Type::Sfixed64, 1, (-3_i64).to_le_bytes().to_vec(), -3.0),
            (
                Type::Fixed32,
                5,
                u32::MAX.to_le_bytes().to_vec(),
                4_294_967_295.0,
            ),
            (Type::Sfixed32, 5, (-4_i32).to_le_bytes().to_vec(), -4.0),
            (Type::Int32, 0, [&[0xff; 9][..], &[1]].concat(), -1.0),
            (Type::Int64, 0, vec![0xac, 0x02], 300.0),
            (Type::Uint32, 0, vec![0xac, 0x02], 300.0),
            (
                Type::Uint64,
                0,
                [&[0xff; 9][..], &[1]].concat(),
                18_446_744_073_709_551_615.0,
            ),
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
            if key < 0x80 {
                vec![key as u8]
            } else {
                vec![key as u8 | 0x80, (key >> 7) as u8]
            }
        };
        for (i, (ty, kind, bytes, value)) in (1_u64..).zip(&kinds) {
            let wanted = [
                format!("one{i}"),
                format!("list{i}[0]?"),
                format!("list{i}[2]?"),
            ];
            let wanted: Vec<&str> = wanted.iter().map(String::as_str).collect();
            let plan = Plan::compile("p.All", &schema, &wanted).unwrap();
            let run = |message: &[u8]| {
                let mut row = Vec::new();
                plan.run(message, &mut row, &mut |_| panic!("no rows"))
                    .map(|()| row)
            };
            let one = [key(i, *kind), bytes.clone()].concat();
            let element = [key(i + 50, *kind), bytes.clone()].concat();
            let packed = [key(i + 50, 2), vec![3 * bytes.len() as u8], bytes.repeat(3)].concat();
            let found = run(&one).unwrap();
            assert_eq!(found[0].to_bits(), f64::to_bits(*value), "{ty:?}");
            assert!(found[1].is_nan() && found[2].is_nan());
            assert_eq!(
                run(&packed).unwrap(),
                [0.0, *value, *value],
                "{ty:?} packed"
            );
            assert_eq!(
                run(&element.repeat(3)).unwrap(),
                [0.0, *value, *value],
                "{ty:?} apart"
            );
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
        let message = [
            car(6, b'x', 1.0),
            car(8, b'y', 2.0),
            car(10, b'z', 3.0),
            car(12, b'z', 4.0),
        ]
        .concat();
        let mut rows = Vec::new();
        plan.run(&message, &mut Vec::new(), &mut |r| rows.push(r.to_vec()))
            .unwrap();
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
}

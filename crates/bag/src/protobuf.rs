//! Protobuf messages: field numbers from the schema's descriptors, wanted numbers along the bytes, the rest passed over.

use super::{
    caught::caught,
    wanted::{Slots, Taken, Tree, all_matched, name_number},
};
use prost_reflect::{
    DescriptorPool, FieldDescriptor, Kind, MessageDescriptor, Value as DefaultValue,
};
use std::collections::BTreeMap;

/// Largest set of descriptors that is read, in bytes: unpacked they take some hundred times as much.
const MOST_SCHEMA: usize = 256 << 10;

/// Which numbers of a channel's messages are wanted.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plan {
    root: Node,
    slots: Slots,
}

/// What is wanted of a message, by field number.
#[derive(Debug, Clone, PartialEq, Default)]
struct Node {
    fields: BTreeMap<u64, Field>,
    /// Slots of its own numbers that have a value if they are left out, with that value.
    defaults: Vec<(Vec<usize>, f64)>,
}

#[derive(Debug, Clone, PartialEq)]
struct Field {
    value: Value,
    /// Every element gives a row.
    each: bool,
    /// Slots by the element's place; place 0 alone where the field is not repeated.
    items: BTreeMap<usize, Vec<usize>>,
    repeated: bool,
}

#[derive(Debug, Clone, PartialEq)]
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
        self.root.walk(message, &mut taken).ok_or("its bytes are no protobuf message")?;
        self.slots.give(&mut taken, row, each)
    }
}

fn node(message: &MessageDescriptor, tree: &Tree, matched: &mut [bool]) -> Node {
    let mut fields = BTreeMap::new();
    let mut defaults = Vec::new();
    for (name, below) in &tree.fields {
        let Some(descriptor) = message.get_field_by_name(name) else {
            continue;
        };
        let field = field(&descriptor, below, matched);
        if let (Value::Number(_), false) = (&field.value, field.repeated) {
            let slots = field.items.values().flatten().copied().collect();
            defaults.extend(value_if_left_out(&descriptor).map(|value| (slots, value)));
        }
        fields.insert(u64::from(descriptor.number()), field);
    }
    Node { fields, defaults }
}

/// Returns the value of a number that a message leaves out: its declared default, or 0.
///
/// `None` if the field has presence (`optional`, `oneof`) and no declared default: then it is unset.
fn value_if_left_out(descriptor: &FieldDescriptor) -> Option<f64> {
    if descriptor.supports_presence() && descriptor.field_descriptor_proto().default_value.is_none()
    {
        return None;
    }
    Some(match descriptor.default_value() {
        DefaultValue::Bool(value) => f64::from(u8::from(value)),
        DefaultValue::I32(value) | DefaultValue::EnumNumber(value) => f64::from(value),
        DefaultValue::I64(value) => value as f64,
        DefaultValue::U32(value) => f64::from(value),
        DefaultValue::U64(value) => value as f64,
        DefaultValue::F32(value) => f64::from(value),
        DefaultValue::F64(value) => value,
        _ => 0.0,
    })
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
    Field { each: repeated && tree.each.is_some(), value, items, repeated }
}

impl Node {
    /// Takes what is wanted of a message; none where its bytes do not fit.
    fn walk(&self, bytes: &[u8], taken: &mut Taken) -> Option<()> {
        for (slots, value) in &self.defaults {
            taken.set_default(slots, *value);
        }
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
mod tests;

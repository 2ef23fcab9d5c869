//! `.msg` definitions: the text of a schema to types and their fields.

use std::collections::{BTreeMap, BTreeSet};

/// A number as the bytes hold it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Primitive {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl Primitive {
    /// Size, and alignment, in bytes.
    pub(crate) fn size(self) -> u8 {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "bool" | "byte" | "char" | "uint8" => Self::U8,
            "int8" => Self::I8,
            "uint16" => Self::U16,
            "int16" => Self::I16,
            "uint32" => Self::U32,
            "int32" => Self::I32,
            "uint64" => Self::U64,
            "int64" => Self::I64,
            "float32" => Self::F32,
            "float64" => Self::F64,
            _ => return None,
        })
    }
}

/// What one element of a field is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Base {
    Primitive(Primitive),
    String,
    WideString,
    /// Full name of another type, `pkg/Type`.
    Message(String),
}

/// How many elements a field has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Count {
    One,
    Fixed(u64),
    /// A sequence; its bound, if it has one, does not change the bytes.
    Any,
}

/// A field of a message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) base: Base,
    pub(crate) count: Count,
}

/// All types of a schema.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Definitions {
    pub(crate) root: String,
    pub(crate) types: BTreeMap<String, Vec<Field>>,
}

/// The two dialects of message definitions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dialect {
    /// `ros1msg`: `time` and `duration` are built in, and `byte` has a sign.
    Ros1,
    /// `ros2msg`.
    Ros2,
}

/// Fields at which a schema is refused.
const MOST_FIELDS: usize = 1 << 16;

/// `pkg/Type` of a type name with or without `/msg/`.
pub(crate) fn short_name(name: &str) -> String {
    name.replace("/msg/", "/")
}

/// Parses the text of a `ros2msg` or `ros1msg` schema.
///
/// Constants, defaults and bounds are read over: none changes where the wanted bytes are.
///
/// # Errors
/// A sentence that says which line cannot be read.
pub(crate) fn parse(root: &str, text: &str, dialect: Dialect) -> Result<Definitions, String> {
    let root = short_name(root);
    if text.trim().is_empty() && !root.ends_with("/Empty") {
        return Err("its schema is empty".to_owned());
    }
    let mut types: BTreeMap<String, Vec<Field>> = BTreeMap::new();
    let mut current = root.clone();
    let mut fields = 0;
    types.insert(current.clone(), Vec::new());
    for line in text.lines().map(str::trim) {
        if line.len() >= 40 && line.bytes().all(|b| b == b'=') {
            continue;
        }
        if let Some(name) = line.strip_prefix("MSG:") {
            current = short_name(name.trim());
            types.insert(current.clone(), Vec::new());
        } else if line.starts_with("IDL:") {
            return Err("its schema is IDL, expected message definitions".to_owned());
        } else if let Some(field) = parse_line(line, &current, dialect)?
            && let Some(of_type) = types.get_mut(&current)
        {
            fields += 1;
            if fields > MOST_FIELDS {
                return Err("its schema is too large".to_owned());
            }
            of_type.push(field);
        }
    }
    add_well_known(&mut types);
    resolve_names(&mut types)?;
    Ok(Definitions { root, types })
}

/// Types that some writers take for granted.
fn add_well_known(types: &mut BTreeMap<String, Vec<Field>>) {
    let field = |name: &str, base: Base| Field { name: name.to_owned(), base, count: Count::One };
    let time = || {
        vec![
            field("sec", Base::Primitive(Primitive::I32)),
            field("nanosec", Base::Primitive(Primitive::U32)),
        ]
    };
    let mut add = |name: &str, fields: Vec<Field>| {
        types.entry(name.to_owned()).or_insert(fields);
    };
    add(TIME, time());
    add(DURATION, time());
    let stamp = field("stamp", Base::Message(TIME.to_owned()));
    add(HEADER, vec![stamp, field("frame_id", Base::String)]);
}

const TIME: &str = "builtin_interfaces/Time";
const DURATION: &str = "builtin_interfaces/Duration";
const HEADER: &str = "std_msgs/Header";

/// One line: a field, or nothing where it is blank, a comment or a constant.
fn parse_line(line: &str, inside: &str, dialect: Dialect) -> Result<Option<Field>, String> {
    let mut tokens = line.split_whitespace();
    let Some(ty) = tokens.next().filter(|t| !t.starts_with('#')) else {
        return Ok(None);
    };
    let unreadable = || {
        let line: String = line.chars().take(80).collect();
        format!("line `{line}` of `{inside}` in its schema cannot be read")
    };
    let name = tokens.next().filter(|n| !n.starts_with('#')).ok_or_else(unreadable)?;
    // A comment may follow a name without a blank between them.
    let (name, comment) = name.split_once('#').map_or((name, false), |(n, _)| (n, true));
    if name.contains('=') || !comment && tokens.next().is_some_and(|t| t.starts_with('=')) {
        return Ok(None);
    }
    if name.is_empty() || !name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') {
        return Err(unreadable());
    }
    let (element, count) = match ty.strip_suffix(']').and_then(|t| t.rsplit_once('[')) {
        None => (ty, Count::One),
        Some((element, "")) => (element, Count::Any),
        Some((element, bound)) if bound.starts_with("<=") => (element, Count::Any),
        Some((element, fixed)) => {
            let n = fixed.parse().map_err(|_| unreadable())?;
            (element, Count::Fixed(n))
        }
    };
    let (element, bounded) = element.split_once("<=").map_or((element, false), |(e, _)| (e, true));
    let base = match element {
        "string" => Base::String,
        "wstring" => Base::WideString,
        "" => return Err(unreadable()),
        // Only strings have a bound of their own.
        _ if bounded || element.contains(['[', ']', '<', '>']) => return Err(unreadable()),
        _ => named(element, dialect),
    };
    Ok(Some(Field { name: name.to_owned(), base, count }))
}

fn named(element: &str, dialect: Dialect) -> Base {
    match (dialect, element) {
        (Dialect::Ros1, "byte") => Base::Primitive(Primitive::I8),
        (Dialect::Ros1, "time") => Base::Message(TIME.to_owned()),
        (Dialect::Ros1, "duration") => Base::Message(DURATION.to_owned()),
        _ => Primitive::named(element)
            .map_or_else(|| Base::Message(short_name(element)), Base::Primitive),
    }
}

/// Makes every reference to a type a full name.
///
/// A relative name means the package that it stands in, then `std_msgs` (`Header`), then the only type of that name.
fn resolve_names(types: &mut BTreeMap<String, Vec<Field>>) -> Result<(), String> {
    let known: BTreeSet<String> = types.keys().cloned().collect();
    let mut by_last: BTreeMap<&str, Option<&String>> = BTreeMap::new();
    for full in &known {
        let last = full.rsplit('/').next().unwrap_or_default();
        by_last.entry(last).and_modify(|only| *only = None).or_insert(Some(full));
    }
    let resolve = |name: &str, inside: &str| -> Option<String> {
        let exact = |full: &str| known.get(full).cloned();
        if name.contains('/') {
            return exact(name);
        }
        let package = inside.split_once('/').map_or("", |(package, _)| package);
        exact(&format!("{package}/{name}"))
            .or_else(|| exact(&format!("std_msgs/{name}")))
            .or_else(|| by_last.get(name).copied().flatten().cloned())
    };
    for (inside, fields) in types.iter_mut() {
        for field in fields {
            if let Base::Message(name) = &mut field.base {
                *name = resolve(name, inside)
                    .ok_or_else(|| format!("type `{name}` in `{inside}` is not in its schema"))?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_defaults_constants_and_relative_names_are_understood() {
        let text = "uint8 A=1\nstring<=8 s \"x # y\"\nfloat64[<=3] d # three\nB[2] b\nint32[] n [1, 2]\n\
            ================================================================================\n\
            MSG: p/msg/B\nfloat32 x 1.5 # default";
        let found = parse("p/msg/A", text, Dialect::Ros2).unwrap();
        assert_eq!(found.root, "p/A");
        let fields = &found.types["p/A"];
        let counts: Vec<Count> = fields.iter().map(|f| f.count).collect();
        assert_eq!(counts, [Count::One, Count::Any, Count::Fixed(2), Count::Any]);
        assert_eq!(fields[2].base, Base::Message("p/B".to_owned()));
        assert_eq!(found.types["p/B"].len(), 1);
    }

    #[test]
    fn an_unknown_type_an_empty_schema_and_idl_are_refused_with_a_reason() {
        for (text, word) in [
            ("q/B b", "q/B"),
            (" \n", "empty"),
            ("IDL: p/msg/A", "IDL"),
            ("float64[x] y", "float64[x]"),
        ] {
            let error = parse("p/A", text, Dialect::Ros2).unwrap_err();
            assert!(error.contains(word), "{text}: {error}");
        }
    }

    #[test]
    fn every_primitive_has_its_size_and_names_are_found_in_any_package() {
        let text = "bool a\nbyte b\nchar c\nfloat32 d\nfloat64 e\nint8 f\nuint8 g\nint16 h\nuint16 i\nint32 j\n\
            uint32 k\nint64 l\nuint64 m\nstring n\nwstring o\nwstring<=5[<=2] p\nTime t\nHeader u\nOther v";
        let text = format!("{text}\n{}\nMSG: q/msg/Other\nint8 x", "=".repeat(80));
        let found = parse("p/A", &text, Dialect::Ros2).unwrap();
        let sizes: Vec<u8> = found.types["p/A"]
            .iter()
            .filter_map(|f| match f.base {
                Base::Primitive(p) => Some(p.size()),
                _ => None,
            })
            .collect();
        assert_eq!(sizes, [1, 1, 1, 4, 8, 1, 1, 2, 2, 4, 4, 8, 8]);
        let named: Vec<&Base> = found.types["p/A"][16..].iter().map(|f| &f.base).collect();
        let of = |name: &str| Base::Message(name.to_owned());
        assert_eq!(named, [&of(TIME), &of(HEADER), &of("q/Other")]);
    }

    #[test]
    fn constants_are_no_fields_however_they_are_written() {
        let text =
            "int32 A=1\nint32 B = 2\nstring C=\"x\" # why\nuint8 d#comment = 3\nstring e \"a = b\"";
        let found = parse("p/A", text, Dialect::Ros2).unwrap();
        let names: Vec<&str> = found.types["p/A"].iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["d", "e"]);
    }

    #[test]
    fn ros_1_has_time_built_in_and_a_header_with_a_number() {
        let text = format!(
            "Header header\ntime t\nbyte b\n{}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id",
            "=".repeat(80)
        );
        let found = parse("p/A", &text, Dialect::Ros1).unwrap();
        assert_eq!(found.types[HEADER].len(), 3);
        assert_eq!(found.types["p/A"][1].base, Base::Message(TIME.to_owned()));
        assert_eq!(found.types["p/A"][2].base, Base::Primitive(Primitive::I8));
    }

    #[test]
    fn every_name_of_a_number_is_its_own_kind() {
        use Primitive::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
        for (name, ros1, ros2) in [
            ("bool", U8, U8),
            ("byte", I8, U8),
            ("char", U8, U8),
            ("uint8", U8, U8),
            ("int8", I8, I8),
            ("uint16", U16, U16),
            ("int16", I16, I16),
            ("uint32", U32, U32),
            ("int32", I32, I32),
            ("uint64", U64, U64),
            ("int64", I64, I64),
            ("float32", F32, F32),
            ("float64", F64, F64),
        ] {
            for (dialect, expected) in [(Dialect::Ros1, ros1), (Dialect::Ros2, ros2)] {
                let found = parse("p/A", &format!("{name} x"), dialect).unwrap();
                let field = &found.types["p/A"][0];
                assert_eq!(
                    (&field.base, field.count),
                    (&Base::Primitive(expected), Count::One),
                    "{name}"
                );
            }
        }
    }

    #[test]
    fn lines_that_are_none_are_refused_with_the_line() {
        for line in [
            "float64",
            "float64 # x",
            "float64 a-b",
            "[3] x",
            "int32<=3 x",
            "string[3][2] x",
            "float64[-1] x",
            "float64 #x",
        ] {
            let error = parse("p/A", line, Dialect::Ros2).unwrap_err();
            assert_eq!(error, format!("line `{line}` of `p/A` in its schema cannot be read"));
        }
        let long = format!("float64 {}", "-".repeat(200));
        let error = parse("p/A", &long, Dialect::Ros2).unwrap_err();
        assert!(error.contains(&format!("`{}`", &long[..80])), "{error}");
        for line in ["# x", "", "float64 x#y", "float64 x #y", "int32 B = 2 # x", "string S=a b"] {
            assert!(parse("p/A", &format!("uint8 z\n{line}"), Dialect::Ros2).is_ok(), "{line}");
        }
        assert!(parse("p/Empty", "", Dialect::Ros2).unwrap().types["p/Empty"].is_empty());
    }

    #[test]
    fn a_schema_has_so_many_fields_and_no_more() {
        let of = |n: usize| parse("p/A", &"uint8 f\n".repeat(n), Dialect::Ros2);
        assert_eq!(of(MOST_FIELDS).unwrap().types["p/A"].len(), MOST_FIELDS);
        assert_eq!(of(MOST_FIELDS + 1).unwrap_err(), "its schema is too large");
    }

    #[test]
    fn a_relative_name_is_of_its_own_package_first_then_the_only_one() {
        let line = "=".repeat(80);
        let other = |package: &str| format!("{line}\nMSG: {package}/msg/B\nint8 x\n");
        let of =
            |text: &str| parse("p/A", text, Dialect::Ros2).map(|d| d.types["p/A"][0].base.clone());
        let message = |name: &str| Ok(Base::Message(name.to_owned()));
        assert_eq!(of(&format!("B b\n{}{}", other("q"), other("p"))), message("p/B"));
        assert_eq!(of(&format!("B b\n{}{}", other("q"), other("std_msgs"))), message("std_msgs/B"));
        assert_eq!(of(&format!("B b\n{}", other("q"))), message("q/B"));
        let error = of(&format!("B b\n{}{}", other("q"), other("r"))).unwrap_err();
        assert_eq!(error, "type `B` in `p/A` is not in its schema");
        // A line of 39 is no line between two types.
        let short = format!("uint8 a\n{}\nuint8 b", "=".repeat(39));
        assert!(of(&short).is_err());
    }
}

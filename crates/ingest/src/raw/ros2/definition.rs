//! `.msg` definitions: the text of a schema to types and their fields.

use std::collections::BTreeMap;

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

/// `pkg/Type` of a type name with or without `/msg/`.
pub(crate) fn short_name(name: &str) -> String {
    name.replace("/msg/", "/")
}

/// Parses the text of a `ros2msg` schema.
///
/// Constants, defaults and bounds are read over: none changes where the wanted bytes are.
///
/// # Errors
/// A sentence that says which line cannot be read.
pub(crate) fn parse(root: &str, text: &str) -> Result<Definitions, String> {
    let root = short_name(root);
    if text.trim().is_empty() && !root.ends_with("/Empty") {
        return Err("its schema is empty".to_owned());
    }
    let mut types: BTreeMap<String, Vec<Field>> = BTreeMap::new();
    let mut current = root.clone();
    types.insert(current.clone(), Vec::new());
    for line in text.lines().map(str::trim) {
        if line.len() >= 40 && line.bytes().all(|b| b == b'=') {
            continue;
        }
        if let Some(name) = line.strip_prefix("MSG:") {
            current = short_name(name.trim());
            types.insert(current.clone(), Vec::new());
        } else if line.starts_with("IDL:") {
            return Err("its schema is IDL, which is not read yet".to_owned());
        } else if let Some(field) = parse_line(line, &current)?
            && let Some(fields) = types.get_mut(&current)
        {
            fields.push(field);
        }
    }
    types
        .entry("builtin_interfaces/Time".to_owned())
        .or_insert_with(|| time_fields(Primitive::I32));
    types
        .entry("builtin_interfaces/Duration".to_owned())
        .or_insert_with(|| time_fields(Primitive::I32));
    resolve_names(&mut types)?;
    Ok(Definitions { root, types })
}

fn time_fields(sec: Primitive) -> Vec<Field> {
    let field = |name: &str, primitive| Field {
        name: name.to_owned(),
        base: Base::Primitive(primitive),
        count: Count::One,
    };
    vec![field("sec", sec), field("nanosec", Primitive::U32)]
}

/// One line: a field, or nothing where it is blank, a comment or a constant.
fn parse_line(line: &str, inside: &str) -> Result<Option<Field>, String> {
    let mut tokens = line.split_whitespace();
    let Some(ty) = tokens.next().filter(|t| !t.starts_with('#')) else {
        return Ok(None);
    };
    let unreadable = || format!("line `{line}` of `{inside}` in its schema cannot be read");
    let name = tokens
        .next()
        .filter(|n| !n.starts_with('#'))
        .ok_or_else(unreadable)?;
    if name.contains('=') || tokens.next().is_some_and(|t| t.starts_with('=')) {
        return Ok(None);
    }
    // A comment may follow a name without a blank between them.
    let name = name.split('#').next().unwrap_or_default();
    let (element, count) = match ty.strip_suffix(']').and_then(|t| t.rsplit_once('[')) {
        None => (ty, Count::One),
        Some((element, "")) => (element, Count::Any),
        Some((element, bound)) if bound.starts_with("<=") => (element, Count::Any),
        Some((element, fixed)) => {
            let n = fixed.parse().map_err(|_| unreadable())?;
            (element, Count::Fixed(n))
        }
    };
    let element = element.split("<=").next().unwrap_or_default();
    let base = match element {
        "string" => Base::String,
        "wstring" => Base::WideString,
        "" => return Err(unreadable()),
        _ => match Primitive::named(element) {
            Some(primitive) => Base::Primitive(primitive),
            None => Base::Message(short_name(element)),
        },
    };
    Ok(Some(Field {
        name: name.to_owned(),
        base,
        count,
    }))
}

/// Makes every reference to a type a full name: relative names mean the package that they stand in.
fn resolve_names(types: &mut BTreeMap<String, Vec<Field>>) -> Result<(), String> {
    let known: Vec<String> = types.keys().cloned().collect();
    let resolve = |name: &str, inside: &str| -> Option<String> {
        let exact = |full: &str| known.iter().find(|k| *k == full).cloned();
        if name.contains('/') {
            return exact(name);
        }
        let package = inside.rsplit_once('/').map_or("", |(package, _)| package);
        exact(&format!("{package}/{name}"))
            .or_else(|| exact(&format!("std_msgs/{name}")))
            .or_else(|| exact(name))
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
        let found = parse("p/msg/A", text).unwrap();
        assert_eq!(found.root, "p/A");
        let fields = &found.types["p/A"];
        let counts: Vec<Count> = fields.iter().map(|f| f.count).collect();
        assert_eq!(
            counts,
            [Count::One, Count::Any, Count::Fixed(2), Count::Any]
        );
        assert_eq!(fields[2].base, Base::Message("p/B".to_owned()));
        assert_eq!(found.types["p/B"].len(), 1);
    }

    #[test]
    fn an_unknown_type_an_empty_schema_and_idl_are_refused_with_a_reason() {
        assert!(parse("p/A", "q/B b").unwrap_err().contains("q/B"));
        assert!(parse("p/A", " \n").unwrap_err().contains("empty"));
        assert!(parse("p/A", "IDL: p/msg/A").unwrap_err().contains("IDL"));
        assert!(
            parse("p/A", "float64[x] y")
                .unwrap_err()
                .contains("float64[x]")
        );
    }
}

//! A plan: which bytes of a message are wanted, compiled once per channel from its definition.

use super::{
    cdr::{CdrError, Reader},
    definition::{Base, Count, Definitions, Field, Primitive},
};

/// Depth at which a definition that contains itself is refused.
const MOST_DEPTH: usize = 32;
/// Steps at which a definition that grows without bound is refused.
const MOST_STEPS: usize = 1 << 16;

#[derive(Debug, Clone, PartialEq, Eq)]
enum Step {
    /// Pass over `count` numbers of `size` bytes.
    Skip { size: u8, count: u64 },
    /// Put a number into a slot.
    Take { primitive: Primitive, slot: usize },
    /// Put some numbers of an array or a sequence into slots: `(index, slot)`.
    TakeSome {
        primitive: Primitive,
        fixed: Option<u64>,
        wanted: Vec<(u64, usize)>,
    },
    /// Pass over a string.
    SkipString,
    /// Pass over a sequence of numbers of `size` bytes.
    SkipSequence { size: u8 },
    /// Pass over an array (`fixed`) or a sequence of what `body` describes.
    Repeat { fixed: Option<u64>, body: Vec<Self> },
    /// A sequence each of whose elements gives a row; `slots` are emptied before each.
    Rows { body: Vec<Self>, slots: Vec<usize> },
}

/// Which bytes of a channel's messages are wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Plan {
    steps: Vec<Step>,
    slots: usize,
}

struct Compiler<'a> {
    definitions: &'a Definitions,
    wanted: &'a [&'a str],
    found: Vec<bool>,
    steps: usize,
}

impl Plan {
    /// Compiles a plan that fills slot i with the number at path `wanted[i]`.
    ///
    /// A path names fields down from the root: `header.stamp.sec`, `objects[].id` (a row for each element)
    /// or `shape.dimensions[0]` (one number of a sequence). One that ends in `?` may be missing.
    ///
    /// # Errors
    /// A sentence that says what is missing or cannot be followed.
    pub(crate) fn compile(definitions: &Definitions, wanted: &[&str]) -> Result<Self, String> {
        let mut compiler = Compiler {
            definitions,
            wanted,
            found: vec![false; wanted.len()],
            steps: 0,
        };
        let mut steps = compiler.message(&definitions.root, "", 0)?;
        let missing = |(path, found): &(&&str, &bool)| !**found && !path.ends_with('?');
        if let Some((path, _)) = wanted.iter().zip(&compiler.found).find(missing) {
            let root = &definitions.root;
            return Err(format!("`{root}` in its schema has no number `{path}`"));
        }
        if !wanted.is_empty() {
            // Nothing behind the last wanted field needs to be walked.
            let last = steps.iter().rposition(takes);
            steps.truncate(last.map_or(0, |last| last + 1));
        }
        if steps.iter().any(wide) {
            return Err("a wstring stands before the wanted fields: its width varies".to_owned());
        }
        Ok(Self {
            steps,
            slots: wanted.len(),
        })
    }

    /// Walks a message: `row` is filled, and given to `each` for every element of the wanted sequence.
    ///
    /// Slots of fields that are missing hold NaN. Returns the bytes left over.
    ///
    /// # Errors
    /// [`CdrError`] where the message does not fit its definition.
    pub(crate) fn run(
        &self,
        message: &[u8],
        row: &mut Vec<f64>,
        each: &mut dyn FnMut(&[f64]),
    ) -> Result<usize, CdrError> {
        row.clear();
        row.resize(self.slots, f64::NAN);
        let mut reader = Reader::new(message)?;
        walk(&self.steps, &mut reader, row, each)?;
        Ok(reader.remaining())
    }
}

fn takes(step: &Step) -> bool {
    match step {
        Step::Take { .. } | Step::TakeSome { .. } | Step::Rows { .. } => true,
        Step::Repeat { body, .. } => body.iter().any(takes),
        _ => false,
    }
}

/// Marks a wide string: its characters have 2 or 4 bytes, depending on who wrote them.
const WIDE: u8 = 0;

fn wide(step: &Step) -> bool {
    match step {
        Step::SkipSequence { size } => *size == WIDE,
        Step::Repeat { body, .. } | Step::Rows { body, .. } => body.iter().any(wide),
        _ => false,
    }
}

impl Compiler<'_> {
    fn message(&mut self, name: &str, prefix: &str, depth: usize) -> Result<Vec<Step>, String> {
        if depth > MOST_DEPTH {
            return Err(format!("type `{name}` in its schema contains itself"));
        }
        // `definition::parse` made sure that every name is there.
        let fields: &[Field] = self.definitions.types.get(name).map_or(&[], Vec::as_slice);
        if fields.is_empty() {
            // ROS 2 gives a message without fields one byte.
            return Ok(vec![Step::Skip { size: 1, count: 1 }]);
        }
        let mut steps: Vec<Step> = Vec::new();
        for field in fields {
            self.steps += 1;
            if self.steps > MOST_STEPS {
                return Err("its schema is too large".to_owned());
            }
            let path = if prefix.is_empty() {
                field.name.clone()
            } else {
                format!("{prefix}.{}", field.name)
            };
            self.field(field, &path, depth, &mut steps)?;
        }
        Ok(steps)
    }

    fn field(
        &mut self,
        field: &Field,
        path: &str,
        depth: usize,
        steps: &mut Vec<Step>,
    ) -> Result<(), String> {
        let fixed = match field.count {
            Count::Fixed(0) => return Ok(()),
            Count::Fixed(n) => Some(n),
            Count::One | Count::Any => None,
        };
        match (&field.base, field.count) {
            (Base::Primitive(p), Count::One) => match self.slot(path) {
                Some(slot) => steps.push(Step::Take {
                    primitive: *p,
                    slot,
                }),
                None => skip(steps, p.size(), 1),
            },
            (Base::Primitive(p), count) => {
                let wanted = self.elements(path);
                match (wanted.is_empty(), count) {
                    (false, _) => steps.push(Step::TakeSome {
                        primitive: *p,
                        fixed,
                        wanted,
                    }),
                    (true, Count::Fixed(n)) => skip(steps, p.size(), n),
                    (true, _) => steps.push(Step::SkipSequence { size: p.size() }),
                }
            }
            (Base::String | Base::WideString, count) => {
                let step = if field.base == Base::String {
                    Step::SkipString
                } else {
                    Step::SkipSequence { size: WIDE }
                };
                steps.push(match count {
                    Count::One => step,
                    Count::Fixed(_) | Count::Any => Step::Repeat {
                        fixed,
                        body: vec![step],
                    },
                });
            }
            (Base::Message(name), Count::One) => {
                for step in self.message(name, path, depth + 1)? {
                    match step {
                        Step::Skip { size, count } => skip(steps, size, count),
                        step => steps.push(step),
                    }
                }
            }
            (Base::Message(name), count) => {
                let before = self.found.clone();
                let body = self.message(name, &format!("{path}[]"), depth + 1)?;
                let slots: Vec<usize> = (0..before.len())
                    .filter(|&i| self.found[i] && !before[i])
                    .collect();
                if count == Count::Any && !slots.is_empty() {
                    steps.push(Step::Rows { body, slots });
                } else if fixed.is_none() || !body.is_empty() {
                    steps.push(Step::Repeat { fixed, body });
                }
            }
        }
        Ok(())
    }

    fn slot(&mut self, path: &str) -> Option<usize> {
        let slot = self
            .wanted
            .iter()
            .position(|w| w.trim_end_matches('?') == path)?;
        self.found[slot] = true;
        Some(slot)
    }

    /// The wanted elements of a sequence of numbers.
    fn elements(&mut self, path: &str) -> Vec<(u64, usize)> {
        let mut wanted = Vec::new();
        for (slot, want) in self.wanted.iter().enumerate() {
            let index = want
                .trim_end_matches('?')
                .strip_prefix(path)
                .and_then(|rest| rest.strip_prefix('[')?.strip_suffix(']')?.parse().ok());
            if let Some(index) = index {
                self.found[slot] = true;
                wanted.push((index, slot));
            }
        }
        wanted
    }
}

/// Adds a skip, joined to the one before where the numbers have the same size.
fn skip(steps: &mut Vec<Step>, size: u8, count: u64) {
    if let Some(Step::Skip {
        size: last,
        count: so_far,
    }) = steps.last_mut()
        && *last == size
    {
        *so_far = so_far.saturating_add(count);
    } else {
        steps.push(Step::Skip { size, count });
    }
}

fn walk(
    steps: &[Step],
    reader: &mut Reader<'_>,
    row: &mut [f64],
    each: &mut dyn FnMut(&[f64]),
) -> Result<(), CdrError> {
    for step in steps {
        match step {
            Step::Skip { size, count } => reader.skip(*size, *count)?,
            Step::Take { primitive, slot } => row[*slot] = reader.number(*primitive)?,
            Step::TakeSome {
                primitive,
                fixed,
                wanted,
            } => {
                let count = fixed.map_or_else(|| reader.count(), Ok)?;
                let last = wanted.iter().map(|w| w.0).max().unwrap_or(0);
                for index in 0..count.min(last + 1) {
                    let value = reader.number(*primitive)?;
                    for (_, slot) in wanted.iter().filter(|w| w.0 == index) {
                        row[*slot] = value;
                    }
                }
                reader.skip(primitive.size(), count.saturating_sub(last + 1))?;
            }
            Step::SkipString => {
                let length = reader.count()?;
                reader.skip(1, length)?;
            }
            Step::SkipSequence { size } => {
                let count = reader.count()?;
                reader.skip(*size, count)?;
            }
            Step::Repeat { fixed, body } => {
                let count = fixed.map_or_else(|| reader.count(), Ok)?;
                // A body that is not empty takes at least a byte, so a claimed count cannot run for long.
                for _ in 0..if body.is_empty() { 0 } else { count } {
                    walk(body, reader, row, each)?;
                }
            }
            Step::Rows { body, slots } => {
                for _ in 0..reader.count()? {
                    for &slot in slots {
                        row[slot] = f64::NAN;
                    }
                    // Nothing within a row gives rows of its own to this caller.
                    walk(body, reader, row, &mut |_| {})?;
                    each(row);
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw::ros2::{cdr::Writer, definition::parse};

    #[test]
    fn wanted_numbers_are_taken_and_the_rest_is_passed_over() {
        let text = "string name\nuint8 a\nfloat64[3] skipped\nP[] rows\nint32 last\n\
            ================================================================================\n\
            MSG: p/P\nuint8 id\nfloat64[<=3] size";
        let definitions = parse("p/M", text).unwrap();
        let plan = Plan::compile(
            &definitions,
            &["a", "rows[].id", "rows[].size[1]", "rows[].colour?"],
        )
        .unwrap();
        let mut writer = Writer::new();
        writer.string("hello");
        writer.u8(9);
        writer.f64s(&[0.0; 3]);
        writer.u32(2);
        for (id, size) in [(1, &[4.0, 2.0][..]), (2, &[4.0][..])] {
            writer.u8(id);
            writer.u32(size.len() as u32);
            writer.f64s(size);
        }
        writer.u32(5);
        let mut seen = Vec::new();
        let mut row = Vec::new();
        let left = plan
            .run(writer.bytes(), &mut row, &mut |r| seen.push(r.to_vec()))
            .unwrap();
        assert_eq!(left, 4, "the last field is not walked");
        assert_eq!(seen[0][..3], [9.0, 1.0, 2.0]);
        assert_eq!(seen[1][..2], [9.0, 2.0]);
        assert!(seen[1][2].is_nan() && seen[1][3].is_nan());
    }

    #[test]
    fn a_type_that_contains_itself_and_a_missing_field_are_refused() {
        let itself = parse("p/A", "p/A[] a\nint32 x").unwrap();
        assert!(Plan::compile(&itself, &[]).unwrap_err().contains("itself"));
        let plain = parse("p/A", "int32 x").unwrap();
        assert!(Plan::compile(&plain, &["y"]).unwrap_err().contains("`y`"));
    }

    #[test]
    fn a_huge_claimed_count_ends_with_the_bytes() {
        let definitions = parse("p/A", "string[] s").unwrap();
        let plan = Plan::compile(&definitions, &[]).unwrap();
        let found = plan.run(
            &[0, 1, 0, 0, 255, 255, 255, 255],
            &mut Vec::new(),
            &mut |_| {},
        );
        assert_eq!(found, Err(CdrError::End));
    }
}

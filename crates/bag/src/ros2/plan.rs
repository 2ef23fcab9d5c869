//! A plan: which bytes of a message are wanted, compiled once per channel from its definition.

use super::{
    cdr::{CdrError, Layout, Reader},
    definition::{Base, Count, Definitions, Dialect, Field, Primitive},
    step::{Block, Step},
    walk::walk,
};
use crate::wanted;

/// Depth at which a definition that contains itself is refused.
const MOST_DEPTH: usize = 32;
/// Steps at which a definition that grows without bound is refused.
const MOST_STEPS: usize = 1 << 16;
/// Bytes that a message may have behind its last field: padding to the next multiple of eight.
pub(crate) const MOST_PADDING: usize = 7;

/// Which bytes of a channel's messages are wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Plan {
    /// For layouts without sizes before structures.
    plain: Vec<Step>,
    /// For layouts with them.
    delimited: Vec<Step>,
    slots: usize,
    /// Whether wide strings, whose width is not declared, stand on the way.
    wide: bool,
    dialect: Dialect,
}

struct Compiler<'a> {
    definitions: &'a Definitions,
    wanted: &'a [&'a str],
    found: Vec<bool>,
    steps: usize,
    structures: bool,
    dialect: Dialect,
}

impl Plan {
    /// Compiles a plan that fills slot i with the number at path `wanted[i]`.
    ///
    /// A path names fields down from the root: `header.stamp.sec`, `objects[].id` (a row for each element),
    /// `shape.dimensions[0]` (one number of a sequence) or `classes[0].label` (of the first element of a sequence).
    /// Alternatives are separated by `|`; one that ends in `?`, and an empty one, may be missing. A path to a string ends in
    /// `#`: its slot takes the string's [`wanted::name_number`].
    ///
    /// # Errors
    /// A sentence that says what is missing or cannot be followed.
    pub(crate) fn compile(
        definitions: &Definitions,
        wanted: &[&str],
        dialect: Dialect,
    ) -> Result<Self, String> {
        let compile = |structures: bool| -> Result<Vec<Step>, String> {
            let mut compiler = Compiler {
                definitions,
                wanted,
                found: vec![false; wanted.len()],
                steps: 0,
                structures,
                dialect,
            };
            let mut steps = compiler.message(&definitions.root, "", 0)?;
            wanted::all_matched(&definitions.root, wanted, &compiler.found)?;
            if !wanted.is_empty() && !structures {
                // Nothing behind the last wanted field needs to be walked.
                let last = steps.iter().rposition(takes);
                steps.truncate(last.map_or(0, |last| last + 1));
            }
            settle(&mut steps)?;
            Ok(steps)
        };
        let plain = compile(false)?;
        let delimited = match dialect {
            Dialect::Ros1 => Vec::new(),
            Dialect::Ros2 => compile(true)?,
        };
        Ok(Self { wide: plain.iter().any(wide), plain, delimited, slots: wanted.len(), dialect })
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
        let (bytes, layout) = match self.dialect {
            Dialect::Ros1 => (message, Layout::ROS1),
            Dialect::Ros2 => {
                let (head, bytes) = message.split_first_chunk::<4>().ok_or(CdrError::End)?;
                (bytes, Layout::declared(*head)?)
            }
        };
        let layout = if self.wide { self.as_wide_as_fits(bytes, layout, row) } else { layout };
        self.run_as(bytes, layout, row, each)
    }

    fn run_as(
        &self,
        bytes: &[u8],
        layout: Layout,
        row: &mut Vec<f64>,
        each: &mut dyn FnMut(&[f64]),
    ) -> Result<usize, CdrError> {
        row.clear();
        row.resize(self.slots, f64::NAN);
        let mut reader = Reader::new(bytes, layout);
        let steps = if layout.delimited_structures { &self.delimited } else { &self.plain };
        walk(steps, &mut reader, row, each)?;
        Ok(reader.remaining())
    }

    /// Recorders differ in the width of a wide character, and none says it: of the two the one under which a message fits whole,
    /// else fits at all.
    fn as_wide_as_fits(&self, bytes: &[u8], layout: Layout, row: &mut Vec<f64>) -> Layout {
        let both = [layout, Layout { wide: 2, ..layout }];
        let left = both.map(|layout| self.run_as(bytes, layout, row, &mut |_| {}).ok());
        let whole = left.iter().position(|left| left.is_some_and(|n| n <= MOST_PADDING));
        both[whole.or_else(|| left.iter().position(Option::is_some)).unwrap_or(0)]
    }
}

fn takes(step: &Step) -> bool {
    match step {
        Step::Block(block) => block.runs.iter().any(|run| run.2.is_some()),
        Step::TakeSome { .. } | Step::TakeName { .. } | Step::Rows { .. } => true,
        Step::Repeat { first, .. } => first.is_some(),
        Step::Structure(body) => body.iter().any(takes),
        Step::SkipString | Step::SkipWide | Step::SkipSequence { .. } => false,
    }
}

fn wide(step: &Step) -> bool {
    match step {
        Step::SkipWide => true,
        Step::Repeat { body, .. } | Step::Rows { body, .. } | Step::Structure(body) => {
            body.iter().any(wide)
        }
        _ => false,
    }
}

/// Works out where the numbers of every block lie.
fn settle(steps: &mut [Step]) -> Result<(), String> {
    for step in steps {
        match step {
            Step::Block(block) => block.settle()?,
            Step::Repeat { body, first, .. } => {
                settle(body)?;
                settle(first.as_deref_mut().unwrap_or_default())?;
            }
            Step::Rows { body, .. } | Step::Structure(body) => settle(body)?,
            _ => {}
        }
    }
    Ok(())
}

/// Whether a body takes no byte of a message, so that any number of them fits anywhere.
fn is_nothing(body: &[Step]) -> bool {
    body.iter().all(|step| match step {
        Step::Block(block) => block.runs.iter().all(|run| run.1 == 0),
        Step::Repeat { fixed, body, .. } => fixed.is_some() && is_nothing(body),
        Step::Structure(body) => is_nothing(body),
        _ => false,
    })
}

impl Compiler<'_> {
    fn message(&mut self, name: &str, prefix: &str, depth: usize) -> Result<Vec<Step>, String> {
        if depth > MOST_DEPTH {
            return Err(format!("type `{name}` in its schema contains itself"));
        }
        // `definition::parse` made sure that every name is there.
        let definitions = self.definitions;
        let fields: &[Field] = definitions.types.get(name).map_or(&[], Vec::as_slice);
        let mut steps: Vec<Step> = Vec::new();
        if fields.is_empty() && self.dialect == Dialect::Ros2 {
            // ROS 2 gives a message without fields one byte.
            push(&mut steps, Primitive::U8, 1, None);
        }
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
        Ok(if self.structures { vec![Step::Structure(steps)] } else { steps })
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
            (Base::Primitive(p), Count::One) => {
                let slot = self.slot(path);
                push(steps, *p, 1, slot);
            }
            (Base::Primitive(p), count) => {
                let wanted = self.elements(path);
                match (wanted.is_empty(), count) {
                    (false, _) => steps.push(Step::TakeSome { primitive: *p, fixed, wanted }),
                    (true, Count::Fixed(n)) => push(steps, *p, n, None),
                    (true, _) => steps.push(Step::SkipSequence { size: p.size() }),
                }
            }
            (Base::String, Count::One) => steps.push(match self.slot(&format!("{path}#")) {
                Some(slot) => Step::TakeName { slot },
                None => Step::SkipString,
            }),
            (Base::String | Base::WideString, count) => {
                let step =
                    if field.base == Base::String { Step::SkipString } else { Step::SkipWide };
                steps.push(match count {
                    Count::One => step,
                    Count::Fixed(_) | Count::Any => {
                        Step::Repeat { fixed, body: vec![step], first: None }
                    }
                });
            }
            (Base::Message(name), Count::One) => {
                for step in self.message(name, path, depth + 1)? {
                    match step {
                        Step::Block(block) => {
                            for (primitive, count, slot) in block.runs {
                                push(steps, primitive, count, slot);
                            }
                        }
                        step => steps.push(step),
                    }
                }
            }
            (Base::Message(name), count) => {
                let before = self.found.clone();
                let body = self.message(name, &format!("{path}[]"), depth + 1)?;
                let slots: Vec<usize> =
                    (0..before.len()).filter(|&i| self.found[i] && !before[i]).collect();
                if count == Count::Any && !slots.is_empty() {
                    steps.push(Step::Rows { body, slots });
                    return Ok(());
                }
                let at_first = format!("{path}[0]");
                let first = if self.wants_within(&at_first) {
                    Some(self.message(name, &at_first, depth + 1)?)
                } else {
                    None
                };
                if fixed.is_none() || !is_nothing(&body) {
                    steps.push(Step::Repeat { fixed, body, first });
                }
            }
        }
        Ok(())
    }

    fn slot(&mut self, path: &str) -> Option<usize> {
        let is_it = |want: &&str| wanted::alternatives(want).any(|w| w == path);
        let slot = self.wanted.iter().position(is_it)?;
        self.found[slot] = true;
        Some(slot)
    }

    fn wants_within(&self, path: &str) -> bool {
        let mut paths = self.wanted.iter().flat_map(|w| wanted::alternatives(w));
        paths.any(|w| w.strip_prefix(path).is_some_and(|rest| rest.starts_with('.')))
    }

    /// The wanted elements of a sequence of numbers.
    fn elements(&mut self, path: &str) -> Vec<(u64, usize)> {
        let mut elements = Vec::new();
        for (slot, want) in self.wanted.iter().enumerate() {
            let index = wanted::alternatives(want).find_map(|w| {
                let rest = w.strip_prefix(path)?;
                rest.strip_prefix('[')?.strip_suffix(']')?.parse().ok()
            });
            if let Some(index) = index {
                self.found[slot] = true;
                elements.push((index, slot));
            }
        }
        elements
    }
}

/// Adds numbers, to the block before where there is one.
fn push(steps: &mut Vec<Step>, primitive: Primitive, count: u64, slot: Option<usize>) {
    let run = (primitive, count, slot);
    match steps.last_mut() {
        Some(Step::Block(block)) => match block.runs.last_mut() {
            Some((last, so_far, None)) if *last == primitive && slot.is_none() => {
                *so_far = so_far.saturating_add(count);
            }
            _ => block.runs.push(run),
        },
        _ => steps.push(Step::Block(Block::from_run(run))),
    }
}

#[cfg(test)]
mod tests;

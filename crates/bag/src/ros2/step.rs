//! Steps along a message, and where the wanted numbers of each lie.

use super::definition::Primitive;

/// One step along a message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Step {
    /// Numbers one after another, of known places.
    Block(Block),
    /// Put some numbers of an array or a sequence into slots: `(index, slot)`.
    TakeSome { primitive: Primitive, fixed: Option<u64>, wanted: Vec<(u64, usize)> },
    /// Pass over a string.
    SkipString,
    /// Put a name into a slot, as [`wanted::name_number`].
    TakeName { slot: usize },
    /// Pass over a string of wide characters.
    SkipWide,
    /// Pass over a sequence of numbers of `size` bytes.
    SkipSequence { size: u8 },
    /// Pass over an array (`fixed`) or a sequence of what `body` describes; with `first`, the first element's numbers
    /// are taken.
    Repeat { fixed: Option<u64>, body: Vec<Self>, first: Option<Vec<Self>> },
    /// A sequence each of whose elements gives a row; `slots` are emptied before each.
    Rows { body: Vec<Self>, slots: Vec<usize> },
    /// A structure that may start with its size.
    Structure(Vec<Self>),
}

/// Numbers one after another: where each wanted one lies depends on where the block starts alone.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Block {
    /// Size and count of each run of numbers, and the slot of a wanted one.
    pub(super) runs: Vec<(Primitive, u64, Option<usize>)>,
    /// By start modulo 8, for XCDR1.
    by_eight: Vec<Places>,
    /// By start modulo 4, for XCDR2.
    by_four: Vec<Places>,
    /// Without alignment, for ROS 1.
    packed: Vec<Places>,
}

/// Where the wanted numbers of a block lie.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Places {
    pub(super) length: u64,
    /// Offset from the block's start, what it is, and its slot.
    pub(super) takes: Vec<(u32, Primitive, u32)>,
}

impl Block {
    /// A block of one run: what its numbers are, how many, and the slot of a wanted one.
    pub(super) fn from_run(run: (Primitive, u64, Option<usize>)) -> Self {
        Self { runs: vec![run], ..Self::default() }
    }

    /// The places for a block that starts at `at`.
    pub(super) fn places(&self, at: usize, most_align: usize) -> Option<&Places> {
        match most_align {
            8 => self.by_eight.get(at % 8),
            4 => self.by_four.get(at % 4),
            _ => self.packed.first(),
        }
    }

    /// Works out where its numbers lie.
    ///
    /// # Errors
    /// A sentence where they do not fit into a message.
    pub(super) fn settle(&mut self) -> Result<(), String> {
        let by_start = |most_align: usize| -> Result<Vec<Places>, String> {
            (0..most_align).map(|start| self.lay_out(start, most_align)).collect()
        };
        (self.by_eight, self.by_four, self.packed) = (by_start(8)?, by_start(4)?, by_start(1)?);
        self.runs = Vec::new();
        Ok(())
    }

    fn lay_out(&self, start: usize, most_align: usize) -> Result<Places, String> {
        let start = start as u64;
        let mut position = start;
        let mut takes = Vec::new();
        for &(primitive, count, slot) in &self.runs {
            let size = u64::from(primitive.size());
            position = position.next_multiple_of(size.min(most_align as u64));
            if let Some(slot) = slot {
                takes.push(((position - start) as u32, primitive, slot as u32));
            }
            position = position.saturating_add(size.saturating_mul(count));
            if position > u64::from(u32::MAX) {
                return Err("an array in its schema is too large".to_owned());
            }
        }
        Ok(Places { length: position - start, takes })
    }
}

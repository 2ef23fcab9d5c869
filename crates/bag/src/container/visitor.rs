//! How a recording is walked, and what a walk gives.

use crate::record::Record;

/// A part of a file that could not be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Damage {
    /// Where it was met.
    pub at_byte: u64,
    /// What is wrong there.
    pub what: String,
    /// Time of receipt of the last message before it and of the first one after it, in ns.
    pub between_ns: (Option<u64>, Option<u64>),
}

/// Takes what a file holds.
pub trait Visitor {
    /// The next record.
    fn record(&mut self, record: Record<'_>);
    /// Another recording begins in the same file: numbers of schemas and channels are its own.
    fn begin(&mut self) {}
    /// A message that is too long to be read was passed over.
    fn passed_over(&mut self);
    /// A chunk begins: remember where you are.
    fn mark(&mut self);
    /// The chunk turned out to be damaged: forget its messages.
    fn roll_back(&mut self);
}

/// How a recording is walked.
#[derive(Debug, Clone, Copy, Default)]
pub struct Walk {
    /// Whether damage is stepped over and returned.
    pub recover: bool,
    /// Whether the file is hashed on the way.
    pub hash: bool,
}

/// What a walk found besides the records.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Walked {
    /// What is damaged; empty without [`Walk::recover`].
    pub damage: Vec<Damage>,
    /// BLAKE3 of all the file's bytes in hexadecimal digits, with [`Walk::hash`].
    pub blake3: Option<String>,
}

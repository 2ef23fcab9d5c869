//! Where the records of a recording lie.

pub(crate) const FOOTER: u8 = 2;
pub(crate) const SCHEMA: u8 = 3;
pub(crate) const CHANNEL: u8 = 4;
pub(crate) const CHUNK: u8 = 6;

/// Opcode, start and end of every record up to the footer.
pub(crate) fn records(bytes: &[u8]) -> Vec<(u8, usize, usize)> {
    let mut found = Vec::new();
    let mut at = 8;
    loop {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap());
        let end = at + 9 + usize::try_from(length).unwrap();
        found.push((bytes[at], at, end));
        if bytes[at] == FOOTER {
            return found;
        }
        at = end;
    }
}

/// Start and end of the records of one kind.
pub(crate) fn of_kind(bytes: &[u8], opcode: u8) -> Vec<(usize, usize)> {
    let all = records(bytes).into_iter();
    all.filter(|r| r.0 == opcode).map(|r| (r.1, r.2)).collect()
}

pub(crate) fn chunks(bytes: &[u8]) -> Vec<(usize, usize)> {
    of_kind(bytes, CHUNK)
}

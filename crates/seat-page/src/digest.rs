//! One number for all states of a drive.

/// FNV-1a, 64 bits, over the bits of every number given: two drives with the same digest went through the same states.
///
/// # Example
/// ```
/// # use maveric_seat_page::Digest;
/// let mut one = Digest::default();
/// one.add(1.0);
/// let mut other = Digest::default();
/// other.add(1.0 + f64::EPSILON);
/// assert_ne!(one.to_string(), other.to_string());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    pub fn add(&mut self, number: f64) {
        for byte in number.to_bits().to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

impl std::fmt::Display for Digest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

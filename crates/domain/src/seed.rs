//! One root seed, one stream per thing.

/// The seed of a stream that belongs to `labels`, such as a participant and a condition.
///
/// Each stream depends on the root seed and its own labels alone, so adding a participant
/// changes nobody else's drive. FNV-1a over the labels, then the `SplitMix64` finaliser.
///
/// # Example
/// ```
/// # use maveric_domain::stream_seed;
/// assert_eq!(stream_seed(1, &["S2P01", "mimic"]), stream_seed(1, &["S2P01", "mimic"]));
/// assert_ne!(stream_seed(1, &["S2P01", "mimic"]), stream_seed(1, &["S2P01m", "imic"]));
/// ```
pub fn stream_seed(root: u64, labels: &[&str]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64 ^ root;
    for label in labels {
        for byte in label.bytes().chain([0xff]) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    let mut z = hash.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

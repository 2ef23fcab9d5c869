//! Sets of factors.

/// Every set of some of so many factors, a bit each: the smallest first, within one size those of the first factors first.
pub(crate) fn sets_of_factors(count: usize) -> Vec<usize> {
    let mut sets: Vec<usize> = (1..1 << count).collect();
    sets.sort_by_key(|set| (set.count_ones(), std::cmp::Reverse(set.reverse_bits())));
    sets
}

//! Mid-ranks, doubled so that they are whole numbers.

/// Twice the mid-ranks (1 to n) of the keys, and Σ (t³ - t) over groups of t tied keys.
pub(crate) fn doubled<K: PartialOrd + Copy>(keys: &[K]) -> (Vec<i64>, f64) {
    let mut order: Vec<(K, usize)> = keys.iter().copied().zip(0..).collect();
    order.sort_unstable_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal));
    let mut ranks = vec![0; keys.len()];
    let mut ties = 0.0;
    let mut start = 0;
    while start < order.len() {
        let mut end = start + 1;
        while end < order.len() && order[end].0 <= order[start].0 {
            end += 1;
        }
        // The mean of ranks start + 1 ..= end, twice.
        for &(_, i) in &order[start..end] {
            ranks[i] = (start + 1 + end) as i64;
        }
        let t = (end - start) as f64;
        ties += t * t * t - t;
        start = end;
    }
    (ranks, ties)
}

/// Of two whole numbers, none below 0: ranks in the largest step that all share.
pub(crate) fn greatest_common_divisor<N>(a: N, b: N) -> N
where
    N: Copy + Default + PartialEq + std::ops::Rem<Output = N>,
{
    if b == N::default() { a } else { greatest_common_divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tied_values_share_the_mean_rank() {
        let (ranks, ties) = doubled(&[3.0, 1.0, 3.0, 7.0]);
        assert_eq!(ranks, [5, 2, 5, 8]);
        assert!((ties - 6.0).abs() < 1e-12);
    }
}

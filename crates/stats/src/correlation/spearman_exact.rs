//! The exact distribution of Spearman's ρ, given the ties.
//!
//! The n! pairings are counted without listing them: which half of the y ranks goes to the
//! first half of the x ranks is listed (2^n sets), and within each half the distribution of
//! Σ xy is built one rank at a time.

/// Pairs up to which all pairings are counted.
pub(super) const MOST_PAIRS: usize = 14;

/// How often each value of Σ xy occurs, from `lowest` upwards.
#[derive(Clone, Default)]
struct Counts {
    lowest: i64,
    counts: Vec<f64>,
}

impl Counts {
    fn add_shifted(&mut self, other: &Self, shift: i64) {
        let low = other.lowest + shift;
        let high = low + other.counts.len() as i64;
        if self.counts.is_empty() {
            self.lowest = low;
        }
        if low < self.lowest {
            let missing = (self.lowest - low) as usize;
            self.counts.splice(0..0, std::iter::repeat_n(0.0, missing));
            self.lowest = low;
        }
        let needed = (high - self.lowest) as usize;
        if self.counts.len() < needed {
            self.counts.resize(needed, 0.0);
        }
        let start = (low - self.lowest) as usize;
        for (into, count) in self.counts[start..].iter_mut().zip(&other.counts) {
            *into += count;
        }
    }

    /// Sums from the left: `result[i]` counts values below `lowest + i`.
    fn cumulative(&self) -> Vec<f64> {
        let mut below = Vec::with_capacity(self.counts.len() + 1);
        below.push(0.0);
        let mut sum = 0.0;
        for count in &self.counts {
            sum += count;
            below.push(sum);
        }
        below
    }
}

/// For each set of `x.len()` positions of `y` (as bits), the distribution of Σ xy over all
/// ways of giving those y to the x.
fn assignments(x: &[i64], y: &[i64]) -> Vec<Counts> {
    let sets = 1_usize << y.len();
    let mut layer = vec![Counts::default(); sets];
    layer[0] = Counts { lowest: 0, counts: vec![1.0] };
    for (done, &rank) in x.iter().enumerate() {
        let mut next = vec![Counts::default(); sets];
        for (set, counts) in layer.iter().enumerate() {
            if set.count_ones() as usize != done || counts.counts.is_empty() {
                continue;
            }
            for (j, &other) in y.iter().enumerate() {
                if set >> j & 1 == 0 {
                    next[set | 1 << j].add_shifted(counts, rank * other);
                }
            }
        }
        layer = next;
    }
    layer
}

/// P(|Σ xy| at least as large) over all pairings of two columns of centred, doubled ranks;
/// `None` beyond [`MOST_PAIRS`].
pub(super) fn p_value(x: &[i64], y: &[i64]) -> Option<f64> {
    let n = x.len();
    if n > MOST_PAIRS {
        return None;
    }
    // Whole steps from the smallest rank: without ties sums are four times closer together.
    let (x, y) = (compact(x), compact(y));
    let size = n as i64;
    let product: i64 = x.iter().sum::<i64>() * y.iter().sum::<i64>();
    let observed: i64 = x.iter().zip(&y).map(|(a, b)| a * b).sum();
    let distance = (size * observed - product).abs();
    if distance == 0 {
        return Some(1.0);
    }
    // Σ xy counts if it is at least `high`, or at most `low`.
    let high = (product + distance + size - 1).div_euclid(size);
    let low = (product - distance).div_euclid(size);
    let (first, second) = x.split_at(n / 2);
    let (left, right) = (assignments(first, &y), assignments(second, &y));
    let full = (1_usize << n) - 1;
    let mut hits = 0.0;
    for (set, counts) in left.iter().enumerate() {
        let other = &right[full ^ set];
        if set.count_ones() as usize != n / 2 || counts.counts.is_empty() {
            continue;
        }
        let below = other.cumulative();
        let total = below[below.len() - 1];
        let below =
            |limit: i64| below[(limit - other.lowest).clamp(0, below.len() as i64 - 1) as usize];
        for (i, count) in counts.counts.iter().enumerate().filter(|(_, c)| **c > 0.0) {
            let sum = counts.lowest + i as i64;
            hits += count * (total - below(high - sum) + below(low - sum + 1));
        }
    }
    let pairings: f64 = (1..=n).map(|i| i as f64).product();
    Some((hits / pairings).min(1.0))
}

fn compact(ranks: &[i64]) -> Vec<i64> {
    let lowest = ranks.iter().copied().min().unwrap_or(0);
    let even = ranks.iter().all(|r| (r - lowest) % 2 == 0);
    let unit = if even { 2 } else { 1 };
    ranks.iter().map(|r| (r - lowest) / unit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn enumerated(x: &[i64], y: &mut Vec<i64>, at: usize, limit: i64) -> (u32, u32) {
        if at == y.len() {
            let sum: i64 = x.iter().zip(y.iter()).map(|(a, b)| a * b).sum();
            return (u32::from(sum.abs() >= limit), 1);
        }
        let (mut hits, mut all) = (0, 0);
        for j in at..y.len() {
            y.swap(at, j);
            let (h, a) = enumerated(x, y, at + 1, limit);
            (hits, all) = (hits + h, all + a);
            y.swap(at, j);
        }
        (hits, all)
    }

    #[test]
    fn it_agrees_with_listing_every_pairing_with_and_without_ties() {
        for (x, y) in [
            (vec![-6, -4, -2, 0, 2, 4, 6], vec![-6, -4, 0, -2, 6, 2, 4]),
            (vec![-5, -5, -1, 1, 3, 3, 4], vec![-6, -3, -3, 1, 1, 4, 6]),
        ] {
            let limit = x.iter().zip(&y).map(|(a, b)| a * b).sum::<i64>().abs();
            let (hits, all) = enumerated(&x, &mut y.clone(), 0, limit);
            let p = p_value(&x, &y).unwrap();
            assert!((p - f64::from(hits) / f64::from(all)).abs() < 1e-14, "{p} {hits} {all}");
        }
    }
}

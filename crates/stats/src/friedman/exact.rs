//! The exact distribution of Friedman's statistic, by convolution over rank-sum states.
//!
//! Under the null hypothesis each subject's ranks, ties and all, come in any order with
//! the same probability. The rank sums of the conditions are then exchangeable, so a state
//! is the *sorted* vector of sums: 24 subjects x 4 conditions have thousands of states
//! where there are 24^24 arrangements.

use super::RankTable;
use crate::ranks::greatest_common_divisor;

/// Transitions after which the exact p is given up.
const MOST_TRANSITIONS: usize = 40_000_000;
const MOST_CONDITIONS: usize = 8;

/// P(Σ Rj² ≥ observed) over all orders within subjects; `None` if there are too many.
///
/// A state that will reach the observed spread whatever follows is counted at once, and one
/// that cannot is dropped; only those between are carried on.
pub(super) fn p_value(table: &RankTable) -> Option<f64> {
    // Ranks from 0 and without their common factor keep the states few; the statistic is
    // unchanged but for scale and offset, which the spread does not see.
    let from_0 = table.doubled.iter().map(|rank| rank - 2);
    let factor = from_0.fold(0_i64, greatest_common_divisor).max(1);
    let largest = table.n as u64 * u64::try_from(2 * (table.k as i64 - 1) / factor).ok()?;
    let packing = Packing::new(table.k, largest)?;
    let mut rows: Vec<Vec<u64>> = table
        .doubled
        .chunks_exact(table.k)
        .map(|row| {
            let mut row: Vec<u64> = row.iter().map(|r| ((r - 2) / factor) as u64).collect();
            row.sort_unstable();
            row
        })
        .filter(|row| row.first() != row.last())
        .collect();
    // Equal rows together, so that their orders are listed once; rows of even ranks first,
    // because their sums stay even and have far fewer states.
    rows.sort_by_cached_key(|row| (row.iter().any(|r| r % 2 == 1), row.clone()));
    let needed = table.spread() * table.k as i64;
    let limits = Limits::new(&rows, (needed as u64).div_ceil((factor * factor) as u64));
    let mut budget = MOST_TRANSITIONS;
    // The last step is only summed, never stored.
    let last = rows.pop()?;
    let mut states = States::start();
    let mut known: (Vec<u64>, Vec<u64>) = (Vec::new(), Vec::new());
    let mut p = 0.0;
    for (done, row) in rows.into_iter().enumerate() {
        if known.0 != row {
            let orders = packing.orders(&row, budget)?;
            known = (row, orders);
        }
        p += states.settle(&packing, &limits, done);
        budget = budget.checked_sub(states.used * known.1.len())?;
        states = states.step(&known.1, &packing);
    }
    let orders = packing.orders(&last, budget)?;
    p += states.settle(&packing, &limits, limits.still.len() - 2);
    budget.checked_sub(states.used * orders.len())?;
    let share = 1.0 / orders.len() as f64;
    for (key, mass) in states.iter() {
        let reaches = |order: &&u64| spread(&packing.unpack(key + **order)) >= limits.needed;
        p += mass * (orders.iter().filter(reaches).count() as f64 * share);
    }
    Some(p.min(1.0))
}

/// k Σ s² - (Σ s)² = k Σ (s - mean)², which a row of one single tie does not change.
fn spread(sums: &Sums) -> u64 {
    let total: u64 = sums.iter().sum();
    let squares: u64 = sums.iter().map(|s| s * s).sum();
    sums.len() as u64 * squares - total * total
}

/// What the rows still to come can do.
struct Limits {
    /// The spread observed.
    needed: u64,
    /// Before each row and after the last: the sum of the sorted rows to come. Added to a
    /// sorted state it gives the largest spread within reach.
    still: Vec<Vec<u64>>,
    /// The sum of their norms √spread, by which the norm of a state can fall at most.
    norms: Vec<f64>,
}

impl Limits {
    fn new(rows: &[Vec<u64>], needed: u64) -> Self {
        let width = rows.first().map_or(0, Vec::len);
        let (mut still, mut norms) = (vec![vec![0; width]], vec![0.0]);
        for row in rows.iter().rev() {
            let before = &still[still.len() - 1];
            still.push(before.iter().zip(row).map(|(a, b)| a + b).collect());
            norms.push(norms[norms.len() - 1] + (spread(&Sums::from_row(row)) as f64).sqrt());
        }
        still.reverse();
        norms.reverse();
        Self { needed, still, norms }
    }

    /// Whether a sorted state reaches the observed spread in any case; `None` if it depends.
    fn fate(&self, mut sums: Sums, done: usize) -> Option<bool> {
        let norm = (spread(&sums) as f64).sqrt();
        // The margin is far above the rounding of the roots.
        if norm - self.norms[done] > (self.needed as f64).sqrt() * (1.0 + 1e-9) {
            return Some(true);
        }
        for (sum, more) in sums.iter_mut().zip(&self.still[done]) {
            *sum += more;
        }
        (spread(&sums) < self.needed).then_some(false)
    }
}

/// The rank sums of one state.
struct Sums {
    values: [u64; MOST_CONDITIONS],
    conditions: usize,
}

impl Sums {
    fn from_row(row: &[u64]) -> Self {
        let mut values = [0; MOST_CONDITIONS];
        values[..row.len()].copy_from_slice(row);
        Self { values, conditions: row.len() }
    }
}

impl std::ops::Deref for Sums {
    type Target = [u64];

    fn deref(&self) -> &[u64] {
        &self.values[..self.conditions]
    }
}

impl std::ops::DerefMut for Sums {
    fn deref_mut(&mut self) -> &mut [u64] {
        &mut self.values[..self.conditions]
    }
}

/// Rank sums side by side in one word, wide enough that adding words adds the sums.
struct Packing {
    conditions: usize,
    bits: u32,
}

impl Packing {
    fn new(conditions: usize, largest: u64) -> Option<Self> {
        let bits = u64::BITS - largest.leading_zeros();
        let fits = conditions <= MOST_CONDITIONS && bits as usize * conditions <= 64;
        fits.then_some(Self { conditions, bits })
    }

    fn pack(&self, sums: &[u64]) -> u64 {
        sums.iter().rev().fold(0, |key, &s| key << self.bits | s)
    }

    fn unpack(&self, mut key: u64) -> Sums {
        let mask = (1 << self.bits) - 1;
        let mut sums = Sums { values: [0; MOST_CONDITIONS], conditions: self.conditions };
        for sum in sums.iter_mut() {
            *sum = key & mask;
            key >>= self.bits;
        }
        sums
    }

    /// The same sums in ascending order.
    fn sorted(&self, key: u64) -> u64 {
        let mut sums = self.unpack(key);
        for i in 1..sums.len() {
            let mut j = i;
            while j > 0 && sums[j - 1] > sums[j] {
                sums.swap(j - 1, j);
                j -= 1;
            }
        }
        self.pack(&sums)
    }

    /// The distinct orders of a sorted row, packed; `None` if there are more than `most`.
    fn orders(&self, sorted: &[u64], most: usize) -> Option<Vec<u64>> {
        let mut row = sorted.to_vec();
        let mut orders = vec![self.pack(&row)];
        loop {
            // The next permutation in lexicographic order; ties are visited once.
            let Some(i) = (1..row.len()).rev().find(|&i| row[i - 1] < row[i]) else {
                return Some(orders);
            };
            let j = (i..row.len()).rev().find(|&j| row[j] > row[i - 1])?;
            row.swap(i - 1, j);
            row[i..].reverse();
            orders.push(self.pack(&row));
            if orders.len() > most {
                return None;
            }
        }
    }
}

/// Sorted rank sums and their probability: an open-addressing table with a fixed hash, so
/// that the order of summation, and with it the last digit, never changes.
struct States {
    keys: Vec<u64>,
    mass: Vec<f64>,
    used: usize,
}

impl States {
    fn empty(slots: usize) -> Self {
        Self { keys: vec![0; slots], mass: vec![0.0; slots], used: 0 }
    }

    /// All sums zero.
    fn start() -> Self {
        let mut states = Self::empty(64);
        states.add(0, 1.0);
        states
    }

    fn iter(&self) -> impl Iterator<Item = (u64, f64)> {
        let slots = self.keys.iter().copied().zip(self.mass.iter().copied());
        slots.filter(|(_, mass)| *mass > 0.0)
    }

    /// Takes out the states whose end is certain; the probability of those that reach.
    fn settle(&mut self, packing: &Packing, limits: &Limits, done: usize) -> f64 {
        let mut reached = 0.0;
        let mut open = Self::empty(self.keys.len());
        for (key, mass) in self.iter() {
            match limits.fate(packing.unpack(key), done) {
                Some(true) => reached += mass,
                Some(false) => {}
                None => open.add(key, mass),
            }
        }
        *self = open;
        reached
    }

    fn step(&self, orders: &[u64], packing: &Packing) -> Self {
        // Room for twice as many states as now, at most half full.
        let mut next = Self::empty((4 * self.used).next_power_of_two().max(64));
        let share = 1.0 / orders.len() as f64;
        for (key, mass) in self.iter() {
            for order in orders {
                next.add(packing.sorted(key + order), mass * share);
            }
        }
        next
    }

    fn add(&mut self, key: u64, mass: f64) {
        if 2 * self.used >= self.keys.len() {
            let mut larger = Self::empty(2 * self.keys.len());
            for (key, mass) in self.iter() {
                larger.add(key, mass);
            }
            *self = larger;
        }
        let slot = self.slot(key);
        if self.mass[slot] <= 0.0 {
            self.used += 1;
            self.keys[slot] = key;
        }
        self.mass[slot] += mass;
    }

    fn slot(&self, key: u64) -> usize {
        let mask = self.keys.len() - 1;
        let mut slot = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.mass[slot] > 0.0 && self.keys[slot] != key {
            slot = (slot + 1) & mask;
        }
        slot
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::WithinSubjects;

    /// Every order of every subject, one by one.
    fn enumerated(table: &RankTable) -> f64 {
        let packing = Packing::new(table.k, 2 * (table.n * table.k) as u64).unwrap();
        let mut all = vec![0_u64];
        for row in table.doubled.chunks_exact(table.k) {
            let mut row: Vec<u64> = row.iter().map(|&v| v as u64).collect();
            row.sort_unstable();
            let orders = packing.orders(&row, 1000).unwrap();
            all = all
                .iter()
                .flat_map(|state| orders.iter().map(move |order| state + order))
                .collect();
        }
        let mean = (table.n * (table.k + 1)) as i64;
        let spread = |key: u64| -> i64 {
            let sums = packing.unpack(key);
            sums.iter().map(|&s| (s as i64 - mean).pow(2)).sum()
        };
        let hits = all.iter().filter(|&&key| spread(key) >= table.spread()).count();
        hits as f64 / all.len() as f64
    }

    #[test]
    fn it_agrees_with_full_enumeration_with_and_without_ties() {
        for rows in [
            vec![
                vec![1.0, 2.0, 3.0],
                vec![1.0, 3.0, 2.0],
                vec![2.0, 3.0, 5.0],
                vec![1.0, 2.0, 9.0],
            ],
            vec![
                vec![1.0, 1.0, 3.0],
                vec![1.0, 3.0, 3.0],
                vec![2.0, 2.0, 2.0],
                vec![1.0, 2.0, 9.0],
            ],
            vec![vec![4.0, 1.0, 3.0, 3.0], vec![1.0, 3.0, 3.0, 5.0], vec![2.0, 1.0, 5.0, 4.0]],
        ] {
            let k = rows[0].len();
            let names: Vec<String> = (0..9).map(|i| format!("n{i}")).collect();
            let data = WithinSubjects::from_rows(&names[..k], &names[..rows.len()], &rows).unwrap();
            let table = RankTable::new(&data);
            assert!((p_value(&table).unwrap() - enumerated(&table)).abs() < 1e-14);
        }
    }
}

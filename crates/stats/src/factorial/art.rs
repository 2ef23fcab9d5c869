//! Aligned ranks: every effect of a factorial design without normal errors.

use serde::{Deserialize, Serialize};

use super::{Effect, FactorialDesign, anova, cells::Cells, design::level_in};
use crate::{
    Named, Reasons,
    numerics::{
        decimal::{Written, tolerance},
        distributions::f_upper,
    },
    ranks::{self, greatest_common_divisor},
};

/// F of one effect on the ranks aligned for it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ArtEffect {
    /// Effects with a factor within subjects over one error pooled within subjects; the others over the subjects within groups.
    #[serde(rename = "F")]
    pub f: Option<f64>,
    /// Degrees of freedom of the effect.
    pub df1: usize,
    /// Of the error: (n - groups) (cells - 1) within subjects, n - groups between.
    pub df2: usize,
    /// P(F' ≥ F).
    pub p: Option<f64>,
    /// With two factors within subjects: over the effect's own error.
    #[serde(flatten)]
    pub strata: Option<ArtStrata>,
}

/// F over the effect's own error, as a repeated-measures analysis of variance of the ranks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ArtStrata {
    /// Mean square of the effect over that of its own error.
    #[serde(rename = "F_strata")]
    pub f: Option<f64>,
    /// Degrees of freedom of that error.
    #[serde(rename = "df2_strata")]
    pub df2: usize,
    /// P(F' ≥ F).
    #[serde(rename = "p_strata")]
    pub p: Option<f64>,
}

/// Aligned rank transform of a factorial design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AlignedRanks {
    /// Complete subjects.
    pub n: usize,
    /// Subjects left out.
    pub n_dropped: usize,
    /// Their names.
    pub dropped: Vec<String>,
    /// Each effect.
    pub art: Named<ArtEffect>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Tests each effect on ranks aligned for it: value - mean of its cell + the effect as estimated from marginal means over rows, then
/// mid-ranks of all rows, then type III F of that effect alone.
///
/// Alignment makes ties that rounding breaks, so means are fractions of whole numbers here: decimals tie as written, longer numbers
/// within four units in the 15th digit of the largest.
///
/// # Source
/// Wobbrock, Findlater, Gergle and Higgins (2011); the pooled error is that of ARTool's `(1 | subject)`.
///
/// # Example
/// ```
/// use maveric_stats::{FactorialDesign, aligned_ranks};
/// let people: Vec<String> = (0..12).map(|i| (i / 2).to_string()).collect();
/// let mode: Vec<String> = (0..12).map(|i| ["calm", "sporty"][i % 2].to_owned()).collect();
/// let value = [1.0, 4.0, 2.0, 4.5, 1.5, 5.0, 3.0, 3.5, 2.5, 3.0, 4.0, 4.5].map(Some);
/// let design = FactorialDesign::from_columns(&people, &[("mode", &mode)], &[], &value)?;
/// assert!(aligned_ranks(&design).art.get("mode").unwrap().p.unwrap() < 0.05);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn aligned_ranks(design: &FactorialDesign) -> AlignedRanks {
    let mut undefined = Reasons::default();
    let aligner = Aligner::new(design);
    let of_effect = |effect: Effect| {
        let name = effect.name(design);
        let test = of_ranks(effect, design, &aligner.ranks(effect));
        let test = undefined.result(&format!("art.{name}"), test);
        (name, test)
    };
    let art = Effect::all(design).into_iter().map(of_effect).collect();
    AlignedRanks {
        n: design.n(),
        n_dropped: design.dropped().len(),
        dropped: design.dropped().to_vec(),
        art,
        undefined,
    }
}

/// Values and marginal means as whole numbers, so that ties are ties.
struct Aligner {
    /// Each value times a common multiple of all numbers of rows that a mean is taken over.
    values: Vec<i128>,
    /// Of each set of factors: the mean over the rows with the same levels, times the same.
    means: Vec<Vec<i128>>,
    /// Aligned values no further apart than this tie.
    tolerance: i128,
}

/// Bits of the common multiple at most: sums of 64-bit values times it fit.
const MOST_BITS: u32 = 40;

impl Aligner {
    fn new(design: &FactorialDesign) -> Self {
        let (whole, tolerance) = whole(&design.values);
        let levels = levels(design);
        let cells: Vec<Vec<usize>> =
            (0..1 << levels.len()).map(|mask| cells(&levels, mask, whole.len())).collect();
        let counts: Vec<Vec<i128>> =
            cells.iter().map(|cells| sums(cells, &vec![1; whole.len()])).collect();
        let multiple =
            counts.iter().flatten().filter(|c| **c > 0).try_fold(1_i128, |multiple, &count| {
                let next = multiple / greatest_common_divisor(multiple, count) * count;
                (next < 1 << MOST_BITS).then_some(next)
            });
        // Without one the means are rounded, far below the values.
        let (scale, rounding) = multiple.map_or((1 << MOST_BITS, 64), |m| (m, 0));
        let mean = |(cells, counts): (&Vec<usize>, &Vec<i128>)| {
            let sums = sums(cells, &whole);
            let cell_mean =
                |&cell: &usize| (sums[cell] * scale + counts[cell] / 2).div_euclid(counts[cell]);
            cells.iter().map(cell_mean).collect()
        };
        Self {
            means: cells.iter().zip(&counts).map(mean).collect(),
            values: whole.iter().map(|w| w * scale).collect(),
            tolerance: tolerance * scale + rounding,
        }
    }

    /// Mid-ranks of the values aligned for one effect.
    fn ranks(&self, effect: Effect) -> Vec<f64> {
        let full = self.means.len() - 1;
        let align = |(row, value): (usize, &i128)| {
            let signed = |mask: usize| {
                let left_out = (effect.0 ^ mask).count_ones();
                let mean = self.means[mask][row];
                if left_out.is_multiple_of(2) { mean } else { -mean }
            };
            let estimate: i128 = (0..=full).filter(|m| m & !effect.0 == 0).map(signed).sum();
            value - self.means[full][row] + estimate
        };
        let aligned: Vec<i128> = self.values.iter().enumerate().map(align).collect();
        mid_ranks(&aligned, self.tolerance)
    }
}

/// Values less the first: decimals as written, longer numbers in units far below their rounding; and how far apart they may be to tie.
fn whole(values: &[f64]) -> (Vec<i128>, i128) {
    match Written::from_values(values) {
        Written::Decimals(written) => {
            let whole = written.iter().map(|w| i128::from(*w) - i128::from(written[0]));
            (whole.collect(), 0)
        }
        Written::Rounded { values } => {
            let tolerance = tolerance(values);
            let units = values.iter().map(|v| ((v - values[0]) / tolerance * 64.0).round() as i128);
            (units.collect(), 64)
        }
    }
}

/// The level of each factor in each row, a row a subject and cell.
fn levels(design: &FactorialDesign) -> Vec<Vec<usize>> {
    let width = design.cells();
    let rows = || 0..design.n() * width;
    let between = (0..design.between.len()).map(|f| {
        let level = |row: usize| level_in(&design.between, f, design.group[row / width]);
        rows().map(level).collect()
    });
    let within = (0..design.within.len()).map(|f| {
        let level = |row: usize| level_in(&design.within, f, row % width);
        rows().map(level).collect()
    });
    between.chain(within).collect()
}

/// Of each row: the cell of the factors in `mask`.
fn cells(levels: &[Vec<usize>], mask: usize, rows: usize) -> Vec<usize> {
    let mut cell = vec![0; rows];
    for (_, levels) in levels.iter().enumerate().filter(|(f, _)| mask >> f & 1 == 1) {
        let size = levels.iter().max().map_or(1, |m| m + 1);
        for (cell, level) in cell.iter_mut().zip(levels) {
            *cell = *cell * size + level;
        }
    }
    cell
}

/// The sum over the rows of each cell.
fn sums(cells: &[usize], values: &[i128]) -> Vec<i128> {
    let mut sums = vec![0; cells.iter().max().map_or(0, |m| m + 1)];
    for (&cell, value) in cells.iter().zip(values) {
        sums[cell] += value;
    }
    sums
}

/// Mid-ranks of values that tie if they are no further from the smallest of their tie.
fn mid_ranks(values: &[i128], tolerance: i128) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by_key(|&i| values[i]);
    let mut keys = vec![0_u32; values.len()];
    let (mut key, mut first) = (0, values[order[0]]);
    for &i in &order {
        if values[i] - first > tolerance {
            key += 1;
            first = values[i];
        }
        keys[i] = key;
    }
    let (doubled, _) = ranks::doubled(&keys);
    doubled.into_iter().map(|r| 0.5 * r as f64).collect()
}

fn of_ranks(effect: Effect, design: &FactorialDesign, ranks: &[f64]) -> (ArtEffect, Reasons) {
    let mut reasons = Reasons::default();
    let cells = Cells::new(design, ranks);
    let sums = effect.sums(&cells);
    let (subjects, within) = anova::errors(&cells);
    let (error, df2) = if effect.is_within(&cells) {
        (within, cells.freedom * (design.cells() - 1))
    } else {
        (subjects, cells.freedom)
    };
    let over = |error: f64, df2: usize| {
        let f = (error > 0.0).then(|| sums.ss / sums.df1 as f64 / (error / df2 as f64));
        (f, f.map(|f| f_upper(f, sums.df1 as f64, df2 as f64)))
    };
    let (f, p) = over(error, df2);
    if f.is_none() {
        reasons.note_all(&["F", "p"], "the ranks have no error");
    }
    let strata = (design.within.len() > 1).then(|| {
        let (f, p) = over(sums.ss_error, sums.df2);
        if f.is_none() {
            reasons.note_all(&["F_strata", "p_strata"], "the ranks have no error");
        }
        ArtStrata { f, df2: sums.df2, p }
    });
    let test = ArtEffect { f, df1: sums.df1, df2, p, strata };
    (test, reasons)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some_design(values: [f64; 9]) -> FactorialDesign {
        let people: Vec<String> = (0..9).map(|i| (i / 3).to_string()).collect();
        let mode: Vec<String> = (0..9).map(|i| (i % 3).to_string()).collect();
        FactorialDesign::from_columns(&people, &[("mode", &mode)], &[], &values.map(Some)).unwrap()
    }

    #[test]
    fn ties_that_rounding_of_means_breaks_are_ties() {
        // Aligned for the one effect: the values less the mean of nothing but the rows.
        let design = some_design([0.1, 0.2, 0.3, 0.3, 0.1, 0.2, 0.2, 0.3, 0.1]);
        let ranks = Aligner::new(&design).ranks(Effect(1));
        assert_eq!(ranks, [2.0, 5.0, 8.0, 8.0, 2.0, 5.0, 5.0, 8.0, 2.0]);
    }

    #[test]
    fn a_large_offset_and_effect_keep_small_differences_apart() {
        let base = [0.0, 1e6, 3e6];
        let small = [1e-4, 2e-4, 3e-4, 2e-4, 3e-4, 1e-4, 3e-4, 1e-4, 2e-4];
        let near = some_design(small);
        let far = some_design(std::array::from_fn(|i| small[i] + base[i % 3]));
        // The residuals are those without the effect.
        let ranks = |design: &FactorialDesign| Aligner::new(design).ranks(Effect(0));
        assert_eq!(ranks(&near), ranks(&far));
    }
}

//! Contrasts of levels as weights of groups and cells.

use super::{
    Factor, FactorialDesign,
    cells::{Rows, average, difference, level, products},
};

/// Weights of the groups and of the cells: of a factor with a pair its first level less its second, of any other the mean.
pub(crate) fn level_weights<'a>(
    design: &FactorialDesign,
    pair: &impl Fn(&str) -> Option<&'a [String; 2]>,
) -> (Vec<f64>, Vec<f64>) {
    crossed(design, |factor| {
        let place = |level: &String| factor.levels.iter().position(|known| known == level);
        let places = pair(&factor.name).and_then(|[a, b]| Some((place(a)?, place(b)?)));
        let levels = factor.levels.len();
        places.map_or_else(|| average(levels), |(a, b)| difference(levels, a, b))
    })
}

/// Weights of the groups and of the cells: of a factor that has one the level at this position, of any other the mean.
pub(crate) fn cell_weights(
    design: &FactorialDesign,
    position: impl Fn(&str) -> Option<usize>,
) -> (Vec<f64>, Vec<f64>) {
    crossed(design, |factor| {
        let levels = factor.levels.len();
        position(&factor.name).map_or_else(|| average(levels), |at| level(levels, at))
    })
}

/// The part of these weights of the cells that is of one stratum: of a factor that is in it the level less the mean, of any other the mean.
pub(crate) fn stratum_weights(
    design: &FactorialDesign,
    position: impl Fn(&str) -> Option<usize>,
    is_in: impl Fn(&str) -> bool,
) -> Vec<f64> {
    let (_, cells) = crossed(design, |factor| {
        let mean = average(factor.levels.len());
        let index = position(&factor.name).filter(|_| is_in(&factor.name));
        let Some(index) = index else { return mean };
        let mut deviation = level(factor.levels.len(), index).concat();
        for (weight, mean) in deviation.iter_mut().zip(mean.concat()) {
            *weight -= mean;
        }
        vec![deviation]
    });
    cells
}

/// The weights of each factor multiplied, those between and those within subjects.
fn crossed(design: &FactorialDesign, part: impl Fn(&Factor) -> Rows) -> (Vec<f64>, Vec<f64>) {
    let weights_of = |factors: &[Factor]| {
        let parts: Vec<Rows> = factors.iter().map(&part).collect();
        products(&parts).concat()
    };
    (weights_of(&design.between), weights_of(&design.within))
}

impl FactorialDesign {
    /// Of each subject the sum of what weights above 0 add, and of what weights below 0 take away.
    pub(crate) fn weighted_sides(&self, cells: &[f64]) -> Vec<[f64; 2]> {
        let side = |values: &[f64], sign: f64| {
            let weighted = values.iter().zip(cells);
            weighted.map(|(v, w)| v * (sign * w).max(0.0)).sum()
        };
        let people = self.values.chunks_exact(cells.len());
        people.map(|v| [side(v, 1.0), side(v, -1.0)]).collect()
    }

    /// Of each complete subject its group: the cell of the factors between subjects.
    pub fn group(&self) -> &[usize] {
        &self.group
    }
}

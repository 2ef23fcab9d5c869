//! Residuals of a factorial design, for judging whether they are normal.

use super::FactorialDesign;

impl FactorialDesign {
    /// Residuals within subjects (value - subject's mean - cell's mean + group's mean), and subjects' means less their group's; each over
    /// the root mean square of its cell, or group. Empty where the design has no factor of that kind; of two cells within, where the
    /// residuals of one are those of the other turned round, only the first's.
    pub(crate) fn standardised_residuals(&self) -> [Vec<f64>; 2] {
        let (n, cells, groups) = (self.n(), self.cells(), self.groups());
        let pivot = self.values[0];
        let value = |i: usize, c: usize| self.values[i * cells + c] - pivot;
        let mean_of = |i: usize| (0..cells).map(|c| value(i, c)).sum::<f64>() / cells as f64;
        let people: Vec<f64> = (0..n).map(mean_of).collect();
        let members: Vec<Vec<usize>> =
            (0..groups).map(|g| (0..n).filter(|&i| self.group[i] == g).collect()).collect();
        let mut within = vec![0.0; n * cells];
        let mut between = vec![0.0; n];
        for own in &members {
            let size = own.len() as f64;
            let group = own.iter().map(|&i| people[i]).sum::<f64>() / size;
            over_its_size(own.iter().map(|&i| (i, people[i] - group)), &mut between);
            for c in 0..cells {
                let cell = own.iter().map(|&i| value(i, c)).sum::<f64>() / size;
                let residual = |&i: &usize| (i * cells + c, value(i, c) - people[i] - cell + group);
                over_its_size(own.iter().map(residual), &mut within);
            }
        }
        if cells == 2 {
            within = within.into_iter().step_by(2).collect();
        }
        [if cells > 1 { within } else { Vec::new() }, if groups > 1 { between } else { Vec::new() }]
    }
}

/// Writes residuals over their root mean square into their places; 0 where they do not vary.
fn over_its_size(residuals: impl Iterator<Item = (usize, f64)>, into: &mut [f64]) {
    let residuals: Vec<(usize, f64)> = residuals.collect();
    let squares: f64 = residuals.iter().map(|(_, r)| r * r).sum();
    let size = (squares / residuals.len() as f64).sqrt();
    for (place, residual) in residuals {
        into[place] = if size > 0.0 { residual / size } else { 0.0 };
    }
}

//! Covariates of the subjects: each stratum regressed on them and on the groups.

use super::{
    Effect, FactorialDesign,
    cells::{Cells, Rows, contrasts, products},
};
use crate::{
    Sphericity, StatsError, complete,
    numerics::{distributions::f_upper, moments::dot, projection::residuals},
    sphericity::Spectrum,
};

/// A covariate of the complete subjects of a design, in their order.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SubjectCovariate<'a> {
    pub(crate) name: &'a str,
    pub(crate) values: Vec<f64>,
}

/// F of one term of a regression of the subjects' contrasts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Regressed {
    /// The effect, or the covariate with the effect that it is multiplied by (`age`, `age:mode`).
    pub(crate) name: String,
    pub(crate) f: Option<f64>,
    pub(crate) df1: usize,
    pub(crate) df2: usize,
    /// P(F' ≥ F) if sphericity holds.
    pub(crate) p: Option<f64>,
    /// Corrections, where the stratum has several contrasts.
    pub(crate) sphericity: Option<Sphericity>,
}

/// The tests of one stratum with covariates in it: of every effect that has the stratum's factors within subjects, and of each covariate.
///
/// `within` says which factors within subjects the stratum is of; none is that of the subjects' means. The subjects' contrasts are
/// regressed on the groups and on the covariates less their means: type III, the error loses a degree of freedom a covariate and contrast.
///
/// # Errors
/// [`StatsError::Collinear`] if the groups and the covariates before it determine a covariate; [`StatsError::TooFew`] without an error.
///
/// # Source
/// Maxwell, Delaney and Kelley (2018), chapters 9 and 12; R: `aov(y ~ a*t + x + Error(id/(a*t)))` for a covariate between subjects alone.
pub(crate) fn regressed(
    design: &FactorialDesign,
    within: &[bool],
    covariates: &[SubjectCovariate],
) -> Result<Vec<Regressed>, StatsError> {
    let cells = Cells::new(design, &design.values);
    let first = design.between.len();
    let stratum = within
        .iter()
        .enumerate()
        .filter(|(_, has)| **has)
        .fold(0, |mask, (f, _)| mask | 1 << (first + f));
    // The contrasts of each subject, and what they are regressed on.
    let (_, rows) = Effect(stratum).rows(&cells);
    let width = design.cells();
    let scores: Rows = rows
        .iter()
        .map(|row| {
            let people = design.values.chunks_exact(width);
            let pivot = cells.pivot;
            people
                .map(|values| values.iter().zip(row).map(|(v, w)| w * (v - pivot)).sum())
                .collect()
        })
        .collect();
    let mut terms: Vec<(String, Rows)> = Vec::new();
    for between in 0..1_usize << first {
        let parts: Vec<Rows> = (0..first)
            .map(|f| {
                let k = design.between[f].levels.len();
                if between >> f & 1 == 1 { contrasts(k) } else { vec![vec![1.0; k]] }
            })
            .collect();
        let of_person = |row: &Vec<f64>| design.group.iter().map(|&g| row[g]).collect();
        let columns = products(&parts).iter().map(of_person).collect();
        terms.push((Effect(between | stratum).name(design), columns));
    }
    for covariate in covariates {
        let name = match stratum {
            0 => covariate.name.to_owned(),
            _ => format!("{}:{}", covariate.name, Effect(stratum).name(design)),
        };
        terms.push((name, vec![centred(&covariate.values)]));
    }
    let all_columns: Vec<&Vec<f64>> = terms.iter().flat_map(|(_, columns)| columns).collect();
    let (n, dropped) = (design.n(), design.dropped().len());
    complete::enough("subject", n, dropped, all_columns.len() + 1)?;
    let freedom = n - all_columns.len();
    let errors = residuals(&all_columns, &scores).map_err(|column| StatsError::Collinear {
        name: covariates[column + covariates.len() - all_columns.len()].name.to_owned(),
    })?;
    let square = |rows: &Rows| rows.iter().map(|row| dot(row, row)).sum::<f64>();
    let error = square(&errors);
    let d = scores.len();
    let spectrum = (d > 1).then(|| Spectrum::new(errors, freedom, width));
    let mut tests = Vec::new();
    for (at, (name, columns)) in terms.iter().enumerate() {
        if stratum == 0 && at == 0 {
            // The mean of everything.
            continue;
        }
        let others = terms.iter().enumerate().filter(|(other, _)| *other != at);
        let others: Vec<&Vec<f64>> = others.flat_map(|(_, (_, columns))| columns).collect();
        let without = residuals(&others, &scores).map_or(error, |rest| square(&rest));
        let (df1, df2) = (columns.len() * d, freedom * d);
        let f = (error > 0.0).then(|| (without - error) / df1 as f64 / (error / df2 as f64));
        tests.push(Regressed {
            name: name.clone(),
            f,
            df1,
            df2,
            p: f.map(|f| f_upper(f, df1 as f64, df2 as f64)),
            sphericity: spectrum.as_ref().map(|s| s.corrections(f, df1, df2).0),
        });
    }
    Ok(tests)
}

fn centred(values: &[f64]) -> Vec<f64> {
    let first = values.first().copied().unwrap_or_default();
    let mean = values.iter().map(|v| v - first).sum::<f64>() / values.len() as f64;
    values.iter().map(|v| v - first - mean).collect()
}

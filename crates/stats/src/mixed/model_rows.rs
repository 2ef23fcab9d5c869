//! The rows, columns and people that a formula's model is fitted to.

use super::{
    blocks::Blocks,
    columns::{Columns, Predictor},
    formula::Formula,
};
use crate::{StatsError, complete, within_subjects::Index};

/// Rows with all values, and whose they are.
pub(super) struct ModelRows<'a> {
    pub(super) columns: Columns<'a>,
    /// The place of each row among those given.
    pub(super) kept: Vec<usize>,
    /// Rows of each subject.
    pub(super) people: Vec<Vec<usize>>,
    /// y.
    pub(super) values: Vec<f64>,
    /// A mean of y: without it large values cost no digits. The intercept takes it.
    pub(super) offset: f64,
    pub(super) missing: usize,
}

impl<'a> ModelRows<'a> {
    /// Rows of at least `least` people, more than columns.
    pub(super) fn new(
        subjects: &[String],
        formula: &'a Formula,
        predictors: &[(&str, Predictor)],
        y: &[Option<f64>],
        least: usize,
    ) -> Result<Self, StatsError> {
        let used = find(formula, predictors)?;
        let names = formula.predictors();
        StatsError::same_length("subject", subjects.len(), y.len())?;
        for (name, predictor) in names.iter().zip(&used) {
            StatsError::same_length(name, predictor.rows(), y.len())?;
        }
        for (name, predictor) in names.iter().zip(&used) {
            if let Predictor::Covariate(values) = predictor {
                complete::values(values, name, 1)?;
            }
        }
        let complete = complete::rows(&[("value", y)], "row", 1)?;
        let kept: Vec<usize> = (complete.kept.iter().copied())
            .filter(|&row| !used.iter().any(|p| p.is_missing(row)))
            .collect();
        let people = Index::from_labels(kept.iter().map(|&row| &subjects[row])).members();
        let columns = Columns::new(formula, &used, &kept)?;
        let (n, missing) = (kept.len(), y.len() - kept.len());
        complete::enough("subject", people.len(), missing, least)?;
        complete::enough("row", n, missing, columns.count() + 1)?;
        let values: Vec<f64> = kept.iter().filter_map(|&row| y[row]).collect();
        let above_first = values.iter().map(|v| v - values[0]).sum::<f64>();
        Ok(Self {
            columns,
            kept,
            people,
            offset: values[0] + above_first / n as f64,
            values,
            missing,
        })
    }

    /// Refuses a column that those before it determine.
    pub(super) fn independent(&self) -> Result<(), StatsError> {
        let dependent = self.columns.collinear(self.values.len());
        dependent.map_or(Ok(()), |name| Err(StatsError::Collinear { name }))
    }

    /// With `q` random columns, by row and place.
    pub(super) fn blocks(&self, q: usize, random: impl Fn(usize, usize) -> f64) -> Blocks {
        Blocks::of_rows(
            &self.people,
            (self.columns.count(), q),
            |row, j| self.columns.value(row, j),
            random,
            |row| self.values[row] - self.offset,
        )
    }
}

/// Why there is no top of the likelihood.
pub(super) fn no_fit() -> StatsError {
    StatsError::no_fit(
        "the predictors and the subjects explain all of the values: what is left to estimate a variance from is rounding",
    )
}

/// The predictors of the formula, in its order.
fn find<'a>(
    formula: &Formula,
    predictors: &[(&str, Predictor<'a>)],
) -> Result<Vec<Predictor<'a>>, StatsError> {
    let one = |name: &String| {
        let predictor = predictors.iter().find(|(known, _)| known == name);
        let predictor = predictor.map(|(_, p)| *p);
        predictor.ok_or_else(|| StatsError::formula(name, "the name of a predictor"))
    };
    formula.predictors().iter().map(one).collect()
}

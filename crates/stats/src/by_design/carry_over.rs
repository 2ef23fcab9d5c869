//! What a condition leaves behind for the one after it: a look at how much the verdict rests on there being nothing.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::{DesignColumns, DesignTable, PERIOD, kept};
use crate::{
    FixedEffect, Formula, MarginalContrast, Named, Predictor, StatsError, TermTest,
    numerics::matrix::Matrix, random_by_factor, within_subjects::Index,
};

/// Name of the term in the model.
const TERM: &str = "carry_over";

/// The model with first-order carry-over, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum CarryOver {
    /// The model.
    Fitted(Box<CarriedOver>),
    /// No model of these data.
    NotFitted {
        /// What stands in its way.
        why_not: NoCarryOver,
    },
}

/// A mixed model of condition, period and what the condition before left behind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CarriedOver {
    /// All carry-over effects at once.
    pub test: TermTest,
    /// What each condition leaves behind for the next one; they sum to zero, and the first condition that somebody meets has none.
    pub effects: Named<FixedEffect>,
    /// Every pair of conditions with carry-over taken out.
    pub contrast: Named<MarginalContrast>,
    /// What that cost: the variance of a difference of two conditions over that without carry-over, people fixed, mean over the pairs.
    pub variance_ratio: f64,
}

/// Why carry-over is not estimated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(rename_all = "snake_case", tag = "reason")]
#[non_exhaustive]
pub enum NoCarryOver {
    /// There are two, and carry-over is one thing with the order.
    #[error("of two conditions carry-over is one thing with the order")]
    TwoConditions,
    /// Hardly anybody shares an order.
    #[error("{people} people in {orders} different orders are fewer than two people an order")]
    FewPeople {
        /// How many have at least one value.
        people: usize,
        /// Different orders.
        orders: usize,
    },
    /// The orders do not tell it from conditions and periods.
    #[error("the orders do not tell carry-over from conditions and periods")]
    NotConnected,
    /// Several factors, groups or covariates.
    #[error("carry-over is estimated of one factor within people, without groups and covariates")]
    SeveralFactors,
    /// The answers are ordered, and their model has no carry-over term.
    #[error("a model of ordered answers has no carry-over here")]
    OrderedAnswers,
    /// The model refuses the data.
    #[error("{problem}")]
    Refused {
        /// What it says.
        problem: String,
    },
}

/// Fits first-order carry-over beside condition and period: a sensitivity analysis, never a reason to change the verdict.
///
/// Needs `periods` and one factor within subjects; whoever lacks a condition is left out.
///
/// # Errors
/// [`StatsError::LengthMismatch`].
///
/// # Source
/// Jones and Kenward (2014), chapter 5; Senn (2002), chapter 10, and Freeman (1989) on why it decides nothing.
///
/// # Example
/// ```
/// use maveric_stats::{CarryOver, DesignColumns, NoCarryOver, carry_over};
/// let people: Vec<String> = (0..8).map(|i| (i / 2).to_string()).collect();
/// let mode: Vec<String> = (0..8).map(|i| ["a", "b"][(i + i / 4) % 2].to_owned()).collect();
/// let periods: Vec<usize> = (0..8).map(|i| 1 + i % 2).collect();
/// let values: Vec<Option<f64>> = (0..8).map(|i| Some(f64::from(i * i % 5))).collect();
/// let data = DesignColumns { subjects: &people, within: vec![("mode", &mode)], periods: &periods, values: &values, ..Default::default() };
/// assert_eq!(carry_over(&data)?, CarryOver::NotFitted { why_not: NoCarryOver::TwoConditions });
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn carry_over(data: &DesignColumns<'_>) -> Result<CarryOver, StatsError> {
    StatsError::same_length(PERIOD, data.periods.len(), data.values.len())?;
    let whole = kept::listwise(data);
    let whole = whole.as_ref().map(DesignTable::columns);
    Ok(match fitted(whole.as_ref().unwrap_or(data)) {
        Ok(model) => CarryOver::Fitted(Box::new(model)),
        Err(why_not) => CarryOver::NotFitted { why_not },
    })
}

fn fitted(data: &DesignColumns<'_>) -> Result<CarriedOver, NoCarryOver> {
    let &[(name, conditions)] = &data.within[..] else {
        return Err(NoCarryOver::SeveralFactors);
    };
    if !data.between.is_empty() || !data.covariates.is_empty() {
        return Err(NoCarryOver::SeveralFactors);
    }
    let rows = Met::new(data);
    if rows.conditions < 3 {
        return Err(NoCarryOver::TwoConditions);
    }
    let (people, orders) = (rows.of_person.len(), rows.orders());
    if people < 2 * orders {
        return Err(NoCarryOver::FewPeople { people, orders });
    }
    let variances = rows.variance(false).zip(rows.variance(true));
    let Some((without, with)) = variances else {
        return Err(NoCarryOver::NotConnected);
    };
    let before: Vec<Option<String>> = (0..data.values.len())
        .map(|row| rows.before[row].map(|before| conditions[before].clone()))
        .collect();
    let cells: Vec<Option<String>> = conditions.iter().cloned().map(Some).collect();
    let periods = kept::labels(data.periods);
    let model = Formula::crossed(&[name], &[PERIOD, TERM]).and_then(|formula| {
        let predictors = [
            (name, Predictor::Factor(&cells)),
            (PERIOD, Predictor::Factor(&periods)),
            (TERM, Predictor::SumToZero(&before)),
        ];
        random_by_factor(data.subjects, &formula, &[name], &predictors, data.values)
    });
    let model = model.map_err(|e| NoCarryOver::Refused { problem: e.to_string() })?;
    let of_term = |(coefficient, effect): (&str, &FixedEffect)| {
        let level = coefficient.strip_prefix(TERM)?.strip_prefix('[')?;
        Some((level.strip_suffix(']')?.to_owned(), effect.clone()))
    };
    let (Some(test), Some(contrast)) = (model.anova.get(TERM), model.contrast.get(name)) else {
        return Err(NoCarryOver::NotConnected);
    };
    Ok(CarriedOver {
        test: test.clone(),
        effects: model.coef.iter().filter_map(of_term).collect(),
        contrast: contrast.clone(),
        variance_ratio: with / without,
    })
}

/// Whether condition and period can be told apart within people.
pub(super) fn is_connected(data: &DesignColumns<'_>) -> bool {
    Met::new(data).variance(false).is_some()
}

/// Which cells people met, in which periods, in rows that have a value.
struct Met {
    /// Rows of each person.
    of_person: Vec<Vec<usize>>,
    /// Of each row, from 0.
    condition: Vec<usize>,
    period: Vec<usize>,
    /// The row before it in the same person's order.
    before: Vec<Option<usize>>,
    conditions: usize,
    periods: usize,
}

impl Met {
    fn new(data: &DesignColumns<'_>) -> Self {
        let rows = data.values.len();
        let cell = |row: usize| -> String {
            let levels = data.within.iter();
            let levels: Vec<&str> = levels.map(|(_, cells)| cells[row].as_str()).collect();
            levels.join(":")
        };
        let cells = Index::from_labels(&(0..rows).map(cell).collect::<Vec<_>>());
        let of_person = data.filled_rows();
        let mut before = vec![None; rows];
        for person_rows in &of_person {
            for &row in person_rows {
                let earlier = data.periods[row].checked_sub(1);
                before[row] =
                    person_rows.iter().copied().find(|r| Some(data.periods[*r]) == earlier);
            }
        }
        Self {
            of_person,
            condition: cells.rows,
            period: data.periods.iter().map(|period| period.saturating_sub(1)).collect(),
            before,
            conditions: cells.names.len(),
            periods: data.periods.iter().copied().max().unwrap_or(0),
        }
    }

    /// How many different orders there are.
    fn orders(&self) -> usize {
        let order_of = |rows: &Vec<usize>| {
            let met = rows.iter();
            let mut order: Vec<(usize, usize)> =
                met.map(|&row| (self.period[row], self.condition[row])).collect();
            order.sort_unstable();
            order
        };
        let orders: BTreeSet<_> = self.of_person.iter().map(order_of).collect();
        orders.len()
    }

    /// Variance of the difference of two conditions over that of the residuals, people fixed, mean over the pairs; `None` where the orders
    /// do not tell all effects apart.
    fn variance(&self, carried: bool) -> Option<f64> {
        let (k, periods) = (self.conditions, self.periods);
        let (first, last) = (k - 1, k - 1 + periods.saturating_sub(1));
        let columns = if carried { last + k - 1 } else { last };
        let is = |yes: bool| f64::from(u8::from(yes));
        let value = |row: usize, column: usize| {
            if column < first {
                return is(self.condition[row] == column + 1);
            }
            if column < last {
                return is(self.period[row] == column - first + 1);
            }
            match self.before[row].map(|before| self.condition[before]) {
                None => 0.0,
                Some(before) if before == k - 1 => -1.0,
                Some(before) => is(before == column - last),
            }
        };
        let mut information = Matrix::zeros(columns, columns);
        for rows in &self.of_person {
            let centred = Matrix::from(rows.len(), columns, |i, column| {
                let mean: f64 = rows.iter().map(|&row| value(row, column)).sum();
                value(rows[i], column) - mean / rows.len() as f64
            });
            information.add(&centred.transposed_times(&centred), 1.0);
        }
        let inverse = information.cholesky()?.inverse();
        let entry = |i: usize, j: usize| match (i.checked_sub(1), j.checked_sub(1)) {
            (Some(i), Some(j)) => inverse[(i, j)],
            _ => 0.0,
        };
        let pairs = (0..k).flat_map(|i| (0..i).map(move |j| (i, j)));
        let of_pairs: Vec<f64> =
            pairs.map(|(i, j)| entry(i, i) + entry(j, j) - 2.0 * entry(i, j)).collect();
        Some(of_pairs.iter().sum::<f64>() / of_pairs.len() as f64)
    }
}

//! The columns of a model: factors in treatment coding, covariates less their means.

use super::formula::Formula;
use crate::{
    StatsError,
    numerics::projection::residuals,
    within_subjects::{Index, tell_apart},
};

/// One predictor, a value a row.
#[derive(Debug, Clone, Copy)]
pub enum Predictor<'a> {
    /// Numbers.
    Covariate(&'a [Option<f64>]),
    /// Labels; the first level to appear is the reference.
    Factor(&'a [Option<String>]),
    /// Labels whose effects sum to zero; a row without one is not missing, and has none of them.
    SumToZero(&'a [Option<String>]),
}

impl Predictor<'_> {
    pub(super) fn rows(&self) -> usize {
        match self {
            Self::Covariate(values) => values.len(),
            Self::Factor(cells) | Self::SumToZero(cells) => cells.len(),
        }
    }

    pub(super) fn is_missing(&self, row: usize) -> bool {
        match self {
            Self::Covariate(values) => values[row].is_none(),
            Self::Factor(cells) => cells[row].is_none(),
            Self::SumToZero(_) => false,
        }
    }
}

/// One predictor on the rows that are used.
enum Coded {
    Covariate {
        /// Less `mean`.
        values: Vec<f64>,
        mean: f64,
    },
    Factor {
        levels: Vec<String>,
        of_row: Vec<usize>,
    },
    /// A column each level but the last, which has -1 in all of them.
    SumToZero {
        levels: Vec<String>,
        of_row: Vec<Option<usize>>,
    },
}

impl Coded {
    /// None of a covariate.
    fn levels(&self) -> Option<&[String]> {
        match self {
            Self::Covariate { .. } => None,
            Self::Factor { levels, .. } | Self::SumToZero { levels, .. } => Some(levels),
        }
    }
}

/// Product of dummies of levels (0 for a covariate) of the predictors of one term.
#[derive(Debug, Clone, PartialEq)]
struct Column {
    /// Predictor, and its level if it is a factor.
    parts: Vec<(usize, usize)>,
}

/// The levels of a factor in the rows that are used.
pub(super) struct FactorRows<'a> {
    /// How many there are.
    pub(super) levels: usize,
    /// That of each row.
    pub(super) of_row: &'a [usize],
}

impl FactorRows<'_> {
    /// Whether no subject has two rows at one level: subject × factor cannot be told from a row.
    pub(super) fn is_residual(&self, people: &[Vec<usize>]) -> bool {
        people.iter().all(|rows| {
            let mut levels: Vec<usize> = rows.iter().map(|&row| self.of_row[row]).collect();
            levels.sort_unstable();
            levels.windows(2).all(|pair| pair[0] != pair[1])
        })
    }
}

/// How one predictor enters a combination of coefficients.
#[derive(Debug, Clone)]
pub(super) enum Weight {
    /// Of a factor: a weight a level. Of levels whose effects sum to zero they stand for no level where they sum to 1.
    Levels(Vec<f64>),
    /// Of a covariate: its coefficient.
    Slope,
    /// Of a covariate: at this value, less its mean.
    At(f64),
}

/// All columns after the intercept, in the order of the terms.
pub(super) struct Columns<'a> {
    formula: &'a Formula,
    coded: Vec<Coded>,
    products: Vec<Column>,
}

impl<'a> Columns<'a> {
    /// `predictors` in the order of the formula's, all there in the rows `kept`.
    pub(super) fn new(
        formula: &'a Formula,
        predictors: &[Predictor],
        kept: &[usize],
    ) -> Result<Self, StatsError> {
        let coded: Vec<Coded> = formula
            .predictors()
            .iter()
            .zip(predictors)
            .map(|(name, predictor)| code(name, predictor, kept))
            .collect::<Result<_, _>>()?;
        let mut columns = Vec::new();
        for term in formula.terms() {
            let levels = term.iter().filter_map(|&p| coded[p].levels());
            tell_apart(&levels.collect::<Vec<_>>())?;
            let mut products: Vec<Vec<(usize, usize)>> = vec![Vec::new()];
            for &p in term {
                let levels = match &coded[p] {
                    Coded::Covariate { .. } => 0..1,
                    Coded::Factor { levels, .. } => 1..levels.len(),
                    Coded::SumToZero { levels, .. } => 0..levels.len() - 1,
                };
                products = levels
                    .flat_map(|level| {
                        products.iter().map(move |part| [&part[..], &[(p, level)]].concat())
                    })
                    .collect();
            }
            columns.extend(products.into_iter().map(|parts| Column { parts }));
        }
        Ok(Self { formula, coded, products: columns })
    }

    /// Columns, the intercept counted.
    pub(super) fn count(&self) -> usize {
        self.products.len() + 1
    }

    /// Column `j` in row `i` of those that are used; 0 is the intercept.
    pub(super) fn value(&self, i: usize, j: usize) -> f64 {
        let Some(column) = j.checked_sub(1).map(|j| &self.products[j]) else {
            return 1.0;
        };
        let part = |&(p, level): &(usize, usize)| match &self.coded[p] {
            Coded::Covariate { values, .. } => values[i],
            Coded::Factor { of_row, .. } => f64::from(u8::from(of_row[i] == level)),
            Coded::SumToZero { levels, of_row } => match of_row[i] {
                None => 0.0,
                Some(last) if last + 1 == levels.len() => -1.0,
                Some(of_row) => f64::from(u8::from(of_row == level)),
            },
        };
        column.parts.iter().map(part).product()
    }

    /// The factor of this name; none if it is no predictor, or a covariate.
    pub(super) fn factor(&self, name: &str) -> Option<FactorRows<'_>> {
        let place = self.formula.predictors().iter().position(|p| p == name)?;
        match &self.coded[place] {
            Coded::Covariate { .. } | Coded::SumToZero { .. } => None,
            Coded::Factor { levels, of_row } => Some(FactorRows { levels: levels.len(), of_row }),
        }
    }

    /// `(Intercept)`, `x`, `a[a2]`, `a[a2]:x`.
    fn name(&self, j: usize) -> String {
        j.checked_sub(1)
            .map_or_else(|| "(Intercept)".to_owned(), |j| self.name_of(&self.products[j]))
    }

    fn name_of(&self, column: &Column) -> String {
        let part = |&(p, level): &(usize, usize)| {
            let name = &self.formula.predictors()[p];
            match &self.coded[p] {
                Coded::Covariate { .. } => name.clone(),
                Coded::Factor { levels, .. } | Coded::SumToZero { levels, .. } => {
                    format!("{name}[{}]", levels[level])
                }
            }
        };
        column.parts.iter().map(part).collect::<Vec<_>>().join(":")
    }

    /// The first column that those before it determine.
    pub(super) fn collinear(&self, rows: usize) -> Option<String> {
        let column = |j: usize| -> Vec<f64> { (0..rows).map(|i| self.value(i, j)).collect() };
        let columns: Vec<Vec<f64>> = (0..self.count()).map(column).collect();
        let dependent = residuals(&columns, &[]).err();
        dependent.map(|j| self.name(j))
    }

    /// Levels of predictor `p` if it is no covariate.
    pub(super) fn levels(&self, p: usize) -> Option<&[String]> {
        self.coded[p].levels()
    }

    /// Every factor averaged over its levels, every covariate at 0 as it was given.
    pub(super) fn at_zero(&self) -> Vec<Weight> {
        self.weights(|mean| Weight::At(-mean))
    }

    /// Every factor averaged over its levels, every covariate at its mean.
    pub(super) fn at_means(&self) -> Vec<Weight> {
        self.weights(|_| Weight::At(0.0))
    }

    fn weights(&self, covariate: impl Fn(f64) -> Weight) -> Vec<Weight> {
        let weight = |coded: &Coded| match coded {
            Coded::Covariate { mean, .. } => covariate(*mean),
            Coded::Factor { levels, .. } | Coded::SumToZero { levels, .. } => {
                Weight::Levels(vec![1.0 / levels.len() as f64; levels.len()])
            }
        };
        self.coded.iter().map(weight).collect()
    }

    /// The coefficient of each column by its name, and of the last of levels whose effects sum to zero, which has no column.
    pub(super) fn coefficients(&self) -> Vec<(String, Vec<f64>)> {
        let intercept = Column { parts: Vec::new() };
        let first = (self.name(0), self.coefficient(&intercept));
        let last = self.coded.iter().enumerate().filter_map(|(p, coded)| match coded {
            Coded::SumToZero { levels, .. } => Some(Column { parts: vec![(p, levels.len() - 1)] }),
            _ => None,
        });
        let columns = self.products.iter().cloned().chain(last);
        let named = columns.map(|column| (self.name_of(&column), self.coefficient(&column)));
        std::iter::once(first).chain(named).collect()
    }

    /// The coefficient of a column with covariates as given, not less their means: every level its reference but those of the column.
    fn coefficient(&self, column: &Column) -> Vec<f64> {
        let mut weights = self.at_zero();
        for (weight, coded) in weights.iter_mut().zip(&self.coded) {
            if let (Weight::Levels(levels), Coded::Factor { .. }) = (weight, coded) {
                levels.fill(0.0);
                levels[0] = 1.0;
            }
        }
        for &(p, level) in &column.parts {
            match &mut weights[p] {
                // The level less the mean of all, which is 0.
                Weight::Levels(levels) if matches!(self.coded[p], Coded::SumToZero { .. }) => {
                    let others = -1.0 / levels.len() as f64;
                    levels.fill(others);
                    levels[level] += 1.0;
                }
                Weight::Levels(levels) => (levels[0], levels[level]) = (-1.0, 1.0),
                covariate => *covariate = Weight::Slope,
            }
        }
        self.combination(&weights)
    }

    /// The coefficients of the columns in a combination of the model's values.
    pub(super) fn combination(&self, weights: &[Weight]) -> Vec<f64> {
        let of_column = |column: &Column| -> f64 {
            let factor = |(p, weight): (usize, &Weight)| {
                let part = column.parts.iter().find(|(q, _)| *q == p);
                match (weight, part) {
                    (Weight::Levels(levels), Some(&(_, level))) => match &self.coded[p] {
                        Coded::SumToZero { .. } => levels[level] - levels[levels.len() - 1],
                        _ => levels[level],
                    },
                    // The column is the same at every level.
                    (Weight::Levels(levels), None) => levels.iter().sum(),
                    (Weight::Slope, Some(_)) | (Weight::At(_), None) => 1.0,
                    (Weight::Slope, None) => 0.0,
                    (Weight::At(value), Some(_)) => *value,
                }
            };
            weights.iter().enumerate().map(factor).product()
        };
        let intercept = Column { parts: Vec::new() };
        std::iter::once(&intercept).chain(&self.products).map(of_column).collect()
    }
}

fn code(name: &str, predictor: &Predictor, kept: &[usize]) -> Result<Coded, StatsError> {
    match predictor {
        Predictor::Covariate(cells) => {
            let given: Vec<f64> = kept.iter().filter_map(|&row| cells[row]).collect();
            let first = given.first().copied().unwrap_or(0.0);
            let shift = given.iter().map(|v| v - first).sum::<f64>() / given.len() as f64;
            Ok(Coded::Covariate {
                values: given.iter().map(|v| (v - first) - shift).collect(),
                mean: first + shift,
            })
        }
        Predictor::SumToZero(cells) => {
            let levels = Index::from_labels(cells.iter().flatten()).names;
            let place = |cell: &String| levels.iter().position(|level| level == cell);
            let of_row = kept.iter().map(|&row| cells[row].as_ref().and_then(place)).collect();
            StatsError::two_levels(name, &levels)?;
            Ok(Coded::SumToZero { levels, of_row })
        }
        Predictor::Factor(cells) => {
            // In order of appearance in all rows, without levels that no row has that is used.
            let used: Vec<&String> = kept.iter().filter_map(|&row| cells[row].as_ref()).collect();
            let mut levels = Index::from_labels(cells.iter().flatten()).names;
            levels.retain(|level| used.contains(&level));
            StatsError::two_levels(name, &levels)?;
            let place = |cell: &String| levels.iter().position(|level| level == cell);
            let of_row = used.into_iter().filter_map(place).collect();
            Ok(Coded::Factor { levels, of_row })
        }
    }
}

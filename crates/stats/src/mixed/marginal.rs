//! Marginal means of a mixed model, and their differences.

use serde::{Deserialize, Serialize};

use super::{columns::Weight, described::Described, formula::Formula, own_errors::OwnErrors};
use crate::{
    Interval, MarginalMean, Named, Reasons,
    numerics::distributions::{t_quantile_two_sided, t_two_sided},
    within_subjects::each_pair,
};

/// The difference of two marginal means of a mixed model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MarginalContrast {
    /// A minus B.
    pub estimate: f64,
    /// Its standard error.
    pub se: f64,
    /// Satterthwaite's degrees of freedom.
    pub df: Option<f64>,
    /// estimate / se.
    pub t: f64,
    /// Two-sided.
    pub p: Option<f64>,
    /// Holm's correction over the pairs of the term.
    pub p_holm: Option<f64>,
    /// The 95 % interval, not adjusted.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

impl MarginalContrast {
    /// By t with these degrees of freedom, not adjusted.
    pub(crate) fn from_estimate(estimate: f64, se: f64, df: Option<f64>) -> Self {
        let t = estimate / se;
        let half = df.and_then(|df| Some(se * t_quantile_two_sided(0.05, df)?));
        Self {
            estimate,
            se,
            df,
            t,
            p: df.map(|df| t_two_sided(t, df)),
            p_holm: None,
            ci: Interval::around(estimate, half),
        }
    }

    /// The contrasts of one family by name, with Holm's correction.
    pub(crate) fn family(pairs: impl IntoIterator<Item = (String, Self)>) -> Named<Self> {
        let pairs: Named<Self> = pairs.into_iter().collect();
        pairs.with_holm(|pair| pair.p, |pair, p| pair.p_holm = p)
    }
}

/// A cell of a term's factors: its levels, and the combination of coefficients that is its mean.
pub(super) struct Cell<'a> {
    levels: Vec<&'a str>,
    weights: Vec<f64>,
}

impl Cell<'_> {
    fn name(&self) -> String {
        self.levels.join(":")
    }

    /// Whether the cells differ in one factor alone: a simple difference.
    fn is_beside(&self, other: &Self) -> bool {
        let pairs = self.levels.iter().zip(&other.levels);
        pairs.filter(|(a, b)| a != b).count() == 1
    }
}

pub(super) const NO_FREEDOM: &str =
    "the variances have no information, so neither have degrees of freedom";

/// Why a pair has no error of its own.
const NO_OWN_ERROR: &str = "the pair has no error of its own: without one of the subjects it cannot be estimated, or it is the same in everybody";

/// The pairs of each term of factors.
pub(crate) type PairsByTerm = Named<Named<MarginalContrast>>;

impl Described<'_> {
    /// The cells of each term that has factors alone: covariates at their mean, other factors averaged.
    fn cells(&self, formula: &Formula) -> Vec<(String, Vec<Cell<'_>>)> {
        let mut by_term = Vec::new();
        for term in formula.terms() {
            let levels: Option<Vec<&[String]>> =
                term.iter().map(|&p| self.columns.levels(p)).collect();
            let Some(levels) = levels else { continue };
            let mut cells = vec![(Vec::new(), self.columns.at_means())];
            for (&p, levels) in term.iter().zip(&levels) {
                let mut next = Vec::new();
                for (names, weights) in &cells {
                    for (i, level) in levels.iter().enumerate() {
                        let (mut names, mut weights) = (names.clone(), weights.clone());
                        names.push(level.as_str());
                        let one = (0..levels.len()).map(|j| f64::from(u8::from(i == j)));
                        weights[p] = Weight::Levels(one.collect());
                        next.push((names, weights));
                    }
                }
                cells = next;
            }
            let cells = cells.into_iter().map(|(levels, weights)| Cell {
                levels,
                weights: self.columns.combination(&weights),
            });
            by_term.push((formula.name(term), cells.collect()));
        }
        by_term
    }

    /// Means by term and cell.
    pub(super) fn means(
        &self,
        formula: &Formula,
        undefined: &mut Reasons,
    ) -> Named<Named<MarginalMean>> {
        let mut one = |term: &str, cell: &Cell| {
            let (mean, se, df) = self.estimates.estimate(&cell.weights);
            let half = df.and_then(|df| Some(se * t_quantile_two_sided(0.05, df)?));
            let name = cell.name();
            if half.is_none() {
                undefined.note(&format!("emm.{term}.{name}"), NO_FREEDOM);
            }
            let mean = MarginalMean { mean, se, ci: Interval::around(mean, half) };
            (name, mean)
        };
        let terms = self.cells(formula).into_iter();
        terms
            .map(|(term, cells)| {
                let means = cells.iter().map(|cell| one(&term, cell)).collect();
                (term, means)
            })
            .collect()
    }

    /// Differences by term and pair of cells; of an interaction the pairs that differ in one factor.
    pub(super) fn contrasts(&self, formula: &Formula, undefined: &mut Reasons) -> PairsByTerm {
        let contrast = |weights: &[f64]| {
            let (estimate, se, df) = self.estimates.estimate(weights);
            MarginalContrast::from_estimate(estimate, se, df)
        };
        self.pairs(formula, contrast, ("contrast", NO_FREEDOM), undefined)
    }

    /// The same, each over its own error; without a p, over that of the model, where it has none.
    pub(super) fn own_contrasts(
        &self,
        formula: &Formula,
        errors: &OwnErrors,
        undefined: &mut Reasons,
    ) -> PairsByTerm {
        let contrast = |weights: &[f64]| {
            let (estimate, of_the_model, _) = self.estimates.estimate(weights);
            let (se, df) = errors.error_of(weights).unzip();
            MarginalContrast::from_estimate(estimate, se.unwrap_or(of_the_model), df)
        };
        self.pairs(formula, contrast, ("own_error", NO_OWN_ERROR), undefined)
    }

    fn pairs(
        &self,
        formula: &Formula,
        contrast: impl Fn(&[f64]) -> MarginalContrast,
        (prefix, why_no_p): (&str, &str),
        undefined: &mut Reasons,
    ) -> PairsByTerm {
        let mut by_term = Vec::new();
        for (term, cells) in self.cells(formula) {
            let mut pairs = Vec::new();
            for (a, b) in each_pair(&cells).filter(|(a, b)| a.is_beside(b)) {
                let name = format!("{}|{}", a.name(), b.name());
                let weights = a.weights.iter().zip(&b.weights).map(|(a, b)| a - b);
                let contrast = contrast(&weights.collect::<Vec<f64>>());
                if contrast.p.is_none() {
                    undefined.note(&format!("{prefix}.{term}.{name}"), why_no_p);
                }
                pairs.push((name, contrast));
            }
            by_term.push((term, MarginalContrast::family(pairs)));
        }
        by_term.into_iter().collect()
    }
}

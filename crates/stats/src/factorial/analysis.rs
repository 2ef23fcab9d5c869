//! The analysis of a factorial design: every effect, mean and contrast of it.

use serde::{Deserialize, Serialize};

use super::{
    FactorialDesign,
    anova::{self, FactorialEffect},
    cells::Cells,
    means::{self, CellContrast, MarginalMean, SimpleEffect},
};
use crate::{Mauchly, Named, Reasons, Sphericity};

/// The analysis of a factorial design.
///
/// An effect joins its factors with `:`, those between subjects first (`group:a:b`); a cell joins its levels in the same order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Factorial {
    /// Complete subjects.
    pub n: usize,
    /// Subjects left out.
    pub n_dropped: usize,
    /// Their names: a cell, or a level of a factor between subjects, is missing.
    pub dropped: Vec<String>,
    /// Levels of each factor, those between subjects first.
    pub levels: Named<Vec<String>>,
    /// F of each effect, by type III sums of squares.
    pub anova: Named<FactorialEffect>,
    /// Corrections for a lack of sphericity, where the part within subjects has more than one degree of freedom.
    pub sphericity: Named<Sphericity>,
    /// Mauchly's test of the same effects. Of its p values the second-order term of `p` holds the number of all cells within
    /// subjects, as in R, where Anderson has the degrees of freedom.
    pub mauchly: Named<Mauchly>,
    /// Marginal means of each effect, by cell, with intervals by the covariance that is pooled over groups.
    pub emm: Named<Named<MarginalMean>>,
    /// Differences of the marginal means of each factor, by pair of levels.
    pub contrast: Named<Named<CellContrast>>,
    /// Of each effect of two factors a:b: `a@b1`, the effect of a at one level of b, and the reverse.
    pub simple: Named<Named<SimpleEffect>>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Analyses a factorial design: F of every effect with corrected degrees of freedom and effect sizes, marginal means, contrasts and simple effects.
///
/// Sums of squares are of type III: an effect is a hypothesis on the means of the cells with equal weight, so that neither unequal
/// groups nor the order of the factors matter. An effect within subjects has its own error (its interaction with the subjects, pooled
/// over groups). Means, contrasts and simple effects come from the multivariate model: no sphericity is assumed, the
/// covariance of the cells is pooled over groups, with n - groups degrees of freedom.
///
/// # Source
/// Maxwell, Delaney and Kelley (2018), chapters 7, 12 to 15; Lecoutre (1991) for Huynh and Feldt's ε; Olejnik and Algina (2003). Agrees with R's
/// afex and emmeans (`model = "multivariate"`).
///
/// # Example
/// ```
/// use maveric_stats::{FactorialDesign, factorial};
/// let people: Vec<String> = (0..12).map(|i| (i / 2).to_string()).collect();
/// let mode: Vec<String> = (0..12).map(|i| ["calm", "sporty"][i % 2].to_owned()).collect();
/// let age: Vec<_> = (0..12).map(|i| Some(["old", "young"][i / 6].to_owned())).collect();
/// let value = [1.0, 4.0, 2.0, 4.5, 1.5, 5.0, 3.0, 3.5, 2.5, 3.0, 4.0, 4.5].map(Some);
/// let design = FactorialDesign::from_columns(&people, &[("mode", &mode)], &[("age", &age)], &value)?;
/// let result = factorial(&design);
/// let both = result.anova.get("age:mode").unwrap();
/// assert_eq!((both.df1, both.df2), (1, 4));
/// assert!(both.p.unwrap() < 0.01);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn factorial(design: &FactorialDesign) -> Factorial {
    let cells = Cells::new(design, &design.values);
    let mut undefined = Reasons::default();
    let tests = anova::tests(&cells, &mut undefined);
    let means = means::Means::new(&cells);
    Factorial {
        n: design.n(),
        n_dropped: design.dropped().len(),
        dropped: design.dropped().to_vec(),
        levels: design.factors().into_iter().map(|f| (f.name.clone(), f.levels.clone())).collect(),
        anova: tests.anova,
        sphericity: tests.sphericity,
        mauchly: tests.mauchly,
        emm: means.marginal(&mut undefined),
        contrast: means.contrasts(&mut undefined),
        simple: means.simple(&mut undefined),
        undefined,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BetweenColumn, StatsError};

    fn names(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    fn some(text: &str) -> Vec<Option<String>> {
        let cell = |t: &str| (t != "-").then(|| t.to_owned());
        text.split(' ').map(cell).collect()
    }

    #[test]
    fn two_conditions_are_the_paired_t_test() {
        let a = [1.0, 2.5, 3.0, 4.75, 2.0];
        let b = [2.0, 2.0, 4.5, 7.0, 2.25];
        let subjects: Vec<String> = (0..10).map(|i| (i / 2).to_string()).collect();
        let values: Vec<_> = a.iter().zip(&b).flat_map(|(a, b)| [Some(*a), Some(*b)]).collect();
        let condition = names("a b a b a b a b a b");
        let design =
            FactorialDesign::from_columns(&subjects, &[("c", &condition)], &[], &values).unwrap();
        let result = factorial(&design);
        let data = crate::WithinSubjects::from_long(&subjects, &condition, &values).unwrap();
        let whole = crate::within(&data);
        let (t, f) = (whole.paired.get("a|b").unwrap(), result.anova.get("c").unwrap());
        assert!((t.t.unwrap().powi(2) / f.f.unwrap() - 1.0).abs() < 1e-12);
        let contrast = result.contrast.get("c").unwrap().get("a|b").unwrap();
        assert!((contrast.p.unwrap() / t.p.unwrap() - 1.0).abs() < 1e-10);
        assert!(result.sphericity.is_empty());
    }

    #[test]
    fn a_subject_without_a_cell_or_a_group_is_left_out_by_name() {
        let design = FactorialDesign::from_columns(
            &names("p p q q r r s s t t"),
            &[("c", &names("a b a b a b a b a b"))],
            &[("g", &some("x x x x - - y y y y"))],
            &[1.0, 2.0, 3.0, 5.0, 1.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(Some),
        )
        .unwrap();
        assert_eq!(design.dropped(), ["r"]);
        assert_eq!(factorial(&design).n_dropped, 1);
    }

    #[test]
    fn what_is_no_design_is_refused_by_name() {
        let value = [Some(1.0); 4];
        let of = |within: &str, between: &str, value: &[Option<f64>]| {
            let (within, between) = (names(within), some(between));
            let columns: [BetweenColumn; 1] = [("g", &between)];
            FactorialDesign::from_columns(&names("p p q q"), &[("c", &within)], &columns, value)
                .unwrap_err()
        };
        assert!(
            matches!(of("a a a a", "x x y y", &value), StatsError::OneLevel { factor, .. } if factor == "c")
        );
        assert!(
            matches!(of("a b a b", "x y x y", &value), StatsError::TwoGroups { subject, .. } if subject == "p")
        );
        assert!(matches!(of("a a a b", "x x y y", &value), StatsError::DoubleCell { .. }));
        let missing = [Some(1.0), None, Some(2.0), None];
        assert!(
            matches!(of("a b a b", "x x y y", &missing), StatsError::EmptyCell { cell } if cell == "b")
        );
        assert!(matches!(of("a b a b", "x x y y", &value), StatsError::TooFew { .. }));
        let none = FactorialDesign::from_columns(&names("p q"), &[], &[], &value[..2]);
        assert!(matches!(none, Err(StatsError::BadParameter { .. })));
    }

    #[test]
    fn every_row_is_a_subject_without_a_factor_within() {
        let columns = some("x x y y");
        let of = |subjects: &str| {
            let values = [1.0, 2.0, 4.0, 5.0].map(Some);
            FactorialDesign::from_columns(&names(subjects), &[], &[("g", &columns)], &values)
        };
        assert_eq!(factorial(&of("p q r s").unwrap()).anova.get("g").unwrap().df2, 2);
        assert!(matches!(of("p q r p"), Err(StatsError::DoubleName { .. })));
    }
}

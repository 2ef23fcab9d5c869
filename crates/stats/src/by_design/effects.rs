//! The test of each effect, as its plan has it.

use serde::{Deserialize, Serialize};

use super::plan::{DesignPlan, DesignShape, EffectMethod};
use crate::{
    Factorial, FactorialDesign, Named, Sphericity, SphericityCorrection, StatsError,
    WithinSubjects,
    factorial::{Regressed, SubjectCovariate, Unpooled, regressed, unpooled},
    groups, within_without_exact,
};

/// The test that decides about one effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectTest {
    /// Which test.
    pub method: EffectMethod,
    /// F; W+ of signed ranks; U of two groups' ranks, of more groups χ²; Friedman's χ² where all people agree and F has no bound.
    pub statistic: Option<f64>,
    /// Degrees of freedom, corrected; none of W+ and U.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub df1: Option<f64>,
    /// Of the error, corrected; F only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub df2: Option<f64>,
    /// By which both were multiplied; F over a stratum only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub epsilon: Option<f64>,
    /// Which correction that is.
    pub correction: SphericityCorrection,
    /// P of a statistic as large where the effect is nil; `None` where the people do not differ in it.
    pub p: Option<f64>,
}

impl EffectTest {
    /// Whether all people order the levels alike, so that Friedman's χ² decides where F would.
    pub fn is_unanimous(&self) -> bool {
        let friedman =
            matches!(self.method, EffectMethod::Friedman | EffectMethod::FriedmanOfDifferences);
        friedman && self.statistic.is_some() && self.df2.is_none()
    }

    fn untested(method: EffectMethod) -> Self {
        Self {
            method,
            statistic: None,
            df1: None,
            df2: None,
            epsilon: None,
            correction: SphericityCorrection::None,
            p: None,
        }
    }

    /// F with whole degrees of freedom, corrected where there is something to correct.
    fn f(
        method: EffectMethod,
        f: Option<f64>,
        df: [usize; 2],
        p: Option<f64>,
        sphericity: Option<&Sphericity>,
    ) -> Self {
        let mut test = Self::untested(method);
        (test.statistic, test.p) = (f, p);
        if let Some(sphericity) = sphericity {
            test.correction = match method {
                EffectMethod::StrataGreenhouseGeisser => SphericityCorrection::GreenhouseGeisser,
                _ => sphericity.correction(),
            };
            (test.epsilon, test.p) = sphericity.corrected(test.correction, p);
        }
        let times = test.epsilon.unwrap_or(1.0);
        [test.df1, test.df2] = df.map(|df| Some(df as f64 * times));
        test
    }
}

/// A design with the analysis of variance of its complete subjects.
pub(super) struct Effects<'a> {
    pub(super) shape: &'a DesignShape,
    pub(super) design: &'a FactorialDesign,
    pub(super) anova: &'a Factorial,
    pub(super) covariates: &'a [SubjectCovariate<'a>],
}

impl Effects<'_> {
    /// The test of each effect of the plan.
    pub(super) fn tests(
        &self,
        plan: &DesignPlan,
        normal: bool,
    ) -> Result<Named<EffectTest>, StatsError> {
        let apart = unpooled(self.design);
        let regressions = self.regressions()?;
        let mut tests = Vec::new();
        for effect in &plan.effects {
            let method = effect.method(normal);
            let name = effect.effect.as_str();
            let test = match method {
                EffectMethod::Strata | EffectMethod::StrataGreenhouseGeisser => {
                    self.strata(name, method)
                }
                EffectMethod::Unpooled => {
                    let test = apart.iter().find(|(known, _)| known == name);
                    of_unpooled(test.and_then(|(_, test)| *test))
                }
                EffectMethod::Regression => {
                    let test = regressions.iter().find(|test| test.name == name);
                    test.map_or_else(
                        || EffectTest::untested(method),
                        |test| {
                            let sphericity = test.sphericity.as_ref();
                            EffectTest::f(method, test.f, [test.df1, test.df2], test.p, sphericity)
                        },
                    )
                }
                ranks => self.ranks(name, ranks)?,
            };
            tests.push((name.to_owned(), test));
        }
        Ok(tests.into_iter().collect())
    }

    /// Of every stratum that has a covariate in it.
    fn regressions(&self) -> Result<Vec<Regressed>, StatsError> {
        let mut tests = Vec::new();
        for within in 0..1_usize << self.shape.within.len() {
            let of_stratum: Vec<SubjectCovariate> = self
                .covariates
                .iter()
                .filter(|c| self.shape.has_covariate(within, c.name))
                .cloned()
                .collect();
            if !of_stratum.is_empty() {
                tests.extend(regressed(self.design, &self.inside(within), &of_stratum)?);
            }
        }
        Ok(tests)
    }

    fn inside(&self, within: usize) -> Vec<bool> {
        (0..self.shape.within.len()).map(|f| within >> f & 1 == 1).collect()
    }

    fn strata(&self, name: &str, method: EffectMethod) -> EffectTest {
        let Some(effect) = self.anova.anova.get(name) else {
            return EffectTest::untested(method);
        };
        let (df, sphericity) = ([effect.df1, effect.df2], self.anova.sphericity.get(name));
        EffectTest::f(method, effect.f, df, effect.p, sphericity)
    }

    fn ranks(&self, name: &str, method: EffectMethod) -> Result<EffectTest, StatsError> {
        let effects = self.shape.effects();
        let within = effects.iter().find(|(known, ..)| known == name);
        let kept = self.inside(within.map_or(0, |(_, _, within)| *within));
        let sums = self.design.sums(&kept);
        let factors = self.shape.within.iter().zip(&kept);
        let levels: Vec<usize> = factors.filter(|(_, kept)| **kept).map(|((_, k), _)| *k).collect();
        let mut test = EffectTest::untested(method);
        match method {
            EffectMethod::SignedRanks => {
                let table = table(self.design, &signed(&sums, levels.len()))?;
                let tests = within_without_exact(&table);
                let ranks = tests.wilcoxon.values().next();
                test.statistic = ranks.and_then(|w| w.w_plus);
                test.p = ranks.and_then(|w| w.p);
            }
            EffectMethod::Friedman | EffectMethod::FriedmanOfDifferences => {
                let rows = match levels[..] {
                    [2, k] => {
                        sums.iter().map(|s| (0..k).map(|j| s[j] - s[k + j]).collect()).collect()
                    }
                    [k, _] => sums
                        .iter()
                        .map(|s| (0..k).map(|j| s[2 * j] - s[2 * j + 1]).collect())
                        .collect(),
                    _ => sums,
                };
                let friedman = within_without_exact(&table(self.design, &rows)?).friedman;
                if friedman.f.is_some() {
                    (test.statistic, test.p) = (friedman.f, friedman.f_p);
                    (test.df1, test.df2) = (friedman.f_df1, friedman.f_df2);
                } else {
                    // Where all people agree F has no bound.
                    (test.statistic, test.p) = (friedman.chi2, friedman.p);
                    test.df1 = friedman.df.map(|df| df as f64);
                }
            }
            _ => {
                let values: Vec<Option<f64>> = sums.iter().map(|s| Some(s.iter().sum())).collect();
                let comparison = groups(&self.design.levels_of(0), &values)?;
                if let Some(several) = &comparison.several {
                    test.statistic = several.kruskal.chi2;
                    test.df1 = Some(several.kruskal.df as f64);
                    test.p = several.kruskal.p;
                } else {
                    let two = comparison.mann_whitney.values().next();
                    test.statistic = two.map(|u| u.u);
                    test.p = two.and_then(|u| u.p);
                }
            }
        }
        Ok(test)
    }
}

/// Of cells of factors with two levels each: the sum of those that the contrast adds, and of those that it takes away.
fn signed(sums: &[Vec<f64>], factors: usize) -> Vec<Vec<f64>> {
    let minus = |cell: usize| cell.count_ones() % 2 == 1;
    debug_assert!(sums.iter().all(|row| row.len() == 1 << factors));
    let row = |row: &Vec<f64>| {
        let side = |side: bool| {
            let cells = row.iter().enumerate();
            cells.filter(|(cell, _)| minus(*cell) == side).map(|(_, v)| v).sum()
        };
        vec![side(false), side(true)]
    };
    sums.iter().map(row).collect()
}

fn table(design: &FactorialDesign, rows: &[Vec<f64>]) -> Result<WithinSubjects, StatsError> {
    let conditions: Vec<String> = (0..rows[0].len()).map(|j| j.to_string()).collect();
    WithinSubjects::from_rows(&conditions, design.subjects(), rows)
}

fn of_unpooled(test: Option<Unpooled>) -> EffectTest {
    let mut effect = EffectTest::untested(EffectMethod::Unpooled);
    if let Some(test) = test {
        effect.statistic = Some(test.f);
        (effect.df1, effect.df2, effect.p) = (Some(test.df1), Some(test.df2), Some(test.p));
    }
    effect
}

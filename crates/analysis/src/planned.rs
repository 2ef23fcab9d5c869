//! Which test a design calls for, before any data: what a preregistration says and what is run.

use crate::crossed::{factors_within, too_many_between};
use maveric_domain::{ConditionId, Design};
use maveric_stats::{DesignPlan, DesignShape};

/// The test of an outcome that a design calls for.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlannedTest {
    /// Two conditions: paired t, or Wilcoxon's signed ranks.
    Pair,
    /// One factor within people: repeated-measures analysis of variance, or Friedman's test.
    OneFactor,
    /// Independent groups: Welch's test, or Mann-Whitney or Kruskal-Wallis.
    Groups,
    /// Groups and a covariate, one row a person: analysis of covariance.
    Covariance,
    /// A test of each effect.
    Effects(DesignPlan),
    /// None, and why.
    None(String),
}

/// The only condition and the baseline, which are then the pair that is compared; none where there are other conditions, or no other baseline.
pub fn held_against_baseline(design: &Design) -> Option<[ConditionId; 2]> {
    let [one] = design.conditions() else {
        return None;
    };
    let baseline = design.baseline_id()?;
    (one.id != baseline).then_some([one.id, baseline])
}

/// The test that a study's design calls for; levels of factors between people count as two, which decides nothing.
pub fn planned(design: &Design) -> PlannedTest {
    let baseline = held_against_baseline(design).map(|[_, baseline]| baseline);
    let conditions: Vec<ConditionId> = design.condition_ids().chain(baseline).collect();
    let (between, covariates) = (design.factors(), design.covariates());
    if let Some(why) = too_many_between(between.len()) {
        return PlannedTest::None(why);
    }
    match (conditions.len(), between.len(), covariates.is_empty()) {
        (..2, 0, _) => PlannedTest::None(
            "one condition and no factor between people: nothing to compare it with".to_owned(),
        ),
        (..2, _, false) => PlannedTest::Covariance,
        (..2, 1, true) => PlannedTest::Groups,
        _ => {
            let within: Vec<(String, usize)> = factors_within(design, &conditions)
                .into_iter()
                .map(|(name, mut levels)| {
                    levels.sort_unstable();
                    levels.dedup();
                    (name, levels.len())
                })
                .filter(|(_, levels)| *levels > 1)
                .collect();
            if let ([(_, levels)], [], true) = (&within[..], between, covariates.is_empty()) {
                return if *levels == 2 { PlannedTest::Pair } else { PlannedTest::OneFactor };
            }
            let shape = DesignShape {
                within,
                between: between.iter().map(|f| (f.name.clone(), 2)).collect(),
                covariates: covariates.iter().map(|c| (c.column.clone(), c.with.clone())).collect(),
            };
            PlannedTest::Effects(DesignPlan::of(&shape))
        }
    }
}

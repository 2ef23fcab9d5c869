//! Parts of a factorial design: the effect of a factor at one level of another.

use serde::{Deserialize, Serialize};

use super::{
    Chosen, ChosenTest, DesignColumns, DesignPlan, DesignTable, EffectTest, FactorialFinding,
    factors::{shaped, tested},
};
use crate::{Adjustment, StatsError, within_subjects::each_pair};

/// The effect of one factor at one level of another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimpleTest {
    /// The factor whose effect it is.
    pub factor: String,
    /// The factor that is held.
    pub at: String,
    /// The level at which it is held.
    pub level: String,
    /// Subjects of that part who are in the test; whoever lacks a value elsewhere is among them.
    pub n: usize,
    /// The test; `None` where that part of the data has none.
    pub test: Option<EffectTest>,
    /// Why there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why_not: Option<String>,
    /// Holm's correction over all simple effects of the same interaction.
    pub p_holm: Option<f64>,
}

/// The simple effects of every interaction of two factors: each tested in the part of the data at that level, as the whole was.
///
/// # Errors
/// Those of the tests of the whole.
///
/// # Source
/// Maxwell, Delaney and Kelley (2018), chapters 7 and 12: the error of a simple effect is its own, not that of the whole design.
pub fn simple_effects(
    data: &DesignColumns<'_>,
    whole: &Chosen<FactorialFinding>,
) -> Result<Vec<SimpleTest>, StatsError> {
    let levels: Vec<(&str, &Vec<String>)> = whole.found.anova.levels.iter().collect();
    let normal = whole.chosen != ChosenTest::Ranks;
    let mut tests = Vec::new();
    for (first, second) in each_pair(&levels) {
        let mut family = Vec::new();
        for (factor, at) in [(first, second), (second, first)] {
            for level in at.1 {
                let part = DesignTable::at_level(data, at.0, level);
                let test = test_of(&part.columns(), factor.0, normal);
                let why_not = test.as_ref().err().map(ToString::to_string);
                let (n, test) = test.ok().unzip();
                family.push(SimpleTest {
                    factor: factor.0.to_owned(),
                    at: at.0.to_owned(),
                    level: level.clone(),
                    n: n.unwrap_or(0),
                    test,
                    why_not,
                    p_holm: None,
                });
            }
        }
        let p = |effect: &SimpleTest| effect.test.as_ref()?.p;
        Adjustment::Holm.correct(&mut family, p, |effect, holm| effect.p_holm = holm);
        tests.extend(family);
    }
    Ok(tests)
}

/// The test of one effect of these data, by the kind that the whole was tested by, and how many subjects are in it.
fn test_of(
    data: &DesignColumns<'_>,
    effect: &str,
    normal: bool,
) -> Result<(usize, EffectTest), StatsError> {
    let (design, shape, covariates) = shaped(data)?;
    let plan = DesignPlan::of(&shape);
    let (_, tests) = tested(&design, &shape, &covariates, &plan, normal)?;
    let test = tests.get(effect).cloned();
    let test = test.map(|test| (design.n(), test));
    test.ok_or_else(|| unknown("an effect", effect, tests.iter().map(|(name, _)| name)))
}

pub(super) fn unknown<'n>(
    what: &str,
    name: &str,
    known: impl Iterator<Item = &'n str>,
) -> StatsError {
    StatsError::UnknownLevel {
        what: what.to_owned(),
        name: name.to_owned(),
        known: known.map(str::to_owned).collect(),
    }
}

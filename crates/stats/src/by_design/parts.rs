//! Parts of a factorial design: the effect of a factor at one level of another.

use serde::{Deserialize, Serialize};

use super::{
    Chosen, ChosenTest, DesignColumns, DesignPlan, EffectTest, FactorialFinding,
    factors::{shaped, tested},
};
use crate::{Adjustment, StatsError};

/// The effect of one factor at one level of another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimpleTest {
    /// The factor whose effect it is.
    pub factor: String,
    /// The factor that is held.
    pub at: String,
    /// The level at which it is held.
    pub level: String,
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
    let mut found = Vec::new();
    for (i, first) in levels.iter().enumerate() {
        for second in &levels[i + 1..] {
            let mut family = Vec::new();
            for (factor, at) in [(first, second), (second, first)] {
                for level in at.1 {
                    let part = DesignTable::at_level(data, at.0, level);
                    let test = test_of(&part.columns(), factor.0, normal);
                    let why_not = test.as_ref().err().map(ToString::to_string);
                    family.push(SimpleTest {
                        factor: factor.0.to_owned(),
                        at: at.0.to_owned(),
                        level: level.clone(),
                        test: test.ok(),
                        why_not,
                        p_holm: None,
                    });
                }
            }
            let p: Vec<Option<f64>> = family
                .iter()
                .map(|effect| effect.test.as_ref().and_then(|test| test.p))
                .collect();
            for (effect, holm) in family.iter_mut().zip(Adjustment::Holm.apply_defined(&p)) {
                effect.p_holm = holm;
            }
            found.extend(family);
        }
    }
    Ok(found)
}

/// The test of one effect of these data, by the kind that the whole was tested by.
fn test_of(data: &DesignColumns<'_>, effect: &str, normal: bool) -> Result<EffectTest, StatsError> {
    let (design, shape, covariates) = shaped(data)?;
    let plan = DesignPlan::of(&shape);
    let (_, tests) = tested(&design, &shape, &covariates, &plan, normal)?;
    let test = tests.get(effect).cloned();
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

/// The same columns with their cells.
#[derive(Debug, Clone, Default)]
pub struct DesignTable {
    /// Whose each row is.
    pub subjects: Vec<String>,
    /// As [`DesignColumns::within`].
    pub within: Vec<(String, Vec<String>)>,
    /// As [`DesignColumns::between`].
    pub between: Vec<(String, Vec<Option<String>>)>,
    /// As [`DesignColumns::covariates`].
    pub covariates: Vec<(String, Vec<Option<f64>>)>,
    /// As [`DesignColumns::with`].
    pub with: Vec<(String, Vec<String>)>,
    /// As [`DesignColumns::periods`].
    pub periods: Vec<usize>,
    /// The outcome.
    pub values: Vec<Option<f64>>,
    /// As [`DesignColumns::labels`].
    pub labels: Vec<(String, String)>,
}

impl DesignTable {
    /// The rows at one level of a factor, without that factor.
    pub(super) fn at_level(data: &DesignColumns<'_>, factor: &str, level: &str) -> Self {
        let within = data.within.iter().find(|(name, _)| *name == factor);
        let between = data.between.iter().find(|(name, _)| *name == factor);
        let is_at = |row: &usize| match (within, between) {
            (Some((_, cells)), _) => cells[*row] == level,
            (_, Some((_, cells))) => cells[*row].as_deref() == Some(level),
            _ => false,
        };
        let rows: Vec<usize> = (0..data.values.len()).filter(is_at).collect();
        Self::rows(data, &rows, Some(factor))
    }

    /// These rows, without a factor.
    pub(super) fn rows(data: &DesignColumns<'_>, rows: &[usize], less: Option<&str>) -> Self {
        fn columns<T: Clone>(
            all: &[(&str, &[T])],
            rows: &[usize],
            less: Option<&str>,
        ) -> Vec<(String, Vec<T>)> {
            let stay = all.iter().filter(|(name, _)| Some(*name) != less);
            stay.map(|(name, cells)| ((*name).to_owned(), these(cells, rows)))
                .collect()
        }
        fn these<T: Clone>(cells: &[T], rows: &[usize]) -> Vec<T> {
            rows.iter().map(|row| cells[*row].clone()).collect()
        }
        let product = |effect: &&str| effect.split(':').all(|name| Some(name) != less);
        let products = |with: &[&str]| {
            let stay = with.iter().copied().filter(product);
            stay.map(str::to_owned).collect()
        };
        let with = data.with.iter();
        Self {
            subjects: these(data.subjects, rows),
            within: columns(&data.within, rows, less),
            between: columns(&data.between, rows, less),
            covariates: columns(&data.covariates, rows, None),
            with: with
                .map(|(n, with)| ((*n).to_owned(), products(with)))
                .collect(),
            periods: rows
                .iter()
                .filter_map(|row| data.periods.get(*row).copied())
                .collect(),
            values: these(data.values, rows),
            labels: Vec::new(),
        }
    }

    /// Its columns.
    pub fn columns(&self) -> DesignColumns<'_> {
        fn columns<T>(all: &[(String, Vec<T>)]) -> Vec<(&str, &[T])> {
            all.iter()
                .map(|(n, cells)| (n.as_str(), &cells[..]))
                .collect()
        }
        let with = self.with.iter();
        DesignColumns {
            subjects: &self.subjects,
            within: columns(&self.within),
            between: columns(&self.between),
            covariates: columns(&self.covariates),
            with: with
                .map(|(n, with)| (n.as_str(), with.iter().map(String::as_str).collect()))
                .collect(),
            periods: &self.periods,
            values: &self.values,
            labels: (self.labels.iter())
                .map(|(n, label)| (n.as_str(), label.as_str()))
                .collect(),
        }
    }
}

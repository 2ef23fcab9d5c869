//! Which test each effect of a design gets, before any data are seen.

use serde::{Deserialize, Serialize};

use crate::factorial::sets_of_factors;

/// What a design is made of, without its data.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DesignShape {
    /// Factors within subjects, and how many levels each has.
    pub within: Vec<(String, usize)>,
    /// Factors between subjects, and how many levels each has.
    pub between: Vec<(String, usize)>,
    /// Covariates of the subjects (one value each), and the effects within subjects that each is multiplied by.
    pub covariates: Vec<(String, Vec<String>)>,
}

/// How one effect is tested, and over which error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum EffectMethod {
    /// F over the effect's own stratum: its interaction with the subjects. Of more than one degree of freedom corrected for a lack of
    /// sphericity, by Greenhouse and Geisser or, where their epsilon is above .75, Huynh and Feldt.
    Strata,
    /// The same with Greenhouse and Geisser's correction always: no rank test exists for the effect.
    StrataGreenhouseGeisser,
    /// F with the covariance of each group on its own: of two groups Welch's test of the subjects' means or differences.
    Unpooled,
    /// F of a regression of the subjects' means or contrasts on the groups and the covariates.
    Regression,
    /// Wilcoxon's signed ranks of each subject's contrast.
    SignedRanks,
    /// Friedman's test, by Iman and Davenport's F, of each subject's means over the other factors.
    Friedman,
    /// The same of each subject's differences between the two levels of the other factor.
    FriedmanOfDifferences,
    /// Mann and Whitney's test, of more than two groups Kruskal and Wallis', of the subjects' means.
    GroupRanks,
}

impl EffectMethod {
    /// Whether values count by their order alone.
    pub fn is_of_ranks(self) -> bool {
        matches!(
            self,
            Self::SignedRanks | Self::Friedman | Self::FriedmanOfDifferences | Self::GroupRanks
        )
    }

    /// The method in a cell of a table.
    pub fn title(self) -> &'static str {
        match self {
            Self::Strata => "F, own stratum",
            Self::StrataGreenhouseGeisser => "F, own stratum, Greenhouse-Geisser",
            Self::Unpooled => "F, groups not pooled",
            Self::Regression => "F, regression",
            Self::SignedRanks => "Wilcoxon, contrasts",
            Self::Friedman => "Friedman, means",
            Self::FriedmanOfDifferences => "Friedman, differences",
            Self::GroupRanks => "ranks of groups, means",
        }
    }

    /// The method in words that end a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::Strata => "F over the effect's own stratum, corrected for a lack of sphericity",
            Self::StrataGreenhouseGeisser => {
                "F over the effect's own stratum with Greenhouse and Geisser's correction, as no rank test exists for it"
            }
            Self::Unpooled => {
                "F with the covariance of each group on its own (of two groups Welch's test of the subjects' means or differences)"
            }
            Self::Regression => {
                "F of a regression of the subjects' contrasts on groups and covariates"
            }
            Self::SignedRanks => "Wilcoxon's signed ranks of each subject's contrast",
            Self::Friedman => {
                "Friedman's test (Iman and Davenport's F) of each subject's means over the other factors"
            }
            Self::FriedmanOfDifferences => {
                "Friedman's test (Iman and Davenport's F) of each subject's differences"
            }
            Self::GroupRanks => "Mann-Whitney or Kruskal-Wallis, of the subjects' means",
        }
    }
}

/// One effect, and what decides about it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlannedEffect {
    /// Its factors joined by `:`, those between subjects first; a covariate by its name, `age:mode` in a product.
    pub effect: String,
    /// Where residuals may be normal.
    pub normal: EffectMethod,
    /// Where they are far from it, or the order of the answers alone counts.
    pub far_from_normal: EffectMethod,
}

impl PlannedEffect {
    pub(super) fn method(&self, normal: bool) -> EffectMethod {
        if normal { self.normal } else { self.far_from_normal }
    }
}

/// The tests of all effects of a design of several factors, or of one within subjects with covariates of the subjects.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DesignPlan {
    /// Main effects first; covariates last.
    pub effects: Vec<PlannedEffect>,
}

/// Part of an effect: which factors of a kind it has.
type Mask = usize;

fn has(mask: Mask, factor: usize) -> bool {
    mask >> factor & 1 == 1
}

impl DesignPlan {
    /// Says for each effect which test it gets.
    ///
    /// | effect | residuals may be normal | far from normal |
    /// | --- | --- | --- |
    /// | within subjects, no groups | F over its stratum | one degree of freedom: signed ranks of the subjects' contrasts; one factor: Friedman of the means over the others; 2 × k: Friedman of the differences; larger: F over its stratum, Greenhouse-Geisser |
    /// | any, with groups | F with each group's covariance on its own | within alone as above; one factor between: Mann-Whitney or Kruskal-Wallis of the means; else as beside |
    /// | between subjects, with a covariate | regression of the means | the same |
    /// | within subjects, with a product of a covariate declared | regression of the contrasts | the same |
    ///
    /// The differences of groups are never compared by ranks: where the smaller group varies more, Mann and Whitney's test of them finds .08.
    ///
    /// # Example
    /// ```
    /// use maveric_stats::{DesignPlan, DesignShape, EffectMethod};
    /// let shape = DesignShape {
    ///     within: vec![("style".to_owned(), 2), ("traffic".to_owned(), 3)],
    ///     ..DesignShape::default()
    /// };
    /// let plan = DesignPlan::of(&shape);
    /// let ranks: Vec<EffectMethod> = plan.effects.iter().map(|effect| effect.far_from_normal).collect();
    /// assert_eq!(ranks, [EffectMethod::SignedRanks, EffectMethod::Friedman, EffectMethod::FriedmanOfDifferences]);
    /// ```
    pub fn of(shape: &DesignShape) -> Self {
        let mut effects: Vec<PlannedEffect> = shape
            .effects()
            .into_iter()
            .map(|(effect, between, within)| {
                let (normal, far_from_normal) = shape.methods(between, within);
                PlannedEffect { effect, normal, far_from_normal }
            })
            .collect();
        let regression = |effect: String| PlannedEffect {
            effect,
            normal: EffectMethod::Regression,
            far_from_normal: EffectMethod::Regression,
        };
        for (covariate, _) in &shape.covariates {
            effects.push(regression(covariate.clone()));
        }
        for within in 1..1 << shape.within.len() {
            for covariate in shape.multiplied(within) {
                let effect = format!("{covariate}:{}", shape.name_within(within));
                effects.push(regression(effect));
            }
        }
        Self { effects }
    }
}

impl DesignShape {
    /// Every effect of factors, main effects first: its name, its factors between and those within subjects.
    pub(super) fn effects(&self) -> Vec<(String, Mask, Mask)> {
        let factors: Vec<&(String, usize)> = self.between.iter().chain(&self.within).collect();
        let split = self.between.len();
        let one = |mask: Mask| {
            let names = factors.iter().enumerate().filter(|(f, _)| has(mask, *f));
            let names: Vec<&str> = names.map(|(_, (name, _))| name.as_str()).collect();
            (names.join(":"), mask & ((1 << split) - 1), mask >> split)
        };
        let sets = sets_of_factors(factors.len()).into_iter();
        sets.map(one).collect()
    }

    /// The factors of a part within subjects, joined by `:`.
    pub(super) fn name_within(&self, within: Mask) -> String {
        let names = self.within.iter().enumerate();
        let names = names.filter(|(f, _)| has(within, *f)).map(|(_, (name, _))| name.as_str());
        names.collect::<Vec<_>>().join(":")
    }

    /// The covariates that are multiplied by this part within subjects.
    pub(super) fn multiplied(&self, within: Mask) -> Vec<&str> {
        let name = self.name_within(within);
        let covariates = self.covariates.iter();
        covariates
            .filter(|(_, with)| with.contains(&name))
            .map(|(covariate, _)| covariate.as_str())
            .collect()
    }

    /// Whether a covariate is in the regression of a part within subjects: all are in that of the subjects' means.
    pub(super) fn has_covariate(&self, within: Mask, name: &str) -> bool {
        within == 0 || self.multiplied(within).contains(&name)
    }

    /// Degrees of freedom within subjects.
    fn freedom(&self, within: Mask) -> usize {
        let levels = self.within.iter().enumerate();
        levels.filter(|(f, _)| has(within, *f)).map(|(_, (_, k))| k - 1).product()
    }

    fn methods(&self, between: Mask, within: Mask) -> (EffectMethod, EffectMethod) {
        use EffectMethod as M;
        let regressed = if within == 0 {
            !self.covariates.is_empty()
        } else {
            !self.multiplied(within).is_empty()
        };
        if regressed {
            return (M::Regression, M::Regression);
        }
        let (grouped, freedom) = (!self.between.is_empty(), self.freedom(within));
        let normal = if grouped { M::Unpooled } else { M::Strata };
        let two = |f: usize| self.within[f].1 == 2;
        let inside: Vec<usize> = (0..self.within.len()).filter(|f| has(within, *f)).collect();
        let ranks = match (between, &inside[..]) {
            (0, _) if freedom == 1 => M::SignedRanks,
            (0, [_]) => M::Friedman,
            (0, [a, b]) if two(*a) || two(*b) => M::FriedmanOfDifferences,
            (0, _) if !grouped => M::StrataGreenhouseGeisser,
            (_, []) if self.between.len() == 1 => M::GroupRanks,
            _ => M::Unpooled,
        };
        (normal, ranks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(within: &[(&str, usize)], between: &[(&str, usize)]) -> DesignShape {
        let owned =
            |all: &[(&str, usize)]| all.iter().map(|(n, k)| ((*n).to_owned(), *k)).collect();
        DesignShape { within: owned(within), between: owned(between), covariates: Vec::new() }
    }

    fn methods(shape: &DesignShape) -> Vec<(String, EffectMethod, EffectMethod)> {
        let plan = DesignPlan::of(shape);
        let all = plan.effects.into_iter();
        all.map(|e| (e.effect, e.normal, e.far_from_normal)).collect()
    }

    #[test]
    fn two_factors_within_have_strata_or_ranks_of_contrasts() {
        use EffectMethod as M;
        let large = shape(&[("a", 3), ("t", 4)], &[]);
        assert_eq!(
            methods(&large),
            [
                ("a".to_owned(), M::Strata, M::Friedman),
                ("t".to_owned(), M::Strata, M::Friedman),
                ("a:t".to_owned(), M::Strata, M::StrataGreenhouseGeisser),
            ]
        );
        let small = shape(&[("a", 2), ("t", 2)], &[]);
        assert!(methods(&small).iter().all(|(_, _, far)| *far == M::SignedRanks));
    }

    #[test]
    fn groups_are_never_pooled() {
        use EffectMethod as M;
        let mixed = methods(&shape(&[("a", 3)], &[("g", 2)]));
        assert!(mixed.iter().all(|(_, normal, _)| *normal == M::Unpooled));
        let ranks: Vec<M> = mixed.into_iter().map(|(_, _, far)| far).collect();
        assert_eq!(ranks, [M::GroupRanks, M::Friedman, M::Unpooled]);
        let two = methods(&shape(&[("a", 2)], &[("g", 3)]));
        assert_eq!(two[2], ("g:a".to_owned(), M::Unpooled, M::Unpooled));
        let crossed = methods(&shape(&[("a", 2)], &[("g", 2), ("h", 2)]));
        let between = crossed.iter().find(|(name, ..)| name == "g:h").unwrap();
        assert_eq!(between.2, M::Unpooled);
    }

    #[test]
    fn a_covariate_of_people_enters_between_them_alone_unless_its_product_is_declared() {
        use EffectMethod as M;
        let mut shape = shape(&[("a", 2), ("t", 2)], &[("g", 2)]);
        shape.covariates = vec![("age".to_owned(), Vec::new())];
        let plain = methods(&shape);
        let of =
            |all: &[(String, M, M)], name: &str| all.iter().find(|(n, ..)| n == name).map(|e| e.1);
        assert_eq!(of(&plain, "g"), Some(M::Regression));
        assert_eq!(of(&plain, "age"), Some(M::Regression));
        assert_eq!(of(&plain, "a"), Some(M::Unpooled));
        assert_eq!(of(&plain, "age:a"), None);
        shape.covariates[0].1 = vec!["a".to_owned()];
        let declared = methods(&shape);
        for name in ["a", "g:a", "age:a"] {
            assert_eq!(of(&declared, name), Some(M::Regression), "{name}");
        }
        assert_eq!(of(&declared, "t"), Some(M::Unpooled));
    }
}

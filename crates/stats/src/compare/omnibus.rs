//! The omnibus test as it is reported, whichever was chosen.

use serde::{Deserialize, Serialize};

use crate::{
    Effect, EffectName, Friedman, Interval, PMethod, Posthoc, RmAnova, Sphericity,
    SphericityCorrection,
};

/// The omnibus test chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum OmnibusTest {
    /// Repeated-measures analysis of variance.
    RmAnova,
    /// Friedman's test.
    Friedman,
    /// Paired t test of two conditions.
    PairedT,
    /// Wilcoxon's signed-rank test of two conditions.
    Wilcoxon,
}

impl OmnibusTest {
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::RmAnova => "analysis of variance",
            Self::Friedman => "Friedman's test",
            Self::PairedT => "paired t test",
            Self::Wilcoxon => "Wilcoxon's signed ranks",
        }
    }
}

/// The omnibus test as it should be reported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Omnibus {
    /// Which test.
    pub test: OmnibusTest,
    /// Which correction, for the analysis of variance.
    pub correction: SphericityCorrection,
    /// F, χ² of Friedman, t, or the sum of the positive ranks.
    pub statistic: Option<f64>,
    /// Degrees of freedom, corrected; none of Wilcoxon.
    pub df1: Option<f64>,
    /// Degrees of freedom of the error, corrected; F only.
    pub df2: Option<f64>,
    /// The ε by which both were multiplied; F only.
    pub epsilon: Option<f64>,
    /// p with the correction; of Friedman the exact p where feasible, else that of Iman
    /// and Davenport's F; of Wilcoxon exact up to 1,000 differences.
    pub p: Option<f64>,
    /// How p was computed.
    pub p_method: OmnibusP,
    /// Whether p is below alpha.
    pub reject: Option<bool>,
    /// Partial eta squared, Kendall's W, dz, or the rank-biserial correlation.
    pub effect: Effect,
}

/// Where the omnibus p comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum OmnibusP {
    /// The F distribution.
    F,
    /// All orders of the ranks within subjects.
    Exact,
    /// Iman and Davenport's F of the ranks.
    ImanDavenport,
    /// χ², where all subjects agree and F is infinite.
    Chi2,
    /// Student's t.
    T,
    /// The normal approximation of Wilcoxon's test.
    Normal,
}

pub(super) fn of_anova(
    anova: &RmAnova,
    sphericity: &Sphericity,
    correction: SphericityCorrection,
) -> Omnibus {
    let (epsilon, p) = sphericity.corrected(correction, anova.p);
    Omnibus {
        test: OmnibusTest::RmAnova,
        correction,
        statistic: anova.f,
        df1: epsilon.map(|e| e * anova.df1 as f64),
        df2: epsilon.map(|e| e * anova.df2 as f64),
        epsilon,
        p,
        p_method: OmnibusP::F,
        reject: None,
        effect: Effect {
            name: EffectName::Eta2Partial,
            value: anova.eta2_partial,
            ci: anova.eta2_partial_ci90,
            confidence: 0.90,
        },
    }
}

impl Friedman {
    /// The p that is reported, and of what it is: exact where that is feasible, else of F; of χ² where F is infinite.
    pub fn reported_p(&self) -> (Option<f64>, OmnibusP) {
        match (self.p_exact, self.f_p) {
            (Some(p), _) => (Some(p), OmnibusP::Exact),
            (None, Some(p)) => (Some(p), OmnibusP::ImanDavenport),
            (None, None) => (self.p, OmnibusP::Chi2),
        }
    }
}

pub(super) fn of_friedman(friedman: &Friedman) -> Omnibus {
    let (p, p_method) = friedman.reported_p();
    Omnibus {
        test: OmnibusTest::Friedman,
        correction: SphericityCorrection::None,
        statistic: friedman.chi2,
        df1: friedman.df.map(|df| df as f64),
        df2: None,
        epsilon: None,
        p,
        p_method,
        reject: None,
        effect: Effect {
            name: EffectName::KendallW,
            value: friedman.kendall_w,
            ci: friedman.kendall_w_ci90,
            confidence: 0.90,
        },
    }
}

/// The test of the only pair.
pub(super) fn of_pair(test: OmnibusTest, posthoc: &Posthoc) -> Omnibus {
    let pair = posthoc.pairs.values().next();
    let effect = pair.map_or(
        Effect { name: EffectName::Dz, value: None, ci: Interval::default(), confidence: 0.95 },
        |pair| pair.effect.clone(),
    );
    let exact = pair.and_then(|pair| pair.p_method) == Some(PMethod::Exact);
    Omnibus {
        test,
        correction: SphericityCorrection::None,
        statistic: pair.and_then(|pair| pair.statistic),
        df1: pair.and_then(|pair| pair.df).map(|df| df as f64),
        df2: None,
        epsilon: None,
        p: pair.and_then(|pair| pair.p),
        p_method: match test {
            OmnibusTest::PairedT => OmnibusP::T,
            _ if exact => OmnibusP::Exact,
            _ => OmnibusP::Normal,
        },
        reject: None,
        effect,
    }
}

//! The tests by name, and the columns that each reads.

use super::{columns::WithinColumns, input::Long, rows::FactorColumns};
use crate::tables::Table;
use maveric_stats::{
    Adjustment, Bounds, CorrelationMethod, Formula, MissingCells, PosthocTest, Statistic,
};

/// What to bootstrap, and from which columns.
#[derive(Debug, Clone)]
pub enum Resampled {
    /// A statistic of one column.
    Column {
        /// Which.
        statistic: Statistic,
        /// The column.
        value: String,
    },
    /// A correlation of two columns.
    Pair {
        /// Which.
        statistic: Statistic,
        /// First column.
        x: String,
        /// Second column.
        y: String,
    },
    /// An effect size of a within-subject design; whole subjects are drawn.
    Design {
        /// Which.
        statistic: Statistic,
        /// Its columns.
        columns: WithinColumns,
    },
}

/// How a factorial design is tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactorialMethod {
    /// Analysis of variance, with means, contrasts and simple effects.
    Anova,
    /// Aligned ranks.
    Art,
}

/// A test and the columns that it reads.
#[derive(Debug, Clone)]
pub enum Test {
    /// The whole analysis of a within-subject design.
    Within(WithinColumns),
    /// Repeated-measures ANOVA.
    RmAnova(WithinColumns),
    /// Friedman's test.
    Friedman(WithinColumns),
    /// Every pair.
    Posthoc {
        /// Columns of the design.
        columns: WithinColumns,
        /// Test of a pair.
        test: PosthocTest,
        /// Adjustment over the pairs.
        adjust: Adjustment,
    },
    /// Correlation of two columns.
    Correlate {
        /// First column.
        x: String,
        /// Second column.
        y: String,
        /// Which coefficient.
        method: CorrelationMethod,
        /// Whose row it is, to warn of repeated rows.
        subject: Option<String>,
    },
    /// Correlation within subjects.
    Rmcorr {
        /// Whose row it is.
        subject: String,
        /// First column.
        x: String,
        /// Second column.
        y: String,
    },
    /// Shapiro-Wilk and moments.
    Normality {
        /// The column.
        value: String,
        /// Groups, tested apart.
        group: Option<String>,
    },
    /// Equal variances.
    Levene {
        /// The groups.
        group: String,
        /// The value.
        value: String,
    },
    /// Cronbach's alpha.
    Alpha {
        /// Columns of the items.
        items: Vec<String>,
        /// Whose sheet it is, where people answered several.
        subject: Option<String>,
    },
    /// Adjusted p values.
    Adjust {
        /// The column.
        p: String,
    },
    /// Resampling intervals.
    Bootstrap {
        /// What to estimate.
        resampled: Resampled,
        /// Resamples.
        resamples: usize,
        /// Root of the random choice.
        seed: u64,
    },
    /// Power, a question a row.
    Power,
    /// Do printed p values follow from printed coefficients?
    Recheck,
    /// The test that the design calls for: what was varied, within whom and between whom, and what was answered.
    Compare {
        /// Columns of the design.
        columns: FactorColumns,
        /// Whether the values are ordered answers.
        ordinal: bool,
        /// What becomes of a subject with a missing cell.
        missing: MissingCells,
    },
    /// Up to two factors within subjects and two between.
    Factorial {
        /// Columns of the design.
        columns: FactorColumns,
        /// How it is tested.
        method: FactorialMethod,
    },
    /// A linear model with a random intercept.
    Mixed {
        /// Whose row it is.
        subject: String,
        /// The fixed effects; a predictor whose values are all numbers is a covariate, any other a factor.
        fixed: Formula,
        /// The value.
        value: String,
    },
    /// A cumulative logit model of whole numbers of which the order counts, with a random intercept.
    Ordinal(WithinColumns),
    /// Independent groups.
    Groups {
        /// The groups.
        group: String,
        /// The value.
        value: String,
    },
    /// Whether conditions differ by less than bounds.
    Equivalence {
        /// Columns of the design.
        columns: WithinColumns,
        /// What counts as no difference.
        bounds: Bounds,
    },
    /// Whether the mean of one sample differs by less than bounds from a value.
    EquivalenceOne {
        /// The column.
        value: String,
        /// What its mean is compared with.
        mu: f64,
        /// What counts as no difference.
        bounds: Bounds,
    },
    /// Bayes factors of paired t tests.
    BayesPaired(WithinColumns),
    /// Bayes factor of a t test of one sample.
    BayesOne {
        /// The column.
        value: String,
        /// What its mean is compared with.
        mu: f64,
    },
    /// Bayes factors of t tests of independent groups.
    BayesGroups {
        /// The groups.
        group: String,
        /// The value.
        value: String,
    },
    /// Bayes factor of a correlation.
    BayesCorrelation {
        /// First column.
        x: String,
        /// Second column.
        y: String,
    },
}

impl Test {
    /// Its name on the command line.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Within(_) => "within",
            Self::RmAnova(_) => "rm-anova",
            Self::Friedman(_) => "friedman",
            Self::Posthoc { .. } => "posthoc",
            Self::Correlate { .. } => "correlate",
            Self::Rmcorr { .. } => "rmcorr",
            Self::Normality { .. } => "normality",
            Self::Levene { .. } => "levene",
            Self::Alpha { .. } => "alpha",
            Self::Adjust { .. } => "adjust",
            Self::Bootstrap { .. } => "bootstrap",
            Self::Power => "power",
            Self::Recheck => "recheck",
            Self::Compare { .. } => "compare",
            Self::Factorial { .. } => "factorial",
            Self::Mixed { .. } => "mixed",
            Self::Ordinal(_) => "ordinal",
            Self::Groups { .. } => "groups",
            Self::Equivalence { .. } | Self::EquivalenceOne { .. } => "equivalence",
            Self::BayesPaired(_)
            | Self::BayesOne { .. }
            | Self::BayesGroups { .. }
            | Self::BayesCorrelation { .. } => "bayes",
        }
    }

    /// The columns that a wide table becomes; `None` if the test compares no conditions.
    pub(super) fn long(&self) -> Option<Long<'_>> {
        match self {
            Self::Within(c)
            | Self::RmAnova(c)
            | Self::Friedman(c)
            | Self::Posthoc { columns: c, .. }
            | Self::Bootstrap {
                resampled: Resampled::Design { columns: c, .. },
                ..
            }
            | Self::Ordinal(c)
            | Self::BayesPaired(c)
            | Self::Equivalence { columns: c, .. } => Some(c.long()),
            Self::Levene { group, value }
            | Self::Normality {
                value,
                group: Some(group),
            }
            | Self::Groups { group, value }
            | Self::BayesGroups { group, value } => Some(Long {
                subject: None,
                within: group,
                value,
            }),
            Self::Compare { columns, .. } | Self::Factorial { columns, .. }
                if columns.within.len() == 1 =>
            {
                Some(Long {
                    subject: columns.subject.as_deref(),
                    within: &columns.within[0],
                    value: &columns.value,
                })
            }
            _ => None,
        }
    }

    /// The column of values, if there is one.
    fn value(&mut self) -> Option<&mut String> {
        match self {
            Self::Within(c)
            | Self::RmAnova(c)
            | Self::Friedman(c)
            | Self::Posthoc { columns: c, .. }
            | Self::Bootstrap {
                resampled: Resampled::Design { columns: c, .. },
                ..
            }
            | Self::Ordinal(c)
            | Self::BayesPaired(c)
            | Self::Equivalence { columns: c, .. } => Some(&mut c.value),
            Self::Compare { columns, .. } | Self::Factorial { columns, .. } => {
                Some(&mut columns.value)
            }
            Self::Bootstrap {
                resampled: Resampled::Column { value, .. },
                ..
            }
            | Self::Normality { value, .. }
            | Self::Levene { value, .. }
            | Self::Mixed { value, .. }
            | Self::Groups { value, .. }
            | Self::EquivalenceOne { value, .. }
            | Self::BayesOne { value, .. }
            | Self::BayesGroups { value, .. } => Some(value),
            _ => None,
        }
    }

    /// The test of each of several values; a column may have a comma in its name.
    pub(super) fn by_value(&self, table: &Table) -> Vec<(String, Self)> {
        let mut test = self.clone();
        let named = test.value().map(|value| value.clone()).unwrap_or_default();
        if table.has(&named) || !named.contains(',') {
            return vec![(named, test)];
        }
        let one = |name: &str| {
            let mut test = self.clone();
            if let Some(value) = test.value() {
                name.trim().clone_into(value);
            }
            (name.trim().to_owned(), test)
        };
        named.split(',').map(one).collect()
    }

    /// Whether there is something to draw: conditions, groups, contrasts, or two columns.
    pub(super) fn has_figure(&self) -> bool {
        !matches!(
            self,
            Self::Normality { .. }
                | Self::Levene { .. }
                | Self::Alpha { .. }
                | Self::Adjust { .. }
                | Self::Bootstrap { .. }
                | Self::Power
                | Self::Recheck
                | Self::BayesOne { .. }
        )
    }
}

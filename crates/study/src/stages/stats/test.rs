//! The tests by name, and the columns that each reads.

use super::{columns::WithinColumns, designs::DesignTest, input::Long};
use crate::tables::Table;
use maveric_stats::{Adjustment, CorrelationMethod, PosthocTest, Statistic};

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
    /// Any design, groups, factors, bounds and models.
    Design(DesignTest),
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
            Self::Design(design) => design.name(),
        }
    }

    /// The columns that a wide table becomes; `None` if the test compares no conditions.
    pub(super) fn long(&self) -> Option<Long<'_>> {
        match self {
            Self::Within(c) | Self::RmAnova(c) | Self::Friedman(c) => Some(c.long()),
            Self::Posthoc { columns, .. }
            | Self::Bootstrap {
                resampled: Resampled::Design { columns, .. },
                ..
            } => Some(columns.long()),
            Self::Levene { group, value }
            | Self::Normality {
                value,
                group: Some(group),
            } => Some(Long {
                subject: None,
                within: group,
                value,
            }),
            Self::Design(design) => design.long(),
            _ => None,
        }
    }

    /// The column of values, if there is one.
    fn value(&mut self) -> Option<&mut String> {
        match self {
            Self::Within(c) | Self::RmAnova(c) | Self::Friedman(c) => Some(&mut c.value),
            Self::Posthoc { columns, .. }
            | Self::Bootstrap {
                resampled: Resampled::Design { columns, .. },
                ..
            } => Some(&mut columns.value),
            Self::Bootstrap {
                resampled: Resampled::Column { value, .. },
                ..
            }
            | Self::Normality { value, .. }
            | Self::Levene { value, .. } => Some(value),
            Self::Design(design) => design.value(),
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
        match self {
            Self::Design(design) => design.has_figure(),
            Self::Normality { .. }
            | Self::Levene { .. }
            | Self::Alpha { .. }
            | Self::Adjust { .. }
            | Self::Bootstrap { .. }
            | Self::Power
            | Self::Recheck => false,
            _ => true,
        }
    }
}

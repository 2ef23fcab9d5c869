//! What can be chosen by name.

use clap::ValueEnum;
use maveric_study::stages::stats::{
    Adjustment, CorrelationMethod, FactorialMethod, MissingCells, PosthocTest, Statistic,
};

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum PosthocArg {
    T,
    PooledT,
    Wilcoxon,
    Conover,
    Nemenyi,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum AdjustArg {
    Holm,
    Bonferroni,
    Hochberg,
    Bh,
    None,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum CorrelationArg {
    Pearson,
    Spearman,
    Kendall,
    Auto,
    All,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(super) enum StatisticArg {
    Mean,
    Median,
    Pearson,
    Spearman,
    Eta2Partial,
    Eta2Generalized,
    Omega2Partial,
    KendallW,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum FactorialArg {
    Anova,
    Art,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum MissingArg {
    /// Left out whole, and named
    Listwise,
    /// Kept, with the cells that are there, in a mixed model
    Mixed,
}

impl From<PosthocArg> for PosthocTest {
    fn from(arg: PosthocArg) -> Self {
        match arg {
            PosthocArg::T => Self::T,
            PosthocArg::PooledT => Self::PooledT,
            PosthocArg::Wilcoxon => Self::Wilcoxon,
            PosthocArg::Conover => Self::Conover,
            PosthocArg::Nemenyi => Self::Nemenyi,
        }
    }
}

impl From<AdjustArg> for Adjustment {
    fn from(arg: AdjustArg) -> Self {
        match arg {
            AdjustArg::Holm => Self::Holm,
            AdjustArg::Bonferroni => Self::Bonferroni,
            AdjustArg::Hochberg => Self::Hochberg,
            AdjustArg::Bh => Self::Bh,
            AdjustArg::None => Self::None,
        }
    }
}

impl From<CorrelationArg> for CorrelationMethod {
    fn from(arg: CorrelationArg) -> Self {
        match arg {
            CorrelationArg::Pearson => Self::Pearson,
            CorrelationArg::Spearman => Self::Spearman,
            CorrelationArg::Kendall => Self::Kendall,
            CorrelationArg::Auto => Self::Auto,
            CorrelationArg::All => Self::All,
        }
    }
}

impl From<StatisticArg> for Statistic {
    fn from(arg: StatisticArg) -> Self {
        match arg {
            StatisticArg::Mean => Self::Mean,
            StatisticArg::Median => Self::Median,
            StatisticArg::Pearson => Self::Pearson,
            StatisticArg::Spearman => Self::Spearman,
            StatisticArg::Eta2Partial => Self::Eta2Partial,
            StatisticArg::Eta2Generalized => Self::Eta2Generalized,
            StatisticArg::Omega2Partial => Self::Omega2Partial,
            StatisticArg::KendallW => Self::KendallW,
        }
    }
}

impl From<FactorialArg> for FactorialMethod {
    fn from(arg: FactorialArg) -> Self {
        match arg {
            FactorialArg::Anova => Self::Anova,
            FactorialArg::Art => Self::Art,
        }
    }
}

impl From<MissingArg> for MissingCells {
    fn from(arg: MissingArg) -> Self {
        match arg {
            MissingArg::Listwise => Self::Listwise,
            MissingArg::Mixed => Self::Mixed,
        }
    }
}

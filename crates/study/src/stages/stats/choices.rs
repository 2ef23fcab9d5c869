//! What can be chosen by name.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use maveric_stats::{Adjustment, CorrelationMethod, MissingCells, PosthocTest, Statistic};

/// How a factorial design is tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FactorialMethod {
    /// Analysis of variance, with means, contrasts and simple effects.
    Anova,
    Art,
}

/// A word, what `--help` says of it, and what it stands for.
type Choice<T> = (&'static str, Option<&'static str>, T);

pub(super) const POSTHOC: [Choice<PosthocTest>; 5] = [
    ("t", None, PosthocTest::T),
    ("pooled-t", None, PosthocTest::PooledT),
    ("wilcoxon", None, PosthocTest::Wilcoxon),
    ("conover", None, PosthocTest::Conover),
    ("nemenyi", None, PosthocTest::Nemenyi),
];

pub(super) const ADJUST: [Choice<Adjustment>; 5] = [
    ("holm", None, Adjustment::Holm),
    ("bonferroni", None, Adjustment::Bonferroni),
    ("hochberg", None, Adjustment::Hochberg),
    ("bh", None, Adjustment::Bh),
    ("none", None, Adjustment::None),
];

pub(super) const CORRELATION: [Choice<CorrelationMethod>; 5] = [
    ("pearson", None, CorrelationMethod::Pearson),
    ("spearman", None, CorrelationMethod::Spearman),
    ("kendall", None, CorrelationMethod::Kendall),
    ("auto", None, CorrelationMethod::Auto),
    ("all", None, CorrelationMethod::All),
];

pub(super) const STATISTIC: [Choice<Statistic>; 8] = [
    ("mean", None, Statistic::Mean),
    ("median", None, Statistic::Median),
    ("pearson", None, Statistic::Pearson),
    ("spearman", None, Statistic::Spearman),
    ("eta2_partial", None, Statistic::Eta2Partial),
    ("eta2_generalized", None, Statistic::Eta2Generalized),
    ("omega2_partial", None, Statistic::Omega2Partial),
    ("kendall_w", None, Statistic::KendallW),
];

pub(super) const FACTORIAL: [Choice<FactorialMethod>; 2] =
    [("anova", None, FactorialMethod::Anova), ("art", None, FactorialMethod::Art)];

pub(super) const MISSING: [Choice<MissingCells>; 2] = [
    ("listwise", Some("Left out whole, and named"), MissingCells::Listwise),
    ("mixed", Some("Kept, with the cells that are there, in a mixed model"), MissingCells::Mixed),
];

/// Reads one of these words.
pub(super) fn one_of<T: Copy + Send + Sync + 'static>(
    choices: &'static [Choice<T>],
) -> impl TypedValueParser<Value = T> {
    let words = choices.iter().map(|(word, help, _)| {
        let value = PossibleValue::new(*word);
        help.map_or(value.clone(), |help| value.help(help))
    });
    PossibleValuesParser::new(words).try_map(|word| {
        let chosen = choices.iter().find(|(known, ..)| *known == word);
        chosen.map(|(.., value)| *value).ok_or("none of the words")
    })
}

#![doc = include_str!("../README.md")]
#![warn(missing_docs)]
#![expect(
    clippy::cast_possible_wrap,
    reason = "counts of subjects, conditions and ranks are far below 2^63"
)]

mod adjust;
mod analysis;
pub mod apa;
mod bayes;
mod bootstrap;
mod by_design;
mod case_crossover;
mod cochran_q;
mod compare;
mod complete;
mod correlation;
mod describe;
mod equivalence;
mod error;
mod event_rates;
mod factorial;
mod forced_choice;
mod friedman;
mod groups;
mod hierarchical;
pub mod interval;
pub mod markup;
mod mcnemar;
mod mixed;
mod named;
mod normality;
mod numerics;
mod ordinal;
mod paired;
mod posthoc;
mod power;
mod proportion;
mod ranks;
mod reasons;
mod recheck;
mod regression;
mod reliability;
mod rm_anova;
mod roles;
mod sphericity;
mod spread;
mod variances;
mod within_subjects;

pub use adjust::{Adjusted, Adjustment, adjust};
pub use analysis::{
    ConditionSummary, FriedmanAnalysis, RmAnovaAnalysis, WithinAnalysis, friedman, rm_anova,
    within, within_without_exact,
};
pub use bayes::{
    BayesCorrelation, BayesCorrelationAnalysis, BayesT, BayesTAnalysis, Prior, bayes_correlation,
    bayes_groups, bayes_one, bayes_paired,
};
pub use bootstrap::{Bootstrap, BootstrapData, BootstrapSettings, Statistic, bootstrap};
pub use by_design::{
    AskedTest, ByDesign, CarriedOver, CarryOver, CellMean, Chosen, ChosenTest, CorrectedTerm,
    DesignChoice, DesignColumns, DesignPlan, DesignShape, DesignTable, EffectMethod, EffectTest,
    FactorialFinding, FollowUp, LevelChoice, LevelContrast, LevelPair, MissingCells, MixedFinding,
    NoCarryOver, OrdinalFinding, OutcomeScale, PERIOD, PlannedEffect, RankCheck, SimplePairs,
    SimpleTest, SmallSample, carry_over, compare_by_design, follow_up, level_contrast,
    simple_effects,
};
pub use case_crossover::{CaseCrossover, CaseStratum, case_crossover};
pub use cochran_q::{CochranQ, CochranQTest, McNemarPair, cochran_q};
pub use compare::{
    AssumptionCheck, Comparison, Omnibus, OmnibusP, OmnibusTest, compare, compare_without_exact,
};
pub use correlation::{
    Correlation, CorrelationMethod, Kendall, Pearson, RmCorrelation, RmCorrelationAnalysis,
    Spearman, SpearmanCompat, correlate, least_correlation, rm_correlation, simultaneous_interval,
};
pub use describe::{
    mean, mean_interval, mean_of_groups_interval, quantile, standard_deviation,
    within_subject_intervals,
};
pub use equivalence::{
    Bounds, Equivalence, EstimateTost, Tost, equivalence, equivalence_one, tost_of_estimate,
};
pub use error::StatsError;
pub use event_rates::{EventRates, Exposed, event_rates};
pub use factorial::{
    AlignedRanks, ArtEffect, ArtStrata, BetweenColumn, CellContrast, ExactTest, Factor, Factorial,
    FactorialDesign, FactorialEffect, MarginalMean, SimpleEffect, WithinColumn, aligned_ranks,
    factorial,
};
pub use forced_choice::{ForcedChoice, forced_choice};
pub use friedman::Friedman;
pub use groups::{
    Dunn, GamesHowell, GroupSummary, GroupsAnalysis, Hedges, Kruskal, MannWhitney, MeanDifference,
    OneWayAnova, SeveralGroups, WelchAnova, groups,
};
pub use hierarchical::{Belief, Hierarchical, PersonRows, hierarchical};
pub use interval::Interval;
pub use mcnemar::{McNemar, McNemarTest, mcnemar};
pub use mixed::{
    Bend, Congruence, CongruenceData, FixedEffect, Formula, InterceptVariance, MarginalContrast,
    MixedMethod, MixedModel, Predictor, RandomIntercept, RatioTest, Region, TermTest, congruence,
    mixed_model, random_by_factor, random_intercept,
};
pub use named::Named;
pub use normality::{Normality, SampleShape, ShapiroWilk, normality};
pub use numerics::decimal::tied_differences;
pub use ordinal::{
    LikelihoodRatio, Ordinal, OrdinalFit, OrdinalParameter, OrdinalVariance, ordinal,
};
pub use paired::{
    conover::Conover, nemenyi::Nemenyi, pooled::PooledT, t::PairedT, wilcoxon::PMethod,
    wilcoxon::Wilcoxon, wilcoxon::WilcoxonCompat,
};
pub use posthoc::{Effect, EffectName, Posthoc, PosthocPair, PosthocTest, posthoc};
pub use power::{PlannedTest, PowerAnalysis, PowerAnswer, PowerQuestion, power};
pub use proportion::{Proportion, proportion, proportion_exact};
pub use reasons::Reasons;
pub use recheck::{Recheck, RecheckAnalysis, ReportedCorrelation, recheck};
pub use regression::{CircularLinear, LinearFit, circular_fit, circular_linear, linear_fit};
pub use reliability::{Alpha, AlphaAnalysis, Icc, ItemDropped, ItemStatistics, alpha, icc};
pub use rm_anova::{RmAnova, RmAnovaCompat};
pub use roles::{Changes, check_groups, check_within};
pub use sphericity::{Mauchly, MauchlyCompat, Sphericity, SphericityCorrection};
pub use spread::{HALF_95, sd_interval};
pub use variances::{Bartlett, Levene, VarianceTests, levene};
pub use within_subjects::WithinSubjects;

//! `maveric stats`.

mod designs;

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use clap::{Args, Subcommand, ValueEnum};
use maveric_study::stages::{
    analyse::{self, AnalyseOptions},
    stats::{
        self, Adjustment, CorrelationMethod, PosthocTest, Resampled, Statistic, Test, WithinColumns,
    },
};
use std::path::PathBuf;

/// One test on a tidy table (CSV, Parquet or - for standard input), or the paper's whole analysis
#[derive(Debug, Args)]
#[command(after_help = "\
Examples: maveric stats compare data.csv --subject id --within condition --value score
          maveric stats correlate data.csv --x age --y speed --method auto --format json
          maveric stats study study_data/generated/paper --out analysis.json")]
pub(crate) struct Stats {
    #[command(subcommand)]
    test: TestArgs,
}

#[derive(Debug, Args)]
struct Input {
    /// Table to read: CSV, TSV, Parquet, or - for CSV on standard input
    data: PathBuf,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

#[derive(Debug, Args)]
#[expect(
    clippy::struct_field_names,
    reason = "the fields are named as their flags"
)]
struct Within {
    #[command(flatten)]
    input: Input,
    /// Column that says whose row it is
    #[arg(long)]
    subject: String,
    /// Column that says in which condition
    #[arg(long)]
    within: String,
    /// Column with the value
    #[arg(long)]
    value: String,
}

impl Within {
    fn split(self) -> (Input, WithinColumns) {
        let columns = WithinColumns {
            subject: self.subject,
            within: self.within,
            value: self.value,
        };
        (self.input, columns)
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum PosthocArg {
    T,
    PooledT,
    Wilcoxon,
    Conover,
    Nemenyi,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum AdjustArg {
    Holm,
    Bonferroni,
    Hochberg,
    Bh,
    None,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum MethodArg {
    Pearson,
    Spearman,
    Kendall,
    Auto,
    All,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
#[value(rename_all = "snake_case")]
enum StatisticArg {
    Mean,
    Median,
    Pearson,
    Spearman,
    Eta2Partial,
    Eta2Generalized,
    Omega2Partial,
    KendallW,
}

#[derive(Debug, Subcommand)]
enum TestArgs {
    /// The whole analysis of a within-subject design
    Within(Within),
    /// Repeated-measures ANOVA with Mauchly's test and corrected degrees of freedom
    RmAnova(Within),
    /// Friedman's test: chi-squared, Iman-Davenport F, exact
    Friedman(Within),
    /// Every pair of conditions, adjusted
    Posthoc {
        #[command(flatten)]
        within: Within,
        /// Test of a pair
        #[arg(long, value_enum, default_value = "t")]
        test: PosthocArg,
        /// Adjustment for the number of pairs
        #[arg(long, value_enum, default_value = "holm")]
        adjust: AdjustArg,
    },
    /// Check the assumptions, choose the test, then compare the pairs; say why
    Compare(Within),
    /// Correlation of two columns
    Correlate {
        #[command(flatten)]
        input: Input,
        /// First column
        #[arg(long)]
        x: String,
        /// Second column
        #[arg(long)]
        y: String,
        /// Which coefficient
        #[arg(long, value_enum, default_value = "auto")]
        method: MethodArg,
        /// Column that says whose row it is: warns where one subject has several rows
        #[arg(long)]
        subject: Option<String>,
    },
    /// Repeated-measures correlation: several rows a subject
    Rmcorr {
        #[command(flatten)]
        input: Input,
        /// Column that says whose row it is
        #[arg(long)]
        subject: String,
        /// First column
        #[arg(long)]
        x: String,
        /// Second column
        #[arg(long)]
        y: String,
    },
    /// Shapiro-Wilk and the moments of a column
    Normality {
        #[command(flatten)]
        input: Input,
        /// Column with the value
        #[arg(long)]
        value: String,
        /// Column that groups the rows
        #[arg(long)]
        group: Option<String>,
    },
    /// Equal variances: Levene, Brown-Forsythe, Bartlett
    Levene {
        #[command(flatten)]
        input: Input,
        /// Column that groups the rows
        #[arg(long)]
        group: String,
        /// Column with the value
        #[arg(long)]
        value: String,
    },
    /// Cronbach's alpha of a scale
    Alpha {
        #[command(flatten)]
        input: Input,
        /// Columns of the items
        #[arg(long, value_delimiter = ',', required = true)]
        items: Vec<String>,
        /// Column that says whose sheet it is, where people answered several: the interval then draws whole people
        #[arg(long)]
        subject: Option<String>,
    },
    /// Adjust p values for their number
    Adjust {
        #[command(flatten)]
        input: Input,
        /// Column of p values
        #[arg(long)]
        p: String,
    },
    /// Percentile and BCa intervals by resampling
    Bootstrap {
        #[command(flatten)]
        input: Input,
        /// What to estimate
        #[arg(long, value_enum)]
        statistic: StatisticArg,
        /// Column with the value
        #[arg(long)]
        value: Option<String>,
        /// First column of a correlation
        #[arg(long)]
        x: Option<String>,
        /// Second column of a correlation
        #[arg(long)]
        y: Option<String>,
        /// Column that says whose row it is: whole subjects are drawn
        #[arg(long)]
        subject: Option<String>,
        /// Column that says in which condition
        #[arg(long)]
        within: Option<String>,
        /// Resamples
        #[arg(long, default_value_t = 10_000)]
        resamples: usize,
        /// Root of the random choice
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Power of a design, and the sample for 80 %: a question a row
    Power {
        #[command(flatten)]
        input: Input,
    },
    /// Does each printed p follow from its printed coefficient and degrees of freedom?
    Recheck {
        #[command(flatten)]
        input: Input,
    },
    #[command(flatten)]
    Design(designs::DesignArgs),
    /// Every analysis that a study's design asks for, over the results of a run
    #[command(visible_alias = "paper")]
    Study {
        /// Folder of results, as the pipeline leaves it
        results: PathBuf,
        /// Design of the study (TOML); study.toml of the folder one stands in when not given, else the paper's
        #[arg(long, value_name = "FILE")]
        design: Option<PathBuf>,
        /// Who took part; participants.csv among the results when not given, else the design's table
        #[arg(long)]
        participants: Option<PathBuf>,
        /// Analysis to write (JSON)
        #[arg(long)]
        out: PathBuf,
        /// How to print the result
        #[arg(long, value_enum, default_value_t)]
        format: Format,
    },
}

impl Stats {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let (input, test) = match self.test {
            TestArgs::Study {
                results,
                design,
                participants,
                out,
                format,
            } => {
                let options = AnalyseOptions {
                    design,
                    results,
                    participants,
                    out,
                };
                return print_outcome(format, "could not analyse the study", |watch| {
                    analyse::analyse(&options, watch)
                });
            }
            TestArgs::Within(w) => with(w, Test::Within),
            TestArgs::RmAnova(w) => with(w, Test::RmAnova),
            TestArgs::Friedman(w) => with(w, Test::Friedman),
            TestArgs::Compare(w) => with(w, Test::Compare),
            TestArgs::Posthoc {
                within,
                test,
                adjust,
            } => {
                let (input, columns) = within.split();
                (
                    input,
                    Test::Posthoc {
                        columns,
                        test: posthoc_test(test),
                        adjust: adjustment(adjust),
                    },
                )
            }
            TestArgs::Correlate {
                input,
                x,
                y,
                method,
                subject,
            } => (
                input,
                Test::Correlate {
                    x,
                    y,
                    method: correlation_method(method),
                    subject,
                },
            ),
            TestArgs::Rmcorr {
                input,
                subject,
                x,
                y,
            } => (input, Test::Rmcorr { subject, x, y }),
            TestArgs::Normality {
                input,
                value,
                group,
            } => (input, Test::Normality { value, group }),
            TestArgs::Levene {
                input,
                group,
                value,
            } => (input, Test::Levene { group, value }),
            TestArgs::Alpha {
                input,
                items,
                subject,
            } => (input, Test::Alpha { items, subject }),
            TestArgs::Adjust { input, p } => (input, Test::Adjust { p }),
            TestArgs::Bootstrap {
                input,
                statistic,
                value,
                x,
                y,
                subject,
                within,
                resamples,
                seed,
            } => {
                let resampled = resampled(statistic, value, (x, y), (subject, within))?;
                (
                    input,
                    Test::Bootstrap {
                        resampled,
                        resamples,
                        seed,
                    },
                )
            }
            TestArgs::Power { input } => (input, Test::Power),
            TestArgs::Recheck { input } => (input, Test::Recheck),
            TestArgs::Design(design) => design.split()?,
        };
        print_outcome(input.format, "could not run the test", |_| {
            stats::stats(&input.data, &test)
        })
    }
}

fn with(within: Within, test: impl FnOnce(WithinColumns) -> Test) -> (Input, Test) {
    let (input, columns) = within.split();
    (input, test(columns))
}

fn posthoc_test(arg: PosthocArg) -> PosthocTest {
    match arg {
        PosthocArg::T => PosthocTest::T,
        PosthocArg::PooledT => PosthocTest::PooledT,
        PosthocArg::Wilcoxon => PosthocTest::Wilcoxon,
        PosthocArg::Conover => PosthocTest::Conover,
        PosthocArg::Nemenyi => PosthocTest::Nemenyi,
    }
}

fn adjustment(arg: AdjustArg) -> Adjustment {
    match arg {
        AdjustArg::Holm => Adjustment::Holm,
        AdjustArg::Bonferroni => Adjustment::Bonferroni,
        AdjustArg::Hochberg => Adjustment::Hochberg,
        AdjustArg::Bh => Adjustment::Bh,
        AdjustArg::None => Adjustment::None,
    }
}

fn correlation_method(arg: MethodArg) -> CorrelationMethod {
    match arg {
        MethodArg::Pearson => CorrelationMethod::Pearson,
        MethodArg::Spearman => CorrelationMethod::Spearman,
        MethodArg::Kendall => CorrelationMethod::Kendall,
        MethodArg::Auto => CorrelationMethod::Auto,
        MethodArg::All => CorrelationMethod::All,
    }
}

type Pair = (Option<String>, Option<String>);

fn resampled(
    arg: StatisticArg,
    value: Option<String>,
    (x, y): Pair,
    (subject, within): Pair,
) -> Result<Resampled, Failure> {
    let needs = |flags: &str| Failure::Usage(format!("this statistic needs {flags}"));
    let statistic = match arg {
        StatisticArg::Mean => Statistic::Mean,
        StatisticArg::Median => Statistic::Median,
        StatisticArg::Pearson => Statistic::Pearson,
        StatisticArg::Spearman => Statistic::Spearman,
        StatisticArg::Eta2Partial => Statistic::Eta2Partial,
        StatisticArg::Eta2Generalized => Statistic::Eta2Generalized,
        StatisticArg::Omega2Partial => Statistic::Omega2Partial,
        StatisticArg::KendallW => Statistic::KendallW,
    };
    match arg {
        StatisticArg::Mean | StatisticArg::Median => Ok(Resampled::Column {
            statistic,
            value: value.ok_or_else(|| needs("--value"))?,
        }),
        StatisticArg::Pearson | StatisticArg::Spearman => {
            let (Some(x), Some(y)) = (x, y) else {
                return Err(needs("--x and --y"));
            };
            Ok(Resampled::Pair { statistic, x, y })
        }
        _ => {
            let (Some(subject), Some(within), Some(value)) = (subject, within, value) else {
                return Err(needs("--subject, --within and --value"));
            };
            let columns = WithinColumns {
                subject,
                within,
                value,
            };
            Ok(Resampled::Design { statistic, columns })
        }
    }
}

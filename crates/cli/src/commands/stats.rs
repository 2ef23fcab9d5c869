//! `maveric stats`.

mod designs;

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use clap::{Args, Subcommand, ValueEnum, builder::ArgPredicate};
use maveric_study::stages::{
    analyse::{self, AnalyseOptions, Family},
    stats::{
        self, Adjustment, CorrelationMethod, PosthocTest, Request, Resampled, Show, Statistic,
        Test, WithinColumns,
    },
};
use std::path::PathBuf;

/// One test on a tidy table (CSV, Parquet or - for standard input), or the paper's whole analysis
#[derive(Debug, Args)]
#[command(after_help = "\
Each call's own --help says which columns its table needs. Every call also takes rows by --where and a column a condition by --wide,
and gives the sentence alone by --apa, tables by --latex or --markdown, and a figure by --figure.
Examples: maveric stats compare data.csv --subject id --within condition --value score
          maveric stats compare data.csv --wide slow,fast,other --where session=2 --figure scores.svg
          maveric stats correlate data.csv --x age --y speed --method auto --format json
          maveric stats paper study_data/generated/paper --out analysis.json")]
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
    /// Keep the rows that have this value in this column; several: all of them
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = column_and_value, help_heading = "The table")]
    keep: Vec<(String, String)>,
    /// Columns that are conditions, in the place of --within and --value (which then name what they become); without --subject a row is a subject
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        help_heading = "The table"
    )]
    wide: Vec<String>,
    /// Print the sentences alone, as APA has them
    #[arg(long, group = "shown", help_heading = "The result")]
    apa: bool,
    /// Print the tables in LaTeX (booktabs)
    #[arg(long, group = "shown", help_heading = "The result")]
    latex: bool,
    /// Print the tables in Markdown
    #[arg(long, group = "shown", help_heading = "The result")]
    markdown: bool,
    /// Draw the result into this file
    #[arg(long, value_name = "OUT.svg|png", help_heading = "The result")]
    figure: Option<PathBuf>,
}

impl Input {
    fn request(self, test: Test) -> Request {
        let show = match (self.apa, self.latex, self.markdown) {
            (true, _, _) => Show::Apa,
            (_, true, _) => Show::Latex,
            (_, _, true) => Show::Markdown,
            _ => Show::Report,
        };
        Request {
            data: self.data,
            input: stats::Input {
                keep: self.keep,
                wide: self.wide,
            },
            test,
            show,
            figure: self.figure,
        }
    }
}

fn column_and_value(text: &str) -> Result<(String, String), String> {
    let parts = text
        .split_once('=')
        .filter(|(column, _)| !column.is_empty());
    parts
        .map(|(column, value)| (column.to_owned(), value.to_owned()))
        .ok_or_else(|| "expected COLUMN=VALUE, as in session=2".to_owned())
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
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, stats::ROW)
    )]
    subject: String,
    /// Column that says in which condition
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, "condition")
    )]
    within: String,
    /// Column with the value; several, as in score,speed, are analysed one by one
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, "value")
    )]
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
    #[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats within data.csv --subject id --within condition --value score")]
    Within(Within),
    /// Repeated-measures ANOVA with Mauchly's test and corrected degrees of freedom
    #[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats rm-anova data.csv --subject id --within condition --value score --latex")]
    RmAnova(Within),
    /// Friedman's test: chi-squared, Iman-Davenport F, exact
    #[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats friedman data.csv --subject id --within condition --value score")]
    Friedman(Within),
    /// Every pair of conditions, adjusted
    #[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats posthoc data.csv --subject id --within condition --value score --test wilcoxon --adjust holm")]
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
    #[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Examples: maveric stats compare data.csv --subject id --within condition --value score --figure score.svg
          maveric stats compare data.csv --subject id --within condition --value score,speed --apa")]
    Compare(Within),
    /// Correlation of two columns
    #[command(after_help = "\
The table: a row a person (or a measurement), with two columns of numbers.
Example: maveric stats correlate data.csv --x age --y speed --method auto --figure speed.svg")]
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
    #[command(after_help = "\
The table: several rows a person, with the column of subjects and two of numbers.
Example: maveric stats rmcorr data.csv --subject id --x age --y speed")]
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
    #[command(after_help = "\
The table: a row a value, with a column of numbers, and of groups if there are any.
Example: maveric stats normality data.csv --value score --group condition")]
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
    #[command(after_help = "\
The table: a row a person, with the columns of group and value.
Example: maveric stats levene data.csv --group group --value score")]
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
    #[command(after_help = "\
The table: a row an answer sheet, with a column an item, reversed items turned already; and a column of people where they filled in several.
Examples: maveric stats alpha data.csv --items q1,q2,q3
          maveric stats alpha data.csv --items q1,q2,q3 --subject id")]
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
    #[command(after_help = "\
The table: a row a test, with a column of p values.
Example: maveric stats adjust data.csv --p p")]
    Adjust {
        #[command(flatten)]
        input: Input,
        /// Column of p values
        #[arg(long)]
        p: String,
    },
    /// Percentile and BCa intervals by resampling
    #[command(after_help = "\
The table: a column of values; two of a correlation; or, as for `within`, a row a cell.
Examples: maveric stats bootstrap data.csv --statistic median --value score --resamples 2000 --seed 3
          maveric stats bootstrap data.csv --statistic eta2_partial --subject id --within condition --value score")]
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
    #[command(after_help = "\
The table: a question a row. test: paired_t, pearson or rm_anova; n: people; effect: dz, r or partial eta squared; alpha;
of rm_anova also k (conditions), corr (between them) and epsilon. Other columns are not read.
Example: maveric stats power questions.csv")]
    Power {
        #[command(flatten)]
        input: Input,
    },
    /// Does each printed p follow from its printed coefficient and degrees of freedom?
    #[command(after_help = "\
The table: a printed correlation a row, as text. coefficient: .46 or -.71; df; p: =.012, <.001 or .012. Other columns are not read.
Example: maveric stats recheck printed.csv")]
    Recheck {
        #[command(flatten)]
        input: Input,
    },
    #[command(flatten)]
    Design(designs::DesignArgs),
    /// Every analysis of the paper over the results of a run
    #[command(alias = "study")]
    Paper {
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
        /// Scales and factors of the homophily tests, one family: mini_ipip,mdsi.high_velocity
        #[arg(long, default_value_t)]
        family: Family,
        /// How to print the result
        #[arg(long, value_enum, default_value_t)]
        format: Format,
    },
}

impl Stats {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let (input, test) = match self.test {
            TestArgs::Paper {
                results,
                design,
                participants,
                out,
                family,
                format,
            } => {
                let options = AnalyseOptions {
                    design,
                    results,
                    participants,
                    out,
                    family,
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
        let (format, request) = (input.format, input.request(test));
        print_outcome(format, "could not run the test", |_| stats::stats(&request))
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

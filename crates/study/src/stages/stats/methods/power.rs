//! Power, a question a row.

use super::{Ran, StudyError, Table, Test, count, labels, plain};
use maveric_stats::{PlannedTest, PowerQuestion, StatsError, power};

/// Power of a design, and the sample for 80 %: a question a row
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a question a row. test: paired_t, pearson or rm_anova; n: people; effect; alpha; of rm_anova also k (conditions), corr (between
them) and epsilon. Other columns are not read.
effect is dz of paired_t, r of pearson, and of rm_anova eta squared between people: the variance of the means is f² = effect / (1 - effect)
times that of people in one condition. That is not the partial eta squared which rm-anova and papers print: write that into a column
eta2_partial, and leave effect and corr of the row empty.
Example: maveric stats power questions.csv")]
pub struct Power {}

impl Test for Power {
    const NAME: &'static str = "power";
    const HAS_FIGURE: bool = false;
    const HAS_SENTENCE: bool = false;

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let questions = power_questions(table)?;
        let answers = power(&questions).map_err(|e| by_row(table, &questions, e))?;
        Ok(Ran::numbers(plain(&answers)))
    }
}

/// What is refused, by the row and the column of the first question that is.
fn by_row(table: &Table, questions: &[PowerQuestion], error: StatsError) -> StudyError {
    let mut rows = questions.iter().enumerate();
    let refused = rows.find_map(|(row, question)| {
        let error = power(std::slice::from_ref(question)).err()?;
        Some((row, error))
    });
    match refused {
        Some((row, StatsError::TooFewConditions { found })) => {
            table.bad_cell(row, "k", found.to_string(), "at least 2 conditions")
        }
        Some((row, StatsError::BadParameter { name, expected, found })) => {
            table.bad_cell(row, &name, found.to_string(), expected)
        }
        _ => error.into(),
    }
}

/// One question a row: `test`, `n`, `effect`, `alpha`, and for an ANOVA `k`, `epsilon` and either `effect` and `corr` or `eta2_partial`.
fn power_questions(table: &Table) -> Result<Vec<PowerQuestion>, StudyError> {
    let test = labels(table, "test")?;
    let n = table.all_numbers("n")?;
    let alpha = table.all_numbers("alpha")?;
    let optional = |name: &str| {
        if table.has(name) { table.numbers(name) } else { Ok(vec![None; table.rows()]) }
    };
    let (k, corr, epsilon) = (optional("k")?, optional("corr")?, optional("epsilon")?);
    let partial = optional("eta2_partial")?;
    // Without the other column this one has to be there.
    let effect =
        if table.has("eta2_partial") { optional("effect")? } else { table.numbers("effect")? };
    let need = |cells: &[Option<f64>], row: usize, name: &str| {
        cells[row].ok_or_else(|| table.bad_cell(row, name, "", "a number, for an ANOVA"))
    };
    (0..table.rows())
        .map(|row| {
            let size = || {
                let number = "a number: dz, r, or eta squared between people";
                effect[row].ok_or_else(|| table.bad_cell(row, "effect", "", number))
            };
            let planned = match test[row].as_str() {
                "paired_t" => PlannedTest::PairedT { effect: size()? },
                "pearson" => PlannedTest::Pearson { effect: size()? },
                "rm_anova" => {
                    let k = count(table, row, "k", need(&k, row, "k")?)?;
                    let epsilon = need(&epsilon, row, "epsilon")?;
                    if let Some(eta2_partial) = partial[row] {
                        for (name, cells) in [("effect", &effect), ("corr", &corr)] {
                            if let Some(found) = cells[row] {
                                let none = "no number beside eta2_partial";
                                return Err(table.bad_cell(row, name, found.to_string(), none));
                            }
                        }
                        PlannedTest::RmAnovaPartial { eta2_partial, k, epsilon }
                    } else {
                        PlannedTest::RmAnova {
                            effect: size()?,
                            k,
                            corr: need(&corr, row, "corr")?,
                            epsilon,
                        }
                    }
                }
                other => {
                    return Err(table.bad_cell(
                        row,
                        "test",
                        other,
                        "paired_t, pearson or rm_anova",
                    ));
                }
            };
            Ok(PowerQuestion {
                test: planned,
                n: count(table, row, "n", n[row])?,
                alpha: alpha[row],
            })
        })
        .collect()
}

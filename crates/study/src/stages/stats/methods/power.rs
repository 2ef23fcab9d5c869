//! Power, a question a row.

use super::{Ran, StudyError, Table, Test, count, labels, plain};
use maveric_stats::{PlannedTest, PowerQuestion, power};

/// Power of a design, and the sample for 80 %: a question a row
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a question a row. test: paired_t, pearson or rm_anova; n: people; effect: dz, r or partial eta squared; alpha;
of rm_anova also k (conditions), corr (between them) and epsilon. Other columns are not read.
Example: maveric stats power questions.csv")]
pub struct Power {}

impl Test for Power {
    const NAME: &'static str = "power";
    const HAS_FIGURE: bool = false;

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        Ok(Ran::numbers(plain(&power(&power_questions(table)?)?)))
    }
}

/// One question a row: `test`, `n`, `effect`, `alpha`, and for an ANOVA `k`, `corr`, `epsilon`.
fn power_questions(table: &Table) -> Result<Vec<PowerQuestion>, StudyError> {
    let test = labels(table, "test")?;
    let n = table.all_numbers("n")?;
    let effect = table.all_numbers("effect")?;
    let alpha = table.all_numbers("alpha")?;
    let optional = |name: &str| {
        if table.has(name) {
            table.numbers(name)
        } else {
            Ok(vec![None; table.rows()])
        }
    };
    let (k, corr, epsilon) = (optional("k")?, optional("corr")?, optional("epsilon")?);
    let need = |cells: &[Option<f64>], row: usize, name: &str| {
        cells[row].ok_or_else(|| table.bad_cell(row, name, "", "a number, for an ANOVA"))
    };
    (0..table.rows())
        .map(|row| {
            let effect = effect[row];
            let planned = match test[row].as_str() {
                "paired_t" => PlannedTest::PairedT { effect },
                "pearson" => PlannedTest::Pearson { effect },
                "rm_anova" => PlannedTest::RmAnova {
                    effect,
                    k: count(table, row, "k", need(&k, row, "k")?)?,
                    corr: need(&corr, row, "corr")?,
                    epsilon: need(&epsilon, row, "epsilon")?,
                },
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

//! Do printed p values follow from printed coefficients?

use super::{Ran, StudyError, Table, Test, count, labels, plain};
use maveric_stats::{ReportedCorrelation, recheck};

/// Does each printed p follow from its printed coefficient and degrees of freedom?
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a printed correlation a row, as text. coefficient: .46 or -.71; df; p: =.012, <.001 or .012. Other columns are not read.
Example: maveric stats recheck printed.csv")]
pub struct Recheck {}

impl Test for Recheck {
    const NAME: &'static str = "recheck";
    const HAS_FIGURE: bool = false;
    const HAS_SENTENCE: bool = false;

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        Ok(Ran::numbers(plain(&recheck(&reported(table)?)?)))
    }
}

/// One published correlation a row: `coefficient`, `df`, `p`, as printed.
fn reported(table: &Table) -> Result<Vec<ReportedCorrelation>, StudyError> {
    let coefficient = labels(table, "coefficient")?;
    let df = table.all_numbers("df")?;
    let p = labels(table, "p")?;
    (0..table.rows())
        .map(|row| {
            Ok(ReportedCorrelation {
                coefficient: coefficient[row].clone(),
                df: count(table, row, "df", df[row])?,
                p: p[row].clone(),
            })
        })
        .collect()
}

//! How near the car at 0 on the dial comes to the person.

use super::StudyPage;
use crate::{
    texts::value,
    words::{in_unit_of, short},
};
use maveric_analysis::Reproduction;
use maveric_domain::ConditionId;
use maveric_report::{ReportError, tables::Table};
use minijinja::context;

impl StudyPage<'_> {
    /// Tables of accuracy, of the mean difference and of who is nearer; none where no car lies at 0 on the dial.
    pub(super) fn accuracy(&self) -> Result<Vec<Table>, ReportError> {
        let a = self.analysis;
        let mut tables = Vec::new();
        let of_own = |own: ConditionId| self.texts.with(&context! { own => own.to_string() });
        if let Some(first) = a.reproduction.first() {
            let texts = of_own(first.condition);
            let row = |r: &Reproduction| {
                let same = r.bias.as_ref().map(|b| b.verdict.words());
                context! {
                    paper => self.printed_accuracy(r),
                    same,
                    ..context! { ..in_unit_of(a, &r.measure), ..value(r) }
                }
            };
            tables.push(texts.table("accuracy", a.reproduction.iter().map(row))?);
            let with_bias = a.reproduction.iter().filter(|r| r.bias.is_some());
            tables.push(texts.table("bias", with_bias.map(row))?);
        }
        if let Some(first) = a.nearer.first() {
            let texts = of_own(first.condition);
            tables.push(texts.table("nearer", &a.nearer)?);
        }
        Ok(tables)
    }

    /// The share that the paper printed.
    fn printed_accuracy(&self, row: &Reproduction) -> Option<f64> {
        let key = format!("accuracy.{}.{}", row.condition, short(&row.measure));
        let row = self.ledger.iter().rfind(|row| row.claim.key == key)?;
        Some(row.claim.printed.value / 100.0)
    }
}

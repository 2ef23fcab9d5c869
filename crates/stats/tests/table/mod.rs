//! Reads the CSV of an oracle case: plain commas, no quotes, an empty cell is missing.

use std::{fs, path::Path};

use maveric_stats::{CaseStratum, PlannedTest, PowerQuestion, ReportedCorrelation, WithinSubjects};
use serde_json::Value;

/// Cells as text, by column.
pub(crate) struct Table {
    pub(crate) header: Vec<String>,
    rows: Vec<Vec<String>>,
    conditions: Vec<String>,
}

impl Table {
    pub(crate) fn read(path: &Path, case: &Value) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let mut lines = text
            .lines()
            .map(|line| line.split(',').map(|c| c.trim().to_owned()).collect::<Vec<_>>());
        let conditions = case["conditions"].as_array().into_iter().flatten();
        Self {
            header: lines.next().unwrap(),
            rows: lines.filter(|row| row.len() > 1 || !row[0].is_empty()).collect(),
            conditions: conditions.map(|c| c.as_str().unwrap().to_owned()).collect(),
        }
    }

    pub(crate) fn text(&self, column: &str) -> Vec<String> {
        let j = self.header.iter().position(|h| h == column).unwrap();
        self.rows.iter().map(|row| row[j].clone()).collect()
    }

    /// Text where a cell may be empty.
    pub(crate) fn labels(&self, column: &str) -> Vec<Option<String>> {
        let cells = self.text(column).into_iter();
        cells.map(|c| (!c.is_empty()).then_some(c)).collect()
    }

    pub(crate) fn numbers(&self, column: &str) -> Vec<Option<f64>> {
        let cells = self.text(column);
        cells.iter().map(|c| (!c.is_empty()).then(|| c.parse().unwrap())).collect()
    }

    pub(crate) fn complete(&self, column: &str) -> Vec<f64> {
        self.numbers(column).into_iter().map(Option::unwrap).collect()
    }

    /// Its columns in the order of [`Self::conditions`].
    pub(crate) fn within(&self) -> WithinSubjects {
        let (subject, condition) = (self.text("subject"), self.text("condition"));
        let value = self.numbers("value");
        let mut rows: Vec<usize> = (0..value.len()).collect();
        rows.sort_by_key(|&row| self.conditions.iter().position(|c| *c == condition[row]));
        let subject: Vec<String> = rows.iter().map(|&row| subject[row].clone()).collect();
        let condition: Vec<String> = rows.iter().map(|&row| condition[row].clone()).collect();
        let value: Vec<Option<f64>> = rows.iter().map(|&row| value[row]).collect();
        WithinSubjects::from_long(&subject, &condition, &value).unwrap()
    }

    /// Moments with and without an event, a stratum a person.
    pub(crate) fn strata(&self) -> Vec<CaseStratum> {
        let mut strata: Vec<CaseStratum> = Vec::new();
        let moments = self.complete("event").into_iter();
        for ((person, event), exposure) in
            self.text("stratum").into_iter().zip(moments).zip(self.complete("exposure"))
        {
            let place = strata.iter().position(|s| s.person == person);
            let place = place.unwrap_or_else(|| {
                strata.push(CaseStratum { person, events: Vec::new(), others: Vec::new() });
                strata.len() - 1
            });
            let stratum = &mut strata[place];
            let list = if event > 0.0 { &mut stratum.events } else { &mut stratum.others };
            list.push(exposure);
        }
        strata
    }

    pub(crate) fn questions(&self) -> Vec<PowerQuestion> {
        let column = |name: &str| self.numbers(name);
        let (n, effect, alpha) = (column("n"), column("effect"), column("alpha"));
        let (k, corr, epsilon) = (column("k"), column("corr"), column("epsilon"));
        let test = |i: usize, name: &str| {
            let effect = effect[i].unwrap();
            match name {
                "paired_t" => PlannedTest::PairedT { effect },
                "pearson" => PlannedTest::Pearson { effect },
                _ => PlannedTest::RmAnova {
                    effect,
                    k: k[i].unwrap() as usize,
                    corr: corr[i].unwrap(),
                    epsilon: epsilon[i].unwrap(),
                },
            }
        };
        let names = self.text("test");
        let questions = names.iter().enumerate().map(|(i, name)| PowerQuestion {
            test: test(i, name),
            n: n[i].unwrap() as usize,
            alpha: alpha[i].unwrap(),
        });
        questions.collect()
    }

    pub(crate) fn reported(&self) -> Vec<ReportedCorrelation> {
        let (coefficients, df, p) = (self.text("coefficient"), self.complete("df"), self.text("p"));
        let rows = coefficients.into_iter().zip(df).zip(p);
        rows.map(|((coefficient, df), p)| ReportedCorrelation { coefficient, df: df as usize, p })
            .collect()
    }
}

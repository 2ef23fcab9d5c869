//! Every pair of conditions, measure by measure.

use super::{Cell, Column, Table};
use crate::apa::{bounded, number, p_cell};
use serde::{Deserialize, Serialize};

/// One pair of conditions on one measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PostHocRow {
    /// Such as `Mean velocity (mph)`.
    pub measure: String,
    /// The first condition: the difference is first minus second.
    pub first: String,
    /// The second.
    pub second: String,
    /// Participants with a value in both.
    pub n: usize,
    /// Mean difference, in the measure's unit.
    pub difference: Option<f64>,
    /// Its test; an error is the reason why there is none.
    pub test: Result<PostHocTest, String>,
}

/// A pair's test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PostHocTest {
    /// The statistic.
    pub statistic: PostHocStatistic,
    /// Two-sided p, not adjusted.
    pub p: f64,
    /// p after Holm, over the pairs of this measure.
    pub p_holm: f64,
    /// Effect size: *d*_z for t, the rank-biserial correlation for V.
    pub effect: Option<f64>,
    /// Its 95% interval.
    pub interval: Option<(f64, f64)>,
}

/// A paired test's statistic.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PostHocStatistic {
    /// Paired t with its degrees of freedom.
    T {
        /// The statistic.
        t: f64,
        /// Degrees of freedom.
        df: usize,
    },
    /// Wilcoxon's sum of positive ranks.
    V(f64),
}

impl PostHocTest {
    fn statistic(&self) -> String {
        match self.statistic {
            PostHocStatistic::T { t, df } => format!("*t*({df}) = {}", number(t, 2)),
            PostHocStatistic::V(v) => format!("*V* = {}", number(v, 1)),
        }
    }

    fn effect(&self) -> Option<String> {
        let value = self.effect?;
        let (symbol, write): (_, fn(f64, usize) -> String) = match self.statistic {
            PostHocStatistic::T { .. } => ("*d*_{z}", number),
            PostHocStatistic::V(_) => ("*r*_{rb}", bounded),
        };
        let interval = self.interval.map_or_else(String::new, |(low, high)| {
            format!(" [{}, {}]", write(low, 2), write(high, 2))
        });
        Some(format!("{symbol} = {}{interval}", write(value, 2)))
    }
}

/// Builds the table `post-hoc`.
pub fn post_hoc(rows: &[PostHocRow]) -> Table {
    let cells = |row: &PostHocRow| {
        let test = row.test.as_ref();
        let because = |reason: &String| Cell::MissingBecause(reason.clone());
        let of = |write: &dyn Fn(&PostHocTest) -> Cell| test.map_or_else(because, write);
        vec![
            Cell::text(&row.measure),
            Cell::text(format!("{} − {}", row.first, row.second)),
            Cell::count(row.n),
            Cell::number_or(row.difference, 2, "nobody has a value in both"),
            of(&|test| Cell::Marked(test.statistic())),
            of(&|test| Cell::text(p_cell(test.p))),
            of(&|test| Cell::text(p_cell(test.p_holm))),
            of(&|test| test.effect().map_or(Cell::Missing, Cell::Marked)),
        ]
    };
    Table {
        name: "post-hoc".to_owned(),
        title: "Post-hoc comparisons".to_owned(),
        columns: vec![
            Column::left("Measure"),
            Column::left("Pair"),
            Column::right("*n*"),
            Column::right("Mean difference"),
            Column::right("Test"),
            Column::right("*p*"),
            Column::right("*p*_{Holm}"),
            Column::right("Effect size [95% CI]"),
        ],
        rows: rows.iter().map(cells).collect(),
        notes: vec![
            "*t*: paired *t* test, *d*_{z} its effect size; *V*: Wilcoxon’s signed ranks, *r*_{rb} the rank-biserial \
             correlation. *p* values are two-sided; Holm’s adjustment is over the pairs of one measure. *n*: \
             participants with a value in both conditions."
                .to_owned(),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(test: Result<PostHocTest, String>) -> PostHocRow {
        PostHocRow {
            measure: "Mean velocity (mph)".into(),
            first: "Mimic".into(),
            second: "Aggressive".into(),
            n: 24,
            difference: Some(-4.61),
            test,
        }
    }

    #[test]
    fn a_test_is_written_as_the_manual_has_it() {
        let table = post_hoc(&[row(Ok(PostHocTest {
            statistic: PostHocStatistic::T { t: -5.9, df: 23 },
            p: 2e-6,
            p_holm: 0.0171,
            effect: Some(-1.2),
            interval: Some((-1.73, -0.67)),
        }))]);
        let shown = table.to_markdown();
        let expected = "| Mean velocity (mph) | Mimic − Aggressive | 24 | −4.61 | *t*(23) = −5.90 | &lt; .001 | .017 \
                        | *d*<sub>z</sub> = −1.20 \\[−1.73, −0.67\\] |";
        assert!(shown.contains(expected), "{shown}");
    }

    #[test]
    fn a_pair_without_a_test_has_a_dash_and_the_reason_below() {
        let table = post_hoc(&[row(Err("all differences are 0".into()))]);
        assert!(
            table
                .to_latex()
                .contains("–\\textsuperscript{a} & –\\textsuperscript{a}")
        );
        assert!(
            table
                .to_markdown()
                .contains("<sup>a</sup> all differences are 0.")
        );
        assert!(!table.to_csv().contains('–'));
    }
}

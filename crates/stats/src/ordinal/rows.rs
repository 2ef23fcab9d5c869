//! The rows of ordered answers, and which conditions separate them.

use super::likelihood::Sample;
use crate::{
    StatsError, complete,
    within_subjects::{Index, tell_apart},
};

/// One answer: positions of its subject, condition, period and category.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    subject: usize,
    condition: usize,
    period: usize,
    category: usize,
}

/// Answers, with the names of what occurs among them.
#[derive(Debug, Clone)]
pub(super) struct Answers {
    pub(super) rows: Vec<Row>,
    /// How many subjects there are; all have a row in the whole data.
    pub(super) subjects: usize,
    /// In order of first appearance.
    pub(super) conditions: Vec<String>,
    /// How many there are; 1 where none is known.
    pub(super) periods: usize,
    /// Ascending.
    pub(super) categories: Vec<i64>,
}

impl Answers {
    pub(super) fn new(
        subjects: &[String],
        conditions: &[String],
        periods: &[usize],
        answers: &[Option<f64>],
    ) -> Result<Self, StatsError> {
        for (name, length) in [("condition", conditions.len()), ("value", answers.len())] {
            StatsError::same_length(name, length, subjects.len())?;
        }
        let kept = complete::rows(&[("value", answers)], "answer", 2)?;
        let mut whole = Vec::with_capacity(kept.kept.len());
        for (&row, &value) in kept.kept.iter().zip(&kept.columns[0]) {
            // Beyond this doubles skip whole numbers.
            if value.fract().abs() > 0.0 || value.abs() > 9e15 {
                return Err(StatsError::NotWhole { row, value });
            }
            whole.push(value as i64);
        }
        let mut categories = whole.clone();
        categories.sort_unstable();
        categories.dedup();
        let named = Index::from_labels(conditions);
        StatsError::two_conditions(named.names.len())?;
        tell_apart(&[named.names.as_slice()])?;
        let people = Index::from_labels(kept.kept.iter().map(|&row| &subjects[row]));
        complete::enough("subject", people.names.len(), kept.missing, 2)?;
        let mut met: Vec<usize> =
            kept.kept.iter().filter_map(|&row| periods.get(row).copied()).collect();
        met.sort_unstable();
        met.dedup();
        let rows: Vec<Row> = (kept.kept.iter().zip(&whole).zip(&people.rows))
            .map(|((&row, answer), &subject)| Row {
                subject,
                condition: named.rows[row],
                period: periods.get(row).map_or(0, |period| met.partition_point(|p| p < period)),
                category: categories.partition_point(|c| c < answer),
            })
            .collect();
        for (condition, name) in named.names.iter().enumerate() {
            if rows.iter().all(|row| row.condition != condition) {
                let cell = name.clone();
                return Err(StatsError::EmptyCell { cell });
            }
        }
        if categories.len() < 2 {
            let reason = format!("all answers are {}", categories[0]);
            return Err(StatsError::no_fit(reason));
        }
        Ok(Self {
            rows,
            subjects: people.names.len(),
            conditions: named.names,
            periods: met.len().max(1),
            categories,
        })
    }

    /// The same without conditions whose every answer is the lowest or the highest of those left.
    ///
    /// In the limit of an infinite coefficient their rows have probability 1, whoever answers. Where the conditions separate the answers
    /// whole, so has every row: what is left is one condition with one answer.
    pub(super) fn without_separated(&self) -> Self {
        let mut left = self.clone();
        loop {
            if left.categories.len() < 2 {
                return left.without_conditions();
            }
            let highest = left.categories.len() - 1;
            let extreme = (0..left.conditions.len()).find(|&condition| {
                let mut answers = left.rows.iter().filter(|row| row.condition == condition);
                let first = answers.next().map_or(0, |row| row.category);
                (first == 0 || first == highest) && answers.all(|row| row.category == first)
            });
            let Some(extreme) = extreme else {
                return left;
            };
            left = left.without(extreme);
        }
    }

    fn without(&self, condition: usize) -> Self {
        let mut rows: Vec<Row> =
            self.rows.iter().copied().filter(|row| row.condition != condition).collect();
        let occurs = |category: usize| rows.iter().any(|row| row.category == category);
        let kept: Vec<usize> = (0..self.categories.len()).filter(|c| occurs(*c)).collect();
        for row in &mut rows {
            row.category = kept.partition_point(|c| *c < row.category);
            row.condition -= usize::from(row.condition > condition);
        }
        let mut conditions = self.conditions.clone();
        conditions.remove(condition);
        Self {
            rows,
            subjects: self.subjects,
            conditions,
            periods: self.periods,
            categories: kept.iter().map(|&c| self.categories[c]).collect(),
        }
    }

    /// The same with two conditions, the first before the second, as one.
    pub(super) fn with_one_of(&self, first: usize, second: usize) -> Self {
        let mut one = self.clone();
        one.conditions.remove(second);
        for row in &mut one.rows {
            if row.condition == second {
                row.condition = first;
            } else {
                row.condition -= usize::from(row.condition > second);
            }
        }
        one
    }

    /// All rows as if of one condition.
    pub(super) fn without_conditions(&self) -> Self {
        let mut one = self.clone();
        one.conditions.truncate(1);
        for row in &mut one.rows {
            row.condition = 0;
        }
        one
    }

    pub(super) fn sample(&self) -> Sample {
        let mut of_subject = vec![Vec::new(); self.subjects];
        for row in &self.rows {
            of_subject[row.subject].push((row.category, [row.condition, row.period]));
        }
        of_subject.retain(|rows| !rows.is_empty());
        let levels = [self.conditions.len(), self.periods];
        Sample::new(of_subject, self.categories.len(), levels)
    }
}

//! Results as people read them: what was found, of whom, why, and what has no value; on a terminal, in Markdown, in LaTeX.

mod bayes;
mod cells;
mod chosen;
mod correlations;
mod factors;
mod groups;
mod models;
mod pairs;
mod plain;
mod reasons;
mod within;

pub(super) use bayes::{bayes, bayes_correlation};
pub(super) use chosen::by_design;
pub(super) use correlations::{correlation, rm_correlation};
pub(super) use factors::{aligned, at_covariates, factorial};
pub(super) use groups::{equivalence, groups};
pub(super) use models::{mixed, ordinal};
pub(super) use pairs::posthoc;
pub(super) use plain::plain;
pub(super) use within::{friedman, rm_anova, whole};

use pairs::comparison;

use maveric_report::{markup, tables::Table};
use maveric_stats::{
    Reasons,
    apa::{Statement, Statements},
};
use std::collections::BTreeSet;

/// A result in words and tables.
#[derive(Debug, Default)]
pub(super) struct Printed {
    /// What was done, and to whom.
    heading: Vec<String>,
    /// Its parts. A table without rows is a paragraph: its title and notes.
    tables: Vec<Table>,
}

impl Printed {
    /// Whose data these are: the first line of each report of a within-subject design.
    fn within(what: &str, n: usize, k: usize, dropped: &[String]) -> Self {
        Self::headed(format!("{what}: {n} subjects, {k} conditions"), n, dropped)
    }

    /// What was done, with how many, and who was left out of it.
    fn headed(who: String, n: usize, dropped: &[String]) -> Self {
        let mut heading = vec![who];
        if !dropped.is_empty() {
            let (count, total, names) = (dropped.len(), n + dropped.len(), dropped.join(", "));
            heading.push(format!(
                "left out for a missing cell: {count} of {total} subjects ({names})"
            ));
        }
        Self { heading, tables: Vec::new() }
    }

    /// Adds a line to the heading, unless it is empty.
    pub(super) fn also(mut self, line: String) -> Self {
        if !line.is_empty() {
            self.heading.push(line);
        }
        self
    }

    /// How many rows or values were left out.
    fn left_out(mut self, missing: usize, what: &str) -> Self {
        if missing > 0 {
            self.heading.push(format!("left out for a missing value: {missing} {what}"));
        }
        self
    }

    /// Adds a table, unless it has neither rows nor notes.
    fn table(mut self, table: Table) -> Self {
        if !(table.rows.is_empty() && table.notes.is_empty()) {
            self.tables.push(table);
        }
        self
    }

    /// The tables of another report after these.
    fn and(mut self, mut other: Self) -> Self {
        self.tables.append(&mut other.tables);
        self
    }

    /// Adds a heading with lines below it, with marks.
    fn lines(self, heading: &str, lines: Vec<String>) -> Self {
        let mut table = cells::table::<()>(heading, []).done();
        table.notes = lines;
        self.table(table)
    }

    /// Reasons for numbers without a value, each with the names it stands for.
    fn undefined(self, reasons: &Reasons) -> Self {
        let mut by_reason: Vec<(&str, Vec<&str>)> = Vec::new();
        for (name, reason) in reasons.iter().filter(|(name, _)| !only_elsewhere(name)) {
            match by_reason.iter_mut().find(|(known, _)| *known == reason) {
                Some((_, names)) => names.push(name),
                None => by_reason.push((reason, vec![name])),
            }
        }
        let lines = by_reason.into_iter().map(|(reason, names)| {
            let shown = names[..names.len().min(4)].join(", ");
            let more = names.len().saturating_sub(4);
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            markup::literal(&format!("{reason}: {shown}{more}"))
        });
        self.lines("No value (–)", lines.collect())
    }

    /// Gives a table whose name is taken one with a number, so that each label of a paper is of one table.
    pub(super) fn label_apart(&mut self, taken: &mut BTreeSet<String>) {
        for table in self.tables.iter_mut().filter(|t| !t.rows.is_empty()) {
            let name = table.name.clone();
            let mut number = 1;
            while !taken.insert(table.name.clone()) {
                number += 1;
                table.name = format!("{name}-{number}");
            }
        }
    }

    /// Lines for a terminal (`Table::to_text`), or GitHub's Markdown.
    pub(super) fn written(&self, table_text: fn(&Table) -> String) -> Vec<String> {
        let mut lines = self.heading.clone();
        for table in &self.tables {
            lines.push(String::new());
            lines.extend(table_text(table).lines().map(str::to_owned));
        }
        lines
    }

    /// LaTeX with `booktabs`; what is no table is a comment.
    pub(super) fn latex(&self) -> Vec<String> {
        let comment = |line: &String| format!("% {line}");
        let mut lines: Vec<String> = self.heading.iter().map(comment).collect();
        for table in &self.tables {
            lines.push(String::new());
            if table.rows.is_empty() {
                let notes = table.notes.iter().map(|note| markup::plain(note));
                let title = std::iter::once(markup::plain(&table.title));
                lines.extend(title.chain(notes).map(|line| comment(&line)));
            } else {
                lines.extend(table.to_latex().lines().map(str::to_owned));
            }
        }
        lines
    }
}

/// Whether a number stands in the JSON alone, for comparing with a program that prints it.
fn only_elsewhere(name: &str) -> bool {
    let last = name.rsplit('.').next().unwrap_or(name);
    ["p_r_default", "p_scipy_auto", "p_zsplit", "p_anderson"]
        .iter()
        .any(|known| last.starts_with(known))
        || last.contains("_mbess_")
}

/// The sentences said about `names`, with marks.
fn sentences(result: &impl Statements, names: &[&str]) -> Vec<String> {
    let statements = result.statements();
    let wanted = statements.iter().filter(|(name, _)| names.contains(&name.as_str()));
    wanted.map(|(_, sentence)| sentence.markup().to_owned()).collect()
}

/// A sentence after its name, with marks.
pub(super) fn named_sentence((name, sentence): (String, Statement)) -> String {
    format!("{}: {}", markup::literal(&name), sentence.markup())
}

/// All sentences, each after its name.
pub(super) fn named_sentences(result: &impl Statements) -> Vec<String> {
    let statements = result.statements().into_iter();
    statements.map(named_sentence).collect()
}

#[cfg(test)]
mod tests {
    use super::{cells::table, *};
    use maveric_report::tables::Cell;

    #[test]
    fn two_tables_of_one_name_have_labels_of_their_own() {
        let made = |title: &str| table(title, [1_usize]).right("*n*", |n| Cell::count(*n)).done();
        let mut first = Printed::default()
            .table(made("Pairs of sex"))
            .lines("Pairs of sex", vec!["no table".to_owned()])
            .table(made("Pairs of sex"));
        let mut second = Printed::default().table(made("Pairs of sex"));
        let mut taken = BTreeSet::new();
        first.label_apart(&mut taken);
        second.label_apart(&mut taken);
        let latex = [first.latex(), second.latex()].concat();
        let labels: Vec<&String> = latex.iter().filter(|l| l.contains("\\label")).collect();
        let expected = ["pairs-of-sex", "pairs-of-sex-2", "pairs-of-sex-3"]
            .map(|name| format!("\\label{{tab:{name}}}"));
        assert_eq!(labels, expected.iter().collect::<Vec<_>>());
    }
}

//! Results as people read them: what was found, of whom, why, and what has no value; on a terminal, in Markdown, in LaTeX.

mod cells;
mod correlations;
mod designs;
mod pairs;
mod plain;
mod within;

pub(super) use correlations::{correlation, rm_correlation};
pub(super) use designs::{by_design, equivalence, factorial, groups, mixed, ordinal, ranks};
pub(super) use pairs::{comparison, posthoc};
pub(super) use plain::plain;
pub(super) use within::{friedman, rm_anova, whole};

use maveric_report::{markup, tables::Table};
use maveric_stats::{Reasons, apa::Statements};

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
    fn of(what: &str, n: usize, k: usize, dropped: &[String]) -> Self {
        let mut heading = vec![format!("{what}: {n} subjects, {k} conditions")];
        if !dropped.is_empty() {
            heading.push(format!(
                "left out for a missing cell: {} of {} subjects ({})",
                dropped.len(),
                n + dropped.len(),
                dropped.join(", ")
            ));
        }
        Self {
            heading,
            tables: Vec::new(),
        }
    }

    /// Adds a table, unless it has neither rows nor notes.
    fn table(mut self, table: Table) -> Self {
        if !(table.rows.is_empty() && table.notes.is_empty()) {
            self.tables.push(table);
        }
        self
    }

    /// Adds a heading with lines below it, with marks.
    fn lines(self, heading: &str, lines: Vec<String>) -> Self {
        let mut table = cells::table(heading, &[]);
        table.notes = lines;
        self.table(table)
    }

    /// Reasons for numbers without a value, each with the names it stands for.
    fn undefined(self, reasons: &Reasons) -> Self {
        let mut by_reason: Vec<(&str, Vec<&str>)> = Vec::new();
        for (name, reason) in reasons.iter() {
            match by_reason.iter_mut().find(|(known, _)| *known == reason) {
                Some((_, names)) => names.push(name),
                None => by_reason.push((reason, vec![name])),
            }
        }
        let said = by_reason.into_iter().map(|(reason, names)| {
            let shown = names[..names.len().min(4)].join(", ");
            let more = names.len().saturating_sub(4);
            let more = if more > 0 {
                format!(" and {more} more")
            } else {
                String::new()
            };
            markup::literal(&format!("{reason}: {shown}{more}"))
        });
        self.lines("No value (–)", said.collect())
    }

    /// Lines for a terminal.
    pub(super) fn text(&self) -> Vec<String> {
        let mut lines = self.heading.clone();
        for table in &self.tables {
            lines.push(String::new());
            lines.extend(table.to_text().lines().map(str::to_owned));
        }
        lines
    }

    /// GitHub's Markdown.
    pub(super) fn markdown(&self) -> Vec<String> {
        let mut lines = self.heading.clone();
        for table in &self.tables {
            lines.push(String::new());
            lines.extend(table.to_markdown().lines().map(str::to_owned));
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

/// The sentences said about `names`, with marks.
fn said(found: &impl Statements, names: &[&str]) -> Vec<String> {
    let all = found.statements();
    let wanted = all
        .iter()
        .filter(|(name, _)| names.contains(&name.as_str()));
    wanted.map(|(_, said)| said.markup().to_owned()).collect()
}

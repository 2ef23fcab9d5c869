//! Results as people read them on a terminal: what was found, of whom, why, and what has no value.

mod correlations;
mod pairs;
mod plain;
mod table;
mod within;

pub(super) use correlations::{correlation, rm_correlation};
pub(super) use pairs::{comparison, posthoc};
pub(super) use plain::plain;
pub(super) use within::{friedman, rm_anova, whole};

use maveric_stats::Reasons;

/// Whose data these are: the first line of each report of a within-subject design.
fn who(what: &str, n: usize, k: usize, dropped: &[String]) -> Vec<String> {
    let mut lines = vec![format!("{what}: {n} subjects, {k} conditions")];
    if !dropped.is_empty() {
        lines.push(format!(
            "left out for a missing cell: {} of {} subjects ({})",
            dropped.len(),
            n + dropped.len(),
            dropped.join(", ")
        ));
    }
    lines
}

/// A heading and what stands below it, after an empty line.
fn section(lines: &mut Vec<String>, heading: &str, below: Vec<String>) {
    if below.is_empty() {
        return;
    }
    lines.push(String::new());
    lines.push(heading.to_owned());
    lines.extend(below);
}

/// Reasons for numbers without a value, each with the names it stands for.
fn undefined(lines: &mut Vec<String>, reasons: &Reasons) {
    let mut by_reason: Vec<(&str, Vec<&str>)> = Vec::new();
    for (name, reason) in reasons.iter() {
        match by_reason.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, names)) => names.push(name),
            None => by_reason.push((reason, vec![name])),
        }
    }
    let below = by_reason
        .into_iter()
        .flat_map(|(reason, names)| {
            let shown = names[..names.len().min(4)].join(", ");
            let more = names.len().saturating_sub(4);
            let more = if more > 0 {
                format!(" and {more} more")
            } else {
                String::new()
            };
            [format!("  {reason}:"), format!("    {shown}{more}")]
        })
        .collect();
    section(lines, "No value (–)", below);
}

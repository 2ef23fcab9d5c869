//! `codebook`: what each questionnaire asks and how it is scored, for people and for programs.

use crate::{
    atomic_write::atomic_write_bytes,
    error::StudyError,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    run_folder::read_scales,
    tables::write_rows,
};
use maveric_domain::{Scale, survey::Scoring};
use path_slash::PathExt as _;
use serde::{Deserialize, Serialize};
use std::{fmt::Write as _, path::PathBuf};

/// What to describe.
#[derive(Debug, Clone)]
pub struct CodebookOptions {
    /// Folder of questionnaire definitions.
    pub scales: PathBuf,
    /// Folder to write `codebook.md` and `codebook.csv` into.
    pub out: PathBuf,
}

/// What was described.
#[derive(Debug, Clone, Serialize)]
pub struct Codebook {
    /// Questionnaires.
    pub scales: usize,
    /// Their items.
    pub items: usize,
}

/// An item of a subscale: a row of `codebook.csv`.
#[derive(Serialize, Deserialize)]
struct ItemRow {
    scale: String,
    subscale: String,
    item: u32,
    column: String,
    min: i32,
    max: i32,
    reversed: bool,
    wording: String,
}

/// Writes the codebook of every scale of a folder: Markdown for people; a CSV row an item of each subscale.
///
/// # Errors
/// [`StudyError`] naming the scale file and key that is wrong, or if a file cannot be written.
pub fn codebook(
    options: &CodebookOptions,
    watch: Watch<'_>,
) -> Result<Outcome<Codebook>, StudyError> {
    let csv = options.out.join("codebook.csv");
    let markdown = options.out.join("codebook.md");
    spare_inputs([&*options.scales], [&*csv, &markdown])?;
    let scales = read_scales(&options.scales)?;
    watch.check()?;
    let mut page = String::from(
        "# Codebook\n\nGenerated from the scales' files. Answers are stored as ticked; reversal is part of scoring.\n",
    );
    for scale in &scales {
        describe(scale, &mut page);
    }
    let mut rows = Vec::new();
    for scale in &scales {
        for subscale in &scale.subscales {
            rows.extend(subscale.items.iter().map(|&item| {
                ItemRow {
                    scale: scale.id.clone(),
                    subscale: subscale.id.clone(),
                    item,
                    column: scale.column_of(item),
                    min: scale.min,
                    max: scale.max,
                    reversed: scale.is_reversed(subscale, item),
                    wording: scale
                        .wording
                        .get(item as usize - 1)
                        .cloned()
                        .unwrap_or_default(),
                }
            }));
        }
    }
    write_rows(&csv, &rows)?;
    atomic_write_bytes(&markdown, page.as_bytes())?;
    let value = Codebook {
        scales: scales.len(),
        items: scales.iter().map(|s| s.items as usize).sum(),
    };
    let summary = vec![format!(
        "{} scales, {} items: {}, {}",
        value.scales,
        value.items,
        markdown.to_slash_lossy(),
        csv.to_slash_lossy()
    )];
    Ok(Outcome {
        value,
        summary,
        warnings: Vec::new(),
    })
}

fn list(items: &[u32]) -> String {
    let items: Vec<String> = items.iter().map(ToString::to_string).collect();
    items.join(", ")
}

/// A text as Markdown shows it: no mark-up of its own, and one line.
fn shown(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '|' => out.push_str("\\|"),
            '\n' | '\r' | '\t' => out.push(' '),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

/// A line of Markdown to a `String` cannot fail.
macro_rules! line {
    ($page:expr, $($text:tt)*) => {{ let _ = writeln!($page, $($text)*); }};
}

fn describe(scale: &Scale, page: &mut String) {
    let Scale {
        id,
        title,
        items,
        min,
        max,
        ..
    } = scale;
    let (title, reference) = (shown(title), shown(&scale.reference));
    line!(page, "\n## {title} (`{id}`)\n\n{reference}\n");
    let how = match scale.scoring {
        Scoring::Sum => "sum",
        Scoring::Mean => "mean",
    };
    line!(
        page,
        "- {items} items, answers {min} to {max}; columns `{}` to `{}`",
        scale.column_of(1),
        scale.column_of(*items)
    );
    line!(
        page,
        "- Score: {how} of a subscale's items; reversed items count as {} minus the answer",
        min + max
    );
    line!(
        page,
        "- Missing: scored when at least {:.0}% of a subscale's items are answered, their mean standing in for the others\n",
        100.0 * scale.min_answered
    );
    line!(
        page,
        "| subscale | name | items | reversed | range | mean | SD | alpha | source |"
    );
    line!(page, "|---|---|---|---|---|---|---|---|---|");
    for subscale in &scale.subscales {
        let reversed: Vec<u32> = subscale
            .items
            .iter()
            .copied()
            .filter(|i| scale.is_reversed(subscale, *i))
            .collect();
        let (low, high) = scale.score_range(subscale);
        let norms = subscale.norms.as_ref().map_or_else(
            || " | | | ".to_owned(),
            |n| {
                let alpha = n
                    .alpha_source
                    .as_ref()
                    .map_or_else(String::new, |s| format!("; alpha: {}", shown(s)));
                format!(
                    "{} | {} | {} | {}{alpha}",
                    n.mean,
                    n.sd,
                    n.alpha,
                    shown(&n.source)
                )
            },
        );
        line!(
            page,
            "| `{}` | {} | {} | {} | {low} to {high} | {norms} |",
            subscale.id,
            shown(&subscale.title),
            list(&subscale.items),
            list(&reversed)
        );
    }
    if !scale.correlations.is_empty() {
        let pairs: Vec<String> = scale
            .correlations
            .iter()
            .map(|c| {
                format!(
                    "{} with {} {} ({})",
                    c.of[0],
                    c.of[1],
                    c.r,
                    shown(&c.source)
                )
            })
            .collect();
        line!(page, "\nUsual correlations: {}.", pairs.join("; "));
    }
    if scale.wording.is_empty() {
        line!(
            page,
            "\nWording: in the publication; it is not in the public domain."
        );
    } else {
        line!(page, "\n| item | wording |\n|---|---|");
        for (item, text) in (1..).zip(&scale.wording) {
            line!(page, "| {item} | {} |", shown(text));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wording_is_text_and_neither_mark_up_nor_a_cell_of_its_own() {
        assert_eq!(
            shown("a | <script>b</script>\n& c\u{1b}[2J"),
            "a \\| &lt;script&gt;b&lt;/script&gt; &amp; c[2J"
        );
    }
}

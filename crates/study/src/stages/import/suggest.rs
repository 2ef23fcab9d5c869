//! `import --suggest`: what the columns of an export may mean, and what is doubtful about it.

use super::{
    columns::Columns,
    export::Export,
    families::{
        Answers, Family, answers, families, joint_pattern, names_only_condition, resembles,
        with_condition,
    },
    formats::Format,
    grid::Grid,
    wide::people_column,
};
use crate::{error::StudyError, once::first_names};
use maveric_domain::{ConditionId, Design, ParticipantId, Scale, design::Software};
use path_slash::PathExt as _;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// A map of columns for an export, as TOML with its doubts as comments. What is not sure stands in comments alone.
///
/// # Errors
/// [`StudyError::NotPossible`] for jsPsych's sessions, whose names of questions are the study's own.
pub(super) fn columns_of(
    path: &Path,
    export: &Export,
    columns: &Columns<'_>,
    design: &Design,
    sheet: Option<&str>,
) -> Result<String, StudyError> {
    let Export::Table(grid, format) = export else {
        let problem = "nothing is proposed for jsPsych, where each question has the name that its page gives it";
        let help = "call questions SCALE_ITEM, or give the trial a property `scale`; what is called otherwise is said in columns.toml";
        return Err(StudyError::not_possible(problem).with_help(help));
    };
    let mut lines = vec![
        format!(
            "# What the columns of {} may mean: {} rows, read as {}.",
            path.to_slash_lossy(),
            grid.rows(),
            match format.software {
                Software::Wide => format.title.to_owned(),
                _ => format!("an export of {}", format.title),
            }
        ),
        "# What is not sure is a comment: look at each `?`. The design names this file:".to_owned(),
        format!(
            "# [files] software = \"{}\", columns = \"surveys/columns.toml\"",
            format.software.id()
        ),
        String::new(),
    ];
    lines.extend(sheet.map(|sheet| format!("sheet = {sheet:?}")));
    lines.push(participant(grid, format, columns));
    let families = families(grid, format);
    let mut scales = Vec::new();
    let mut by_name = false;
    let mut words = BTreeSet::new();
    for scale in columns.scales {
        let proposal = of_scale(grid, scale, &families, columns, &mut words);
        by_name |= proposal.iter().any(|line| line.contains("{condition}"));
        scales.extend(proposal);
    }
    if !by_name {
        lines.push(moment(grid, format, columns, design));
    }
    lines.push(String::new());
    if !words.is_empty() {
        lines.push(format!(
            "# [moments]   # ? if conditions stand at {{condition}} below: which ({}), or \"pre\"",
            ConditionId::listed(&design.labels())
        ));
        lines.extend(words.iter().map(|word| format!("# {word} = \"?\"")));
        lines.push(String::new());
    }
    lines.extend(scales);
    Ok(lines.join("\n") + "\n")
}

/// The line that says whose each row is.
fn participant(grid: &Grid, format: &Format, columns: &Columns<'_>) -> String {
    let ids = |column: usize| grid.filled(column).collect::<BTreeSet<&str>>();
    if let Some(column) = people_column(grid, format, &columns.map).ok().flatten() {
        let (name, n) = (&grid.columns[column], ids(column).len());
        return format!("# participant = {name:?}   # by convention: {n} different ones");
    }
    let is_id = |column: &usize| {
        let cells = ids(*column);
        cells.len() == grid.rows() && cells.iter().all(|cell| ParticipantId::new(*cell).is_ok())
    };
    let possible: Vec<usize> = (0..grid.columns.len()).filter(is_id).collect();
    if let [only] = possible[..] {
        return format!("participant = {:?}", grid.columns[only]);
    }
    let names = possible.iter().map(|at| grid.columns[*at].as_str());
    format!(
        "# participant = \"?\"   # no column is known to say whose row it is; different in each row: {}",
        list(&names.collect::<Vec<&str>>())
    )
}

/// The line that says which column tells the moment.
fn moment(grid: &Grid, format: &Format, columns: &Columns<'_>, design: &Design) -> String {
    let words = |column: usize| grid.filled(column).collect::<BTreeSet<&str>>();
    let is_moment = |column: &usize| {
        let words = words(*column);
        !words.is_empty() && words.iter().all(|word| columns.moment_by_word(word).is_some())
    };
    let possible: Vec<usize> = (0..grid.columns.len()).filter(is_moment).collect();
    let by_convention = |at: &usize| {
        let (_, field) = format.field_of(&grid.columns[*at]);
        columns.moment_fields().contains(&field)
    };
    let names: Vec<&str> = possible.iter().map(|at| grid.columns[*at].as_str()).collect();
    match possible.as_slice() {
        columns if columns.iter().any(by_convention) => {
            format!("# moment: by convention, {}", list(&names))
        }
        [_] => format!("moment = {:?}", names[0]),
        [] => {
            let questionnaire = format.questionnaire.and_then(|name| grid.position(name));
            let kinds = questionnaire.map_or_else(BTreeSet::new, words);
            let kinds: Vec<&str> = kinds.into_iter().collect();
            let hint = match kinds.as_slice() {
                [] | [_] => String::new(),
                several => format!(
                    "; `{}` has {}, which [moments] could give a meaning",
                    format.questionnaire.unwrap_or_default(),
                    list(several)
                ),
            };
            format!(
                "# moment = \"?\"   # no column has conditions ({}) alone: without one all answers count as from before the drives{hint}",
                ConditionId::listed(&design.labels())
            )
        }
        _ => format!("# moment = \"?\"   # several columns have conditions: {}", list(&names)),
    }
}

fn list(names: &[&str]) -> String {
    if names.is_empty() {
        return "none".to_owned();
    }
    first_names(names.iter().map(|name| format!("`{name}`")), 12)
}

/// What is proposed for a scale, as lines; `words` gains what may be conditions in the names of its columns.
fn of_scale(
    grid: &Grid,
    scale: &Scale,
    families: &[Family],
    columns: &Columns<'_>,
    words: &mut BTreeSet<String>,
) -> Vec<String> {
    let id = &scale.id;
    let title = format!("{} items, answers {}", scale.count(), scale.ranges());
    let convention = columns.pattern_of(scale);
    let fits = |family: &&Family| {
        family.columns.len() == scale.items.len() && answers(grid, scale, family) != Answers::Beyond
    };
    let fitting: Vec<&Family> = families.iter().filter(fits).collect();
    if fitting.iter().any(|f| f.pattern() == convention) {
        return vec![format!(
            "# [scales.{id}]   # {title}: found as {convention}, as it is called by convention"
        )];
    }
    let named: Vec<&Family> = fitting.iter().copied().filter(|f| resembles(scale, f)).collect();
    let mut patterns: BTreeMap<String, Vec<&Family>> = BTreeMap::new();
    for family in &named {
        let alike =
            |other: &&&Family| with_condition(other, columns) == with_condition(family, columns);
        // A word is a condition where another stands in its place or the study has no other, and a part of the scale's own name otherwise.
        let several = named.iter().filter(alike).count() > 1;
        let pattern = if several || names_only_condition(scale, family, columns) {
            with_condition(family, columns)
        } else {
            family.pattern()
        };
        patterns.entry(pattern).or_default().push(family);
    }
    let proposed: Vec<(&String, &Vec<&Family>)> = patterns.iter().collect();
    match proposed.as_slice() {
        [(pattern, same)] => {
            let mut lines =
                vec![format!("[scales.{id}]   # {title}"), format!("column = {pattern:?}")];
            lines.extend(
                same.iter()
                    .map(|f| answers(grid, scale, f))
                    .max()
                    .and_then(|how| how_answered(grid, scale, same, how)),
            );
            lines.push(String::new());
            lines
        }
        [] if fitting.is_empty() => vec![format!(
            "# [scales.{id}]   # {title}: no columns numbered 1 to {} have such answers",
            scale.count()
        )],
        [] => doubtful(
            scale,
            &title,
            "columns fit by their number and answers, not by their names",
            &fitting,
            words,
        ),
        _ => doubtful(scale, &title, "several columns fit", &named, words),
    }
}

/// The line on answers that are not the scale's numbers as they stand.
fn how_answered(grid: &Grid, scale: &Scale, families: &[&Family], how: Answers) -> Option<String> {
    match how {
        Answers::FromZero => {
            Some(format!("add = 1   # the answers go from 0 to {}", scale.items.first()?.max - 1))
        }
        Answers::Words => {
            let columns = families.iter().flat_map(|f| f.columns.values());
            let words: BTreeSet<&str> = columns.flat_map(|c| grid.filled(*c)).collect();
            let words: Vec<String> = words.into_iter().map(|word| format!("{word:?}")).collect();
            Some(format!(
                "# labels = [\"?\"]   # from the lowest answer; there are {}",
                words.join(", ")
            ))
        }
        _ => None,
    }
}

/// Lines that are comments alone: what is possible, and what would have to be known.
fn doubtful(
    scale: &Scale,
    title: &str,
    why: &str,
    families: &[&Family],
    words: &mut BTreeSet<String>,
) -> Vec<String> {
    let mut lines = vec![format!("# [scales.{}]   # ? {title}: {why}", scale.id)];
    if let Some((joined, parts)) = joint_pattern(families) {
        lines.push(format!("# column = {joined:?}   # with [moments] above"));
        words.extend(parts);
    }
    lines.extend(families.iter().map(|f| format!("# column = {:?}", f.pattern())));
    lines
}

//! One `[[stage]]` that gives several stages: rows of a table, combinations, shards.

use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::value::{Located, check_name, read_param, required, string, wrong_type};
use crate::error::{FileProblem, MOST_STAGES};
use crate::params::{Param, ParamKind, is_name};
use crate::paths::normalise;
use crate::stage::{Row, Share};

/// What distinguishes one stage of a fan-out from the others.
#[derive(Clone, Default)]
pub(super) struct Branch {
    /// Values by name; they stand in the stage as parameters do.
    pub(super) values: Vec<(String, Param)>,
    /// Whether only the values in use make a difference.
    pub(super) distinct: bool,
    pub(super) row: Option<Row>,
    pub(super) share: Option<Share>,
}

/// All branches of the stage at byte `at`; the one empty branch if it has no fan-out.
pub(super) fn branches(
    table: &DeTable<'_>,
    root: &Path,
    at: usize,
    substitute: &mut dyn FnMut(&str, usize) -> Result<String, Located>,
) -> Result<Vec<Branch>, Located> {
    let branches = match (table.get("foreach"), table.get("matrix")) {
        (Some(value), Some(_)) => {
            let start = value.span().start;
            return Err(FileProblem::TwoFanOuts.located(start));
        }
        (Some(value), None) => {
            let start = value.span().start;
            let path = substitute(&string("foreach", value)?, start)?;
            rows(&path, root)
                .map_err(|message| FileProblem::Table { path, message }.located(start))?
        }
        (None, Some(value)) => combinations(value)?,
        (None, None) => vec![Branch::default()],
    };
    let at_most = |shards: u64, at| match shards.saturating_mul(branches.len() as u64) {
        stages if stages > MOST_STAGES => Err(FileProblem::TooManyStages { stages }.located(at)),
        _ => Ok(()),
    };
    let shards = match table.get("shards") {
        Some(value) => {
            let shards = count("shards", value)?;
            at_most(u64::from(shards), value.span().start)?;
            shards
        }
        None if table.contains_key("over") => {
            required(table, "shards", "[[stage]] with `over`", at)?;
            return Ok(branches);
        }
        None => {
            at_most(1, at)?;
            return Ok(branches);
        }
    };
    let over = match table.get("over") {
        None => None,
        Some(value) => {
            let start = value.span().start;
            Some(over(&substitute(&string("over", value)?, start)?, start)?)
        }
    };
    let shard = |branch: &Branch, shard: u32| {
        let mut branch = branch.clone();
        let whole = |number: u32| Param { kind: ParamKind::Integer, text: number.to_string() };
        branch.values.push(("shard".to_owned(), whole(shard)));
        branch.values.push(("shards".to_owned(), whole(shards)));
        branch.share = over.as_ref().map(|(folder, pattern)| Share {
            folder: folder.clone(),
            pattern: pattern.clone(),
            shard,
            shards,
        });
        branch
    };
    let cut = |branch: &Branch| (0..shards).map(|i| shard(branch, i)).collect::<Vec<_>>();
    Ok(branches.iter().flat_map(cut).collect())
}

/// A whole number from 1 on.
pub(super) fn count(key: &str, value: &super::value::Value<'_>) -> Result<u32, Located> {
    let expected = "a whole number from 1 on";
    let Some(number) = value.get_ref().as_integer() else {
        return Err(wrong_type(key, value, expected));
    };
    let count = u32::from_str_radix(number.as_str(), number.radix()).ok();
    count.filter(|&count| count > 0).ok_or_else(|| {
        FileProblem::WrongType { key: key.to_owned(), found: number.as_str().to_owned(), expected }
            .located(value.span().start)
    })
}

fn over(path: &str, at: usize) -> Result<(String, String), Located> {
    let bad = || {
        let path = path.to_owned();
        FileProblem::BadOver { path }.located(at)
    };
    let (folder, pattern) = match path.rsplit_once('/') {
        Some((folder, last)) if last.contains('*') => (folder, last),
        _ => (path, "*"),
    };
    if folder.contains('*') || pattern.matches('*').count() != 1 {
        return Err(bad());
    }
    let folder = normalise(folder).ok_or_else(bad)?;
    Ok((folder, pattern.to_owned()))
}

/// A branch a row; columns whose names can be no parameter's cannot be used.
fn rows(path: &str, root: &Path) -> Result<Vec<Branch>, String> {
    let bytes = std::fs::read(root.join(path)).map_err(|e| e.to_string())?;
    let (heading, rows) = crate::table::read(&bytes, b',')?;
    let mut branches = Vec::new();
    for (line, cells) in rows {
        let value = |(name, text): (&String, &String)| {
            let (kind, text) = (ParamKind::Literal, text.clone());
            is_name(name).then_some((name.clone(), Param { kind, text }))
        };
        branches.push(Branch {
            values: heading.iter().zip(&cells).filter_map(value).collect(),
            distinct: true,
            row: Some(Row { table: path.to_owned(), line }),
            share: None,
        });
    }
    if branches.is_empty() {
        return Err("it has no rows".to_owned());
    }
    Ok(branches)
}

/// All combinations, the last name's values changing fastest.
fn combinations(value: &super::value::Value<'_>) -> Result<Vec<Branch>, Located> {
    let expected = "a table of arrays, each with at least one value";
    let DeValue::Table(lists) = value.get_ref() else {
        return Err(wrong_type("matrix", value, expected));
    };
    let mut lists: Vec<_> = lists.iter().collect();
    lists.sort_by_key(|(name, _)| name.span().start);
    let length = |list: &super::value::Value<'_>| match list.get_ref() {
        DeValue::Array(values) => values.len() as u64,
        _ => 1,
    };
    let stages = lists.iter().map(|(_, list)| length(list));
    let stages = stages.fold(1, u64::saturating_mul);
    if stages > MOST_STAGES {
        let start = value.span().start;
        return Err(FileProblem::TooManyStages { stages }.located(start));
    }
    let mut branches = vec![Branch::default()];
    for (name, list) in lists {
        check_name(name.get_ref(), name.span().start)?;
        let values = match list.get_ref() {
            DeValue::Array(values) if !values.is_empty() => values,
            _ => return Err(wrong_type(name.get_ref(), list, expected)),
        };
        let mut longer = Vec::with_capacity(branches.len() * values.len());
        for branch in &branches {
            for value in values {
                let mut branch = branch.clone();
                let param = read_param(name.get_ref(), value)?;
                branch.values.push((name.get_ref().to_string(), param));
                longer.push(branch);
            }
        }
        branches = longer;
    }
    Ok(branches)
}

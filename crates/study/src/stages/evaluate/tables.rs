//! An evaluation as tables and sentences, for its page and for a terminal.

use crate::error::StudyError;
use maveric_following::{Compared, FollowingEvaluation, MethodMean};
use maveric_pages::{FOLLOWING, PageTexts};
use maveric_report::tables::Table;
use serde::Serialize;

/// What the texts may ask for.
#[derive(Serialize)]
struct Words<'a> {
    /// Title of the study, where there is one.
    titled: Option<&'a str>,
    data_set: &'a str,
    /// Drives, and of how many drivers where these are fewer.
    counted: &'a str,
    drives: usize,
    people: usize,
    names: Vec<&'a str>,
    driven: &'static str,
}

/// The texts of an evaluation; the study's title names the recordings, where there is one.
pub(crate) fn texts(
    evaluation: &FollowingEvaluation,
    titled: Option<&str>,
) -> Result<PageTexts, StudyError> {
    let mut words = Words {
        titled,
        data_set: "",
        counted: "",
        drives: evaluation.drivers.len(),
        people: evaluation.people(),
        names: evaluation.drivers.iter().map(|d| d.driver.as_str()).collect(),
        driven: evaluation.driven.label(),
    };
    let counted = PageTexts::new(FOLLOWING, &words)?.text("counted")?;
    words.counted = &counted;
    let recorded = PageTexts::new(FOLLOWING, &words)?.text("recorded")?;
    words.data_set = titled.unwrap_or(&recorded);
    Ok(PageTexts::new(FOLLOWING, &words)?)
}

#[derive(Serialize)]
struct MeanRow<'a> {
    label: &'static str,
    best: bool,
    of_drivers: Vec<Option<f64>>,
    #[serde(flatten)]
    mean: &'a MethodMean,
}

/// The errors of every method: means over drivers, and driver by driver.
pub(crate) fn errors(
    evaluation: &FollowingEvaluation,
    texts: &PageTexts,
) -> Result<[Table; 2], StudyError> {
    let rows: Vec<MeanRow<'_>> = evaluation
        .means
        .iter()
        .map(|mean| MeanRow {
            label: mean.method.label(),
            best: evaluation.is_best(mean.method),
            of_drivers: evaluation.drivers.iter().map(|d| d.gap_rmse_m(mean.method)).collect(),
            mean,
        })
        .collect();
    Ok([texts.table("following-errors", &rows)?, texts.table("following-by-driver", &rows)?])
}

#[derive(Serialize)]
struct ComparedRow<'a> {
    label: &'static str,
    beside_label: &'static str,
    #[serde(flatten)]
    pair: &'a Compared,
}

/// Two methods driver by driver.
pub(crate) fn compared(
    evaluation: &FollowingEvaluation,
    texts: &PageTexts,
) -> Result<Table, StudyError> {
    let rows = evaluation.compared.iter().map(|pair| ComparedRow {
        label: pair.method.label(),
        beside_label: pair.beside.label(),
        pair,
    });
    Ok(texts.table("following-compared", rows)?)
}

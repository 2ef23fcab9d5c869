//! The tables of an evaluation as lines of text.

use super::tables::{compared, errors, texts};
use crate::error::StudyError;
use maveric_following::{FollowingEvaluation, FollowingMethod};
use maveric_pages::PageTexts;
use maveric_report::tables::Table;
use serde::Serialize;

pub(super) fn lines(evaluation: &FollowingEvaluation) -> Result<Vec<String>, StudyError> {
    let texts = &texts(evaluation, None)?;
    let block = |table: &Table| table.to_text().trim_end().to_owned();
    let [means, _] = errors(evaluation, texts)?;
    let mut blocks =
        vec![block(&means), texts.text("driven_line")?, block(&drivers(evaluation, texts)?)];
    if !evaluation.compared.is_empty() {
        blocks.push(block(&compared(evaluation, texts)?));
    }
    Ok(blocks.join("\n\n").lines().map(str::to_owned).collect())
}

#[derive(Serialize)]
struct DriverRow<'a> {
    driver: &'a str,
    errors: [Option<f64>; 3],
}

fn drivers(evaluation: &FollowingEvaluation, texts: &PageTexts) -> Result<Table, StudyError> {
    let rows = evaluation.drivers.iter().map(|d| DriverRow {
        driver: &d.driver,
        errors: FollowingMethod::ALL.map(|method| d.gap_rmse_m(method)),
    });
    Ok(texts.table("drivers", rows)?)
}

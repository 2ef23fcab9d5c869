//! What the tables of a run say of questionnaires and of what was left out.

use crate::{
    atomic_write::if_there,
    beyond::beyond_in_words,
    error::StudyError,
    run_folder::lists,
    stages::score,
    tables::{
        drives::exclusions,
        embeddings::{EmbeddingRow, read_embeddings},
        read_rows,
    },
};
use maveric_domain::Scale;
use maveric_pages::study::Reliability;
use maveric_report::tables::Exclusion;
use std::{collections::BTreeSet, path::Path};

/// How well the items of every score agree.
pub(super) fn reliabilities(
    folder: &Path,
    scales: &[Scale],
) -> Result<Vec<Reliability>, StudyError> {
    let mut rows = Vec::new();
    for file in [
        "scores_reliabilities.csv",
        "rating_scores_reliabilities.csv",
    ] {
        let when = if file.starts_with("rating") {
            " (after a condition)"
        } else {
            ""
        };
        let per_score: Vec<score::Reliability> = if_there(&folder.join(file), read_rows)?;
        rows.extend(per_score.into_iter().map(|row| Reliability {
            id: format!("{}.{}{when}", row.scale, row.subscale),
            title: format!("{}{when}", titled(scales, &row.scale, &row.subscale)),
            items: row.items,
            n: row.n,
            alpha: row.alpha,
            ci_low: row.ci_low,
            ci_high: row.ci_high,
            omega: row.omega,
        }));
    }
    Ok(rows)
}

/// What its file calls a subscale: `Mini-IPIP: Openness`; the ids where there is no file.
pub(super) fn titled(scales: &[Scale], scale: &str, subscale: &str) -> String {
    let Some(known) = scales.iter().find(|s| s.id == scale) else {
        return format!("{scale}: {subscale}");
    };
    let part = known.subscales.iter().find(|s| s.id == subscale);
    match part {
        Some(part) if part.title != known.title => format!("{}: {}", known.title, part.title),
        _ => known.title.clone(),
    }
}

pub(super) fn listed_exclusions(folder: &Path) -> Result<Vec<Exclusion>, StudyError> {
    let mut left_out = Vec::new();
    for list in lists(folder) {
        let drives = list.parent().unwrap_or(folder);
        let stage = if drives.starts_with(folder.join("av")) {
            "simulate"
        } else {
            "ingest"
        };
        left_out.extend(exclusions(drives)?.into_iter().map(|row| Exclusion {
            what: if row.is_kept() {
                Exclusion::NOTHING.to_owned()
            } else {
                stage.to_owned()
            },
            // A log that could not be ingested is no drive, and has its own name alone.
            who: Some(row.drive).filter(|d| !d.is_empty()).unwrap_or(row.log),
            why: row.what,
        }));
    }
    let rows = if_there(&folder.join("embeddings.csv"), read_embeddings)?;
    let why = |row: &EmbeddingRow| {
        let blank = row.readings == Some(0);
        let blank = blank.then(|| "shows no habit: its driver is taken as anybody".to_owned());
        blank.or_else(|| row.beyond_why.as_ref().map(beyond_in_words))
    };
    let personalised = rows
        .iter()
        .filter_map(|row| Some((row.drive.to_string(), why(row)?)));
    let personalised: BTreeSet<(String, String)> = personalised.collect();
    left_out.extend(personalised.into_iter().map(|(who, why)| Exclusion {
        who,
        what: "personalize".to_owned(),
        why,
    }));
    for file in [
        "answers_exclusions.csv",
        "scores_exclusions.csv",
        "rating_scores_exclusions.csv",
    ] {
        let listed: Vec<Exclusion> = if_there(&folder.join(file), read_rows)?;
        left_out.extend(listed);
    }
    Ok(left_out)
}

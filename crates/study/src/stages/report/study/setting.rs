//! What the tables of a run say of questionnaires and of what was left out.

use crate::{
    atomic_write::if_there,
    beyond::beyond_in_words,
    error::StudyError,
    run_folder::lists,
    stages::score,
    tables::{
        Table as File,
        embeddings::{EmbeddingRow, read_embeddings},
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
        let all = |path: &Path| File::read(path)?.records::<score::Reliability>();
        let all = if_there(&folder.join(file), all)?;
        rows.extend(all.into_iter().map(|row| Reliability {
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
fn titled(scales: &[Scale], scale: &str, subscale: &str) -> String {
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
    let mut found = Vec::new();
    for list in lists(folder) {
        let path = list.with_file_name("exclusions.csv");
        if !path.exists() {
            continue;
        }
        let stage = if path.starts_with(folder.join("av")) {
            "simulate"
        } else {
            "ingest"
        };
        let table = File::read(&path)?;
        let (drive, what) = (table.text("drive")?, table.text("what")?);
        // A log that could not be ingested is no drive, and has its own name alone.
        let log = if table.has("log") {
            table.text("log")?
        } else {
            vec![None; table.rows()]
        };
        for i in 0..table.rows() {
            let who = drive[i].as_ref().or(log[i].as_ref());
            found.push(Exclusion {
                who: who.cloned().unwrap_or_default(),
                what: stage.to_owned(),
                why: what[i].clone().unwrap_or_default(),
            });
        }
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
    found.extend(personalised.into_iter().map(|(who, why)| Exclusion {
        who,
        what: "personalize".to_owned(),
        why,
    }));
    for file in [
        "answers_exclusions.csv",
        "scores_exclusions.csv",
        "rating_scores_exclusions.csv",
    ] {
        let listed = |path: &Path| File::read(path)?.records::<Exclusion>();
        found.extend(if_there(&folder.join(file), listed)?);
    }
    Ok(found)
}

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

/// How well the items of every score agree; those of sheets that stand in both tables of a run once, as given after a condition.
pub(super) fn reliabilities(
    folder: &Path,
    scales: &[Scale],
) -> Result<Vec<Reliability>, StudyError> {
    let read = |file: &str| -> Result<Vec<score::Reliability>, StudyError> {
        if_there(&folder.join(file), read_rows)
    };
    let all = read("scores_reliabilities.csv")?;
    let after = read("rating_scores_reliabilities.csv")?;
    let row = |row: score::Reliability, when: &str| Reliability {
        id: format!("{}.{}{when}", row.scale, row.subscale),
        title: format!("{}{when}", titled(scales, &row.scale, &row.subscale)),
        items: row.items,
        n: row.n,
        alpha: row.alpha,
        ci_low: row.ci_low,
        ci_high: row.ci_high,
        omega: row.omega,
    };
    let mut rows: Vec<Reliability> = not_among(all, &after).map(|r| row(r, "")).collect();
    rows.extend(after.into_iter().map(|r| row(r, " (after a condition)")));
    Ok(rows)
}

/// Those scores that are not the same sheets' as one of the others.
fn not_among(
    rows: Vec<score::Reliability>,
    others: &[score::Reliability],
) -> impl Iterator<Item = score::Reliability> {
    let name = |row: &score::Reliability| (row.scale.clone(), row.subscale.clone());
    let sheets = |row: &score::Reliability| (row.n, row.dropped, row.mean.map(f64::to_bits));
    rows.into_iter().filter(move |row| {
        let same =
            |other: &score::Reliability| name(row) == name(other) && sheets(row) == sheets(other);
        !others.iter().any(same)
    })
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
        let stage = if drives.starts_with(folder.join("av")) { "simulate" } else { "ingest" };
        left_out.extend(exclusions(drives)?.into_iter().map(|row| Exclusion {
            what: if row.is_kept() { Exclusion::NOTHING.to_owned() } else { stage.to_owned() },
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
    let personalised = rows.iter().filter_map(|row| Some((row.drive.to_string(), why(row)?)));
    let personalised: BTreeSet<(String, String)> = personalised.collect();
    left_out.extend(personalised.into_iter().map(|(who, why)| Exclusion {
        who,
        what: "personalize".to_owned(),
        why,
    }));
    for file in ["answers_exclusions.csv", "scores_exclusions.csv", "rating_scores_exclusions.csv"]
    {
        let listed: Vec<Exclusion> = if_there(&folder.join(file), read_rows)?;
        left_out.extend(listed);
    }
    Ok(without_narrower(left_out))
}

/// Without what is said of answers after a drive where it is said of all answers of the same person.
fn without_narrower(mut rows: Vec<Exclusion>) -> Vec<Exclusion> {
    let said = |row: &Exclusion| (row.who.clone(), row.why.clone());
    let known: BTreeSet<(String, String)> = rows.iter().map(said).collect();
    rows.retain(|row| {
        let wider = row.why.strip_suffix(" after a drive");
        wider.is_none_or(|wider| !known.contains(&(row.who.clone(), wider.to_owned())))
    });
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_answered_nothing_is_not_told_again_of_what_comes_after_a_drive() {
        let row = |who: &str, when: &str| Exclusion {
            who: who.to_owned(),
            what: "questionnaires".to_owned(),
            why: format!("participant {who} answered no questionnaire{when}"),
        };
        let after = " after a drive";
        let rows = vec![row("P1", ""), row("P1", after), row("P2", after)];
        assert_eq!(without_narrower(rows), [row("P1", ""), row("P2", after)]);
    }

    #[test]
    fn sheets_that_both_tables_have_are_told_once_and_others_of_the_same_score_twice() {
        let row = |scale: &str, n: usize, mean: f64| score::Reliability {
            scale: scale.to_owned(),
            subscale: "total".to_owned(),
            items: 3,
            n,
            dropped: 1,
            people: None,
            alpha: None,
            ci_low: None,
            ci_high: None,
            omega: None,
            mean: Some(mean),
            sd: None,
            floor: 0,
            ceiling: 0,
            item: Vec::new(),
        };
        let after = [row("comfort", 103, 4.5), row("trust", 103, 4.0)];
        let all = vec![row("comfort", 103, 4.5), row("trust", 26, 4.2)];
        let told: Vec<String> = not_among(all, &after).map(|row| row.scale).collect();
        assert_eq!(told, ["trust"]);
    }
}

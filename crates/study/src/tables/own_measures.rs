//! The measures that a study brings along: its own table, read whole or refused by row and column; and their means, a row each.

use super::{Table, surveys::occasions};
use crate::{design::DesignFile, error::StudyError, once::names};
use maveric_domain::{
    ConditionId, Occasion, OwnMeasurement, ParticipantId, Ride,
    design::{ABOUT_A_ROW, DesignError},
    nearest,
    occasion::{OCCASION, is_first},
};
use maveric_measures::objective;
use path_slash::PathExt as _;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// A study's own measures as its table gives them.
#[derive(Debug, Clone, Default)]
pub struct OwnMeasures {
    /// Means over sessions and trials, by person, condition and the order of the design; where the design has several sessions, over the
    /// trials of the first.
    pub measurements: Vec<OwnMeasurement>,
    /// Of whom and of which condition there is a row, be its cells empty or not.
    pub(crate) rows: BTreeSet<(ParticipantId, ConditionId)>,
    /// Columns that no `[[measure]]` declares: they are not read.
    pub undeclared: Vec<String>,
    /// Rows of later sessions, which are in no mean.
    pub later: usize,
}

/// Reads the table of a design's own measures; none where it declares none, or the table is not there yet. Where there is a table of
/// people, whoever is not in it is refused.
///
/// # Errors
/// [`StudyError`] for a declared id that is one of ours, and naming the table with row and column for a person or a condition that the study does
/// not know, two rows for one value, a cell that is no number, or a declared measure without a column.
pub fn read_own_measures(
    study: &DesignFile,
    participants: Option<&Path>,
) -> Result<Option<OwnMeasures>, StudyError> {
    read_of_rides(study, participants, &|_, _| true)
}

/// As [`read_own_measures`]; of a design with several sessions or rides in a condition, the means are over those rides of somebody that it
/// `keeps`.
pub(crate) fn read_of_rides(
    study: &DesignFile,
    participants: Option<&Path>,
    keeps: &dyn Fn(&ParticipantId, Ride) -> bool,
) -> Result<Option<OwnMeasures>, StudyError> {
    refuse_ours(study)?;
    let path = study.resolve(&study.design.files().measures);
    if study.design.measures().is_empty() || !path.exists() {
        return Ok(None);
    }
    let table = Table::read(&path)?;
    let people = known_people(study, participants, &table)?;
    let conditions = known_conditions(study, &table)?;
    one_row_each(&table)?;
    let cells: Vec<(ParticipantId, ConditionId)> = people.into_iter().zip(conditions).collect();
    let on = if study.design.repeats() {
        occasions(&table)?
    } else {
        vec![Occasion::default(); cells.len()]
    };
    // Of a study that declares its sessions, the first is compared.
    let sessions = study.design.protocol().session_count();
    let is_later = |on: &Occasion| sessions > 1 && !is_first(&on.session);
    let counts = cells.iter().zip(&on).map(|((who, condition), on)| {
        let ride = Ride { condition: *condition, occasion: *on };
        !is_later(on) && (!study.design.repeats() || keeps(who, ride))
    });
    let counts: Vec<bool> = counts.collect();
    let mut means: BTreeMap<(ParticipantId, ConditionId), Vec<OwnMeasurement>> = BTreeMap::new();
    for measure in study.design.measures() {
        let mut sums: BTreeMap<&(ParticipantId, ConditionId), (f64, usize)> = BTreeMap::new();
        let values = table.numbers(&measure.id)?;
        for ((cell, value), counts) in cells.iter().zip(values).zip(&counts) {
            let Some(value) = value.filter(|_| *counts) else {
                continue;
            };
            let (sum, n) = sums.entry(cell).or_default();
            (*sum, *n) = (*sum + value, *n + 1);
        }
        for (cell, (sum, n)) in sums {
            means.entry(cell.clone()).or_default().push(OwnMeasurement {
                participant: cell.0.clone(),
                condition: cell.1,
                measure: measure.id.clone(),
                value: sum / n as f64,
                n,
            });
        }
    }
    let declared = |column: &String| study.design.measure(column).is_some();
    let mut undeclared = table.columns();
    undeclared.retain(|column| !declared(column) && !ABOUT_A_ROW.contains(&column.as_str()));
    Ok(Some(OwnMeasures {
        measurements: means.into_values().flatten().collect(),
        rows: cells.into_iter().collect(),
        undeclared,
        later: on.iter().filter(|on| is_later(on)).count(),
    }))
}

pub(crate) fn read_own_measurements(path: &Path) -> Result<Vec<OwnMeasurement>, StudyError> {
    let table = Table::read(path)?;
    table.each_once(&["participant", "condition", "measure"])?;
    table.records()
}

/// Refuses an id that a measure of a drive has: nobody would know which of the two an outcome is.
fn refuse_ours(study: &DesignFile) -> Result<(), StudyError> {
    let ours = |id: &str| objective::find(id);
    let mut taken = study.design.measures().iter();
    let Some((id, ours)) = taken.find_map(|m| Some((&m.id, ours(&m.id)?))) else {
        return Ok(());
    };
    let error = DesignError::key(
        "measure.id",
        format!("`{id}`"),
        format!("another id: `{id}` is measured of every drive ({})", ours.title.to_lowercase()),
    );
    Err(study.wrong(error.to_string(), None))
}

fn known_people(
    study: &DesignFile,
    participants: Option<&Path>,
    table: &Table,
) -> Result<Vec<ParticipantId>, StudyError> {
    let ids: Vec<ParticipantId> = table.ids("participant")?;
    study.forgotten()?.refuse(table.path(), ids.iter())?;
    let list = study.people_file(participants);
    if participants.is_none() && !list.is_file() {
        return Ok(ids);
    }
    let people = study.people(participants)?;
    let enrolled = people.enrolled;
    // That nobody takes part then is for the gate to say.
    if enrolled.is_empty() {
        return Ok(ids);
    }
    let known: BTreeSet<&ParticipantId> = enrolled.iter().map(|p| &p.id).collect();
    let Some(row) = ids.iter().position(|id| !known.contains(id)) else {
        return Ok(ids);
    };
    let people: Vec<&str> = enrolled.iter().map(|p| p.id.as_str()).collect();
    let stranger = ids[row].as_str();
    let meant = nearest(stranger, people.iter().copied());
    let meant = meant.map_or_else(String::new, |n| format!("; did you mean `{n}`?"));
    let expected = format!("a person of {}: {}{meant}", list.to_slash_lossy(), names(&people));
    Err(table.bad_cell(row, "participant", stranger, expected))
}

/// In which condition each row is.
///
/// # Errors
/// [`StudyError::BadCell`] for one that the study does not know.
pub(crate) fn known_conditions(
    study: &DesignFile,
    table: &Table,
) -> Result<Vec<ConditionId>, StudyError> {
    let words = table.text("condition")?;
    let condition = |(row, word): (usize, Option<String>)| {
        let word = word.unwrap_or_default();
        let id = word.trim().parse().ok();
        id.filter(|id| study.design.knows(*id)).ok_or_else(|| {
            let labels = ConditionId::listed(&study.design.labels());
            let expected = format!("a condition of the study: {labels}");
            table.bad_cell(row, "condition", word, expected)
        })
    };
    words.into_iter().enumerate().map(condition).collect()
}

/// Refuses a second source of one value: two rows of one person and condition that no session or trial tells apart.
fn one_row_each(table: &Table) -> Result<(), StudyError> {
    let mut keys = ABOUT_A_ROW.to_vec();
    keys.retain(|key| table.has(key));
    table.each_once(&keys).map_err(|mut error| {
        let told_apart = keys.iter().any(|key| OCCASION.contains(key));
        if let StudyError::BadCell { expected, .. } = &mut error
            && !told_apart
        {
            expected.push_str(
                "; several are averaged where a column `session` or `trial` tells them apart",
            );
        }
        error
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const STUDY: &str = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n\
                         [[measure]]\nid = \"tor_s\"\nunit = \"s\"\n[[measure]]\nid = \"glances\"\nunit = \"1\"\n";

    /// A study with this table of own measures.
    fn study(design: &str, table: &str) -> (tempfile::TempDir, DesignFile) {
        let folder = tempfile::tempdir().unwrap();
        let write =
            |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("study.toml", design);
        write("measures.csv", table);
        write("participants.csv", "participant\nP01\nP02\nP03\n");
        let study = DesignFile::read(&folder.path().join("study.toml")).unwrap();
        (folder, study)
    }

    fn read(design: &str, table: &str) -> Result<Option<OwnMeasures>, StudyError> {
        let (_folder, study) = study(design, table);
        read_own_measures(&study, None)
    }

    fn refused(table: &str) -> String {
        read(STUDY, table).unwrap_err().to_string()
    }

    #[test]
    fn sessions_and_trials_are_averaged_and_counted_and_an_empty_cell_counts_for_nothing() {
        let own = read(
            STUDY,
            "participant,condition,session,trial,tor_s,glances,rater\n\
             P01,calm,1,1,2.0,4,x\nP01,calm,1,2,3.0,,x\nP01,calm,2,1,7.0,6,x\nP02,sporty,1,1,,1,y\n",
        );
        let own = own.unwrap().unwrap();
        let rows: Vec<(&str, &str, &str, f64, usize)> = own
            .measurements
            .iter()
            .map(|m| {
                let (who, which) = (m.participant.as_str(), m.condition.as_str());
                (who, which, m.measure.as_str(), m.value, m.n)
            })
            .collect();
        assert_eq!(
            rows,
            [
                ("P01", "calm", "tor_s", 4.0, 3),
                ("P01", "calm", "glances", 5.0, 2),
                ("P02", "sporty", "glances", 1.0, 1),
            ]
        );
        assert_eq!((own.rows.len(), own.undeclared), (2, vec!["rater".to_owned()]));
    }

    #[test]
    fn a_ride_that_is_not_kept_is_in_no_mean_of_several() {
        let design = format!("{STUDY}[protocol]\nrides_per_condition = 2\n");
        let table = "participant,condition,trial,tor_s,glances\nP01,calm,1,2.0,\nP01,calm,2,3.0,\n";
        let (_folder, study) = study(&design, table);
        let mean_without = |left_out: u32| {
            let keeps = |_: &ParticipantId, ride: Ride| ride.occasion.trial.get() != left_out;
            let own = read_of_rides(&study, None, &keeps).unwrap().unwrap();
            let means = own.measurements.iter().map(|m| (m.value, m.n));
            means.collect::<Vec<_>>()
        };
        assert_eq!(mean_without(1), [(3.0, 1)]);
        assert_eq!(mean_without(3), [(2.5, 2)]);
    }

    #[test]
    fn what_is_wrong_is_named_by_row_column_what_was_found_and_what_would_be_possible() {
        let head = "participant,condition,tor_s,glances\n";
        for (rows, words) in [
            (
                "P01,calm,1,1\nP04,calm,1,1\n",
                &[
                    "row 2, column `participant`",
                    "found `P04`",
                    "participants.csv: P01, P02, P03",
                    "did you mean",
                ][..],
            ),
            ("P01,own,1,1\n", &["row 1, column `condition`", "found `own`", "calm, sporty"]),
            (
                "P01,calm,1,1\nP02,calm,fast,1\n",
                &["row 2, column `tor_s`", "found `fast`", "a finite number"],
            ),
            (
                "P01,calm,1,1\nP02,calm,1,1\nP01,calm,2,2\n",
                &[
                    "row 3",
                    "`participant`, `condition`",
                    "found `P01, calm`",
                    "row 1 says so already",
                    "`session` or `trial`",
                ],
            ),
        ] {
            let error = refused(&format!("{head}{rows}"));
            assert!(error.contains("measures.csv"), "{error}");
            for word in words {
                assert!(error.contains(word), "no {word} in {error}");
            }
        }
        let twice =
            refused("participant,condition,trial,tor_s,glances\nP01,calm,1,1,1\nP01,calm,1,2,1\n");
        assert!(twice.contains("found `P01, calm, 1`") && !twice.contains("averaged"), "{twice}");
        let without = refused("participant,condition,tor_s\nP01,calm,1\n");
        assert!(without.contains("no column `glances`"), "{without}");
        let column = refused("participant,condition,tor_s,glances,tor_s\nP01,calm,1,1,2\n");
        assert!(column.contains("`tor_s` twice: columns 3 and 5"), "{column}");
    }

    #[test]
    fn an_id_of_ours_is_refused_and_a_table_that_is_not_there_yet_is_not() {
        let ours = STUDY.replace("tor_s", "lane_changes");
        let error = read(&ours, "participant\n").unwrap_err().to_string();
        assert!(
            error.contains("study.toml") && error.contains("`measure.id`: found `lane_changes`"),
            "{error}"
        );
        let (folder, before) = study(STUDY, "");
        std::fs::remove_file(folder.path().join("measures.csv")).unwrap();
        assert!(read_own_measures(&before, None).unwrap().is_none());
        let none = STUDY.split("[[measure]]").next().unwrap();
        assert!(read(none, "anything\n1\n").unwrap().is_none());
    }
}

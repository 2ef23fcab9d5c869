//! The drives among the results of a study, and why others are not.

use super::Cell;
use crate::{
    atomic_write::if_there,
    beyond::turned_for,
    error::StudyError,
    run_folder::lists,
    tables::{
        Table, conditions::read_conditions, drives::ExclusionRow, embeddings::read_embeddings,
        read_rows,
    },
};
use maveric_analysis::{LeftOut, Rule};
use maveric_domain::{Design, DriveMeta, ParticipantId};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// The drives among the results.
#[derive(Default)]
pub(super) struct Drives {
    pub(super) made: BTreeSet<Cell>,
    /// Those that a rule left out, with the reason.
    pub(super) kept_out: BTreeMap<Cell, String>,
    /// Logs that could not be ingested, by their names.
    pub(super) failed: BTreeMap<String, String>,
    /// For whom `steer` did not turn the dial.
    pub(super) not_turned: BTreeSet<ParticipantId>,
}

impl Drives {
    pub(super) fn read(
        results: &Path,
        design: &Design,
        left_out: &LeftOut,
    ) -> Result<Self, StudyError> {
        let mut drives = Self { not_turned: not_turned(results, design)?, ..Self::default() };
        for list in lists(results) {
            let listed: Vec<DriveMeta> = read_rows(&list)?;
            let cell = |m: &DriveMeta| (m.participant.clone(), m.ride());
            drives.made.extend(listed.iter().map(cell));
            let path = list.with_file_name("exclusions.csv");
            if !path.is_file() {
                continue;
            }
            let table = Table::read(&path)?;
            // Other stages list their exclusions in fewer columns.
            if !table.has("rule") {
                continue;
            }
            for row in table.records::<ExclusionRow>()? {
                if !row.participant.is_empty() {
                    let cell = (ParticipantId::new(&row.participant)?, row.ride()?);
                    if !is_taken_back(&row, &cell, left_out) {
                        drives.kept_out.insert(cell, row.what);
                    }
                } else if row.drive.is_empty() {
                    drives.failed.insert(row.log, row.what);
                }
            }
        }
        Ok(drives)
    }
}

/// Whether a drive was left out by a rule that names it, as the design or the list of stopped rides no longer does.
fn is_taken_back(row: &ExclusionRow, (who, ride): &Cell, left_out: &LeftOut) -> bool {
    let by_name = Rule::BY_NAME.iter().any(|rule| rule.key() == row.rule);
    let mut named = left_out.drives.keys();
    by_name && left_out.keeps(who, *ride) && !named.any(|drive| drive.as_str() == row.drive)
}

/// For whom `steer` did not turn the dial, of those whom it has looked at.
fn not_turned(results: &Path, design: &Design) -> Result<BTreeSet<ParticipantId>, StudyError> {
    let conditions = results.join("conditions.csv");
    if !conditions.is_file() {
        return Ok(BTreeSet::new());
    }
    let conditions = read_conditions(&conditions)?;
    let rows = if_there(&results.join("embeddings.csv"), read_embeddings)?;
    let strangers = turned_for(&rows, &conditions, design).into_iter();
    let not_turned = strangers.filter(|(_, turned)| !turned);
    Ok(not_turned.map(|(who, _)| who).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_that_a_rule_kept_out_waits_for_its_log_once_the_rule_is_taken_back() {
        let row = |rule: &str| ExclusionRow {
            drive: "log-7".to_owned(),
            rule: rule.to_owned(),
            ..ExclusionRow::default()
        };
        let cell = (ParticipantId::new("P1").unwrap(), "calm".parse().unwrap());
        let taken_back = |rule: &str, exclude: &str| {
            let text = format!(
                "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[exclude]\n{exclude}"
            );
            let named = LeftOut::named(&Design::from_toml(&text).unwrap());
            is_taken_back(&row(rule), &cell, &named)
        };
        assert!(taken_back("exclude.drives", ""));
        assert!(taken_back("exclude.people", "people = { P2 = \"sick\" }\n"));
        for (rule, exclude) in [
            ("exclude.drives", "drives = { P1-calm = \"sick\" }\n"),
            ("exclude.drives", "drives = { log-7 = \"sick\" }\n"),
            ("exclude.people", "people = { P1 = \"sick\" }\n"),
            ("exclude.drive_shorter_than_s", ""),
        ] {
            assert!(!taken_back(rule, exclude), "{rule} {exclude}");
        }
    }

    #[test]
    fn for_whom_the_dial_was_not_turned_is_known_once_conditions_are_placed() {
        let design = Design::from_toml(
            "[study]\ntitle = \"t\"\n[people]\nlearn = { part = \"learn\" }\n[style]\nscore = \"adb.total\"\npoints = 15\n\
             [baseline]\nid = \"own\"\n[[condition]]\nid = \"mine\"\ncar = { dial = 0 }\n[[condition]]\nid = \"sporty\"\ncar = { dial = \"+1\" }\n",
        )
        .unwrap();
        let results = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(results.path().join(name), text);
        let of = || {
            let people = not_turned(results.path(), &design).unwrap().into_iter();
            people.map(|who| who.to_string()).collect::<Vec<_>>()
        };
        write(
            "embeddings.csv",
            "drive,participant,condition,adb_used,adb,adb_hat,line_position,readings,beyond_why,w1\n\
             P1-own,P1,own,false,,30,0.1,9,scale,0.5\nP2-own,P2,own,false,,30,0.1,9,,0.5\n",
        )
        .unwrap();
        assert!(of().is_empty());
        let header = "participant,condition,adb_hat,moved_points,moved_points_sd,clamped,angle_rad,beyond_training,beyond_why,w1\n";
        let placed =
            |who: &str, condition: &str| format!("{who},{condition},30,0,,false,,false,,0.5\n");
        let mine = header.to_owned() + &placed("P1", "mine") + &placed("P2", "mine");
        write("conditions.csv", &mine).unwrap();
        assert_eq!(of(), ["P1"]);
        write("conditions.csv", &(mine + &placed("P1", "sporty"))).unwrap();
        assert!(of().is_empty());
    }
}

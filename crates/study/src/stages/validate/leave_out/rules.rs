//! What is computed, table by table: from a file of rules, or from the roles of a design.

use crate::{
    atomic_write::read_text,
    deciding::hash_of,
    error::StudyError,
    recordings::{Recorded, Recordings},
};
use maveric_domain::{ConditionId, ParticipantId};
use maveric_rehearsal::leave_out::Drove;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::Path};

/// How often roles are exchanged where nothing says otherwise.
const PERMUTATIONS: usize = 1000;

/// Which part of the recordings a table opens.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// What may be looked at while the method is made
    #[default]
    Development,
    /// What is opened once
    Test,
}

/// What a table asks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Asks {
    /// Is one role's drive above the others of its driver?
    #[default]
    Order,
    /// Does the dial point where the driver's own drives of two roles differ?
    Direction,
    /// Whose drive is it?
    Identity,
    /// How alike are two drives in one role?
    Retest,
    /// Do standard errors hold?
    Errors,
    /// What does a model say that was learned elsewhere?
    Shipped,
}

/// All tables.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rules {
    /// What heads the page.
    pub title: String,
    /// Where the recordings are from, and how they are cited.
    #[serde(default)]
    pub source: Option<String>,
    /// In which order people drove.
    #[serde(default)]
    pub order_of_drives: Option<String>,
    /// How often roles are exchanged.
    #[serde(default = "permutations")]
    pub permutations: usize,
    /// The tables, in the order of the page.
    #[serde(rename = "table")]
    pub tables: Vec<Table>,
}

fn permutations() -> usize {
    PERMUTATIONS
}

/// A question to people who are left out in turn, and the drives that answer it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// What the page, its files and its warnings call it.
    pub id: String,
    /// What it asks.
    pub asks: Asks,
    /// Which part it opens.
    #[serde(default)]
    pub part: Part,
    /// Whether its numbers were seen while the method was made: no verdict rests on them then.
    #[serde(default)]
    pub seen: bool,
    /// Whose drives it reads; everybody's where there are none.
    #[serde(default)]
    pub people: Vec<ParticipantId>,
    /// Of whom it counts; all of them where there are none.
    #[serde(default)]
    pub judged: Vec<ParticipantId>,
    /// The roles that are learned from.
    pub learn: Vec<ConditionId>,
    /// Roles that are read as well.
    #[serde(default)]
    pub read: Vec<ConditionId>,
    /// Of an order or a direction: the role that has to be higher.
    #[serde(default)]
    pub higher: Option<ConditionId>,
    /// The roles that it has to be above.
    #[serde(default)]
    pub lower: Vec<ConditionId>,
    /// Of identity: the role that stands for everybody.
    #[serde(default)]
    pub among: Option<ConditionId>,
    /// The role whose driver is looked for.
    #[serde(default)]
    pub sought: Option<ConditionId>,
    /// Of two drives: their role.
    #[serde(default)]
    pub role: Option<ConditionId>,
    /// Of a direction: how far the dial is turned, in points.
    #[serde(default)]
    pub points: Option<f64>,
    /// Directions that are drawn beside it.
    #[serde(default)]
    pub directions: Option<usize>,
    /// The statistic, in words.
    #[serde(default)]
    pub statistic: Option<String>,
    /// The level of its test.
    #[serde(default)]
    pub threshold: Option<f64>,
}

impl Table {
    /// Every role whose drives it reads.
    pub fn roles(&self) -> impl Iterator<Item = ConditionId> {
        self.learn.iter().chain(&self.read).copied()
    }

    /// The recordings that it reads.
    pub(super) fn reads<'a>(&self, recordings: &'a Recordings) -> Vec<&'a Recorded> {
        let is_of = |r: &&Recorded| {
            let meta = r.drive.meta();
            let of_people = self.people.is_empty() || self.people.contains(&meta.participant);
            of_people && self.roles().any(|role| role == meta.condition)
        };
        recordings.rows.iter().filter(is_of).collect()
    }
}

impl Rules {
    /// Reads a file of rules and checks that every table says what it needs; gives its hash as well.
    ///
    /// # Errors
    /// [`StudyError::BadFile`] naming the file, the table and the key.
    pub fn read(path: &Path) -> Result<(Self, String), StudyError> {
        let text = read_text(path)?;
        let rules: Self = toml::from_str(&text)
            .map_err(|e| StudyError::file(path, format!("not a file of rules: {e}")))?;
        for table in &rules.tables {
            if let Some(key) = table.missing() {
                return Err(StudyError::file(
                    path,
                    format!("table `{}` has no `{key}`, which it needs", table.id),
                ));
            }
            // Every verdict has its level of .05.
            if table.threshold.is_some_and(|t| (t - 0.05).abs() > 1e-12) {
                return Err(StudyError::file(
                    path,
                    format!("table `{}`: `threshold` has to be 0.05", table.id),
                ));
            }
        }
        Ok((rules, hash_of(text.as_bytes())))
    }

    /// The tables that follow from the roles that were driven: the role of the highest score above all others; whose drive it is; and
    /// how alike two drives are. The last two are of roles that somebody drove twice; without any, the driver of the highest role is
    /// looked for among the drives of the lowest. `learn` are the labels of the drives, repeats of a role among them.
    ///
    /// # Errors
    /// [`StudyError::NotPossible`] where no two roles differ in their score.
    pub(super) fn of_roles(
        title: &str,
        drives: &[Drove],
        learn: &[ConditionId],
    ) -> Result<Self, StudyError> {
        let mut points: BTreeMap<ConditionId, Vec<f64>> = BTreeMap::new();
        let mut twice: BTreeMap<(ConditionId, &ParticipantId), usize> = BTreeMap::new();
        for drive in drives {
            points.entry(drive.role).or_default().extend(drive.points);
            *twice.entry((drive.role, &drive.participant)).or_default() += 1;
        }
        let mut scored: Vec<(ConditionId, f64)> = points
            .into_iter()
            .filter_map(|(role, points)| Some((role, crate::mean::mean(&points)?)))
            .collect();
        scored.sort_by(|a, b| b.1.total_cmp(&a.1));
        let (&(higher, most), others) = scored.split_first().ok_or_else(no_roles)?;
        let lower: Vec<ConditionId> = others
            .iter()
            .filter(|(_, points)| *points < most)
            .map(|(role, _)| *role)
            .collect();
        let Some(&lowest) = lower.last() else {
            return Err(no_roles());
        };
        let table = |id: String, asks| Table {
            id,
            asks,
            learn: learn.to_vec(),
            ..Table::default()
        };
        let mut tables = vec![Table {
            higher: Some(higher),
            lower,
            ..table("order".to_owned(), Asks::Order)
        }];
        let mut repeated: Vec<ConditionId> = twice
            .into_iter()
            .filter(|(_, drives)| *drives > 1)
            .map(|((role, _), _)| role)
            .collect();
        repeated.dedup();
        if repeated.is_empty() {
            tables.push(Table {
                among: Some(lowest),
                sought: Some(higher),
                ..table("identity".to_owned(), Asks::Identity)
            });
        }
        for role in repeated {
            tables.push(Table {
                among: Some(role),
                sought: Some(role),
                ..table(format!("identity-{role}"), Asks::Identity)
            });
            for (name, asks) in [("retest", Asks::Retest), ("errors", Asks::Errors)] {
                tables.push(Table {
                    role: Some(role),
                    ..table(format!("{name}-{role}"), asks)
                });
            }
        }
        Ok(Self {
            title: title.to_owned(),
            source: None,
            order_of_drives: None,
            permutations: PERMUTATIONS,
            tables,
        })
    }
}

impl Table {
    /// The first key that it lacks.
    fn missing(&self) -> Option<&'static str> {
        let needed = match self.asks {
            Asks::Order | Asks::Shipped => &["higher", "lower"][..],
            Asks::Direction => &["higher", "lower", "points", "directions"],
            Asks::Identity => &["among", "sought"],
            Asks::Retest | Asks::Errors => &["role"],
        };
        let lacks = |key: &str| match key {
            "higher" => self.higher.is_none(),
            "lower" => self.lower.is_empty(),
            "points" => self.points.is_none(),
            "directions" => self.directions.is_none(),
            "among" => self.among.is_none(),
            "sought" => self.sought.is_none(),
            _ => self.role.is_none(),
        };
        needed.iter().copied().find(|key| lacks(key))
    }
}

fn no_roles() -> StudyError {
    let problem = "no two roles were driven whose scores differ, so no order can be asked for";
    let help = "give the roles of the design scores ([[role]] score = 47), or the drivers' own in scores.csv, and record each person in two of them";
    StudyError::not_possible(problem).with_help(help)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::DriveId;

    fn drove(who: &str, role: &str, points: impl Into<Option<f64>>) -> Drove {
        Drove {
            drive: DriveId::new(format!("{who}-{role}")).unwrap(),
            participant: ParticipantId::new(who).unwrap(),
            role: role.parse().unwrap(),
            points: points.into(),
            speed_mps: None,
            time_gap_s: None,
        }
    }

    #[test]
    fn a_design_with_three_roles_asks_for_the_highest_of_all_and_a_role_driven_twice_for_more() {
        let drives = [
            drove("A", "drowsy", 20.0),
            drove("A", "sporty", 47.0),
            drove("A", "own", 33.0),
            drove("B", "own", 33.0),
            drove("B", "own", 31.0),
        ];
        let rules = Rules::of_roles("x", &drives, &[]).unwrap();
        let ids: Vec<&str> = rules.tables.iter().map(|t| t.id.as_str()).collect();
        assert_eq!(ids, ["order", "identity-own", "retest-own", "errors-own"]);
        let words = |roles: &[ConditionId]| ConditionId::listed(roles);
        assert_eq!(rules.tables[0].higher.unwrap().as_str(), "sporty");
        assert_eq!(words(&rules.tables[0].lower), "own, drowsy");
        let once = Rules::of_roles("x", &drives[..4], &[]).unwrap();
        let identity = &once.tables[1];
        let pair = (identity.among.unwrap(), identity.sought.unwrap());
        assert_eq!((pair.0.as_str(), pair.1.as_str()), ("drowsy", "sporty"));
        assert!(rules.tables.iter().all(|t| t.missing().is_none()));
    }

    #[test]
    fn roles_of_one_score_or_none_are_refused() {
        for points in [Some(30.0), None] {
            let drives = [drove("A", "own", points), drove("A", "sporty", points)];
            let said = Rules::of_roles("x", &drives, &[]).unwrap_err();
            assert!(said.to_string().contains("no two roles"), "{said}");
            assert!(said.suggestion().unwrap().contains("score = 47"));
        }
    }

    #[test]
    fn a_file_of_rules_names_the_table_and_the_key_that_it_lacks() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rules.toml");
        let read = |table: &str| {
            std::fs::write(
                &path,
                format!("title = \"x\"\n[[table]]\nid = \"a\"\n{table}"),
            )
            .unwrap();
            Rules::read(&path)
        };
        let said = read("asks = \"order\"\nlearn = [\"own\"]\n")
            .unwrap_err()
            .to_string();
        assert!(
            said.contains("rules.toml: table `a` has no `higher`"),
            "{said}"
        );
        let said = read("asks = \"retest\"\nlearn = [\"own\"]\nrole = \"own\"\nthreshold = 0.1\n");
        assert!(said.unwrap_err().to_string().contains("0.05"));
        let said = read("asks = \"guess\"\nlearn = []\n")
            .unwrap_err()
            .to_string();
        assert!(said.contains("guess"), "{said}");
        let (rules, hash) = read("asks = \"retest\"\nlearn = [\"own\"]\nrole = \"own\"\n").unwrap();
        assert_eq!((rules.permutations, hash.len()), (PERMUTATIONS, 64));
    }
}

//! `validate --leave-out people`: a study's own recordings, learned in turn from everybody but one.

mod answer;
mod direction;
mod elsewhere;
mod folds;
mod of_roles;
mod page;
mod tables;
#[cfg(test)]
mod tests;

pub use answer::Answer;

use super::{Validate, write};
use crate::{
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch},
    recordings::{self, Recorded, Recordings},
    stages::report::write_page,
};
use answer::findings_of;
use folds::{Fold, Learning, styles};
use maveric_analysis::Finding;
use maveric_domain::{
    ConditionId, DrivenBy,
    design::{Asks, ValidateTable},
};
use maveric_measures::objective;
use maveric_model::{HeadsKind, TrainSettings};
use maveric_rehearsal::leave_out::{
    Asked, Drove, Order, Repeated, errors_that_hold, order, people, retest, whose,
};
use of_roles::tables_of_roles;
use path_slash::PathExt as _;
use serde::Serialize;

/// How often roles are exchanged where nothing says otherwise.
const PERMUTATIONS: usize = 1000;

/// What was found of people who were left out in turn.
#[derive(Debug, Clone, Serialize)]
pub struct InTurn {
    /// Whether the drivers are made up.
    pub synthetic: bool,
    pub heads: HeadsKind,
    /// People with a drive in a role.
    pub people: usize,
    /// Drives that were read, in any role.
    pub drives: usize,
    /// The tables, in the order of the page.
    pub tables: Vec<Answered>,
    /// What became of the questions, over all tables that had not been seen before.
    pub findings: Vec<Finding>,
}

impl InTurn {
    /// How many people a table is about.
    fn people_of(&self, table: &ValidateTable) -> usize {
        if table.people.is_empty() { self.people } else { table.people.len() }
    }
}

/// A table with its answer.
#[derive(Debug, Clone, Serialize)]
pub struct Answered {
    pub asked: ValidateTable,
    /// What was found; none where it cannot be answered.
    pub answer: Option<Answer>,
    pub unanswered: Option<String>,
}

/// Leaves people out in turn; writes `validation.json`, `validation.md` and a page with the tables.
pub(super) fn work(options: &Validate, watch: Watch<'_>) -> Result<Outcome<InTurn>, StudyError> {
    let study = DesignFile::find(options.design.as_deref())?;
    let mut warnings = Vec::new();
    let scores = options.run.join("scores.csv");
    let files = (&*options.run.join("drives"), scores.is_file().then_some(&*scores));
    let recordings = recordings::read(&study, files, &mut warnings)?;
    let declared = study.design.validate();
    let mut asked = declared.tables.clone();
    if asked.is_empty() {
        asked = tables_of_roles(&recordings.drove())?;
    }
    for table in asked.iter_mut().filter(|t| t.learn.is_empty()) {
        table.learn = recordings.labels();
    }
    let settings = TrainSettings { heads: options.heads, ..TrainSettings::default() };
    let mut tables = Vec::new();
    for table in asked {
        watch.check()?;
        let bench = Bench {
            options,
            permutations: declared.permutations.unwrap_or(PERMUTATIONS),
            table: &table,
            recordings: &recordings,
            settings: &settings,
        };
        let (answer, unanswered) = match bench.answer(watch)? {
            Ok(answer) => (Some(answer), None),
            Err(why) => (None, Some(why)),
        };
        warnings.extend(unanswered.iter().map(|why| format!("{}: {why}", table.id)));
        warnings.extend(answer.iter().flat_map(|a| a.warnings(&table.id)));
        tables.push(Answered { asked: table, answer, unanswered });
    }
    warnings.dedup();
    let judged = tables.iter().filter(|t| !t.asked.seen);
    let judged: Vec<&Answer> = judged.filter_map(|t| t.answer.as_ref()).collect();
    let value = InTurn {
        findings: findings_of(&judged),
        synthetic: recordings.rows.iter().any(|r| r.drive.meta().driven_by == DrivenBy::Synthetic),
        heads: options.heads,
        people: people(&recordings.drove()).len(),
        drives: recordings.rows.len(),
        tables,
    };
    let printed = tables::tables(&value, &study.design)?;
    let tables = printed.iter().flat_map(|(_, tables)| tables);
    let mut summary = write(&options.out, tables, &value)?;
    let page = page::page(&value, options, &study, printed, &warnings)?;
    let page = write_page(&options.out, &page)?;
    summary.push(format!(
        "{} people, {} drives, each person left out in turn: {}",
        value.people,
        value.drives,
        page.to_slash_lossy()
    ));
    Ok(Outcome::new(value, summary, warnings))
}

/// One table and what it is answered with.
struct Bench<'a> {
    options: &'a Validate,
    /// How often roles are exchanged where the command does not say.
    permutations: usize,
    table: &'a ValidateTable,
    recordings: &'a Recordings,
    settings: &'a TrainSettings,
}

impl Bench<'_> {
    /// The answer, or why there is none.
    fn answer(&self, watch: Watch<'_>) -> Result<Result<Answer, String>, StudyError> {
        let table = self.table;
        let rows = reads(table, self.recordings);
        let mut drove: Vec<Drove> = rows.iter().map(|r| r.drove.clone()).collect();
        for (row, drove) in rows.iter().zip(&mut drove) {
            let label = row.drive.meta().condition;
            // Only what is learned from has points.
            if !table.learn.contains(&label) {
                drove.points = None;
            }
            // An order may be of the second drive in a role; whose a drive is, is asked of the role.
            if matches!(table.asks, Asks::Order | Asks::Direction | Asks::Shipped) {
                drove.role = label;
            }
        }
        let everybody = people(&drove);
        if let Err(why) = recordings::enough(everybody.len()) {
            return Ok(Err(why));
        }
        for role in [table.higher, table.among, table.sought, table.role]
            .into_iter()
            .flatten()
            .chain(table.lower.iter().copied())
        {
            if !drove.iter().any(|d| d.role == role) {
                return Ok(Err(format!("nobody drove in the role `{role}`")));
            }
        }
        if table.asks == Asks::Shipped {
            let shipped = elsewhere::said_of(self, &rows, &drove, watch)?;
            return Ok(shipped
                .map(Answer::Shipped)
                .ok_or_else(|| "no --model was given".to_owned()));
        }
        let learning = Learning {
            drives: rows.iter().map(|r| &r.drive).collect(),
            drove,
            learn: &table.learn,
            settings: self.settings,
            range: self.recordings.range,
            seed: self.options.seed,
            jobs: self.options.jobs,
            watch,
        };
        let points: Vec<Option<f64>> = learning.drove.iter().map(|d| d.points).collect();
        let folds = learning.folds(&points)?;
        Ok(match table.asks {
            Asks::Order => Ok(Answer::Order(self.order(&learning, &folds, watch)?)),
            Asks::Identity => {
                let (among, sought) = (table.among, table.sought);
                let (among, sought) = (role_of(among)?, role_of(sought)?);
                let identified = whose(&learning.drove, &styles(&folds), among, sought)?;
                Ok(Answer::Identity(identified))
            }
            Asks::Retest => {
                let lines = learning.lines(&folds, &points)?;
                let measured = measured(&rows);
                let role = role_of(table.role)?;
                let (measures, uncounted) = retest(&learning.drove, role, &measured, &lines)?;
                Ok(Answer::Retest { measures, uncounted })
            }
            Asks::Errors => {
                let prior = self.settings.heads == HeadsKind::Linear;
                let roles = [role_of(table.role)?];
                let share = errors_that_hold(&learning.drove, &styles(&folds), &roles, prior);
                Ok(Answer::Errors(share))
            }
            Asks::Direction => {
                let (found, uncounted) =
                    direction::pointing(self, &learning, &folds, &rows, watch)?;
                Ok(Answer::Direction { found, uncounted })
            }
            // Answered above, from no fold.
            Asks::Shipped => Err("no --model was given".to_owned()),
        })
    }

    fn order(
        &self,
        learning: &Learning<'_>,
        folds: &[Fold],
        watch: Watch<'_>,
    ) -> Result<Order, StudyError> {
        let roles = Asked { higher: role_of(self.table.higher)?, lower: self.table.lower.clone() };
        let wanted = self.options.permutations;
        // Networks see the score: each exchange of roles learns all of them again, which has to be asked for.
        let permutations = wanted.unwrap_or(match self.settings.heads {
            HeadsKind::Linear => self.permutations,
            HeadsKind::Paper => 0,
        });
        let mut done = 0;
        let mut read = |points: &[Option<f64>]| {
            watch.step(done.min(permutations), permutations, "exchanged roles")?;
            done += 1;
            learning.lines(folds, points)
        };
        order(&learning.drove, &roles, permutations, self.options.seed, &mut read)
    }
}

/// The recordings that a table reads.
fn reads<'a>(table: &ValidateTable, recordings: &'a Recordings) -> Vec<&'a Recorded> {
    let is_of = |r: &&Recorded| {
        let meta = r.drive.meta();
        let of_people = table.people.is_empty() || table.people.contains(&meta.participant);
        of_people && table.roles().any(|role| role == meta.condition)
    };
    recordings.rows.iter().filter(is_of).collect()
}

/// A role that the design was checked to name.
fn role_of(role: Option<ConditionId>) -> Result<ConditionId, StudyError> {
    role.ok_or_else(|| StudyError::not_possible("a table without the role that it asks about"))
}

/// What two drives are compared in: every measure, and the time gap over the whole drive.
fn measured(rows: &[&Recorded]) -> Vec<Repeated<'static>> {
    let repeated = |m: &'static objective::Measure| Repeated {
        name: m.name,
        title: m.title,
        unit: m.unit,
        values: rows.iter().map(|r| m.of(&r.drive)).collect(),
    };
    let mut measured: Vec<Repeated<'static>> = objective::all().iter().map(repeated).collect();
    measured.push(Repeated {
        name: "median_time_gap_s",
        title: "Median time gap",
        unit: "s",
        values: rows.iter().map(|r| r.drove.time_gap_s).collect(),
    });
    measured
}

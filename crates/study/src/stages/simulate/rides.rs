//! Which conditions are driven, how often, and what wanders in each.

use super::Simulate;
use crate::{
    design::DesignFile,
    error::StudyError,
    tables::{
        conditions::{ConditionRow, read_conditions},
        drives::refuse_foreign,
        variability::read_variability,
    },
};
use maveric_domain::{Design, DriveId, Occasion, Variability, design::Condition};
use std::collections::BTreeSet;

/// A condition in one session and trial.
pub(super) struct Ride<'a> {
    pub(super) row: &'a ConditionRow,
    pub(super) id: DriveId,
    pub(super) occasion: Occasion,
    pub(super) varying: Option<Variability>,
}

impl Simulate {
    /// The rows to drive: of a sweep all, since the design does not name them; of what it names, only what is not recorded elsewhere.
    pub(super) fn conditions_to_drive(
        &self,
        study: Option<&DesignFile>,
    ) -> Result<Vec<ConditionRow>, StudyError> {
        let mut conditions = read_conditions(&self.conditions)?;
        if let Some(study) = study {
            let simulated = |id| study.design.condition(id).is_some_and(Condition::simulated);
            conditions.retain(|row| row.sweep.is_some() || simulated(row.condition));
            if conditions.is_empty() {
                let problem = "holds no condition that the design lets the program drive";
                return Err(StudyError::file(&self.conditions, problem));
            }
        }
        Ok(conditions)
    }

    /// A ride of each condition in each session and trial, every one with a name of its own, and so in another world.
    pub(super) fn rides<'a>(
        &self,
        study: Option<&DesignFile>,
        conditions: &'a [ConditionRow],
    ) -> Result<Vec<Ride<'a>>, StudyError> {
        let varying = self.varying(study, conditions)?;
        let (mut rides, mut names) = (Vec::new(), BTreeSet::new());
        for (row, varying) in conditions.iter().zip(varying) {
            let occasions = match study {
                Some(study) if row.sweep.is_none() => study.design.occasions(row.condition),
                _ => vec![Occasion::FIRST],
            };
            for occasion in occasions {
                let id = row.drive_on(occasion)?;
                if !names.insert(id.clone()) {
                    let problem = format!("two rows are drive {id}, expected a name for each");
                    return Err(StudyError::file(&self.conditions, problem));
                }
                rides.push(Ride {
                    row,
                    id,
                    occasion,
                    varying,
                });
            }
        }
        refuse_foreign(&self.out.join("drives"), names.iter().map(DriveId::as_str))?;
        Ok(rides)
    }

    /// What wanders in each of `conditions`: as in the person's own drive where the design says so, nothing elsewhere.
    pub(super) fn varying(
        &self,
        study: Option<&DesignFile>,
        conditions: &[ConditionRow],
    ) -> Result<Vec<Option<Variability>>, StudyError> {
        let design = study.map(|s| &s.design);
        let varies = |row: &ConditionRow| {
            let condition = design.and_then(|d| d.condition(row.condition));
            row.sweep.is_none() && condition.is_some_and(|c| c.vary)
        };
        let Some(first) = conditions.iter().find(|row| varies(row)) else {
            return Ok(vec![None; conditions.len()]);
        };
        let Some(path) = &self.variability else {
            let problem = format!(
                "the car of condition {} varies, and nothing says how people's own drives do",
                first.condition
            );
            let help = "write it with `maveric personalize --variability FILE` and give it with --variability FILE";
            return Err(StudyError::not_possible(problem).with_help(help));
        };
        let known = read_variability(path)?;
        let baseline = design.and_then(Design::baseline_id);
        let variability = |row: &ConditionRow| {
            if !varies(row) {
                return Ok(None);
            }
            let by_hand = known
                .iter()
                .find(|k| k.participant == row.participant && Some(k.condition) == baseline);
            by_hand.map(|k| Some(k.variability())).ok_or_else(|| {
                let whose = &row.participant;
                StudyError::file(
                    path,
                    format!("has no row of the own drive of participant {whose}"),
                )
            })
        };
        conditions.iter().map(variability).collect()
    }
}

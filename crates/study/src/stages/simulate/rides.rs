//! Which conditions are driven, and how often.

use super::Simulate;
use crate::{
    design::DesignFile,
    error::StudyError,
    tables::{
        conditions::{ConditionRow, read_conditions},
        drives::refuse_foreign,
    },
};
use maveric_domain::{DriveId, Occasion, design::Condition};
use std::collections::BTreeSet;

/// A condition in one session and trial.
pub(super) struct Ride<'a> {
    pub(super) row: &'a ConditionRow,
    pub(super) id: DriveId,
    pub(super) occasion: Occasion,
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
        let (mut rides, mut names) = (Vec::new(), BTreeSet::new());
        for row in conditions {
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
                rides.push(Ride { row, id, occasion });
            }
        }
        refuse_foreign(&self.out.join("drives"), names.iter().map(DriveId::as_str))?;
        Ok(rides)
    }
}

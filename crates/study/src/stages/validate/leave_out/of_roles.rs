//! The tables that follow from the roles of a design.

use crate::error::StudyError;
use maveric_domain::{
    ConditionId, ParticipantId,
    design::{Asks, ValidateTable},
};
use maveric_rehearsal::leave_out::Drove;
use std::collections::BTreeMap;

/// The tables that follow from the roles that were driven: the role of the highest score above all others; whose drive it is; and
/// how alike two drives are. The last two are of roles that somebody drove twice; without any, the driver of the highest role is
/// looked for among the drives of the lowest.
///
/// # Errors
/// [`StudyError::NotPossible`] where no two roles differ in their score.
pub(super) fn tables_of_roles(drives: &[Drove]) -> Result<Vec<ValidateTable>, StudyError> {
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
    let lower: Vec<ConditionId> =
        others.iter().filter(|(_, points)| *points < most).map(|(role, _)| *role).collect();
    let Some(&lowest) = lower.last() else {
        return Err(no_roles());
    };
    let table = |id: String, asks| ValidateTable { id, asks, ..ValidateTable::default() };
    let mut tables = vec![ValidateTable {
        higher: Some(higher),
        lower,
        ..table("order".to_owned(), Asks::Order)
    }];
    let mut repeated: Vec<ConditionId> =
        twice.into_iter().filter(|(_, drives)| *drives > 1).map(|((role, _), _)| role).collect();
    repeated.dedup();
    if repeated.is_empty() {
        tables.push(ValidateTable {
            among: Some(lowest),
            sought: Some(higher),
            ..table("identity".to_owned(), Asks::Identity)
        });
    }
    for role in repeated {
        tables.push(ValidateTable {
            among: Some(role),
            sought: Some(role),
            ..table(format!("identity-{role}"), Asks::Identity)
        });
        for (name, asks) in [("retest", Asks::Retest), ("errors", Asks::Errors)] {
            tables
                .push(ValidateTable { role: Some(role), ..table(format!("{name}-{role}"), asks) });
        }
    }
    Ok(tables)
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
        let tables = tables_of_roles(&drives).unwrap();
        let ids: Vec<&str> = tables.iter().map(|t| t.id.as_str()).collect();
        assert_eq!(ids, ["order", "identity-own", "retest-own", "errors-own"]);
        let words = |roles: &[ConditionId]| ConditionId::listed(roles);
        assert_eq!(tables[0].higher.unwrap().as_str(), "sporty");
        assert_eq!(words(&tables[0].lower), "own, drowsy");
        let once = tables_of_roles(&drives[..4]).unwrap();
        let identity = &once[1];
        let pair = (identity.among.unwrap(), identity.sought.unwrap());
        assert_eq!((pair.0.as_str(), pair.1.as_str()), ("drowsy", "sporty"));
    }

    #[test]
    fn roles_of_one_score_or_none_are_refused() {
        for points in [Some(30.0), None] {
            let drives = [drove("A", "own", points), drove("A", "sporty", points)];
            let said = tables_of_roles(&drives).unwrap_err();
            assert!(said.to_string().contains("no two roles"), "{said}");
            assert!(said.suggestion().unwrap().contains("score = 47"));
        }
    }
}

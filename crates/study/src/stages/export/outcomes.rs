//! What was analysed, a row a person and condition, and a row a person.

use super::{people, pseudonym::Pseudonyms};
use crate::{
    error::StudyError,
    tables::{TableName, participants::Enrolled, write_rows},
};
use maveric_analysis::{Observed, StudyData, observed};
use maveric_domain::{ConditionId, Design, ParticipantId};
use std::path::Path;

/// A cell with the name of its column.
type Cell<T> = (String, Option<T>);

/// Writes `outcomes_long.csv` and `outcomes_wide.csv`, sorted by pseudonym; the outcomes that they hold.
pub(super) fn write(
    out: &Path,
    data: Option<&StudyData>,
    people: &[Enrolled],
    names: &Pseudonyms,
) -> Result<Vec<Observed>, StudyError> {
    let Some(data) = data else {
        return Ok(Vec::new());
    };
    let (observed, design) = (observed(data), &data.design);
    let mut rows: Vec<(ParticipantId, usize)> = (data.participants.iter().enumerate())
        .map(|(index, id)| (names.pseudonym(id), index))
        .collect();
    rows.sort();
    let of_person = |index: usize| {
        let person = people.iter().find(|p| p.id == data.participants[index]);
        let cell = |column: &str| {
            let cell = person.and_then(|p| people::cell(p, column));
            (column.to_owned(), cell)
        };
        let columns = design.tested_columns();
        columns.map(cell).collect::<Vec<Cell<String>>>()
    };
    let values = |index: usize, condition: ConditionId| {
        let value = |seen: &Observed| {
            let seen_there = seen.conditions.iter().find(|(c, _)| *c == condition);
            seen_there.and_then(|(_, values)| values[index])
        };
        let cell = |seen: &Observed| (seen.outcome.clone(), value(seen));
        observed.iter().map(cell).collect::<Vec<Cell<f64>>>()
    };
    let mut conditions: Vec<ConditionId> = Vec::new();
    for (condition, _) in observed.iter().flat_map(|seen| &seen.conditions) {
        if !conditions.contains(condition) {
            conditions.push(*condition);
        }
    }
    conditions.sort_by_key(|c| design.conditions().iter().position(|known| known.id == *c));
    let mut long = Vec::new();
    for (name, index) in &rows {
        for condition in &conditions {
            let cells = values(*index, *condition);
            if cells.iter().all(|(_, value)| value.is_none()) {
                continue;
            }
            let key = (("participant", name), ("condition", condition.to_string()));
            long.push((key, levels(design, *condition), of_person(*index), cells));
        }
    }
    write_rows(TableName::OutcomesLong, &out.join("outcomes_long.csv"), long)?;
    let wide = rows.iter().map(|(name, index)| {
        let cells = observed.iter().flat_map(|seen| {
            let one = |(c, values): &(ConditionId, Vec<Option<f64>>)| {
                (wide_column(seen, *c), values[*index])
            };
            seen.conditions.iter().map(one)
        });
        (("participant", name), of_person(*index), cells.collect::<Vec<Cell<f64>>>())
    });
    write_rows(TableName::OutcomesWide, &out.join("outcomes_wide.csv"), wide)?;
    Ok(observed)
}

fn wide_column(seen: &Observed, condition: ConditionId) -> String {
    format!("{}.{condition}", seen.outcome)
}

/// The columns of the wide table that hold the first outcome with values in several conditions: a drive by hand is none of them.
pub(super) fn compared(design: &Design, observed: &[Observed]) -> Option<Vec<String>> {
    let columns = |seen: &Observed| -> Vec<String> {
        let compared = seen.conditions.iter().filter(|(condition, values)| {
            design.condition(*condition).is_some() && values.iter().any(Option::is_some)
        });
        compared.map(|(c, _)| wide_column(seen, *c)).collect()
    };
    let several = |columns: &Vec<String>| columns.len() > 1;
    observed.iter().map(columns).find(several)
}

/// The level of a condition in each factor that the conditions cross; none of the baseline.
fn levels(design: &Design, condition: ConditionId) -> Vec<Cell<String>> {
    let known = design.condition(condition).map(|c| &c.levels);
    let factors = design.conditions().iter().take(1);
    let factors = factors.flat_map(|first| first.levels.keys());
    let level = |factor: &String| known.and_then(|levels| levels.get(factor)).cloned();
    factors.map(|f| (f.clone(), level(f))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(outcome: &str, conditions: &[(&str, Option<f64>)]) -> Observed {
        let values = conditions.iter().map(|(condition, value)| {
            (condition.parse::<ConditionId>().unwrap(), vec![None, *value])
        });
        Observed {
            outcome: outcome.to_owned(),
            title: String::new(),
            unit: String::new(),
            factor: 1.0,
            conditions: values.collect(),
        }
    }

    #[test]
    fn what_can_be_compared_has_values_in_conditions_that_are_not_the_drive_by_hand() {
        let design = Design::from_toml(
            "[study]\ntitle = \"A study\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"",
        );
        let design = design.unwrap();
        let alone = seen("alone", &[("own", Some(1.0)), ("calm", Some(2.0)), ("sporty", None)]);
        assert_eq!(compared(&design, std::slice::from_ref(&alone)), None);
        let both = seen("both", &[("own", Some(1.0)), ("calm", Some(2.0)), ("sporty", Some(3.0))]);
        let columns = ["both.calm", "both.sporty"].map(str::to_owned);
        assert_eq!(compared(&design, &[alone, both]), Some(columns.to_vec()));
    }
}

//! `participants.csv`: what is said of people, and who can be found out by it.

use super::pseudonym::Pseudonyms;
use crate::{
    error::StudyError,
    tables::{TableName, participants::Enrolled, write_rows},
};
use maveric_domain::{ConditionId, Design, ParticipantId};
use std::{collections::BTreeMap, path::Path};

/// Width of a band of ages, in years.
const BAND_YEARS: u32 = 10;

/// Fewer people than this who share what the table says of them can be found out.
const FEWEST_ALIKE: usize = 3;

/// The column that becomes bands.
pub(super) const AGE: &str = "age";

/// The columns that have a place of their own in the table, whatever the design makes of them.
const ALWAYS: [&str; 5] = ["population", AGE, "gender", "professional", "order"];

/// The band that an age lies in, such as `30-39`.
fn band(age_years: f64) -> String {
    let low = (age_years as u32) / BAND_YEARS * BAND_YEARS;
    format!("{low}-{}", low + BAND_YEARS - 1)
}

/// What is given away of a person's cell; nothing of one that says it is missing.
pub(super) fn cell(person: &Enrolled, column: &str) -> Option<String> {
    if column == AGE {
        return person.age_years.map(band);
    }
    let cell = person.cells.get(column).cloned();
    cell.filter(|cell| cell != "NA")
}

/// Writes the table, sorted by pseudonym; warns of people whom few others resemble in what it says.
pub(super) fn write(
    out: &Path,
    people: &[Enrolled],
    names: &Pseudonyms,
    design: &Design,
) -> Result<Vec<String>, StudyError> {
    if people.is_empty() {
        return Ok(Vec::new());
    }
    let mut rows: Vec<(ParticipantId, &Enrolled)> =
        people.iter().map(|p| (names.pseudonym(&p.id), p)).collect();
    rows.sort_by(|a, b| (!a.1.learned_from, &a.0).cmp(&(!b.1.learned_from, &b.0)));
    let mut columns = design.people().columns();
    columns.extend(design.tested_columns());
    columns.retain(|column| !ALWAYS.contains(column));
    let given = rows.into_iter().map(|(name, p)| {
        let order: Vec<&str> = p.order.iter().map(ConditionId::as_str).collect();
        let word = |column: &str| p.cells.get(column).cloned().unwrap_or_default();
        let telling: Vec<(&str, String)> = columns.iter().map(|c| (*c, word(c))).collect();
        (
            ("participant", name),
            ("population", p.population.clone().unwrap_or_default()),
            (AGE, cell(p, AGE).unwrap_or_default()),
            ("gender", p.gender.clone().unwrap_or_default()),
            ("professional", p.professional),
            ("order", order.join(" ")),
            telling,
        )
    });
    write_rows(TableName::Participants, &out.join("participants.csv"), given)?;
    let mut warnings = alike(people, design);
    let covariates = design.covariates().iter().map(|c| c.column.as_str());
    let exact: Vec<&str> = covariates.filter(|c| *c != AGE).collect();
    if !exact.is_empty() {
        warnings.push(format!(
            "covariates are given away as they are ({}): a rare value may single somebody out",
            exact.join(", ")
        ));
    }
    Ok(warnings)
}

/// Warns of people whom few others resemble in what the table still says.
fn alike(people: &[Enrolled], design: &Design) -> Vec<String> {
    let factors = design.factors().iter().map(|f| f.name.as_str());
    let factors: Vec<&str> = factors.filter(|f| !ALWAYS.contains(f)).collect();
    let mut groups: BTreeMap<String, usize> = BTreeMap::new();
    for p in people {
        let learned = p.learned_from.then(|| "learned from".to_owned());
        let professional = p.professional.then(|| "professional".to_owned());
        let words = [learned, p.population.clone(), cell(p, AGE), p.gender.clone(), professional];
        let levels = factors.iter().map(|factor| cell(p, factor));
        let words: Vec<String> = words.into_iter().chain(levels).flatten().collect();
        *groups.entry(words.join(", ")).or_default() += 1;
    }
    let few = groups.iter().filter(|(_, n)| **n < FEWEST_ALIKE);
    few.map(|(words, n)| format!("only {n} alike ({words}): who knows them may recognise them"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_fall_into_bands_of_ten() {
        assert_eq!([18.0, 39.9, 40.0].map(band), ["10-19", "30-39", "40-49"].map(str::to_owned));
    }
}

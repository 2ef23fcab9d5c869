//! A design held against what there is: scales, measures, people, drives and answers.

use crate::{
    atomic_write::if_there,
    beyond,
    design::{DesignFile, People},
    error::StudyError,
    gate::{analysed, nobody_listed},
    run_folder::{read_scales, score_range},
    stages::{import::refuse_export, orders::balance_of},
    tables::{
        embeddings::read_embeddings, own_measures::read_own_measures, participants::Enrolled,
    },
};
use maveric_analysis::{LeftOut, Why, covariate_number};
use maveric_domain::{
    Design, DriveId, Ride, Scale,
    design::{DesignError, Quantity, ScoreName, Style},
};
use maveric_measures::objective;
use path_slash::PathExt as _;
use std::path::Path;

/// Says whether every scale, measure and person that a design names is there.
///
/// # Errors
/// [`StudyError`] naming the design's file, the key, what it says and what would be possible.
pub fn check_design(study: &DesignFile) -> Result<(), StudyError> {
    refuse_export(study)?;
    let folder = study.resolve(&study.design.files().scales);
    let scales = read_scales(&folder)?;
    of_scales(study, &scales)
        .map_err(|error| study.wrong(error.to_string(), error.suggestion()))?;
    read_own_measures(study, None)?;
    let excluded = study.design.exclude();
    let unlisted = !study.people_file(None).exists();
    if excluded.people.is_empty() && excluded.drives.is_empty() && unlisted {
        // A study whose people come yet: the seat writes their table.
        return Ok(());
    }
    let people = study.people(None)?;
    let ids = || people.enrolled.iter().map(|p| p.id.as_str());
    let excluded = study.design.exclude().people.keys();
    let forgotten = study.forgotten()?;
    if let Some(id) = excluded.clone().find(|id| forgotten.has(id)) {
        return Err(study.wrong(
            format!("`exclude.people`: names {id}, who was forgotten"),
            Some(format!("take {id} out of [exclude]: nothing of theirs is there any more")),
        ));
    }
    let unknown = |key: &str, word: &str, known: &mut dyn Iterator<Item = &str>| {
        let error = DesignError::word(key, word, known);
        study.wrong(error.to_string(), error.suggestion())
    };
    if let Some(stranger) = excluded.into_iter().find(|id| people.find(id).is_none()) {
        return Err(unknown("exclude.people", stranger.as_str(), &mut ids()));
    }
    let drives = drives_of(study, &people);
    let mut named = study.design.exclude().drives.keys();
    if let Some(stranger) = named.find(|id| !drives.contains(id)) {
        let error =
            unknown("exclude.drives", stranger.as_str(), &mut drives.iter().map(DriveId::as_str));
        return Err(error);
    }
    Ok(())
}

/// Covariates of those tested that are words: whoever has not come yet is in no test.
fn covariates_of_words(design: &Design, people: &People) -> Vec<String> {
    let mut notes = Vec::new();
    let enrolled = people.enrolled.iter();
    for person in enrolled.filter(|p| p.tested && p.excluded.is_none()) {
        for covariate in design.covariates() {
            let cell = person.cells.get(&covariate.column);
            let cell = cell.filter(|cell| *cell != "NA");
            let read = cell.map(|cell| covariate_number(&person.id, covariate, cell));
            if let Some(Err(error)) = read {
                notes.push(format!(
                    "{error}: the analysis stops there once {} has a value",
                    person.id
                ));
            }
        }
    }
    notes
}

/// The drives that the study can have: of each person in each condition, the baseline and each role.
fn drives_of(study: &DesignFile, people: &People) -> Vec<DriveId> {
    let labels = study.design.labels();
    let people = people.enrolled.iter();
    let rides = labels.iter();
    let rides: Vec<Ride> = rides.flat_map(|&label| study.design.rides(label)).collect();
    people
        .flat_map(|p| rides.iter().map(|&ride| DriveId::in_condition(&p.id, ride)))
        // Of two ids too long for one there is no drive.
        .filter_map(Result::ok)
        .collect()
}

/// People who are in the study and neither learned from nor tested.
fn nobodys(people: &People) -> impl Iterator<Item = &Enrolled> {
    let enrolled = people.enrolled.iter();
    enrolled.filter(|p| !p.learned_from && !p.tested && p.excluded.is_none())
}

/// What an outcome may be: a measure's column, or a score of a scale.
struct Known<'a> {
    measures: Vec<&'a str>,
    scores: Vec<String>,
}

impl<'a> Known<'a> {
    fn new(design: &'a Design, scales: &[Scale]) -> Self {
        Self {
            measures: objective::all()
                .iter()
                .chain(objective::further())
                .chain(objective::met())
                .map(|m| m.name)
                .chain(design.measures().iter().map(|m| m.id.as_str()))
                .collect(),
            scores: scales.iter().flat_map(Scale::score_names).collect(),
        }
    }

    fn scores(&self) -> impl Iterator<Item = &str> + Clone {
        self.scores.iter().map(String::as_str)
    }

    fn score(&self, key: impl Into<String>, name: &ScoreName) -> Result<(), DesignError> {
        one_of(key, &name.to_string(), self.scores())
    }

    fn measure(&self, key: impl Into<String>, name: &str) -> Result<(), DesignError> {
        one_of(key, name, self.measures.iter().copied())
    }

    fn either(&self, key: impl Into<String>, name: &str) -> Result<(), DesignError> {
        let measures = self.measures.iter().copied();
        one_of(key, name, measures.chain(self.scores()))
    }
}

/// Refuses a word that is none of the known ones.
fn one_of<'w>(
    key: impl Into<String>,
    word: &str,
    known: impl Iterator<Item = &'w str> + Clone,
) -> Result<(), DesignError> {
    if known.clone().any(|name| name == word) {
        return Ok(());
    }
    Err(DesignError::word(key, word, known))
}

fn of_scales(study: &DesignFile, scales: &[Scale]) -> Result<(), DesignError> {
    let (design, known) = (&study.design, Known::new(&study.design, scales));
    if let Some(style) = design.style() {
        known.score("style.score", &style.score)?;
        check_style_range(design, style, scales)?;
    }
    for (at, outcome) in design.outcomes().iter().enumerate() {
        match &outcome.quantity {
            Quantity::Measure(name) => known.measure("outcome.measure", name)?,
            Quantity::Score(name) => {
                known.score("outcome.scale", name)?;
                dropped_items(
                    &format!("outcome[{}].drop_items", at + 1),
                    name,
                    &outcome.drop_items,
                    scales,
                )?;
            }
        }
    }
    for condition in design.conditions() {
        for name in condition.expected.keys() {
            known.either(format!("condition.{}.expected", condition.id), name)?;
        }
    }
    for (at, hypothesis) in design.hypotheses().iter().enumerate() {
        known.either(format!("hypothesis[{}].outcome", at + 1), &hypothesis.outcome)?;
    }
    for rating in design.homophily().iter().flat_map(|h| &h.ratings) {
        known.score("homophily.ratings", rating)?;
    }
    for factor in design.homophily().iter().flat_map(|h| &h.factors) {
        let whole = scales.iter().map(|s| s.id.as_str());
        one_of("homophily.factors", factor, whole.chain(known.scores()))?;
    }
    Ok(())
}

/// Items that an outcome drops are items of its score, and others are left.
fn dropped_items(
    key: &str,
    name: &ScoreName,
    items: &[u32],
    scales: &[Scale],
) -> Result<(), DesignError> {
    let scale = scales.iter().find(|s| s.id == name.scale);
    let mut subscales = scale.iter().flat_map(|s| &s.subscales);
    let Some(subscale) = subscales.find(|s| s.id == name.subscale) else {
        return Ok(());
    };
    if !items.is_empty() && !subscale.sum_of.is_empty() {
        let dropped = format!("items of `{name}`, a sum of other scores");
        let expected = format!("items of one of {}", subscale.sum_of.join(", "));
        return Err(DesignError::key(key, dropped, expected));
    }
    let numbers: Vec<String> = subscale.items.iter().map(u32::to_string).collect();
    if let Some(stranger) = items.iter().find(|i| !subscale.items.contains(i)) {
        let expected = format!("an item of `{name}`: {}", numbers.join(", "));
        return Err(DesignError::key(key, stranger, expected));
    }
    if !items.is_empty() && items.len() == subscale.items.len() {
        let expected = format!("at most {} of them, so that one is left", items.len() - 1);
        let every = format!("every item of `{name}`");
        return Err(DesignError::key(key, every, expected));
    }
    Ok(())
}

/// The range of the style is that of its scale or lies within it, and no condition asks for more than its width.
fn check_style_range(design: &Design, style: &Style, scales: &[Scale]) -> Result<(), DesignError> {
    let Some((low, high)) = score_range(scales, &style.score) else {
        return Ok(());
    };
    let [from, to] = style.range.unwrap_or([low, high]);
    if from < low || to > high {
        return Err(DesignError::key(
            "style.range",
            format!("[{from}, {to}]"),
            format!("within {low} to {high}, the range of `{}` in its scale's file", style.score),
        ));
    }
    let conditions = design.conditions().iter();
    let mut dials = conditions.filter_map(|c| Some((c, c.dial()?)));
    match dials.find(|(_, dial)| dial.abs() > to - from) {
        None => Ok(()),
        Some((condition, dial)) => Err(DesignError::key(
            format!("condition.{}.car.dial", condition.id),
            dial,
            format!("at most {} points either way, the width of `{}`", to - from, style.score),
        )),
    }
}

/// What one should know of a study before it is run: who is left out, and by which rule.
/// `results` is where the runs of the study write.
///
/// # Errors
/// As [`check_design`], and if a table cannot be read.
pub fn study_notes(study: &DesignFile, results: &Path) -> Result<Vec<String>, StudyError> {
    check_design(study)?;
    let design = &study.design;
    let named = LeftOut::named(design).with_stopped(&study.stopped()?);
    let left_out = analysed(named, results)?;
    let people = left_out.people.iter();
    let people = people.map(|(id, why)| (id.as_str(), why));
    let drives = left_out.drives.iter();
    let drives = drives.map(|(id, why)| (id.as_str(), why));
    let note = |(id, why): (&str, &Why)| format!("{id} is left out: {}", why.reason);
    let mut notes: Vec<String> = people.chain(drives).map(note).collect();
    let enrolled = study.people(None)?;
    if enrolled.enrolled.is_empty() {
        let error = nobody_listed(&study.people_file(None));
        notes.push(format!("{error}; {}", error.suggestion().unwrap_or_default()));
    }
    let neither: Vec<&str> = nobodys(&enrolled).map(|p| p.id.as_str()).collect();
    if !neither.is_empty() {
        notes.push(format!(
            "{}: neither learned from nor tested, by the columns that `[people]` names",
            neither.join(", ")
        ));
    }
    notes.extend(covariates_of_words(design, &enrolled));
    if let Err(error) = design.runnable() {
        notes.push(format!("{error}: this outcome will not be testable"));
    }
    if let Some(balance) = balance_of(study, &enrolled.enrolled) {
        notes.extend(maveric_pages::orders(design, &balance)?);
    }
    notes.extend(met(results)?);
    let measures = &design.files().measures;
    if design.measures().is_empty() && study.resolve(measures).is_file() {
        notes.push(format!(
            "{} is not read: the design declares no [[measure]]",
            measures.to_slash_lossy()
        ));
    }
    Ok(notes)
}

/// Who of those whose styles were learned is beyond what the model has met, and whether it can say.
fn met(results: &Path) -> Result<Vec<String>, StudyError> {
    let rows = if_there(&results.join("embeddings.csv"), read_embeddings)?;
    let mut notes = beyond::named("drive", beyond::of_rows(&rows), "");
    if !rows.is_empty() && rows.iter().all(|row| row.beyond().is_none()) {
        notes.push(
            "nobody can say whether the model has met drivers like these: it learned from too few people, or does not say from whom (`support_p` of embeddings.csv is empty)"
                .to_owned(),
        );
    }
    Ok(notes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::embeddings::{EmbeddingRow, write_embeddings};
    use maveric_domain::{BeyondWhy, DriveId, Embedding, ParticipantId};

    /// What is said before a run of a study with a covariate and with this table of people: an error, else the notes.
    fn said(people: &str, exclude: &str) -> String {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        std::fs::create_dir(file("scales")).unwrap();
        std::fs::write(file("scales/adb.toml"), maveric_data::SCALES_ADB).unwrap();
        std::fs::write(file("participants.csv"), people).unwrap();
        let design = format!(
            "[study]\ntitle = \"t\"\n[people]\nlearn = {{ part = \"learn\" }}\n[[condition]]\nid = \"calm\"\n\
             [[covariate]]\ncolumn = \"years\"\n[exclude]\n{exclude}"
        );
        std::fs::write(file("study.toml"), design).unwrap();
        let study = DesignFile::read(&file("study.toml")).unwrap();
        let notes = study_notes(&study, &file("results"));
        notes.map_or_else(|e| e.to_string(), |notes| notes.join("; "))
    }

    #[test]
    fn a_covariate_of_words_is_told_and_one_that_is_not_known_is_not() {
        let table = |years: &str| {
            format!(
                "participant,part,years\nP01,test,41\nP02,test,{years}\nP04,learn,old\nP05,test,old\n"
            )
        };
        let exclude = "people = { P05 = \"withdrew\" }";
        for years in ["39.5", "NA", ""] {
            let notes = said(&table(years), exclude);
            assert_eq!(notes, "P05 is left out: withdrew", "{years}");
        }
        let told = said(&table("tbd"), exclude);
        assert!(
            told.starts_with(
                "P05 is left out: withdrew; the covariate `years` of `P02` is `tbd`, expected a number"
            ),
            "{told}"
        );
    }

    #[test]
    fn a_primary_outcome_whose_test_can_never_be_run_is_told() {
        let people = "participant,part,years\nP01,test,41\n";
        let primary = |test: &str| {
            format!(
                "[[condition]]\nid = \"sporty\"\n[[outcome]]\nmeasure = \"mean_velocity_mps\"\nprimary = true\ntest = \"{test}\"\n\
                 contrast = [\"sporty\", \"calm\"]\n"
            )
        };
        assert_eq!(said(people, &primary("mixed")), "");
        let told = said(people, &primary("ordinal"));
        assert!(
            told.contains("`ordinal` beside the [[covariate]] `years`")
                && told.ends_with("this outcome will not be testable"),
            "{told}"
        );
    }

    #[test]
    fn a_table_of_people_without_a_row_is_told_and_what_to_write_into_it() {
        let head = "participant,part,years\n";
        let empty = said(head, "");
        for part in ["participants.csv: has no row: nobody takes part", "write a row for each"] {
            assert!(empty.contains(part), "{empty}");
        }
        assert_eq!(said(&format!("{head}P01,test,41\n"), ""), "");
    }

    #[test]
    fn who_is_beyond_what_the_model_has_met_is_named_and_a_model_that_cannot_say_is_too() {
        let row =
            |drive: &str, support_p: Option<f64>, beyond_why: Option<BeyondWhy>| EmbeddingRow {
                readings: Some(9),
                support_p,
                beyond_why,
                ..EmbeddingRow::new(
                    DriveId::new(drive).unwrap(),
                    ParticipantId::new("P").unwrap(),
                    "own".parse().unwrap(),
                    Embedding::new(vec![0.0]).unwrap(),
                )
            };
        let results = tempfile::tempdir().unwrap();
        assert!(met(results.path()).unwrap().is_empty(), "nothing is there yet");
        let notes = |rows: &[EmbeddingRow]| {
            write_embeddings(&results.path().join("embeddings.csv"), rows).unwrap();
            met(results.path()).unwrap()
        };
        let usual = row("P-own", Some(0.4), None);
        assert!(notes(std::slice::from_ref(&usual)).is_empty());
        let habit = "following_gap_s".to_owned();
        let stranger = row("Q-own", Some(0.001), Some(BeyondWhy::Habits { habit }));
        let named = notes(&[usual, stranger]);
        assert!(named.len() == 1 && named[0].starts_with("drive Q-own: shows habits"), "{named:?}");
        let unknown = notes(&[row("P-own", None, None)]);
        assert!(unknown.len() == 1 && unknown[0].contains("nobody can say"), "{unknown:?}");
    }
}

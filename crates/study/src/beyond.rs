//! Drives beyond what a model has learned from: named, and in words.

use crate::once::told_once;
use maveric_domain::{
    BeyondWhy, ConditionId, ConditionRow, Design, EmbeddingRow, ParticipantId, occasion::is_first,
};
use maveric_model::{FreeSpeed, HEADS, Model};
use std::collections::BTreeMap;

/// Why a drive is beyond what the model has learned from, in words.
pub fn beyond_in_words(why: &BeyondWhy) -> String {
    let title = |habit: &str| {
        let head = HEADS.iter().find(|head| head.name == habit);
        head.map_or(habit.to_owned(), |head| head.title.to_lowercase())
    };
    match why {
        BeyondWhy::Scale => {
            "reads as a score that the scale does not have, so it has none".to_owned()
        }
        BeyondWhy::Style { habit } => format!(
            "shows a style further out than nearly everybody learned from, most of all in: {}",
            title(habit)
        ),
        BeyondWhy::Habits { habit } => format!(
            "shows habits that no style of those learned from explains, most of all: {}",
            title(habit)
        ),
    }
}

/// A sentence a reason for all who are beyond by it, with what `follows` from that.
pub(crate) fn named<'a>(
    kind: &str,
    beyond: impl IntoIterator<Item = (String, &'a BeyondWhy)>,
    follows: &str,
) -> Vec<String> {
    let why = |(who, why)| (who, format!("{}{follows}", beyond_in_words(why)));
    told_once(kind, beyond.into_iter().map(why))
}

/// The drives that are beyond, and by what.
pub(crate) fn of_rows(rows: &[EmbeddingRow]) -> impl Iterator<Item = (String, &BeyondWhy)> {
    rows.iter().filter_map(|row| Some((row.drive.to_string(), row.beyond_why.as_ref()?)))
}

/// One row a participant, of the drive of their first session: the fit with the score where there is one.
pub(crate) fn own_drives(rows: &[EmbeddingRow], baseline: ConditionId) -> Vec<&EmbeddingRow> {
    let is_own_drive = |r: &&EmbeddingRow| r.condition == baseline && is_first(&r.session);
    let has_adb_fit = |p: &ParticipantId| {
        let mut fits = rows.iter().filter(is_own_drive);
        fits.any(|r| r.participant == *p && r.adb_used)
    };
    rows.iter().filter(is_own_drive).filter(|r| r.adb_used == has_adb_fit(&r.participant)).collect()
}

/// Of everybody whose drive that is steered from is beyond what the model has learned from: whether a condition that turns the dial was
/// placed for them all the same.
pub(crate) fn turned_for(
    rows: &[EmbeddingRow],
    conditions: &[ConditionRow],
    design: &Design,
) -> BTreeMap<ParticipantId, bool> {
    let Some(baseline) = design.baseline_id() else {
        return BTreeMap::new();
    };
    let turned = |who: &ParticipantId| {
        let theirs = conditions.iter().filter(|row| row.participant == *who);
        theirs
            .filter_map(|row| design.condition(row.condition))
            .any(|condition| condition.side().is_some())
    };
    let steered_from = own_drives(rows, baseline).into_iter();
    let beyond = steered_from.filter(|row| row.beyond() == Some(true));
    beyond.map(|row| (row.participant.clone(), turned(&row.participant))).collect()
}

/// A sentence for the drives that are beyond what the model has learned from, and one where it cannot say of any.
pub(crate) fn warnings(model: &Model, rows: &[EmbeddingRow]) -> Vec<String> {
    let off_the_scale = |why: &BeyondWhy| *why == BeyondWhy::Scale;
    let mut warnings = named(
        "drive",
        of_rows(rows).filter(|(_, why)| !off_the_scale(why)),
        ": the model has met nobody who drives like this, and where it puts this driver says little",
    );
    warnings.extend(unseen_limits(model, rows));
    let known = rows.iter().any(|row| row.support_p.is_some());
    let shows = rows.iter().any(|row| row.readings != Some(0));
    warnings.extend((shows && !known).then(|| unknown(model.people())));
    warnings
}

/// Why a model that learned from so many `people` cannot say whether it has met a driver.
pub(crate) fn unknown(people: usize) -> String {
    format!(
        "the model learned from {people} people, too few to say whether it has met drivers like these (expected at least three for each habit that a drive shows)"
    )
}

/// A sentence for drives on roads whose limit lies outside those that the model learned from.
fn unseen_limits(model: &Model, rows: &[EmbeddingRow]) -> Vec<String> {
    let posted = model.posted();
    let [low, high] = [posted.lowest_mps, posted.highest_mps].map(|v| format!("{:.0}", 3.6 * v));
    let range = if low == high { low } else { format!("{low} to {high}") };
    let read = match posted.free_speed {
        FreeSpeed::Absolute => "its free speed is read in m/s, as if that were posted there too",
        FreeSpeed::Posted => "its free speed is read by its share of the limit",
    };
    let why = format!(
        "the model learned where {range} km/h is posted, which is not what is posted here: {read}"
    );
    let unseen = rows.iter().filter(|row| row.posted_unseen == Some(true));
    told_once("drive", unseen.map(|row| (row.drive.to_string(), why.clone())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{DriveId, Embedding};
    use std::num::NonZeroU32;

    #[test]
    fn all_who_are_beyond_by_one_reason_are_one_sentence_in_the_habits_own_words() {
        let by = |habit: &str| BeyondWhy::Style { habit: habit.to_owned() };
        let (gap, scale) = (by("following_gap_s"), BeyondWhy::Scale);
        let who = |name: &str| name.to_owned();
        let rows = [(who("A"), &gap), (who("B"), &scale), (who("C"), &gap)];
        let named = named("drive", rows, ": so");
        assert_eq!(named.len(), 2);
        assert!(
            named[0].starts_with("2 drives (A, C): shows a style") && named[0].ends_with(": so"),
            "{named:?}"
        );
        assert!(!named[0].contains("following_gap_s"), "{named:?}");
        assert!(named[1].starts_with("drive B: reads as a score"));
    }

    #[test]
    fn too_few_people_and_a_model_that_does_not_say_whom_it_learned_from_are_told_apart() {
        assert!(unknown(5).contains("5 people, too few to say"));
    }

    #[test]
    fn whoever_is_beyond_in_the_drive_that_is_steered_from_was_turned_for_or_not_and_no_other_drive_counts()
     {
        let design = Design::from_toml(
            "[study]\ntitle = \"Two\"\n[people]\nlearn = { part = \"learn\" }\n[style]\nscore = \"adb.total\"\npoints = 15\n\
             [baseline]\nid = \"own\"\n[[condition]]\nid = \"sporty\"\ncar = { dial = \"+1\" }\n",
        )
        .unwrap();
        let who = ParticipantId::new("P1").unwrap();
        let style = || Embedding::new(vec![0.5]).unwrap();
        let drive = |session: u32, beyond: bool| {
            let id = DriveId::new(format!("P1-own{session}")).unwrap();
            EmbeddingRow {
                session: NonZeroU32::new(session).unwrap(),
                support_p: Some(0.5),
                beyond_why: beyond.then_some(BeyondWhy::Scale),
                ..EmbeddingRow::new(id, who.clone(), "own".parse().unwrap(), style())
            }
        };
        let turned = ConditionRow::new(who.clone(), "sporty".parse().unwrap(), style());
        let of = |first: bool, second: bool, placed: &[ConditionRow]| {
            let rows = [drive(1, first), drive(2, second)];
            let turned = turned_for(&rows, placed, &design).into_values();
            turned.collect::<Vec<bool>>()
        };
        let placed = std::slice::from_ref(&turned);
        assert_eq!(of(true, false, placed), [true]);
        assert_eq!(of(true, false, &[]), [false]);
        assert!(of(false, true, placed).is_empty());
    }
}

//! Drives beyond what a model has learned from: named, and in words.

use crate::once::told_once;
use maveric_domain::{BeyondWhy, EmbeddingRow};
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

/// A sentence for the drives that are beyond what the model has learned from, and one where it cannot say of any.
pub(crate) fn told(model: &Model, rows: &[EmbeddingRow]) -> Vec<String> {
    let beyond: BTreeMap<&str, String> = rows
        .iter()
        .filter_map(|row| Some((row.drive.as_str(), row.beyond_why.as_ref().filter(|w| **w != BeyondWhy::Scale)?)))
        .map(|(drive, why)| {
            let why = format!("{}: the model has met nobody who drives like this, and where it puts this driver says little", beyond_in_words(why));
            (drive, why)
        })
        .collect();
    let mut said = told_once(
        "drive",
        beyond
            .into_iter()
            .map(|(drive, why)| (drive.to_owned(), why)),
    );
    said.extend(unseen_limits(model, rows));
    let known = rows.iter().any(|row| row.support_p.is_some());
    match model.people() {
        _ if known => {}
        Some(people) => said.push(format!(
            "the model learned from {people} people, too few to say whether it has met drivers like these (expected at least three for each habit that a drive shows)"
        )),
        None => said.push(
            "the model does not say whom it learned from, so nobody knows whether it has met drivers like these: train it anew".to_owned(),
        ),
    }
    said
}

/// A sentence for drives on roads whose limit lies outside those that the model learned from.
fn unseen_limits(model: &Model, rows: &[EmbeddingRow]) -> Vec<String> {
    let Some(posted) = model.posted() else {
        return Vec::new();
    };
    let [low, high] = [posted.lowest_mps, posted.highest_mps].map(|v| format!("{:.0}", 3.6 * v));
    let range = if low == high {
        low
    } else {
        format!("{low} to {high}")
    };
    let read = match posted.free_speed {
        FreeSpeed::Absolute => "its free speed is read in m/s, as if that were posted there too",
        FreeSpeed::Posted => "its free speed is read by its share of the limit",
    };
    let why = format!(
        "the model learned where {range} km/h is posted, which is not what is posted here: {read}"
    );
    let unseen: BTreeMap<&str, &str> = rows
        .iter()
        .filter(|row| row.posted_unseen == Some(true))
        .map(|row| (row.drive.as_str(), why.as_str()))
        .collect();
    let of_each = unseen.into_iter();
    told_once(
        "drive",
        of_each.map(|(drive, why)| (drive.to_owned(), why.to_owned())),
    )
}

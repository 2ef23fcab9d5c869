//! What a page sends of a drive: checked against the step, kept once.

use crate::{
    request::{Answered, Refused, Shared, json, read},
    steps::Step,
};
use axum::{
    body::Bytes,
    extract::{Path, State},
    response::Response,
};
use maveric_domain::DrivenBy;
use maveric_seat_page::{Chunk, End, Header};

/// Steps that a second of driving has.
const TICKS_PER_S: f64 = 100.0;
/// Longest line, in bytes: a piece of a second has some thousand.
const LONGEST_LINE: usize = 16 << 10;
/// Length of a digest.
const DIGEST_LEN: usize = 16;
/// How often one step may be begun.
const MOST_ATTEMPTS: u32 = 50;

/// Takes in a drive: its header once, pieces as they come, its end. Gives the step up to which all is kept.
pub(crate) async fn drive(
    State(shared): State<Shared>,
    Path((token, step, attempt, tab)): Path<(String, usize, u32, String)>,
    body: Bytes,
) -> Answered<Response> {
    let (person, found) = shared.at(&token, step)?;
    let store = &shared.seat.store;
    let Some((seed, seconds)) = found.world() else {
        return Err(Refused::NotThis("nothing is driven here".to_owned()));
    };
    let begun = store.begun(&person.participant, step)?;
    let before = begun.iter().find(|b| b.attempt == attempt);
    // What a tab kept while the network was gone is taken from whichever tab finds it.
    if before.is_none() && !store.claimed(&token, &tab)? {
        return Err(Refused::OtherTab);
    }
    let expected = begun.last().map_or(1, |b| b.attempt + 1);
    if before.is_none() && (attempt != expected || attempt > MOST_ATTEMPTS) {
        return Err(Refused::NotThis(format!(
            "attempt {attempt}, expected {expected}"
        )));
    }
    let text = std::str::from_utf8(&body).map_err(|e| Refused::NotThis(e.to_string()))?;
    let most = (seconds * TICKS_PER_S).ceil() as u64;
    let mut pieces = Vec::new();
    let mut end = None;
    for line in text.lines() {
        if line.len() > LONGEST_LINE {
            return Err(Refused::NotThis(format!(
                "a line of {} bytes, expected at most {LONGEST_LINE}",
                line.len()
            )));
        }
        if let Ok(header) = serde_json::from_str::<Header>(line) {
            check_header(&header, &found, seed, &shared)?;
            store.begin(&person.participant, step, attempt, line)?;
        } else if let Ok(chunk) = serde_json::from_str::<Chunk>(line) {
            let given: u64 = chunk.held.iter().map(|h| u64::from(h.steps)).sum();
            let by_hand = found.drives().is_none_or(|(_, by_hand)| by_hand);
            let after = chunk.from_tick.saturating_add(chunk.ticks);
            if after > most || given != if by_hand { chunk.ticks } else { 0 } || chunk.ticks == 0 {
                return Err(Refused::NotThis(
                    "a piece that this drive cannot have".to_owned(),
                ));
            }
            pieces.push((chunk.from_tick, chunk.ticks, line.to_owned()));
        } else if serde_json::from_str::<End>(line).is_ok() {
            end = Some(line);
        } else {
            return Err(Refused::NotThis(
                "a line that is no part of a drive".to_owned(),
            ));
        }
    }
    if store
        .begun(&person.participant, step)?
        .iter()
        .all(|b| b.attempt != attempt)
    {
        return Err(Refused::NotThis(
            "a piece before the head of its drive".to_owned(),
        ));
    }
    let kept = store.keep(&person.participant, (step, attempt), &pieces)?;
    if let Some(end) = end {
        let whole: End = read(end.as_bytes())?;
        if whole.end_tick == kept && whole.states.len() == DIGEST_LEN {
            store.end(&person.participant, (step, attempt), end)?;
        }
    }
    Ok(json(&kept))
}

fn check_header(header: &Header, step: &Step, seed: &str, shared: &Shared) -> Answered<()> {
    let by_hand = !matches!(step, Step::Ride { .. });
    let who = header.driven_by;
    let fits = if by_hand {
        matches!(who, DrivenBy::Human | DrivenBy::Scripted)
    } else {
        who == DrivenBy::Automated
    };
    let mut settings = shared.seat.settings.scenario.settings().clone();
    settings.duration_s = step.world().map_or(0.0, |(_, seconds)| seconds);
    let world = *header.scenario.settings() == settings;
    if fits && world && header.seed.to_string() == seed {
        Ok(())
    } else {
        Err(Refused::NotThis("the head of another drive".to_owned()))
    }
}

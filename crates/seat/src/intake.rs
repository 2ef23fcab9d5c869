//! What a page sends of a drive: checked against the step, kept once.

use crate::{
    drives::{Begun, most_bytes, most_bytes_of_step},
    parts::Parts,
    request::{Answered, Refused, Shared, json},
    seat::Seat,
    steps::{AskedProbe, Step, TICKS_PER_S},
};
use axum::{
    body::Bytes,
    extract::{Path, State},
    response::Response,
};
use maveric_domain::DrivenBy;
use maveric_seat_page::{Chunk, End, Fit, Header};

/// Longest line, in bytes: a piece of a second has some thousand.
const LONGEST_LINE: usize = 16 << 10;
/// Events in a piece, beside one a step; and letters of what happened.
const MOST_EVENTS: usize = 16;
const LONGEST_EVENT: usize = 200;
const DIGEST_LEN: usize = 16;
/// How often one step may be begun.
const MOST_ATTEMPTS: u32 = 50;
const MOST_COORDINATES: usize = 64;

/// Takes in a drive: its header once, pieces as they come, its end. Gives the step up to which all is kept.
pub(crate) async fn drive(
    State(shared): State<Shared>,
    Path((token, step, attempt, tab)): Path<(String, usize, u32, String)>,
    body: Bytes,
) -> Answered<Response> {
    let kept = shared.blocking(move |seat| take(seat, (&token, &tab), (step, attempt), &body));
    Ok(json(&kept.await?))
}

/// Takes in what a tab sends of an attempt, all of it or nothing.
fn take(
    seat: &Seat,
    (token, tab): (&str, &str),
    (step, attempt): (usize, u32),
    body: &[u8],
) -> Answered<u64> {
    let text = std::str::from_utf8(body).map_err(|e| Refused::NotThis(e.to_string()))?;
    let (_, found) = seat.store.look(|b| b.at(token, step))?;
    let parts = parts(seat, &found, text).map_err(Refused::NotThis)?;
    seat.store.within(|b| {
        let (person, _) = b.at(token, step)?;
        let (who, place) = (&person.participant, (step, attempt));
        // What another tab kept while the network was gone is brought by the one that has the page now.
        if !b.claimed(token, tab)? {
            return Err(Refused::OtherTab);
        }
        let begun = b.begun(who, step)?;
        let before = begun.iter().any(|b| b.attempt == attempt);
        if begun.iter().any(|b| b.attempt == attempt && b.set_aside) {
            // The step is to be driven again.
            return Err(Refused::Over);
        }
        if !before && begun.iter().any(Begun::is_whole) {
            let why = "this drive has come to its end, and nobody has it driven again";
            return Err(Refused::NotThis(why.to_owned()));
        }
        let expected = begun.last().map_or(1, |b| b.attempt + 1);
        if !before && (attempt != expected || attempt > MOST_ATTEMPTS) {
            return Err(Refused::NotThis(format!(
                "attempt {attempt}, expected {expected}, at most {MOST_ATTEMPTS}"
            )));
        }
        match &parts.header {
            Some(header) => b.begin(who, place, header)?,
            None if !before => {
                let why = "a piece before the head of its drive";
                return Err(Refused::NotThis(why.to_owned()));
            }
            None => {}
        }
        // Another drive of the same attempt: of a tab that was open beside this one.
        let kept = b.keep(who, place, &parts.pieces)?.ok_or(Refused::OtherTab)?;
        let begun = b.begun(who, step)?;
        let of_attempt = begun.iter().filter(|b| b.attempt == attempt);
        let bytes: u64 = of_attempt.map(|b| b.bytes).sum();
        let of_step: u64 = begun.iter().map(|b| b.bytes).sum();
        let ticks = found.world().map_or(0, |(_, s)| most_ticks(s));
        if bytes > most_bytes(kept) || of_step > most_bytes_of_step(ticks) {
            return Err(Refused::NotThis(format!(
                "{bytes} bytes for {kept} steps: more than a drive can have"
            )));
        }
        if let Some((at, end)) = &parts.end
            && *at == kept
        {
            b.end(who, place, end)?;
        }
        Ok(kept)
    })
}

fn most_ticks(seconds: f64) -> u64 {
    (seconds * TICKS_PER_S).ceil() as u64
}

/// The lines of a drive, each looked at: what is wrong with the first that cannot be of this step.
pub(crate) fn parts(seat: &Seat, found: &Step, text: &str) -> Result<Parts, String> {
    let Some((seed, seconds)) = found.world() else {
        return Err("nothing is driven here".to_owned());
    };
    let most = most_ticks(seconds);
    let inputs = found.is_given_inputs();
    let mut parts = Parts::default();
    for line in text.lines() {
        let length = line.len();
        if length > LONGEST_LINE {
            return Err(format!("a line of {length} bytes, expected at most {LONGEST_LINE}"));
        }
        if let Ok(header) = serde_json::from_str::<Header>(line) {
            check_header(&header, found, (seed, seconds), seat)?;
            parts.header = Some(line.to_owned());
        } else if let Ok(chunk) = serde_json::from_str::<Chunk>(line) {
            let given: u64 = chunk.held.iter().map(|h| u64::from(h.steps)).sum();
            let after = chunk.from_tick.saturating_add(chunk.ticks);
            if after > most || given != if inputs { chunk.ticks } else { 0 } || chunk.ticks == 0 {
                return Err("a piece that this drive cannot have".to_owned());
            }
            let (events, most) = (chunk.events.len(), MOST_EVENTS + chunk.ticks as usize);
            if events > most || chunk.events.iter().any(|e| e.what.len() > LONGEST_EVENT) {
                return Err(format!(
                    "{events} events in a piece, expected at most {most}, each of at most {LONGEST_EVENT} letters"
                ));
            }
            check_events(found, &chunk)?;
            parts.pieces.push((chunk.from_tick, chunk.ticks, line.to_owned()));
        } else if let Ok(end) = serde_json::from_str::<End>(line)
            && end.states.len() == DIGEST_LEN
        {
            parts.end = Some((end.end_tick, line.to_owned()));
        } else {
            return Err("a line that is no part of a drive".to_owned());
        }
    }
    Ok(parts)
}

/// Whether every answer to a probe is one that the step asks, and whoever stopped did so for a reason that it has.
fn check_events(found: &Step, chunk: &Chunk) -> Result<(), String> {
    for event in &chunk.events {
        found.stopped(event).unwrap_or_else(|| Ok(String::new()))?;
    }
    let answers = chunk.events.iter().filter(|e| AskedProbe::is_answered_by(e));
    for event in answers {
        let read = found.probe().and_then(|probe| probe.answer(event));
        read.unwrap_or_else(|| Err("an answer to a probe where none is asked".to_owned()))?;
    }
    Ok(())
}

fn check_header(
    header: &Header,
    found: &Step,
    (seed, seconds): (&str, f64),
    seat: &Seat,
) -> Result<(), String> {
    let who = header.driven_by;
    let driver = if matches!(found, Step::Ride { .. }) {
        who == DrivenBy::Automated
    } else {
        matches!(who, DrivenBy::Human | DrivenBy::Scripted)
    };
    let fits = driver && header.holds_inputs() == found.is_given_inputs();
    let mut settings = seat.settings.scenario.settings().clone();
    settings.duration_s = seconds;
    if fits && *header.scenario.settings() == settings && header.seed.to_string() == seed {
        Ok(())
    } else {
        Err("the head of another drive".to_owned())
    }
}

/// A style as it is kept, if it is one.
pub(crate) fn style(fit: &Fit) -> Result<String, String> {
    let mut numbers = fit.embedding.iter().chain(fit.covariance.iter().flatten());
    let length = fit.embedding.len();
    let spread = fit.covariance.as_ref().map_or(0, Vec::len);
    let most = MOST_COORDINATES * MOST_COORDINATES;
    let sizes = (1..=MOST_COORDINATES).contains(&length) && spread <= most;
    if !sizes || !numbers.all(|n| n.is_finite()) {
        return Err("no style".to_owned());
    }
    serde_json::to_string(fit).map_err(|e| e.to_string())
}

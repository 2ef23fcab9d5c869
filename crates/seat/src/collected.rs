//! What happened on every page and in every drive, as tables: events, consents, notes.

use crate::{
    books::{Books, whole},
    error::SeatError,
    lent::rows_of,
    listed::{KeptSheet, Listed},
    person::Person,
    sheet::{Sheet, is_text},
    steps::{Act, STOPPED, Step, TICKS_PER_S},
    tables::{Given, Standing},
};
use maveric_domain::{ParticipantId, Ride};
use maveric_seat_page::Chunk;
use maveric_study::tables::collected::{ConsentRow, EventRow, LentRow, NoteRow, Stopped};
use rusqlite::params;
use std::collections::BTreeSet;

/// The page of the practice.
const PRACTICE: &str = "practice";
/// The page of the row that says how somebody's part ended.
const END: &str = "end";
/// How the text of an experimenter's note begins among the seat's events.
pub(crate) const NOTE: &str = "note: ";
#[derive(Debug, Default)]
pub(crate) struct Collected {
    pub(crate) events: Vec<EventRow>,
    pub(crate) consents: Vec<ConsentRow>,
    pub(crate) notes: Vec<NoteRow>,
    pub(crate) stopped: Vec<Stopped>,
    pub(crate) lent: Vec<LentRow>,
}

/// A moment as it is written, in UTC.
fn written(unix_s: i64) -> Option<String> {
    let moment = chrono::DateTime::from_timestamp(unix_s, 0)?;
    Some(moment.format("%Y-%m-%dT%H:%M:%SZ").to_string())
}

impl Books<'_> {
    /// What was collected: of `before`, rows of people whose part had ended stay as they are; of others they are read anew, where
    /// `unfinished` also of those whose part goes on. Nobody is in it who was taken out of the study's table.
    pub(crate) fn collected(
        &self,
        (given, standing): (&[Given], &Standing),
        before: &[EventRow],
        unfinished: bool,
    ) -> Result<Collected, SeatError> {
        let stays = |(person, _): &&Given| standing.person(person) != Listed::TakenOut;
        let final_rows: BTreeSet<String> = before
            .iter()
            .filter(|row| row.page == END)
            .map(|row| row.participant.to_string())
            .collect();
        let (mut collected, mut stopped) = (Collected::default(), Vec::new());
        for (person, sheets) in given.iter().filter(stays) {
            let who = ParticipantId::new(&*person.participant)?;
            stopped.extend(self.left_out_with(person, &who)?);
            // What was decided after the end is not in the rows of before.
            let is_final = final_rows.contains(&person.participant)
                && !self.was_excluded(&person.participant)?;
            if is_final || person.ended.is_none() && !unfinished {
                let theirs = before.iter().filter(|row| row.participant == who);
                collected.events.extend(theirs.cloned());
            } else {
                self.events_of((person, sheets), &who, &mut collected.events)?;
            }
            collected.consents.extend(consents_of(sheets, &who));
            collected.lent.extend(rows_of(person)?);
        }
        // Whoever is out as a whole has each drive once.
        let out: BTreeSet<ParticipantId> =
            stopped.iter().map(|row: &Stopped| row.participant.clone()).collect();
        let by_drive = collected.events.iter().filter(|row| !out.contains(&row.participant));
        collected.stopped = by_drive.filter_map(stopped_in).chain(stopped).collect();
        let known: BTreeSet<&str> =
            given.iter().filter(stays).map(|(person, _)| person.participant.as_str()).collect();
        for (given, about, text) in self.all_events()? {
            if about.as_deref().is_some_and(|who| !known.contains(who)) {
                continue;
            }
            let note = text.strip_prefix(NOTE);
            collected.notes.push(NoteRow {
                at: written(given),
                participant: about.map(ParticipantId::new).transpose()?,
                by: if note.is_some() { "experimenter" } else { "seat" }.to_owned(),
                text: note.unwrap_or(&text).to_owned(),
            });
        }
        Ok(collected)
    }

    /// Every event of the seat, the oldest first: when, about whom, what.
    fn all_events(&self) -> Result<Vec<(i64, Option<String>, String)>, SeatError> {
        let question = "SELECT given, participant, what FROM event ORDER BY rowid";
        self.rows(question, [], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))
    }

    fn events_of(
        &self,
        (person, sheets): (&Person, &[KeptSheet]),
        who: &ParticipantId,
        events: &mut Vec<EventRow>,
    ) -> Result<(), SeatError> {
        let left_out = self.left_out(&person.participant)?;
        let repeated = self.repeated(&person.participant)?;
        let decided = self.decided(&person.participant)?;
        let row_of = |step: usize, page: &str, moment: Option<String>, what: &str| EventRow {
            participant: who.clone(),
            step: step + 1,
            page: page.to_owned(),
            moment,
            attempt: None,
            time_s: None,
            what: what.to_owned(),
            value: None,
            at: None,
        };
        for (step, found) in person.steps.iter().enumerate() {
            let (page, moment) = place(found);
            let row = |what: &str| row_of(step, &page, moment.clone(), what);
            if let Step::Language { chosen: Some(language), .. } = found {
                events.push(row(language));
            }
            // What was answered during a ride is among what happened in it: nobody was on a page.
            let on_page = |kept: &&KeptSheet| kept.step == step && found.drives().is_none();
            for kept in sheets.iter().filter(on_page) {
                let sheet = kept.sheet();
                if let (Step::Aftercare { again: Some(asked), .. }, Some(sheet)) = (found, &sheet) {
                    let felt = sheet.answers.iter().flatten();
                    events.extend(felt.map(|answer| EventRow {
                        value: Some(f64::from(*answer)),
                        ..row(&format!("felt:{}", asked.scale))
                    }));
                }
                events.push(EventRow {
                    value: sheet.as_ref().map(|sheet| sheet.seconds),
                    at: written(kept.given),
                    ..row(if sheet.is_some_and(|s| s.agreed) { "agreed" } else { "answered" })
                });
            }
            self.driven(person, (step, found), &row, events)?;
            let done = repeated.iter().chain(&decided);
            for done in done.filter(|done| done.step == step) {
                events.push(EventRow {
                    attempt: done.attempt,
                    at: written(done.given),
                    ..row(&done.what)
                });
            }
            for left in left_out.iter().filter(|left| left.step == step) {
                let drives = found.ride().is_some();
                let begun = self.begun(&person.participant, step)?;
                let ticks = begun.last().map_or(0, |begun| begun.ticks);
                events.push(EventRow {
                    time_s: drives.then_some(ticks as f64 / TICKS_PER_S),
                    at: written(left.given),
                    ..row(&left.what)
                });
            }
        }
        if let Some(how) = &person.ended {
            let last = person.at.min(person.steps.len().saturating_sub(1));
            events.push(row_of(last, END, None, how));
        }
        Ok(())
    }

    /// What happened in the drives of a step.
    fn driven(
        &self,
        person: &Person,
        (step, found): (usize, &Step),
        row: &dyn Fn(&str) -> EventRow,
        events: &mut Vec<EventRow>,
    ) -> Result<(), SeatError> {
        let Some((_, seconds)) = found.world() else {
            return Ok(());
        };
        let who = &person.participant;
        for begun in self.begun(who, step)? {
            let of_drive = |what: &str, tick: u64| EventRow {
                attempt: Some(begun.attempt),
                time_s: Some(tick as f64 / TICKS_PER_S),
                ..row(what)
            };
            let (at, lines) = self.noted(who, (step, begun.attempt))?;
            events.push(EventRow { at: written(at), ..of_drive("begun", 0) });
            for line in lines {
                let chunk = serde_json::from_str::<Chunk>(&line).unwrap_or_default();
                events.extend(chunk.events.iter().map(|event| EventRow {
                    value: event.points,
                    // Such as the name of a device, as it calls itself.
                    ..of_drive(&event.what.replace(|c: char| !is_text(c), ""), event.tick)
                }));
            }
            let in_time = (begun.ticks as f64) < seconds * TICKS_PER_S;
            let how = match found {
                _ if !begun.ended => "cut short",
                Step::Practice { .. } if in_time => "practice passed",
                Step::Practice { .. } => "practice not passed: its time was over",
                _ => "ended",
            };
            events.push(of_drive(how, begun.ticks));
        }
        Ok(())
    }

    /// Why somebody stopped in what they drove last at a step; none where they did not.
    pub(crate) fn stopped(
        &self,
        participant: &str,
        (step, found): (usize, &Step),
    ) -> Result<Option<String>, SeatError> {
        let last = self.begun(participant, step)?.pop();
        let Some(last) = last.filter(|last| !last.set_aside) else {
            return Ok(None);
        };
        let (_, lines) = self.noted(participant, (step, last.attempt))?;
        let chunks = lines.iter().map(|line| serde_json::from_str::<Chunk>(line));
        let events = chunks.filter_map(Result::ok).flat_map(|chunk| chunk.events);
        // Only what was checked was kept.
        let mut reasons = events.filter_map(|event| found.stopped(&event)?.ok());
        Ok(reasons.next())
    }

    /// Tells whoever runs the study of somebody who feels unwell still, some time after they stopped.
    pub(crate) fn feels_again(
        &self,
        person: &Person,
        found: &Step,
        kept: &str,
    ) -> Result<(), SeatError> {
        let Step::Aftercare { again: Some(asked), .. } = found else {
            return Ok(());
        };
        // Only what was checked is kept.
        let sheet = serde_json::from_str::<Sheet>(kept).unwrap_or_default();
        let still = sheet.answers.iter().flatten();
        for answer in still.filter(|answer| asked.stops(**answer)) {
            let (scale, minutes) = (&asked.scale, sheet.seconds / 60.0);
            let text =
                format!("still unwell {minutes:.0} min after they stopped: {scale} {answer}");
            self.event(Some(&person.participant), &text)?;
        }
        Ok(())
    }

    /// When a drive was begun, and those of its pieces in which something happened.
    fn noted(
        &self,
        participant: &str,
        (step, attempt): (usize, u32),
    ) -> Result<(i64, Vec<String>), SeatError> {
        self.ask(|c| {
            let key = params![participant, whole(step), attempt];
            let begun = c
                .prepare_cached(
                    "SELECT begun FROM drive WHERE participant = ?1 AND step = ?2 AND attempt = ?3",
                )?
                .query_row(key, |row| row.get(0))?;
            let mut pieces = c.prepare_cached(
                "SELECT line FROM piece WHERE participant = ?1 AND step = ?2 AND attempt = ?3 AND line LIKE '%\"events\"%' ORDER BY from_tick",
            )?;
            let lines = pieces.query_map(key, |row| row.get(0))?;
            Ok((begun, lines.collect::<rusqlite::Result<_>>()?))
        })
    }
}

/// A drive or a ride that somebody stopped, or that the experimenter left out; the practice is none of the study's.
fn stopped_in(event: &EventRow) -> Option<Stopped> {
    let acts = [Act::Skip, Act::Abort];
    // What a page says of a drive has no time of day.
    let left_out = event.at.is_some() && acts.iter().any(|act| event.what.starts_with(act.past()));
    let reason = event.what.strip_prefix(STOPPED);
    let reason = reason.or_else(|| left_out.then_some(&event.what))?;
    let ride: Ride = event.page.parse().ok().filter(|_| event.page != PRACTICE)?;
    Some(Stopped {
        participant: event.participant.clone(),
        condition: ride.condition,
        session: ride.occasion.session,
        trial: ride.occasion.trial,
        time_s: event.time_s?,
        reason: reason.to_owned(),
    })
}

/// The texts that somebody agreed to.
fn consents_of<'a>(
    sheets: &'a [KeptSheet],
    who: &'a ParticipantId,
) -> impl Iterator<Item = ConsentRow> + 'a {
    sheets.iter().filter_map(|kept| {
        let sheet = kept.sheet()?;
        Some(ConsentRow {
            participant: who.clone(),
            step: kept.step + 1,
            text_sha256: sheet.text_sha256?,
            style_lent: sheet.style_lent,
            at: written(kept.given),
        })
    })
}

/// What a step is called in the tables, and the moment of a scale.
fn place(step: &Step) -> (String, Option<String>) {
    match step {
        Step::Language { .. } => ("language".to_owned(), None),
        Step::Computer { .. } => ("computer".to_owned(), None),
        Step::Screen { .. } => ("screening".to_owned(), None),
        Step::Text { .. } => ("consent".to_owned(), None),
        Step::Scale { scale, moment, .. } => (scale.clone(), Some(moment.to_string())),
        Step::Break { .. } => ("break".to_owned(), None),
        Step::Controls => ("controls".to_owned(), None),
        Step::Practice { .. } => (PRACTICE.to_owned(), None),
        Step::Drive { .. } | Step::Ride { .. } | Step::Elsewhere { .. } => {
            (step.ride().map_or_else(String::new, |ride| ride.to_string()), None)
        }
        Step::Between { .. } => ("between".to_owned(), None),
        Step::Aftercare { .. } => ("aftercare".to_owned(), None),
        Step::Thanks { .. } => ("thanks".to_owned(), None),
    }
}

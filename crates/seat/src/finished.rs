//! What becomes of a drive that has ended: it is driven again from its record, so that the log holds what the page went through, and
//! a drive by hand is learned from here too.

use crate::{error::SeatError, person::Person, seat::Seat, steps::Step};
use maveric_seat_page::{Fit, Record, Replayed, fit, replay};

/// Embeddings of the page and of a processor that fuses its sums agree to this.
const SAME_STYLE: f64 = 1e-5;

impl Seat {
    /// Writes the drive of `step` and those that were cut short before it; false, and nothing done, while none has ended.
    ///
    /// What cannot be driven again is kept as it came, said on the experimenter's page, and holds nobody up.
    ///
    /// # Errors
    /// [`SeatError::Store`]; [`SeatError::Study`] if a file cannot be written.
    pub(crate) fn finish_drive(
        &self,
        person: &Person,
        step: usize,
        found: &Step,
    ) -> Result<bool, SeatError> {
        let begun = self.store.begun(&person.participant, step)?;
        let Some(whole) = begun.iter().find(|b| b.ended) else {
            return Ok(false);
        };
        let Some((condition, by_hand)) = found.drives() else {
            return Ok(true);
        };
        let (who, files) = (&person.participant, &self.settings.files);
        let name = format!("{who}-{condition}");
        for cut in begun.iter().filter(|b| b.attempt != whole.attempt) {
            let lines = self.store.record(who, (step, cut.attempt))?;
            files.record(&name, Some(cut.attempt), &lines)?;
        }
        let lines = self.store.record(who, (step, whole.attempt))?;
        files.record(&name, None, &lines)?;
        let driven = Record::from_lines(&lines).and_then(|record| Ok((replay(&record)?, record)));
        match driven {
            Err(error) => self.tell(who, &format!("{name}: cannot be driven again: {error}"))?,
            Ok((again, record)) => {
                files.log(&name, (who, condition), &record, &again)?;
                self.tell(who, &format!("{name}: {}", pictures(&record)))?;
                if !again.same() {
                    let text = "the page came through other states than its record gives here";
                    self.tell(who, &format!("{name}: {text}"))?;
                }
                if let Step::Ride {
                    turns: Some(step), ..
                } = found
                {
                    let events = record.chunks.iter().flat_map(|c| &c.events);
                    let turned: Vec<(f64, f64)> = events
                        .filter(|e| e.what == "dial")
                        .filter_map(|e| Some((e.tick as f64 / 100.0, e.points?)))
                        .collect();
                    let seconds = record.ticks() as f64 / 100.0;
                    files.turns((&name, who), &turned, step.abs(), seconds)?;
                }
                if by_hand {
                    self.learn(person, &name, &record, &again)?;
                }
            }
        }
        Ok(true)
    }

    fn tell(&self, who: &str, what: &str) -> Result<(), SeatError> {
        self.store.event(Some(who), what)
    }

    /// Learns of a drive by hand where the page did not come to it, and holds what the page learned against it.
    fn learn(
        &self,
        person: &Person,
        name: &str,
        record: &Record,
        again: &Replayed,
    ) -> Result<(), SeatError> {
        let Some(model) = &self.model else {
            return Ok(());
        };
        let who = &person.participant;
        let here = match fit(model, &again.rollout.recording, record.header.driven_by) {
            Ok(here) => here,
            Err(error) => return self.tell(who, &format!("{name}: no style learned: {error}")),
        };
        let page: Option<Fit> = person
            .fit
            .as_deref()
            .and_then(|f| serde_json::from_str(f).ok());
        let Some(page) = page else {
            let kept = serde_json::to_string(&here).unwrap_or_default();
            return self.store.fit(&person.token, &kept);
        };
        let apart = (page.embedding.iter().zip(&here.embedding))
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        if page.embedding.len() != here.embedding.len() || apart > SAME_STYLE {
            let text = format!(
                "{name}: the page learned another style than its record gives here, {apart:.2e} apart"
            );
            self.tell(who, &text)?;
        }
        Ok(())
    }
}

/// How the pictures of a drive came.
fn pictures(record: &Record) -> String {
    let frames = || record.chunks.iter().map(|c| c.frames);
    let drawn: u64 = frames().map(|f| u64::from(f.drawn)).sum();
    let late: u64 = frames().map(|f| u64::from(f.late)).sum();
    let left_out: u64 = frames().map(|f| u64::from(f.dropped_steps)).sum();
    let longest_ms = frames().map(|f| f.longest_ms).max().unwrap_or(0);
    let input_ms = frames().map(|f| f.input_ms).max().unwrap_or(0);
    let seconds = record.ticks() as f64 / 100.0;
    let seen = match input_ms {
        0 => String::new(),
        ms => format!(", a key seen after at most {ms} ms"),
    };
    let mark = if 100 * late > drawn {
        "; more than 1 % came late"
    } else {
        ""
    };
    format!(
        "{seconds:.0} s, {:.1} pictures a second, {late} of {drawn} over 50 ms after the one before (longest {longest_ms} ms){seen}, \
         {left_out} steps left out{mark}",
        drawn as f64 / seconds.max(0.01)
    )
}

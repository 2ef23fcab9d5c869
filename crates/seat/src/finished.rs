//! What becomes of a drive that has ended: it is driven again from its record, so that the log holds what the page went through, and
//! a drive by hand is learned from here too.

use crate::{
    crash::CRASH,
    drives::Begun,
    error::SeatError,
    person::Person,
    seat::Seat,
    sheet::Sheet,
    steps::{DEVICE_GONE, Step, TICKS_PER_S},
};
use maveric_domain::{DriveId, Embedding, ParticipantId};
use maveric_seat_page::{Event, Record, Replayed, RideStyle, fit, replay};
use maveric_study::beyond_in_words;
use std::fmt;

/// Embeddings of the page and of a processor that fuses its sums agree to this.
const SAME_STYLE: f64 = 1e-5;

impl Seat {
    /// Writes what somebody drove of a step at which they stopped, since they felt unwell: nothing is learned of it, and nothing is driven
    /// after it.
    pub(crate) fn stop_drive(
        &self,
        person: &Person,
        (step, found): (usize, &Step),
        reason: &str,
    ) -> Result<(), SeatError> {
        let why = format!("the person stopped ({reason})");
        self.write_drive(person, (step, found), Some(&why))?;
        self.store.within(|b| {
            b.event(Some(&person.participant), &format!("step {}: {why}", step + 1))?;
            b.stop(person, step)
        })
    }

    /// Writes what somebody drove of a step at which they left and let it be kept, cut short as it is: nothing is learned of it.
    pub(crate) fn keep_unfinished(&self, person: &Person, step: usize) -> Result<(), SeatError> {
        match person.steps.get(step) {
            Some(found) => {
                let why = "the person left";
                self.write_drive(person, (step, found), Some(why)).map(drop)
            }
            None => Ok(()),
        }
    }

    /// Writes the drive of `step` that ended, or where `left` says why there is no more the last as it is, and those that were cut short
    /// before it; false, and nothing done, while there is none.
    ///
    /// What cannot be driven again is kept as it came, said on the experimenter's page, and holds nobody up.
    ///
    /// # Errors
    /// [`SeatError::Store`]; [`SeatError::Study`] if a file cannot be written.
    pub(crate) fn write_drive(
        &self,
        person: &Person,
        (step, found): (usize, &Step),
        left: Option<&str>,
    ) -> Result<bool, SeatError> {
        let read = self.store.look(|b| {
            let begun = b.begun(&person.participant, step)?;
            let record = |a: &Begun| b.record(&person.participant, (step, a.attempt));
            let lines: Result<Vec<String>, SeatError> = begun.iter().map(record).collect();
            Ok::<_, SeatError>((lines?, begun))
        });
        let (lines, begun) = read?;
        let last = || begun.iter().rposition(|b| b.ticks > 0 && !b.set_aside);
        let ended = begun.iter().rposition(Begun::is_whole);
        let Some(whole) = ended.or_else(|| last().filter(|_| left.is_some())) else {
            return Ok(false);
        };
        let Some((ride, _)) = found.drives() else {
            return Ok(true);
        };
        let (who, files) = (&person.participant, &self.settings.files);
        let participant = ParticipantId::new(who.as_str())?;
        let name = DriveId::in_condition(&participant, ride)?;
        let name = name.as_str();
        let mut outcome = Outcome { name: name.to_owned(), ..Outcome::default() };
        for (place, cut) in begun.iter().enumerate().filter(|(at, _)| *at != whole) {
            files.record(name, Some(cut.kept_as()), &lines[place])?;
        }
        let lines = &lines[whole];
        files.record(name, None, lines)?;
        let driven = Record::from_lines(lines).and_then(|record| Ok((replay(&record)?, record)));
        match driven {
            Err(error) => outcome.tell(&format!("cannot be driven again: {error}")),
            Ok((again, record)) => {
                let pictures = Pictures::from_record(&record);
                let cut = left.map(|why| {
                    let seconds = record.ticks() as f64 / TICKS_PER_S;
                    format!("{why} after {seconds:.0} s, and what was driven is kept")
                });
                // What is said of it here as well as in its log; the rest is said in words of its own, or was before.
                let remarks = [crash_note(&record), gone_note(&record), mark(person, found)];
                let remarks: Vec<String> = remarks.into_iter().flatten().collect();
                for text in &remarks {
                    outcome.tell(text);
                }
                let notes: Vec<String> =
                    cut.into_iter().chain(pictures.note()).chain(remarks).collect();
                let note = (!notes.is_empty()).then(|| notes.join("; "));
                let kept = (&record, lines.as_str(), note.as_deref());
                files.log(name, (who, ride), kept, &again)?;
                outcome.tell(&pictures.to_string());
                if ended.is_some() && !again.same() {
                    outcome.tell("the page came through other states than its record gives here");
                }
                outcome.probes = probes_of(found, &record);
                if let Some(text) = self.shows_another(person, found, &record)? {
                    outcome.tell(text);
                }
                if let Step::Ride { turns: Some(step), .. } = found {
                    let turned: Vec<(f64, f64)> = events(&record, "dial")
                        .filter_map(|e| Some((e.tick as f64 / TICKS_PER_S, e.points?)))
                        .collect();
                    let seconds = record.ticks() as f64 / TICKS_PER_S;
                    files.turns((name, who), &turned, step.abs(), seconds)?;
                }
                if let Some(apart) = self.style_apart(person, found, &record) {
                    outcome.tell(&format!(
                        "the page drove another style than the study's for this person, {apart:.2e} apart"
                    ));
                }
                if found.is_learned_of() && left.is_none() {
                    self.learn(person, (&record, &again), &mut outcome);
                }
            }
        }
        self.keep(person, (step, left.is_some()), &outcome)?;
        Ok(true)
    }

    /// How far the style that a ride began with is from the one that the step asks for; none where they agree, or nobody can say.
    fn style_apart(&self, person: &Person, found: &Step, record: &Record) -> Option<f64> {
        let Step::Ride { style, points, .. } = found else {
            return None;
        };
        if *style == RideStyle::Replay {
            return None;
        }
        let model = self.model.as_ref()?;
        let fitted = person.style().and_then(|fit| Embedding::new(fit.embedding).ok());
        let own_embedding = fitted.unwrap_or_else(|| model.mean_embedding().clone());
        let expected = style.place(model, &own_embedding, *points).ok()?.embedding;
        let apart = apart(record.header.style.as_ref()?.coordinates(), expected.coordinates());
        (apart > SAME_STYLE).then_some(apart)
    }

    /// What is said of a ride that is to show the person's drive by hand again and shows another; none where it is that, or shows none.
    fn shows_another(
        &self,
        person: &Person,
        found: &Step,
        record: &Record,
    ) -> Result<Option<&'static str>, SeatError> {
        if !matches!(found, Step::Ride { style, .. } if *style == RideStyle::Replay) {
            return Ok(None);
        }
        let driven = self.store.look(|b| b.own_drive(person))?;
        let driven = driven.and_then(|lines| Record::from_lines(&lines).ok());
        let same = driven.is_some_and(|driven| record.shows(&driven));
        Ok((!same).then_some("the page showed another drive than the person's own"))
    }

    /// Keeps what came of a drive and goes on, both or neither. Who was forgotten meanwhile has nothing kept, and what was written of
    /// them goes again.
    fn keep(
        &self,
        person: &Person,
        (step, left): (usize, bool),
        outcome: &Outcome,
    ) -> Result<(), SeatError> {
        let stays = self.store.within(|b| {
            let stays = b.person(&person.token)?.is_some();
            if stays {
                for text in &outcome.told {
                    b.event(Some(&person.participant), text)?;
                }
                if let Some(style) = &outcome.style {
                    b.fit(person, style)?;
                    self.lend(b, person, style)?;
                }
                if let Some(probes) = &outcome.probes {
                    b.keep_sheet(person, step, probes)?;
                }
                if !left {
                    b.go_on(person, step)?;
                }
            }
            Ok::<_, SeatError>(stays)
        })?;
        if !stays {
            self.without_writing(|files| files.forget(&person.participant))?;
        }
        Ok(())
    }

    /// Learns of a drive by hand: what was driven counts, and what the page learned is held against it.
    fn learn(&self, person: &Person, (record, again): (&Record, &Replayed), outcome: &mut Outcome) {
        let Some(model) = &self.model else {
            return;
        };
        let learned = match fit(model, &again.rollout.recording, record.header.driven_by) {
            Ok(learned) => learned,
            Err(error) => return outcome.tell(&format!("no style learned: {error}")),
        };
        if let Some(why) = &learned.beyond {
            outcome.tell(&format!(
                "beyond what the model has learned from: {}; rides go on, marked",
                beyond_in_words(why)
            ));
        }
        if learned.beyond.is_none() && learned.readings == 0 {
            outcome.tell("no style was learned of it: where a ride begins from the person's own, it begins from the average driver's");
        }
        outcome.style = serde_json::to_string(&learned).ok();
        let Some(page) = person.style() else {
            return;
        };
        let apart = apart(&page.embedding, &learned.embedding);
        if apart > SAME_STYLE {
            outcome.tell(&format!(
                "the page learned another style than its record gives here, {apart:.2e} apart; the record's is kept"
            ));
        }
    }
}

/// The largest difference of two styles' numbers.
fn apart(one: &[f64], other: &[f64]) -> f64 {
    if one.len() != other.len() {
        return f64::INFINITY;
    }
    let differences = one.iter().zip(other).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

/// What was answered on the way, as a sheet; none where nothing was asked. Of several answers to one probe the first counts.
fn probes_of(step: &Step, record: &Record) -> Option<String> {
    let Step::Ride { probe: Some(probe), .. } = step else {
        return None;
    };
    // Only what was checked was kept.
    let answers = events(record, "").filter_map(|event| probe.answer(event)?.ok());
    let mut sheet = Sheet::default();
    for (at_s, answer) in answers {
        let before = sheet.probes.last().map(|(before_s, _)| *before_s);
        if before.is_none_or(|before_s| at_s > before_s) {
            sheet.probes.push((at_s, answer));
        }
    }
    serde_json::to_string(&sheet).ok()
}

/// What is said of a ride in a style that was learned of a drive beyond what the model has learned from, or of one that showed nothing.
fn mark(person: &Person, step: &Step) -> Option<String> {
    let Step::Ride { style, lent, .. } = step else {
        return None;
    };
    let theirs = matches!(style, RideStyle::Own | RideStyle::Across(_) | RideStyle::Lent { .. });
    if !theirs && lent.is_none() {
        return None;
    }
    let is_lent = lent.is_some() || matches!(style, RideStyle::Lent { .. });
    let fit = person.style()?;
    let nothing = if is_lent {
        "the car has somebody else's style, drawn as for the average driver: none was learned of this person's drive by hand"
    } else {
        "the car has the average driver's style, moved as the condition says: none was learned of this person's drive by hand"
    };
    match &fit.beyond {
        Some(why) => Some(format!(
            "the car has a style that says little of this person, whose drive by hand {}",
            beyond_in_words(why)
        )),
        None => (fit.readings == 0).then(|| nothing.to_owned()),
    }
}

/// What happened in a drive, by how it begins.
fn events<'a>(record: &'a Record, what: &'a str) -> impl Iterator<Item = &'a Event> {
    let events = record.chunks.iter().flat_map(|chunk| &chunk.events);
    events.filter(move |event| event.what.starts_with(what))
}

/// What is said of a drive that ended with a crash.
fn crash_note(record: &Record) -> Option<String> {
    let crash = events(record, CRASH).next()?;
    let seconds = crash.tick as f64 / TICKS_PER_S;
    Some(format!("the car hit another vehicle after {seconds:.0} s, and the drive ended there"))
}

/// What is said of a drive during which the device was gone with which somebody drove.
fn gone_note(record: &Record) -> Option<String> {
    match events(record, DEVICE_GONE).count() {
        0 => None,
        1 => Some("the device was gone once, and everything waited for it".to_owned()),
        n => Some(format!("the device was gone {n} times, and everything waited for it")),
    }
}

/// What came of a drive, beside its files.
#[derive(Default)]
struct Outcome {
    name: String,
    /// What whoever runs the study is told.
    told: Vec<String>,
    /// The style that was learned.
    style: Option<String>,
    /// What was answered on the way, as a sheet.
    probes: Option<String>,
}

impl Outcome {
    fn tell(&mut self, text: &str) {
        self.told.push(format!("{}: {text}", self.name));
    }
}

/// How the pictures of a drive came.
struct Pictures {
    seconds: f64,
    drawn: u64,
    late: u64,
    left_out: u64,
    longest_ms: u32,
    input_ms: u32,
}

impl Pictures {
    fn from_record(record: &Record) -> Self {
        let frames = || record.chunks.iter().map(|c| c.frames);
        Self {
            seconds: record.ticks() as f64 / TICKS_PER_S,
            drawn: frames().map(|f| u64::from(f.drawn)).sum(),
            late: frames().map(|f| u64::from(f.late)).sum(),
            left_out: frames().map(|f| u64::from(f.dropped_steps)).sum(),
            longest_ms: frames().map(|f| f.longest_ms).max().unwrap_or(0),
            input_ms: frames().map(|f| f.input_ms).max().unwrap_or(0),
        }
    }

    /// What the drive's log says of them where more than one in a hundred came late.
    fn note(&self) -> Option<String> {
        let Self { drawn, late, .. } = self;
        (100 * late > *drawn).then(|| {
            format!("{late} of {drawn} pictures came more than 50 ms after the one before: more than 1 %")
        })
    }
}

impl fmt::Display for Pictures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rate = self.drawn as f64 / self.seconds.max(0.01);
        write!(
            f,
            "{:.0} s, {rate:.1} pictures a second, {} of {} over 50 ms after the one before (longest {} ms)",
            self.seconds, self.late, self.drawn, self.longest_ms
        )?;
        if self.input_ms > 0 {
            write!(f, ", a key seen after at most {} ms", self.input_ms)?;
        }
        write!(f, ", {} steps left out", self.left_out)?;
        self.note().map_or(Ok(()), |_| write!(f, "; more than 1 % came late"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::DrivenBy;
    use maveric_seat_page::SeatDrive;
    use maveric_simulator::Scenario;

    #[test]
    fn a_ride_in_the_own_style_is_marked_where_the_drive_is_beyond_and_no_other_is() {
        let ride = |style| Step::Ride {
            condition: "mimic".parse().unwrap(),
            occasion: maveric_domain::Occasion::FIRST,
            number: 1,
            seconds: 10.0,
            seed: "1".to_owned(),
            style,
            points: 0.0,
            turns: None,
            lent: None,
            probe: None,
        };
        let mut person = Person::new("t".to_owned(), "P001".to_owned(), Vec::new());
        assert_eq!(mark(&person, &ride(RideStyle::Own)), None);
        let fit = |known: &str| {
            let text = format!(r#"{{"embedding":[0.0],"covariance":null,{known},"readings":3}}"#);
            Some(text)
        };
        person.fit = fit(r#""score":30.0"#);
        assert_eq!(mark(&person, &ride(RideStyle::Own)), None);
        person.fit = fit(r#""score":null,"beyond":"scale""#);
        let text = mark(&person, &ride(RideStyle::Own)).unwrap();
        assert!(text.contains("the scale does not have"), "{text}");
        assert_eq!(mark(&person, &ride(RideStyle::Mean)), None);
        let nothing = r#"{"embedding":[0.0],"covariance":null,"score":null,"readings":0}"#;
        person.fit = Some(nothing.to_owned());
        let text = mark(&person, &ride(RideStyle::Own)).unwrap();
        assert!(text.contains("the average driver's style"), "{text}");
        assert_eq!(mark(&person, &ride(RideStyle::Mean)), None);
        let lent = RideStyle::Lent {
            apart_sd: [1.0, 3.0],
            seed: maveric_seat_page::Seed(1),
            withheld: std::collections::BTreeSet::new(),
        };
        let text = mark(&person, &ride(lent)).unwrap();
        assert!(text.contains("somebody else's style"), "{text}");
    }

    #[test]
    fn a_drive_for_whose_device_everything_waited_says_how_often() {
        let record = |events: &str| {
            let chunk = format!(
                r#"{{"from_tick":0,"ticks":1,"held":[],"frames":{{"drawn":1,"late":0,"dropped_steps":0,"longest_ms":30,"input_ms":0}},"events":[{events}]}}"#
            );
            let scenario = Scenario::paper();
            let drive = SeatDrive::by_hand(&scenario, 1, DrivenBy::Human).unwrap();
            Record {
                header: drive.begun().header.clone(),
                chunks: vec![serde_json::from_str(&chunk).unwrap()],
                end: None,
            }
        };
        let gone = r#"{"tick":1,"what":"device gone: G29","points":null}"#;
        let plugged = r#"{"tick":1,"what":"unplugged: G29","points":null}"#;
        assert_eq!(gone_note(&record(plugged)), None);
        assert!(gone_note(&record(gone)).unwrap().contains("gone once"));
        let twice = format!("{gone},{plugged},{gone}");
        assert!(gone_note(&record(&twice)).unwrap().contains("gone 2 times"));
    }

    #[test]
    fn a_drive_of_which_more_than_one_picture_in_a_hundred_came_late_says_so() {
        let pictures = |late| Pictures {
            seconds: 10.0,
            drawn: 600,
            late,
            left_out: 0,
            longest_ms: 80,
            input_ms: 0,
        };
        assert_eq!(pictures(6).note(), None);
        assert!(pictures(7).note().unwrap().starts_with("7 of 600 pictures"));
        assert!(pictures(7).to_string().ends_with("0 steps left out; more than 1 % came late"));
    }
}

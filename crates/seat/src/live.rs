//! What goes on, as the experimenter's page shows it: a summary of everybody that reads nobody's steps.

use crate::{
    books::Books,
    disk,
    error::SeatError,
    escaped::plain,
    known::Known,
    person::{NEVER_CAME, NOT_ADMITTED, style_kept},
    refusals::Refusal,
    request::Shared,
    steps::{DEVICE_GONE, TICKS_PER_S},
    words::Words,
};
use maveric_seat_page::{Chunk, Fit};
use maveric_study::beyond_in_words;
use std::fmt::Write as _;

/// Things that happened which are shown.
const SHOWN: u32 = 200;

/// The parts of the page that may change, by the ids of their places.
pub(crate) const REFUSED: &str = "refused";
pub(crate) const PEOPLE: &str = "people";
pub(crate) const HAPPENED: &str = "happened";
pub(crate) const DISK: &str = "disk";

struct Whereabouts {
    token: String,
    at: usize,
    ended: Option<String>,
    /// When they came to the step, or ended, in s since 1970.
    since: i64,
    fit: Option<String>,
    /// Steps of 0.01 s of what they drive now, and its last piece.
    driven: Option<(u64, Option<String>)>,
    /// Whether everything that they drove is out of the analysis.
    excluded: bool,
}

impl Books<'_> {
    /// Where everybody is, in the order in which they were let in.
    fn whereabouts(&self) -> Result<Vec<Whereabouts>, SeatError> {
        self.rows(
            "SELECT p.token, p.at, p.ended, p.since, p.fit, d.ticks,
                (SELECT line FROM piece WHERE participant = d.participant AND step = d.step AND attempt = d.attempt
                 ORDER BY from_tick DESC LIMIT 1),
                COALESCE((SELECT what LIKE 'excluded: %' FROM decided WHERE participant = p.participant
                    AND (what LIKE 'excluded: %' OR what LIKE 'counts again: %') ORDER BY rowid DESC LIMIT 1), 0)
             FROM person p LEFT JOIN drive d ON p.ended IS NULL AND d.participant = p.participant AND d.step = p.at
                AND d.attempt = (SELECT MAX(attempt) FROM drive WHERE participant = p.participant AND step = p.at)
             ORDER BY p.rowid",
            [],
            |row| {
                let ticks: Option<i64> = row.get(5)?;
                let piece = row.get(6)?;
                Ok(Whereabouts {
                    token: row.get(0)?,
                    at: row.get::<_, i64>(1)? as usize,
                    ended: row.get(2)?,
                    since: row.get(3)?,
                    fit: row.get(4)?,
                    driven: ticks.map(|ticks| (ticks.cast_unsigned(), piece)),
                    excluded: row.get(7)?,
                })
            },
        )
    }

    /// How many people have not ended.
    pub(crate) fn on_the_way(&self) -> Result<i64, SeatError> {
        self.ask(|c| {
            c.query_row("SELECT COUNT(*) FROM person WHERE ended IS NULL", [], |row| row.get(0))
        })
    }
}

/// What may change of the page: parts and what stands in them. What was refused is shown even where nothing can be read.
pub(crate) async fn parts(shared: &Shared) -> Vec<(&'static str, String)> {
    let read = shared.blocking(|seat| {
        let (people, events) =
            seat.store.look(|b| Ok::<_, SeatError>((b.whereabouts()?, b.events(SHOWN)?)))?;
        let known = people.into_iter().filter_map(|there| Some((seat.known(&there.token)?, there)));
        Ok::<_, SeatError>((known.collect::<Vec<_>>(), events))
    });
    let read = read.await;
    let words = shared.words();
    let mut refused = refused(&shared.refusals.newest_first(), words);
    let (people, events) = match read {
        Ok(read) => read,
        Err(error) => {
            let _ = write!(refused, "<p role=\"alert\">{}</p>", plain(&error.to_string()));
            return vec![(REFUSED, refused)];
        }
    };
    let people = people.iter().map(|(known, there)| row(known, there, words)).collect();
    let mut happened = String::new();
    for (who, what) in events {
        let who = who.map_or_else(String::new, |who| plain(&who));
        let _ = write!(happened, "<tr><td>{who}<td>{}", plain(&what));
    }
    let disk = shared.seat.settings.files.folder().and_then(disk::left);
    vec![
        (REFUSED, refused),
        (PEOPLE, people),
        (HAPPENED, happened),
        (DISK, disk.map_or_else(String::new, |bytes| room(bytes, words))),
    ]
}

/// What the disk has left, and whether that is little.
fn room(bytes: u64, words: &Words) -> String {
    let gb = disk::in_gb(bytes);
    let free = words.plain("lab_disk", &[("gb", &gb)]);
    if bytes < disk::LITTLE {
        format!("<strong role=\"alert\">{free} {}</strong>", words.plain("lab_disk_little", &[]))
    } else {
        free
    }
}

/// What the server refused or could not keep.
fn refused(all: &[Refusal], words: &Words) -> String {
    if all.is_empty() {
        return String::new();
    }
    let say = |name| words.plain(name, &[]);
    let mut table = format!(
        "<h2>{}</h2><table><thead><tr><th>{}<th>{}<th>{}<th>{}<tbody>",
        say("lab_refused"),
        say("lab_person"),
        say("lab_what"),
        say("lab_how_often"),
        say("lab_last")
    );
    for refusal in all {
        let somebody = words.sentence("lab_somebody");
        let who = refusal.participant.as_deref().unwrap_or(somebody);
        let _ = write!(
            table,
            "<tr><td>{}<td>{}<td>{}<td>{}",
            plain(who),
            plain(&refusal.why),
            words.plain("lab_times", &[("n", &refusal.times.to_string())]),
            time(refusal.last_s)
        );
    }
    table + "</table>"
}

/// A moment, of which the page says how long ago it is.
fn time(unix_s: i64) -> String {
    let moment = chrono::DateTime::from_timestamp(unix_s, 0).unwrap_or_default();
    format!("<time data-since=\"{unix_s}\">{} UTC</time>", moment.format("%H:%M:%S"))
}

fn row(known: &Known, there: &Whereabouts, words: &Words) -> String {
    let say = |name| words.plain(name, &[]);
    let (at, steps) = (there.at, known.steps.len());
    let mut place = match (&there.ended, known.steps.get(at)) {
        (Some(how), _) => ended(how, words),
        (None, Some(step)) => words.plain(
            "lab_at",
            &[
                ("step", &(at + 1).to_string()),
                ("of", &steps.to_string()),
                ("what", words.sentence(step.what)),
            ],
        ),
        (None, None) => say("lab_at_end"),
    };
    let mut pictures = String::new();
    if let (Some((ticks, piece)), Some(step)) = (&there.driven, known.steps.get(at)) {
        let seconds = step.seconds.unwrap_or_default();
        let driven = format!("{:.0}", *ticks as f64 / TICKS_PER_S);
        place +=
            &words.plain("lab_driven", &[("seconds", &driven), ("of", &format!("{seconds:.0}"))]);
        let piece = piece.as_deref().and_then(|line| serde_json::from_str::<Chunk>(line).ok());
        // Everything waits for a device that is gone: the piece that says so stays the last.
        let gone = |piece: &Chunk| piece.events.iter().any(|e| e.what.starts_with(DEVICE_GONE));
        if piece.as_ref().is_some_and(gone) {
            let _ = write!(place, "<br><strong>{}</strong>", say("lab_device_gone"));
        }
        // Only pieces of some steps are kept.
        pictures = piece.map_or(pictures, |piece| {
            format!("{:.0}", f64::from(piece.frames.drawn) * TICKS_PER_S / piece.ticks as f64)
        });
    }
    let beyond = match style_kept(there.fit.as_deref()) {
        Some(Fit { beyond: Some(why), .. }) => {
            words.plain("lab_beyond", &[("why", &beyond_in_words(&why))])
        }
        Some(Fit { readings: 0, .. }) => say("no_style"),
        _ => String::new(),
    };
    let rides: Vec<String> = known.rides.iter().map(|ride| plain(ride)).collect();
    let (link, who) = (format!("/p/{}", there.token), plain(&known.participant));
    // Whoever began came.
    let never_came = if at == 0 && there.ended.is_none() && there.driven.is_none() {
        format!(
            "<form method=\"post\" action=\"/lab/never/{who}\"><button>{}</button></form>",
            say("lab_never")
        )
    } else {
        String::new()
    };
    let step = if there.ended.is_none() && at < steps {
        format!("<a href=\"/lab/step/{who}/{at}\">{}</a>", say("lab_step"))
    } else {
        String::new()
    };
    format!(
        "<tr id=\"person-{who}\"><td><a href=\"/lab/above/{who}\">{who}</a><td>{place}<td>{}<td>{pictures}<td>{}<td>{beyond}\
         <td><a href=\"{link}\">{link}</a><td>{never_came}{step} <a href=\"/lab/exclude/{who}\">{}</a> <a href=\"/lab/forget/{who}\">{}</a>",
        time(there.since),
        rides.join(", "),
        say(if there.excluded { "lab_excluded" } else { "lab_exclude" }),
        say("lab_forget"),
    )
}

fn ended(how: &str, words: &Words) -> String {
    let name = match how {
        "done" => "lab_done",
        "left" => "lab_left",
        NOT_ADMITTED => "lab_not_admitted",
        NEVER_CAME => "lab_never_came",
        other => return plain(other),
    };
    words.plain(name, &[])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{person::Person, steps::Step};

    fn there(at: usize) -> Whereabouts {
        Whereabouts {
            token: "t".to_owned(),
            at,
            ended: None,
            since: 0,
            fit: None,
            driven: None,
            excluded: false,
        }
    }

    fn known(steps: Vec<Step>) -> Known {
        Known::from_person(&Person::new("t".to_owned(), "P001".to_owned(), steps))
    }

    #[test]
    fn whose_drive_is_beyond_what_the_model_has_met_is_marked_among_the_people() {
        let mut there = there(0);
        assert!(!row(&known(Vec::new()), &there, &Words::default()).contains("beyond"));
        let fit = r#"{"embedding":[0.0],"covariance":null,"score":30.0,"readings":3,"beyond":"style:pass"}"#;
        there.fit = Some(fit.to_owned());
        let marked = row(&known(Vec::new()), &there, &Words::default());
        assert!(marked.contains("<td>beyond what the model has met: shows a style"), "{marked}");
        // Nothing was learned: the style is the average driver's.
        let fit = r#"{"embedding":[0.0],"covariance":null,"score":null,"readings":0}"#;
        for (readings, nothing) in [("0", true), ("3", false)] {
            let fit = fit.replace("\"readings\":0", &format!("\"readings\":{readings}"));
            there.fit = Some(fit);
            let marked = row(&known(Vec::new()), &there, &Words::default());
            assert_eq!(marked.contains("<td>No style was learned"), nothing, "{marked}");
        }
    }

    #[test]
    fn who_is_where_is_said_in_the_studys_language() {
        let words = Words::shipped("de");
        let known = known(vec![Step::Controls]);
        let mut there = there(0);
        let shown = row(&known, &there, &words);
        assert!(
            shown.contains("<td>Schritt 1 von 1: Bedienung<td>") && shown.contains("Vergessen …"),
            "{shown}"
        );
        there.ended = Some(NOT_ADMITTED.to_owned());
        assert!(row(&known, &there, &words).contains("<td>nicht zugelassen<td>"));
        there.ended = Some("by hand".to_owned());
        assert!(row(&known, &there, &words).contains("<td>by hand<td>"));
    }

    #[test]
    fn who_drives_is_shown_with_how_far_and_how_many_pictures_a_second_the_last_piece_had() {
        let practice = Step::Practice {
            seconds: 300.0,
            lane_kept_s: 30.0,
            passes: 1,
            seed: "1".to_owned(),
            probe: None,
        };
        let known = known(vec![Step::Controls, practice]);
        let mut there = there(0);
        let shown = row(&known, &there, &Words::default());
        assert!(
            shown.contains(
                "<td>step 1 of 2: controls<td><time data-since=\"0\">00:00:00 UTC</time><td><td>"
            ),
            "{shown}"
        );
        assert!(shown.contains("Never came"));
        there.at = 1;
        let piece = r#"{"from_tick":6400,"ticks":50,"held":[[50,0,0,0,0]],"frames":{"drawn":29,"late":0,"dropped_steps":0,"longest_ms":30,"input_ms":0}}"#;
        there.driven = Some((6_450, Some(piece.to_owned())));
        let shown = row(&known, &there, &Words::default());
        assert!(
            shown.contains("step 2 of 2: practice, 64 of 300 s<td>")
                && shown.contains("<td>58<td>"),
            "{shown}"
        );
        assert!(!shown.contains("Never came"));
        assert!(!shown.contains("device"), "{shown}");
        // Everything waits for a device that is gone.
        let gone = piece.replace(
            "\"frames\"",
            "\"events\":[{\"tick\":6450,\"what\":\"device gone: G29\",\"points\":null}],\"frames\"",
        );
        there.driven = Some((6_450, Some(gone)));
        let shown = row(&known, &there, &Words::default());
        assert!(
            shown.contains(
                "64 of 300 s<br><strong>the device is gone, and everything waits</strong>"
            ),
            "{shown}"
        );
        // Begun, and nothing has come yet.
        there.driven = Some((0, None));
        assert!(row(&known, &there, &Words::default()).contains(
            "practice, 0 of 300 s<td><time data-since=\"0\">00:00:00 UTC</time><td><td>"
        ));
    }
}

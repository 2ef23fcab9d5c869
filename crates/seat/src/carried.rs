//! A study without a server: as a folder of static files, and what people's browsers hand back.

use crate::{
    assets,
    error::SeatError,
    intake,
    parts::Carried,
    person::NOT_ADMITTED,
    plan::Whose,
    seat::{Seat, SeatSettings},
    sheet::Sheet,
    steps::{STOPPED, Step},
    token, unnamed,
};
use maveric_domain::design::{Crash, Redirect, SeatView};
use maveric_seat_page::Fit;
use maveric_study::atomic_write::atomic_write_bytes;
use path_slash::PathExt as _;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The file by which a folder is known as a study's.
const STUDY: &str = "study.json";
/// Largest file that a person hands back, in bytes.
const LARGEST: u64 = 256 << 20;

/// What the page is told where no server tells it.
#[derive(Serialize)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a fact that the page is told"
)]
struct Static<'a> {
    title: &'a str,
    synthetic: bool,
    made_up_model: bool,
    mph: bool,
    scenario: &'a str,
    crash: Crash,
    view: &'a SeatView,
    /// Whether `model.maveric` is there.
    model: bool,
    /// Where what was given is sent; none where the person hands it over.
    post: Option<&'a str>,
    /// Where the platform is that pays.
    redirect: Option<&'a Redirect>,
    /// A row of the square each; the page draws one.
    rows: Vec<Vec<Step>>,
}

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Exported {
    /// The folder that holds them.
    pub folder: PathBuf,
    /// The names of its files, without the folder.
    pub files: Vec<String>,
    /// Orders of conditions among which the page draws.
    pub orders: usize,
}

/// Writes the seat's study as static files into `folder`; what people give is sent to `post`, or handed over by them as a file.
///
/// # Errors
/// [`SeatError::Protocol`] for a `post` that is no address over https, a folder that holds something else, what a server alone can do, or rides in somebody else's style
/// where too few let theirs be lent; [`SeatError::Store`]; [`SeatError::Study`] if a file cannot be written.
pub fn export(seat: &Seat, folder: &Path, post: Option<&str>) -> Result<Exported, SeatError> {
    let settings: &SeatSettings = &seat.settings;
    let origin = match post.map(|post| (post, url::Url::parse(post))) {
        None => None,
        Some((_, Ok(url))) if url.scheme() == "https" || local(&url) => {
            Some(url.origin().ascii_serialization())
        }
        Some((post, _)) => {
            return Err(SeatError::cannot(
                format!("`{post}` is no address to send answers to"),
                "expected https://…: answers do not travel in the clear",
            ));
        }
    };
    if !settings.in_others.is_empty() {
        return Err(SeatError::cannot(
            "[protocol] `languages` lets people choose, and static files speak one language",
            "write `language` alone, and export once a language",
        ));
    }
    if settings.design.protocol().withdraw_until.is_some() {
        return Err(SeatError::cannot(
            "by [protocol] `withdraw_until` people take back what they gave by their link, and static files give nobody one",
            "leave it out, and say in the consent how and until when people can ask you to delete what they sent",
        ));
    }
    let holds = |name: &str| folder.join(name).exists();
    let empty = std::fs::read_dir(folder).map_or(true, |mut found| found.next().is_none());
    if !empty && !holds(STUDY) {
        return Err(SeatError::cannot(
            format!(
                "{} holds something else than a study of the seat",
                folder.to_slash_lossy()
            ),
            "name a new folder",
        ));
    }
    seat.refuse_few_donors(false)?;
    let steps_of_row = |row: usize| -> Result<Vec<Step>, SeatError> {
        let steps = seat.steps_of(None, Whose::Nobody, &seat.order(row))?;
        steps
            .into_iter()
            .map(|step| unnamed::step(seat.model.as_ref(), step))
            .collect()
    };
    let rows: Vec<Vec<Step>> = (0..seat.orders())
        .map(steps_of_row)
        .collect::<Result<_, _>>()?;
    let orders = rows.len();
    let study = Static {
        title: settings.design.title(),
        synthetic: settings.design.synthetic(),
        made_up_model: settings.made_up_model,
        mph: seat.mph(),
        scenario: &seat.scenario_json,
        crash: settings.design.protocol().crash,
        view: &settings.design.protocol().view,
        model: settings.model.is_some(),
        post,
        redirect: settings.design.protocol().redirect.as_ref(),
        rows,
    };
    let study =
        serde_json::to_vec(&study).map_err(|e| SeatError::cannot(e.to_string(), "report this"))?;
    let mut files = vec![
        (
            "index.html",
            assets::static_page(origin.as_deref(), &settings.texts.words),
        ),
        ("page.css", assets::bytes("page.css").to_vec()),
        ("page.js", assets::bytes("page.js").to_vec()),
        ("seat.wasm", assets::bytes("seat.wasm").to_vec()),
        (STUDY, study),
    ];
    if let Some(model) = &settings.model {
        files.push(("model.maveric", model.clone()));
    }
    for (name, bytes) in &files {
        atomic_write_bytes(&folder.join(name), bytes)?;
    }
    Ok(Exported {
        folder: folder.to_owned(),
        files: files.iter().map(|(name, _)| (*name).to_owned()).collect(),
        orders,
    })
}

fn local(url: &url::Url) -> bool {
    url.scheme() == "http" && matches!(url.host_str(), Some("localhost" | "127.0.0.1"))
}

/// A line of what a person hands back.
#[derive(Deserialize)]
#[serde(untagged, deny_unknown_fields)]
enum Line {
    Head {
        maveric_seat_person: u32,
        token: String,
        row: usize,
    },
    Sheet {
        step: usize,
        /// A [`Sheet`], read by itself: in a line of several kinds its numbered texts would not be taken.
        sheet: serde_json::Value,
    },
    Drive {
        step: usize,
        attempt: u32,
        record: String,
    },
    Fit {
        fit: Fit,
    },
    Ended {
        ended: String,
    },
    /// A rule held them back at a step where it is judged who takes part: nothing else is there.
    NotAdmitted {
        not_admitted: usize,
        /// Left out by a page of an older export: the first such step.
        step: Option<usize>,
    },
}

/// Somebody who was taken in.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TakenIn {
    /// The id that they were given.
    pub participant: String,
    /// Sheets of answers, texts agreed to among them.
    pub sheets: usize,
    /// Drives and rides that came to their end.
    pub drives: usize,
    /// `done`, `left` or `not admitted`.
    pub ended: String,
}

/// What is missing of what was given, if something is: all that was asked of who is through, and the consent of whoever gave anything.
fn missing(steps: &[Step], given: &Carried) -> Option<String> {
    let sheet = |at: usize| given.sheets.iter().any(|(step, _)| *step == at);
    let driven = |at: usize| {
        let mut drives = given.drives.iter().filter(|(step, ..)| *step == at);
        drives.any(|(.., parts)| parts.end.is_some())
    };
    if given.sheets.is_empty() && given.drives.is_empty() {
        return Some("nothing was given: expected answers or drives from step 1 on".to_owned());
    }
    let through = given.ended == "done";
    let stopped = given.drives.iter().find_map(|(step, _, parts)| {
        let stops = |piece: &(u64, u64, String)| piece.2.contains(STOPPED);
        parts.pieces.iter().any(stops).then_some(*step)
    });
    let is_aftercare = |step: &Step| matches!(step, Step::Aftercare { .. });
    let aftercare = steps.iter().position(is_aftercare).unwrap_or(steps.len());
    let lacks = |(at, step): (usize, &Step)| {
        // Whoever stopped was asked nothing more.
        if stopped.is_some_and(|stopped| (stopped + 1..aftercare).contains(&at)) {
            return None;
        }
        let (is_there, what) = match step {
            Step::Text { agree: true, .. } => (sheet(at), "was not agreed to"),
            Step::Scale { .. } if through => (sheet(at), "has no answers of its questionnaire"),
            Step::Break { .. } if through => (sheet(at), "was not rested at"),
            Step::Elsewhere { .. } if through => (sheet(at), "has no ride that was over"),
            Step::Drive { .. } if through => (driven(at), "has no drive that came to its end"),
            Step::Ride { .. } if through => (driven(at), "has no ride that came to its end"),
            _ => (true, ""),
        };
        (!is_there).then(|| format!("step {} of {} {what}", at + 1, steps.len()))
    };
    steps.iter().enumerate().find_map(lacks)
}

/// Counts somebody whom a rule of a step held back, once; gives what is wrong with it.
fn hold_back(
    seat: &Seat,
    token: &str,
    steps: &[Step],
    (step, place): (Option<usize>, usize),
) -> Result<Option<String>, SeatError> {
    let rules = match step {
        Some(step) => steps.get(step).and_then(Step::rules),
        None => steps.iter().find_map(Step::rules),
    };
    let Some(rule) = rules.and_then(|rules| rules.get(place).cloned()) else {
        return Ok(Some(format!(
            "rule {place} is none by which this study judges who takes part"
        )));
    };
    let first = seat.store.within(|b| {
        let first = b.first_time(token)?;
        if first {
            b.hold_back(&rule)?;
        }
        Ok::<_, SeatError>(first)
    })?;
    seat.write_files()?;
    Ok((!first).then(|| "counted before".to_owned()))
}

/// What is wrong with a line of a file.
fn bad(path: &Path, line: usize, problem: impl Into<String>) -> SeatError {
    SeatError::Carried {
        path: path.to_owned(),
        line,
        problem: problem.into(),
    }
}

/// The lines of a file, each with its number.
fn lines_of(path: &Path) -> Result<Vec<(usize, Line)>, SeatError> {
    let io = |source| SeatError::io(path, source);
    let size = std::fs::metadata(path).map_err(io)?.len();
    if size > LARGEST {
        let problem = format!("the file has {size} bytes, expected at most {LARGEST}");
        return Err(bad(path, 1, problem));
    }
    let text = std::fs::read_to_string(path).map_err(io)?;
    // An editor may have put a mark before it.
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let parsed = (1..).zip(text.lines()).map(|(number, line)| {
        let no_part = |e: serde_json::Error| {
            let problem = format!("no part of what the page hands over: {e}");
            bad(path, number, problem)
        };
        Ok((number, serde_json::from_str(line).map_err(no_part)?))
    });
    parsed.collect()
}

/// What a head is wrong about: somebody of another study, or who was taken in or forgotten before; none where it is not.
fn unwanted(seat: &Seat, token: &str, row: usize) -> Result<Option<String>, SeatError> {
    if !token::possible(token) || row >= seat.orders() {
        let problem = format!("token `{token}` and row {row} are none of this study");
        return Ok(Some(problem));
    }
    if let Some(before) = seat.store.look(|b| b.person(token))? {
        return Ok(Some(format!("taken in before, as {}", before.participant)));
    }
    let forgotten = seat.store.look(|b| b.link_forgotten(token))?;
    let problem = "who handed this over is forgotten: it is not taken in again";
    Ok(forgotten.then(|| problem.to_owned()))
}

/// What was given, looked at whole before anything is kept.
fn checked(
    seat: &Seat,
    steps: &[Step],
    path: &Path,
    lines: Vec<(usize, Line)>,
) -> Result<Carried, SeatError> {
    let Some((last, Line::Ended { ended })) = lines.last() else {
        let problem = "the file is cut off: expected how it ended";
        return Err(bad(path, lines.len() + 1, problem));
    };
    if !["done", "left"].contains(&ended.as_str()) {
        let problem = format!("ended `{ended}`, expected done or left");
        return Err(bad(path, *last, problem));
    }
    let mut given = Carried {
        ended: ended.clone(),
        ..Carried::default()
    };
    for (number, line) in lines {
        let wrong = |why: String| bad(path, number, why);
        let step_at = |step: usize| {
            let problem = || wrong(format!("step {step}, expected at most {}", steps.len()));
            steps.get(step).ok_or_else(problem)
        };
        match line {
            Line::Sheet { step, sheet } => {
                let sheet: Sheet =
                    serde_json::from_value(sheet).map_err(|e| wrong(e.to_string()))?;
                let kept = sheet.checked(step_at(step)?).map_err(wrong)?;
                given.sheets.push((step, kept));
            }
            Line::Drive {
                step,
                attempt,
                record,
            } => {
                let parts = intake::parts(seat, step_at(step)?, &record).map_err(wrong)?;
                if parts.header.is_none() {
                    return Err(wrong("a drive without its head".to_owned()));
                }
                given.drives.push((step, attempt, parts));
            }
            Line::Fit { fit } => given.style = Some(intake::style(&fit).map_err(wrong)?),
            Line::Ended { .. } => missing(steps, &given).map_or(Ok(()), |why| Err(wrong(why)))?,
            Line::Head { .. } => return Err(wrong("a second head".to_owned())),
            Line::NotAdmitted { .. } => {
                let why = "held back by a rule, and something was given all the same";
                return Err(wrong(why.to_owned()));
            }
        }
    }
    Ok(given)
}

/// Takes in what somebody handed back: checked as the server checks what a page sends it; nothing of a file that is wrong anywhere.
///
/// # Errors
/// [`SeatError::Carried`] naming the line; [`SeatError::Store`]; [`SeatError::Study`] if a file cannot be written.
pub fn take_in(seat: &Seat, path: &Path) -> Result<TakenIn, SeatError> {
    let mut lines = lines_of(path)?.into_iter();
    let Some((
        _,
        Line::Head {
            maveric_seat_person: 1,
            token,
            row,
        },
    )) = lines.next()
    else {
        let problem = "not the head of what a person hands over";
        return Err(bad(path, 1, problem));
    };
    if let Some(problem) = unwanted(seat, &token, row)? {
        return Err(bad(path, 1, problem));
    }
    let steps = seat.steps_of(None, Whose::Link(&token), &seat.order(row))?;
    let rest: Vec<(usize, Line)> = lines.collect();
    if let [(number, Line::NotAdmitted { not_admitted, step })] = rest[..] {
        let why = hold_back(seat, &token, &steps, (step, not_admitted))?;
        return why.map_or(
            Ok(TakenIn {
                participant: String::new(),
                sheets: 0,
                drives: 0,
                ended: NOT_ADMITTED.to_owned(),
            }),
            |why| Err(bad(path, number, why)),
        );
    }
    let given = checked(seat, &steps, path, rest)?;
    let person = seat.take_in((&token, row), &steps, &given)?;
    let mut drives = 0;
    for (step, found) in steps.iter().enumerate() {
        let reason = seat
            .store
            .look(|b| b.stopped(&person.participant, (step, found)))?;
        if let Some(reason) = reason {
            seat.stop_drive(&person, (step, found), &reason)?;
            continue;
        }
        let whole = found.drives().is_some() && seat.write_drive(&person, (step, found), None)?;
        if !whole && given.ended == "left" {
            seat.keep_unfinished(&person, step)?;
        }
        drives += usize::from(whole);
    }
    seat.write_files()?;
    Ok(TakenIn {
        participant: person.participant,
        sheets: given.sheets.len(),
        drives,
        ended: given.ended,
    })
}

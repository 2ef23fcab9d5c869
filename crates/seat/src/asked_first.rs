//! What the experimenter is asked before it is done, since it cannot be undone: closing the seat, forgetting somebody, leaving a step out.

use crate::{
    error::SeatError,
    escaped::plain,
    markup::{form_field, html, html_with_way_back, to_lab},
    request::{Answered, Refused, Shared, with_help},
    seat::Seat,
    steps::Act,
};
use axum::{
    Router,
    body::Bytes,
    extract::{Path, State},
    response::Response,
    routing::get,
};
use path_slash::PathExt as _;
use std::path::PathBuf;

const LONGEST_REASON: usize = 200;

/// Each question, and what is done once it is answered.
pub(crate) fn routes() -> Router<Shared> {
    Router::new()
        .route("/lab/stop", get(asks_to_stop).post(stop))
        .route("/lab/forget/{participant}", get(asks_to_forget).post(forget))
        .route("/lab/exclude/{participant}", get(asks_to_exclude).post(exclude))
        .route("/lab/step/{participant}/{step}", get(asks_to_leave_out).post(leave_out))
}

async fn asks_to_stop(State(shared): State<Shared>) -> Answered<Response> {
    let on_the_way =
        shared.blocking(|seat| seat.store.look(|b| b.on_the_way().map_err(Refused::from)));
    let on_the_way = on_the_way.await?;
    let words = shared.words();
    let who = match on_the_way {
        0 => words.plain("lab_nobody_on", &[]),
        1 => words.plain("lab_one_on", &[]),
        more => words.plain("lab_more_on", &[("n", &more.to_string())]),
    };
    let say = |name| words.plain(name, &[]);
    let body = format!(
        "<p>{who} {}</p><form method=\"post\" action=\"/lab/stop\"><button>{}</button></form>",
        say("lab_links_go_on"),
        say("lab_close_it")
    );
    Ok(html_with_way_back(words, &say("lab_close_title"), &body))
}

async fn stop(State(shared): State<Shared>) -> Response {
    shared.seat.stop();
    let words = shared.words();
    html(
        words,
        &format!(
            "<h1>{}</h1><p>{}</p>",
            words.plain("lab_closed", &[]),
            words.plain("lab_closed_help", &[])
        ),
    )
}

async fn asks_to_forget(
    State(shared): State<Shared>,
    Path(participant): Path<String>,
) -> Answered<Response> {
    let who = participant.clone();
    let known = shared.blocking(move |seat: &Seat| match seat.knows(&who) {
        Err(error @ SeatError::Nobody { .. }) => Err(with_help(error)),
        other => Ok(other?),
    });
    known.await?;
    let words = shared.words();
    let say = |name| words.plain(name, &[("who", &participant)]);
    let body = format!(
        "<p>{} {}</p><form method=\"post\"><button>{}</button></form>",
        say("lab_forget_what"),
        say("lasting"),
        say("lab_forget_it")
    );
    Ok(html_with_way_back(words, &say("lab_forget_title"), &body))
}

async fn forget(
    State(shared): State<Shared>,
    Path(participant): Path<String>,
) -> Answered<Response> {
    let who = participant.clone();
    let gone = shared.blocking(move |seat: &Seat| match seat.forget(&who) {
        Err(error @ SeatError::Nobody { .. }) => Err(with_help(error)),
        other => Ok(other?),
    });
    let gone = gone.await?;
    shared.refusals.forget(&participant);
    let words = shared.words();
    let say = |name| words.plain(name, &[("who", &participant)]);
    let left = gone.study.map_or_else(Vec::new, |study| study.left);
    let mut body = format!("<p>{}</p>", say("lasting"));
    if !left.is_empty() {
        let file = |path: &PathBuf| format!("<li>{}", plain(&path.to_slash_lossy()));
        let files: String = left.iter().map(file).collect();
        body += &["<p>", &say("lab_forgotten_left"), "</p><ul>", &files, "</ul>"].concat();
    }
    Ok(html_with_way_back(words, &say("lab_forgotten"), &body))
}

async fn asks_to_leave_out(
    State(shared): State<Shared>,
    Path((participant, step)): Path<(String, usize)>,
) -> Response {
    let words = shared.words();
    let number = (step + 1).to_string();
    let say = |name| words.plain(name, &[("who", &participant), ("step", &number)]);
    let acts = [
        ("skip", "lab_skip", "lab_skip_help"),
        ("repeat", "lab_repeat", "lab_repeat_help"),
        ("abort", "lab_abort", "lab_abort_help"),
        ("extend", "lab_extend", "lab_extend_help"),
    ];
    // A form each: Enter in one of its fields does what stands beside it, and nothing else.
    let forms = acts.map(|(act, name, help)| {
        let minutes = match act {
            "extend" => {
                "<input name=\"minutes\" type=\"number\" min=\"1\" max=\"120\" value=\"5\"> "
            }
            _ => "",
        };
        format!(
            "<form method=\"post\"><input type=\"hidden\" name=\"act\" value=\"{act}\"><h2>{}</h2><p>{}</p>\
             <p>{} {minutes}<button>{}</button></p></form>",
            say(name),
            say(help),
            reason_field(&say("lab_reason")),
            say(name)
        )
    });
    let body = format!("<p>{}</p>{}", say("lab_step_help"), forms.concat());
    html_with_way_back(words, &say("lab_step_title"), &body)
}

async fn leave_out(
    State(shared): State<Shared>,
    Path((participant, step)): Path<(String, usize)>,
    body: Bytes,
) -> Answered<Response> {
    let reason = reason_of(&body);
    let act = form_field(&body, "act").unwrap_or_default();
    let minutes = form_field(&body, "minutes").and_then(|text| text.trim().parse().ok());
    let done = shared.blocking(move |seat| {
        let done = match act.as_str() {
            "skip" => seat.leave_out(&participant, step, Act::Skip, &reason),
            "abort" => seat.leave_out(&participant, step, Act::Abort, &reason),
            "repeat" => seat.repeat(&participant, step, &reason),
            "extend" => {
                // What is no number of minutes is none.
                seat.extend(&participant, step, minutes.unwrap_or(0.0), &reason)
            }
            other => {
                let why = format!("act `{other}`, expected skip, repeat, abort or extend");
                return Err(Refused::NotThis(why));
            }
        };
        done.map_err(with_help)
    });
    done.await?;
    Ok(to_lab())
}

/// Where a reason is typed, which no form goes without.
fn reason_field(label: &str) -> String {
    format!(
        "<label>{label} <input name=\"reason\" maxlength=\"{LONGEST_REASON}\" size=\"60\" required></label>"
    )
}

/// The reason that was given, as far as one is kept.
fn reason_of(body: &Bytes) -> String {
    let reason = form_field(body, "reason").unwrap_or_default();
    reason.chars().take(LONGEST_REASON).collect()
}

async fn asks_to_exclude(
    State(shared): State<Shared>,
    Path(participant): Path<String>,
) -> Answered<Response> {
    let who = participant.clone();
    let excluded = shared.blocking(move |seat| {
        let excluded = seat.store.look(|b| {
            b.called(&who)?;
            b.excluded(&who)
        });
        excluded.map_err(with_help)
    });
    let excluded = excluded.await?;
    let words = shared.words();
    let say = |name| words.plain(name, &[("who", &participant)]);
    let form = match excluded {
        Some(what) => format!(
            "<p>{}</p><form method=\"post\"><button>{}</button></form>",
            words.plain("lab_excluded_what", &[("what", &what)]),
            say("lab_counts")
        ),
        None => format!(
            "<p>{}</p><form method=\"post\">{} <button>{}</button></form>",
            say("lab_exclude_what"),
            reason_field(&say("lab_reason")),
            say("lab_exclude_it")
        ),
    };
    Ok(html_with_way_back(words, &say("lab_exclude_title"), &form))
}

async fn exclude(
    State(shared): State<Shared>,
    Path(participant): Path<String>,
    body: Bytes,
) -> Answered<Response> {
    let reason = reason_of(&body);
    let done = shared.blocking(move |seat| seat.exclude(&participant, &reason).map_err(with_help));
    done.await?;
    Ok(to_lab())
}

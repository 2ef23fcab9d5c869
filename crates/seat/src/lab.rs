//! The experimenter's page: who is where, and the link for the next person.

use crate::{
    above, assets, entrance,
    error::SeatError,
    let_in::Invitation,
    markup::{form_field, html, plain, to_lab},
    person::Person,
    refusals::Refusal,
    request::{Answered, Refused, Shared},
    seat::Seat,
    steps::Step,
    words::in_english,
};
use axum::{
    Router,
    body::Bytes,
    extract::{Path, Request, State},
    http::{HeaderValue, header},
    middleware::{self, Next},
    response::{IntoResponse, Response},
    routing::{get, post},
};
use maveric_study::beyond_in_words;
use std::fmt::Write as _;

/// The pages of the laboratory; all but the door are for whoever gave the password.
pub(crate) fn routes(shared: &Shared) -> Router<Shared> {
    let inside = Router::new()
        .route("/lab", get(page))
        .route("/lab/live", get(live))
        .route("/lab/next", post(next))
        .route("/lab/never/{participant}", post(never_came))
        .route("/lab/note", post(note))
        .route("/lab/stop", get(asks_to_stop).post(stop))
        .route(
            "/lab/forget/{participant}",
            get(asks_to_forget).post(forget),
        )
        .route("/lab/above/{participant}", get(from_above))
        .route("/lab/answers.csv", get(answers))
        .route_layer(middleware::from_fn_with_state(shared.clone(), inside));
    inside.route("/lab/enter", post(entrance::enter))
}

/// Shows the door to whoever has not given the password.
async fn inside(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    if shared.entered(request.headers()).await {
        next.run(request).await
    } else if request.uri().path() == "/lab" {
        entrance::door(false)
    } else {
        to_lab()
    }
}

/// Things that happened, and letters of a note.
const SHOWN: u32 = 200;
const LONGEST_NOTE: usize = 1_000;

async fn page(State(shared): State<Shared>) -> Answered<Response> {
    let title = plain(shared.seat.settings.design.title());
    let phase = if shared.seat.rides() {
        ""
    } else {
        "<p>Nobody rides: people drive by hand alone.</p>"
    };
    let live = what_may_change(&shared).await?;
    Ok(html(&format!(
        "<h1>{title}</h1>{phase}<p id=\"silent\" role=\"alert\" hidden>The seat does not answer: what stands here may be old.</p>\
         <form method=\"post\" action=\"/lab/next\"><label>Id, the next that is free where it is left empty \
         <input name=\"participant\" maxlength=\"64\" size=\"12\"></label> <button>Link for the next person</button></form>\
         <form method=\"post\" action=\"/lab/note\"><label>A note of yours <input name=\"note\" maxlength=\"{LONGEST_NOTE}\" size=\"60\"></label> \
         <button>Write down</button></form><div id=\"live\">{live}</div>\
         <h2>The study</h2><p><a href=\"/lab/answers.csv\">Answers so far</a></p>\
         <p><a href=\"/lab/stop\">Close the seat …</a></p><script type=\"module\" src=\"{}\"></script>",
        assets::address("lab.js")
    )))
}

async fn live(State(shared): State<Shared>) -> Answered<Response> {
    let kind = [(header::CONTENT_TYPE, "text/html; charset=utf-8")];
    Ok((kind, what_may_change(&shared).await?).into_response())
}

/// Who is where, what was refused, what happened. What was refused is shown even where nothing can be read.
async fn what_may_change(shared: &Shared) -> Answered<String> {
    let mut page = refused(&shared.refusals.newest_first());
    let read = shared.blocking(|seat| {
        seat.store
            .look(|b| Ok::<_, Refused>((b.everybody()?, b.events(SHOWN)?)))
    });
    let (people, events) = match read.await {
        Ok(read) => read,
        Err(Refused::Failed(error)) => {
            let _ = write!(page, "<p role=\"alert\">{}</p>", plain(&error.to_string()));
            return Ok(page);
        }
        Err(other) => return Err(other),
    };
    page += "<table><thead><tr><th>Person<th>Where<th>Order<th>Style<th>Link<th><tbody>";
    page.extend(people.iter().map(row));
    page += "</table><h2>What happened</h2><table><thead><tr><th>Person<th>What, the newest first<tbody>";
    for (who, what) in events {
        let who = who.map_or_else(String::new, |who| plain(&who));
        let _ = write!(page, "<tr><td>{who}<td>{}", plain(&what));
    }
    page += "</table>";
    Ok(page)
}

/// What the server refused or could not keep.
fn refused(all: &[Refusal]) -> String {
    if all.is_empty() {
        return String::new();
    }
    let mut table = "<h2>What was refused, or could not be kept</h2><table><thead><tr><th>Person<th>What<th>How often<th>Last<tbody>".to_owned();
    for refusal in all {
        let who = refusal.participant.as_deref().unwrap_or("somebody");
        let _ = write!(
            table,
            "<tr><td>{}<td>{}<td>{} times<td>{} s ago",
            plain(who),
            plain(&refusal.why),
            refusal.times,
            refusal.ago().as_secs()
        );
    }
    table + "</table>"
}

fn row(person: &Person) -> String {
    let order: Vec<String> = person.rides().iter().map(|ride| plain(ride)).collect();
    let steps = person.steps.len();
    let place = match (&person.ended, person.steps.get(person.at)) {
        (Some(how), _) => plain(how),
        (None, Some(step)) => format!("step {} of {steps}: {}", person.at + 1, what(step)),
        (None, None) => "at the end".to_owned(),
    };
    let beyond = person.beyond().map(|why| {
        format!(
            "beyond what the model has met: {}",
            plain(&beyond_in_words(&why))
        )
    });
    let (link, who) = (format!("/p/{}", person.token), plain(&person.participant));
    // Whoever began came.
    let never_came = if person.at == 0 && person.ended.is_none() {
        format!(
            "<form method=\"post\" action=\"/lab/never/{who}\"><button>Never came</button></form>"
        )
    } else {
        String::new()
    };
    format!(
        "<tr><td><a href=\"/lab/above/{who}\">{who}</a><td>{place}<td>{}<td>{}<td><a href=\"{link}\">{link}</a>\
         <td>{never_came}<a href=\"/lab/forget/{who}\">Forget …</a>",
        order.join(", "),
        beyond.unwrap_or_default()
    )
}

fn what(step: &Step) -> &'static str {
    match step {
        Step::Screen { .. } => "screening",
        Step::Text { .. } => "reading",
        Step::Scale { .. } => "questionnaire",
        Step::Controls => "controls",
        Step::Practice { .. } => "practice",
        Step::Drive { .. } => "driving",
        Step::Ride { .. } => "riding",
        Step::Aftercare { .. } => "stopped: aftercare",
        Step::Thanks { .. } => "thanks",
    }
}

async fn next(State(shared): State<Shared>, body: Bytes) -> Answered<Response> {
    let given = |name| form_field(&body, name).map(|text| text.trim().to_owned());
    let invitation = Invitation {
        participant: given("participant").filter(|id| !id.is_empty()),
    };
    shared
        .blocking(move |seat| seat.invite(&invitation).map_err(with_help))
        .await?;
    Ok(to_lab())
}

async fn never_came(
    State(shared): State<Shared>,
    Path(participant): Path<String>,
) -> Answered<Response> {
    shared
        .blocking(move |seat| seat.never_came(&participant).map_err(with_help))
        .await?;
    Ok(to_lab())
}

/// A refusal that says what to do, where something can be done.
fn with_help(error: SeatError) -> Refused {
    match error.suggestion() {
        Some(help) => Refused::NotThis(format!("{error}: {help}")),
        None => Refused::Failed(error),
    }
}

/// What somebody drives now, or drove last.
async fn from_above(
    State(shared): State<Shared>,
    Path(participant): Path<String>,
) -> Answered<Response> {
    let who = participant.clone();
    let drawn = shared.blocking(move |seat| {
        let lines = seat.store.look(|b| match b.last_drive(&who)? {
            Some(last) => Ok(b.record(&who, last)?),
            None => Err(Refused::NotThis("nothing was driven yet".to_owned())),
        })?;
        Ok::<_, Refused>(above::picture(&lines))
    });
    let drawn = drawn
        .await?
        .unwrap_or_else(|error| format!("<p>{}</p>", plain(&error.to_string())));
    let mut page = html(&format!(
        "<h1>{}</h1>{drawn}<p><a href=\"/lab\">Back</a></p>",
        plain(&participant)
    ));
    page.headers_mut()
        .insert(header::REFRESH, HeaderValue::from_static("2"));
    Ok(page)
}

async fn answers(State(shared): State<Shared>) -> Answered<Response> {
    let text = shared.blocking(|seat| {
        seat.write_files()?;
        Ok::<_, Refused>(seat.settings.files.answers()?)
    });
    let kind = [
        (header::CONTENT_TYPE, "text/csv; charset=utf-8"),
        (header::CONTENT_DISPOSITION, "attachment"),
    ];
    Ok((kind, text.await?).into_response())
}

async fn asks_to_stop(State(shared): State<Shared>) -> Answered<Response> {
    let everybody =
        shared.blocking(|seat| seat.store.look(|b| b.everybody().map_err(Refused::from)));
    let everybody = everybody.await?;
    let here = everybody.iter().filter(|p| p.ended.is_none()).count();
    let who = match here {
        0 => "Nobody is on the way.".to_owned(),
        1 => "1 person has not ended, and cannot go on while it is closed.".to_owned(),
        more => format!("{more} people have not ended, and cannot go on while it is closed."),
    };
    Ok(html(&format!(
        "<h1>Close the seat?</h1><p>{who} Their links go on when it is opened again.</p>\
         <form method=\"post\" action=\"/lab/stop\"><button>Close the seat</button></form><p><a href=\"/lab\">Back</a></p>"
    )))
}

async fn stop(State(shared): State<Shared>) -> Response {
    shared.seat.stop();
    html("<h1>The seat is closed</h1><p>Everything that was given is in the study’s folder.</p>")
}

async fn asks_to_forget(Path(participant): Path<String>) -> Response {
    let (who, lasting) = (plain(&participant), plain(in_english("lasting")));
    html(&format!(
        "<h1>Forget {who}?</h1><p>Everything that {who} gave is deleted: answers, drives, logs, style, and what was written down of them. \
         Their id is left, so that nobody else gets it. {lasting}</p>\
         <form method=\"post\"><button>Forget {who}</button></form><p><a href=\"/lab\">Back</a></p>"
    ))
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
    Ok(html(&format!(
        "<h1>{} is forgotten</h1><p>{}</p><p><a href=\"/lab\">Back</a></p>",
        plain(&participant),
        plain(gone.lasting)
    )))
}

async fn note(State(shared): State<Shared>, body: Bytes) -> Answered<Response> {
    let text = form_field(&body, "note").unwrap_or_default();
    let text: String = text.trim().chars().take(LONGEST_NOTE).collect();
    if !text.is_empty() {
        shared.blocking(move |seat| seat.note(&text)).await?;
    }
    Ok(to_lab())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whose_drive_is_beyond_what_the_model_has_met_is_marked_among_the_people() {
        let mut person = Person::new("t".to_owned(), "P001".to_owned(), Vec::new());
        assert!(!row(&person).contains("beyond"));
        let fit = r#"{"embedding":[0.0],"covariance":null,"score":30.0,"readings":3,"beyond":"style:pass"}"#;
        person.fit = Some(fit.to_owned());
        let marked = row(&person);
        assert!(
            marked.contains("<td>beyond what the model has met: shows a style"),
            "{marked}"
        );
    }
}

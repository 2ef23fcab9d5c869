//! The experimenter's page: who is where, and the link for the next person.

use crate::{
    above, assets, entrance,
    error::SeatError,
    let_in::Invitation,
    live::{self, HAPPENED, PEOPLE, REFUSED},
    markup::{form_field, html, plain, to_lab},
    request::{Answered, Refused, Shared},
    seat::Seat,
    steps::Act,
    streamed,
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
use std::collections::BTreeMap;

/// The pages of the laboratory; all but the door are for whoever gave the password.
pub(crate) fn routes(shared: &Shared) -> Router<Shared> {
    let inside = Router::new()
        .route("/lab", get(page))
        .route("/lab/live", get(streamed::stream))
        .route("/lab/next", post(next))
        .route("/lab/never/{participant}", post(never_came))
        .route("/lab/note", post(note))
        .route("/lab/stop", get(asks_to_stop).post(stop))
        .route(
            "/lab/forget/{participant}",
            get(asks_to_forget).post(forget),
        )
        .route(
            "/lab/step/{participant}/{step}",
            get(asks_to_leave_out).post(leave_out),
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

/// Letters of a note, and of a reason.
const LONGEST_NOTE: usize = 1_000;
const LONGEST_REASON: usize = 200;

async fn page(State(shared): State<Shared>) -> Response {
    let title = plain(shared.seat.settings.design.title());
    let phase = if shared.seat.rides() {
        ""
    } else {
        "<p>Nobody rides: people drive by hand alone.</p>"
    };
    let order = if shared.seat.rides() {
        " <label>Order of conditions, the square's where it is left empty <input name=\"order\" size=\"24\"></label>"
    } else {
        ""
    };
    let parts: BTreeMap<_, _> = live::parts(&shared).await.into_iter().collect();
    let part = |name| parts.get(name).map_or("", String::as_str);
    html(&format!(
        "<h1>{title}</h1>{phase}<p id=\"silent\" role=\"alert\" hidden>The seat does not answer: what stands here may be old.</p>\
         <form method=\"post\" action=\"/lab/next\"><label>Id, the next that is free where it is left empty \
         <input name=\"participant\" maxlength=\"64\" size=\"12\"></label>{order} <button>Link for the next person</button></form>\
         <form method=\"post\" action=\"/lab/note\"><label>A note of yours <input name=\"note\" maxlength=\"{LONGEST_NOTE}\" size=\"60\"></label> \
         <button>Write down</button></form><div id=\"{REFUSED}\">{}</div>\
         <table><thead><tr><th>Person<th>Where<th>Since<th>Pictures a second<th>Order<th>Style<th>Link<th><tbody id=\"{PEOPLE}\">{}</table>\
         <h2>What happened</h2><table><thead><tr><th>Person<th>What, the newest first<tbody id=\"{HAPPENED}\">{}</table>\
         <h2>The study</h2><p><a href=\"/lab/answers.csv\">Answers so far</a></p>\
         <p><a href=\"/lab/stop\">Close the seat …</a></p><script type=\"module\" src=\"{}\"></script>",
        part(REFUSED),
        part(PEOPLE),
        part(HAPPENED),
        assets::address("lab.js")
    ))
}

async fn next(State(shared): State<Shared>, body: Bytes) -> Answered<Response> {
    let given = |name| form_field(&body, name).map(|text| text.trim().to_owned());
    let invitation = Invitation {
        participant: given("participant").filter(|id| !id.is_empty()),
        order: given("order").filter(|order| !order.is_empty()),
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
    let on_the_way =
        shared.blocking(|seat| seat.store.look(|b| b.on_the_way().map_err(Refused::from)));
    let who = match on_the_way.await? {
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

async fn asks_to_leave_out(Path((participant, step)): Path<(String, usize)>) -> Response {
    let (who, number) = (plain(&participant), step + 1);
    html(&format!(
        "<h1>Step {number} of {who}</h1><p>Your reason stands in the record. What was driven of the step is kept, and a drive or a ride is left out of the analysis by name. \
         Their page goes on by itself while they drive, otherwise when they press its button or load it again.</p>\
         <form method=\"post\"><label>Reason <input name=\"reason\" maxlength=\"{LONGEST_REASON}\" size=\"60\" required></label>\
         <p><button name=\"act\" value=\"skip\">Skip this step</button> they go on at the next.</p>\
         <p><button name=\"act\" value=\"abort\">End the driving</button> nothing is driven any more: they read what those read who stop (<code>aftercare</code>), and go on to the end.</p></form>\
         <p><a href=\"/lab\">Back</a></p>"
    ))
}

async fn leave_out(
    State(shared): State<Shared>,
    Path((participant, step)): Path<(String, usize)>,
    body: Bytes,
) -> Answered<Response> {
    let reason = form_field(&body, "reason").unwrap_or_default();
    let reason: String = reason.chars().take(LONGEST_REASON).collect();
    let act = match form_field(&body, "act").as_deref() {
        Some("skip") => Act::Skip,
        Some("abort") => Act::Abort,
        other => {
            return Err(Refused::NotThis(format!(
                "act {other:?}, expected skip or abort"
            )));
        }
    };
    let done = shared.blocking(move |seat| {
        let done = seat.leave_out(&participant, step, act, &reason);
        done.map_err(with_help)
    });
    done.await?;
    Ok(to_lab())
}

async fn note(State(shared): State<Shared>, body: Bytes) -> Answered<Response> {
    let text = form_field(&body, "note").unwrap_or_default();
    let text: String = text.trim().chars().take(LONGEST_NOTE).collect();
    if !text.is_empty() {
        shared.blocking(move |seat| seat.note(&text)).await?;
    }
    Ok(to_lab())
}

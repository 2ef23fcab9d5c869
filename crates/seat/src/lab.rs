//! The experimenter's page: who is where, and the link for the next person.

use crate::{
    above, asked_first, assets, entrance,
    escaped::plain,
    let_in::Invitation,
    live::{self, DISK, HAPPENED, PEOPLE, REFUSED},
    markup::{form_field, html, html_with_way_back, to_lab},
    request::{Answered, Refused, Shared, with_help},
    streamed,
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
        .route("/lab/above/{participant}", get(from_above))
        .route("/lab/answers.csv", get(answers))
        .merge(asked_first::routes())
        .route_layer(middleware::from_fn_with_state(shared.clone(), inside));
    inside.route("/lab/enter", post(entrance::enter))
}

/// Shows the door to whoever has not given the password.
async fn inside(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    if shared.entered(request.headers()).await {
        next.run(request).await
    } else if request.uri().path() == "/lab" {
        entrance::door(shared.words(), false)
    } else {
        to_lab()
    }
}

const LONGEST_NOTE: usize = 1_000;

async fn page(State(shared): State<Shared>) -> Response {
    let title = plain(shared.seat.settings.design.title());
    let words = shared.words();
    let say = |name| words.plain(name, &[]);
    let (mut phase, mut order) = (String::new(), String::new());
    if shared.seat.rides() {
        order = format!(
            " <label>{} <input name=\"order\" size=\"24\"></label>",
            say("lab_order_field")
        );
    } else {
        phase = format!("<p>{}</p>", say("lab_nobody_rides"));
    }
    let parts: BTreeMap<_, _> = live::parts(&shared).await.into_iter().collect();
    let part = |name| parts.get(name).map_or("", String::as_str);
    let heads = |names: &[&str]| -> String {
        let head = |name: &&str| match *name {
            "" => "<th>".to_owned(),
            name => format!("<th>{}", words.plain(name, &[])),
        };
        names.iter().map(head).collect()
    };
    html(
        words,
        &format!(
            "<h1>{title}</h1>{phase}<p id=\"silent\" role=\"alert\" hidden>{}</p>\
             <form method=\"post\" action=\"/lab/next\"><label>{} <input name=\"participant\" maxlength=\"64\" size=\"12\"></label>{order} \
             <button>{}</button></form>\
             <form method=\"post\" action=\"/lab/note\"><label>{} <input name=\"note\" maxlength=\"{LONGEST_NOTE}\" size=\"60\"></label> \
             <button>{}</button></form><div id=\"{REFUSED}\">{}</div>\
             <table><thead><tr>{}<tbody id=\"{PEOPLE}\">{}</table>\
             <h2>{}</h2><table><thead><tr>{}<tbody id=\"{HAPPENED}\">{}</table>\
             <h2>{}</h2><p id=\"{DISK}\">{}</p><p><a href=\"/lab/answers.csv\">{}</a></p>\
             <p><a href=\"/lab/stop\">{}</a></p><script type=\"module\" src=\"{}\"></script>",
            say("lab_silent"),
            say("lab_id"),
            say("lab_next"),
            say("lab_note"),
            say("lab_write"),
            part(REFUSED),
            heads(&[
                "lab_person",
                "lab_where",
                "lab_since",
                "lab_pictures",
                "lab_order",
                "lab_style",
                "lab_link",
                ""
            ]),
            part(PEOPLE),
            say("lab_happened"),
            heads(&["lab_person", "lab_what_newest"]),
            part(HAPPENED),
            say("lab_study"),
            part(DISK),
            say("lab_answers"),
            say("lab_close"),
            assets::address("lab.js")
        ),
    )
}

async fn next(State(shared): State<Shared>, body: Bytes) -> Answered<Response> {
    let given = |name| form_field(&body, name).map(|text| text.trim().to_owned());
    let invitation = Invitation {
        participant: given("participant").filter(|id| !id.is_empty()),
        order: given("order").filter(|order| !order.is_empty()),
    };
    shared.blocking(move |seat| seat.invite(&invitation).map_err(with_help)).await?;
    Ok(to_lab())
}

async fn never_came(
    State(shared): State<Shared>,
    Path(participant): Path<String>,
) -> Answered<Response> {
    shared.blocking(move |seat| seat.never_came(&participant).map_err(with_help)).await?;
    Ok(to_lab())
}

/// What somebody drives now, or drove last.
async fn from_above(
    State(shared): State<Shared>,
    Path(participant): Path<String>,
) -> Answered<Response> {
    let who = participant.clone();
    let drawn = shared.blocking(move |seat| {
        let words = &seat.settings.texts.words;
        let lines = seat.store.look(|b| match b.last_drive(&who)? {
            Some(last) => Ok(b.record(&who, last)?),
            None => Err(Refused::NotThis(words.sentence("lab_nothing_driven").to_owned())),
        })?;
        let unit = seat.settings.design.speed_unit();
        Ok::<_, Refused>(above::picture(&lines, words, unit))
    });
    let drawn =
        drawn.await?.unwrap_or_else(|error| format!("<p>{}</p>", plain(&error.to_string())));
    let mut page = html_with_way_back(shared.words(), &plain(&participant), &drawn);
    page.headers_mut().insert(header::REFRESH, HeaderValue::from_static("2"));
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

async fn note(State(shared): State<Shared>, body: Bytes) -> Answered<Response> {
    let text = form_field(&body, "note").unwrap_or_default();
    let text: String = text.trim().chars().take(LONGEST_NOTE).collect();
    if !text.is_empty() {
        shared.blocking(move |seat| seat.note(&text)).await?;
    }
    Ok(to_lab())
}

//! The experimenter's page: who is where, and the link for the next person.

use crate::{
    above,
    request::{Refused, Shared},
    steps::Step,
    token,
};
use axum::{
    Router,
    body::Bytes,
    extract::{Path, State},
    http::{HeaderMap, HeaderValue, StatusCode, header},
    response::{IntoResponse, Response},
    routing::{get, post},
};
use std::fmt::Write as _;

/// Name of the cookie that says that the password was given.
const COOKIE: &str = "lab";

pub(crate) fn routes() -> Router<Shared> {
    Router::new()
        .route("/lab", get(page))
        .route("/lab/enter", post(enter))
        .route("/lab/next", post(next))
        .route("/lab/note", post(note))
        .route("/lab/stop", post(stop))
        .route("/lab/above/{participant}", get(from_above))
        .route("/lab/answers.csv", get(answers))
}

/// Things that happened, and letters of a note.
const SHOWN: u32 = 200;
const LONGEST_NOTE: usize = 1_000;

/// Whether the cookie is that of the password.
fn entered(shared: &Shared, headers: &HeaderMap) -> bool {
    let Some(password) = &shared.seat.settings.password else {
        return false;
    };
    let expected = token::sha256(&format!("lab {password}"));
    let cookies = headers.get(header::COOKIE).and_then(|c| c.to_str().ok());
    cookies.is_some_and(|all| {
        all.split("; ")
            .filter_map(|c| c.strip_prefix(COOKIE)?.strip_prefix('='))
            .any(|value| token::same_secret(value, &expected))
    })
}

fn html(body: &str) -> Response {
    let page = format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Laboratory</title>\
         <link rel=\"stylesheet\" href=\"/page/page.css\"><main>{body}</main></html>"
    );
    ([(header::CONTENT_TYPE, "text/html; charset=utf-8")], page).into_response()
}

/// Text that cannot become markup.
fn plain(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

async fn page(State(shared): State<Shared>, headers: HeaderMap) -> Result<Response, Refused> {
    if !entered(&shared, &headers) {
        return Ok(html(
            "<h1>Laboratory</h1><form method=\"post\" action=\"/lab/enter\">\
             <label>Password <input type=\"password\" name=\"password\" autofocus></label> <button>Enter</button></form>",
        ));
    }
    let title = plain(shared.seat.settings.design.title());
    let mut rows = String::new();
    for person in shared.seat.store.everybody()? {
        let order: Vec<String> = person.rides().iter().map(|ride| plain(ride)).collect();
        let of = person.steps.len();
        let place = match (&person.ended, person.steps.get(person.at)) {
            (Some(how), _) => plain(how),
            (None, Some(step)) => format!("step {} of {of}: {}", person.at + 1, what(step)),
            (None, None) => "at the end".to_owned(),
        };
        let (link, who) = (format!("/p/{}", person.token), plain(&person.participant));
        let _ = write!(
            rows,
            "<tr><td><a href=\"/lab/above/{who}\">{who}</a><td>{place}<td>{}<td><a href=\"{link}\">{link}</a>",
            order.join(", ")
        );
    }
    let mut happened = String::new();
    for (who, what) in shared.seat.store.events(SHOWN)? {
        let who = who.map_or_else(String::new, |who| plain(&who));
        let _ = write!(happened, "<tr><td>{who}<td>{}", plain(&what));
    }
    let phase = if shared.seat.rides() {
        ""
    } else {
        "<p>Nobody rides: people drive by hand alone.</p>"
    };
    Ok(html(&format!(
        "<h1>{title}</h1>{phase}<form method=\"post\" action=\"/lab/next\"><button>Link for the next person</button></form>\
         <table><thead><tr><th>Person<th>Where<th>Order<th>Link<tbody>{rows}</table>\
         <h2>What happened</h2>\
         <form method=\"post\" action=\"/lab/note\"><label>A note of yours <input name=\"note\" maxlength=\"{LONGEST_NOTE}\" size=\"60\"></label> \
         <button>Write down</button></form>\
         <table><thead><tr><th>Person<th>What, the newest first<tbody>{happened}</table>\
         <h2>The study</h2><p><a href=\"/lab/answers.csv\">Answers so far</a></p>\
         <form method=\"post\" action=\"/lab/stop\"><button>Close the seat</button></form>"
    )))
}

fn what(step: &Step) -> &'static str {
    match step {
        Step::Text { .. } => "reading",
        Step::Scale { .. } => "questionnaire",
        Step::Controls => "controls",
        Step::Practice { .. } => "practice",
        Step::Drive { .. } => "driving",
        Step::Ride { .. } => "riding",
        Step::Thanks { .. } => "thanks",
    }
}

fn to_lab(cookie: Option<String>) -> Response {
    let mut response = (StatusCode::SEE_OTHER, [(header::LOCATION, "/lab")]).into_response();
    if let Some(value) = cookie.and_then(|c| c.parse().ok()) {
        response.headers_mut().insert(header::SET_COOKIE, value);
    }
    response
}

async fn enter(State(shared): State<Shared>, body: Bytes) -> Response {
    // One field of a form; a password of letters, digits and - _ needs no decoding, others are decoded.
    let given = form_field(&body, "password");
    let right = shared
        .seat
        .settings
        .password
        .as_deref()
        .zip(given.as_deref());
    if right.is_some_and(|(password, given)| token::same_secret(given, password)) {
        let password = shared.seat.settings.password.as_deref().unwrap_or_default();
        let value = token::sha256(&format!("lab {password}"));
        let secure = match shared.wire.scheme() {
            "https" => "; Secure",
            _ => "",
        };
        return to_lab(Some(format!(
            "{COOKIE}={value}; Path=/lab; HttpOnly; SameSite=Strict{secure}"
        )));
    }
    // Whoever guesses waits, and others who guess behind them.
    let _line = shared.guesses.lock().await;
    tokio::time::sleep(std::time::Duration::from_millis(500)).await;
    to_lab(None)
}

/// A field of a form, as browsers encode it.
fn form_field(body: &[u8], name: &str) -> Option<String> {
    let text = std::str::from_utf8(body).ok()?;
    let field = text
        .split('&')
        .find_map(|f| f.strip_prefix(name)?.strip_prefix('='))?;
    let mut bytes = Vec::new();
    let mut rest = field.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'+' => b' ',
            b'%' => {
                let digits = [rest.next()?, rest.next()?];
                u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?
            }
            plain => plain,
        });
    }
    String::from_utf8(bytes).ok()
}

async fn next(State(shared): State<Shared>, headers: HeaderMap) -> Result<Response, Refused> {
    if !entered(&shared, &headers) {
        return Ok(to_lab(None));
    }
    shared.seat.let_in()?;
    Ok(to_lab(None))
}

/// What somebody drives now, or drove last.
async fn from_above(
    State(shared): State<Shared>,
    headers: HeaderMap,
    Path(participant): Path<String>,
) -> Result<Response, Refused> {
    if !entered(&shared, &headers) {
        return Ok(to_lab(None));
    }
    let Some(last) = shared.seat.store.last_drive(&participant)? else {
        return Err(Refused::NotThis("nothing was driven yet".to_owned()));
    };
    let lines = shared.seat.store.record(&participant, last)?;
    let drawn = shared.blocking(move |_| Ok(above::picture(&lines)));
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

async fn answers(State(shared): State<Shared>, headers: HeaderMap) -> Result<Response, Refused> {
    if !entered(&shared, &headers) {
        return Ok(to_lab(None));
    }
    let text = shared.blocking(|seat| {
        seat.write_files()?;
        seat.settings.files.answers()
    });
    let kind = [
        (header::CONTENT_TYPE, "text/csv; charset=utf-8"),
        (header::CONTENT_DISPOSITION, "attachment"),
    ];
    Ok((kind, text.await?).into_response())
}

async fn stop(State(shared): State<Shared>, headers: HeaderMap) -> Response {
    if !entered(&shared, &headers) {
        return to_lab(None);
    }
    shared.seat.stop();
    html("<h1>The seat is closed</h1><p>Everything that was given is in the study’s folder.</p>")
}

async fn note(
    State(shared): State<Shared>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Response, Refused> {
    let text = form_field(&body, "note").unwrap_or_default();
    let text: String = text.trim().chars().take(LONGEST_NOTE).collect();
    if entered(&shared, &headers) && !text.is_empty() {
        shared.seat.store.event(None, &format!("note: {text}"))?;
    }
    Ok(to_lab(None))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_form_is_read_as_browsers_write_it_and_markup_stays_text() {
        let given = |body: &str| form_field(body.as_bytes(), "password");
        assert_eq!(given("password=a%26b+c").as_deref(), Some("a&b c"));
        assert_eq!(given("other=1&password=x").as_deref(), Some("x"));
        assert_eq!(given("password=%zz"), None);
        assert_eq!(
            plain("<b title=\"&\">"),
            "&lt;b title=&quot;&amp;&quot;&gt;"
        );
    }
}

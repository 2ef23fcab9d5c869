//! Who may see the experimenter's page: whoever gave its password, known from then on by a cookie that nobody can guess.

use crate::{
    error::SeatError,
    held::held,
    markup::{form_field, html, to_lab},
    request::{Refused, Shared},
    token,
    words::Words,
};
use axum::{
    body::Bytes,
    extract::State,
    http::{HeaderMap, StatusCode, header},
    response::{IntoResponse, Response},
};
use std::time::Duration;

const COOKIE: &str = "lab";
/// A wrong guess takes so long, and those behind it wait.
const WRONG_TAKES: Duration = Duration::from_millis(500);
/// Cookies that are good at a time; the oldest goes first.
const MOST_COOKIES: usize = 200;

impl Shared {
    /// Whether somebody gave the password. A cookie that nobody was given is a guess, and takes as long as one.
    pub(crate) async fn entered(&self, headers: &HeaderMap) -> bool {
        let cookies = headers.get_all(header::COOKIE).iter();
        let cookies = cookies.filter_map(|c| c.to_str().ok());
        let given: Vec<&str> = cookies
            .flat_map(|all| all.split("; "))
            .filter_map(|c| c.strip_prefix(COOKIE)?.strip_prefix('='))
            .collect();
        let known = |value: &&str| {
            let cookies = held(&self.entered);
            cookies.iter().any(|c| token::same_secret(value, c))
        };
        if given.iter().any(known) {
            return true;
        }
        if !given.is_empty() {
            let _turn = self.guesses.lock().await;
            tokio::time::sleep(WRONG_TAKES).await;
        }
        false
    }

    /// Whether this is the password. Each is looked at in turn, so that many guesses at once are no faster.
    async fn is_password(&self, given: Option<&str>) -> bool {
        let _turn = self.guesses.lock().await;
        let password = self.seat.settings.password.as_deref();
        let right = password
            .zip(given)
            .is_some_and(|(password, given)| token::same_secret(given, password));
        if !right {
            tokio::time::sleep(WRONG_TAKES).await;
        }
        right
    }

    /// A cookie for somebody who gave the password.
    fn cookie(&self) -> Result<String, SeatError> {
        let value = token::new()?;
        let mut cookies = held(&self.entered);
        if cookies.len() == MOST_COOKIES {
            cookies.pop_front();
        }
        cookies.push_back(value.clone());
        let secure = match self.wire.scheme() {
            "https" => "; Secure",
            _ => "",
        };
        Ok(format!("{COOKIE}={value}; Path=/lab; HttpOnly; SameSite=Strict{secure}"))
    }
}

/// Asks for the password; `wrong` says that the last one was not it.
pub(crate) fn door(words: &Words, wrong: bool) -> Response {
    let say = |name| words.plain(name, &[]);
    let (status, said) = if wrong {
        (StatusCode::UNAUTHORIZED, format!("<p role=\"alert\">{}</p>", say("lab_wrong")))
    } else {
        (StatusCode::OK, String::new())
    };
    let page = html(
        words,
        &format!(
            "<h1>{}</h1>{said}<form method=\"post\" action=\"/lab/enter\">\
             <label>{} <input type=\"password\" name=\"password\" autofocus></label> <button>{}</button></form>",
            say("lab_title"),
            say("lab_password"),
            say("lab_enter")
        ),
    );
    (status, page).into_response()
}

pub(crate) async fn enter(State(shared): State<Shared>, body: Bytes) -> Response {
    let given = form_field(&body, "password");
    if !shared.is_password(given.as_deref()).await {
        return door(shared.words(), true);
    }
    match shared.cookie() {
        Ok(cookie) => ([(header::SET_COOKIE, cookie)], to_lab()).into_response(),
        Err(error) => Refused::from(error).into_response(),
    }
}

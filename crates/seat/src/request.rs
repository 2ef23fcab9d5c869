//! What every request has: the seat, who asks, and how they are answered.

use crate::{
    books::Books, error::SeatError, person::Person, refusals::Refusals, seat::Seat, steps::Step,
    wire::Wire, words::Words,
};
use axum::{
    http::{HeaderName, HeaderValue, StatusCode, header},
    response::{IntoResponse, Response},
};
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, VecDeque},
    net::SocketAddr,
    sync::{Arc, Mutex},
};

/// A refusal that says what to do, where something can be done.
pub(crate) fn with_help(error: SeatError) -> Refused {
    match error.suggestion() {
        Some(help) => Refused::NotThis(format!("{error}: {help}")),
        None => Refused::Failed(error),
    }
}

/// What every request is answered from.
#[derive(Clone)]
pub(crate) struct Shared {
    pub(crate) seat: Arc<Seat>,
    pub(crate) address: SocketAddr,
    /// How what is sent is kept from others.
    pub(crate) wire: Wire,
    /// Whoever gives a wrong password waits in this line.
    pub(crate) guesses: Arc<tokio::sync::Mutex<()>>,
    /// The cookies that were given for the right password.
    pub(crate) entered: Arc<Mutex<VecDeque<String>>>,
    /// Requests of each person that are not answered yet.
    pub(crate) unanswered: Arc<Mutex<BTreeMap<String, usize>>>,
    pub(crate) refusals: Arc<Refusals>,
}

impl Shared {
    pub(crate) fn words(&self) -> &Words {
        &self.seat.settings.texts.words
    }
}

/// What went wrong with a request, on its way to whoever runs the study.
#[derive(Clone)]
pub(crate) struct Why(pub(crate) String);

/// By this header a page knows a refusal that stays: no proxy has it, so theirs (413, 429, 502 …) are asked again.
pub(crate) const LASTING: HeaderName = HeaderName::from_static("maveric-refused");

/// Why a request is refused.
pub(crate) enum Refused {
    NoSuchPerson,
    /// Their part is over, or that of a step that was left out.
    Over,
    /// What was sent is not what the step may send.
    NotThis(String),
    /// Another tab has the page.
    OtherTab,
    /// The step of this place was answered before, otherwise: by a page in another browser.
    AnsweredBefore(usize),
    /// It can no longer be done.
    TooLate(String),
    Failed(SeatError),
}

impl From<SeatError> for Refused {
    fn from(error: SeatError) -> Self {
        Self::Failed(error)
    }
}

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        let (status, lasting, shown) = match self {
            Self::NoSuchPerson => {
                (StatusCode::NOT_FOUND, "no-such-person", "no such link".to_owned())
            }
            Self::Over => (StatusCode::GONE, "over", "this part of the study is over".to_owned()),
            Self::NotThis(why) => (StatusCode::BAD_REQUEST, "not-this", why),
            Self::OtherTab => {
                (StatusCode::CONFLICT, "other-tab", "this study is open in another tab".to_owned())
            }
            Self::AnsweredBefore(step) => (
                StatusCode::CONFLICT,
                "other-tab",
                format!(
                    "step {} was answered before, with other answers: the first are kept",
                    step + 1
                ),
            ),
            Self::TooLate(why) => (StatusCode::FORBIDDEN, "too-late", why),
            Self::Failed(error) => {
                // What went wrong here may pass, and is the experimenter's to read, not the person's.
                let shown = "this could not be kept; please tell whoever runs the study";
                let status = StatusCode::INTERNAL_SERVER_ERROR;
                return refusal(status, shown.to_owned(), error.to_string());
            }
        };
        let mut response = refusal(status, shown.clone(), shown);
        let lasting = HeaderValue::from_static(lasting);
        response.headers_mut().insert(LASTING, lasting);
        response
    }
}

/// A refusal as it is shown, with why on its way to whoever runs the study.
pub(crate) fn refusal(status: StatusCode, shown: String, why: String) -> Response {
    let mut response = (status, shown).into_response();
    response.extensions_mut().insert(Why(why));
    response
}

pub(crate) type Answered<T> = Result<T, Refused>;

pub(crate) fn json(value: &impl Serialize) -> Response {
    let body = serde_json::to_string(value).unwrap_or_default();
    ([(header::CONTENT_TYPE, "application/json")], body).into_response()
}

pub(crate) fn read<'a, T: Deserialize<'a>>(body: &'a [u8]) -> Answered<T> {
    serde_json::from_slice(body).map_err(|e| Refused::NotThis(e.to_string()))
}

impl Shared {
    /// Does what asks the seat's file or takes long, off the threads that serve connections.
    pub(crate) async fn blocking<T: Send + 'static, E: From<SeatError> + Send + 'static>(
        &self,
        work: impl FnOnce(&Seat) -> Result<T, E> + Send + 'static,
    ) -> Result<T, E> {
        let seat = Arc::clone(&self.seat);
        let done = tokio::task::spawn_blocking(move || work(&seat)).await;
        // A panic there is a bug, said as such and no further.
        done.map_err(|e| SeatError::Unfinished { problem: e.to_string() })?
    }
}

impl Books<'_> {
    /// The person of a link.
    pub(crate) fn somebody(&self, token: &str) -> Answered<Person> {
        self.person(token)?.ok_or(Refused::NoSuchPerson)
    }

    /// Somebody at the step that they say. A step that lies behind may come again: the reply was lost.
    pub(crate) fn at(&self, token: &str, step: usize) -> Answered<(Person, Step)> {
        let person = self.somebody(token)?;
        let there = person.steps.get(step).cloned();
        match there.filter(|_| step <= person.at) {
            Some(_) if person.ended.is_some() && step >= person.at => Err(Refused::Over),
            Some(_) if self.is_left_out(&person.participant, step)? => Err(Refused::Over),
            Some(there) => Ok((person, there)),
            // Somebody who had gone on is to drive the step before once more.
            None if self.repeats(&person)? => Err(Refused::Over),
            None => Err(Refused::NotThis(format!("step {step}, expected at most {}", person.at))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_that_stays_says_so_and_one_that_may_pass_does_not() {
        let lasting = |refused: Refused| {
            let response = refused.into_response();
            let value = response.headers().get(LASTING);
            value.map(|v| v.to_str().unwrap().to_owned())
        };
        let word = |word: &str| Some(word.to_owned());
        assert_eq!(lasting(Refused::NoSuchPerson), word("no-such-person"));
        assert_eq!(lasting(Refused::Over), word("over"));
        let not_this = Refused::NotThis("step 3".to_owned());
        assert_eq!(lasting(not_this), word("not-this"));
        assert_eq!(lasting(Refused::OtherTab), word("other-tab"));
        assert_eq!(lasting(Refused::AnsweredBefore(3)), word("other-tab"));
        let too_late = Refused::TooLate("until yesterday".to_owned());
        assert_eq!(lasting(too_late), word("too-late"));
        let full = SeatError::Unfinished { problem: "disk full".to_owned() };
        assert_eq!(lasting(Refused::Failed(full)), None);
    }
}

//! What every request has: the seat, who asks, and how they are answered.

use crate::{error::SeatError, person::Person, seat::Seat, steps::Step, token, wire::Wire};
use axum::{
    http::{StatusCode, header},
    response::{IntoResponse, Response},
};
use serde::{Deserialize, Serialize};
use std::{net::SocketAddr, sync::Arc};

/// What every request is answered from.
#[derive(Clone)]
pub(crate) struct Shared {
    pub(crate) seat: Arc<Seat>,
    pub(crate) address: SocketAddr,
    /// How what is sent is kept from others.
    pub(crate) wire: Wire,
    /// Whoever gives a wrong password waits in this line.
    pub(crate) guesses: Arc<tokio::sync::Mutex<()>>,
}

/// What went wrong with a request, on its way to the list of events.
#[derive(Clone)]
pub(crate) struct Why(pub(crate) String);

/// Why a request is refused.
pub(crate) enum Refused {
    /// Nobody has this link, or their part is over.
    NoSuchPerson,
    /// What was sent is not what the step may send.
    NotThis(String),
    /// Another tab has the page.
    OtherTab,
    /// Our own fault.
    Failed(SeatError),
}

impl From<SeatError> for Refused {
    fn from(error: SeatError) -> Self {
        Self::Failed(error)
    }
}

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        match self {
            Self::NoSuchPerson => (StatusCode::NOT_FOUND, "no such link").into_response(),
            Self::NotThis(why) => (StatusCode::BAD_REQUEST, why).into_response(),
            Self::OtherTab => {
                (StatusCode::CONFLICT, "this study is open in another tab").into_response()
            }
            // What went wrong here is the experimenter's to read, not the person's.
            Self::Failed(error) => {
                let told = "this could not be kept; please tell whoever runs the study";
                let mut response = (StatusCode::INTERNAL_SERVER_ERROR, told).into_response();
                response.extensions_mut().insert(Why(error.to_string()));
                response
            }
        }
    }
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
    /// Does what takes longer than a request should keep others waiting.
    pub(crate) async fn blocking<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Seat) -> Result<T, SeatError> + Send + 'static,
    ) -> Answered<T> {
        let seat = Arc::clone(&self.seat);
        let done = tokio::task::spawn_blocking(move || work(&seat)).await;
        // A panic there is a bug, said as such and no further.
        Ok(done.map_err(|e| SeatError::Unfinished {
            problem: e.to_string(),
        })??)
    }

    pub(crate) fn person(&self, token: &str) -> Answered<Person> {
        let known = token::possible(token).then(|| self.seat.store.person(token));
        known.transpose()?.flatten().ok_or(Refused::NoSuchPerson)
    }

    /// Somebody whose part is not over, at the step that they say.
    pub(crate) fn at(&self, token: &str, step: usize) -> Answered<(Person, Step)> {
        let person = self.person(token)?;
        if person.ended.is_some() {
            return Err(Refused::NoSuchPerson);
        }
        let found = person.steps.get(step).cloned();
        // A step that lies behind may come again: the reply was lost.
        match found.filter(|_| step <= person.at) {
            Some(found) => Ok((person, found)),
            None => Err(Refused::NotThis(format!(
                "step {step}, expected at most {}",
                person.at
            ))),
        }
    }
}

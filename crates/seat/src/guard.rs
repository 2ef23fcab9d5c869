//! What every request passes: where it comes from, how large it is and how long it takes; and what every reply says.

use crate::{
    connections::Stage,
    held::held,
    origin,
    request::{Refused, Shared, Why, refusal},
    wire::Wire,
};
use axum::{
    body::{Body, to_bytes},
    extract::{Request, State},
    http::{HeaderName, HeaderValue, Method, StatusCode, header},
    middleware::Next,
    response::{IntoResponse, Response},
};
use std::time::Duration;

/// Largest body of a drive, in bytes: some minutes of inputs that a page kept while the network was gone; and of anything else.
const LARGEST_DRIVE: usize = 2 << 20;
const LARGEST_BODY: usize = 64 << 10;
/// A body has to be there within this time.
const BODY_WITHIN: Duration = Duration::from_secs(30);
/// Requests of one person that are not answered yet.
const MOST_UNANSWERED: usize = 8;

/// What a page asks of its server.
const PARTS: [&str; 8] = ["answer", "done", "drive", "fit", "language", "leave", "model", "open"];

/// What a reply says to the browser, each once: what a page of ours may do, and that nothing of a person is kept by it.
const HEADERS: [(HeaderName, &str); 4] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; connect-src 'self'; img-src 'self' data:; \
         base-uri 'none'; form-action 'self'; frame-ancestors 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    // Links stay here; with no referrer at all a browser would hide the origin of a form, too.
    (header::REFERRER_POLICY, "same-origin"),
    (header::CACHE_CONTROL, "no-store"),
];

/// Lets a request pass, or says why not; tells whoever runs the study of what was refused.
pub(crate) async fn guard(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    let path = request.uri().path().to_owned();
    let stage = request.extensions().get::<Stage>().cloned().unwrap_or_default();
    let mut response = answered(&shared, request, next, &stage).await;
    stage.waits();
    let status = response.status();
    if status.is_client_error() || status.is_server_error() {
        let why = response.extensions().get::<Why>().map(|why| why.0.clone());
        let why = why.unwrap_or_else(|| status.to_string());
        let token = token_of(&path);
        let who = token.and_then(|token| shared.seat.whose(token));
        let part = path.split('/').nth(3).unwrap_or_default();
        let part = PARTS.iter().find(|known| **known == part);
        let why = part.map_or_else(|| why.clone(), |part| format!("{part}: {why}"));
        let ours = status.is_server_error();
        shared.refusals.add(who, &why, ours);
    }
    for (name, value) in HEADERS {
        // A file that never changes says itself how long it is kept.
        response.headers_mut().entry(name).or_insert(HeaderValue::from_static(value));
    }
    response
}

/// The token in a path of the page's server.
fn token_of(path: &str) -> Option<&str> {
    path.strip_prefix("/api/")?.split('/').next()
}

fn refused(status: StatusCode, why: &str) -> Response {
    refusal(status, why.to_owned(), why.to_owned())
}

async fn answered(shared: &Shared, request: Request, next: Next, stage: &Stage) -> Response {
    let headers = request.headers();
    if !matches!(shared.wire, Wire::BehindProxy) && !origin::host_is_ours(headers, shared.address) {
        return refused(StatusCode::MISDIRECTED_REQUEST, "not this machine's name");
    }
    if request.method() != Method::GET && !origin::own(headers) {
        return refused(StatusCode::FORBIDDEN, "from another page");
    }
    let path = request.uri().path();
    let mut largest = LARGEST_BODY;
    let mut unanswered = None;
    if let Some(token) = token_of(path) {
        // Nothing is read from whoever has no link, and little at a time from whoever has one.
        if !shared.seat.has_link(token) {
            return Refused::NoSuchPerson.into_response();
        }
        unanswered = Unanswered::one_more(shared, token);
        if unanswered.is_none() {
            return refused(StatusCode::TOO_MANY_REQUESTS, "too many requests at once");
        }
        if path.split('/').nth(3) == Some("drive") {
            largest = LARGEST_DRIVE;
        }
    }
    let (head, body) = request.into_parts();
    let read = tokio::time::timeout(BODY_WITHIN, to_bytes(body, largest));
    let body = match read.await {
        Ok(Ok(body)) => body,
        Ok(Err(_)) => {
            let why = format!("a body cut off, or of more than {largest} bytes");
            return refused(StatusCode::PAYLOAD_TOO_LARGE, &why);
        }
        Err(_) => return refused(StatusCode::REQUEST_TIMEOUT, "the body took too long"),
    };
    stage.asks();
    let response = next.run(Request::from_parts(head, Body::from(body))).await;
    drop(unanswered);
    response
}

/// A request of a person that is not answered yet.
struct Unanswered {
    shared: Shared,
    token: String,
}

impl Unanswered {
    fn one_more(shared: &Shared, token: &str) -> Option<Self> {
        let mut counts = held(&shared.unanswered);
        let count = counts.entry(token.to_owned()).or_default();
        if *count == MOST_UNANSWERED {
            return None;
        }
        *count += 1;
        Some(Self { shared: shared.clone(), token: token.to_owned() })
    }
}

impl Drop for Unanswered {
    fn drop(&mut self) {
        let mut counts = held(&self.shared.unanswered);
        if let Some(count) = counts.get_mut(&self.token) {
            *count -= 1;
            if *count == 0 {
                counts.remove(&self.token);
            }
        }
    }
}

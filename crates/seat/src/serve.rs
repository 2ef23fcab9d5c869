//! The server: the page, and what it sends.

#[cfg(feature = "tls")]
use crate::wire::tls::Encrypted;
use crate::{
    among_others::AmongOthers,
    assets,
    error::SeatError,
    intake, lab, origin,
    request::{Answered, Refused, Shared, Why, json, read},
    seat::Seat,
    sheet::Sheet,
    steps::Step,
    token,
    wire::Wire,
};
use axum::{
    Router,
    body::{Body, Bytes},
    extract::{DefaultBodyLimit, Path, Request, State},
    http::{HeaderValue, StatusCode, header},
    middleware::{self, Next},
    response::{IntoResponse, Response},
    routing::{get, post},
};
use maveric_domain::design::SeatView;
use maveric_seat_page::Fit;
use serde::{Deserialize, Serialize};
use std::{
    net::SocketAddr,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

/// Largest body that is taken, in bytes: some minutes of inputs that a page kept while the network was gone.
const LARGEST_BODY: usize = 2 << 20;

/// A server that listens.
pub struct Serving {
    listener: tokio::net::TcpListener,
    wire: Wire,
    router: Router,
    /// Where it listens.
    pub address: SocketAddr,
}

/// Listens on `address` for a seat.
///
/// # Errors
/// [`SeatError::Address`] if it cannot be listened on, or leads out of this machine where the wire is [`Wire::Here`]: what people type
/// would travel in the clear.
pub async fn serve(seat: Arc<Seat>, address: SocketAddr, wire: Wire) -> Result<Serving, SeatError> {
    let refused = |problem: String| SeatError::Address {
        address: address.to_string(),
        problem,
    };
    if !address.ip().is_loopback() && matches!(wire, Wire::Here) {
        return Err(refused(
            "others could read what is sent: --tls-cert and --tls-key encrypt it; --plain-http says that a proxy in front does".to_owned(),
        ));
    }
    let listener = tokio::net::TcpListener::bind(address)
        .await
        .map_err(|e| refused(e.to_string()))?;
    let address = listener.local_addr().map_err(|e| refused(e.to_string()))?;
    let shared = Shared {
        seat,
        address,
        wire: wire.clone(),
        guesses: Arc::default(),
    };
    Ok(Serving {
        listener,
        wire,
        router: router(shared),
        address,
    })
}

/// Listens and serves until `stop` is set; `ready` is told where.
///
/// # Errors
/// As [`serve`] and [`Serving::until`]; [`SeatError::Study`] if the files of what was given cannot be written at the end.
pub fn run(
    seat: Arc<Seat>,
    address: SocketAddr,
    wire: Wire,
    stop: Arc<AtomicBool>,
    ready: impl FnOnce(SocketAddr),
) -> Result<(), SeatError> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(|e| SeatError::Address {
            address: address.to_string(),
            problem: e.to_string(),
        })?;
    let (kept, watched) = (Arc::clone(&seat), Arc::clone(&seat));
    runtime.block_on(async {
        let serving = serve(seat, address, wire).await?;
        ready(serving.address);
        let stopped = async move {
            while !stop.load(Ordering::Relaxed) && !watched.stopping() {
                tokio::time::sleep(Duration::from_millis(100)).await;
            }
        };
        // A page that keeps its connection open does not keep the server from ending.
        tokio::select! {
            served = serving.until(std::future::pending()) => served,
            () = stopped => Ok(()),
        }
    })?;
    kept.write_files()
}

impl Serving {
    /// Serves until `stop` is done.
    ///
    /// # Errors
    /// [`SeatError::Address`] if listening fails.
    pub async fn until(
        self,
        stop: impl Future<Output = ()> + Send + 'static,
    ) -> Result<(), SeatError> {
        let address = self.address.to_string();
        let served = match self.wire {
            #[cfg(feature = "tls")]
            Wire::Tls(identity) => {
                let listener = Encrypted::new(self.listener, identity, self.address);
                axum::serve(listener, self.router)
                    .with_graceful_shutdown(stop)
                    .await
            }
            Wire::Here | Wire::BehindProxy => {
                axum::serve(self.listener, self.router)
                    .with_graceful_shutdown(stop)
                    .await
            }
        };
        served.map_err(|e| SeatError::Address {
            address,
            problem: e.to_string(),
        })
    }
}

fn router(shared: Shared) -> Router {
    Router::new()
        .route("/p/{token}", get(page))
        .route("/page/{file}", get(file))
        .route("/api/{token}", get(state))
        .route("/api/{token}/model", get(model))
        .route("/api/{token}/open/{tab}", post(open))
        .route("/api/{token}/answer/{step}", post(answer))
        .route(
            "/api/{token}/drive/{step}/{attempt}/{tab}",
            post(intake::drive),
        )
        .route("/api/{token}/fit", post(fit))
        .route("/api/{token}/done/{step}", post(done))
        .route("/api/{token}/leave", post(leave))
        .merge(lab::routes())
        .layer(DefaultBodyLimit::max(LARGEST_BODY))
        .layer(middleware::from_fn_with_state(shared.clone(), guard))
        .with_state(shared)
}

/// Refuses what other pages ask for, and says to the browser what a page of ours may do.
async fn guard(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    let headers = request.headers();
    if !matches!(shared.wire, Wire::BehindProxy) && !origin::host_is_ours(headers, shared.address) {
        return (StatusCode::MISDIRECTED_REQUEST, "not this machine's name").into_response();
    }
    if request.method() != axum::http::Method::GET && !origin::own(headers) {
        return (StatusCode::FORBIDDEN, "from another page").into_response();
    }
    let mut response = next.run(request).await;
    if let Some(Why(text)) = response.extensions().get() {
        // Where even this cannot be kept there is nobody left to tell.
        let _ = shared.seat.store.event(None, text);
    }
    let said = [
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
    for (name, value) in said {
        response
            .headers_mut()
            .insert(name, HeaderValue::from_static(value));
    }
    response
}

async fn page() -> Response {
    assets::answer("index.html")
}

async fn file(Path(name): Path<String>) -> Response {
    assets::answer(&name)
}

/// What the page begins with.
#[derive(Serialize)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a fact that the page tells"
)]
struct PageState<'a> {
    title: &'a str,
    synthetic: bool,
    made_up_model: bool,
    mph: bool,
    at: usize,
    ended: Option<&'a str>,
    steps: &'a [Step],
    fit: Option<Fit>,
    /// Drives begun at the present step.
    attempts: u32,
    /// Whether the last of them has come to its end.
    whole: bool,
    scenario: &'a str,
    view: &'a SeatView,
    /// Their style beside the others', once they are through.
    styles: Option<AmongOthers>,
}

async fn state(State(shared): State<Shared>, Path(token): Path<String>) -> Answered<Response> {
    let person = shared.person(&token)?;
    let design = &shared.seat.settings.design;
    let begun = shared.seat.store.begun(&person.participant, person.at)?;
    Ok(json(&PageState {
        title: design.title(),
        synthetic: design.synthetic(),
        made_up_model: shared.seat.settings.made_up_model,
        mph: shared.seat.mph(),
        at: person.at,
        ended: person.ended.as_deref(),
        steps: &person.steps,
        fit: person
            .fit
            .as_deref()
            .and_then(|f| serde_json::from_str(f).ok()),
        attempts: begun.last().map_or(0, |b| b.attempt),
        whole: begun.last().is_some_and(|b| b.ended),
        scenario: &shared.seat.scenario_json,
        view: &design.protocol().view,
        styles: shared.seat.among_others(&person)?,
    }))
}

async fn model(State(shared): State<Shared>, Path(token): Path<String>) -> Answered<Response> {
    shared.person(&token)?;
    let bytes = shared.seat.settings.model.clone().unwrap_or_default();
    let kind = [(header::CONTENT_TYPE, "application/octet-stream")];
    Ok((kind, Body::from(bytes)).into_response())
}

async fn open(
    State(shared): State<Shared>,
    Path((token, tab)): Path<(String, String)>,
) -> Answered<Response> {
    shared.person(&token)?;
    if !token::possible(&tab) {
        return Err(Refused::NotThis("no tab".to_owned()));
    }
    shared.seat.store.claim(&token, &tab)?;
    Ok(json(&"open"))
}

async fn answer(
    State(shared): State<Shared>,
    Path((token, step)): Path<(String, usize)>,
    body: Bytes,
) -> Answered<Response> {
    let (person, found) = shared.at(&token, step)?;
    let sheet: Sheet = read(&body)?;
    let kept = sheet.checked(&found).map_err(Refused::NotThis)?;
    shared.seat.store.answer(&person, step, &kept)?;
    Ok(json(&shared.person(&token)?.at))
}

async fn fit(
    State(shared): State<Shared>,
    Path(token): Path<String>,
    body: Bytes,
) -> Answered<Response> {
    let person = shared.person(&token)?;
    let drives = matches!(person.steps.get(person.at), Some(Step::Drive { .. }));
    if person.ended.is_some() || !drives {
        return Err(Refused::NotThis("nothing is learned here".to_owned()));
    }
    let fit: Fit = read(&body)?;
    let kept = intake::style(&fit).map_err(Refused::NotThis)?;
    shared.seat.store.fit(&person.token, &kept)?;
    Ok(json(&"kept"))
}

/// Goes on from a step that asks nothing, or whose drive has ended: a drive is then driven again and written as a log.
async fn done(
    State(shared): State<Shared>,
    Path((token, step)): Path<(String, usize)>,
) -> Answered<Response> {
    let (person, found) = shared.at(&token, step)?;
    let seat = &shared.seat;
    match &found {
        Step::Scale { .. } | Step::Text { agree: true, .. } => {
            return Err(Refused::NotThis("answers are asked here".to_owned()));
        }
        Step::Drive { .. } | Step::Ride { .. } if step == person.at => {
            let who = person.clone();
            let found = found.clone();
            let ended = shared.blocking(move |seat| seat.finish_drive(&who, step, &found));
            if !ended.await? {
                return Err(Refused::NotThis("this drive has not ended".to_owned()));
            }
        }
        Step::Thanks { .. } => {
            seat.store.ended(&person, "done")?;
            shared.blocking(Seat::write_files).await?;
        }
        _ => {}
    }
    seat.store.go_on(&token, step)?;
    let at = shared.person(&token)?.at;
    Ok(json(&at))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Leaving {
    keep: bool,
}

async fn leave(
    State(shared): State<Shared>,
    Path(token): Path<String>,
    body: Bytes,
) -> Answered<Response> {
    let person = shared.person(&token)?;
    let leaving: Leaving = read(&body)?;
    let how = if leaving.keep { "left" } else { "deleted" };
    if person.ended.is_none() {
        shared.seat.store.ended(&person, how)?;
        let who = person.participant;
        let told = shared.blocking(move |seat| {
            if !leaving.keep {
                seat.settings.files.forget(&who)?;
            }
            seat.write_files()
        });
        told.await?;
    }
    Ok(json(&how))
}

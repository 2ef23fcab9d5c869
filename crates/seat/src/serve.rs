//! The server: the page, and what it sends.

use crate::{
    among_others::AmongOthers,
    assets,
    between::Between,
    connections,
    drives::Begun,
    error::SeatError,
    guard, intake, lab, markup,
    person::Person,
    refusals::Refusals,
    request::{Answered, Refused, Shared, json, read},
    seat::Seat,
    sheet::{Sheet, say_the_same},
    steps::{self, Step},
    token, unnamed,
    wire::Wire,
    withdrawal::Withdrawal,
};
use axum::{
    Router,
    body::{Body, Bytes},
    extract::{DefaultBodyLimit, Path, RawQuery, State},
    http::{HeaderMap, StatusCode, header},
    middleware,
    response::{IntoResponse, Redirect, Response},
    routing::{get, post},
};
use maveric_domain::design::{Crash, SeatView};
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

pub struct Serving {
    listener: tokio::net::TcpListener,
    wire: Wire,
    router: Router,
    pub address: SocketAddr,
}

/// Listens on `address` for a seat; `tell` is told of whatever the server refuses or cannot keep.
///
/// # Errors
/// [`SeatError::Address`] if it cannot be listened on, or leads out of this machine where the wire is [`Wire::Here`]: what people type
/// would travel in the clear.
pub async fn serve(
    seat: Arc<Seat>,
    address: SocketAddr,
    wire: Wire,
    tell: impl Fn(&str) + Send + Sync + 'static,
) -> Result<Serving, SeatError> {
    let refused = |problem: String| SeatError::Address { address: address.to_string(), problem };
    if !address.ip().is_loopback() && matches!(wire, Wire::Here) {
        return Err(refused(
            "others could read what is sent: --tls-cert and --tls-key encrypt it; --plain-http says that a proxy in front does".to_owned(),
        ));
    }
    let listener =
        tokio::net::TcpListener::bind(address).await.map_err(|e| refused(e.to_string()))?;
    let address = listener.local_addr().map_err(|e| refused(e.to_string()))?;
    let shared = Shared {
        seat,
        address,
        wire: wire.clone(),
        guesses: Arc::default(),
        entered: Arc::default(),
        unanswered: Arc::default(),
        refusals: Arc::new(Refusals::new(Box::new(tell))),
    };
    Ok(Serving { listener, wire, router: router(shared), address })
}

/// Listens and serves until `stop` is set; `ready` is told where, and `tell` of whatever is refused or cannot be kept.
///
/// # Errors
/// As [`serve`]; [`SeatError::Study`] if the files of what was given cannot be written at the end.
pub fn run(
    seat: Arc<Seat>,
    (address, wire): (SocketAddr, Wire),
    stop: Arc<AtomicBool>,
    ready: impl FnOnce(SocketAddr),
    tell: impl Fn(&str) + Send + Sync + 'static,
) -> Result<(), SeatError> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(|e| SeatError::Address { address: address.to_string(), problem: e.to_string() })?;
    let (kept, watched) = (Arc::clone(&seat), Arc::clone(&seat));
    runtime.block_on(async {
        let serving = serve(seat, address, wire, tell).await?;
        ready(serving.address);
        let stopped = async move {
            while !stop.load(Ordering::Relaxed) && !watched.stopping() {
                tokio::time::sleep(Duration::from_millis(100)).await;
            }
        };
        // A page that keeps its connection open does not keep the server from ending.
        tokio::select! {
            () = serving.forever() => {}
            () = stopped => {}
        }
        Ok::<_, SeatError>(())
    })?;
    kept.write_all()
}

impl Serving {
    /// Serves for as long as it is waited for.
    pub async fn forever(self) {
        connections::accept(self.listener, self.wire, self.router).await;
    }
}

fn router(shared: Shared) -> Router {
    Router::new()
        .route("/", get(front))
        // Browsers ask for it by themselves.
        .route("/favicon.ico", get(|| async { StatusCode::NO_CONTENT }))
        .route("/join", get(join))
        .route("/p/{token}", get(person))
        .route("/page/{version}/{file}", get(file))
        .route("/api/{token}", get(state))
        .route("/api/{token}/model", get(model))
        .route("/api/{token}/own", get(own_drive))
        .route("/api/{token}/open/{tab}", post(open))
        .route("/api/{token}/answer/{step}", post(answer))
        .route("/api/{token}/drive/{step}/{attempt}/{tab}", post(intake::drive))
        .route("/api/{token}/language/{step}/{wanted}", post(language))
        .route("/api/{token}/fit", post(fit))
        .route("/api/{token}/done/{step}", post(done))
        .route("/api/{token}/leave", post(leave))
        .merge(lab::routes(&shared))
        // Bodies are read and measured before.
        .layer(DefaultBodyLimit::disable())
        .layer(middleware::from_fn_with_state(shared.clone(), guard::guard))
        .with_state(shared)
}

async fn front(State(shared): State<Shared>) -> Response {
    markup::html(
        shared.words(),
        "<h1>The seat of a driving study</h1><p>Whoever takes part opens the link that they were given. \
         Whoever runs the study goes to <a href=\"/lab\">the laboratory</a>.</p>",
    )
}

/// The page that everybody with a link opens.
async fn person(State(shared): State<Shared>, Path(token): Path<String>) -> Response {
    let known = shared.seat.known(&token);
    let language = known.as_ref().and_then(|known| known.language.as_deref());
    assets::page(&shared.seat.texts_in(language).words)
}

/// Whoever comes from a platform, with their id on it in the address: sent on to their own link.
async fn join(State(shared): State<Shared>, RawQuery(query): RawQuery) -> Answered<Response> {
    let name = shared.seat.settings.design.protocol().platform.clone();
    let given = url::form_urlencoded::parse(query.as_deref().unwrap_or_default().as_bytes());
    let id = given.into_iter().find(|(key, _)| Some(key.as_ref()) == name.as_deref());
    let id = id.map(|(_, id)| id.into_owned()).unwrap_or_default();
    let token = shared.blocking(move |seat| seat.join(&id)).await?;
    let token = token.ok_or_else(|| {
        let expected = name.map_or_else(
            || "this study gives links to nobody who comes by this address".to_owned(),
            |name| {
                format!("the platform did not say who you are: expected {name}=… in the address")
            },
        );
        Refused::NotThis(expected)
    })?;
    Ok(Redirect::to(&format!("/p/{token}")).into_response())
}

async fn file(Path((version, name)): Path<(String, String)>, headers: HeaderMap) -> Response {
    assets::answer((&version, &name), &headers)
}

/// What the page begins with.
#[derive(Serialize)]
#[expect(clippy::struct_excessive_bools, reason = "each is a fact that the page tells")]
struct PageState<'a> {
    title: &'a str,
    synthetic: bool,
    made_up_model: bool,
    mph: bool,
    at: usize,
    ended: Option<&'a str>,
    steps: Vec<Step>,
    fit: Option<Fit>,
    /// Drives begun at the present step.
    attempts: u32,
    /// Whether the last of them has come to its end.
    whole: bool,
    /// Whether the experimenter ended the driving.
    aborted: bool,
    /// Where the platform is that pays them.
    redirect: Option<&'a str>,
    /// When the next session is, of who is between two.
    between: Option<Between>,
    scenario: &'a str,
    crash: Crash,
    view: &'a SeatView,
    /// Their style beside the others', once they are through.
    styles: Option<AmongOthers>,
    withdraw: Withdrawal,
}

async fn state(State(shared): State<Shared>, Path(token): Path<String>) -> Answered<Response> {
    shared.blocking(move |seat| state_of(seat, &token)).await
}

fn state_of(seat: &Seat, token: &str) -> Answered<Response> {
    let design = &seat.settings.design;
    let leads = design.protocol().redirect.as_ref();
    let (person, ended, begun, aborted, between, redirect) = seat.store.look(|b| {
        let Some(person) = b.person(token)? else {
            if !b.link_forgotten(token)? {
                return Err(Refused::NoSuchPerson);
            }
            let nobody = Person::new(String::new(), String::new(), Vec::new());
            return Ok((
                nobody,
                Some(DELETED),
                Vec::new(),
                false,
                None,
                leads.and_then(|leads| leads.stopped.as_deref()),
            ));
        };
        let begun = b.begun(&person.participant, person.at)?;
        let aborted = b.is_aborted(&person.participant)?;
        let between = Between::at(b, &person)?;
        let redirect = b.leads_to(leads, &person)?;
        Ok((person, None, begun, aborted, between, redirect))
    })?;
    let rides = steps::coded_rides(&person.steps);
    let on_page = person.steps.iter().map(|s| s.for_page(&rides));
    let on_page = on_page.map(|step| unnamed::step(seat.model.as_ref(), step));
    Ok(json(&PageState {
        title: design.title(),
        synthetic: design.synthetic(),
        made_up_model: seat.settings.made_up_model,
        mph: seat.mph(),
        at: person.at,
        ended: ended.or(person.ended.as_deref()),
        steps: on_page.collect::<Result<_, _>>()?,
        fit: person.style(),
        attempts: begun.last().map_or(0, |b| b.attempt),
        whole: begun.last().is_some_and(Begun::is_whole),
        aborted,
        redirect,
        between,
        scenario: &seat.scenario_json,
        crash: design.protocol().crash,
        view: &design.protocol().view,
        styles: seat.among_others(&person)?,
        withdraw: seat.withdrawal(),
    }))
}

async fn model(State(shared): State<Shared>) -> Answered<Response> {
    let bytes = shared.seat.model_for_page()?;
    let kind = [(header::CONTENT_TYPE, "application/octet-stream")];
    Ok((kind, Body::from(bytes)).into_response())
}

/// The record of somebody's drive by hand, which a ride shows them again.
async fn own_drive(State(shared): State<Shared>, Path(token): Path<String>) -> Answered<Response> {
    let lines = shared.blocking(move |seat| {
        let lines = seat.store.look(|b| {
            let person = b.somebody(&token)?;
            Ok::<_, Refused>(b.own_drive(&person)?)
        })?;
        let missing = "there is no drive by hand to show again";
        lines.ok_or_else(|| Refused::NotThis(missing.to_owned()))
    });
    let kind = [(header::CONTENT_TYPE, "application/jsonl")];
    Ok((kind, lines.await?).into_response())
}

async fn open(
    State(shared): State<Shared>,
    Path((token, tab)): Path<(String, String)>,
) -> Answered<Response> {
    if !token::possible(&tab) {
        return Err(Refused::NotThis("no tab".to_owned()));
    }
    let claimed = shared.blocking(move |seat| seat.store.within(|b| b.claim(&token, &tab)));
    claimed.await?;
    Ok(json(&"open"))
}

async fn answer(
    State(shared): State<Shared>,
    Path((token, step)): Path<(String, usize)>,
    body: Bytes,
) -> Answered<Response> {
    let kept = shared.blocking(move |seat| {
        let (person, judged) = seat.store.within(|b| {
            let (person, found) = b.at(&token, step)?;
            let sheet: Sheet = read(&body)?;
            let refused = sheet.refused;
            let kept = sheet.checked(&found).map_err(Refused::NotThis)?;
            let judged = if let Some(rules) = found.rules() {
                b.judge((&person, step), &rules, refused)?;
                true
            } else {
                match b.answered(&person.participant, step)? {
                    // The reply was lost, or another browser with the same link says the same.
                    Some(before) if say_the_same(&before, &kept) => {}
                    Some(_) => return Err(Refused::AnsweredBefore(step)),
                    None => {
                        b.answer(&person, step, &kept)?;
                        b.feels_again(&person, &found, &kept)?;
                    }
                }
                false
            };
            Ok::<_, Refused>((b.somebody(&token)?, judged))
        })?;
        if judged || person.waits() {
            seat.write_files()?;
        }
        Ok::<_, Refused>(person.at)
    });
    Ok(json(&kept.await?))
}

async fn language(
    State(shared): State<Shared>,
    Path((token, step, wanted)): Path<(String, usize, String)>,
) -> Answered<Response> {
    let position = shared.blocking(move |seat| seat.choose(&token, step, &wanted));
    Ok(json(&position.await?))
}

async fn fit(
    State(shared): State<Shared>,
    Path(token): Path<String>,
    body: Bytes,
) -> Answered<Response> {
    let kept = shared.blocking(move |seat| {
        seat.store.within(|b| {
            let person = b.somebody(&token)?;
            let current = person.steps.get(person.at);
            if person.ended.is_some() || !current.is_some_and(Step::is_learned_of) {
                return Err(Refused::NotThis("nothing is learned here".to_owned()));
            }
            let fit: Fit = read(&body)?;
            let kept = intake::style(&fit).map_err(Refused::NotThis)?;
            Ok(b.fit(&person, &kept)?)
        })
    });
    kept.await?;
    Ok(json(&"kept"))
}

/// Goes on from a step that asks nothing, or whose drive has ended: a drive is then driven again and written as a log.
async fn done(
    State(shared): State<Shared>,
    Path((token, step)): Path<(String, usize)>,
) -> Answered<Response> {
    let position = shared.blocking(move |seat| {
        let (person, found) = seat.store.look(|b| b.at(&token, step))?;
        if step == person.at
            && let Some(reason) =
                seat.store.look(|b| b.stopped(&person.participant, (step, &found)))?
        {
            seat.stop_drive(&person, (step, &found), &reason)?;
            return seat.store.look(|b| Ok::<_, Refused>(b.somebody(&token)?.at));
        }
        match &found {
            Step::Language { .. }
            | Step::Computer { .. }
            | Step::Screen { .. }
            | Step::Scale { .. }
            | Step::Break { .. }
            | Step::Elsewhere { .. }
            | Step::Text { agree: true, .. } => {
                return Err(Refused::NotThis("answers are asked here".to_owned()));
            }
            Step::Between { .. } if step == person.at => seat.comes_again(&person)?,
            Step::Drive { .. } | Step::Ride { .. }
                if step == person.at && !seat.write_drive(&person, (step, &found), None)? =>
            {
                return Err(Refused::NotThis("this drive has not ended".to_owned()));
            }
            _ => {}
        }
        let ends = matches!(found, Step::Thanks { .. });
        let person = seat.store.within(|b| {
            let person = b.somebody(&token)?;
            if ends {
                b.ended(&person, "done")?;
            }
            b.go_on(&person, step)?;
            b.somebody(&token)
        })?;
        if ends || person.waits() {
            seat.write_files()?;
        }
        Ok(person.at)
    });
    Ok(json(&position.await?))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Leaving {
    keep: bool,
}

/// What somebody is told whose link leads to nothing any more.
const DELETED: &str = "deleted";

/// Leaves the study, or takes back what was given, also after the end.
async fn leave(
    State(shared): State<Shared>,
    Path(token): Path<String>,
    body: Bytes,
) -> Answered<Response> {
    let leaving: Leaving = read(&body)?;
    let refusals = Arc::clone(&shared.refusals);
    let how = shared.blocking(move |seat| {
        let left_by = seat.store.within(|b| {
            let person = match b.person(&token)? {
                None if b.link_forgotten(&token)? => return Ok(None),
                person => person.ok_or(Refused::NoSuchPerson)?,
            };
            let refused = b.refuse_consent(&person)?;
            if leaving.keep {
                b.ended(&person, "left")?;
            } else if person.ended.is_some()
                && let Some(why) = seat.withdrawal().too_late()
            {
                return Err(Refused::TooLate(why));
            }
            Ok(Some((b.somebody(&token)?, refused)))
        })?;
        let Some((person, refused)) = left_by else {
            // Where it could not be ended before it is now.
            seat.forget_the_rest()?;
            seat.write_files()?;
            return Ok(DELETED.to_owned());
        };
        if leaving.keep {
            seat.keep_unfinished(&person, person.at)?;
            seat.write_files()?;
            return Ok::<_, Refused>(person.ended.unwrap_or_default());
        }
        seat.forget(&person.participant)?;
        refusals.forget(&person.participant);
        if refused {
            seat.write_files()?;
        }
        Ok(DELETED.to_owned())
    });
    Ok(json(&how.await?))
}

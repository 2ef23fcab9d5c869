//! Connections, and how long and how many may be unfinished: whoever asks nothing, or slowly, keeps nobody else from being served.

use crate::{held::held, wire::Wire};
use axum::Router;
use hyper::{
    Request,
    body::Incoming,
    server::conn::http1,
    service::{Service as _, service_fn},
};
use hyper_util::{
    rt::{TokioIo, TokioTimer},
    service::TowerToHyperService,
};
use std::{
    collections::BTreeMap,
    net::IpAddr,
    sync::{
        Arc, Mutex,
        atomic::{AtomicU8, Ordering},
    },
    time::{Duration, Instant},
};
use tokio::{
    io::{AsyncRead, AsyncWrite},
    net::TcpListener,
    task::AbortHandle,
};

/// The head of a request has to be there within this time, from when the connection began or the request before was answered.
const HEAD_WITHIN: Duration = Duration::from_secs(30);
/// Connections from one address that have not asked anything whole after a while.
const MOST_NEW: usize = 128;
const A_WHILE: Duration = Duration::from_secs(1);
/// Connections of pages that are sent what changes: the oldest go first.
const MOST_STREAMING: usize = 32;
/// Connections in all, where the system allows as many.
const MOST: usize = 8_192;
/// Files that are open beside the connections.
const OTHER_FILES: usize = 128;
/// Where no connection can be taken the next is tried after so long.
const TRIED_AGAIN: Duration = Duration::from_millis(20);

const NEW: u8 = 0;
const ASKING: u8 = 1;
const WAITING: u8 = 2;
const STREAMING: u8 = 3;

/// What a connection is at: it has asked nothing whole yet, a request of it is being answered, it waits for the next, or it is sent
/// something for as long as it is open.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stage(Arc<AtomicU8>);

impl Stage {
    /// A request has arrived whole.
    pub(crate) fn asks(&self) {
        self.0.store(ASKING, Ordering::Relaxed);
    }

    /// It was answered; what was refused before it arrived whole does not count.
    pub(crate) fn waits(&self) {
        let to_waiting = |stage| (stage == ASKING).then_some(WAITING);
        let _ = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, to_waiting);
    }

    /// It is being answered without an end.
    pub(crate) fn streams(&self) {
        self.0.store(STREAMING, Ordering::Relaxed);
    }

    fn at(&self) -> u8 {
        self.0.load(Ordering::Relaxed)
    }
}

struct Open {
    from: IpAddr,
    since: Instant,
    stage: Stage,
    task: AbortHandle,
}

/// The connections that are open, the oldest first.
#[derive(Default)]
struct Connections {
    open: Mutex<BTreeMap<u64, Open>>,
}

impl Connections {
    /// Makes room for one more from this address: the oldest that asked nothing go, or of all the oldest that waits; none that streams
    /// but for their own number.
    fn make_room(&self, from: IpAddr, most: usize) {
        let mut open = held(&self.open);
        let idle = |o: &Open| o.from == from && o.stage.at() == NEW && o.since.elapsed() >= A_WHILE;
        hang_up_all_but(&mut open, MOST_NEW, idle);
        hang_up_all_but(&mut open, MOST_STREAMING, |o| o.stage.at() == STREAMING);
        if open.len() >= most && !hang_up(&mut open, |o| o.stage.at() == NEW) {
            hang_up(&mut open, |o| o.stage.at() == WAITING);
        }
    }
}

fn hang_up_all_but(open: &mut BTreeMap<u64, Open>, most: usize, which: impl Fn(&Open) -> bool) {
    let many = open.values().filter(|o| which(o)).count();
    for _ in most..many {
        hang_up(open, &which);
    }
}

fn hang_up(open: &mut BTreeMap<u64, Open>, which: impl Fn(&Open) -> bool) -> bool {
    let oldest = open.iter().find(|(_, o)| which(o)).map(|(id, _)| *id);
    let gone = oldest.and_then(|id| open.remove(&id));
    gone.is_some_and(|o| {
        o.task.abort();
        true
    })
}

/// How many connections the system lets us have; it is asked for as many as it may give.
fn most() -> usize {
    #[cfg(unix)]
    {
        use nix::sys::resource::{Resource, getrlimit, setrlimit};
        if let Ok((_, hard)) = getrlimit(Resource::RLIMIT_NOFILE) {
            // Where it may not be raised it stays as it is.
            let wanted = hard.min((MOST + OTHER_FILES) as u64);
            let _ = setrlimit(Resource::RLIMIT_NOFILE, wanted, hard);
            let (soft, _) = getrlimit(Resource::RLIMIT_NOFILE).unwrap_or((wanted, hard));
            return (soft as usize).saturating_sub(OTHER_FILES).clamp(1, MOST);
        }
    }
    MOST
}

/// Takes connections, each served by itself.
pub(crate) async fn accept(listener: TcpListener, wire: Wire, router: Router) {
    let connections = Arc::new(Connections::default());
    let most = most();
    for id in 0_u64.. {
        let (stream, address) = loop {
            match listener.accept().await {
                Ok(accepted) => break accepted,
                // Too many files are open, or the other end is gone already.
                Err(_) => tokio::time::sleep(TRIED_AGAIN).await,
            }
        };
        // Replies are small, and whoever asked waits for them.
        let _ = stream.set_nodelay(true);
        let from = address.ip();
        connections.make_room(from, most);
        let stage = Stage::default();
        let (router, wire) = (router.clone(), wire.clone());
        let (theirs, closed) = (stage.clone(), Arc::clone(&connections));
        let mut open = held(&connections.open);
        let task = tokio::spawn(async move {
            match wire {
                #[cfg(feature = "tls")]
                Wire::Tls(identity) => {
                    if let Some(stream) = identity.greet(stream).await {
                        serve(stream, theirs, router).await;
                    }
                }
                Wire::Here | Wire::BehindProxy => serve(stream, theirs, router).await,
            }
            held(&closed.open).remove(&id);
        });
        let task = task.abort_handle();
        let since = Instant::now();
        open.insert(id, Open { from, since, stage, task });
    }
}

async fn serve(
    stream: impl AsyncRead + AsyncWrite + Unpin + Send + 'static,
    stage: Stage,
    router: Router,
) {
    let service = TowerToHyperService::new(router);
    let service = service_fn(move |mut request: Request<Incoming>| {
        request.extensions_mut().insert(stage.clone());
        service.call(request)
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_WITHIN)
        .serve_connection(TokioIo::new(stream), service);
    // A connection that broke off is nobody's any more.
    let _ = connection.await;
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::Ipv4Addr;

    const HERE: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

    /// Connections at these stages, the oldest first.
    fn at(stages: &[u8]) -> Connections {
        let connections = Connections::default();
        for (id, stage) in (0..).zip(stages) {
            let open = Open {
                from: HERE,
                since: Instant::now(),
                stage: Stage(Arc::new(AtomicU8::new(*stage))),
                task: tokio::spawn(std::future::pending::<()>()).abort_handle(),
            };
            held(&connections.open).insert(id, open);
        }
        connections
    }

    fn left(connections: &Connections) -> Vec<u64> {
        held(&connections.open).keys().copied().collect()
    }

    #[test]
    fn what_is_streamed_stays_so_until_something_else_is_asked() {
        let stage = Stage::default();
        stage.asks();
        stage.streams();
        stage.waits();
        assert_eq!(stage.at(), STREAMING);
        stage.asks();
        stage.waits();
        assert_eq!(stage.at(), WAITING);
    }

    #[tokio::test]
    async fn a_page_that_is_sent_what_changes_makes_no_room_for_who_comes_next() {
        let connections = at(&[STREAMING, WAITING, STREAMING, WAITING]);
        connections.make_room(HERE, 4);
        assert_eq!(left(&connections), [0, 2, 3]);
        connections.make_room(HERE, 3);
        connections.make_room(HERE, 2);
        assert_eq!(left(&connections), [0, 2]);
    }

    #[tokio::test]
    async fn of_too_many_pages_that_are_sent_what_changes_the_oldest_goes() {
        let connections = at(&[STREAMING; MOST_STREAMING]);
        connections.make_room(HERE, MOST);
        assert_eq!(left(&connections).len(), MOST_STREAMING);
        let connections = at(&[STREAMING; MOST_STREAMING + 1]);
        connections.make_room(HERE, MOST);
        let left = left(&connections);
        assert_eq!((left[0], left.len()), (1, MOST_STREAMING));
    }
}

//! The experimenter's page is sent what has changed, for as long as it is open.

use crate::{books::now, connections::Stage, live::parts, request::Shared};
use axum::{
    Extension,
    body::{Body, Bytes},
    extract::State,
    http::{HeaderName, header},
    response::{IntoResponse, Response},
};
use hyper::body::Frame;
use std::{
    collections::BTreeMap,
    convert::Infallible,
    fmt::Write as _,
    pin::Pin,
    task::{Context, Poll},
    time::Duration,
};
use tokio::sync::mpsc;

/// How often it is looked whether something has changed.
const EVERY: Duration = Duration::from_secs(1);
/// The event that tells a page the seat's time, each time.
const NOW: &str = "now";

/// The page's connection: parts as they change, and once a second the time here.
pub(crate) async fn stream(
    State(shared): State<Shared>,
    Extension(stage): Extension<Stage>,
) -> Response {
    let (sender, parts) = mpsc::channel(1);
    stage.streams();
    tokio::spawn(send(shared, sender));
    let head = [
        (header::CONTENT_TYPE, "text/event-stream"),
        // A proxy in front passes each on at once.
        (HeaderName::from_static("x-accel-buffering"), "no"),
    ];
    (head, Body::new(Events(parts))).into_response()
}

/// Sends until the page is gone.
async fn send(shared: Shared, page: mpsc::Sender<Bytes>) {
    let mut sent: BTreeMap<&str, String> = BTreeMap::new();
    loop {
        let mut text = String::new();
        for (part, html) in parts(&shared).await {
            if sent.get(part) != Some(&html) {
                text += &event(part, &html);
                sent.insert(part, html);
            }
        }
        text += &event(NOW, &now().to_string());
        if page.send(text.into()).await.is_err() {
            return;
        }
        tokio::select! {
            () = page.closed() => return,
            () = tokio::time::sleep(EVERY) => {}
        }
    }
}

/// An event as browsers read it: text of several lines has as many lines of data.
fn event(name: &str, text: &str) -> String {
    let mut event = format!("event: {name}\n");
    for line in text.split(['\n', '\r']) {
        let _ = writeln!(event, "data: {line}");
    }
    event + "\n"
}

/// A body that goes on for as long as somebody sends.
struct Events(mpsc::Receiver<Bytes>);

impl hyper::body::Body for Events {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        let next = self.0.poll_recv(context);
        next.map(|text| text.map(|text| Ok(Frame::data(text))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_has_a_line_of_data_for_each_line_of_its_text() {
        assert_eq!(event("people", "<tr>"), "event: people\ndata: <tr>\n\n");
        assert_eq!(
            event("x", "a\rb\nc"),
            "event: x\ndata: a\ndata: b\ndata: c\n\n"
        );
        assert_eq!(event("x", ""), "event: x\ndata: \n\n");
    }
}

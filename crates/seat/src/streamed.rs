//! The experimenter's page is sent what has changed, for as long as it is open.

use crate::{books::now, connections::Stage, live::parts, request::Shared};
use axum::{
    Extension,
    body::Body,
    extract::State,
    http::{HeaderName, header},
    response::{IntoResponse, Response},
};
use futures_util::stream;
use std::{collections::BTreeMap, convert::Infallible, fmt::Write as _, time::Duration};

/// How often it is looked whether something has changed.
const EVERY: Duration = Duration::from_secs(1);
/// The event that tells a page the seat's time, each time.
const NOW: &str = "now";

/// The page's connection: parts as they change, and once a second the time here.
pub(crate) async fn stream(
    State(shared): State<Shared>,
    Extension(stage): Extension<Stage>,
) -> Response {
    stage.streams();
    let changes = stream::unfold(None, move |sent: Option<BTreeMap<&str, String>>| {
        let shared = shared.clone();
        async move {
            if sent.is_some() {
                tokio::time::sleep(EVERY).await;
            }
            let (mut sent, mut text) = (sent.unwrap_or_default(), String::new());
            for (part, html) in parts(&shared).await {
                if sent.get(part) != Some(&html) {
                    text += &event(part, &html);
                    sent.insert(part, html);
                }
            }
            text += &event(NOW, &now().to_string());
            Some((Ok::<_, Infallible>(text), Some(sent)))
        }
    });
    let head = [
        (header::CONTENT_TYPE, "text/event-stream"),
        // A proxy in front passes each on at once.
        (HeaderName::from_static("x-accel-buffering"), "no"),
    ];
    (head, Body::from_stream(changes)).into_response()
}

/// An event as browsers read it: text of several lines has as many lines of data. Written here, since an event of axum's whose text is empty
/// has no data, and a browser passes it over: what a part loses would stay there.
fn event(name: &str, text: &str) -> String {
    let mut event = format!("event: {name}\n");
    for line in text.split(['\n', '\r']) {
        let _ = writeln!(event, "data: {line}");
    }
    event + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_has_a_line_of_data_for_each_line_of_its_text() {
        assert_eq!(event("people", "<tr>"), "event: people\ndata: <tr>\n\n");
        assert_eq!(event("x", "a\rb\nc"), "event: x\ndata: a\ndata: b\ndata: c\n\n");
        assert_eq!(event("x", ""), "event: x\ndata: \n\n");
    }
}

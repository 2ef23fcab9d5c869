//! The experimenter's page goes on by itself.

use crate::support::{
    Server, TAB, entered, folder, one_person, opened,
    script::{driven, go_on, piece, until},
};
use std::{
    io::{Read as _, Write as _},
    net::TcpStream,
    time::{Duration, Instant},
};

/// What has to come comes within a second or two.
const PATIENCE: Duration = Duration::from_secs(20);

/// What a page is sent, and what has been read of it so far.
struct Page {
    stream: TcpStream,
    text: String,
}

impl Page {
    fn open(server: &Server, cookie: &str) -> Self {
        let mut stream = TcpStream::connect(server.address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let address = server.address;
        let asked =
            format!("GET /lab/live HTTP/1.1\r\nHost: {address}\r\nCookie: {cookie}\r\n\r\n");
        stream.write_all(asked.as_bytes()).unwrap();
        Self { stream, text: String::new() }
    }

    /// Reads until this is there, and gives what had come until then and with it.
    fn until(&mut self, what: &str) -> String {
        let (mut part, begun) = ([0_u8; 4096], Instant::now());
        while !self.text.contains(what) {
            let read = self.stream.read(&mut part).unwrap();
            let waits = read > 0 && begun.elapsed() < PATIENCE;
            assert!(waits, "{what} did not come: {}", self.text);
            self.text += &String::from_utf8_lossy(&part[..read]);
        }
        std::mem::take(&mut self.text)
    }
}

#[test]
fn a_page_is_sent_who_is_where_when_that_changes_and_the_time_each_second() {
    let (_folder, server, token) = one_person();
    let cookie = entered(&server);
    let mut page = Page::open(&server, &cookie);
    let first = page.until("event: now");
    assert!(first.contains("content-type: text/event-stream"), "{first}");
    assert!(first.contains("data: <tr id=\"person-P001\">"), "{first}");
    assert!(first.contains("step 1 of 11: reading"), "{first}");
    // Nothing has happened since, and nothing is sent of it again.
    page.until("event: now");
    let quiet = page.until("event: now");
    assert!(!quiet.contains("event: people"), "{quiet}");
    go_on(&server, &token);
    page.until("step 2 of 11: questionnaire");
    server.seat.let_in().unwrap();
    page.until("<tr id=\"person-P002\">");
    server.seat.note("lights\non").unwrap();
    let noted = page.until("data: on");
    assert!(noted.contains("note: lights\ndata: on"), "{noted}");
    server.seat.forget("P002").unwrap();
    let gone = page.until("event: people");
    assert!(!(gone + &page.until("event: now")).contains("P002"));
    // A drive that goes on: how far it is.
    let (at, step) = until(&server, &token, "practice");
    let (lines, _) = driven(&step);
    let path = format!("/api/{token}/drive/{at}/1/{TAB}");
    assert_eq!(server.post(&path, &piece(&lines[..4])).0, 200);
    page.until("practice, 3 of 10 s<td>");
}

#[test]
fn nothing_is_sent_to_who_has_not_given_the_password() {
    let folder = folder();
    let server = Server::open(folder.path());
    opened(&server);
    let (status, reply) = server.ask("GET", "/lab/live", "", &[]);
    assert!(status == 303 && !reply.contains("P001"), "{reply}");
}

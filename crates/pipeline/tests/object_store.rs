//! A cache and inputs on a local S3 server, where `moto_server` is on the PATH.
#![expect(clippy::unwrap_used, reason = "a test stops at the first surprise")]

#[path = "../../../tests/support/where_there.rs"]
mod where_there;

use std::fs;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use maveric_pipeline::{
    Pipeline, PipelineError, Place, RunOptions, RunReport, Settings, State, run,
};

/// The variables by which `object_store` finds the server; this test file is a process of its own.
const CHILD: &str = "MAVERIC_PIPELINE_TEST_BUCKET";

/// The server believes who one says one is.
const SIGNED: &str = "Authorization: AWS4-HMAC-SHA256 Credential=someone/20260101/us-east-1/s3/aws4_request, \
    SignedHeaders=host, Signature=0";

struct Server {
    child: Child,
    port: u16,
}

impl Server {
    fn start() -> Result<Self, String> {
        let port = TcpListener::bind("127.0.0.1:0")
            .unwrap()
            .local_addr()
            .unwrap()
            .port();
        let child = Command::new("moto_server")
            .args(["-H", "127.0.0.1", "-p", &port.to_string()])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn();
        let Ok(mut child) = child else {
            return Err("`moto_server` is not on the PATH".to_owned());
        };
        let until = Instant::now() + Duration::from_mins(1);
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            if child.try_wait().unwrap().is_some() {
                return Err("`moto_server` does not start".to_owned());
            }
            assert!(Instant::now() < until, "the server does not listen");
            std::thread::sleep(Duration::from_millis(100));
        }
        Ok(Self { child, port })
    }

    /// What the server says to a request.
    fn ask(&self, verb: &str, path: &str, body: &str) -> String {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        let length = body.len();
        write!(
            stream,
            "{verb} {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n{SIGNED}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{body}"
        )
        .unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let answer = String::from_utf8_lossy(&answer).into_owned();
        assert!(answer.starts_with("HTTP/1.1 2"), "{verb} {path}: {answer}");
        answer
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

const PIPELINE: &str = r#"
name = "p"
[fetch]
"raw/logs" = "s3://lab/study/logs"
"raw/one.txt" = "s3://lab/study/one.txt"
[[stage]]
name = "sum"
cmd = ["sh", "-c", "mkdir -p out; cat raw/logs/a.txt raw/logs/deep/b.txt raw/one.txt > out/sum; head -c 20000000 /dev/zero > out/big; echo ran >> RAN"]
inputs = ["raw/logs", "raw/one.txt"]
outputs = ["out"]
"#;

fn run_in(root: &Path, ran: &Path) -> Result<RunReport, PipelineError> {
    let text = PIPELINE.replace("RAN", &ran.display().to_string());
    let pipeline = Pipeline::parse(&text, "p.toml".as_ref(), root, &Settings::default())?;
    let place = Place {
        root: root.to_owned(),
        ledger: root.join("p.lock"),
        log_dir: root.join(".logs"),
        program: None,
    };
    let options = RunOptions {
        cache: Some("s3://lab/cache".into()),
        ..RunOptions::default()
    };
    run(&pipeline, &place, &options, &mut |_| {})
}

fn state(root: &Path, ran: &Path) -> State {
    let report = run_in(root, ran).unwrap();
    let wrong = (&report.warnings, &report.failures);
    assert!(wrong.0.is_empty() && wrong.1.is_empty(), "{wrong:?}");
    report.stages[0].state
}

fn main() {
    if let Ok(port) = std::env::var(CHILD) {
        let server = Server {
            child: Command::new("true").spawn().unwrap(),
            port: port.parse().unwrap(),
        };
        return on(&server);
    }
    let server = if cfg!(feature = "object-store") {
        Server::start()
    } else {
        Err("the feature `object-store` is off".to_owned())
    };
    let missing = server.as_ref().err().cloned();
    let name = "inputs_are_fetched_when_they_change_and_outputs_come_from_the_bucket";
    let test = move || beside(&server.unwrap());
    where_there::run(vec![where_there::trial(name, missing, test)]);
}

/// Runs this file once more, with the variables that name the server.
fn beside(server: &Server) {
    let itself = std::env::current_exe().unwrap();
    let status = Command::new(itself)
        .env(CHILD, server.port.to_string())
        .env("AWS_ACCESS_KEY_ID", "someone")
        .env("AWS_SECRET_ACCESS_KEY", "secret")
        .env("AWS_REGION", "us-east-1")
        .env("AWS_ALLOW_HTTP", "true")
        .env(
            "AWS_ENDPOINT_URL",
            format!("http://127.0.0.1:{}", server.port),
        )
        .status();
    assert!(status.unwrap().success());
}

fn on(server: &Server) {
    let folder = tempfile::tempdir().unwrap();
    let ran = folder.path().join("ran");
    let count = || fs::read_to_string(&ran).unwrap_or_default().lines().count();
    server.ask("PUT", "/lab", "");
    server.ask("PUT", "/lab/study/logs/a.txt", "a\n");
    server.ask("PUT", "/lab/study/logs/deep/b.txt", "b\n");
    server.ask("PUT", "/lab/study/one.txt", "one\n");
    let (mine, yours) = (folder.path().join("mine"), folder.path().join("yours"));
    fs::create_dir_all(&mine).unwrap();
    fs::create_dir_all(&yours).unwrap();
    assert_eq!(state(&mine, &ran), State::Done);
    assert_eq!(
        fs::read_to_string(mine.join("out/sum")).unwrap(),
        "a\nb\none\n"
    );
    // Another folder takes what the first has made, parts of 8 MiB and all.
    assert_eq!(state(&yours, &ran), State::Restored);
    assert_eq!(
        fs::read(yours.join("out/big")).unwrap(),
        vec![0; 20_000_000]
    );
    assert_eq!((state(&yours, &ran), count()), (State::UpToDate, 1));
    // What changes there is fetched again, what goes there goes here, and what is damaged there is made anew.
    server.ask("PUT", "/lab/study/one.txt", "two\n");
    assert_eq!((state(&mine, &ran), count()), (State::Done, 2));
    assert_eq!(
        fs::read_to_string(mine.join("out/sum")).unwrap(),
        "a\nb\ntwo\n"
    );
    server.ask("PUT", "/lab/study/logs/c.txt", "c\n");
    assert_eq!(state(&mine, &ran), State::Done);
    assert!(mine.join("raw/logs/c.txt").exists());
    server.ask("DELETE", "/lab/study/logs/c.txt", "");
    assert_eq!((state(&mine, &ran), count()), (State::Restored, 3));
    assert!(!mine.join("raw/logs/c.txt").exists());
    let text = PIPELINE.replace("s3://lab/study/logs", "s3://lab/nothing");
    let error = Pipeline::parse(&text, "p.toml".as_ref(), &mine, &Settings::default());
    let place = Place::below(&mine);
    let error = run(&error.unwrap(), &place, &RunOptions::default(), &mut |_| {}).unwrap_err();
    assert!(error.to_string().contains("s3://lab/nothing"), "{error}");
}

//! Many people driving at once against one server, all on this machine: how long an upload takes, whether every row is kept, and (on
//! Linux) what the server needs of a processor, with so many pages of the experimenter's open.
//!
//! usage: `cargo run --release -p maveric-seat --example load -- [PEOPLE] [SECONDS] [PAGES]`

#![expect(clippy::print_stdout, reason = "a program that says what it measured")]

use maveric_domain::{Design, DrivenBy, ScoreRange, Seconds};
use maveric_seat::{Seat, SeatSettings, Wire, files::Files, serve, steps::Texts};
use maveric_seat_page::{Chunk, Frames, Held, Input, SeatDrive, Signal};
use maveric_simulator::{Hands, Scenario};
use serde_json::Value;
use std::{
    error::Error,
    io::{Read as _, Write as _},
    net::{SocketAddr, TcpStream},
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

type Failed = Box<dyn Error + Send + Sync>;

const DESIGN: &str = r#"
[study]
title = "Load"
[[condition]]
id = "calm"
[baseline]
id = "own"
[protocol]
steps = ["drive"]
drive_s = 7200
"#;
const TAB: &str = "00112233445566778899aabbccddeeff";
const TICKS: u64 = 100;
/// Bytes that the experimenter's pages were sent.
static WATCHED: AtomicU64 = AtomicU64::new(0);
const PASSWORD: &str = "load";

fn main() -> Result<(), Failed> {
    let mut given = std::env::args().skip(1);
    let mut number = |otherwise: u64| given.next().map_or(Ok(otherwise), |a| a.parse());
    let (people, seconds, pages) = (number(1_000)?, number(30)?, number(0)?);
    let folder = tempfile::tempdir()?;
    let seat = Arc::new(Seat::open(&folder.path().join("seat.db"), settings()?)?);
    let links: Vec<String> = (0..people).map(|_| seat.let_in()).collect::<Result<_, _>>()?;
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    let any = SocketAddr::from(([127, 0, 0, 1], 0));
    let serving = runtime.block_on(serve(Arc::clone(&seat), any, Wire::Here, |_| {}))?;
    let address = serving.address;
    runtime.spawn(serving.forever());
    println!("http://{address}/lab (password: {PASSWORD})");

    for _ in 0..pages {
        thread::spawn(move || watch(address));
    }
    let begun = Instant::now();
    let before_s = server_s();
    let drivers: Vec<_> = (links.into_iter().zip(0_u64..))
        .map(|(link, at)| {
            let wait = Duration::from_millis(1_000 * at / people);
            thread::Builder::new()
                .stack_size(256 << 10)
                .spawn(move || drive(address, &link, wait, seconds))
        })
        .collect::<Result<_, _>>()?;
    let mut took_ms = Vec::new();
    let mut kept = 0;
    for driver in drivers {
        let (took, last) = driver.join().map_err(|_| "a driver stopped")??;
        took_ms.extend(took);
        kept += last;
    }
    let (took_s, needed_s) = (begun.elapsed().as_secs_f64(), server_s() - before_s);
    took_ms.sort_by(f64::total_cmp);
    let quantile_ms = |share: f64| took_ms[((took_ms.len() - 1) as f64 * share) as usize];
    let sent = people * seconds * TICKS;
    println!(
        "{people} people, {} uploads in {:.1} s: p50 {:.1} ms, p99 {:.1} ms, longest {:.1} ms; steps sent {sent}, kept {kept}, lost {}",
        took_ms.len(),
        took_s,
        quantile_ms(0.5),
        quantile_ms(0.99),
        quantile_ms(1.0),
        sent - kept
    );
    println!(
        "{pages} pages of the experimenter's, sent {:.0} kB a second: the server needs {:.1} % of a processor",
        WATCHED.load(Ordering::Relaxed) as f64 / 1e3 / took_s,
        100.0 * needed_s / took_s
    );
    println!("state: {} bytes", Path::new(&folder.path().join("seat.db")).metadata()?.len());
    runtime.shutdown_background();
    Ok(())
}

fn settings() -> Result<SeatSettings, Failed> {
    Ok(SeatSettings {
        design: Design::from_toml(DESIGN)?,
        scales: Vec::new(),
        // As long as the steps of a whole study are.
        in_others: Vec::new(),
        texts: Texts { thanks: Some("Thanks. ".repeat(2_500)), ..Texts::default() },
        scenario: Scenario::paper(),
        model: None,
        made_up_model: false,
        range: Some(ScoreRange::ADB),
        files: Files::nowhere(),
        password: Some(PASSWORD.to_owned()),
    })
}

/// What the server's threads have needed of a processor so far, in s; nothing where the system does not say.
fn server_s() -> f64 {
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten();
    let needed = threads.flatten().filter_map(|thread| {
        let stat = std::fs::read_to_string(thread.path().join("stat")).ok()?;
        let (name, numbers) = stat.rsplit_once(')')?;
        let mut numbers = numbers.split(' ').skip(12).map(str::parse::<f64>);
        let needed = numbers.next()?.ok()? + numbers.next()?.ok()?;
        name.contains("(tokio").then_some(needed / 100.0)
    });
    needed.sum()
}

/// The experimenter's page: is sent what changes, and reads it.
fn watch(address: SocketAddr) -> Result<(), Failed> {
    let mut stream = TcpStream::connect(address)?;
    let body = format!("password={PASSWORD}");
    let length = body.len();
    let enter = format!(
        "POST /lab/enter HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nContent-Length: {length}\r\n\r\n{body}"
    );
    stream.write_all(enter.as_bytes())?;
    let mut part = vec![0_u8; 1 << 16];
    let read = stream.read(&mut part)?;
    let reply = String::from_utf8_lossy(&part[..read]).into_owned();
    let cookie = reply.lines().find_map(|l| l.strip_prefix("set-cookie: "));
    let cookie = cookie.and_then(|c| c.split(';').next()).ok_or("no cookie")?;
    let live = format!("GET /lab/live HTTP/1.1\r\nHost: {address}\r\nCookie: {cookie}\r\n\r\n");
    stream.write_all(live.as_bytes())?;
    loop {
        let read = stream.read(&mut part)?;
        if read == 0 {
            return Ok(());
        }
        WATCHED.fetch_add(read as u64, Ordering::Relaxed);
    }
}

/// One person: a piece a second over one connection. Gives how long each upload took, in ms, and the steps that were kept.
fn drive(
    address: SocketAddr,
    link: &str,
    wait: Duration,
    seconds: u64,
) -> Result<(Vec<f64>, u64), Failed> {
    let mut stream = TcpStream::connect(address)?;
    stream.set_nodelay(true)?;
    let state = ask(&mut stream, address, "GET", &format!("/api/{link}"), "")?;
    let state: Value = serde_json::from_str(&state)?;
    let seed = state["steps"][0]["seed"].as_str().ok_or("no seed")?.parse()?;
    let scenario = Scenario::paper().with_duration(Seconds(7_200.0))?;
    let header = SeatDrive::by_hand(&scenario, seed, DrivenBy::Scripted)?.begun().header;
    ask(&mut stream, address, "POST", &format!("/api/{link}/open/{TAB}"), "null")?;
    let path = format!("/api/{link}/drive/0/1/{TAB}");
    ask(&mut stream, address, "POST", &path, &serde_json::to_string(&header)?)?;
    thread::sleep(wait);
    let begun = Instant::now();
    let (mut took, mut kept) = (Vec::new(), 0);
    for second in 0..seconds {
        let piece = serde_json::to_string(&piece(second))? + "\n";
        let sent = Instant::now();
        kept = ask(&mut stream, address, "POST", &path, &piece)?.parse()?;
        took.push(1e3 * sent.elapsed().as_secs_f64());
        thread::sleep((Duration::from_secs(second + 1)).saturating_sub(begun.elapsed()));
    }
    Ok((took, kept))
}

/// A second in which hands never rest: another input at every step.
fn piece(second: u64) -> Chunk {
    let held = (0..TICKS).map(|tick| {
        let throttle = (second * TICKS + tick) as f64 % 977.0 / 977.0;
        let hands = Hands { throttle, ..Hands::default() };
        Held { steps: 1, input: Input::new(hands, Signal::Off) }
    });
    Chunk {
        from_tick: second * TICKS,
        ticks: TICKS,
        held: held.collect(),
        frames: Frames { drawn: 60, ..Frames::default() },
        ..Chunk::default()
    }
}

fn ask(
    stream: &mut TcpStream,
    address: SocketAddr,
    method: &str,
    path: &str,
    body: &str,
) -> Result<String, Failed> {
    let length = body.len();
    let text = format!(
        "{method} {path} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nContent-Length: {length}\r\n\r\n{body}"
    );
    stream.write_all(text.as_bytes())?;
    let mut reply = Vec::new();
    let mut part = [0_u8; 4096];
    loop {
        let n = stream.read(&mut part)?;
        if n == 0 {
            return Err("the server hung up".into());
        }
        reply.extend_from_slice(&part[..n]);
        let text = String::from_utf8_lossy(&reply);
        if let Some((head, body)) = text.split_once("\r\n\r\n") {
            let length = head.to_ascii_lowercase();
            let length = length
                .split("content-length: ")
                .nth(1)
                .and_then(|rest| rest.split("\r\n").next()?.parse::<usize>().ok())
                .ok_or("no length")?;
            if body.len() >= length {
                if !head.starts_with("HTTP/1.1 200") {
                    return Err(text.into_owned().into());
                }
                return Ok(body.to_owned());
            }
        }
    }
}

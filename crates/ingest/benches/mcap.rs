//! The time from a recording to its drive, beside that of the container alone.
//!
//! `cargo bench -p maveric-ingest`: 20 minutes of Odometry at 50 Hz and ObjectArray at 20 Hz, about 7 MB in zstd. By the clock, and
//! where Linux tells it by the processor time of the thread that reads.
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark fails as tests do, and prints"
)]

use maveric_domain::Drive;
use maveric_ingest::{IngestSettings, read_log};
use std::{path::PathBuf, sync::LazyLock};

#[path = "../tests/generated/mod.rs"]
mod generated;

static LOG: LazyLock<PathBuf> = LazyLock::new(|| {
    let path = std::env::temp_dir().join(format!("maveric-bench-{}.mcap", std::process::id()));
    std::fs::write(&path, generated::log(20.0, 8)).unwrap();
    path
});

fn main() {
    divan::main();
    if std::env::args().any(|word| word == "--bench") {
        processor_times();
    }
    let _ = std::fs::remove_file(&*LOG);
}

/// What this thread alone has used, in ms.
fn used_ms() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let ns: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(ns / 1e6)
}

fn processor_times() {
    let least = |work: fn() -> usize| {
        let times = (0..50).map(|_| {
            let before = used_ms()?;
            std::hint::black_box(work());
            Some(used_ms()? - before)
        });
        times.flatten().fold(f64::INFINITY, f64::min)
    };
    let (container, drive) = (least(read_container), least(read_drive));
    println!(
        "reading thread, least of 50: container {container:.1} ms, drive {drive:.1} ms, {:.2} times",
        drive / container
    );
}

/// The mcap crate reads the container and gives every message; nothing is decoded.
fn read_container() -> usize {
    let bytes = std::fs::read(&*LOG).unwrap();
    let messages = mcap::MessageStream::new(&bytes).unwrap();
    messages.map(|m| m.unwrap().data.len()).sum()
}

/// The same file to a complete drive.
fn read_drive() -> usize {
    let logs = read_log(&LOG, &IngestSettings::default()).unwrap();
    let log = logs.into_iter().next().unwrap();
    let drive = Drive::from_recording(log.meta, &log.recording).unwrap();
    drive.len()
}

#[divan::bench(name = "mcap/messages/84000", sample_count = 20)]
fn container(bencher: divan::Bencher<'_, '_>) {
    let _ = &*LOG;
    bencher.bench(read_container);
}

#[divan::bench(name = "ingest/drive/84000", sample_count = 20)]
fn drive(bencher: divan::Bencher<'_, '_>) {
    let _ = &*LOG;
    bencher.bench(read_drive);
}

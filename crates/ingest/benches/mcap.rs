//! The time from a recording to its drive, beside that of the container alone.
//!
//! `cargo bench -p maveric-ingest`: 20 minutes of Odometry at 50 Hz and ObjectArray at 20 Hz, about 7 MB in zstd.
#![expect(clippy::unwrap_used, reason = "a benchmark fails as tests do")]

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
    let _ = std::fs::remove_file(&*LOG);
}

/// The mcap crate reads the container and gives every message; nothing is decoded.
#[divan::bench(name = "mcap/messages/84000", sample_count = 20)]
fn container(bencher: divan::Bencher<'_, '_>) {
    let path = &*LOG;
    bencher.bench(|| {
        let bytes = std::fs::read(path).unwrap();
        let messages = mcap::MessageStream::new(&bytes).unwrap();
        messages.map(|m| m.unwrap().data.len()).sum::<usize>()
    });
}

/// The same file to a complete drive.
#[divan::bench(name = "ingest/drive/84000", sample_count = 20)]
fn drive(bencher: divan::Bencher<'_, '_>) {
    let path = &*LOG;
    bencher.bench(|| {
        let found = read_log(path, &IngestSettings::default())
            .unwrap()
            .remove(0);
        Drive::from_recording(found.meta, &found.recording)
            .unwrap()
            .len()
    });
}

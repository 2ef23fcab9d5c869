//! Real recordings, where they stand beside the checkout.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first surprise")]

mod independent;
mod pairs;
mod samples;
#[path = "../../../../tests/support/where_there.rs"]
mod where_there;

use libtest_mimic::Trial;
use maveric_ingest::{IngestSettings, Mapping};
use std::path::Path;
use where_there::{shared, trial};

/// A test of a folder of recordings.
fn on(name: &'static str, folder: &'static str, test: fn(&Path)) -> Trial {
    let found = shared(folder);
    let missing = found.clone().err();
    trial(name, missing, move || test(&found.unwrap()))
}

/// Tests by their names, all of one folder.
macro_rules! of {
    ($folder:literal: $($test:ident),+ $(,)?) => {
        [$(crate::on(stringify!($test), $folder, $test)),+]
    };
}
use of;

fn settings(mapping: &str) -> IngestSettings {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
    IngestSettings {
        mapping: Some(Mapping::read(&folder.join(mapping)).unwrap()),
        ..IngestSettings::default()
    }
}

fn main() {
    let mut tests = samples::tests();
    tests.extend(pairs::tests());
    tests.extend(independent::tests());
    where_there::run(tests);
}

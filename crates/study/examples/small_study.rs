//! Makes up a very small study in a folder given as argument, ingests it and measures the drives: three commands of
//! the program, called as functions.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_study::{
    StudyError, Watch,
    stages::{
        generate::{GenerateOptions, generate},
        ingest::{IngestOptions, ingest},
        measure::{MeasureOptions, measure},
    },
};
use std::{path::PathBuf, sync::atomic::AtomicBool};

fn main() -> Result<(), StudyError> {
    let out = std::env::args_os().nth(1).map_or_else(
        || std::env::temp_dir().join("maveric-small-study"),
        PathBuf::from,
    );
    let cancel = AtomicBool::new(false);
    let watch = Watch::new(&|_, _, _| {}, &cancel);
    let made = GenerateOptions {
        out: out.clone(),
        scenario: None,
        scales: "study_data/scales".into(),
        effects: "study_data/effects.toml".into(),
        study1: 2,
        study2: 1,
        duration_s: Some(120.0),
        repeat_drives: false,
        seed: 1,
        jobs: 1,
    };
    let drives = out.join("drives");
    let read = IngestOptions {
        logs: vec![out.join("logs/study1")],
        out: drives.clone(),
        mapping: None,
        rate_hz: None,
        recover: false,
        jobs: 1,
    };
    let measured = MeasureOptions {
        drives: vec![drives],
        out: out.join("measurements.csv"),
    };
    for line in generate(&made, watch)?.summary {
        println!("{line}");
    }
    for line in ingest(&read, watch)?.summary {
        println!("{line}");
    }
    for line in measure(&measured, watch)?.summary {
        println!("{line}");
    }
    Ok(())
}

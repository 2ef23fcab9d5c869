//! What the pipeline itself costs, beside what its stages do.
//!
//! `cargo bench -p maveric-pipeline`
#![allow(clippy::unwrap_used, reason = "a bench stops at the first surprise")]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use divan::Bencher;
use divan::counter::{BytesCount, ItemsCount};
use maveric_pipeline::{Graph, Pipeline, Place, RunOptions, Settings, run, status};

fn main() {
    divan::main();
}

/// `stages` stages in chains of a hundred, each with a file of its own.
fn chains(stages: usize) -> String {
    let mut text = "name = 'p'\n".to_owned();
    for i in 0..stages {
        let input =
            if i % 100 == 0 { "source.txt".to_owned() } else { format!("out/{}.txt", i - 1) };
        writeln!(
            text,
            "[[stage]]\nname = 's{i}'\ncmd = ['cp', '{input}', 'out/{i}.txt']\n\
             inputs = ['{input}']\noutputs = ['out/{i}.txt']"
        )
        .unwrap();
    }
    text
}

fn place(root: &Path) -> Place {
    fs::write(root.join("source.txt"), "source\n").unwrap();
    Place::below(root)
}

fn read(text: &str, root: &Path) -> Pipeline {
    Pipeline::parse(text, "p.toml".as_ref(), root, &Settings::default()).unwrap()
}

#[divan::bench(name = "pipeline/graph_read_and_ordered", args = [100, 10_000])]
fn graph(bencher: Bencher<'_, '_>, stages: usize) {
    let text = chains(stages);
    bencher
        .counter(ItemsCount::new(stages))
        .bench_local(|| Graph::new(&read(&text, ".".as_ref())).unwrap().ordered().count());
}

/// Each stage is a process of `cp`; how long that takes alone is the next bench.
#[divan::bench(name = "pipeline/run", args = [200], sample_count = 5)]
fn run_all(bencher: Bencher<'_, '_>, stages: usize) {
    let text = chains(stages);
    bencher
        .counter(ItemsCount::new(stages))
        .with_inputs(|| tempfile::tempdir().unwrap())
        .bench_local_refs(|folder| {
            let pipeline = read(&text, folder.path());
            let options = RunOptions::default();
            run(&pipeline, &place(folder.path()), &options, &mut |_| {}).unwrap()
        });
}

#[divan::bench(name = "pipeline/the_same_processes_alone", args = [200], sample_count = 5)]
fn processes(bencher: Bencher<'_, '_>, stages: usize) {
    bencher
        .counter(ItemsCount::new(stages))
        .with_inputs(|| tempfile::tempdir().unwrap())
        .bench_local_refs(|folder| {
            place(folder.path());
            for i in 0..stages {
                let mut cp = std::process::Command::new("cp");
                let to = format!("{i}.txt");
                let status = cp.args(["source.txt", &to]).current_dir(folder.path()).status();
                assert!(status.unwrap().success());
            }
        });
}

/// Reading, ordering and finding that nothing is to be done.
#[divan::bench(name = "pipeline/nothing_to_do", args = [100, 1_000, 10_000], sample_count = 10)]
fn nothing_to_do(bencher: Bencher<'_, '_>, stages: usize) {
    let folder = tempfile::tempdir().unwrap();
    let (text, place) = (chains(stages), place(folder.path()));
    let pipeline = read(&text, folder.path());
    run(&pipeline, &place, &RunOptions::default(), &mut |_| {}).unwrap();
    bencher.counter(ItemsCount::new(stages)).bench_local(|| {
        let pipeline = read(&text, folder.path());
        run(&pipeline, &place, &RunOptions::default(), &mut |_| {}).unwrap()
    });
}

/// One large file and many small ones, none remembered.
#[divan::bench(name = "pipeline/hash", args = [1, 1_000], sample_count = 10)]
fn hash(bencher: Bencher<'_, '_>, files: usize) {
    const BYTES: usize = 256 << 20;
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("data")).unwrap();
    for i in 0..files {
        fs::write(folder.path().join(format!("data/{i}")), vec![7; BYTES / files]).unwrap();
    }
    let text = "name = 'p'\n[[stage]]\nname = 's'\ncmd = ['true']\ninputs = ['data']\n";
    let pipeline = read(text, folder.path());
    let place = place(folder.path());
    bencher.counter(BytesCount::new(BYTES)).bench_local(|| {
        let _ = fs::remove_file(folder.path().join(".pipeline/lock.hashes"));
        status(&pipeline, &place).unwrap()
    });
}

//! Two stages without a file, brought up to date in a temporary folder.
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

use maveric_pipeline::{NewStage, Pipeline, Place, RunOptions, run};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let place = Place::below(folder.path());
    let stages = [
        NewStage::new("write", ["sh", "-c", "echo hello > hello.txt"]).makes(["hello.txt"]),
        NewStage::new("copy", ["cp", "hello.txt", "copy.txt"])
            .reads(["hello.txt"])
            .makes(["copy.txt"]),
    ];
    let pipeline = Pipeline::from_stages("greeting", &stages, &place.root)?;
    run(&pipeline, &place, &RunOptions::default(), &mut |_| {})?;
    println!(
        "{}",
        std::fs::read_to_string(folder.path().join("copy.txt"))?
    );
    Ok(())
}

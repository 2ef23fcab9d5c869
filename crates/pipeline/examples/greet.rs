//! Brings a two-stage pipeline up to date twice, in a temporary folder.
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

use maveric_pipeline::{Event, Pipeline, PipelineError, Place, RunOptions, Settings, run};

const PIPELINE: &str = r#"
name = "greeting"
[params]
who = "world"
[[stage]]
name = "write"
cmd = ["sh", "-c", "echo hello {who} > hello.txt"]
outputs = ["hello.txt"]
[[stage]]
name = "count"
cmd = ["sh", "-c", "wc -c < hello.txt | tee count.txt"]
inputs = ["hello.txt"]
outputs = ["count.txt"]
summary = true
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let place = Place::below(folder.path());
    bring_up_to_date(&place, &[])?;
    bring_up_to_date(&place, &[])?;
    bring_up_to_date(&place, &[("who".to_owned(), "reader".to_owned())])?;
    Ok(())
}

fn bring_up_to_date(place: &Place, set: &[(String, String)]) -> Result<(), PipelineError> {
    let settings = Settings { set: set.to_vec(), ..Settings::default() };
    let pipeline = Pipeline::parse(PIPELINE, "greeting.toml".as_ref(), &place.root, &settings)?;
    let report = run(&pipeline, place, &RunOptions::default(), &mut |event| match event {
        Event::Started { stage, reasons, .. } => {
            for reason in reasons {
                println!("{stage} runs: {reason}");
            }
        }
        Event::UpToDate { stage, .. } => println!("{stage} is up to date"),
        _ => {}
    })?;
    for summary in report.summaries {
        println!("{}: {} bytes\n", summary.stage, summary.text.trim());
    }
    Ok(())
}

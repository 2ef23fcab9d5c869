//! Pipelines of somebody else's, and runs that are killed.

use super::*;

/// The example of a pipeline that counts words, in the folder `name`.
fn novels(study: &TempStudy, name: &str) {
    let example = crate::support::root().join("crates/pipeline/examples/novels");
    for file in [
        "books.csv",
        "pipelines/words.toml",
        "texts/moby.txt",
        "texts/pride.txt",
        "texts/cities.txt",
    ] {
        let content = std::fs::read(example.join(file)).unwrap();
        study.write(&format!("{name}/{file}"), content);
    }
}

#[test]
fn variants_are_kept_compared_and_cleaned_side_by_side() {
    let study = TempStudy::new();
    novels(&study, "one");
    let words = "one/pipelines/words.toml";
    study.maveric(&["run", words]).ok();
    study.maveric(&["run", words, "--variant", "two", "--set", "top=2"]).ok();
    assert!(study.path("one/made/table.csv").exists());
    assert!(study.path("one/made-two/table.csv").exists());
    let differ = study.maveric(&["diff", words, "--variant", "two"]).ok().stdout;
    tells(&differ, &["parameter `top` changed from 3 to 2"]);
    assert!(!differ.contains("`out`"), "{differ}");
    study
        .maveric(&["diff", words, "--variant", "three"])
        .failed(2, &["no variant `three`", "there are two"]);
    study.maveric(&["diff", words]).failed(2, &["name two runs"]);
    study.maveric(&["run", words, "--variant", "../x"]).failed(2, &["cannot name a variant"]);
    study.write("one/made-two/rows/mine.txt", "");
    let cleaned = study.maveric(&["clean", words, "--variant", "two"]).ok().stdout;
    assert!(cleaned.contains("removed made-two/table.csv"), "{cleaned}");
    assert!(study.path("one/made/table.csv").exists());
    assert!(study.path("one/made-two/rows/mine.txt").exists());
    let shown = study.maveric(&["run", words, "--show"]).ok().stdout;
    assert!(shown.contains("name = \"words\"") && shown.contains("foreach = \"books.csv\""));
}

#[test]
fn a_stage_can_print_the_command_that_makes_it_again() {
    let study = TempStudy::new();
    study.write(
        "mine/pipelines/p.toml",
        "name = 'p'\n[params]\nout = 'made'\nword = 'a'\n[[stage]]\nname = 'page'\n\
         cmd = ['sh', '-c', 'echo \"$1\" {word} > {out}', 'sh', '{command}']\noutputs = ['{out}']\n",
    );
    let args = ["run", "mine/pipelines/p.toml", "--variant", "b", "--set", "word=it is"];
    study.maveric(&[&args[..], &["-j", "2"]].concat()).ok();
    let page = study.read("mine/made-b");
    let expected = "maveric run pipelines/p.toml --variant b --set 'word=it is' it is\n";
    assert_eq!(page, expected);
    assert!(study.maveric(&args).ok().stdout.contains("nothing was run"));
}

#[test]
fn a_pipeline_of_someone_elses_is_run_verified_traced_compared_and_cleaned() {
    let study = TempStudy::new();
    novels(&study, "one");
    novels(&study, "two");
    let (one, two) = ("one/pipelines/words.toml", "two/pipelines/words.toml");
    let ran = study.maveric(&["run", one, "-j", "2", "--cache", "cache"]).ok();
    assert!(ran.stdout.contains("moby,1851,the and i"), "{}", ran.stdout);
    let taken = study.maveric(&["run", two, "--cache", "cache"]).ok();
    tells(&taken.stderr, &["[9/9] table: taken from the cache"]);
    let same = study.maveric(&["diff", one, two]).ok().stdout;
    assert_eq!(same, "9 stages are the same in both\n");
    let verified = study.maveric(&["verify", one]).ok().stdout;
    assert!(verified.contains("0 not as recorded"), "{verified}");
    let path = ["trace", "one/made/rows/pride.csv", "--pipeline", one];
    let trace = study.maveric(&path).ok().stdout;
    assert!(trace.contains("(row on line 3 of books.csv)"), "{trace}");
    study.write("two/made/table.csv", "edited by hand\n");
    let verified = study.maveric(&["verify", two]);
    assert_eq!(verified.status, Some(1));
    assert!(verified.stdout.contains("made/table.csv, which it makes, has another content"));
    let cleaned = study.maveric(&["clean", two]).ok().stdout;
    assert!(cleaned.contains("kept made/table.csv"), "{cleaned}");
    let graph = study.maveric(&["graph", one]).ok().stdout;
    assert!(graph.contains(r#""count (x3)" -> "row (x3)""#), "{graph}");
}

/// Whether a process whose command line names this folder is there.
#[cfg(target_os = "linux")]
fn at_work(folder: &str) -> bool {
    let processes = std::fs::read_dir("/proc").unwrap().flatten();
    processes
        .filter_map(|entry| std::fs::read(entry.path().join("cmdline")).ok())
        .any(|line| String::from_utf8_lossy(&line).contains(folder))
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_that_is_killed_takes_its_stages_with_it_and_the_next_begins_at_once() {
    use std::time::{Duration, Instant};
    let study = TempStudy::new();
    // An hour of a hundred people: nobody waits for the end of it.
    let out = study.path("long");
    let out = out.to_str().unwrap();
    study.write(
        "pipelines/long.toml",
        format!(
            "name = \"long\"\n[[stage]]\nname = \"generate\"\ncmd = [\"maveric\", \"generate\", \"--out\", \"{out}\", \"--study1\", \"100\", \
             \"--duration\", \"3600\"]\n"
        ),
    );
    let mut run = std::process::Command::new(env!("CARGO_BIN_EXE_maveric"))
        .args(["run", "pipelines/long.toml", "-j", "1"])
        .current_dir(study.path("."))
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let within = |limit: Duration, reached: &dyn Fn() -> bool| {
        let begun = Instant::now();
        while !reached() && begun.elapsed() < limit {
            std::thread::sleep(Duration::from_millis(20));
        }
        reached()
    };
    assert!(within(Duration::from_mins(1), &|| at_work(out)));
    run.kill().unwrap();
    run.wait().unwrap();
    assert!(within(Duration::from_secs(20), &|| !at_work(out)));
    // Nothing is under way any more: the next run, of one person's minute, waits for nobody and finds its place free.
    let text = study.read("pipelines/long.toml");
    let text = text.replace("\"100\"", "\"1\"").replace("3600", "60");
    study.write("pipelines/long.toml", text);
    let run = study.maveric(&["run", "pipelines/long.toml"]).ok();
    assert!(!run.stderr.contains("wait"), "{}", run.stderr);
    assert!(study.path("long/logs").is_dir());
}

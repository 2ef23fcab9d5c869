//! What is too much is refused by its number.

use crate::support::{TempStudy, argv};
use std::fmt::Write as _;

const DESIGN: &str = "[study]\ntitle = \"Many\"\n";

fn conditions(count: usize) -> String {
    (0..count).fold(DESIGN.to_owned(), |mut text, i| {
        let _ = write!(text, "\n[[condition]]\nid = \"c{i}\"\n");
        text
    })
}

fn placed(study: &TempStudy, count: usize) -> String {
    let scenario = study.read("study_data/scenarios/cut_in.toml");
    (0..count).fold(scenario, |mut text, i| {
        let ahead_m = 100 + 10 * i;
        let _ = write!(text, "\n[[vehicles]]\nahead_m = {ahead_m}.0\nlane = 0\nspeed_mps = 20.0\n");
        text
    })
}

#[test]
fn every_limit_is_told_by_what_was_asked_and_what_is_possible() {
    let study = TempStudy::new();
    study.write("t.csv", "v\n1\n2\n3\n4\n");
    study.write("many.toml", conditions(700));
    study.write("crowd.toml", placed(&study, 20_000));
    let table = "t,x_follower,v_follower,x_leader,v_leader,leader_length,spacing\n";
    let rows = (0..20).fold(String::new(), |mut rows, i| {
        let _ = writeln!(rows, "{},{i},1,9,1,0,9", 100 * i);
        rows
    });
    study.write("oa_pair_r_f2_c.csv", format!("{table}{rows}"));
    let pipeline = |shards: u64| {
        format!(
            "name = \"p\"\n[[stage]]\nname = \"s\"\ncmd = [\"true\"]\nshards = {shards}\noutputs = [\"o\"]\n"
        )
    };
    study.write("wide.toml", pipeline(4_000_000_000));
    let ingest = "ingest oa_pair_r_f2_c.csv --mapping study_data/mappings/openacc.toml --out o";
    for (words, call) in [
        ("10000 threads, expected at most 1024", format!("{ingest} -j 10000")),
        ("200024 people, expected at most 100000", "generate --out o --learn 200000".to_owned()),
        ("at most 1000", "generate --out o --scenario crowd.toml".to_owned()),
        (
            "100 to 1000000",
            "stats bootstrap t.csv --statistic mean --value v --resamples 1000000000000".to_owned(),
        ),
        ("at most 50", "design describe --design many.toml".to_owned()),
        ("above 0, at most 1000", format!("{ingest} --rate 1e9")),
        ("rows", format!("{ingest} --rate 1000")),
        ("4000000000", "run wide.toml -n".to_owned()),
    ] {
        let ran = study.maveric(&argv(&call));
        assert!(
            matches!(ran.status, Some(1 | 2)) && ran.stderr.contains(words),
            "{call}: {:?}: {}",
            ran.status,
            ran.stderr
        );
        assert!(!study.path("o").exists(), "{call} wrote something");
    }
}

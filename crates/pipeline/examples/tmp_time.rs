#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]
use maveric_pipeline::*;
use std::fmt::Write as _;
use std::fs;
use std::time::Instant;
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut text = "name = 'p'\n".to_owned();
    for i in 0..n {
        let input = if i % 100 == 0 {
            "source.txt".to_owned()
        } else {
            format!("out/{}.txt", i - 1)
        };
        writeln!(text, "[[stage]]\nname = 's{i}'\ncmd = ['cp', '{input}', 'out/{i}.txt']\ninputs = ['{input}']\noutputs = ['out/{i}.txt']").unwrap();
    }
    fs::write(folder.path().join("source.txt"), "source\n").unwrap();
    let place = Place {
        root: folder.path().to_owned(),
        ledger: folder.path().join("p.lock"),
        log_dir: folder.path().join("logs"),
        program: None,
    };
    let t = Instant::now();
    let p = Pipeline::parse(&text, "p.toml".as_ref(), folder.path(), &[]).unwrap();
    println!("parse {:?}", t.elapsed());
    let t = Instant::now();
    Graph::new(&p).unwrap();
    println!("graph {:?}", t.elapsed());
    let t = Instant::now();
    run(&p, &place, &RunOptions::default(), &mut |_| {}).unwrap();
    println!(
        "run {:?} {:?}/stage",
        t.elapsed(),
        t.elapsed() / u32::try_from(n).unwrap()
    );
    for _ in 0..3 {
        let t = Instant::now();
        run(&p, &place, &RunOptions::default(), &mut |_| {}).unwrap();
        println!("noop {:?}", t.elapsed());
        let t = Instant::now();
        Ledger::read(&place.ledger, "p").unwrap();
        println!("  ledger {:?}", t.elapsed());
        let t = Instant::now();
        status(&p, &place).unwrap();
        println!("  status {:?}", t.elapsed());
    }
    println!(
        "{}",
        fs::read_to_string("/proc/self/status")
            .unwrap()
            .lines()
            .filter(|l| l.starts_with("VmHWM"))
            .collect::<String>()
    );
}

//! Who is left out is nowhere: every byte that is written afterwards is read.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::case_sensitive_file_extension_comparisons,
    reason = "a test stops at the first surprise, and its files are the program's own"
)]

mod support;

use maveric_study::{
    DesignFile,
    forget::{forget_person, refuse_learned_from_gone},
    tables::{Table, drives::read_drive, embeddings::read_embeddings},
};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use support::TempStudy;

/// Somebody whom the model learns from, and somebody who rides.
const LEARNED: &str = "Pae2ad5c3f7";
const TESTED: &str = "P968d0fdc85";
const KEY: &str = "a secret of this test alone";

const RUN: [&str; 7] = [
    "run",
    "--set",
    "epochs=2",
    "--set",
    "duration=60",
    "-j",
    "2",
];

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            std::fs::copy(&path, target).unwrap();
        }
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The sample that is shipped, run once: people who were made up, with their logs and answers.
fn run_once() -> TempStudy {
    let study = TempStudy::new();
    study.maveric(&["init", "mine"]).ok();
    let sample = study.path("study_data/sample");
    for part in ["logs", "surveys"] {
        copy(&sample.join(part), &study.path("mine").join(part));
    }
    let people = study.path("mine/participants.csv");
    std::fs::copy(sample.join("participants.csv"), people).unwrap();
    study.write("key", KEY);
    study.maveric_in("mine", &RUN).ok();
    collect(&study);
    study
}

/// What a seat would have collected of everybody.
fn collect(study: &TempStudy) {
    let people = std::fs::read_to_string(study.path("mine/participants.csv")).unwrap();
    let ids = || {
        people
            .lines()
            .skip(1)
            .filter_map(|line| line.split(',').next())
    };
    let mut events = "participant,step,page,moment,attempt,time_s,what,value,at\n".to_owned();
    let mut consents = "participant,step,text_sha256,at\n".to_owned();
    let mut notes =
        "at,participant,by,text\n2026-11-23T10:00:00Z,,experimenter,a window was open\n".to_owned();
    for id in ids() {
        let _ = writeln!(events, "{id},5,own,,1,12.5,uncomfortable,,");
        let _ = writeln!(events, "{id},9,end,,,,done,,2026-11-23T10:00:00Z");
        let _ = writeln!(consents, "{id},1,{},2026-11-23T09:00:00Z", "ab".repeat(32));
        let _ = writeln!(notes, "2026-11-23T10:00:00Z,{id},seat,{id}-own: 60 s");
    }
    for (name, text) in [("events", events), ("consents", consents), ("notes", notes)] {
        study.write(&format!("mine/seat/{name}.csv"), text);
    }
}

fn export(study: &TempStudy, out: &str) -> support::Ran {
    let out = format!("../{out}");
    let args = [
        "export",
        "--logs",
        "logs/study1",
        "--logs",
        "logs/study2",
        "--participants",
        "participants.csv",
        "--surveys",
        "results/answers.csv",
        "--seat",
        "seat",
        "--notes",
        "--key",
        "../key",
        "--pipeline",
        ".maveric/study.toml",
        "--out",
        &out,
    ];
    study.maveric_in("mine", &args)
}

/// How somebody could be known again.
struct Traces {
    /// Words: the id, the pseudonym, coordinates of their style to six digits.
    words: Vec<String>,
    /// Speeds of each of their drives, in m/s.
    speeds: Vec<Vec<f64>>,
    /// The words as bytes, and eight successive speeds as `f64` and `f32`.
    patterns: [Patterns; 2],
}

impl Traces {
    /// Of those people in a study that was run.
    fn of(study: &TempStudy, people: &[&str]) -> Self {
        let key = blake3_key();
        let mut words: Vec<String> = Vec::new();
        for who in people {
            words.push((*who).to_owned());
            let hash = blake3::keyed_hash(&key, who.as_bytes()).to_hex();
            words.push(format!("P{}", &hash[..10]));
        }
        for table in ["embeddings.csv", "model_embeddings.csv"] {
            let rows = read_embeddings(&study.path("mine/results").join(table)).unwrap();
            for row in rows
                .iter()
                .filter(|r| people.contains(&r.participant.as_str()))
            {
                let coordinates = row.embedding.coordinates().iter();
                words.extend(coordinates.map(|w| six_digits(*w)));
            }
        }
        let drives =
            ["mine/results/drives", "mine/results/av/drives"].map(|f| files(&study.path(f)));
        let mut speeds = Vec::new();
        for path in drives
            .concat()
            .iter()
            .filter(|p| p.extension().is_some_and(|e| e == "parquet"))
        {
            let drive = read_drive(path).unwrap();
            if people.contains(&drive.meta().participant.as_str()) {
                speeds.push(drive.rows().ego_speed_mps.clone());
            }
        }
        assert!(words.len() > 2 * people.len() && speeds.len() >= people.len());
        Self::by(words, speeds)
    }

    fn by(words: Vec<String>, speeds: Vec<Vec<f64>>) -> Self {
        let doubles = |eight: &[f64]| eight.iter().flat_map(|v| v.to_le_bytes()).collect();
        let singles = |eight: &[f64]| {
            let singles = eight.iter().map(|v| *v as f32);
            singles.flat_map(f32::to_le_bytes).collect()
        };
        let samples = eights(&speeds).flat_map(|eight| [doubles(eight), singles(eight)]);
        let bytes = words.iter().map(|word| word.clone().into_bytes());
        Self {
            patterns: [
                Patterns::of(bytes.collect()),
                Patterns::of(samples.collect()),
            ],
            words,
            speeds,
        }
    }

    /// The same without a word.
    fn samples_alone(&self) -> Self {
        Self::by(Vec::new(), self.speeds.clone())
    }

    /// A word that stands in a text.
    fn word_in(&self, text: &[u8]) -> Option<&str> {
        let at = self.patterns[0].first_in(text)?;
        Some(&self.words[at])
    }

    /// Whether eight successive samples stand among bytes, as `f64` or `f32`.
    fn samples_in_bytes(&self, bytes: &[u8]) -> bool {
        self.patterns[1].first_in(bytes).is_some()
    }

    /// Whether eight successive samples stand in a column, to a millimetre a second.
    fn samples_in(&self, column: &[f64]) -> bool {
        const NEAR: f64 = 6e-4;
        let mut eights: Vec<&[f64]> = eights(&self.speeds).collect();
        eights.sort_by(|a, b| a[0].total_cmp(&b[0]));
        column.windows(8).any(|window| {
            let from = eights.partition_point(|eight| eight[0] < window[0] - NEAR);
            let near = eights[from..]
                .iter()
                .take_while(|e| e[0] < window[0] + NEAR);
            let same = |eight: &&[f64]| eight.iter().zip(window).all(|(a, b)| (a - b).abs() < NEAR);
            near.copied().any(|eight| same(&eight))
        })
    }
}

/// Successive samples that are unlike each other, from all over each drive.
fn eights(speeds: &[Vec<f64>]) -> impl Iterator<Item = &[f64]> {
    let lively = |eight: &&[f64]| eight.windows(2).all(|w| (w[0] - w[1]).abs() > 2e-3);
    let all = speeds
        .iter()
        .flat_map(|s| s.windows(8).step_by((s.len() / 40).max(1)));
    all.filter(lively)
}

fn blake3_key() -> [u8; 32] {
    blake3::derive_key("maveric study export pseudonyms v1", KEY.as_bytes())
}

/// A number as text, cut after six significant digits: it begins every longer way to write it.
fn six_digits(w: f64) -> String {
    let text = w.to_string();
    let mut digits = 0;
    let mut started = false;
    let end = text.char_indices().find(|(_, c)| {
        started |= c.is_ascii_digit() && *c != '0';
        digits += usize::from(started && c.is_ascii_digit());
        digits > 6
    });
    text[..end.map_or(text.len(), |(at, _)| at)].to_owned()
}

/// Patterns by their first two bytes, so that a text is gone through once.
struct Patterns {
    all: Vec<Vec<u8>>,
    by_start: Vec<Vec<usize>>,
}

impl Patterns {
    fn of(all: Vec<Vec<u8>>) -> Self {
        let mut by_start = vec![Vec::new(); 1 << 16];
        for (at, pattern) in all.iter().enumerate() {
            by_start[start(pattern)].push(at);
        }
        Self { all, by_start }
    }

    /// The pattern that stands first.
    fn first_in(&self, text: &[u8]) -> Option<usize> {
        (0..text.len().saturating_sub(1)).find_map(|from| {
            let candidates = &self.by_start[start(&text[from..])];
            let stands = |at: &&usize| text[from..].starts_with(&self.all[**at]);
            candidates.iter().find(stands).copied()
        })
    }
}

fn start(bytes: &[u8]) -> usize {
    usize::from(bytes[0]) << 8 | usize::from(bytes[1])
}

/// Reads every byte of the files, and what they hold: no trace is there. `may_name` says where the id itself may stand.
#[track_caller]
fn nowhere(study: &TempStudy, folder: &str, traces: &Traces, skip: impl Fn(&str) -> bool) {
    let root = study.path(folder);
    let mut read = 0;
    for path in files(&root) {
        let name = path
            .strip_prefix(&root)
            .unwrap()
            .to_string_lossy()
            .into_owned();
        if skip(&name) {
            continue;
        }
        read += 1;
        let kind = path.extension().unwrap_or_default();
        assert_eq!(traces.word_in(name.as_bytes()), None, "the name of {name}");
        let bytes = std::fs::read(&path).unwrap();
        let mut texts = vec![bytes];
        if name.ends_with("analysis.json") {
            // The flow lists those who are left out, each with the reason.
            let mut json: serde_json::Value = serde_json::from_slice(&texts[0]).unwrap();
            json.as_object_mut().unwrap().remove("flow");
            texts[0] = json.to_string().into_bytes();
        }
        if kind == "html" {
            let inside = embedded(&texts[0]);
            texts.extend(inside);
        }
        for text in &texts {
            if let Some(word) = traces.word_in(text) {
                let at = text
                    .windows(word.len())
                    .position(|w| w == word.as_bytes())
                    .unwrap();
                let around = &text[at.saturating_sub(120)..(at + 120).min(text.len())];
                panic!("{word} is in {name}: {}", String::from_utf8_lossy(around));
            }
            assert!(!traces.samples_in_bytes(text), "samples in {name}");
        }
        if kind == "parquet" {
            let table = Table::read(&path).unwrap();
            for column in table.columns() {
                if let Ok(words) = table.text(&column) {
                    let words: Vec<String> = words.into_iter().flatten().collect();
                    assert_eq!(traces.word_in(words.join("\n").as_bytes()), None, "{name}");
                }
                if let Ok(numbers) = table.numbers(&column) {
                    let numbers: Vec<f64> = numbers.into_iter().flatten().collect();
                    assert!(!traces.samples_in(&numbers), "samples in {name}, {column}");
                }
            }
        }
        if kind == "mcap" {
            let out = study.path("decoded");
            let _ = std::fs::remove_dir_all(&out);
            let args = ["ingest", path.to_str().unwrap(), "--out", "decoded"];
            study.maveric(&args).ok();
            for drive in files(&out)
                .iter()
                .filter(|p| p.extension().is_some_and(|e| e == "parquet"))
            {
                let drive = read_drive(drive).unwrap();
                let who = drive.meta().participant.as_str().to_owned();
                assert_eq!(traces.word_in(who.as_bytes()), None, "{name}");
                assert!(
                    !traces.samples_in(&drive.rows().ego_speed_mps),
                    "samples in {name}"
                );
            }
        }
    }
    assert!(read > 3, "{read} files of {folder}");
}

/// What stands in a page as base64.
fn embedded(page: &[u8]) -> Vec<Vec<u8>> {
    use base64::Engine as _;
    let is_letter = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'/');
    let runs = page.split(|b| !is_letter(b)).filter(|run| run.len() >= 64);
    let decode = |run: &[u8]| {
        let engine = base64::engine::general_purpose::STANDARD_NO_PAD;
        engine.decode(run).ok()
    };
    runs.filter_map(decode).collect()
}

/// What the lab itself keeps: what was there before any run, lists of exclusions, what runs note of themselves.
fn labs(name: &str) -> bool {
    let own = ["logs/", "surveys/", "scales/", ".maveric/", "seat/"];
    own.iter().any(|own| name.starts_with(own))
        || ["study.toml", "participants.csv"].contains(&name)
        || name.ends_with("exclusions.csv") && name.starts_with("results/")
}

/// A change to the study's design.
fn exclude(study: &TempStudy, rules: &str) {
    let text = std::fs::read_to_string(study.path("mine/study.toml")).unwrap();
    study.write("mine/study.toml", format!("{text}\n[exclude]\n{rules}\n"));
}

/// Takes the rows of somebody out of the table of people.
fn delete_rows(study: &TempStudy, people: &[&str]) {
    let text = std::fs::read_to_string(study.path("mine/participants.csv")).unwrap();
    let kept = text
        .lines()
        .filter(|l| !people.iter().any(|p| l.starts_with(p)));
    let kept: Vec<&str> = kept.collect();
    study.write("mine/participants.csv", kept.join("\n") + "\n");
}

#[test]
fn whom_the_design_excludes_is_in_nothing_that_is_made_or_given_away() {
    let study = run_once();
    let people = [LEARNED, TESTED];
    let traces = Traces::of(&study, &people);
    let notes = std::fs::read_to_string(study.path("mine/seat/notes.csv")).unwrap();
    let sick = format!("2026-11-23T11:00:00Z,,experimenter,{TESTED} felt sick\n");
    study.write("mine/seat/notes.csv", notes + &sick);
    export(&study, "shared").ok();
    // What is read finds those who are there: their words, and by themselves their samples.
    for traces in [&traces, &traces.samples_alone()] {
        let reads = std::panic::AssertUnwindSafe(|| nowhere(&study, "shared", traces, |_| false));
        assert!(std::panic::catch_unwind(reads).is_err());
    }
    exclude(
        &study,
        &format!(
            "people = {{ {LEARNED} = \"withdrew consent\", {TESTED} = \"withdrew consent\" }}"
        ),
    );
    // What was learned from them is refused until it is trained anew.
    export(&study, "early").failed(
        1,
        &[
            "model.maveric",
            LEARNED,
            "withdrew consent",
            "maveric run train",
        ],
    );
    assert!(!study.path("early").exists());
    study.maveric_in("mine", &RUN).ok();
    nowhere(&study, "mine", &traces, labs);
    let page = std::fs::read_to_string(study.path("mine/report/index.html")).unwrap();
    assert!(page.contains("withdrew consent"), "the reason is told");
    let again = export(&study, "shared").ok();
    assert!(
        again.stdout.contains("2 people left out by exclude.people"),
        "{}",
        again.stdout
    );
    assert!(
        again
            .stderr
            .contains("2 people of the export that stood in")
            && again.stderr.contains("delete"),
        "{}",
        again.stderr
    );
    nowhere(&study, "shared", &traces, |_| false);
    assert!(
        again
            .stderr
            .contains("1 that name somebody who is left out are not"),
        "{}",
        again.stderr
    );
    // All that the study has, with tables of the drives and what was analysed.
    let whole = [
        "export",
        "--key",
        "../key",
        "--out",
        "../whole",
        "--drives",
        "parquet",
        "--notes",
        "--pipeline",
    ];
    study.maveric_in("mine", &whole).ok();
    nowhere(&study, "whole", &traces, |_| false);
    assert!(study.path("whole/outcomes_long.csv").is_file());
    let status = study.maveric_in("mine", &["status"]).ok();
    assert!(status.stdout.contains(TESTED) || status.stderr.contains(TESTED));
}

#[test]
fn whoever_has_no_row_among_the_people_any_more_is_as_one_who_was_never_there() {
    let study = run_once();
    let people = [LEARNED, TESTED];
    let traces = Traces::of(&study, &people);
    delete_rows(&study, &people);
    study.maveric_in("mine", &RUN).ok();
    nowhere(&study, "mine", &traces, labs);
    let given = export(&study, "shared").ok();
    assert!(
        given
            .stdout
            .contains("2 people left out by unknown participant")
            || given.stdout.contains("left out by unknown participant"),
        "{}",
        given.stdout
    );
    nowhere(&study, "shared", &traces, |_| false);
}

#[test]
fn a_drive_that_is_excluded_is_in_nothing_and_its_person_stays() {
    let study = run_once();
    let drive = format!("{TESTED}-own");
    let path = study.path(&format!("mine/results/drives/{drive}.parquet"));
    let speeds = read_drive(&path).unwrap().rows().ego_speed_mps.clone();
    let traces = Traces::by(vec![drive.clone()], vec![speeds]);
    exclude(
        &study,
        &format!("drives = {{ \"{drive}\" = \"simulator sickness\" }}"),
    );
    study.maveric_in("mine", &RUN).ok();
    nowhere(&study, "mine", &traces, labs);
    let given = export(&study, "shared").ok();
    assert!(
        given.stdout.contains("1 drive left out by exclude.drives"),
        "{}",
        given.stdout
    );
    nowhere(&study, "shared", &traces, |_| false);
    let people = std::fs::read_to_string(study.path("shared/participants.csv")).unwrap();
    assert_eq!(people.lines().count(), 1 + 8);
    let events = std::fs::read_to_string(study.path("shared/seat/events.csv")).unwrap();
    assert!(
        events.contains(",uncomfortable,") && !events.contains("2026"),
        "{events}"
    );
    let notes = std::fs::read_to_string(study.path("shared/seat/notes.csv")).unwrap();
    assert!(notes.contains("-own: 60 s") && notes.contains("a window was open"));
    assert!(
        given.stderr.contains("read seat/notes.csv"),
        "{}",
        given.stderr
    );
}

#[test]
fn whoever_is_forgotten_is_nowhere_but_in_the_list_of_ids() {
    let study = run_once();
    let people = [LEARNED, TESTED];
    let traces = Traces::of(&study, &people);
    let model = study.path("mine/results/model.maveric");
    let kept = std::fs::read(&model).unwrap();
    // A note that nobody but the lab can judge.
    study.write(&format!("mine/seat/{TESTED}-calm.jsonl"), "a record");
    study.write("mine/notes.txt", format!("{TESTED} was late"));
    study.write("mine/seat/seat.db-wal", TESTED);
    let design = DesignFile::read(&study.path("mine/study.toml")).unwrap();
    let (mut last, mut last_id) = (None, None);
    for who in people {
        let enrolled = design.people(None).unwrap().enrolled;
        let person = enrolled.iter().find(|p| p.id.as_str() == who).unwrap();
        last = Some(forget_person(&design, &person.id).unwrap());
        last_id = Some(person.id.clone());
    }
    let last = last.unwrap();
    assert_eq!(last.left, [study.path("mine/notes.txt")]);
    // The seat's own file is the seat's to clear.
    for path in ["notes.txt", "seat/seat.db-wal"] {
        std::fs::remove_file(study.path("mine").join(path)).unwrap();
    }
    nowhere(&study, "mine", &traces, |name| name == "forgotten.csv");
    let events = std::fs::read_to_string(study.path("mine/seat/events.csv")).unwrap();
    assert_eq!(events.lines().count(), 1 + 2 * 6);
    // An export that lies there may hold them under a pseudonym, which only its key tells.
    let earlier = study.write("mine/given/ro-crate-metadata.json", "{}");
    let again = forget_person(&design, &last_id.unwrap()).unwrap();
    assert_eq!(again.left, [earlier]);
    std::fs::remove_dir_all(study.path("mine/given")).unwrap();
    // A copy of what had learned from them is refused; what is trained anew is not.
    study.write("mine/results/model.maveric", &kept);
    let refused = refuse_learned_from_gone(&design, &model)
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("model.maveric") && refused.contains(LEARNED),
        "{refused}"
    );
    std::fs::remove_file(&model).unwrap();
    study.maveric_in("mine", &RUN).ok();
    refuse_learned_from_gone(&design, &model).unwrap();
    nowhere(&study, "mine", &traces, |name| name == "forgotten.csv");
    export(&study, "shared").ok();
    nowhere(&study, "shared", &traces, |_| false);
    // The design names them no more, and their ids are not given again.
    let text = std::fs::read_to_string(study.path("mine/study.toml")).unwrap();
    exclude(&study, &format!("people = {{ {TESTED} = \"left\" }}"));
    let named = ["exclude.people", TESTED, "forgotten"];
    study.maveric_in("mine", &["run"]).failed(1, &named);
    study.write("mine/study.toml", text);
    let table = study.path("mine/participants.csv");
    let text = std::fs::read_to_string(&table).unwrap();
    std::fs::write(
        &table,
        format!("{text}{TESTED},2,internal,30-39,male,false,\n"),
    )
    .unwrap();
    study
        .maveric_in("mine", &["run"])
        .failed(1, &["participants.csv", TESTED, "forgotten", "another id"]);
}

//! The program as a process: exit statuses, streams, broken files. What a command computes is tested where it lives.

use crate::support::{TempStudy, argv};

#[test]
fn wrong_usage_is_status_2_and_help_has_an_example() {
    let study = TempStudy::new();
    assert_eq!(study.maveric(&["frobnicate"]).status, Some(2));
    assert_eq!(study.maveric(&["train"]).status, Some(2));
    let commands = "run status graph verify diff trace clean init generate ingest inspect import \
        score codebook train personalize steer simulate measure rate evaluate stats \
        report export completions man cite";
    for command in argv(commands) {
        let help = study.maveric(&[command, "--help"]).ok().stdout;
        assert!(help.contains("Example"), "{command}: {help}");
    }
}

#[test]
fn a_stderr_that_nobody_reads_ends_no_command_half_way() {
    let study = TempStudy::new();
    study.write("t.toml", "name = 't'\n[[stage]]\nname = 'a'\ncmd = ['sh', '-c', 'echo x >&2; echo y > made']\noutputs = ['made']\n");
    for (line, status) in [
        ("run t.toml", 0),
        ("run t.toml --why nothing", 2),
        ("train", 2),
        ("frobnicate", 2),
        ("ingest nowhere.mcap --out d", 1),
        ("stats within no.csv --subject s --within w --value v", 1),
        ("report nowhere --out r", 1),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let ended =
            study.command(&argv(line)).stderr(writer).stdout(std::process::Stdio::null()).status();
        assert_eq!(ended.unwrap().code(), Some(status), "{line}");
    }
    assert!(study.path("made").exists());
}

#[test]
fn a_missing_file_an_empty_one_and_a_folder_are_named() {
    let study = TempStudy::new();
    let empty = study.write("empty.mcap", "");
    let text = study.write("text.mcap", "this is no recording\n");
    let folder = study.path("study_data");
    let out = study.path("out");
    let ingest = |log: &str| study.maveric(&["ingest", log, "--out", out.to_str().unwrap()]);
    ingest("nowhere.mcap").failed(1, &["nowhere.mcap"]);
    ingest(empty.to_str().unwrap()).failed(1, &["empty.mcap", "empty"]);
    ingest(text.to_str().unwrap()).failed(1, &["text.mcap", "neither an MCAP recording"]);
    assert!(
        !out.exists() || std::fs::read_dir(&out).unwrap().next().is_none(),
        "nothing is written"
    );
    let compare = |data: &str| {
        let columns = argv("--subject s --within w --value v");
        study.maveric(&[&["stats", "compare", data], &columns[..]].concat())
    };
    compare(folder.to_str().unwrap()).failed(1, &["is a folder"]);
    compare("nowhere.csv").failed(1, &["nowhere.csv"]);
    study.maveric(&["run", "pipelines/nowhere.toml"]).failed(1, &["nowhere.toml"]);
    let broken = study.write("pipelines/broken.toml", "name = \"x\"\n[[stage]]\nnme = \"a\"\n");
    study.maveric(&["run", broken.to_str().unwrap()]).failed(1, &["broken.toml:", "nme"]);
}

#[test]
fn an_unknown_column_gets_the_nearest_name() {
    let study = TempStudy::new();
    study.write("d.csv", "subject,condition,value\na,x,1\na,y,2\nb,x,2\nb,y,4\n");
    study
        .maveric(&argv("stats within d.csv --subject subjct --within condition --value value"))
        .failed(1, &["subjct", "did you mean `subject`"]);
}

#[test]
fn a_model_of_something_else_is_refused() {
    let study = TempStudy::new();
    study.write("model.maveric", "{\"weights\": []}");
    study.write("conditions.csv", "participant,condition,w1\nP1,mimic,0.1\n");
    study
        .maveric(&argv("simulate --model model.maveric --conditions conditions.csv --out av"))
        .failed(1, &["model.maveric"]);
    assert!(!study.path("av").exists());
}

#[test]
fn json_is_one_object_on_stdout() {
    let study = TempStudy::new();
    study.write("d.csv", "s,w,v\na,x,1\na,y,2\na,z,4\nb,x,2\nb,y,4\nb,z,5\nc,x,1\nc,y,3\nc,z,2\n");
    let ran = study
        .maveric(&argv("stats within d.csv --subject s --within w --value v --format json"))
        .ok();
    let value: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert!(value["rm_anova"]["F"].as_f64().unwrap() > 0.0);
    assert!(value["apa"].is_object() || value["apa"].is_string());
    assert!(ran.stderr.is_empty(), "{}", ran.stderr);
}

#[test]
fn who_did_not_answer_is_said_and_listed() {
    let study = TempStudy::new();
    let answers: Vec<String> = (1..=11).map(|item| format!("P1,pre,adb,{item},3")).collect();
    let surveys = format!("participant,moment,scale,item,answer\n{}\n", answers.join("\n"));
    study.write("surveys.csv", &surveys);
    study.write("participants.csv", "participant\nP1\nP2\n");
    let score = |surveys: &str| {
        let line = format!("score --surveys {surveys} --participants participants.csv");
        study.maveric(&argv(&format!("{line} --out scores.csv")))
    };
    let ran = score("surveys.csv").ok();
    assert!(ran.stderr.contains("P2"), "{}", ran.stderr);
    let listed = study.read("scores_exclusions.csv");
    assert!(listed.contains("P2,questionnaires,"), "{listed}");
    let scores = study.read("scores.csv");
    assert!(scores.contains("P1,pre,adb,total,33.0,11,11"), "{scores}");
    study.write("wrong.csv", surveys.replace(",11,3", ",11,9"));
    score("wrong.csv").failed(1, &["P1", "adb", "item 11", "9"]);
}

#[test]
fn a_sample_of_two_and_a_half_people_is_refused() {
    let study = TempStudy::new();
    study.write("power.csv", "test,n,effect,alpha\npaired_t,2.5,0.5,0.05\n");
    study
        .maveric(&["stats", "power", "power.csv"])
        .failed(1, &["row 1", "`n`", "2.5", "whole number"]);
}

#[test]
fn power_takes_a_printed_partial_eta_squared_by_a_column_of_its_own() {
    let study = TempStudy::new();
    let power = |rows: &str| {
        let text = format!("test,n,effect,eta2_partial,alpha,k,corr,epsilon\n{rows}");
        study.write("power.csv", text);
        study.maveric(&["stats", "power", "power.csv", "--format", "json"])
    };
    let both = power("rm_anova,24,,.08,.05,4,,1\nrm_anova,24,.08,,.05,4,.5,1\n").ok();
    let both: serde_json::Value = serde_json::from_str(&both.stdout).unwrap();
    assert_eq!(both["row"][0]["n_for_80"], 45);
    assert_eq!(both["row"][1]["n_for_80"], 18);
    let twice = power("rm_anova,24,.03,.08,.05,4,.5,1\n");
    twice.failed(1, &["row 1", "`effect`", "eta2_partial"]);
    let unread = power("rm_anova,24,,.08,.05,4,.5,1\n");
    unread.failed(1, &["row 1", "`corr`", "eta2_partial"]);
    let neither = power("rm_anova,24,,,.05,4,.5,1\n");
    neither.failed(1, &["row 1", "`effect`", "a number"]);
}

#[test]
fn both_kinds_of_heads_learn_the_same_bytes_again() {
    let study = TempStudy::new();
    let run = |line: &str| study.maveric(&argv(line)).ok();
    run("generate --out d --study1 4 --study2 1 --duration 90 --seed 3");
    run("ingest d/logs/study1 --out d/drives");
    for heads in ["linear", "paper"] {
        let train = |out: &str, threads: &str| {
            let drives = "--drives d/drives --epochs 4";
            run(&format!("train --heads {heads} {drives} --out {out} -j {threads}"));
        };
        train("one.maveric", "1");
        train("two.maveric", "2");
        for (one, two) in
            [("one.maveric", "two.maveric"), ("one_training.json", "two_training.json")]
        {
            let read = |name: &str| std::fs::read(study.path(name)).unwrap();
            assert!(read(one) == read(two), "{heads}: {two} differs");
        }
    }
    let unknown = argv("train --heads deep --drives d/drives --out x");
    study.maveric(&unknown).failed(2, &["deep", "linear"]);
}

#[test]
fn generated_logs_are_watched_side_by_side() {
    let study = TempStudy::new();
    let generate = "generate --out g --study1 1 --study2 1 --duration 40";
    study.maveric(&argv(generate)).ok();
    let [one, other] = ["g/logs/study1/S1P01-own.mcap", "g/logs/study2/S2P01-own.mcap"];
    let text = |path: &str| {
        String::from_utf8_lossy(&std::fs::read(study.path(path)).unwrap()).into_owned()
    };
    study.maveric(&["inspect", one, other, "--watch", "both.html"]).ok();
    let page = text("both.html");
    assert_eq!(page.matches("<li class=\"pl-row").count(), 2);
    assert!(page.contains("Synthetic participants.") && page.contains("<b>S1P01-own</b>"));
    study
        .maveric(&argv("inspect study_data/scenarios/paper.toml --watch none.html"))
        .failed(1, &["paper.toml"]);
    assert!(!study.path("none.html").exists());
}

#[test]
fn outside_a_study_run_says_what_to_do_and_the_papers_study_runs_from_the_program_alone() {
    let study = TempStudy::new();
    let empty = study.path("elsewhere");
    std::fs::create_dir(&empty).unwrap();
    for command in ["run", "status", "graph"] {
        study
            .maveric_in("elsewhere", &[command])
            .failed(1, &["there is no study here", "maveric init my_study", "--paper"]);
    }
    let told = study.maveric_in("elsewhere", &["init", "--paper"]).ok();
    assert!(told.stdout.contains("pipelines/smoke.toml"));
    let plan = study.maveric_in("elsewhere", &["run", "-n"]).ok().stdout;
    assert!(plan.contains("report: stale"), "{plan}");
    let first = argv("run pipelines/smoke.toml score --set duration=20");
    study.maveric_in("elsewhere", &first).ok();
    assert!(empty.join("study_data/generated/smoke/scores.csv").is_file());
    study.maveric_in("elsewhere", &["init", "--paper"]).failed(1, &["is not empty"]);
    study
        .maveric_in("elsewhere", &["init", "x", "--paper", "--synthetic"])
        .failed(2, &["--synthetic"]);
}

#[test]
fn an_installed_program_has_completions_a_manual_and_its_version() {
    let study = TempStudy::new();
    for (shell, words) in [
        ("bash", "complete -F _maveric"),
        ("zsh", "#compdef maveric"),
        ("fish", "complete -c maveric"),
        ("powershell", "Register-ArgumentCompleter"),
        ("elvish", "edit:completion"),
    ] {
        let text = study.maveric(&["completions", shell]).ok().stdout;
        assert!(text.contains(words) && text.contains("personalize"), "{shell}");
    }
    study.maveric(&["completions", "tcsh"]).failed(2, &["bash"]);
    study.maveric(&["man", "man"]).ok();
    let page = study.read("man/maveric-stats-within.1");
    assert!(page.contains(".SH OPTIONS") && page.contains("\\-\\-subject"));
    assert!(study.path("man/maveric.1").is_file() && !study.path("man/maveric-man.1").exists());
    let version = study.maveric(&["--version"]).ok().stdout;
    assert!(version.starts_with(concat!("maveric ", env!("CARGO_PKG_VERSION"))), "{version}");
}

#[test]
fn what_cite_prints_is_what_the_citation_file_says() {
    let file = std::fs::read_to_string(crate::support::root().join("CITATION.cff")).unwrap();
    let study = TempStudy::new();
    let printed = study.maveric(&["cite", "--format", "json"]).ok().stdout;
    let printed: serde_json::Value = serde_json::from_str(&printed).unwrap();
    let field = |entry: usize, name: &str| {
        let fields = printed["entries"][entry]["fields"].as_array().unwrap();
        let pair = fields.iter().find(|f| f[0] == name).unwrap();
        pair[1].as_str().unwrap().replace(['{', '}'], "")
    };
    for entry in [0, 1] {
        let title = format!("title: \"{}\"", field(entry, "title"));
        assert!(file.contains(&title), "{title}");
    }
    assert!(file.contains(&format!("name: {}", field(0, "author"))));
    assert!(file.contains(&format!("\nversion: {}\n", env!("CARGO_PKG_VERSION"))));
    let authors = field(1, "author");
    let in_file = file.matches("family-names:").count();
    assert_eq!(authors.split(" and ").count(), in_file);
    for author in authors.split(" and ") {
        let (family, given) = author.split_once(", ").unwrap();
        let both = format!("family-names: {family}\n        given-names: {given}\n");
        assert!(file.contains(&both), "{author}");
    }
    assert!(file.contains(&format!("arXiv:{}", field(1, "eprint"))));
    let bibtex = study.maveric(&["cite"]).ok().stdout;
    assert!(bibtex.starts_with("@software{") && bibtex.contains("@misc{schrum2023maveric,"));
}

//! What is given away of it.

use super::*;

/// Somebody who withdrew, with rows in every table, and what the lab said of them.
const WITHDREW: &str = "Person03";
const SAID: [&str; 3] = ["felt observed", "Monday", "a remark"];
const KEY: &str = "a secret of this test alone";

/// A study of seven people with a factor between them, a covariate, and somebody who withdrew.
fn with_somebody_who_withdrew() -> TempStudy {
    let people = ["Person01", "Person02", WITHDREW, "Person04", "Person05", "Person06", "Person07"];
    let study = recorded_of(&people, &["calm", "sporty"]);
    let declared = format!(
        "{DECLARED}[[factor]]\ncolumn = \"seat\"\nlabel = \"Seat, of Person03 unknown\"\n[[covariate]]\ncolumn = \"years\"\n[contrasts]"
    );
    change(&study, "mine/study.toml", "[contrasts]", &declared);
    let excluded = "# Person03 called on Monday\n[exclude]\npeople = { Person03 = \"withdrew, felt observed\" }\n";
    change(&study, "mine/study.toml", "[exclude]", excluded);
    study.write("mine/measures.csv", table_of(&people));
    let mut rows = "participant,age,seat,years,order,remark\n".to_owned();
    for (i, who) in people.iter().enumerate() {
        let seat = ["high", "low"][i % 2];
        let _ = writeln!(rows, "{who},3{i},{seat},{}.5,calm sporty,a remark", 3 * i + i * i);
    }
    study.write("mine/participants.csv", rows);
    study.write("key", KEY);
    study
}

/// Whether a word stands in a text, not inside another.
fn says(text: &str, word: &str) -> bool {
    let inside = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
    text.match_indices(word).any(|(at, _)| {
        !inside(text[..at].chars().next_back()) && !inside(text[at + word.len()..].chars().next())
    })
}

/// The files of a folder, by name or by what they hold, that say one of these words.
fn naming(folder: &Path, words: &[&str]) -> Vec<PathBuf> {
    let mut all = files(folder);
    all.retain(|path| {
        let mut text = String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
        text += &path.strip_prefix(folder).unwrap().to_string_lossy();
        if path.extension().is_some_and(|e| e == "parquet") {
            let table = Table::read(path).unwrap();
            let cells = table.columns().into_iter().map(|c| table.text(&c).unwrap());
            text.extend(cells.flatten().flatten().map(|cell| cell + "\n"));
        }
        words.iter().any(|word| says(&text, word))
    });
    all
}

/// The rows of a table of numbers and plain words, by column.
fn rows(study: &TempStudy, path: &str) -> Vec<BTreeMap<String, String>> {
    let text = study.read(path);
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
    let names: Vec<String> = lines.next().unwrap().collect();
    lines.map(|cells| names.iter().cloned().zip(cells).collect()).collect()
}

/// Mean and number of the values of an outcome in a condition.
fn mean(long: &[BTreeMap<String, String>], outcome: &str, condition: &str) -> (f64, usize) {
    let there = long.iter().filter(|row| row["condition"] == condition);
    let values: Vec<f64> = there.filter_map(|row| row[outcome].parse().ok()).collect();
    (values.iter().sum::<f64>() / values.len() as f64, values.len())
}

#[test]
fn what_is_given_away_is_what_was_analysed_and_nothing_of_whoever_withdrew() {
    let study = with_somebody_who_withdrew();
    study.mine("run").ok();
    let export = |more: &[&str]| {
        let words = argv("export --key ../key --out ../shared --pipeline");
        study.maveric_in("mine", &[&words[..], more].concat())
    };
    let given = export(&["--drives", "parquet"]).ok();
    assert!(given.stdout.contains("6 participants under pseudonyms, 18 drives"));
    tells(&given.stderr, &["are `…` in the export"]);
    let key = blake3::derive_key("maveric study export pseudonyms v1", KEY.as_bytes());
    let hash = blake3::keyed_hash(&key, WITHDREW.as_bytes()).to_hex();
    let pseudonym = format!("P{}", &hash[..10]);
    let theirs = [&SAID[..], &[WITHDREW, pseudonym.as_str(), "Person01", "Person07"]].concat();
    assert_eq!(naming(&study.path("shared"), &theirs), Vec::<PathBuf>::new());
    // The same search finds them in the study itself, in each kind of file.
    let found = naming(&study.path("mine"), &["Person01", WITHDREW]);
    let ends = |ending: &str| found.iter().any(|p| p.to_string_lossy().ends_with(ending));
    assert!(ends("study.toml") && ends("measures.csv") && ends("analysis.json"), "{found:?}");
    let dictionary = study.read("shared/dictionary.csv");
    tells(
        &dictionary,
        &[
            "measures.csv,tor_s,s,Take-over time,",
            "measures.csv,glances,,glances,",
            "files.csv,blake3,",
        ],
    );
    let pipeline = study.read("shared/pipeline.toml");
    tells(&pipeline, &["answers = \"surveys.csv\""]);
    assert!(!study.path("shared/scenario.toml").exists());
    // Every outcome has the numbers of the analysis, and one row has what the other table has.
    let (long, wide) =
        (rows(&study, "shared/outcomes_long.csv"), rows(&study, "shared/outcomes_wide.csv"));
    assert_eq!((long.len(), wide.len()), (18, 6));
    let mut units: BTreeMap<String, f64> = BTreeMap::new();
    for row in analysis(&study)["descriptives"].as_array().unwrap() {
        let (outcome, condition) =
            (row["outcome"].as_str().unwrap(), row["condition"].as_str().unwrap());
        let (value, n) = mean(&long, outcome, condition);
        assert_eq!(row["n"], n, "{row}");
        let Some(analysed) = row["mean"].as_f64().filter(|m| *m != 0.0) else {
            continue;
        };
        let unit = *units.entry(outcome.to_owned()).or_insert(analysed / value);
        assert!((analysed / value / unit - 1.0).abs() < 1e-12, "{row}: {value}");
        assert!((unit - 1.0).abs() < 1e-12 || outcome.contains("_mps"), "{outcome}: {unit}");
        for row in long.iter().filter(|row| row["condition"] == condition) {
            let person = wide.iter().find(|p| p["participant"] == row["participant"]);
            assert_eq!(person.unwrap()[&format!("{outcome}.{condition}")], row[outcome]);
        }
    }
    let known = units.contains_key("tor_s") && units.contains_key("comfort.total");
    assert!(units.len() == 11 && known, "{units:?}");
    let seats = long.iter().filter(|row| row["seat"] == "high").count();
    assert_eq!(seats, 3 * 3, "the first, fifth and seventh sat high");
    assert!(long.iter().all(|row| row["years"].ends_with(".5")));
    // Each drive stands as a table of as many rows, and by another word as another kind of table alone.
    let drives = files(&study.path("shared/drives"));
    assert_eq!(drives.len(), 18);
    let samples = |path: &Path| Table::read(path).unwrap().rows();
    assert!(drives.iter().all(|path| samples(path) == 1200));
    // What is given away is a study: it can be analysed anew, with the same numbers but for millimetres.
    std::fs::rename(study.path("shared"), study.path("again")).unwrap();
    study.maveric_in("again", &["run"]).ok();
    let again = study.json("again/results/analysis.json");
    let (first, second) = (&analysis(&study)["descriptives"], &again["descriptives"]);
    let (first, second) = (first.as_array().unwrap(), second.as_array().unwrap());
    assert_eq!(first.len(), second.len());
    for (a, b) in first.iter().zip(second) {
        assert_eq!((&a["outcome"], &a["n"]), (&b["outcome"], &b["n"]));
        let [a_mean, b_mean] = [a, b].map(|row| row["mean"].as_f64().unwrap_or_default());
        assert!((a_mean - b_mean).abs() <= 1e-3 * (1.0 + a_mean.abs()), "{a} {b}");
    }
}

#[test]
fn an_export_says_what_it_holds_and_is_whole_or_not_there() {
    let study = with_somebody_who_withdrew();
    let export = |more: &[&str]| {
        let words = argv("export --key ../key --out ../a/shared");
        study.maveric_in("mine", &[&words[..], more].concat())
    };
    export(&["--drives", "xml"]).failed(2, &["[possible values: csv, parquet]"]);
    // Before there are results there are no outcomes, which is said where there is a folder of them.
    export(&["--drives", "csv"]).ok();
    assert!(!study.path("a/shared/outcomes_long.csv").exists());
    let drives = files(&study.path("a/shared/drives"));
    assert!(drives.len() == 18 && drives.iter().all(|d| d.extension().unwrap() == "csv"));
    let design = study.read("a/shared/study.toml");
    assert!(design.contains("# 1 person left out by name"), "{design}");
    let readme = study.read("a/shared/README.md");
    tells(
        &readme,
        &[
            "6 people, 18 drives and 90 answers",
            "- 1 person left out by exclude.people",
            "| `measures.csv` |",
            "| `drives/` |",
            "read.csv(\"surveys.csv\")",
            "None is given",
        ],
    );
    let factors = study.read("a/shared/factors.csv");
    tells(
        &factors,
        &[
            "condition,within,",
            ",sporty,Sporty,",
            "seat,between,\"Seat, of … unknown\",high,high,,3",
            "years,covariate,years,,,,6",
        ],
    );
    for file in [
        "scales/comfort.toml",
        "codebook.csv",
        "codebook.md",
        "codebook_measures.csv",
        "surveys_wide.csv",
    ] {
        assert!(study.path("a/shared").join(file).is_file(), "{file}");
    }
    // A text that names somebody stops it, and what stood there stays.
    let scale = study.read("mine/scales/comfort.toml");
    study.write(
        "mine/scales/comfort.toml",
        format!("# Person03 did not understand item 2\n{scale}"),
    );
    let before = files(&study.path("a"));
    export(&[]).failed(1, &["comfort.toml", "names `Person03`", "take the name out"]);
    assert_eq!(files(&study.path("a")), before);
    let elsewhere = "export --key ../key --out ../b/c/shared";
    let ran = study.mine(elsewhere);
    ran.failed(1, &["names `Person03`"]);
    assert!(!study.path("b").exists());
    study.write("mine/scales/comfort.toml", scale);
    study.write("a/shared/mine.txt", "somebody's own");
    export(&[]).failed(1, &["`mine.txt`, which no export wrote", "a new folder"]);
    assert!(study.path("a/shared/drives").exists());
}

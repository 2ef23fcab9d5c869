//! What a run writes: every file and column explained, a manuscript's parts, and a page that answers first.

use crate::support::{TempStudy, argv, files, root, tells};
use maveric_study::tables::{
    Table,
    dictionary::{FileEntry, entries, entry_at},
};
use serde_json::Value;
use std::{collections::BTreeSet, path::Path, sync::OnceLock};

/// One run for all tests: making it takes most of their time.
fn run() -> &'static TempStudy {
    static RUN: OnceLock<TempStudy> = OnceLock::new();
    RUN.get_or_init(|| {
        let study = TempStudy::new();
        study.maveric(&["run", "pipelines/smoke.toml"]).ok();
        study
    })
}

const PAGE: &str = "docs/outputs.md";

/// A list of names as people read it.
fn listed(names: &[String], between: &str) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    names.join(between)
}

/// The page of an entry: what it is, who writes it, and its columns.
fn section(entry: &FileEntry) -> String {
    let by = listed(&entry.by, ", ");
    let when = entry.when.as_ref().map(|w| format!(" when {w}"));
    let made_in = entry.made_in.as_ref();
    let made_in = made_in.map(|path| format!("; made in `crates/{path}`"));
    let mut text = format!(
        "## {}\n\n{}\n\nWritten by {by}{}{}.\n",
        listed(&entry.files, ", "),
        entry.about.trim(),
        when.unwrap_or_default(),
        made_in.unwrap_or_default()
    );
    if entry.columns.is_empty() {
        return text;
    }
    let elsewhere = entry.columns.iter().any(|c| c.made_in.is_some());
    text += if elsewhere {
        "\n| column | unit | means | made in `crates/` |\n|---|---|---|---|\n"
    } else {
        "\n| column | unit | means |\n|---|---|---|\n"
    };
    for column in &entry.columns {
        let unit = column.unit.as_deref().unwrap_or_default();
        let when = column.when.as_ref().map(|w| format!("; only when {w}"));
        let when = when.unwrap_or_default();
        text += &["| `", &column.name, "` | ", unit, " | ", &column.means, &when, " |"].concat();
        if elsewhere {
            let path = column.made_in.as_ref().map(|path| format!(" `{path}` |"));
            text += &path.unwrap_or_else(|| " |".to_owned());
        }
        text.push('\n');
    }
    text
}

#[test]
fn the_page_of_outputs_says_what_the_dictionary_says() {
    let path = root().join(PAGE);
    let page = std::fs::read_to_string(&path).unwrap();
    let (head, _) = page.split_once("\n## ").unwrap();
    let sections: Vec<String> = entries().iter().map(section).collect();
    let expected = format!("{head}\n{}", sections.join("\n"));
    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        std::fs::write(&path, expected).unwrap();
    } else {
        let same = page.lines().zip(expected.lines()).find(|(is, should)| is != should);
        assert!(
            page == expected,
            "{PAGE} is not what columns.toml says: UPDATE_GOLDEN=1 writes it; the first line that differs: {same:?}"
        );
    }
}

#[test]
fn every_entry_has_words_and_says_where_its_numbers_are_made() {
    assert!(entries().len() > 20);
    for entry in entries() {
        let what = entry.files.join(", ");
        assert!(!entry.about.trim().is_empty() && !entry.by.is_empty(), "{what}");
        assert_eq!(entry.columns.is_empty(), entry.name.is_none(), "{what}");
        let mut names = BTreeSet::new();
        for column in &entry.columns {
            assert!(!column.means.is_empty(), "{what}: {}", column.name);
            assert!(names.insert(&column.name), "{what}: {} twice", column.name);
        }
        let made_in = entry.columns.iter().filter_map(|c| c.made_in.as_ref());
        for path in made_in.chain(&entry.made_in) {
            assert!(root().join("crates").join(path).exists(), "{what}: {path}");
        }
    }
}

/// What a folder has that the dictionary does not know, and what the dictionary has that it lacks.
fn strange_and_missing(folder: &Path) -> (BTreeSet<String>, BTreeSet<String>) {
    let (mut strange, mut found) = (BTreeSet::new(), BTreeSet::new());
    let mut missing = BTreeSet::new();
    for path in files(folder) {
        let shown = path.strip_prefix(folder).unwrap().to_string_lossy();
        let shown = shown.replace('\\', "/");
        let Some(entry) = entry_at(&shown) else {
            strange.insert(shown);
            continue;
        };
        found.insert(&entry.files);
        if entry.name.is_none() {
            continue;
        }
        let columns = Table::read(&path).unwrap().columns();
        let unknown = columns.iter().filter(|c| entry.column(c).is_none());
        strange.extend(unknown.map(|column| format!("{shown}: {column}")));
        let lacks = entry.always().filter(|c| !columns.iter().any(|has| has == c));
        missing.extend(lacks.map(|column| format!("{shown}: {column}")));
    }
    let always = entries().iter().filter(|e| e.when.is_none());
    let absent = always.filter(|e| !found.contains(&e.files));
    missing.extend(absent.map(|e| e.files.join(", ")));
    (strange, missing)
}

#[test]
fn a_run_writes_every_file_and_column_that_the_dictionary_has_and_no_other() {
    let (strange, missing) = strange_and_missing(&run().path("study_data/generated/smoke"));
    assert!(strange.is_empty(), "not in columns.toml: {strange:#?}");
    assert!(missing.is_empty(), "in columns.toml, not in a run: {missing:#?}");
}

#[test]
fn a_file_and_a_column_that_nobody_explained_and_one_that_is_not_there_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("forgotten.csv", "participant,reason\nP1,asked\n");
    write("mine.csv", "a\n1\n");
    let (strange, missing) = strange_and_missing(folder.path());
    let named = ["forgotten.csv: reason", "mine.csv"].map(str::to_owned);
    assert_eq!(strange, named.into());
    assert!(missing.contains("forgotten.csv: models") && missing.contains("drives.csv"));
}

/// Macros of `numbers.tex`, in order.
fn macros(tex: &str) -> Vec<&str> {
    let lines = tex.lines().filter_map(|line| line.strip_prefix("\\newcommand{\\"));
    lines.filter_map(|rest| rest.split('}').next()).collect()
}

#[test]
fn a_manuscript_has_numbers_by_name_methods_results_and_references() {
    let report = run().path("reports/smoke");
    let manuscript = report.join("manuscript");
    let numbers = std::fs::read_to_string(manuscript.join("numbers.tex")).unwrap();
    let found = macros(&numbers);
    let once: BTreeSet<&str> = found.iter().copied().collect();
    assert_eq!(once.len(), found.len(), "a macro is defined twice");
    assert!(found.len() > 100, "{} macros", found.len());
    assert!(found.iter().all(|name| name.chars().all(|c| c.is_ascii_alphabetic())));
    let csv = std::fs::read_to_string(manuscript.join("numbers.csv")).unwrap();
    assert!(found.iter().all(|name| csv.contains(&format!("\n{name},"))));
    for part in ["results.md", "methods.md", "references.bib"] {
        let text = std::fs::read_to_string(manuscript.join(part)).unwrap();
        assert!(!text.trim().is_empty(), "{part}");
        assert!(!text.contains("&lt;") && !text.contains("&amp;"), "{part}");
    }
    let bib = std::fs::read_to_string(manuscript.join("references.bib")).unwrap();
    tells(&bib, &["author = {Jian, J.-Y. and Bisantz, A. M. and Drury, C. G.}"]);
    // A document of Word is a zip archive.
    assert!(std::fs::read(manuscript.join("manuscript.docx")).unwrap().starts_with(b"PK"));
}

/// Every number of a value.
fn numbers_in(value: &Value, found: &mut Vec<f64>) {
    match value {
        Value::Number(number) => found.extend(number.as_f64()),
        Value::Array(all) => {
            found.push(all.len() as f64);
            for value in all {
                numbers_in(value, found);
            }
        }
        Value::Object(all) => all.values().for_each(|value| numbers_in(value, found)),
        _ => {}
    }
}

const MINUS: char = '\u{2212}';

/// A number as sentences have it: a true minus, and without the zero before the point where 1 bounds it.
fn written(value: f64) -> Vec<String> {
    let mut all = Vec::new();
    for (value, decimals) in [
        (value, 0),
        (value, 1),
        (value, 2),
        (value, 3),
        (100.0 * value, 0),
        (100.0 * value, 1),
        (value, 4),
    ] {
        let text = format!("{value:.decimals$}").replace('-', "\u{2212}");
        all.push(text.replacen(
            "0.",
            ".",
            usize::from(text.trim_start_matches(MINUS).starts_with("0.")),
        ));
        all.push(text.trim_start_matches(MINUS).to_owned());
        all.push(text);
    }
    all
}

/// The numbers of a text, without those that are part of a word.
fn tokens(text: &str) -> Vec<String> {
    let part = |c: char| c.is_ascii_digit() || c == '.' || c == MINUS;
    let words = text.split(|c: char| !(part(c) || c.is_alphabetic() || c == '_'));
    let numbers = words.map(|word| word.trim_end_matches('.'));
    let is_number =
        |word: &&str| word.chars().all(part) && word.contains(|c: char| c.is_ascii_digit());
    numbers.filter(is_number).map(str::to_owned).collect()
}

#[test]
fn every_number_of_a_manuscript_is_one_of_the_analysis() {
    let analysis = run().json("study_data/generated/smoke/analysis.json");
    let mut all = Vec::new();
    numbers_in(&analysis, &mut all);
    // Sentences: as they are written. The levels of intervals stand in no result.
    let known: BTreeSet<String> = all.iter().flat_map(|value| written(*value)).collect();
    let levels = ["90", "95", ".001", "1"];
    let results = run().read("reports/smoke/manuscript/results.md");
    let found = tokens(&results);
    assert!(found.len() > 200, "{} numbers", found.len());
    let unknown: Vec<&String> = found
        .iter()
        .filter(|token| !known.contains(*token) && !levels.contains(&token.as_str()))
        .collect();
    assert!(unknown.is_empty(), "{unknown:?} in {results}");
    assert!(!known.contains("7777.77"));
    // Cells: to the last digit.
    let exactly: BTreeSet<u64> =
        all.iter().flat_map(|v| [v.to_bits(), (100.0 * v).to_bits()]).collect();
    let csv = Table::read(&run().path("reports/smoke/manuscript/numbers.csv")).unwrap();
    let (table, row, column) =
        (csv.text("table").unwrap(), csv.text("row").unwrap(), csv.text("column").unwrap());
    let value = csv.numbers("value").unwrap();
    let mut tables = BTreeSet::new();
    for i in 0..csv.rows() {
        let (Some(table), Some(value)) = (&table[i], value[i]) else {
            continue;
        };
        if matches!(
            table.as_str(),
            "descriptives"
                | "omnibus"
                | "contrasts"
                | "bias"
                | "nearer"
                | "accuracy"
                | "mixed"
                | "embedding-line"
        ) {
            tables.insert(table.clone());
            let place = format!("{table}, {:?}, {:?}: {value}", row[i], column[i]);
            let of_the_paper = column[i].as_deref() == Some("paper");
            assert!(of_the_paper || exactly.contains(&value.to_bits()), "{place}");
        }
        if table == "descriptives" {
            let is = |d: &&Value| {
                let id = format!(
                    "{}.{}",
                    d["outcome"].as_str().unwrap(),
                    d["condition"].as_str().unwrap()
                );
                Some(id.as_str()) == row[i].as_deref()
            };
            let described = analysis["descriptives"].as_array().unwrap().iter().find(is).unwrap();
            assert_eq!(described[column[i].as_deref().unwrap()].as_f64(), Some(value));
        }
    }
    assert!(tables.len() > 5, "{tables:?}");
}

#[test]
fn every_test_stands_in_the_results_and_in_a_table_with_a_number_a_cell() {
    let analysis = run().json("study_data/generated/smoke/analysis.json");
    let results = run().read("reports/smoke/manuscript/results.md");
    let panels = analysis["panels"].as_array().unwrap();
    let omnibus = Table::read(&run().path("reports/smoke/tables/omnibus.csv")).unwrap();
    let heads = [
        "outcome",
        "group",
        "effect",
        "test",
        "n",
        "statistic",
        "df1",
        "df2",
        "epsilon",
        "p",
        "size",
        "effect_size",
        "low",
        "high",
    ];
    assert_eq!(omnibus.columns(), heads);
    assert_eq!(omnibus.rows(), panels.len());
    let contrasts = Table::read(&run().path("reports/smoke/tables/contrasts.csv")).unwrap();
    let (first, second) = (contrasts.text("first").unwrap(), contrasts.text("second").unwrap());
    let (outcome, statistic) =
        (contrasts.text("outcome").unwrap(), contrasts.numbers("statistic").unwrap());
    let mut at = 0;
    for (i, panel) in panels.iter().enumerate() {
        let title = panel["title"].as_str().unwrap();
        assert!(results.contains(title), "{title}");
        let found = &panel["comparison"]["omnibus"];
        assert_eq!(
            omnibus.numbers("statistic").unwrap()[i],
            found["statistic"].as_f64(),
            "{title}"
        );
        assert_eq!(omnibus.numbers("p").unwrap()[i], found["p"].as_f64(), "{title}");
        for pair in panel["contrasts"].as_array().unwrap() {
            let id = [&outcome[at], &first[at], &second[at]].map(|id| id.clone().unwrap());
            let of_pair = [&panel["outcome"], &pair["first"], &pair["second"]]
                .map(|id| id.as_str().unwrap().to_owned());
            assert_eq!(id, of_pair);
            assert_eq!(statistic[at], pair["statistic"].as_f64(), "{id:?}");
            if let Some(difference) = pair["mean_difference"].as_f64() {
                // With two decimals, or three where people differ by less than a tenth.
                let written = written(difference);
                let mut said =
                    [8, 11].map(|at| format!("mean difference {}, ", written[at])).into_iter();
                assert!(said.any(|said| results.contains(&said)), "{difference} of {id:?}");
            }
            at += 1;
        }
    }
    assert_eq!(at, contrasts.rows());
}

#[test]
fn a_drive_as_csv_has_its_rows_and_names_no_lead_where_nobody_is_there() {
    let study = run();
    let drives = study.path("study_data/generated/smoke/drives/study2");
    let drive =
        files(&drives).into_iter().find(|p| p.extension().is_some_and(|e| e == "parquet")).unwrap();
    let out = study.path("drive.csv");
    let [from, to] = [&drive, &out].map(|path| path.to_str().unwrap());
    study.maveric(&["inspect", from, "--csv", to]).ok();
    let table = Table::read(&out).unwrap();
    assert_eq!(table.rows(), Table::read(&drive).unwrap().rows());
    let entry = entry_at("drives/study2/x.parquet").unwrap();
    let columns: Vec<&str> = entry.always().collect();
    assert_eq!(table.columns(), columns);
    let (present, gap) = (table.text("lead_present").unwrap(), table.numbers("lead_dx_m").unwrap());
    assert!(present.iter().zip(&gap).all(|(p, g)| (p.as_deref() == Some("true")) == g.is_some()));
}

#[test]
fn a_style_reaches_a_figure_of_one_test_and_a_page_and_a_wrong_one_is_refused() {
    let study = run();
    let style = study.write(
        "style.toml",
        "[palette]\nink = \"#123456\"\n[size]\none_column_mm = 90\n[labels]\nx = \"Age (years)\"\n[conditions.mimic]\nlabel = \"Own style\"\n",
    );
    study.write("two.csv", "x,y\n1,2\n2,3\n3,5\n4,4\n5,8\n6,7\n");
    let style = style.to_str().unwrap();
    let figure = |name: &str| {
        let correlate = argv("stats correlate two.csv --x x --y y");
        let drawn = ["--figure", name, "--style", style];
        study.maveric(&[&correlate[..], &drawn].concat()).ok();
        std::fs::read(study.path(name)).unwrap()
    };
    let svg = String::from_utf8(figure("a.svg")).unwrap();
    assert!(svg.contains("#123456") && !svg.contains("#222222"));
    assert!(svg.contains(">Age (years)</text>"), "{svg}");
    assert!(figure("a.pdf").starts_with(b"%PDF"));
    let report = argv("report study_data/generated/smoke --out reports/styled --style");
    study.maveric(&[&report[..], &[style]].concat()).ok();
    let page = study.read("reports/styled/index.html");
    assert!(page.contains("#123456") && page.contains("Own style"));
    study.write("bad.toml", "[palette]\nink = \"dark\"\n");
    study
        .maveric(&argv("report study_data/generated/smoke --out reports/x --style bad.toml"))
        .failed(1, &["bad.toml", "palette.ink", "#rrggbb"]);
}

#[test]
fn the_page_answers_first_and_folds_what_is_behind() {
    let page = run().read("reports/smoke/index.html");
    let at = |what: &str| page.find(what).unwrap_or_else(|| panic!("no {what}"));
    for card in [
        "own-style",
        "nearer",
        "dial",
        "noticed",
        "style",
        "across",
        "congruence",
        "preferred",
        "personality",
        "paper",
    ] {
        assert!(at(&format!("id=\"card-{card}\"")) < at("id=\"contents\""), "{card}");
    }
    // Four people: nothing goes with anything.
    assert!(page.contains("too few to say"));
    assert!(!page.contains("jian_trust: overall") && page.contains("<abbr title="));
    assert!(at("id=\"section-1\"") < at("class=\"supplement\""));
}

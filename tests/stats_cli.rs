//! `maveric stats` as a process: bad tables, missing cells, and the reports that people read.

use crate::support::{Ran, TempStudy, argv, tells};
use std::fmt::Write as _;

const WITHIN: &str = "--subject s --within w --value v";

/// `maveric stats` of a table, as this line asks for it.
fn stats(study: &TempStudy, line: &str, table: &str) -> Ran {
    study.write("d.csv", table);
    let words = argv(line);
    study.maveric(&[&["stats", words[0], "d.csv"], &words[1..]].concat())
}

fn within(study: &TempStudy, command: &str, table: &str) -> Ran {
    stats(study, &format!("{command} {WITHIN}"), table)
}

fn json(study: &TempStudy, line: &str, table: &str) -> serde_json::Value {
    let ran = stats(study, &format!("{line} --format json"), table).ok();
    serde_json::from_str(&ran.stdout).unwrap()
}

#[test]
fn a_table_that_is_no_design_is_refused_with_its_own_message() {
    let study = TempStudy::new();
    for (table, words) in [
        ("s,w,v\na,x,1\na,y,2\n", &["1 complete subject", "at least 2"][..]),
        ("s,w,v\na,x,1\nb,x,2\n", &["1 condition", "at least 2"]),
        (
            "s,w,v\na,x,1\na,x,3\na,y,2\nb,x,2\nb,y,4\n",
            &["subject `a`", "condition `x`", "two values"],
        ),
        ("s,w,v\na,x,1\na,y,fast\nb,x,2\nb,y,4\n", &["d.csv", "fast", "`v`"]),
        ("s,w,v\na,x,1\na,y,inf\nb,x,2\nb,y,4\n", &["inf"]),
        ("s,w,v\na,x,1\na,y,-1e400\nb,x,2\nb,y,4\n", &["finite"]),
        ("s,w,v\n", &["d.csv", "no rows"]),
        ("", &["d.csv", "empty"]),
        ("s,w,value\na,x,1\na,y,2\nb,x,2\nb,y,4\n", &["`v`", "value"]),
    ] {
        for command in ["within", "compare"] {
            within(&study, command, table).failed(1, words);
        }
    }
}

#[test]
fn answers_with_yes_or_no_are_read_in_words_and_numbers_and_nothing_else() {
    let study = TempStudy::new();
    let mut rows = "s,w,v\n".to_owned();
    for (who, (x, y)) in [("Yes", "no"), ("1", "0"), ("true", "FALSE"), ("y", "n"), ("no", "no")]
        .into_iter()
        .enumerate()
    {
        let _ = write!(rows, "p{who},x,{x}\np{who},y,{y}\n");
    }
    rows += "p9,x,yes\np9,y,\n";
    let found = json(&study, &format!("mcnemar {WITHIN}"), &rows);
    let test = &found["mcnemar"];
    assert_eq!((&test["only_a"], &test["only_b"]), (&4.into(), &0.into()));
    assert_eq!(found["n"], 5);
    assert_eq!(found["dropped"], serde_json::json!(["p9"]));
    let q = json(&study, &format!("cochran-q {WITHIN}"), &rows);
    assert_eq!(q["cochran_q"]["Q"], 4.0);
    assert_eq!(q["pairs"]["x|y"]["p_holm"], test["p_mid"]);
    let said = within(&study, "mcnemar", &rows).ok().stdout;
    assert!(said.contains("4 against 0"), "{said}");
    within(&study, "mcnemar", &rows.replace("TRUE", "maybe").replace("true", "maybe"))
        .failed(1, &["d.csv: row 5, column `v`", "maybe", "yes or no"]);
    let wide = "who,x,y\na,yes,no\nb,no,no\nc,true,FALSE\nd,1,0\n";
    for call in ["mcnemar", "cochran-q"] {
        let found = json(&study, &format!("{call} --wide x,y"), wide);
        assert_eq!(found["n"], 4, "{call}");
        let bad = wide.replace("c,true,FALSE", "c,true,2");
        let said = ["d.csv: row 3, column `y`", "`2`", "yes or no"];
        stats(&study, &format!("{call} --wide x,y"), &bad).failed(1, &said);
    }
    let three = format!("{rows}p0,z,yes\np1,z,no\np2,z,no\np3,z,no\np4,z,no\n");
    within(&study, "mcnemar", &three).failed(1, &["cochran-q"]);
}

#[test]
fn a_subject_with_a_missing_cell_is_named_and_counted() {
    let study = TempStudy::new();
    let table =
        "s,w,v\nann,x,1\nann,y,2\nben,x,2\nben,y,4.5\ncem,x,3\ncem,y,\ndee,x,1\ndee,y,3\neva,y,3\n";
    let ran = within(&study, "within", table).ok();
    assert!(ran.stderr.contains("cem, eva"), "{}", ran.stderr);
    tells(&ran.stdout, &["2 of 5 subjects (cem, eva)"]);
    let value = json(&study, &format!("within {WITHIN}"), table);
    assert_eq!(value["n"], 3);
    assert_eq!(value["dropped"], serde_json::json!(["cem", "eva"]));
}

#[test]
fn constant_data_have_reasons_and_no_numbers() {
    let study = TempStudy::new();
    let table = "s,w,v\na,x,2\na,y,2\na,z,2\nb,x,2\nb,y,2\nb,z,2\nc,x,2\nc,y,2\nc,z,2\n";
    let value = json(&study, &format!("within {WITHIN}"), table);
    for (part, name) in [("rm_anova", "F"), ("friedman", "chi2"), ("mauchly", "W")] {
        assert!(value[part][name].is_null(), "{part}.{name}");
        let said = |key: &str| value["undefined"][key].is_string();
        assert!(said(part) || said(&format!("{part}.{name}")), "{part}.{name}");
    }
    let ran = within(&study, "compare", table).ok();
    assert!(ran.stdout.contains("No value (–)"), "{}", ran.stdout);
}

#[test]
fn the_report_of_a_comparison_says_what_why_and_how_much() {
    let study = TempStudy::new();
    let mut table = String::from("s,w,v\n");
    for (i, row) in
        [[1.0, 4.0, 2.0], [2.0, 6.0, 3.0], [3.0, 6.5, 3.5], [1.5, 5.0, 4.0], [2.5, 5.0, 2.0]]
            .iter()
            .enumerate()
    {
        for (condition, value) in ["slow", "fast", "other"].iter().zip(row) {
            let _ = writeln!(table, "P{i},{condition},{value}");
        }
    }
    let ran = within(&study, "compare", &table).ok();
    for words in [
        "5 subjects, 3 conditions",
        "Checks",
        "Why this test",
        "ηp² = ",
        "90% CI",
        "slow|fast",
        "95% CI",
        "p adjusted",
    ] {
        assert!(ran.stdout.contains(words), "no `{words}` in\n{}", ran.stdout);
    }
    // Columns line up: every row of the pairs is as wide as the header says or narrower.
    let rows: Vec<&str> =
        ran.stdout.lines().filter(|line| line.contains('|') && line.ends_with(']')).collect();
    assert_eq!(rows.len(), 3);
    assert!(rows.iter().all(|row| row.chars().count() == rows[0].chars().count()), "{rows:?}");
}

#[test]
fn the_correction_of_pairs_is_named_as_it_is() {
    let study = TempStudy::new();
    let table = "s,w,v\na,x,1\na,y,2\na,z,5\nb,x,2\nb,y,4\nb,z,5\nc,x,1\nc,y,3\nc,z,4\nd,x,2\nd,y,3\nd,z,6\n";
    let call = |more: &str| json(&study, &format!("posthoc {WITHIN} {more}"), table);
    let said = call("--test t --adjust bonferroni");
    assert!(said["apa"]["x|y"].as_str().unwrap().contains("p_Bonferroni"), "{}", said["apa"]);
    let said = call("--test nemenyi");
    assert!(said["apa"]["x|z"].as_str().unwrap().starts_with("q(3, ∞) = "), "{}", said["apa"]);
}

/// A score of everybody in every condition.
const SCORE: &str = "--subject id --within condition --value score";
const SCORES: &str = "id,group,condition,score,speed\n\
    P1,a,slow,1,20\nP1,a,fast,4,22.5\nP1,a,other,2,21\n\
    P2,a,slow,2,24\nP2,a,fast,6,27\nP2,a,other,3,25\n\
    P3,b,slow,3,19\nP3,b,fast,6.5,20.5\nP3,b,other,3.5,21\n\
    P4,b,slow,1.5,22\nP4,b,fast,5,23\nP4,b,other,4,21.5\n\
    P5,b,slow,2.5,25\nP5,b,fast,5,28\nP5,b,other,2,26\n";
const WIDE: &str = "id,phase,slow,fast,other\nP1,2,1,4,2\nP2,2,2,6,3\nP3,2,3,6.5,3.5\nP4,2,1.5,5,4\nP5,2,2.5,5,2\nP6,1,9,9,9\n";

#[test]
fn a_wide_table_and_chosen_rows_give_what_the_long_table_gives() {
    let study = TempStudy::new();
    let expected = json(&study, &format!("compare {SCORE}"), SCORES);
    let wide = "compare --wide slow,fast,other --where phase=2";
    let numbered = json(&study, wide, WIDE);
    let named = json(&study, &format!("{wide} --subject id"), WIDE);
    for found in [&numbered, &named] {
        assert_eq!(found["omnibus"], expected["omnibus"]);
        assert_eq!(found["posthoc"]["pairs"], expected["posthoc"]["pairs"]);
    }
    // Under names of one's own, and by calls that can do without conditions.
    let call = "compare --wide slow,fast,other --where phase=2 --within pace --value trust";
    assert_eq!(json(&study, call, WIDE)["omnibus"], expected["omnibus"]);
    for test in ["equivalence --bounds=-1,1", "bayes"] {
        let long = json(&study, &format!("{test} {SCORE}"), SCORES);
        for subject in ["", " --subject id"] {
            let call = format!("{test} --wide slow,fast,other --where phase=2{subject}");
            let found = json(&study, &call, WIDE);
            for part in ["tost", "bayes_t"] {
                assert_eq!(found[part], long[part], "{call}");
            }
        }
        let half = format!("{test} --within condition --value score");
        stats(&study, &half, SCORES).failed(2, &["--subject"]);
    }
    stats(&study, "bayes", SCORES).failed(2, &["--value", "--mu"]);
    let half = "compare --between group --within condition --value score";
    stats(&study, half, SCORES).failed(2, &["--subject with --within"]);
    let call = "compare --wide slow,fast,other --where phase=3";
    stats(&study, call, WIDE).failed(1, &["`phase`", "`3`", "1, 2"]);
    let call = "correlate --x slow --y fast --wide slow,fast";
    stats(&study, call, WIDE).failed(1, &["`correlate`", "--wide"]);
}

#[test]
fn a_bad_cell_is_named_by_its_row_in_the_file_whatever_rows_are_kept() {
    let study = TempStudy::new();
    let table = "id,phase,x,y\na,1,1,2\nb,2,1,2\nc,2,fast,3\n";
    let call = "compare --wide x,y --subject id --where phase=2";
    stats(&study, call, table).failed(1, &["row 3", "`x`", "fast"]);
}

#[test]
fn several_values_are_analysed_one_by_one_under_their_names() {
    let study = TempStudy::new();
    let call = "rm-anova --subject id --within condition --value";
    let found = json(&study, &format!("{call} score,speed"), SCORES);
    for (value, other) in [("score", "speed"), ("speed", "score")] {
        let mut alone = json(&study, &format!("{call} {value}"), SCORES);
        // Warnings are of the whole call.
        alone.as_object_mut().unwrap().remove("warnings");
        assert_eq!(found["value"][value], alone);
        assert_ne!(found["value"][value], found["value"][other]);
    }
}

#[test]
fn a_refusal_says_what_shape_was_found_and_what_might_be_meant() {
    let study = TempStudy::new();
    let words = [
        "no column `condition`",
        "6 rows",
        "`slow` (numbers, 6 different)",
        "--wide",
        "--subject id",
    ];
    stats(&study, &format!("compare {SCORE}"), WIDE).failed(1, &words);
    let call = "compare --subject group --within condition --value score";
    let words = ["subject `a`", "two values", "15 rows", "`id` (text, 5 different)"];
    stats(&study, call, SCORES).failed(1, &words);
    // A long table that was read as one, and a call that takes no conditions, are not told of wide columns.
    for (call, table) in [
        (format!("compare {SCORE} --where id=P1"), SCORES),
        ("alpha --items q1".to_owned(), "q1,q2\n1,2\n2,3\n4,4\n"),
        ("power".to_owned(), "test,n,effect\npaired_t,24,0.5\n"),
    ] {
        let ran = stats(&study, &call, table);
        assert_eq!(ran.status, Some(1), "{call}: {}", ran.stderr);
        assert!(!ran.stderr.contains("--wide"), "{call}: {}", ran.stderr);
    }
}

#[test]
fn a_refusal_names_the_table_and_the_cell() {
    let study = TempStudy::new();
    let answers = "s,w,v\na,x,1\na,y,2\nb,x,1.34\nb,y,2\n";
    let words = ["d.csv: row 3, column `v`", "1.34", "whole number"];
    within(&study, "ordinal", answers).failed(1, &words);
    let printed = "coefficient,df,p\n.46,22,=.024\n.46,22,none\n";
    let words = ["d.csv: row 2, column `p`", "`none`"];
    stats(&study, "recheck", printed).failed(1, &words);
    let question = "test,n,effect,alpha,k,corr,epsilon\n\
                    paired_t,24,0.5,0.05,,,\nrm_anova,24,0.1,0.05,4,0.5,0.2\n";
    let words = ["d.csv: row 2, column `epsilon`", "`0.2`", "from 0.333 to 1"];
    stats(&study, "power", question).failed(1, &words);
    let one = "s,w,v\na,x,1\na,y,2\n";
    within(&study, "within", one).failed(1, &["d.csv: 1 complete subject after"]);
    let call = "compare --subject id --between group --value score";
    let words = ["d.csv", "`P1` occurs twice", "changes within subjects"];
    stats(&study, call, SCORES).failed(1, &words);
    let call = "compare --subject id --within condition,again,speed --value score";
    let again = |line: &str| format!("{line},{}\n", line.split(',').nth(2).unwrap());
    let three: String = SCORES.lines().map(again).collect();
    let three = three.replacen("condition\n", "again\n", 1);
    stats(&study, call, &three).failed(1, &["factors within subjects", "at most 2, got 3"]);
}

#[test]
fn small_units_and_values_far_from_zero_keep_the_digits_that_tell_them_apart() {
    let study = TempStudy::new();
    let (mut small, mut far) = ("s,w,v\n".to_owned(), "s,w,v\n".to_owned());
    for (i, d) in [4, 7, 6, 5, 8, 3].into_iter().enumerate() {
        let _ = writeln!(small, "P{i},a,0.00{i}1\nP{i},b,0.00{i}{d}");
        let _ = writeln!(far, "P{i},a,12034.{i}1\nP{i},b,12034.{i}{d}");
    }
    let call = format!("equivalence {WITHIN} --bounds=-0.002,0.002 --apa");
    let said = stats(&study, &call, &small).ok().stdout;
    assert!(said.contains("90% CI [−0.000"), "{said}");
    let call = "bootstrap --statistic mean --value v --apa";
    let said = stats(&study, call, &small).ok().stdout;
    assert!(said.contains("estimate 0.00") && !said.contains("0.00,"), "{said}");
    let text = within(&study, "compare", &far).ok().stdout;
    let mean = |name: &str| {
        let row = text.lines().find(|line| line.trim().starts_with(name));
        row.unwrap().split_whitespace().nth(1).unwrap().to_owned()
    };
    assert_ne!(mean("a "), mean("b "), "{text}");
    assert!(mean("a ").starts_with("12034."), "{text}");
}

#[test]
fn a_label_of_a_paper_is_that_of_one_table() {
    let study = TempStudy::new();
    for call in [
        "compare --subject id --within condition --between group --value score,speed --latex",
        "normality --value score --group condition --latex",
    ] {
        let latex = stats(&study, call, SCORES).ok().stdout;
        let labels = latex.lines().filter(|line| line.starts_with("\\label{"));
        let mut labels: Vec<&str> = labels.collect();
        let all = labels.len();
        labels.sort_unstable();
        labels.dedup();
        assert!(all > 2 && labels.len() == all, "{call}: {latex}");
    }
}

#[test]
fn the_sentence_alone_and_the_tables_of_a_paper() {
    let study = TempStudy::new();
    let with = |flag: &str| {
        let ran = stats(&study, &format!("rm-anova {SCORE} {flag}"), SCORES);
        ran.ok().stdout
    };
    let said = with("--apa");
    assert!(said.starts_with("F(1.42, 5.67) = ") && said.lines().count() == 1, "{said}");
    let latex = with("--latex");
    assert!(
        latex.contains("\\begin{tabularx}{\\linewidth}{>{\\raggedright\\arraybackslash}Xrrrrr}")
            && latex.contains("\\textit{F}(1.42, 5.67) = "),
        "{latex}"
    );
    let markdown = with("--markdown");
    assert!(
        markdown.contains("| conditions | ") && markdown.contains("*F*(1.42, 5.67) = "),
        "{markdown}"
    );
    let none = stats(&study, "adjust --p score --apa", "score\n0.1\n0.2\n");
    none.failed(1, &["`adjust` has no sentence"]);
}

#[test]
fn a_figure_is_drawn_where_there_is_something_to_draw_and_refused_by_name_elsewhere() {
    let study = TempStudy::new();
    for call in [
        format!("within {SCORE}"),
        format!("compare {SCORE}"),
        format!("posthoc {SCORE}"),
        "correlate --x score --y speed".to_owned(),
        "rmcorr --subject id --x score --y speed".to_owned(),
    ] {
        stats(&study, &format!("{call} --figure out/f.svg"), SCORES).ok();
        let drawn = study.read("out/f.svg");
        assert!(drawn.starts_with("<svg") || drawn.starts_with("<?xml"), "{call}");
        assert!(drawn.contains("font-face"), "{call}: no font inside");
    }
    let drawn = |name: &str| stats(&study, &format!("compare {SCORE} --figure {name}"), SCORES);
    drawn("f.png").ok();
    assert_eq!(&std::fs::read(study.path("f.png")).unwrap()[1..4], b"PNG");
    drawn("f.pdf").ok();
    let pdf = std::fs::read(study.path("f.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF"));
    let refused = "normality --value score --figure n.svg";
    stats(&study, refused, SCORES).failed(1, &["`normality` has nothing to draw"]);
    assert!(!study.path("n.svg").exists());
    drawn("f.gif").failed(1, &["f.gif", ".svg, .png or .pdf"]);
}

/// The lines of a help text that call the program.
fn examples(help: &str) -> Vec<Vec<String>> {
    let mut calls: Vec<String> = Vec::new();
    let mut within = false;
    for line in help.lines() {
        match line.split_once("maveric stats ") {
            Some((before, call)) if before.trim().is_empty() || before.contains("Example") => {
                calls.push(call.to_owned());
                within = true;
            }
            // A long call goes on in the next line.
            None if within && !line.is_empty() => {
                let call = calls.last_mut().unwrap();
                call.push(' ');
                call.push_str(line.trim());
            }
            _ => within = false,
        }
    }
    calls.iter().map(|call| words(call)).collect()
}

/// A command line without its quotes.
fn words(call: &str) -> Vec<String> {
    let quoted = call.split('"').enumerate();
    let parts = quoted.flat_map(|(i, part)| match i % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect(),
        _ => vec![part.to_owned()],
    });
    parts.collect()
}

/// One table with every column that an example names, eight people with a row a cell.
fn every_column(cells: usize) -> String {
    let mut table = String::from(
        "id,group,vehicle,condition,style,load,age,score,speed,answer,q1,q2,q3,p,noticed\n",
    );
    for i in 0..8 {
        for j in 0..cells {
            let (x, y) = (f64::from(i), j as f64);
            let wobble = (x * 7.0 + y * 3.0) % 5.0;
            let (group, vehicle) = [("a", "car"), ("b", "truck")][usize::from(i > 3)];
            let (condition, style) = [("slow", "calm"), ("fast", "sporty")][j % 2];
            let (load, age) = (["low", "high"][j / 2], 30 + 10 * (i % 2));
            let score = 3.0 + y + 0.5 * wobble + 0.1 * x;
            let _ = writeln!(
                table,
                "P{i},{group},{vehicle},{condition},{style},{load},{age},{score},{},{},{},{},{},{},{}",
                20.0 + 2.0 * y + 0.7 * ((x * 5.0 + y) % 3.0) + 0.3 * x,
                1 + (i + 2 * i32::from(j == 1)) % 4,
                1.0 + wobble,
                2.0 + (wobble + y) % 4.0,
                1.0 + (wobble + x) % 5.0,
                0.01 + 0.05 * wobble,
                ["no", "yes"][usize::from(wobble > 2.0)],
            );
        }
    }
    table
}

#[test]
fn every_call_says_which_columns_it_needs_and_its_examples_run() {
    let study = TempStudy::new();
    study.write("questions.csv", "test,n,effect,alpha,k,corr,epsilon\npaired_t,24,0.5,0.05,,,\nrm_anova,24,0.1,0.05,4,0.5,1\n");
    study.write("printed.csv", "coefficient,df,p\n.46,22,=.024\n-.71,22,<.001\n");
    let whole = study.maveric(&["stats", "--help"]).ok().stdout;
    let listed = whole.lines().skip_while(|line| !line.starts_with("Commands:")).skip(1);
    let names: Vec<String> = listed
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.strip_prefix("  ").filter(|rest| !rest.starts_with(' ')))
        .filter_map(|line| line.split_whitespace().next().map(str::to_owned))
        .filter(|name| !["help", "paper", "study"].contains(&name.as_str()))
        .collect();
    assert!(names.len() >= 14, "{names:?}");
    for name in &names {
        let help = study.maveric(&["stats", name, "--help"]).ok().stdout;
        assert!(
            help.contains("The table: "),
            "{name} does not say which columns it needs:\n{help}"
        );
        let cells = if name == "factorial" { 4 } else { 2 };
        study.write("data.csv", every_column(cells));
        let examples = examples(&help);
        assert!(!examples.is_empty(), "{name} has no example:\n{help}");
        for example in examples {
            assert_eq!(&example[0], name);
            let call: Vec<&str> =
                ["stats"].into_iter().chain(example.iter().map(String::as_str)).collect();
            study.maveric(&call).ok();
        }
    }
}

//! `maveric stats` of designs beyond one factor: what is chosen, how it is said and drawn, and what is refused by name.

use crate::support::{Ran, TempStudy, argv, tells};
use serde_json::Value;
use std::fmt::Write as _;

/// Sixteen people in two vehicles, in two styles under two loads; with an age, a speed and an answer.
fn table() -> String {
    let mut text = String::from("id,vehicle,style,load,age,score,speed,answer\n");
    let mut power = 5_i32;
    for i in 0..16 {
        for (j, (style, load)) in
            [("calm", "low"), ("calm", "high"), ("sporty", "low"), ("sporty", "high")]
                .into_iter()
                .enumerate()
        {
            // 5 is a primitive root of 97: no order, no ties.
            power = power * 5 % 97;
            let score = f64::from(i % 5) + j as f64 + f64::from(power) / 24.0;
            let vehicle = ["car", "truck"][i as usize % 2];
            let _ = writeln!(
                text,
                "P{i},{vehicle},{style},{load},{},{score:.3},{:.3},{}",
                20 + 3 * i % 29,
                20.0 + score + f64::from(power % 7),
                1 + (i + 2 * i32::from(j > 1) + power % 2) % 5,
            );
        }
    }
    text
}

fn call(study: &TempStudy, words: &str, more: &[&str]) -> Ran {
    let words = argv(words);
    let whole = [&["stats", words[0], "d.csv"], &words[1..], more].concat();
    study.maveric(&whole)
}

fn json(study: &TempStudy, words: &str) -> Value {
    let ran = call(study, words, &["--format", "json"]).ok();
    serde_json::from_str(&ran.stdout).unwrap()
}

fn with(table: &str) -> TempStudy {
    let study = TempStudy::new();
    study.write("d.csv", table);
    study
}

/// Rows under the low load alone.
const LOW: &str = "--where load=low";

#[test]
fn a_comparison_chooses_by_the_design_and_finds_what_the_call_of_its_own_finds() {
    let study = with(&table());
    for (design, chosen, own, parts) in [
        (
            "--subject id --within style,load --value score".to_owned(),
            &["factorial", "ranks"][..],
            "factorial --subject id --within style,load --value score".to_owned(),
            &["anova", "emm", "contrast", "simple", "sphericity"][..],
        ),
        (
            format!("--subject id --within style --between vehicle --value score {LOW}"),
            &["factorial", "ranks"],
            format!("factorial --subject id --within style --between vehicle --value score {LOW}"),
            &["anova", "emm", "contrast", "simple"],
        ),
        (
            format!("--between vehicle --value score {LOW} --where style=calm"),
            &["welch-t", "mann-whitney"],
            format!("groups --group vehicle --value score {LOW} --where style=calm"),
            &["welch_t", "mann_whitney", "hedges", "desc"],
        ),
        (
            format!("--subject id --within style --covariate age --value score {LOW}"),
            &["factorial", "ranks"],
            format!("factorial --subject id --within style --value score {LOW}"),
            &["anova", "emm", "contrast"],
        ),
        (
            format!("--subject id --within style --ordinal --value answer {LOW}"),
            &["ordinal"],
            format!("ordinal --subject id --within style --value answer {LOW}"),
            &["threshold", "coef", "lr", "laplace", "variance"],
        ),
        (
            format!("--subject id --within style --value score {LOW}"),
            &["paired-t", "wilcoxon"],
            format!("within --subject id --within style --value score {LOW}"),
            &["desc"],
        ),
    ] {
        let found = json(&study, &format!("compare {design}"));
        let name = found["chosen"].as_str().unwrap();
        assert!(chosen.contains(&name), "{design}: {name}");
        assert!(!found["reasons"].as_array().unwrap().is_empty(), "{design}");
        assert!(!found["apa"].as_object().unwrap().is_empty(), "{design}");
        let alone = json(&study, &own);
        for part in parts {
            assert!(!found[part].is_null(), "{design}: no {part}");
            assert_eq!(found[part], alone[part], "{design}: {part}");
        }
    }
}

#[test]
fn a_declared_product_with_a_covariate_is_tested_and_one_with_nothing_is_refused() {
    let study = with(&table());
    let compare = "compare --subject id --within style,load --value score --covariate age";
    let plain = json(&study, compare);
    assert!(plain["tests"]["age:style"].is_null() && plain["tests"]["style"].is_object());
    let declared = json(&study, &format!("{compare} --with age:style,age:style:load"));
    for effect in ["age:style", "age:style:load"] {
        assert!(declared["tests"][effect]["p"].is_number(), "{effect}");
    }
    let unknown = format!("{compare} --with age:colour");
    call(&study, &unknown, &[]).failed(1, &["age:colour", "style, load, style:load"]);
    let other = format!("{compare} --with score:style");
    call(&study, &other, &[]).failed(1, &["score:style"]);
    call(&study, &format!("{compare} --with style"), &[]).failed(2, &["age:style"]);
    let alone = compare.replace(" --covariate age", "");
    call(&study, &format!("{alone} --with age:style"), &[]).failed(2, &["--covariate"]);
}

#[test]
fn ordered_answers_print_the_f_that_decides() {
    let study = with(&table());
    let compare = "compare --subject id --within style --ordinal --value answer --where load=low";
    let found = json(&study, compare);
    let test = &found["small_sample"];
    let out = call(&study, compare, &[]).ok();
    let f = format!("F({}, {}) = {:.2}", test["df1"], test["df2"], test["F"].as_f64().unwrap());
    assert!(out.stdout.contains(&f), "{f}: {}", out.stdout);
    assert!(!out.stdout.contains("χ²("), "{}", out.stdout);
}

#[test]
fn a_person_without_a_cell_leaves_by_name_or_stays_in_a_mixed_model() {
    let mut rows: Vec<String> = table().lines().map(str::to_owned).collect();
    rows.remove(2);
    let study = with(&(rows.join("\n") + "\n"));
    let compare = "compare --subject id --within style,load --between vehicle --value score";
    let out = call(&study, compare, &[]).ok();
    assert!(out.stderr.contains("P0") && out.stdout.contains("15 subjects"), "{}", out.stdout);
    let kept = json(&study, &format!("{compare} --missing mixed"));
    assert_eq!(kept["chosen"], "mixed");
    assert_eq!((&kept["n_obs"], &kept["n_subjects"]), (&63.into(), &16.into()));
    let why = kept["reasons"][0].as_str().unwrap();
    assert!(why.contains("1 of the subjects") && why.contains("are kept"), "{why}");
}

/// Each call with a sentence, the beginning of that sentence, and whether there is something to draw.
const CALLS: [(&str, &str, bool); 11] = [
    ("factorial --subject id --within style,load --value score", "style: F(1, 15) = ", true),
    (
        "factorial --subject id --within style,load --value score --method art",
        "style: F(1, 45) = ",
        true,
    ),
    (
        "groups --group vehicle --value score --where style=calm --where load=low",
        "welch_t: t(",
        true,
    ),
    ("groups --group style --value score --where load=low", "welch_t: t(", true),
    (
        "equivalence --subject id --within style --value score --bounds=-1,1 --where load=low",
        "t(15) = ",
        true,
    ),
    (
        "equivalence --subject id --within style --value score --bounds=-1,1 --standardized --where load=low",
        "t(15) = ",
        true,
    ),
    ("bayes --subject id --within style --value score --where load=low", "BF", true),
    ("bayes --value score --mu=3", "BF", false),
    ("bayes --x score --y speed", "BF", true),
    ("mixed --subject id --fixed style*load+age --value score", "style: F(1, ", true),
    ("ordinal --subject id --within style --value answer", "lr: χ²(1) = ", true),
];

#[test]
fn equivalence_counts_values_of_one_sample_and_subjects_of_pairs() {
    let study = with(&table());
    let said = |words: &str| call(&study, words, &["--bounds=-1,1"]).ok().stdout;
    let one = said("equivalence --value score --mu=3");
    assert!(one.contains(" values") && !one.contains("subjects"), "{one}");
    let pairs = said("equivalence --subject id --within style --value score --where load=low");
    assert!(pairs.contains("tests: 16 subjects"), "{pairs}");
}

#[test]
fn each_analysis_has_its_sentence_its_tables_and_its_figure() {
    let study = with(&table());
    for (words, sentence, drawn) in CALLS {
        let said = call(&study, words, &["--apa"]).ok().stdout;
        assert!(said.starts_with(sentence), "{words}: {said}");
        let latex = call(&study, words, &["--latex"]).ok().stdout;
        assert!(latex.contains("\\begin{tabularx}"), "{words}: {latex}");
        let markdown = call(&study, words, &["--markdown"]).ok().stdout;
        assert!(markdown.contains("| --"), "{words}: {markdown}");
        let text = call(&study, words, &[]).ok().stdout;
        assert!(!text.contains("NaN") && !text.contains("p_anderson"), "{words}: {text}");
        let figure = call(&study, words, &["--figure", "f.svg"]);
        if drawn {
            figure.ok();
            assert!(study.read("f.svg").contains("<svg"));
            std::fs::remove_file(study.path("f.svg")).unwrap();
        } else {
            figure.failed(1, &["`bayes` has nothing to draw"]);
        }
    }
}

#[test]
fn one_word_means_one_thing_in_every_call() {
    let study = with(&table());
    for (words, other) in [
        (
            "groups --group vehicle --value score --where style=calm --where load=low",
            ["--group", "--between"],
        ),
        ("levene --group vehicle --value score", ["--group", "--between"]),
        ("normality --group style --value score", ["--group", "--within"]),
        ("normality --group vehicle --value score", ["--group", "--between"]),
        (
            "bayes --group vehicle --value score --where style=calm --where load=low",
            ["--group", "--between"],
        ),
        (
            "mixed --subject id --fixed vehicle*style+age --value score",
            ["--fixed vehicle*style+age", "--between vehicle --within style --covariate age"],
        ),
        (
            "mixed --subject id --fixed style*load --value score",
            ["--fixed style*load", "--within style,load"],
        ),
    ] {
        let renamed = words.replace(other[0], other[1]);
        assert_ne!(renamed, words);
        assert_eq!(json(&study, words), json(&study, &renamed), "{renamed}");
    }
    // A factor is one by its flag, be its levels numbers; in a formula numbers are a covariate.
    let by_flag = json(&study, "mixed --subject id --within style --between age --value score");
    let by_formula = json(&study, "mixed --subject id --fixed style*age --value score");
    assert!(by_flag["anova"]["age"]["df1"].as_u64().unwrap() > 1);
    assert_eq!(by_formula["anova"]["age"]["df1"], 1);
    call(&study, "mixed --subject id --fixed style --within style --value score", &[])
        .failed(2, &["--fixed", "--within"]);
    call(&study, "mixed --subject id --value score", &[]).failed(2, &["--fixed", "--between"]);
    call(&study, "levene --value score", &[]).failed(2, &["--group"]);
}

#[test]
fn bayes_factors_say_of_which_pair_they_are_and_what_was_held_likely_before() {
    let study = with(&table());
    let pairs = "bayes --subject id --within style --value score --where load=low";
    let found = json(&study, pairs);
    let pair = found["bayes_t"].as_object().unwrap().keys().next().unwrap();
    assert_eq!(found["prior"]["family"], "Cauchy");
    assert_eq!(found["prior"]["scale"], std::f64::consts::FRAC_1_SQRT_2);
    let text = call(&study, pairs, &[]).ok().stdout;
    tells(&text, &[&format!("{pair}: BF"), "Cauchy prior of the"]);
    let groups = "bayes --between vehicle --value score --where style=calm --where load=low";
    let text = call(&study, groups, &[]).ok().stdout;
    assert!(text.contains("8 + 8"), "{text}");
    let correlation = json(&study, "bayes --x score --y speed");
    let sentence = correlation["apa"]["bayes_r"].as_str().unwrap();
    assert!(sentence.contains("κ = .33); BF") && sentence.contains("κ = 1.00)"), "{sentence}");
    assert_eq!(correlation["prior_kappa1"]["scale"], 1.0);
}

#[test]
fn two_factors_are_drawn_as_lines_of_their_means_and_three_as_cells() {
    let study = with(&table());
    for (words, lines) in [
        ("factorial --subject id --within style,load --value score", true),
        (
            "compare --subject id --within style --between vehicle --value score --where load=low",
            true,
        ),
        ("mixed --subject id --within style,load --value score", true),
        ("factorial --subject id --within style,load --between vehicle --value score", false),
        ("factorial --subject id --within style --value score --where load=low", false),
    ] {
        call(&study, words, &["--figure", "f.svg"]).ok();
        let svg = study.read("f.svg");
        assert_eq!(svg.contains(">Means by factor<"), lines, "{words}");
        let emm = json(&study, words)["emm"].as_object().unwrap().clone();
        for (cell, mean) in
            emm.get("style:load").and_then(Value::as_object).into_iter().flatten().filter(|_| lines)
        {
            let mean = format!(" {:.2}", mean["mean"].as_f64().unwrap());
            assert!(svg.contains(&mean), "{words}: {cell}{mean}");
        }
        std::fs::remove_file(study.path("f.svg")).unwrap();
    }
}

#[test]
fn a_wide_table_is_a_design_of_one_factor_for_every_call_that_has_one() {
    let study = TempStudy::new();
    study.write("d.csv", "a,b,c\n1,2,4\n2,2,3\n3,5,5\n1,4,3\n2,3,5\n4,3,5\n");
    let compared = json(&study, "compare --wide a,b,c");
    let tested = json(&study, "factorial --wide a,b,c");
    assert_eq!((&compared["n"], &tested["n"]), (&6.into(), &6.into()));
    assert!(tested["anova"]["condition"]["F"].is_number());
}

#[test]
fn what_no_test_can_take_is_refused_by_the_name_of_what_is_wrong() {
    let whole = table();
    let each = |old: &str, new: &str| whole.replace(old, new);
    let factorial =
        "factorial --subject id --within style --between vehicle --value score --where load=low";
    let mixed = "mixed --subject id --fixed style+age+twice --value score";
    let head = whole.lines().next().unwrap();
    let twice: String = std::iter::once(format!("{head},twice\n"))
        .chain(whole.lines().skip(1).map(|row| {
            let age: i32 = row.split(',').nth(4).unwrap().parse().unwrap();
            format!("{row},{}\n", 2 * age + 1)
        }))
        .collect();
    let two_groups = whole.replacen("P0,car", "P0,truck", 1);
    for (table, words, named) in [
        (each("truck", "car"), factorial, &["factor `vehicle`", "one level, `car`"][..]),
        (
            // Nobody in a truck has a calm drive, so that group has no complete subject.
            each("truck,calm,low", "truck,calm,none"),
            factorial,
            &["cell `truck`", "no subject with all values", "leave out its level"],
        ),
        (two_groups, factorial, &["subject `P0`", "`truck`", "`car`", "within factor"]),
        (twice, mixed, &["`twice`", "determined by the other predictors"]),
        (
            each("low", "none"),
            "compare --subject id --within style,load --value score --covariate style",
            &["style"],
        ),
    ] {
        let study = with(&table);
        call(&study, words, &[]).failed(1, named);
    }
}

#[test]
fn a_model_that_does_not_converge_has_a_reason_in_the_place_of_its_numbers() {
    // Within each person the conditions separate the answers, and people do not differ: no finite coefficient.
    let mut text = String::from("id,w,v\n");
    for i in 0..8 {
        let _ = writeln!(text, "P{i},a,1\nP{i},b,2\nP{i},c,3");
    }
    let study = with(&text);
    let words = "ordinal --subject id --within w --value v";
    let ran = call(&study, words, &["--format", "json"]);
    if ran.status == Some(0) {
        let found: Value = serde_json::from_str(&ran.stdout).unwrap();
        assert!(found["coef"]["b"]["estimate"].is_null());
        let why = found["undefined"].as_object().unwrap();
        assert!(why.keys().any(|name| name.starts_with("coef.b")), "{why:?}");
    } else {
        ran.failed(1, &["cannot be fitted", "separate the answers"]);
    }
    // Two answers that follow another order in each person, without an end: a slope that grows without bound.
    let mut text = String::from("id,w,v\n");
    for i in 0..6 {
        let _ = writeln!(text, "P{i},a,{}\nP{i},b,{}\nP{i},c,2", 1 + i % 2, 2 + i % 2);
    }
    let found = json(&with(&text), words);
    let reasons = found["undefined"].as_object().unwrap();
    for (name, coefficient) in found["coef"].as_object().unwrap() {
        if coefficient["estimate"].is_null() {
            assert!(reasons.contains_key(&format!("coef.{name}")), "{reasons:?}");
        }
    }
}

/// Nine people in a car who are old, and nine in a truck who are not, in two styles: the score follows age alone.
fn aged() -> String {
    let mut text = String::from("id,vehicle,style,age,score\n");
    let mut power = 5_i32;
    for i in 0..18 {
        let (vehicle, age) = if i < 9 { ("car", 60 + i % 7) } else { ("truck", 35 + i % 7) };
        for style in ["calm", "sporty"] {
            power = power * 5 % 97;
            let score = 0.2 * f64::from(age) + f64::from(power) / 200.0;
            let _ = writeln!(text, "P{i},{vehicle},{style},{age},{score:.4}");
        }
    }
    text
}

#[test]
fn pairs_and_means_take_out_what_the_test_takes_out() {
    let study = with(&aged());
    let words =
        "compare --subject id --within style --between vehicle --covariate age --value score";
    let found = json(&study, words);
    let effect = found["tests"]["vehicle"]["p"].as_f64().unwrap();
    let pair = &found["follow_up"]["contrast"]["vehicle"]["car|truck"];
    assert!((pair["p"].as_f64().unwrap() - effect).abs() < 1e-9);
    let raw = &found["contrast"]["vehicle"]["car|truck"];
    let [raw, adjusted] = [raw, pair].map(|pair| pair["estimate"].as_f64().unwrap());
    assert!(raw > 4.0 && adjusted.abs() < 2.0, "{raw} {adjusted}");
    let means = &found["follow_up"]["emm"]["vehicle"];
    let mean = |name: &str| means[name]["mean"].as_f64().unwrap();
    assert!((mean("car") - mean("truck") - adjusted).abs() < 1e-9);
    for show in ["", "--latex", "--markdown"] {
        let more: Vec<&str> = show.split_whitespace().collect();
        let text = call(&study, words, &more).ok().stdout;
        assert!(text.contains("Means of vehicle, at the mean of age"), "{text}");
        let pairs = text.split("Pairs of vehicle").nth(1).unwrap();
        let row = pairs.lines().find(|line| line.contains("truck")).unwrap();
        assert!(!row.contains(".001"), "{row}");
    }
    call(&study, words, &["--figure", "f.svg"]).ok();
    let drawn = study.read("f.svg");
    let cell = &found["follow_up"]["emm"]["vehicle:style"]["car:calm"]["mean"];
    let cell = format!(" {:.2}", cell.as_f64().unwrap());
    assert!(drawn.contains(&cell), "{cell}");
    assert!(drawn.contains("at the mean of age"));
    // Of one factor they are dots over values that are not.
    let adjusted = "score; dots are means, at the mean of age";
    let one = "compare --subject id --between vehicle --value score --where style=calm";
    for (covariate, says) in [("", false), (" --covariate age", true)] {
        call(&study, &format!("{one}{covariate}"), &["--figure", "f.svg"]).ok();
        assert_eq!(study.read("f.svg").contains(adjusted), says, "{covariate}");
    }
}

/// Twelve people in four conditions, the first without the last; answers of five.
fn four() -> String {
    let mut text = String::from("id,c,v,ans\n");
    let mut power = 5_i32;
    for i in 0..12 {
        for (j, c) in (0_i32..).zip(["a", "b", "d", "e"]) {
            power = power * 5 % 97;
            let v = f64::from(i % 5) + f64::from(power * (1 + j)) / 60.0;
            if (i, j) != (0, 3) {
                let _ = writeln!(text, "P{i},{c},{v:.3},{}", 1 + power % 5);
            }
        }
    }
    text
}

#[test]
fn a_figure_has_the_test_that_decides_above_it() {
    let study = with(&four());
    for (words, effect) in [
        ("compare --subject id --within c --value v --missing mixed", "c"),
        ("compare --subject id --within c --value ans --ordinal", "conditions"),
    ] {
        call(&study, words, &["--figure", "f.svg"]).ok();
        let said = json(&study, words)["apa"][effect].clone();
        let said = said.as_str().unwrap();
        let test = said.split(", p").next().unwrap();
        assert!(test.starts_with("F("), "{said}");
        let drawn = study.read("f.svg");
        assert!(drawn.contains(test), "{words}: no {test}");
        assert!(!drawn.contains("χ²") && !drawn.contains("Wilcoxon"), "{words}");
        std::fs::remove_file(study.path("f.svg")).unwrap();
    }
    // The Bayes factor of one pair is above the picture of that pair alone.
    let bayes = "bayes --subject id --within c --value v";
    call(&study, bayes, &["--figure", "f.svg"]).ok();
    let drawn = study.read("f.svg");
    assert!(!drawn.contains("prior") && !drawn.contains("means ."));
    let two: Vec<String> = four().lines().map(str::to_owned).collect();
    let two = two.iter().filter(|row| !row.contains(",d,") && !row.contains(",e,"));
    let two: Vec<&str> = two.map(String::as_str).collect();
    let study = with(&(two.join("\n") + "\n"));
    call(&study, bayes, &["--figure", "f.svg"]).ok();
    assert!(study.read("f.svg").contains("prior"));
}

#[test]
fn pairs_of_a_mixed_model_are_printed_over_their_own_error() {
    let study = with(&four());
    let words = "compare --subject id --within c --value v --missing mixed";
    let found = json(&study, words);
    let [own, of_the_model] = ["own_error", "contrast"]
        .map(|errors| format!("{:.2}", found[errors]["c"]["a|e"]["df"].as_f64().unwrap()));
    assert_ne!(own, of_the_model);
    let text = call(&study, words, &[]).ok().stdout;
    let row = text.lines().find(|line| line.trim().starts_with("a|e"));
    let row = row.unwrap();
    assert!(row.contains(&own) && !row.contains(&of_the_model), "{row}");
}

#[test]
fn the_interval_of_kendalls_w_is_printed_where_it_holds_w() {
    let alike = [[1, 2, 3]; 20];
    let all = [[1, 2, 3], [1, 3, 2], [2, 1, 3], [2, 3, 1], [3, 1, 2], [3, 2, 1]];
    // Rank sums of 40, 39 and 41.
    let mut unlike = [all, all, all].concat();
    unlike.extend([[1, 2, 3], [3, 1, 2]]);
    let mut nearly = alike.to_vec();
    nearly[0] = [1, 3, 2];
    nearly[1] = [2, 1, 3];
    for (orders, printed) in [(unlike, false), (nearly, true)] {
        let mut text = String::from("id,c,v\n");
        for (i, ranks) in orders.iter().enumerate() {
            for (c, rank) in ["a", "b", "d"].iter().zip(ranks) {
                let _ = writeln!(text, "P{i},{c},{}", [1, 10, 1000][rank - 1]);
            }
        }
        let study = with(&text);
        for analysis in ["friedman", "within", "compare"] {
            let words = format!("{analysis} --subject id --within c --value v");
            let out = call(&study, &words, &[]).ok().stdout;
            let lines = out.lines().filter(|line| line.contains("90% CI"));
            let of_w = lines.filter(|line| line.contains('W'));
            let held = of_w.filter(|line| line.contains("CI [.") || line.contains("W [."));
            assert_eq!(held.count() > 0, printed, "{words}: {out}");
        }
    }
}

#[test]
fn groups_are_said_by_the_test_that_was_chosen_alone() {
    // Values far from all others in each group: ranks are compared.
    let mut text = String::from("g,v\n");
    for (g, name) in ["x", "y", "z"].into_iter().enumerate() {
        for i in 0..8 {
            let far = if i == 7 { 400.0 } else { 0.0 };
            let _ = writeln!(text, "{name},{}", far + f64::from(i * 3 % 8) + 0.3 * g as f64);
        }
    }
    let study = with(&text);
    let words = "compare --between g --value v";
    assert_eq!(json(&study, words)["chosen"], "kruskal-wallis");
    let out = call(&study, words, &[]).ok().stdout;
    tells(
        &out,
        &["kruskal: χ²(2", "x|y: z = ", "p_Holm", "No difference of the groups is shown at .05."],
    );
    assert!(!out.contains("welch_anova: ") && !out.contains("x|y: t("), "{out}");
    // What was chosen has no value where a group has one row.
    let one: Vec<&str> = "g,v\nx,1\nx,2\nx,4\nx,3\ny,2\ny,5\ny,3\ny,4\nz,3".lines().collect();
    let study = with(&(one.join("\n") + "\n"));
    if json(&study, words)["chosen"] == "welch-anova" {
        let out = call(&study, words, &[]).ok().stdout;
        tells(&out, &["The test that was chosen has no value"]);
        assert!(!out.contains("kruskal: "), "{out}");
    }
}

#[test]
fn a_difference_of_nothing_is_drawn_within_standardised_bounds() {
    let mut text = String::from("id,c,v\n");
    for (i, d) in [1.0, -1.0, 0.5, -0.5, 0.25, -0.25].into_iter().enumerate() {
        let _ = writeln!(text, "P{i},a,{}\nP{i},b,{i}", i as f64 + d);
    }
    let study = with(&text);
    let words = "equivalence --subject id --within c --value v --bounds=-2,2 --standardized";
    assert_eq!(json(&study, words)["tost"]["a|b"]["estimate"], 0.0);
    call(&study, words, &["--figure", "f.svg"]).ok();
    assert!(study.read("f.svg").contains("a|b 0.00 ["));
    // Of one sample values are counted.
    let one = "equivalence --value v --mu=3 --bounds=-9,9";
    let out = call(&study, one, &[]).ok().stdout;
    assert!(out.contains("12 values") && !out.contains("subjects"), "{out}");
}

#[test]
fn ordered_answers_of_several_factors_say_that_their_numbers_count() {
    let study = with(&table());
    let of = |more: &str| {
        let words = format!("compare --subject id --within style,load --value answer {more}");
        json(&study, &words)["reasons"].to_string()
    };
    assert!(of("--ordinal").contains("the answers' numbers"));
    assert!(!of("").contains("the answers' numbers"));
}

/// Eight people in a car and eight in a truck who have the same ids, in two styles.
fn reused_ids() -> String {
    let mut rows = table().lines().map(str::to_owned).collect::<Vec<_>>();
    for row in &mut rows[1..] {
        let (id, rest) = row.split_once(',').unwrap();
        let number: usize = id[1..].parse().unwrap();
        *row = format!("P{},{rest}", number / 2);
    }
    rows.join("\n") + "\n"
}

#[test]
fn ids_of_two_groups_are_refused_everywhere() {
    let study = with(&reused_ids());
    for test in ["factorial", "compare", "mixed"] {
        let words =
            format!("{test} --subject id --within style --between vehicle --value score {LOW}");
        let named = ["subject `P0`", "`car`", "`truck`", "`vehicle`", "share a name"];
        call(&study, &words, &[]).failed(1, &named);
    }
}

#[test]
fn roles_of_a_mixed_model_are_stated() {
    let study = with(&table());
    let fixed = json(&study, "mixed --subject id --fixed vehicle*style+age --value score");
    let roles = serde_json::json!({"within": ["style"], "between": ["vehicle", "age"]});
    assert_eq!(fixed["roles"], roles);
    let study = with(&reused_ids());
    let fixed = "mixed --subject id --fixed vehicle*style --value score";
    assert_eq!(json(&study, fixed)["roles"]["within"], serde_json::json!(["vehicle", "style"]));
    let said = call(&study, fixed, &[]).ok();
    tells(&said.stdout, &["change within subjects: vehicle, style"]);
    let covariate = "mixed --subject id --within style --covariate age --value score";
    let said = call(&study, covariate, &[]).ok();
    tells(&said.stderr, &["`age` changes within subjects", "P0", "share an id"]);
}

#[test]
fn one_reused_id_in_a_formula_warns() {
    let study = with(&table().replace("P1,", "P0,"));
    let said = call(&study, "mixed --subject id --fixed vehicle*style --value score", &[]).ok();
    tells(&said.stderr, &["`vehicle` has several values for `P0`", "one for 14 others"]);
}

#[test]
fn a_factor_within_that_nobody_changes_is_refused() {
    let study = with(&table());
    for test in ["factorial", "compare", "mixed", "within", "rm-anova", "friedman", "ordinal"] {
        let value = if test == "ordinal" { "answer" } else { "score" };
        let words = format!(
            "{test} --subject id --within vehicle --value {value} --where style=calm {LOW}"
        );
        let named = ["no subject has two levels of `vehicle`", "--between"];
        call(&study, &words, &[]).failed(1, &named);
    }
}

#[test]
fn a_column_in_two_roles_is_refused() {
    let study = with(&table());
    for (words, column) in [
        ("mixed --subject id --within style --covariate score --value score", "score"),
        ("mixed --subject id --fixed id --value score", "id"),
        ("compare --subject id --within style --between id --value score", "id"),
        ("compare --subject id --within style --covariate score --value score", "score"),
        ("factorial --subject id --within style --between style --value score", "style"),
        ("within --subject id --within id --value score", "id"),
        ("rmcorr --subject id --x age --y age", "age"),
        ("correlate --x age --y age", "age"),
        ("groups --between score --value score", "score"),
    ] {
        call(&study, words, &[]).failed(1, &[&format!("`{column}` has two roles")]);
    }
}

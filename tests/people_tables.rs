//! Tables that people write: codes for no answer, numbers, ids and labels.

use crate::support::{Ran, TempStudy, argv, tells};

const SCALE: &str = "id = \"calm\"\ntitle = \"Calmness\"\nreference = \"made up\"\nitems = 2\nmin = -2\nmax = 2\nscoring = \"mean\"\n\
    [[subscales]]\nid = \"calm\"\ntitle = \"Calmness\"\nitems = [1, 2]\n";
const DESIGN: &str =
    "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n";

/// A study of two conditions and one scale from -2 to 2, with an export.
fn study(people: &str, export: &str) -> TempStudy {
    let study = TempStudy::new();
    study.write("mine/study.toml", DESIGN);
    study.write("mine/scales/calm.toml", SCALE);
    study.write("mine/participants.csv", people);
    study.write("mine/export.csv", export);
    study
}

fn import(study: &TempStudy, more: &str) -> Ran {
    let line = format!("import export.csv --scales scales --out answers.csv {more}");
    study.maveric_in("mine", &argv(&line))
}

const PEOPLE: &str = "participant\nP01\nP02\n";

#[test]
fn a_missing_code_within_the_range_is_refused() {
    let export = "CASE,SERIAL,QUESTNNR,calm_1,calm_2\n1,P01,base,-1,2\n2,P02,base,-2,-9\n";
    let sosci = study(PEOPLE, export);
    import(&sosci, "").failed(1, &["P01", "`calm`", "`-1`", "from -2 to 2", "missing = "]);
    // The map states which words of this scale are no answers.
    sosci.write("mine/map.toml", "[scales.calm]\nmissing = [\"-9\"]\n");
    import(&sosci, "--columns map.toml").ok();
    let answers = sosci.read("mine/answers.csv");
    tells(&answers, &["P01,pre,calm,1,-1", "P02,pre,calm,1,-2", "P02,pre,calm,2,\n"]);
    let table = study(PEOPLE, "participant,calm_1,calm_2\nP01,1,2\nP02,-1,0\n");
    table.write("mine/map.toml", "missing = [\"-1\"]\n");
    import(&table, "--columns map.toml").failed(1, &["`-1`", "from -2 to 2"]);
}

#[test]
fn codes_outside_the_range_are_still_missing() {
    let export = "CASE,SERIAL,QUESTNNR,calm_1,calm_2\n1,P01,base,-9,2\n2,P02,base,0,-8\n";
    let study = study(PEOPLE, export);
    import(&study, "").ok();
    tells(&study.read("mine/answers.csv"), &["P01,pre,calm,1,\n", "P02,pre,calm,2,\n"]);
}

/// Qualtrics' three heads, and a row for each status.
fn qualtrics(rows: &[(&str, &str)]) -> String {
    let mut text = String::from(
        "Status,ExternalReference,calm_1,calm_2\nResponse Type,External Data Reference,a,b\n\
         \"{\"\"ImportId\"\":\"\"status\"\"}\",\"{\"\"ImportId\"\":\"\"externalDataReference\"\"}\",\"{\"\"ImportId\"\":\"\"QID1_1\"\"}\",\"{\"\"ImportId\"\":\"\"QID1_2\"\"}\"\n",
    );
    for (status, who) in rows {
        text += &[status, ",", who, ",1,2\n"].concat();
    }
    text
}

#[test]
fn an_unknown_status_is_reported_with_its_rows() {
    let rows = [("IP Address", "P01"), ("Umfragevorschau", "P02"), ("", "P03"), ("77", "P04")];
    let german = study("participant\nP01\nP02\nP03\nP04\n", &qualtrics(&rows));
    let said = import(&german, "").ok().stderr;
    tells(&said, &["`Status`", "`Umfragevorschau` (row 2)", "empty (row 3)", "`77` (row 4)"]);
    let known = study(PEOPLE, &qualtrics(&[("0", "P01"), ("Imported", "P02")]));
    assert!(!import(&known, "").ok().stderr.contains("Status"));
}

#[test]
fn a_point_beside_decimal_commas_is_refused() {
    let table = "id;style;score\nP1;a;1.142\nP1;b;998,5\nP2;a;3\nP2;b;4,5\nP3;a;1\nP3;b;2\n";
    let study = study(PEOPLE, "participant,calm_1,calm_2\nP01,1,2\n");
    study.write("mine/d.csv", table);
    for test in ["compare", "mixed", "within", "groups"] {
        let columns = match test {
            "groups" => "--between style --value score",
            _ => "--subject id --within style --value score",
        };
        let ran = study.maveric_in("mine", &argv(&format!("stats {test} d.csv {columns}")));
        ran.failed(1, &["row 1, column `score`", "`1.142`", "decimal comma"]);
    }
    let formula = "stats mixed d.csv --subject id --fixed score --value score2";
    let again = |line: &str| format!("{line};{}\n", line.rsplit(';').next().unwrap());
    let twice: String = table.lines().map(again).collect();
    study.write(
        "mine/d.csv",
        twice.replacen("score;score", "score;score2", 1).replace("1.142", "1,142"),
    );
    study.maveric_in("mine", &argv(formula)).failed(1, &["cannot be fitted"]);
}

#[test]
fn covariates_of_people_may_have_decimal_commas() {
    let study =
        study("participant;hours\nP01;3,5\nP02;1.142\n", "participant,calm_1,calm_2\nP01,1,2\n");
    study.write("mine/study.toml", format!("{DESIGN}[[covariate]]\ncolumn = \"hours\"\n"));
    let ran = study.maveric_in("mine", &argv("status"));
    ran.failed(1, &["participants.csv: row 2, column `hours`", "`1.142`", "decimal comma"]);
    study.write("mine/participants.csv", "participant;hours\nP01;3,5\nP02;4,25\n");
    let said = study.maveric_in("mine", &argv("status")).ok();
    assert!(!said.stderr.contains("3,5"), "{}", said.stderr);
}

#[test]
fn an_unknown_id_is_reported_with_rows_and_neighbour() {
    let export = "participant,calm_1,calm_2\nVP05,1,2\nvp06 ,2,1\nX,0,0\n";
    let study = study("participant\nVP05\nVP06\n", export);
    let said = import(&study, "").ok().stderr;
    tells(&said, &["`vp06`", "row 2", "did you mean `VP06`?", "`X`", "row 3"]);
    assert_eq!(said.matches("`vp06`").count(), 1, "{said}");
}

#[test]
fn orders_keep_a_table_of_one_line() {
    let study = study("P01;P02\n", "participant,calm_1,calm_2\nP01,1,2\n");
    let ran = study.maveric_in("mine", &argv("design orders --people 4"));
    ran.failed(1, &["participants.csv", "no column `participant`"]);
    assert_eq!(study.read("mine/participants.csv"), "P01;P02\n");
    study.write("mine/participants.csv", "participant,order\n");
    study.maveric_in("mine", &argv("design orders --people 4")).ok();
}

#[test]
fn an_id_that_looks_like_an_option_is_refused() {
    let study = study("participant\n-x\n", "participant,calm_1,calm_2\nP01,1,2\n");
    import(&study, "").failed(1, &["`-x`", "begin"]);
}

#[test]
fn keys_are_compared_trimmed_and_composed() {
    let study = study(PEOPLE, "participant,calm_1,calm_2\nP01,1,2\n");
    let mut table = String::from("id,group,score\n");
    for i in 0..12 {
        let group = [["f", "f "], ["Mu\u{308}nchen", "M\u{fc}nchen"]][i % 2][i / 6];
        table += format!("P{i},{group},{}\n", i * i % 7).as_str();
    }
    study.write("mine/d.csv", &table);
    let compare = "stats compare d.csv --between group --value score";
    let said = study.maveric_in("mine", &argv(compare)).ok().stdout;
    tells(&said, &["2 groups"]);
    study.write("mine/d.csv", table.replace("f ,", "F,"));
    for test in ["compare", "groups", "levene", "factorial", "normality"] {
        let ran = study.maveric_in("mine", &argv(&compare.replace("compare", test)));
        ran.failed(1, &["`f` and `F`", "column `group`"]);
    }
}

#[test]
fn people_whose_ids_differ_in_case_are_refused() {
    let study = study("participant\nP01\np01\n", "participant,calm_1,calm_2\nP01,1,2\n");
    import(&study, "").failed(1, &["participants.csv: row 2", "`p01`", "`P01`"]);
}

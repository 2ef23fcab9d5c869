use super::*;
use crate::tables::{read_rows, surveys::read_scores};

const SCALE: &str = "id = \"calm\"\ntitle = \"Calmness\"\nreference = \"made up\"\nitems = 6\nmin = 1\nmax = 5\nscoring = \"mean\"\nreversed = [2, 4]\n[[subscales]]\nid = \"calm\"\ntitle = \"Calmness\"\nitems = [1, 2, 3, 4, 5, 6]\n";

fn run(rows: &str, moments: Moments) -> Result<(Outcome<ScoredSurveys>, String), String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("scales")).unwrap();
    std::fs::write(folder.path().join("scales/calm.toml"), SCALE).unwrap();
    let surveys = folder.path().join("surveys.csv");
    let header = "participant,moment,scale,item,answer,seconds\n";
    std::fs::write(&surveys, format!("{header}{rows}")).unwrap();
    let options = ScoreAnswers {
        design: None,
        surveys: vec![surveys],
        participants: None,
        scales: Some(folder.path().join("scales")),
        drives: Vec::new(),
        moments,
        out: folder.path().join("scores.csv"),
    };
    let done = options.run(Watch::unwatched()).map_err(|e| e.to_string())?;
    let listed = std::fs::read_to_string(exclusions_path(&options.out)).unwrap();
    Ok((done, listed))
}

fn sheet(who: &str, moment: &str, answers: [i32; 6], seconds: &str) -> String {
    let row = |(item, answer)| format!("{who},{moment},calm,{item},{answer},{seconds}\n");
    (1..).zip(answers).map(row).collect()
}

#[test]
fn floor_ceiling_items_and_careless_sheets_are_said() {
    let rows = [
        sheet("A", "pre", [5, 1, 5, 1, 5, 5], "4.5"),
        sheet("B", "pre", [1, 5, 1, 5, 1, 1], "3.0"),
        sheet("C", "pre", [3, 3, 4, 2, 3, 4], "0.5"),
        sheet("D", "pre", [4, 4, 4, 4, 4, 4], ""),
        sheet("A", "mimic", [2, 4, 2, 4, 3, 2], "5"),
    ]
    .concat();
    let (done, listed) = run(&rows, Moments::All).unwrap();
    let found = &done.value.reliabilities[0];
    assert_eq!((found.n, found.floor, found.ceiling), (4, 1, 1));
    assert!((found.mean.unwrap() - (5.0 + 1.0 + 3.5 + 10.0 / 3.0) / 4.0).abs() < 1e-12);
    assert!(found.omega.unwrap() > 0.8 && found.alpha.unwrap() > 0.9);
    assert_eq!(found.item.len(), 6);
    let second = &found.item[1];
    assert!(second.reversed && second.r_rest.unwrap() > 0.5 && second.floor == 1);
    assert!(second.alpha_dropped.unwrap() > 0.8);
    assert!(listed.contains("C,nothing,") && listed.contains("0.5 s an item"), "{listed}");
    assert!(listed.contains("D,nothing,") && listed.contains("all 6 items of `calm` with 4"));
    assert_eq!(listed.lines().count(), 3);
    let (after, listed) = run(&rows, Moments::After).unwrap();
    assert_eq!((after.value.scores, listed.lines().count()), (1, 1));
}

#[test]
fn sheets_are_counted_where_one_item_has_no_reliability() {
    let who = |id: &str| (ParticipantId::new(id).unwrap(), Moment::Pre);
    let matrix = ItemMatrix {
        scale: "again".to_owned(),
        subscale: "again".to_owned(),
        items: vec![1],
        respondents: ["A", "B", "C"].map(who).to_vec(),
        answers: vec![vec![Some(3.0)], vec![Some(2.0)], vec![None]],
    };
    let found = reliability(&matrix, &[], &[]);
    assert_eq!((found.n, found.dropped, found.alpha), (2, 1, None));
}

#[test]
fn what_is_said_of_an_item_is_of_the_whole_sheets_that_are_counted_beside_it() {
    let whole = [
        sheet("A", "pre", [1, 4, 2, 5, 3, 2], "5"),
        sheet("B", "pre", [5, 1, 4, 2, 5, 4], "5"),
        sheet("C", "pre", [3, 3, 4, 2, 3, 4], "5"),
        sheet("D", "pre", [1, 4, 1, 5, 2, 2], "5"),
    ]
    .concat();
    let first_item = |rows: &str| {
        let (done, _) = run(rows, Moments::All).unwrap();
        let found = &done.value.reliabilities[0];
        (found.n, found.dropped, found.item[0].floor)
    };
    assert_eq!(first_item(&whole), (4, 0, 2));
    let cut = whole.replace("D,pre,calm,3,1,", "D,pre,calm,3,,");
    assert_eq!(first_item(&cut), (3, 1, 1));
}

/// What comes of answers by a study of two conditions: the scores, or what is said.
fn in_a_study(
    rows: &str,
    moments: Moments,
) -> Result<(Outcome<ScoredSurveys>, Vec<Score>), String> {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let write = |name: &str, text: &str| std::fs::write(at(name), text).unwrap();
    std::fs::create_dir(at("scales")).unwrap();
    write("scales/calm.toml", SCALE);
    let conditions = "[[condition]]\nid = \"same\"\n[[condition]]\nid = \"fast\"\n";
    write("study.toml", &format!("[study]\ntitle = \"t\"\n{conditions}"));
    write("people.csv", "participant\nA\nB\n");
    let header = "participant,moment,scale,item,answer,seconds\n";
    write("surveys.csv", &format!("{header}{rows}"));
    let options = ScoreAnswers {
        design: Some(at("study.toml")),
        surveys: vec![at("surveys.csv")],
        participants: Some(at("people.csv")),
        scales: Some(at("scales")),
        drives: Vec::new(),
        moments,
        out: at("scores.csv"),
    };
    let done = options.run(Watch::unwatched());
    let done = done.map_err(|e| [e.to_string(), e.suggestion().unwrap_or_default()].join("\n"))?;
    // Whatever reads them finds tables, be they empty.
    let reliabilities: Vec<Reliability> = read_rows(&reliabilities_path(&options.out)).unwrap();
    let items: Vec<ItemMean> = read_rows(&item_means_path(&options.out)).unwrap();
    let scores = read_scores(&options.out).unwrap();
    assert_eq!(reliabilities.is_empty() && items.is_empty(), scores.is_empty());
    Ok((done, scores))
}

#[test]
fn where_no_ride_was_rated_the_tables_of_what_was_said_after_drives_are_empty() {
    let before = sheet("A", "pre", [1, 4, 2, 5, 3, 2], "5");
    let (done, scores) = in_a_study(&before, Moments::After).unwrap();
    assert!(scores.is_empty());
    let said = "no answers after a drive".to_owned();
    assert!(done.summary.contains(&said), "{:?}", done.summary);
    let (done, scores) = in_a_study(&before, Moments::All).unwrap();
    assert_eq!(scores.len(), 1);
    assert!(!done.summary.contains(&said), "{:?}", done.summary);
    let rated = before + &sheet("B", "fast", [1, 4, 2, 5, 3, 2], "5");
    let (done, scores) = in_a_study(&rated, Moments::After).unwrap();
    assert_eq!(scores.len(), 1);
    assert!(!done.summary.contains(&said), "{:?}", done.summary);
    let error = in_a_study("", Moments::After).unwrap_err();
    assert_eq!(error.trim(), "the surveys hold no answers");
}

#[test]
fn answers_none_of_which_is_let_in_are_counted_and_it_is_said_why() {
    let unknown = sheet("A", "Pre", [1, 4, 2, 5, 3, 2], "5");
    let error = in_a_study(&unknown, Moments::All).unwrap_err();
    assert!(
        error.starts_with(
            "the surveys hold no answers that are let in: 6 answers left out by unknown condition"
        ) && error.contains("`Pre` is none of the design's: same, fast"),
        "{error}"
    );
    let (done, scores) = in_a_study(&unknown, Moments::After).unwrap();
    assert!(scores.is_empty() && done.warnings.iter().any(|w| w.contains("`Pre`")));
}

#[test]
fn a_condition_rated_twice_and_a_time_below_zero_are_refused() {
    let twice = sheet("A", "mimic", [3; 6], "") + &sheet("A", "mimic", [2; 6], "");
    let error = run(&twice, Moments::All).unwrap_err();
    assert!(
        error.contains("participant A (mimic), scale `calm`: item 1 is answered twice"),
        "{error}"
    );
    let error = run(&sheet("A", "pre", [3; 6], "-1"), Moments::All).unwrap_err();
    assert!(error.contains("row 1, column `seconds`"), "{error}");
    let error =
        run(&sheet("A", "pre", [3; 6], "").replace(",3,", ",three,"), Moments::All).unwrap_err();
    assert!(error.contains("found `three`"), "{error}");
}

#[test]
fn nobody_is_missed_after_a_ride_that_others_have_and_they_have_not() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let write = |name: &str, text: &str| {
        std::fs::create_dir_all(at(name).parent().unwrap()).unwrap();
        std::fs::write(at(name), text).unwrap();
    };
    write("scales/calm.toml", SCALE);
    let design = "[study]\ntitle = \"t\"\n[people]\nlearn = { part = \"learn\" }\ntest = { part = \"test\" }\n\
         [style]\nscore = \"adb.total\"\npoints = 15\n[baseline]\nid = \"own\"\n\
         [[condition]]\nid = \"same\"\ncar = { dial = \"0\" }\n[[condition]]\nid = \"fast\"\ncar = { dial = \"+1\" }\n";
    write("study.toml", design);
    write("people.csv", "participant,part\nL,learn\nA,test\nB,test\nC,test\n");
    let row = |who: &str, ride: &str| format!("{who}-{ride},{who},{ride},automated,1,1,9,0.4\n");
    let rides = [row("A", "same"), row("A", "fast"), row("B", "same")].concat();
    let header = "drive,participant,condition,driven_by,session,trial,rows,duration_s\n";
    write("drives/drives.csv", &format!("{header}{rides}"));
    let answers = [("A", "same"), ("A", "fast"), ("B", "same")]
        .map(|(who, ride)| sheet(who, ride, [1, 5, 2, 4, 3, 2], "5"));
    let header = "participant,moment,scale,item,answer,seconds\n";
    write("surveys.csv", &format!("{header}{}", answers.concat()));
    let listed = |drives: Vec<PathBuf>, moments| {
        let options = ScoreAnswers {
            design: Some(at("study.toml")),
            surveys: vec![at("surveys.csv")],
            participants: Some(at("people.csv")),
            scales: Some(at("scales")),
            drives,
            moments,
            out: at("scores.csv"),
        };
        options.run(Watch::unwatched()).unwrap();
        std::fs::read_to_string(exclusions_path(&options.out)).unwrap()
    };
    let known = listed(vec![at("drives")], Moments::After);
    assert_eq!(known.lines().count(), 1, "{known}");
    let unknown = listed(Vec::new(), Moments::After);
    for said in [
        "participant B (fast) did not answer scale `calm`",
        "participant C answered no questionnaire after a drive",
    ] {
        assert!(unknown.contains(said), "{unknown}");
    }
    assert_eq!(unknown.lines().count(), 3, "{unknown}");
    let exclude =
        "[exclude]\npeople = { C = \"withdrew\" }\ndrives = { B-fast = \"the rig failed\" }\n";
    write("study.toml", &format!("{design}{exclude}"));
    let all = listed(Vec::new(), Moments::All);
    assert!(all.contains("participant L answered no questionnaire"), "{all}");
    assert_eq!(all.lines().count(), 2, "{all}");
}

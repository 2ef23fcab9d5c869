//! From an export to scores: what was asked before the drives, after one, during one and at the end.

use super::*;
use crate::{
    stages::score::{Moments, ScoreAnswers},
    tables::surveys::read_scores,
};

/// The moments of the scores of P01's answers: of all of them, and of those given after a drive.
fn scored(surveys: &Path, design: &Path) -> [Vec<String>; 2] {
    let folder = design.parent().unwrap();
    std::fs::write(folder.join("people.csv"), "participant\nP01\n").unwrap();
    [Moments::All, Moments::After].map(|moments| {
        let score = ScoreAnswers {
            design: Some(design.to_owned()),
            surveys: vec![surveys.to_owned()],
            participants: Some(folder.join("people.csv")),
            scales: Some(folder.join("scales")),
            drives: Vec::new(),
            moments,
            out: folder.join("scores.csv"),
        };
        score.run(Watch::unwatched()).unwrap();
        let scores = read_scores(&score.out).unwrap();
        scores.iter().map(|s| s.moment.to_string()).collect()
    })
}

/// The same of an export, with the head of the table that was imported.
fn imported(export: &str, map: Option<&str>, design: &str) -> (String, [Vec<String>; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let import = in_folder(folder.path(), None, export.as_bytes(), map, design);
    import.run(Watch::unwatched()).unwrap();
    let (table, design) = (import.out.unwrap(), import.design.unwrap());
    let text = std::fs::read_to_string(&table).unwrap();
    let head = text.lines().next().unwrap().to_owned();
    (head, scored(&table, &design))
}

/// The names of the columns of all three times, as `name` has them of a time and an item.
fn columns(name: impl Fn(&str, u32) -> String) -> String {
    let times = ["pre", "sporty", "post"].iter();
    let names: Vec<String> =
        times.flat_map(|time| [1, 2, 3].map(|item| name(time, item))).collect();
    names.join(",")
}

#[test]
fn what_is_asked_at_the_end_is_scored_as_that_whatever_software_wrote_it() {
    let named = columns(|time, item| format!("{time}_calm_{item}"));
    let import_ids = columns(|time, item| format!("\"{{\"\"ImportId\"\":\"\"{time}{item}\"\"}}\""));
    let codes = columns(|time, item| format!("{time}calm[SQ00{item}]"));
    let answers = "1,2,3,4,5,6,7,6,5";
    let qualtrics = format!(
        "ResponseId,{named}\nResponse ID,{named}\n\"{{\"\"ImportId\"\":\"\"_recordId\"\"}}\",{import_ids}\nP01,{answers}\n"
    );
    let limesurvey =
        format!("id,submitdate,lastpage,token,{codes}\n1,2026-01-01,3,P01,{answers}\n");
    let sosci = "CASE,SERIAL,QUESTNNR,CA01_01,CA01_02,CA01_03\n1,P01,base,1,2,3\n2,P01,sporty,4,5,6\n3,P01,end,7,6,5\n";
    let otree = "participant.label,a.1.player.calm_1,a.1.player.calm_2,a.1.player.calm_3,b.1.player.condition,b.1.player.calm_1,b.1.player.calm_2,b.1.player.calm_3,c.1.player.condition,c.1.player.calm_1,c.1.player.calm_2,c.1.player.calm_3\n\
                 P01,1,2,3,sporty,4,5,6,post,7,6,5\n";
    let trial = |moment: &str| {
        format!(
            r#"{{"trial_type": "survey-likert", "subject": "P01", "scale": "calm", "moment": "{moment}", "rt": 6000, "response": {{"Q0": 1, "Q1": 2, "Q2": 3}}}}"#
        )
    };
    let jspsych = format!("[{}]", ["pre", "sporty", "post"].map(trial).join(","));
    let wide = format!("participant,{named}\nP01,{answers}\n");
    for (export, map) in [
        (qualtrics.as_str(), Some(BY_NAME)),
        (&limesurvey, Some("[scales.calm]\ncolumn = \"{moment}calm[SQ{item}]\"\n")),
        (
            sosci,
            Some(
                "[moments]\nbase = \"pre\"\nend = \"post\"\n[scales.calm]\ncolumn = \"CA01_{item}\"\n",
            ),
        ),
        (otree, None),
        (&jspsych, None),
        (&wide, Some(BY_NAME)),
    ] {
        let (head, [all, after]) = imported(export, map, DESIGN);
        assert!(head.contains(",condition"), "{head}");
        assert_eq!(all, ["pre", "sporty", "post"], "{export}");
        assert_eq!(after, ["sporty"], "{export}");
    }
}

#[test]
fn a_scale_whose_moment_is_the_end_is_scored_at_the_end_and_a_condition_of_that_name_is_none() {
    let at_end = "[scales.calm]\nmoment = \"post\"\n";
    let wide = "participant,calm_1,calm_2,calm_3\nP01,1,2,3\n";
    let (_, [all, after]) = imported(wide, Some(at_end), DESIGN);
    assert_eq!((all, after), (vec!["post".to_owned()], Vec::new()));
    // Without an end there is one column for all.
    let rides = "participant,condition,calm_1,calm_2,calm_3\nP01,sporty,1,2,3\n";
    let (head, _) = imported(rides, None, DESIGN);
    assert_eq!(head, "participant,moment,scale,item,answer");
    let design = DESIGN.replace("\"calm\"", "\"post\"");
    let (head, [all, after]) = imported(&rides.replace("sporty", "post"), None, &design);
    assert_eq!(head, "participant,moment,scale,item,answer");
    assert_eq!(all, ["after:post"]);
    assert_eq!(all, after);
}

#[test]
fn probes_are_scored_from_the_table_and_refused_of_an_export_which_has_no_time_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let import = in_folder(folder.path(), None, b"", None, DESIGN);
    let one_item = SCALE
        .replace("calm", "misc")
        .replace("items = 3", "items = 1")
        .replace("reversed = [2]\n", "")
        .replace("[1, 2, 3]", "[1]");
    std::fs::write(folder.path().join("scales/misc.toml"), one_item).unwrap();
    let sheet =
        |moment: &str| [1, 2, 3].map(|item| format!("P01,{moment},calm,{item},4,\n")).concat();
    let table = folder.path().join("answers.csv");
    let text = format!(
        "participant,moment,condition,scale,item,answer,at_s\n{}{}P01,probe,sporty,misc,1,3,60\n{}",
        sheet("pre,"),
        sheet("after,sporty"),
        sheet("post,")
    );
    std::fs::write(&table, text).unwrap();
    let [all, after] = scored(&table, &import.design.unwrap());
    assert_eq!(all, ["pre", "sporty", "post", "probe:sporty"]);
    assert_eq!(after, ["sporty", "probe:sporty"]);
    let error =
        mapped(b"participant,condition,calm_1,calm_2,calm_3\nP01,probe:sporty,1,2,3\n", None)
            .unwrap_err();
    assert!(
        error.contains("row 1, `calm_1` (participant P01): `probe:sporty` is a probe")
            && error.contains("at_s"),
        "{error}"
    );
}

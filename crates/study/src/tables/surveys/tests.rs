use super::*;

fn read(text: &str) -> Result<Answered, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("answers.csv");
    std::fs::write(&path, text).unwrap();
    read_answered(&path).map_err(|e| e.to_string())
}

fn moments_of(text: &str) -> Vec<Moment> {
    read(text).unwrap().answers.iter().map(|a| a.moment).collect()
}

fn after(id: &str) -> Moment {
    Moment::After(id.parse().unwrap())
}

#[test]
fn a_table_of_one_column_is_read_as_before_also_where_a_condition_is_called_post() {
    let text = "participant,moment,scale,item,answer\nA,pre,m,1,1\nA,post,m,1,2\nA,calm,m,1,3\nA,after:pre,m,1,4\n";
    assert_eq!(moments_of(text), [Moment::Pre, after("post"), after("calm"), after("pre")]);
}

#[test]
fn beside_its_condition_a_moment_is_a_word_and_a_condition_may_have_any_id() {
    let text = "participant,moment,condition,scale,item,answer,at_s\nA,pre,,m,1,1,\nA,after,post,m,1,2,\nA,after,pre,m,1,2,\n\
                A,post,,m,1,3,\nA,probe,calm,misc,1,,60\nA,calm,,m,1,4,\n";
    assert_eq!(
        moments_of(text),
        [Moment::Pre, after("post"), after("pre"), Moment::Post, after("calm")]
    );
    let probes = read(text).unwrap().probes;
    let [probe] = &probes[..] else {
        panic!("{probes:?}");
    };
    assert_eq!((probe.ride.to_string().as_str(), probe.answer), ("calm", None));
    assert!((probe.at_s - 60.0).abs() < 1e-12);
}

#[test]
fn what_is_no_moment_and_a_probe_without_its_time_name_their_cell() {
    let two = |row: &str| {
        read(&format!("participant,moment,condition,scale,item,answer,at_s\n{row}\n")).unwrap_err()
    };
    for row in ["A,pre,calm,m,1,1,", "A,after,,m,1,1,", "A,probe,,m,1,1,5", "A,sporty,calm,m,1,1,"]
    {
        let told = two(row);
        assert!(told.contains("row 1, column `moment`") && told.contains("`post`"), "{told}");
    }
    assert!(two("A,after,a b,m,1,1,").contains("column `condition`"));
    assert!(two("A,probe,calm,m,1,1,").contains("column `at_s`"));
}

#[test]
fn session_and_trial_stand_beside_the_moment_and_are_the_first_where_the_table_is_silent() {
    let head = "participant,moment,session,trial,scale,item,answer\n";
    let moments = moments_of(&format!(
        "{head}A,pre,,,m,1,1\nA,calm,,,m,1,2\nA,calm,1,2,m,1,3\nA,calm,2,1,m,1,4\n"
    ));
    let again = |session, trial| {
        let occasion = Occasion::new(session, trial).unwrap();
        after("calm").on(occasion)
    };
    assert_eq!(moments, [Moment::Pre, after("calm"), again(1, 2), again(2, 1)]);
    for (row, column) in [
        ("A,calm,0,1,m,1,1", "session"),
        ("A,calm,1,-1,m,1,1", "trial"),
        ("A,calm,1,1.5,m,1,1", "trial"),
    ] {
        let told = read(&format!("{head}{row}\n")).unwrap_err();
        let place = format!("row 1, column `{column}`");
        assert!(told.contains(&place) && told.contains("from 1"), "{told}");
    }
    let told = read(&format!("{head}A,pre,2,1,m,1,1\n")).unwrap_err();
    assert!(told.contains("asked once"), "{told}");
    // What was written comes back, and a table of one ride each has no such column.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scores.csv");
    let score = |moment| Score {
        participant: ParticipantId::new("A").unwrap(),
        moment,
        scale: "m".to_owned(),
        subscale: "m".to_owned(),
        value: Some(2.5),
        answered: 1,
        items: 1,
    };
    let scores = [score(Moment::Pre), score(after("calm")), score(again(2, 2))];
    write_scores(&path, &scores).unwrap();
    assert_eq!(read_scores(&path).unwrap(), scores);
    write_scores(&path, &scores[..2]).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(!text.contains("session") && !text.contains("trial"), "{text}");
}

#[test]
fn answers_come_back_as_they_were() {
    let answer = |moment| Answer {
        participant: ParticipantId::new("A").unwrap(),
        moment,
        scale: "m".to_owned(),
        item: 1,
        answer: Some(2),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("answers.csv");
    let first = [answer(Moment::Pre), answer(after("calm"))];
    write_answers(&path, &first, &[]).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.starts_with("participant,moment,scale,item,answer\n"), "{text}");
    let all = [answer(Moment::Pre), answer(after("post")), answer(Moment::Post)];
    let probes = [ProbeAnswer {
        participant: ParticipantId::new("A").unwrap(),
        ride: "calm".parse().unwrap(),
        scale: "misc".to_owned(),
        at_s: 60.0,
        answer: Some(4),
    }];
    write_answers(&path, &all, &probes).unwrap();
    let back = read_answered(&path).unwrap();
    assert_eq!((&back.answers[..], &back.probes[..]), (&all[..], &probes[..]));
}

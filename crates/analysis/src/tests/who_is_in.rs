//! Who is analysed, and what is refused.

use super::*;

#[test]
fn whoever_lacks_a_value_is_left_out_and_named() {
    let mut tables = tables();
    for drive in &mut tables.measurements {
        if drive.meta.drive.as_str() == "P4-same" {
            drive.values.insert(SPEED.to_owned(), None);
        }
    }
    let a = analysed(tables);
    assert_eq!(panel(&a, SPEED).dropped, ["P4"]);
    assert_eq!(panel(&a, SPEED).lacking(), 1);
    assert_eq!((panel(&a, SPEED).n, a.reproduction[0].dropped), (5, 1));
    let said = |e: &crate::Exclusion| e.who == "P4" && e.what == "comparison of mean velocity";
    assert!(a.exclusions.iter().any(said));
    // They rated all conditions.
    assert!(a.partly.is_empty());
}

#[test]
fn whoever_has_nothing_in_a_condition_is_named_and_their_accuracy_is_not_said_to_lack_a_value() {
    let mut tables = tables();
    let fast = id("fast");
    tables.measurements.retain(|d| d.meta.drive.as_str() != "P4-fast");
    tables.post.retain(|s| s.participant != person(3) || s.moment != Moment::after(fast));
    // A baseline of zero has no accuracy.
    for drive in &mut tables.measurements {
        if drive.meta.drive.as_str() == "P6-own" {
            drive.values.insert(SPEED.to_owned(), Some(0.0));
        }
    }
    let a = analysed(tables);
    assert_eq!(a.partly, ["P4"]);
    let accuracy = a.exclusions.iter();
    let accuracy = accuracy.filter(|e| e.what == "accuracy of mean velocity in same");
    let said: Vec<(&str, bool)> = accuracy
        .map(|e| (e.who.as_str(), e.why == "not in the comparison of mean velocity"))
        .collect();
    assert_eq!(said, [("1 participant", true), ("1 participant", false)]);
}

#[test]
fn whoever_is_excluded_is_out_of_everything_and_counted_with_the_reason() {
    let mut with = tables();
    with.people = (0..7).map(|i| listed(i, false, &[])).collect();
    for drive in &with.measurements {
        let seconds = if drive.meta.drive.as_str() == "P5-slow" { 100.0 } else { 600.0 };
        with.durations_s.insert(drive.meta.drive.clone(), seconds);
    }
    with.measurements
        .retain(|d| d.meta.participant.as_str() != "P6" || d.meta.condition == id("own"));
    let rules = "[exclude]\npeople = { P1 = \"withdrew consent\" }\n\
                 drives = { P2-fast = \"simulator sickness\" }\n\
                 drive_shorter_than_s = 300\nfewer_conditions_than = 2\n";
    let a = analysed_by(&plain(&["same", "fast", "slow"], rules), with);
    assert_eq!(a.flow.recruited, 7);
    assert_eq!((a.flow.drove, a.flow.analysed), (6, 5));
    assert_eq!(a.flow.absent, ["P7"]);
    let why: Vec<(&str, &[String])> =
        a.flow.left_out.iter().map(|l| (l.why.as_str(), &l.who[..])).collect();
    assert_eq!(
        why,
        [
            ("withdrew consent", &["P1".to_owned()][..]),
            ("no drive and no answer in any condition", &["P7".to_owned()][..]),
        ]
    );
    let drives: Vec<&str> = a.flow.drives.iter().map(|l| l.why.as_str()).collect();
    assert_eq!(drives, ["simulator sickness", "drive shorter than 300 s"]);
    let trust = panel(&a, "jian_trust.overall");
    assert_eq!(trust.participants, ["P2", "P3", "P4", "P5", "P6"]);
    // Neither the drive nor what was said of it is left.
    assert_eq!((trust.rows[0][1], trust.rows[3][2]), (None, None));
    assert_eq!((panel(&a, SPEED).n, trust.n), (2, 3));
}

#[test]
fn whoever_never_drove_is_absent_whatever_else_leaves_them_out() {
    let mut with = with_people(AGES);
    with.people.extend([listed(6, false, &[]), listed(7, false, &[])]);
    let rules = "[exclude]\npeople = { P1 = \"withdrew consent\", P7 = \"fell ill\" }\n";
    let a = analysed_by(&plain(&["same", "fast", "slow"], rules), with);
    assert_eq!(a.flow.absent, ["P7", "P8"]);
    let out = a.flow.left_out.iter();
    let out: Vec<(&str, usize)> = out.map(|l| (l.why.as_str(), l.who.len())).collect();
    assert_eq!(
        out,
        [("fell ill", 1), ("withdrew consent", 1), ("no drive and no answer in any condition", 1)]
    );
    let counts = (a.flow.recruited, a.flow.drove, a.flow.analysed);
    assert_eq!(counts, (8, 6, 5));
}

#[test]
fn whoever_has_no_baseline_drive_or_answered_nothing_is_named() {
    let whole = analysed(tables());
    assert!(whole.without_baseline.is_empty() && whole.without_answer.is_empty());
    let mut some = tables();
    some.measurements.retain(|d| d.meta.drive.as_str() != "P4-own");
    some.post.retain(|s| s.participant.as_str() != "P5");
    let a = analysed(some);
    assert_eq!(a.without_baseline, ["P4"]);
    assert_eq!(a.without_answer, ["P5"]);
}

#[test]
fn too_few_conditions_are_counted_from_drives_and_answers() {
    let mut with = tables();
    with.measurements
        .retain(|d| d.meta.participant.as_str() != "P6" || d.meta.condition == id("same"));
    with.post.retain(|s| s.participant.as_str() != "P6");
    let rules = "[exclude]\nfewer_conditions_than = 2\n";
    let a = analysed_by(&plain(&["same", "fast", "slow"], rules), with);
    assert_eq!(a.flow.left_out[0].why, "fewer than 2 conditions");
    assert!(a.flow.absent.is_empty());
    assert_eq!((a.participants, a.flow.left_out[0].who.len()), (5, 1));
}

#[test]
fn a_condition_is_there_if_it_was_driven_or_rated_and_refused_if_it_was_neither() {
    let design = design(DESIGN.split("[homophily]").next().unwrap());
    let of = |driven: bool, rated: bool| {
        let mut tables = tables();
        let across = id("across");
        tables.measurements.retain(|d| driven || d.meta.condition != across);
        let after = Moment::after(across);
        tables.post.retain(|s| rated || s.moment != after);
        StudyData::new(&design, tables).map(|_| ())
    };
    for (driven, rated) in [(true, true), (true, false), (false, true)] {
        assert!(of(driven, rated).is_ok(), "{driven} {rated}");
    }
    // One person's rating is enough.
    let mut once = tables();
    once.measurements.retain(|d| d.meta.condition != id("across"));
    let after = Moment::after(id("across"));
    once.post.retain(|s| s.moment != after || s.participant == person(0));
    assert!(StudyData::new(&design, once).is_ok());
    assert!(matches!(
        of(false, false),
        Err(AnalysisError::NobodyThere { condition }) if condition == id("across")
    ));
}

#[test]
fn whoever_is_learned_from_or_drove_nothing_of_the_study_takes_no_part() {
    let mut with = with_people(AGES);
    // P7 is learned from and drove the baseline; P8 is to be tested and drove something else.
    with.people.extend([listed(6, true, &[]), listed(7, false, &[])]);
    with.measurements.push(drive_of(6, "own", Some(30.0)));
    with.measurements.push(drive_of(7, "elsewhere", Some(30.0)));
    let a = analysed(with);
    assert_eq!((a.participants, a.flow.recruited, a.flow.drove), (6, 7, 6));
    assert_eq!(a.flow.left_out[0].who, ["P8"]);
}

#[test]
fn what_cannot_be_analysed_is_refused_by_name() {
    let mut two = tables();
    two.measurements.retain(|d| ["P1", "P2"].contains(&d.meta.participant.as_str()));
    two.post.clear();
    let error = StudyData::new(&design(DESIGN), two).unwrap_err();
    assert!(matches!(error, AnalysisError::TooFewPeople { found: 2 }));
    let error = StudyData::new(&design(&plain(&["fast", "sporty"], "")), tables()).unwrap_err();
    assert!(error.to_string().contains("`sporty`"), "{error}");
    for (factor, said) in [
        ("mdsi", "the scale `mdsi`, which nobody answered"),
        ("mini_ipip.pace", "the factors of mini_ipip are conscientiousness"),
    ] {
        let text = DESIGN.replace("\"mini_ipip\"", &format!("\"{factor}\""));
        let data = StudyData::new(&design(&text), tables()).unwrap();
        let error = analyse(&data, Purpose::Report).unwrap_err();
        assert!(error.to_string().contains(said) && error.suggestion().is_some(), "{error}");
    }
}

#[test]
fn a_score_is_called_by_its_questionnaire() {
    let data = StudyData::new(&design(DESIGN), tables()).unwrap();
    let name: ScoreName = "jian_trust.overall".parse().unwrap();
    assert_eq!(data.score_title(&name), "jian_trust.overall");
}

use super::*;

#[test]
fn who_misses_as_many_checks_of_attention_as_the_rule_says_is_left_out_and_who_misses_fewer_is_not()
{
    let scale = "id = \"read\"\ntitle = \"Read\"\nreference = \"made up\"\nmin = 1\nmax = 7\n\
                 [[item]]\ntext = \"Tick 2.\"\nexpected = 2\n[[item]]\ntext = \"Tick 7.\"\nexpected = 7\n";
    let scales = [Scale::from_toml(scale).unwrap()];
    let answer = |who: &str, item, answer| Answer {
        participant: ParticipantId::new(who).unwrap(),
        moment: maveric_domain::Moment::Pre,
        scale: "read".to_owned(),
        item,
        answer: Some(answer),
    };
    let answers = [
        [answer("P1", 1, 3), answer("P1", 2, 3)],
        [answer("P2", 1, 2), answer("P2", 2, 1)],
        [answer("P3", 1, 2), answer("P3", 2, 7)],
    ];
    let design = |rule: &str| {
        let text = format!("[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n{rule}");
        Design::from_toml(&text)
    };
    let left_out = |rule: &str| {
        let left_out = LeftOut::default();
        let design = design(rule).unwrap();
        let left_out = left_out.with_careless(&design, &scales, answers.as_flattened());
        let people = left_out.people.iter();
        let people = people.map(|(who, why)| format!("{who} {}", why.reason));
        people.collect::<Vec<_>>()
    };
    let otherwise = "of the items that are there for attention answered otherwise than asked for";
    let (both, one) = (format!("P1 2 {otherwise}"), format!("P2 1 {otherwise}"));
    let from_one = left_out("[exclude]\nattention_missed_at_least = 1");
    assert_eq!(from_one, [both.clone(), one]);
    let from_two = left_out("[exclude]\nattention_missed_at_least = 2");
    assert_eq!(from_two, [both]);
    assert!(left_out("").is_empty());
    assert!(design("[exclude]\nattention_missed_at_least = 0").is_err());
}

#[test]
fn a_stopped_ride_is_left_out_with_what_was_said_of_it_and_named_with_its_condition_and_reason() {
    let design = Design::from_toml(
        "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n[[condition]]\nid = \"b\"",
    )
    .unwrap();
    let who = |id: &str| ParticipantId::new(id).unwrap();
    let id = |id: &str| id.parse::<ConditionId>().unwrap();
    let stop = |id: &str, condition: &str, reason: &str| Stopped {
        participant: who(id),
        condition: condition.parse().unwrap(),
        session: first(),
        trial: first(),
        time_s: 34.0,
        reason: reason.to_owned(),
    };
    let stopped =
        [stop("P1", "a", "misc >= 6"), stop("P2", "a", "misc >= 6"), stop("P3", "b", "unwell")];
    let left_out = LeftOut::named(&design).with_stopped(&stopped);
    let long = "P".repeat(63);
    let too_long = LeftOut::default().with_stopped(&[stop(&long, "a", "unwell")]);
    assert!(too_long.drives.is_empty() && !too_long.keeps(&who(&long), id("a")));
    assert!(!left_out.keeps(&who("P1"), id("a")));
    assert!(left_out.keeps(&who("P1"), id("b")) && left_out.keeps_person(&who("P1")));
    let flow = crate::flow::flow(
        &design,
        &[],
        &[who("P1"), who("P2"), who("P3")].into(),
        &left_out,
        (&[], Vec::new()),
    );
    let rows: Vec<(&str, usize)> =
        flow.drives.iter().map(|row| (row.why.as_str(), row.who.len())).collect();
    assert_eq!(rows, [("`a` was stopped: misc >= 6", 2), ("`b` was stopped: unwell", 1)]);
    assert!(flow.drives.iter().all(|row| row.rule == Rule::Stopped));
}

#[test]
fn what_the_experimenter_did_is_said_as_it_was_done_and_all_of_a_person_is_one_loss() {
    let design = Design::from_toml("[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"").unwrap();
    let who = |id: &str| ParticipantId::new(id).unwrap();
    let stop = |id: &str, condition: &str, reason: &str| Stopped {
        participant: who(id),
        condition: condition.parse().unwrap(),
        session: first(),
        trial: first(),
        time_s: 34.0,
        reason: reason.to_owned(),
    };
    let stopped = [
        stop("P1", "a", "excluded: wrong glasses"),
        stop("P1", "own", "excluded: wrong glasses"),
        stop("P2", "a", "skipped: the rig broke"),
        stop("P3", "a", "aborted"),
        stop("P4", "a", "excluded"),
    ];
    assert!(!stopped.iter().any(Stopped::by_the_person));
    assert!(stop("P5", "a", "misc >= 6").by_the_person());
    let left_out = LeftOut::named(&design).with_stopped(&stopped);
    assert!(left_out.keeps_person(&who("P1")) && !left_out.keeps(&who("P1"), stopped[0].ride()));
    let left_out = left_out.with_excluded(&stopped);
    let there: BTreeSet<ParticipantId> = ["P1", "P2", "P3", "P5"].map(who).into();
    let flow = crate::flow::flow(&design, &[], &there, &left_out, (&[], Vec::new()));
    let rows = |rows: &[crate::LeftOutFor]| -> Vec<String> {
        let row = |row: &crate::LeftOutFor| format!("{}: {}", row.who.join(" "), row.why);
        rows.iter().map(row).collect()
    };
    assert_eq!(rows(&flow.left_out), ["P1: by the experimenter: wrong glasses"]);
    assert_eq!((flow.recruited, flow.drove, flow.analysed), (4, 4, 3));
    // P4 is not among those who were to be tested: what they drove is told by its name.
    assert_eq!(
        rows(&flow.drives),
        [
            "P3-a: `a` was aborted",
            "P2-a: `a` was skipped: the rig broke",
            "P4-a: by the experimenter"
        ]
    );
}

#[test]
fn of_several_rides_each_is_judged_alone_and_one_too_many_is_named_with_what_was_declared() {
    let text = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n[baseline]\nid = \"own\"\n\
                [protocol]\nrides_per_condition = 2\nsessions = { count = 2, days_between = [2, 14] }\n\
                [exclude]\ndrive_shorter_than_s = 300\nfewer_conditions_than = 1\ndrives = { \"P1-a_s2_t1\" = \"lost\" }";
    let design = Design::from_toml(text).unwrap();
    let who = ParticipantId::new("P1").unwrap();
    let ride = |text: &str| text.parse::<Ride>().unwrap();
    let driven = |ride: Ride, duration_s| Driven {
        drive: DriveId::in_condition(&who, ride).unwrap(),
        participant: who.clone(),
        ride,
        duration_s: Some(duration_s),
    };
    let rides = ["a", "a:s1:t2", "a:s2:t1", "a:s2:t2"].map(ride);
    let drives = [
        driven(rides[0], 299.0),
        driven(rides[1], 300.0),
        driven(rides[2], 400.0),
        driven(rides[3], 400.0),
    ];
    let came = || drives.iter().map(|d| (&d.participant, d.ride));
    let left_out =
        LeftOut::named(&design).with_short(&design, &drives).with_few_conditions(&design, came());
    assert_eq!(rides.map(|ride| left_out.keeps(&who, ride)), [false, true, false, true]);
    assert!(left_out.keeps_person(&who));
    let why = |text: &str| unknown_ride(&design, ride(text));
    for known in ["a", "a:s2:t2", "own", "own:s2:t1"] {
        assert_eq!(why(known), None, "{known}");
    }
    for (unknown, words) in [
        ("a:s1:t3", "session 1, trial 3 of `a`, expected sessions up to 2 and trials up to 2"),
        ("a:s3:t1", "session 3, trial 1"),
        ("own:s1:t2", "trials up to 1"),
    ] {
        let why = why(unknown).unwrap();
        assert_eq!(why.rule, Rule::UnknownOccasion);
        assert!(why.reason.contains(words), "{why}");
    }
    assert_eq!(why("b").unwrap().rule, Rule::UnknownCondition);
}

#[test]
fn a_rule_leaves_out_what_lies_below_it_and_nothing_at_it() {
    let text = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n[[condition]]\nid = \"b\"\n\
                [exclude]\ndrive_shorter_than_s = 300\nfewer_conditions_than = 2\ndrives = { \"P4-b\" = \"lost\" }";
    let design = Design::from_toml(text).unwrap();
    let driven = |who: &str, condition: &str, duration_s| Driven {
        drive: DriveId::new(format!("{who}-{condition}")).unwrap(),
        participant: ParticipantId::new(who).unwrap(),
        ride: condition.parse().unwrap(),
        duration_s,
    };
    let drives = [
        driven("P1", "a", Some(300.0)),
        driven("P1", "b", None),
        driven("P2", "a", Some(299.9)),
        driven("P2", "b", Some(400.0)),
        driven("P3", "own", Some(400.0)),
        driven("P4", "a", Some(400.0)),
    ];
    let left_out = LeftOut::named(&design)
        .with_short(&design, &drives)
        .with_few_conditions(&design, drives.iter().map(|d| (&d.participant, d.ride)));
    let people: Vec<&str> = left_out.people.keys().map(ParticipantId::as_str).collect();
    // One short drive leaves P2 with one condition; P3 sat through none, which is for others to judge.
    assert_eq!(people, ["P2", "P4"]);
    assert!(left_out.people.values().all(|why| why.rule == Rule::FewConditions));
    let short: Vec<&str> = left_out.drives.keys().map(DriveId::as_str).collect();
    assert_eq!(short, ["P2-a", "P4-b"]);
    let who = |text: &str| ParticipantId::new(text).unwrap();
    let (a, b): (Ride, Ride) = ("a".parse().unwrap(), "b".parse().unwrap());
    assert!(left_out.keeps(&who("P1"), a) && !left_out.keeps(&who("P2"), b));
    assert!(left_out.keeps_person(&who("P3")) && !left_out.keeps(&who("P4"), b));
}

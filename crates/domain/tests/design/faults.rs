//! What is refused, by key and value.

use super::*;

#[test]
fn every_length_and_angle_of_the_protocol_ends_where_it_says() {
    let of = |key: &str, value: f64| {
        let value = format!("{value:?}").to_lowercase();
        match key.rsplit_once('.') {
            Some((table, key)) => with(&format!("[protocol.{table}]\n{key} = {value}")),
            None => with(&format!("[protocol]\n{key} = {value}")),
        }
    };
    for (key, low, high) in [
        ("drive_s", 10.0, 7200.0),
        ("ride_s", 10.0, 7200.0),
        ("practice.at_most_s", 30.0, 7200.0),
        ("practice.lane_kept_s", 0.0, 300.0),
        ("view.eye_m", 0.5, 4.0),
        ("view.field_deg", 10.0, 100.0),
        ("view.side_deg", 0.0, 90.0),
    ] {
        assert!(of(key, low).is_ok() && of(key, high).is_ok(), "{key}");
        for beyond in [low - 0.1, high + 0.1, f64::NAN] {
            let text = of(key, beyond).unwrap_err();
            assert!(text.contains("`protocol."), "{key} {beyond}: {text}");
        }
    }
    let screens = |n: u32| with(&format!("[protocol.view]\nscreens = {n}"));
    assert!(screens(1).is_ok() && screens(3).is_ok());
    assert!(screens(2).unwrap_err().contains("1 or 3"));
    let steps = |steps: &str| with(&format!("[protocol]\nsteps = {steps}"));
    assert!(steps("[\"drive\", \"rides\"]").is_ok());
    assert!(steps("[\"rides\"]").is_err());
}

#[test]
fn fifty_conditions_are_a_study_and_one_more_is_none() {
    let study = |n: usize| {
        let conditions = (0..n).map(|i| format!("[[condition]]\nid = \"c{i}\"\n"));
        read(&format!("[study]\ntitle = \"x\"\n{}", conditions.collect::<String>()))
    };
    assert_eq!(study(50).unwrap().contrasts().len(), 1225);
    assert!(study(51).unwrap_err().contains("at most 50"));
}

#[test]
fn a_fault_is_named_with_its_key_and_what_would_be_possible() {
    for (more, said) in [
        ("[contrast]\ncompare = \"all\"", "line 16: unknown field `contrast`"),
        ("[contrast]\ncompare = \"all\"", "did you mean `contrasts`?"),
        ("[exclude]\nstraightlined = true", "did you mean `straight_lined`?"),
        ("[[condition]]\nid = \"calm\"", "`condition.id`: found `calm` twice"),
        ("[[condition]]\nid = \"so calm\"", "line 17: condition `so calm` must be"),
        (
            "[[condition]]\nid = \"x\"\ncar = { dial = 1, mean = true }",
            "`condition.x.car`: found `dial` and `mean`",
        ),
        ("[[condition]]\nid = \"x\"\ncar = { dial = \"far\" }", "number of steps"),
        ("[[condition]]\nid = \"x\"\ncar = { dial = true }", "points, such as -15"),
        ("[[condition]]\nid = \"x\"\ncar = {}", "found no car"),
        (
            "[[condition]]\nid = \"x\"\nlevels = { traffic = \"dense\" }",
            "`condition.x.levels`: found traffic, expected no factor, as in `calm`",
        ),
        ("[[condition]]\nid = \"x\"\ncolor = \"blue\"", "#rrggbb"),
        (
            "[contrasts]\ncompare = \"against calmm\"",
            "found `calmm`, expected one of `calm`, `sporty`; did you mean `calm`?",
        ),
        ("[contrasts]\ncompare = [[\"calm\", \"spotry\"]]", "did you mean `sporty`?"),
        ("[contrasts]\ncompare = [[\"calm\", \"sporty\"], [\"sporty\", \"calm\"]]", "twice"),
        (
            "[protocol]\nsteps = [\"rides\", \"drive\"]",
            "`protocol.steps`: found rides without a drive before them",
        ),
        ("[protocol]\nsteps = [\"drive\", \"drive\"]", "found drive twice, expected each once"),
        ("[protocol]\nride_s = 1", "`protocol.ride_s`: found 1, expected 10 to 7200 s"),
        ("[protocol]\nconsnet = \"consent.md\"", "did you mean `consent`?"),
        ("[contrasts]\ncompare = \"some\"", "\"against ID\""),
        ("[[outcome]]\nmeasure = \"a\"\nscale = \"b.c\"", "one of them"),
        ("[[outcome]]\nscale = \"comfort\"", "expected SCALE.SUBSCALE"),
        (
            "[[outcome]]\nmeasure = \"speed\"\n[[hypothesis]]\nsays = \"x\"\noutcome = \"sped\"\ncontrast = [\"calm\", \"sporty\"]\ndirection = \"+\"",
            "`hypothesis[1].outcome`: found `sped`, expected `speed`; did you mean `speed`?",
        ),
        (
            "[[hypothesis]]\nsays = \"x\"\noutcome = \"speed\"\ncontrast = [\"calm\", \"own\"]\ndirection = \"+\"",
            "`hypothesis[1].contrast`: found `own`",
        ),
        (
            "[[hypothesis]]\nsays = \"x\"\noutcome = \"speed\"\ncontrast = [\"calm\", \"sporty\"]",
            "neither `direction` nor `equivalent`",
        ),
        ("[contrasts]\ncompare = [[\"calm\", \"calm\"]]", "`calm` with itself"),
        (
            "[contrasts]\ncompare = \"against calm\"\n[[condition]]\nid = \"x\"\n[[hypothesis]]\nsays = \"x\"\noutcome = \"speed\"\ncontrast = [\"x\", \"sporty\"]\ndirection = \"+\"",
            "a pair that `[contrasts]` compares: calm and sporty; calm and x",
        ),
        (
            "[[hypothesis]]\nsays = \"x\"\noutcome = \"speed\"\ncontrast = [\"calm\", \"sporty\"]\ndirection = \"+\"\nequivalent = [0, 1]",
            "both `direction` and `equivalent`",
        ),
        (
            "[[hypothesis]]\nsays = \"x\"\noutcome = \"speed\"\ncontrast = [\"calm\", \"sporty\"]\nequivalent = [1, 1]",
            "`hypothesis[1].equivalent`",
        ),
        ("[[outcome]]\nmeasure = \"speed\"\nsame_within = 0", "`outcome.same_within`"),
        (
            "[[outcome]]\nmeasure = \"speed\"\n[[outcome]]\nmeasure = \"speed\"",
            "`outcome`: found `speed` twice",
        ),
        ("[[outcome]]\nlabel = \"x\"", "neither `measure` nor `scale`"),
        ("[exclude]\ndrive_shorter_than_s = 0", "seconds above 0"),
        ("[exclude]\ndrives = { d = \" \" }", "`exclude: d`"),
        ("[exclude]\npeople = { P07 = \"\" }", "expected the reason"),
        ("[exclude]\ndrive_shorter_than_s = -1", "seconds above 0"),
        ("[baseline]\nid = \"own\"\n[[role]]\nid = \"own\"", "the baseline's"),
        ("[[role]]\nid = \"fast\"\nscore = inf", "`role.score`: found inf of `fast`"),
        ("[[role]]\nid = \"fast\"\nrepeats = \"fast\"", "`role.repeats`: found `fast` of `fast`"),
        (
            "[[role]]\nid = \"a\"\n[[role]]\nid = \"b\"\nrepeats = \"a\"\nscore = 20",
            "it has that of the role it repeats",
        ),
        (
            "[[role]]\nid = \"a\"\n[[role]]\nid = \"b\"\nrepeats = \"a\"\n[[role]]\nid = \"c\"\nrepeats = \"b\"",
            "another role that repeats none itself",
        ),
    ] {
        let error = with(more).unwrap_err();
        assert!(error.contains(said), "{more}\n{error}\nhas no: {said}");
    }
}

#[test]
fn a_dial_needs_a_style_and_a_learned_car_somebody_to_learn_from() {
    let no_style = SMALL.replace("[style]\nscore = \"adb.total\"\npoints = 15\n", "");
    let error = read(&no_style).unwrap_err();
    let said = "`condition.calm.car`: found a place on the dial, and no `[style]`";
    assert!(error.contains(said), "{error}");
    for car in ["across", "free"] {
        let text = no_style.replace("dial = \"-1\"", &format!("{car} = true"));
        let error = read(&text).unwrap_err();
        assert!(error.contains(said), "{car}: {error}");
    }
    let nobody = SMALL.replace("learn = { study = 1 }", "");
    let error = read(&nobody).unwrap_err();
    assert!(error.contains("people to learn from"), "{error}");
    let elsewhere = format!("{nobody}[model]\nfile = \"lab.maveric\"\n");
    assert!(read(&elsewhere).is_ok());
    let no_step = SMALL.replace("points = 15", "range = [11, 66]");
    let error = read(&no_step).unwrap_err();
    assert!(error.contains("points of a step"), "{error}");
    // The dial reaches from one end of the score to the other, no further, and its steps are above 0.
    let within = |to: &str| read(&SMALL.replace("points = 15", to));
    assert!(within("points = 7.5\nrange = [1, 8.5]").is_ok());
    assert!(within("points = 0").unwrap_err().contains("`style.points`"));
    assert!(within("points = 1\nrange = [6, 6]").unwrap_err().contains("`style.range`"));
    let narrow = SMALL.replace("points = 15", "points = 1\nrange = [1, 6]");
    let error = read(&narrow).unwrap_err();
    let said = "`condition.sporty.car.dial`: found 7.5, expected at most 5";
    assert!(error.contains(said), "{error}");
    for no_range in ["[6, 1]", "[0, inf]", "[-inf, 6]", "[1, nan]"] {
        let error = within(&format!("points = 1\nrange = {no_range}")).unwrap_err();
        assert!(error.contains("`style.range`"), "{no_range}: {error}");
    }
}

#[test]
fn a_study_without_conditions_or_title_is_none() {
    for (text, said) in [
        ("[study]\ntitle = \"x\"".to_owned(), "at least one [[condition]]"),
        ("[[condition]]\nid = \"x\"".to_owned(), "missing field `study`"),
        (SMALL.replace("Calm, normal, sporty", " "), "study.title"),
        ("[study".to_owned(), "line 1: "),
    ] {
        let error = read(&text).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn labels_are_given_once_factors_have_levels_and_a_car_is_of_one_kind() {
    let two = |first: &str, second: &str| {
        let head = "[study]\ntitle = \"t\"\n[people]\nlearn = { part = \"l\" }\n[style]\nscore = \"adb.total\"\n";
        let text = format!("{head}[[condition]]\nid = \"a\"\n{first}\n[[condition]]\n{second}\n");
        Design::from_toml(&text).map_err(|e| e.to_string())
    };
    assert!(two("", "id = \"b\"").is_ok());
    let matched = |more: &str| {
        let design = two(&format!("car = {{ other = \"matched\"{more} }}"), "id = \"b\"");
        design.unwrap().conditions()[0].car.clone().unwrap()
    };
    let lent = |from, apart_sd| Car::Matched(Matched { from, apart_sd });
    assert_eq!(matched(""), lent(Donors::Tested, [0.7, 2.5]));
    let learned = ", from = \"learned\", apart = [1, 3]";
    assert_eq!(matched(learned), lent(Donors::Learned, [1.0, 3.0]));
    // The word for before the drives is as good an id as any.
    assert!(two("", "id = \"pre\"").is_ok());
    for (first, second, expected) in [
        ("label = \"Calm\"", "id = \"b\"\nlabel = \"Calm\"", "`Calm` twice"),
        (
            "levels = { pace = \"slow\" }",
            "id = \"b\"\nlevels = { pace = \"slow\" }",
            "`slow` in every condition",
        ),
        ("car = { dial = 1, across = true }", "id = \"b\"", "`dial` and `across`"),
        ("car = { other = \"matched\", mean = true }", "id = \"b\"", "`mean` and `other`"),
        (
            "car = { dial = 0, apart = [1, 2] }",
            "id = \"b\"",
            "`condition.a.car.apart`: found a car that has nobody else's style",
        ),
        ("car = { other = \"matched\", apart = [2.5, 0.7] }", "id = \"b\"", "found [2.5, 0.7]"),
        ("car = { other = \"alike\" }", "id = \"b\"", "unknown variant `alike`"),
    ] {
        let refused = two(first, second).unwrap_err();
        assert!(refused.contains(expected), "{refused}");
    }
}

#[test]
fn tables_of_people_left_out_name_the_key_that_they_lack() {
    let with = |tables: &str| {
        read(&format!(
            "[study]\ntitle = \"x\"\n[style]\nscore = \"adb.total\"\nrange = [11, 55]\n\
             [[role]]\nid = \"calm\"\nscore = 20\n[[role]]\nid = \"sporty\"\nscore = 45\n{tables}"
        ))
    };
    let table = |keys: &str| with(&format!("[[validate.table]]\nid = \"a\"\n{keys}"));
    let pair = "higher = \"sporty\"\nlower = [\"calm\"]\n";
    let read = table(&format!("asks = \"order\"\n{pair}")).unwrap();
    let [order] = read.validate().tables.as_slice() else {
        panic!("{:?}", read.validate());
    };
    assert!(order.learn.is_empty() && !order.seen && order.lower.len() == 1);
    for (keys, said) in [
        ("asks = \"guess\"\n", "unknown variant `guess`"),
        ("asks = \"retest\"\nrole = \"calm\"\nstatistic = \"t\"\n", "unknown field `statistic`"),
        ("asks = \"order\"\n", "`validate.table.a.higher`"),
        ("asks = \"order\"\nhigher = \"sporty\"\n", "`validate.table.a.lower`"),
        (&format!("asks = \"direction\"\n{pair}directions = 9\n"), "`validate.table.a.points`"),
        (&format!("asks = \"direction\"\n{pair}points = 0\ndirections = 9\n"), "other than 0"),
        (&format!("asks = \"direction\"\n{pair}points = 15\ndirections = 0\n"), "at least 1"),
        ("asks = \"identity\"\namong = \"calm\"\n", "`validate.table.a.sought`"),
        ("asks = \"errors\"\n", "`validate.table.a.role`"),
        (
            "asks = \"retest\"\nrole = \"clam\"\n",
            "`validate.table.a.role`: found `clam`, expected one of `calm`, `sporty`; did you mean `calm`?",
        ),
        (
            &format!(
                "asks = \"order\"\n{pair}[[validate.table]]\nid = \"a\"\nasks = \"order\"\n{pair}"
            ),
            "an id that no other table has",
        ),
    ] {
        let error = table(keys).unwrap_err();
        assert!(error.contains(said), "{keys}: {error}");
    }
}

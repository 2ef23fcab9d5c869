//! Outcomes, measures, factors, covariates and contrasts.

use super::*;

#[test]
fn a_covariate_is_multiplied_by_an_effect_within_people_alone() {
    let covariate = |with: &str| format!("[[covariate]]\ncolumn = \"age\"\nwith = [\"{with}\"]\n");
    let design = with(&covariate("condition")).unwrap();
    assert_eq!(design.covariates()[0].with, ["condition"]);
    let error = with(&covariate("conditon")).unwrap_err();
    assert!(
        error.contains("`conditon` of `age`") && error.contains("did you mean `condition`"),
        "{error}"
    );
    let level = |id: &str, speed: &str, light: &str| {
        format!(
            "[[condition]]\nid = \"{id}\"\nlevels = {{ speed = \"{speed}\", light = \"{light}\" }}\n"
        )
    };
    let crossed = "[study]\ntitle = \"x\"\n".to_owned()
        + &level("a", "low", "day")
        + &level("b", "low", "night")
        + &level("c", "high", "day")
        + &level("d", "high", "night");
    for name in ["speed", "light", "light:speed"] {
        assert!(read(&(crossed.clone() + &covariate(name))).is_ok(), "{name}");
    }
    let error = read(&(crossed + &covariate("condition"))).unwrap_err();
    assert!(error.contains("`light`, `speed`, `light:speed`"), "{error}");
    assert!(with("[[factor]]\ncolumn = \"city\"\nwith = [\"condition\"]\n").is_err());
}

#[test]
fn a_measure_of_the_studys_own_has_a_unit_a_name_and_perhaps_a_direction() {
    let design = with(
        "[[measure]]\nid = \"tor_s\"\ntitle = \"Take-over time\"\nunit = \"s\"\naggression = \"-\"\n\
         [[measure]]\nid = \"glances\"\nunit = \"1\"\naggression = \"none\"\n",
    )
    .unwrap();
    let measures = design.measures();
    assert_eq!(measures.len(), 2);
    let (time, glances) = (&measures[0], &measures[1]);
    assert_eq!((&*time.title, time.shown_unit()), ("Take-over time", "s"));
    assert_eq!(time.aggression, Some(Sign::Minus));
    assert_eq!((&*glances.title, glances.shown_unit()), ("glances", ""));
    assert_eq!(glances.aggression, None);
    assert_eq!(design.measure("tor_s"), Some(time));
    assert!(design.measure("tor").is_none());
    let refused = |more: &str| with(&format!("[[measure]]\n{more}")).unwrap_err();
    for (more, said) in [
        ("id = \"tor\"", "`measure.tor.unit`: found nothing"),
        ("id = \"tor\"\nunit = \" \"", "`measure.tor.unit`: found nothing"),
        ("id = \"a.b\"\nunit = \"s\"", "`measure.id`: found `a.b`"),
        ("id = \"trial\"\nunit = \"s\"", "`measure.id`: found `trial`"),
        ("id = \"a\"\nunit = \"s\"\n[[measure]]\nid = \"a\"\nunit = \"m\"", "`a` twice"),
        ("id = \"a\"\nunit = \"s\"\naggression = \"up\"", "unknown variant `up`"),
    ] {
        let error = refused(more);
        assert!(error.contains(said), "{error}");
    }
}

const CROSSED: &str = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\nlevels = { style = \"sporty\", road = \"town\" }\n\
    [[condition]]\nid = \"b\"\nlevels = { style = \"sporty\", road = \"land\" }\n[[condition]]\nid = \"c\"\nlevels = { style = \"calm\", road = \"town\" }\n\
    [[condition]]\nid = \"d\"\nlevels = { style = \"calm\", road = \"land\" }\n";

#[test]
fn factors_and_levels_are_called_by_their_labels_and_stand_in_the_order_of_the_conditions() {
    let labels = "[[factor]]\nwithin = \"style\"\nlabel = \"Driving style\"\nlevels = { calm = \"Calm\" }\n\
        [[factor]]\ncolumn = \"group\"\n[[covariate]]\ncolumn = \"age\"\nlabel = \"Age\"\n";
    let design = Design::from_toml(&format!("{CROSSED}{labels}")).unwrap();
    let within = design.factors_within();
    let levels = |factor: &str| within.iter().find(|(name, _)| name == factor).unwrap().1.clone();
    assert_eq!(levels("style"), ["sporty", "calm"]);
    assert_eq!(levels("road"), ["town", "land"]);
    let label = |name| design.factor_label(name);
    assert_eq!([label("style"), label("group"), label("age")], ["Driving style", "group", "Age"]);
    let level = |level| design.level_label("style", level);
    assert_eq!([level("calm"), level("sporty")], ["Calm", "sporty"]);
    // A label of a factor within people makes no group of people.
    assert_eq!(design.factors().len(), 1);
    let plain = Design::from_toml(
        "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\nlabel = \"First\"\n[[condition]]\nid = \"b\"\n",
    );
    let plain = plain.unwrap();
    assert_eq!(plain.factors_within()[0].0, "condition");
    assert_eq!(plain.level_label("condition", "a"), "First");
}

#[test]
fn a_contrast_of_levels_names_what_is_there_and_holds_at_least_one_pair() {
    let with = |contrast: &str| {
        let text = format!(
            "{CROSSED}[[factor]]\ncolumn = \"group\"\n[contrasts]\nfactors = [{contrast}]\n"
        );
        Design::from_toml(&text)
    };
    let sound = "{ style = [\"calm\", \"sporty\"], group = [\"x\", \"y\"], road = \"town\" }";
    assert_eq!(with(sound).unwrap().level_contrasts().len(), 1);
    for (contrast, words) in [
        ("{ road = \"town\" }", "no pair of levels"),
        ("{ style = [\"calm\", \"calm\"] }", "`calm` with itself"),
        ("{ style = [\"calm\", \"brisk\"] }", "one of `sporty`, `calm`"),
        ("{ colour = [\"red\", \"blue\"] }", "`group`"),
        (&format!("{sound}, {sound}"), "stands above"),
    ] {
        let refused = with(contrast).unwrap_err().to_string();
        assert!(refused.contains(words), "{contrast}: {refused}");
    }
    for (factor, words) in [
        ("label = \"x\"", "neither `column` nor `within`"),
        ("column = \"a\"\nwithin = \"road\"", "both `column` and `within`"),
        ("within = \"rode\"", "did you mean `road`?"),
    ] {
        let refused = Design::from_toml(&format!("{CROSSED}[[factor]]\n{factor}\n"));
        let refused = refused.unwrap_err();
        let said = format!("{refused} {}", refused.suggestion().unwrap_or_default());
        assert!(said.contains(words), "{factor}: {said}");
    }
}

#[test]
fn a_primary_outcome_declares_its_test_and_one_contrast_and_is_refused_without() {
    let outcome =
        |more: &str| with(&format!("[[outcome]]\nmeasure = \"mean_velocity_mps\"\n{more}\n"));
    let design = outcome("primary = true\ntest = \"mixed\"\ncontrast = [\"sporty\", \"calm\"]");
    let declared = &design.unwrap().outcomes()[0].clone();
    assert_eq!(declared.test, Some(DeclaredTest::Mixed));
    assert_eq!(declared.primary, Some([id("sporty"), id("calm")]));
    for (more, key, said) in [
        (
            "primary = true\ntest = \"auto\"\ncontrast = [\"sporty\", \"calm\"]",
            "outcome[1].test",
            "`auto` of a primary outcome",
        ),
        (
            "primary = true\ncontrast = [\"sporty\", \"calm\"]",
            "outcome[1].test",
            "none of a primary outcome",
        ),
        ("primary = true\ntest = \"mixed\"", "outcome[1].contrast", "none of a primary outcome"),
        (
            "primary = true\ntest = \"mixed\"\ncontrast = [\"sporty\", \"clam\"]",
            "outcome[1].contrast",
            "`clam`",
        ),
        (
            "primary = true\ntest = \"mixed\"\ncontrast = [\"calm\", \"calm\"]",
            "outcome[1].contrast",
            "a pair that `[contrasts]` compares",
        ),
        (
            "test = \"mixed\"\ncontrast = [\"sporty\", \"calm\"]",
            "outcome[1].contrast",
            "not primary",
        ),
        ("test = \"anova\"", "", "rm-anova"),
    ] {
        let refused = outcome(more).unwrap_err();
        assert!(refused.contains(key) && refused.contains(said), "{more}: {refused}");
    }
    // Others may leave the test to what the data look like, or to the design.
    for (more, test) in [("test = \"auto\"", Some(DeclaredTest::Auto)), ("", None)] {
        assert_eq!(outcome(more).unwrap().outcomes()[0].test, test);
    }
}

#[test]
fn a_primary_outcome_by_a_test_that_the_design_can_never_run_is_read_and_not_to_be_declared() {
    let outcome = |test: &str, [first, second]: [&str; 2]| {
        format!(
            "[[outcome]]\nmeasure = \"mean_velocity_mps\"\nprimary = true\ntest = \"{test}\"\ncontrast = [\"{first}\", \"{second}\"]\n"
        )
    };
    let pair = ["sporty", "calm"];
    let (factor, covariate) =
        ("[[factor]]\ncolumn = \"city\"\n", "[[covariate]]\ncolumn = \"age\"\n");
    for test in ["ordinal", "rm-anova", "friedman"] {
        for (more, said) in [
            (factor, "beside the [[factor]] `city`"),
            (covariate, "beside the [[covariate]] `age`"),
        ] {
            let design = with(&(outcome(test, pair) + more)).unwrap();
            let refused = design.runnable().unwrap_err().to_string();
            let found = format!("`{test}` {said}");
            assert!(refused.contains("outcome[1].test") && refused.contains(&found), "{refused}");
            assert!(refused.contains("\"mixed\""), "{refused}");
        }
        let crossed = format!("{CROSSED}{}", outcome(test, ["a", "b"]));
        let design = Design::from_toml(&crossed).unwrap();
        let refused = design.runnable().unwrap_err().to_string();
        assert!(refused.contains("cross two factors"), "{refused}");
        // Of the conditions alone, and beside the label of what they are, each can be run.
        let label = "[[factor]]\nwithin = \"condition\"\nlabel = \"Style\"\n";
        for more in ["", label] {
            let design = with(&(outcome(test, pair) + more)).unwrap();
            assert_eq!(design.runnable(), Ok(()), "{test}{more}");
        }
        // So can it in each group of people, of an outcome that decides nothing.
        let plain =
            format!("[[outcome]]\nmeasure = \"mean_velocity_mps\"\ntest = \"{test}\"\n{factor}");
        assert_eq!(with(&plain).unwrap().runnable(), Ok(()));
    }
    for more in [factor, covariate] {
        let design = with(&(outcome("mixed", pair) + more)).unwrap();
        assert_eq!(design.runnable(), Ok(()), "{more}");
    }
    let crossed = format!("{CROSSED}{}", outcome("mixed", ["a", "b"]));
    assert_eq!(Design::from_toml(&crossed).unwrap().runnable(), Ok(()));
}

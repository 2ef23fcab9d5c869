//! Tables of any software: maps, patterns, sheets, and what is refused of them.

use super::*;

#[test]
fn an_otree_table_becomes_a_long_one() {
    let (warnings, table) = run(Software::Otree, OTREE, None).unwrap();
    assert_eq!(
        table,
        "participant,moment,scale,item,answer\nP01,pre,calm,1,1\nP01,pre,calm,2,2\nP01,pre,calm,3,3\nP01,mimic,calm,1,4\nP01,mimic,calm,2,\nP01,mimic,calm,3,6\n\
         P02,pre,calm,1,7\nP02,pre,calm,2,7\nP02,pre,calm,3,6\nP02,cautious,calm,1,5\nP02,cautious,calm,2,5\nP02,cautious,calm,3,5\n"
    );
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(
        warnings.iter().any(|w| w.contains("bot")) && warnings.iter().any(|w| w.contains("P04"))
    );
}

#[test]
fn an_item_that_was_left_out_is_no_answer() {
    let folder = tempfile::tempdir().unwrap();
    let from = Some(Software::Otree);
    let options = in_folder(folder.path(), from, OTREE.as_bytes(), None, "paper.toml");
    let done = options.run(Watch::unwatched()).unwrap();
    assert!(done.summary[0].starts_with("11 answers of 2 participants"));
}

#[test]
fn answers_about_a_condition_that_the_design_has_not_are_left_out_and_listed() {
    let text = OTREE.replace("cautious", "kautious");
    let (warnings, table) = run(Software::Otree, &text, None).unwrap();
    assert!(!table.contains("kautious") && table.contains("P02,pre,calm,1,7"));
    let said = warnings.iter().find(|w| w.contains("kautious")).unwrap();
    assert!(
        said.contains("3 answers left out") && said.contains("own, mimic, aggressive"),
        "{said}"
    );
}

#[test]
fn faults_name_participant_scale_and_item() {
    let fails = |from: &str, to: &str| {
        assert!(OTREE.contains(from), "{from}");
        run(Software::Otree, &OTREE.replacen(from, to, 1), None).unwrap_err()
    };
    for (from, to, said) in [
        (
            "P01,0,1,2",
            "P01,0,1,9",
            "participant P01 (pre), scale `calm`, item 2 (row 1, `intro.1.player.calm_2`): found `9`, expected a whole number from 1 to 7",
        ),
        ("cautious,5,5", "cautious,5,five", "participant P02 (cautious), scale `calm`, item 2"),
        (
            "x2,P02",
            "x2,P01",
            "participant P01 (pre), scale `calm`, item 1: answered twice, in row 1",
        ),
        (
            "intro.1.player.calm_3",
            "intro.1.player.clam_3",
            "scale `calm`: `intro.1.player` has no column for items 3",
        ),
        (
            "intro.1.player.calm_3",
            "intro.1.player.calm_4",
            "`intro.1.player` has no column for items 3",
        ),
        ("x2,P02", "x2,P 02", "P 02"),
        ("x2,P02", "x2,", "row 2"),
    ] {
        let error = fails(from, to);
        assert!(error.contains(said), "{error}");
    }
    let twice = OTREE
        .replace("intro.1.player.calm_1", "drive.2.player.condition,drive.2.player.calm_1")
        .replace("intro.1", "drive.2");
    let twice = twice.replace("P01,0,1", "P01,0,mimic,1").replace("P02,0,7", "P02,0,mimic,7");
    let error = run(Software::Otree, &twice, None).unwrap_err();
    assert!(
        error.contains("P01 (mimic)")
            && error.contains("drive.1.player")
            && error.contains("drive.2.player"),
        "{error}"
    );
    let error = run(Software::Otree, "participant.label,a\nP01,1\n", None).unwrap_err();
    assert!(error.contains("holds no answers") && error.contains("calm_{item}"), "{error}");
}

#[test]
fn a_word_that_is_a_condition_of_the_design_means_it_whatever_else_it_means() {
    let text =
        "[study]\ntitle = \"t\"\n[[condition]]\nid = \"pre\"\n[[condition]]\nid = \"post\"\n";
    let design = Design::from_toml(text).unwrap();
    let columns = Columns::new(None, &[], &design).unwrap();
    let after = Moment::After("pre".parse().unwrap());
    assert_eq!(columns.moment_of("pre").unwrap(), after);
    assert_eq!(columns.moment_of("after:pre").unwrap(), after);
    let papers = DesignFile::paper().unwrap().design;
    let columns = Columns::new(None, &[], &papers).unwrap();
    assert_eq!(columns.moment_of("pre").unwrap(), Moment::Pre);
}

#[test]
fn a_map_renames_columns_words_and_answers() {
    let table = "who;".replace(';', ",") + "q1,q2,q3,car\nP01,never,often,always,A\n";
    let map = "participant = \"who\"\nmoment = \"car\"\n[moments]\nA = \"aggressive\"\n[scales.calm]\ncolumn = \"q{item}\"\nlabels = [\"never\", \"rarely\", \"sometimes\", \"often\", \"usually\", \"almost always\", \"always\"]\n";
    let (_, long) = run(Software::Otree, &table, Some(map)).unwrap();
    assert!(
        long.ends_with(
            "P01,aggressive,calm,1,1\nP01,aggressive,calm,2,4\nP01,aggressive,calm,3,7\n"
        ),
        "{long}"
    );
    for (from, to, said) in [
        ("scales.calm", "scales.clam", "clam"),
        ("\"never\", ", "", "6 labels"),
        ("q{item}", "q", "{item}"),
        ("[moments]", "[momentz]", "momentz"),
    ] {
        let error = run(Software::Otree, &table, Some(&map.replace(from, to))).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn jspsych_trials_become_the_same_table_with_times() {
    let likert = |who: &str, moment: &str, answers: &str| {
        format!(
            r#"{{"trial_type": "survey-likert", "subject": "{who}"{moment}, "rt": 9000, "response": {{{answers}}}}}"#
        )
    };
    let named = likert("P01", "", r#""calm_1": 0, "calm_2": 6, "calm_3": null"#);
    let numbered =
        likert("P01", r#", "scale": "calm", "condition": "mimic""#, r#""Q0": 1, "Q1": 2, "Q2": 3"#);
    let other = r#"{"trial_type": "survey-text", "response": {"Q0": "no remark"}}"#;
    let text = format!("[{named}, {numbered}, {other}]\n");
    let (warnings, table) = run(Software::Jspsych, &text, None).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(
        table,
        "participant,moment,scale,item,answer,seconds\nP01,pre,calm,1,1,3.0\nP01,pre,calm,2,7,3.0\nP01,pre,calm,3,,3.0\n\
         P01,mimic,calm,1,2,3.0\nP01,mimic,calm,2,3,3.0\nP01,mimic,calm,3,4,3.0\n"
    );
    // A condition that the design does not know is left out, counted and named.
    let unknown = text.replace("\"mimic\"", "\"x\"");
    let (warnings, table) = run(Software::Jspsych, &unknown, None).unwrap();
    assert!(warnings[0].contains("3 answers left out: condition `x`"), "{warnings:?}");
    assert_eq!(table.lines().count(), 4);
    // Several sessions: one array each, one after the other or in an array.
    let second = text.replace("P01", "P02");
    for both in [format!("{text}{second}"), format!("[{text},{second}]")] {
        let (_, table) = run(Software::Jspsych, &both, None).unwrap();
        assert_eq!(table.lines().count(), 13);
    }
    for (from, to, said) in [
        (
            "\"calm_2\": 6",
            "\"calm_2\": 7",
            "participant P01 (pre), scale `calm`, item 2 (session 1, trial 1, `calm_2`): found `7`",
        ),
        ("\"calm_2\": 6", "\"calm_2\": \"very\"", "found `very`"),
        ("\"condition\": \"mimic\"", "\"nothing\": 0", "answered twice"),
        ("\"subject\"", "\"sbject\"", "whose"),
        ("]\n", "", "not JSON"),
    ] {
        assert!(text.contains(from), "{from}");
        let error = run(Software::Jspsych, &text.replace(from, to), None).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn the_number_of_a_ride_in_a_name_is_the_persons_own_order() {
    let folder = tempfile::tempdir().unwrap();
    let people = "participant,order\nP01,sporty calm\nP02,\n";
    std::fs::write(folder.path().join("participants.csv"), people).unwrap();
    let map = "[scales.calm]\ncolumn = \"{trial}_Q3_{item}\"\n";
    let table = "participant,1_Q3_1,1_Q3_2,1_Q3_3,2_Q3_1,2_Q3_2,2_Q3_3\nP01,1,2,3,4,5,6\n";
    let go = |table: &str| {
        let options = in_folder(folder.path(), None, table.as_bytes(), Some(map), DESIGN);
        let done = options.run(Watch::unwatched()).map_err(|e| e.to_string());
        done.map(|_| std::fs::read_to_string(options.out.unwrap()).unwrap())
    };
    let long = go(table).unwrap();
    assert_eq!(rows(&long)[0], "P01,calm,calm,1,4");
    assert_eq!(rows(&long)[3], "P01,sporty,calm,1,1");
    let error = go(&table.replace("P01", "P02")).unwrap_err();
    assert!(
        error.contains("row 1 (participant P02): answers about ride 1")
            && error.contains("`order` of 0 conditions"),
        "{error}"
    );
}

#[test]
fn a_proposal_counts_from_zero_lists_words_and_abstains_where_several_columns_fit() {
    let table = |cells: &str| {
        format!("participant,ride,calm_a1,calm_a2,calm_a3\nP01,sporty,{cells}\nP02,calm,{cells}\n")
    };
    let text = suggest(table("0,3,6").as_bytes());
    assert!(
        text.contains("column = \"calm_a{item}\"\nadd = 1   # the answers go from 0 to 6"),
        "{text}"
    );
    assert!(text.contains("\nmoment = \"ride\"\n"), "{text}");
    let (_, long) = mapped(table("0,3,6").as_bytes(), Some(&text)).unwrap();
    assert_eq!(rows(&long)[0], "P01,sporty,calm,1,1");
    let text = suggest(table("never,often,never").as_bytes());
    assert!(
        text.contains(
            "# labels = [\"?\"]   # from the lowest answer; there are \"never\", \"often\""
        ),
        "{text}"
    );
    let text = suggest(table("1,9,1").as_bytes());
    assert!(text.contains("no columns numbered 1 to 3 have such answers"), "{text}");
    let other = table("1,2,3").replace("calm_a", "q");
    let text = suggest(other.as_bytes());
    assert!(
        text.contains("# column = \"q{item}\"") && text.contains("not by their names"),
        "{text}"
    );
}

#[test]
fn the_only_condition_of_a_study_is_known_in_the_names_of_columns() {
    let proposed = |condition: &str, columns: &str| {
        let folder = tempfile::tempdir().unwrap();
        let design = format!("[study]\ntitle = \"t\"\n[[condition]]\nid = \"{condition}\"\n");
        let heads = [1, 2, 3].map(|item| format!("{columns}{item}"));
        let table = format!("participant,{}\nP01,1,2,3\n", heads.join(","));
        let options = Import {
            suggest: true,
            out: None,
            ..in_folder(folder.path(), None, table.as_bytes(), None, &design)
        };
        options.run(Watch::unwatched()).unwrap().summary.join("\n")
    };
    let ride = proposed("ride", "ride_calm_a");
    assert!(
        ride.contains("\ncolumn = \"{condition}_calm_a{item}\"\n") && !ride.contains("moment"),
        "{ride}"
    );
    // A word of the scale's own name is none.
    let own = proposed("calm", "calm_a");
    assert!(own.contains("\ncolumn = \"calm_a{item}\"\n"), "{own}");
}

#[test]
fn a_proposal_is_written_over_a_map_that_is_not_filled_in_alone() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("columns.toml");
    let table = b"participant,condition,calm_1,calm_2,calm_3\nP01,sporty,1,2,3\n";
    let propose = || {
        let import = Import {
            suggest: true,
            out: Some(out.clone()),
            ..in_folder(folder.path(), None, table, None, DESIGN)
        };
        import.run(Watch::unwatched())
    };
    std::fs::write(&out, "# what the columns mean\n\n# sheet = \"Data\"\n").unwrap();
    propose().unwrap();
    assert!(!std::fs::read_to_string(&out).unwrap().contains("Data"));
    std::fs::write(&out, "# mine\nparticipant = \"VP\"\n").unwrap();
    let error = propose().unwrap_err();
    assert!(error.to_string().contains("is filled in already"), "{error}");
    assert!(error.suggestion().unwrap().contains("--out"));
    assert!(std::fs::read_to_string(&out).unwrap().contains("VP"));
}

#[test]
fn a_pattern_that_no_column_has_is_told_from_a_scale_that_nobody_answered() {
    let folder = tempfile::tempdir().unwrap();
    let other = SCALE.replace("calm", "bold");
    let table = b"participant,condition,calm_1,calm_2,calm_3,bold_1,bold_2,bold_3,age\nP01,sporty,1,2,3,,,,30\n";
    let told = |map: &str| {
        let import = in_folder(folder.path(), None, table, Some(map), DESIGN);
        std::fs::write(folder.path().join("scales/bold.toml"), &other).unwrap();
        import.run(Watch::unwatched()).unwrap().warnings.join("\n")
    };
    let bold = "[scales.bold]\ncolumn = \"bold_{item}\"\n";
    let answered = told(bold);
    assert!(answered.contains("scale `bold`: nobody answered it (bold_{item})"), "{answered}");
    let misspelt = told(&bold.replace("bold_", "bald_"));
    assert!(
        misspelt.contains(
            "calls its columns `bald_{item}`, and none is called so; 5 columns belong to no scale"
        ),
        "{misspelt}"
    );
}

#[test]
fn rows_that_end_early_are_counted_and_a_row_of_nobody_is_refused_with_its_column() {
    let head = "participant,condition,calm_1,calm_2,calm_3\n";
    let whole = format!("{head}P01,sporty,1,2,\n\nP02,sporty,1,\"2\n\",\n");
    let (warnings, _) = mapped(whole.as_bytes(), None).unwrap();
    assert!(!warnings.iter().any(|w| w.contains("early")), "{warnings:?}");
    let cut = format!("{head}P01,sporty,1,2\n\nP02,sporty,1\nP03,calm,1,2,3\n");
    let (warnings, table) = mapped(cut.as_bytes(), None).unwrap();
    assert_eq!(
        warnings[0],
        "2 rows end early (row 1 after 4, row 3 after 3 of 5 cells): what they lack counts as not answered"
    );
    assert!(table.contains("P02,sporty,calm,3,\n"), "{table}");
    let nobody = format!("{head}P01,sporty,1,2,3\n ,sporty,1,2,3\n");
    let error = mapped(nobody.as_bytes(), None).unwrap_err();
    assert!(
        error.contains("row 2: column `participant`") && error.contains("take the row out"),
        "{error}"
    );
}

#[test]
fn a_workbook_is_read_by_the_name_of_its_sheet() {
    let answers: &[&[&str]] = &[
        &["participant", "condition", "calm_1", "calm_2", "calm_3"],
        &["P01", "sporty", "1", "2", ""],
    ];
    let (_, table) = mapped(&workbook(&[("Sheet1", answers)]), None).unwrap();
    assert_eq!(rows(&table), ["P01,sporty,calm,1,1", "P01,sporty,calm,2,2", "P01,sporty,calm,3,"]);
    let two = workbook(&[("Notes", &[&["written by hand"]]), ("Data", answers), ("Empty", &[])]);
    let error = mapped(&two, None).unwrap_err();
    assert!(
        error.contains("has 2 sheets with something in them")
            && error.contains("its sheets are Notes, Data, Empty"),
        "{error}"
    );
    let (_, same) = mapped(&two, Some("sheet = \"Data\"\n")).unwrap();
    assert_eq!(same, table);
    let error = mapped(&two, Some("sheet = \"Date\"\n")).unwrap_err();
    assert!(error.contains("has no sheet `Date`; its sheets are Notes, Data, Empty"), "{error}");
    let error = mapped(b"PK\x03\x04 and nothing else", None).unwrap_err();
    assert!(error.contains("is no workbook (.xlsx) that can be read"), "{error}");
    let error = mapped(QUALTRICS.as_bytes(), Some("sheet = \"Data\"\n")).unwrap_err();
    assert!(error.contains("it is no workbook"), "{error}");
    // The three heads of Qualtrics stand in its workbooks too.
    let lines: Vec<Vec<&str>> = vec![
        vec!["ResponseId", "calm_calm_1", "calm_calm_2", "calm_calm_3"],
        vec!["Response ID", "a", "b", "c"],
        vec![
            "{\"ImportId\":\"_recordId\"}",
            "{\"ImportId\":\"QID1_1\"}",
            "{\"ImportId\":\"QID1_2\"}",
            "{\"ImportId\":\"QID1_3\"}",
        ],
        vec!["R_1", "7", "6", "5"],
    ];
    let lines: Vec<&[&str]> = lines.iter().map(Vec::as_slice).collect();
    let (_, table) = mapped(&workbook(&[("Sheet1", &lines)]), Some(BY_NAME)).unwrap();
    assert_eq!(rows(&table), ["R_1,calm,calm,1,7", "R_1,calm,calm,2,6", "R_1,calm,calm,3,5"]);
}

#[test]
fn a_column_whose_name_stands_twice_is_refused() {
    let error =
        mapped(b"participant,calm_1,calm_2,calm_3,calm_3\nP01,1,2,3,4\n", None).unwrap_err();
    assert!(error.contains("both `calm_3` and `calm_3 (column 5)` hold it"), "{error}");
}

#[test]
fn a_dot_in_the_name_of_a_column_is_read_by_a_pattern_that_has_it() {
    let three = |name: &str| [1, 2, 3].map(|item| name.replace('#', &item.to_string())).join(",");
    for (name, pattern, moment) in [
        ("calm.#", "calm.{item}", "pre"),
        ("calm_#.sporty", "calm_{item}.{condition}", "sporty"),
        ("sporty.calm_#", "{condition}.calm_{item}", "sporty"),
        ("rating_sporty.1.player.calm_#", "rating_{condition}.1.player.calm_{item}", "sporty"),
    ] {
        let table = format!("participant,{}\nP01,1,2,3\n", three(name));
        let map = format!("[scales.calm]\ncolumn = \"{pattern}\"\n");
        let (warnings, long) = mapped(table.as_bytes(), Some(&map)).unwrap();
        assert_eq!(rows(&long)[2], format!("P01,{moment},calm,3,3"), "{name}");
        assert!(warnings.is_empty(), "{name}: {warnings:?}");
    }
    let dotted = format!("participant,{}\nP01,1,2,3\n", three("calm.#"));
    let text = suggest(dotted.as_bytes());
    assert!(text.contains("\ncolumn = \"calm.{item}\"\n"), "{text}");
    let (_, long) = mapped(dotted.as_bytes(), Some(&text)).unwrap();
    assert_eq!(rows(&long)[0], "P01,pre,calm,1,1");
}

#[test]
fn a_page_that_is_called_like_a_condition_is_told_where_nothing_says_when() {
    let page = |name: &str| {
        let items = [1, 2, 3].map(|item| format!("{name}.1.player.calm_{item}"));
        format!("participant.label,{}\nP01,1,2,3\n", items.join(","))
    };
    let (warnings, long) = mapped(page("rating_sporty").as_bytes(), None).unwrap();
    assert_eq!(rows(&long)[0], "P01,pre,calm,1,1");
    assert!(
        warnings[0].contains("`rating_sporty.1.player` has `sporty` in its name"),
        "{warnings:?}"
    );
    let (warnings, _) = mapped(page("intro").as_bytes(), None).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let said = page("rating_sporty").replace(
        "rating_sporty.1.player.calm_1",
        "rating_sporty.1.player.condition,rating_sporty.1.player.calm_1",
    );
    let said = said.replace("P01,", "P01,calm,");
    let (warnings, long) = mapped(said.as_bytes(), None).unwrap();
    assert_eq!(rows(&long)[0], "P01,calm,calm,1,1");
    assert!(warnings.is_empty(), "{warnings:?}");
    // Two of them would both be from before the drives.
    let [first, second] = ["rating_sporty", "rating_calm"].map(page);
    let second = second.replace("participant.label,", "");
    let both: Vec<String> = first
        .lines()
        .zip(second.lines())
        .map(|(a, b)| format!("{a},{}", b.trim_start_matches("P01,")))
        .collect();
    let error = mapped(both.join("\n").as_bytes(), None).unwrap_err();
    assert!(error.contains("answered twice") && error.contains("{condition}"), "{error}");
}

#[test]
fn a_pattern_of_whole_names_keeps_the_moment_of_its_page() {
    let read = |condition: &str, pattern: &str| {
        let table = OTREE.replace("drive.1.player.condition", condition);
        let map = format!("[scales.calm]\ncolumn = \"{pattern}\"\n");
        let (_, long) = run(Software::Otree, &table, Some(&map)).unwrap();
        rows(&long)[0].to_owned()
    };
    let [of_page, whole] = ["drive.1.player.condition", "drive.1.player.calm_{item}"];
    assert_eq!(read(of_page, whole), "P01,mimic,calm,1,4");
    // Nothing says it on that page.
    assert_eq!(read("remark", whole), "P01,pre,calm,1,4");
    assert_eq!(read("intro.1.player.condition", whole), "P01,pre,calm,1,4");
    // A pattern that names the moment goes before the page.
    let named = OTREE.replace("drive.1.player.calm", "drive_cautious.1.player.calm");
    let map = "[scales.calm]\ncolumn = \"drive_{condition}.1.player.calm_{item}\"\n";
    let (_, long) = run(Software::Otree, &named, Some(map)).unwrap();
    assert_eq!(rows(&long)[0], "P01,cautious,calm,1,4");
}

#[test]
fn a_moment_that_a_map_names_whole_holds_for_pages_that_have_none() {
    for moment in ["ride", "my.ride"] {
        let read = |page: &str| {
            let table = format!(
                "participant,{moment},rating.calm_1,rating.calm_2,rating.calm_3{}\nP01,sporty,1,2,3{}\n",
                if page.is_empty() { "" } else { ",rating.ride" },
                if page.is_empty() { "" } else { ",calm" },
            );
            let map = format!("moment = \"{moment}\"\n");
            let (_, long) = mapped(table.as_bytes(), Some(&map)).unwrap();
            rows(&long)[0].to_owned()
        };
        assert_eq!(read(""), "P01,sporty,calm,1,1", "{moment}");
        // The page's own goes before it.
        let own = if moment == "ride" { "calm" } else { "sporty" };
        assert_eq!(read("own"), format!("P01,{own},calm,1,1"), "{moment}");
    }
}

#[test]
fn the_column_that_a_map_names_for_the_moment_has_to_be_there_and_may_have_a_dot() {
    let table = b"participant,my.ride,calm_1,calm_2,calm_3\nP01,sporty,1,2,3\n";
    let (_, long) = mapped(table, Some("moment = \"my.ride\"\n")).unwrap();
    assert_eq!(rows(&long)[0], "P01,sporty,calm,1,1");
    let error = mapped(table, Some("moment = \"my.rde\"\n")).unwrap_err();
    assert!(error.contains("no column `my.rde`"), "{error}");
}

#[test]
fn whose_answers_about_an_unknown_condition_were_left_out_is_listed() {
    let folder = tempfile::tempdir().unwrap();
    let listed = |text: &str| {
        let from = Some(Software::Otree);
        let options = in_folder(folder.path(), from, text.as_bytes(), None, "paper.toml");
        let done = options.run(Watch::unwatched()).unwrap();
        let list = exclusions_path(options.out.as_ref().unwrap());
        (done.summary, std::fs::read_to_string(list).unwrap())
    };
    let (summary, list) = listed(&OTREE.replace("cautious", "kautious"));
    assert!(summary.contains(&"3 answers left out by unknown condition".to_owned()), "{summary:?}");
    assert_eq!(list.lines().count(), 2, "{list}");
    assert!(
        list.contains("P02,answers (kautious),")
            && list.contains("`kautious` is none of the design's"),
        "{list}"
    );
    let (_, list) = listed(OTREE);
    assert_eq!(list.lines().count(), 1, "{list}");
    // Where nothing else was answered, it is said why there is nothing.
    let jam = b"participant,condition,calm_1,calm_2,calm_3\nP01,jam,1,2,3\n";
    let error = mapped(jam, None).unwrap_err();
    assert!(error.contains("3 answers left out by unknown condition"), "{error}");
}

#[test]
fn a_map_that_means_a_condition_which_the_study_does_not_have_is_refused() {
    let table = b"participant,K_calm_1,K_calm_2,K_calm_3\nP01,1,2,3\n";
    let map = |meaning: &str| format!("[moments]\nK = \"{meaning}\"\n{BY_NAME}");
    assert!(mapped(table, Some(&map("sporty"))).is_ok());
    let error = mapped(table, Some(&map("spotry"))).unwrap_err();
    assert!(
        error.contains(
            "[moments] `K`: `spotry` is no condition of the study, which has calm, sporty"
        ),
        "{error}"
    );
    let error = mapped(table, Some("[scales.calm]\nmoment = \"clam\"\n")).unwrap_err();
    assert!(error.contains("[scales.calm] `moment`: `clam`"), "{error}");
}

#[test]
fn a_jspsych_trial_of_an_unknown_scale_and_a_sheet_without_some_items_are_told() {
    let trial = |moment: &str, scale: &str, answers: &str| {
        format!(
            r#"{{"trial_type": "survey-likert", "subject": "P01", "condition": "{moment}", "scale": "{scale}", "response": {{{answers}}}}}"#
        )
    };
    let whole = r#""Q0": 1, "Q1": 2, "Q2": 3"#;
    let go = |second: String| {
        let text = format!("[{}, {second}]", trial("mimic", "calm", whole));
        run(Software::Jspsych, &text, None).map(|(warnings, _)| warnings)
    };
    assert_eq!(go(trial("cautious", "calm", whole)), Ok(Vec::new()), "nothing to tell");
    assert_eq!(
        go(trial("cautious", "clam", whole)).unwrap(),
        ["trial 2 of session 1: its `scale` is `clam`, which is none of the study's: not read"]
    );
    let short = r#""Q0": 1, "Q1": 2"#;
    assert_eq!(
        go(trial("cautious", "calm", short)).unwrap(),
        ["sheet P01 (cautious): scale `calm` without items 3, which count as not answered"]
    );
    let alone = format!("[{}]", trial("mimic", "calm", short));
    let error = run(Software::Jspsych, &alone, None).unwrap_err();
    assert!(error.contains("scale `calm`: no trial asks items 3"), "{error}");
}

#[test]
fn a_formula_of_which_a_workbook_has_no_value_is_no_answer_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let read = |word: &str| {
        let rows: [&[&str]; 2] = [&["participant", "why_1"], &["P01", word]];
        let book = workbook(&[("Sheet1", &rows)]);
        let options = in_folder(folder.path(), None, &book, None, DESIGN);
        let why = "id = \"why\"\ntitle = \"Why\"\nreference = \"made up\"\n[[item]]\ntext = \"Why?\"\nkind = \"text\"\n";
        std::fs::write(folder.path().join("scales/why.toml"), why).unwrap();
        let done = options.run(Watch::unwatched());
        done.map_err(|e| e.to_string())?;
        Ok::<_, String>(std::fs::read_to_string(options.out.unwrap()).unwrap())
    };
    let error = read("=A2").unwrap_err();
    assert!(error.contains("item 1 (row 1, `why_1`): found a formula"), "{error}");
    for (given, said) in [("calm", ",calm"), ("=1+2#3", ",3")] {
        let table = read(given).unwrap();
        assert!(rows(&table)[0].contains(said), "{table}");
    }
}

#[test]
fn a_formula_of_which_a_workbook_has_no_value_is_no_missing_answer() {
    let book = |last: &str| {
        let rows: [&[&str]; 2] = [
            &["participant", "condition", "calm_1", "calm_2", "calm_3", "sum"],
            &["P01", "sporty", "1", "2", last, "=C2+D2"],
        ];
        mapped(&workbook(&[("Sheet1", &rows)]), None)
    };
    let error = book("=1+2").unwrap_err();
    assert!(
        error.contains("item 3 (row 1, `calm_3`): found a formula") && error.contains("save it"),
        "{error}"
    );
    for last in ["=1+2#3", "3"] {
        let (_, table) = book(last).unwrap();
        assert_eq!(rows(&table)[2], "P01,sporty,calm,3,3");
    }
}

#[test]
fn a_word_for_no_answer_is_no_text_and_an_answer_between_two_steps_is_told_by_the_step() {
    let folder = tempfile::tempdir().unwrap();
    let scale = "id = \"calm\"\ntitle = \"Calm\"\nreference = \"made up\"\n\
                 [[item]]\ntext = \"How calm?\"\nkind = \"slider\"\nmin = 0\nmax = 100\nstep = 5\nanchors = [\"low\", \"high\"]\n\
                 [[item]]\ntext = \"Why?\"\nkind = \"text\"\n";
    let go = |number: &str, words: &str| {
        let table = format!("participant,calm_1,calm_2\nP01,{number},{words}\n");
        let map = "missing = [\"-99\"]\n";
        let options = in_folder(folder.path(), None, table.as_bytes(), Some(map), DESIGN);
        std::fs::write(folder.path().join("scales/calm.toml"), scale).unwrap();
        let done = options.run(Watch::unwatched()).map_err(|e| e.to_string())?;
        let table = std::fs::read_to_string(options.out.unwrap()).unwrap();
        Ok::<_, String>((done.summary[0].clone(), table))
    };
    let (summary, table) = go("95", "-99").unwrap();
    assert!(summary.starts_with("1 answers of"), "{summary}");
    assert!(!table.contains("-99"), "{table}");
    let (summary, table) = go("95", "no traffic").unwrap();
    assert!(summary.starts_with("2 answers of"), "{summary}");
    assert!(table.contains("no traffic"), "{table}");
    let error = go("7", "").unwrap_err();
    assert!(error.contains("found `7`, expected a whole number from 0 to 100 by 5"), "{error}");
}

#[test]
fn columns_that_are_called_as_by_convention_beside_those_of_a_pattern_are_told() {
    let table = "participant,calm_1,calm_2,calm_3,sporty_calm_1,sporty_calm_2,sporty_calm_3\nP01,1,2,3,4,5,6\n";
    let (warnings, long) = mapped(table.as_bytes(), Some(BY_NAME)).unwrap();
    assert_eq!(rows(&long)[0], "P01,sporty,calm,1,4");
    assert!(
        warnings[0].contains("`calm_1` to `calm_3` were not read")
            && warnings[0].contains("`{condition}_calm_{item}`"),
        "{warnings:?}"
    );
    let named = table.replace(",calm_", ",pre_calm_");
    let (warnings, long) = mapped(named.as_bytes(), Some(BY_NAME)).unwrap();
    assert!(warnings.is_empty() && long.contains("P01,pre,calm,1,1"));
}

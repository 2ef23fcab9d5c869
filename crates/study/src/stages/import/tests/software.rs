//! Exports that are known by their head: Qualtrics, LimeSurvey, SoSci Survey; and what each is told.

use super::*;

#[test]
fn qualtrics_three_heads_are_known_and_a_preview_is_nobodys_answer() {
    let (warnings, table) = mapped(QUALTRICS.as_bytes(), Some(BY_NAME)).unwrap();
    assert_eq!(
        rows(&table),
        [
            "P01,calm,calm,1,1",
            "P01,calm,calm,2,2",
            "P01,calm,calm,3,3",
            "P01,sporty,calm,1,7",
            "P01,sporty,calm,2,6",
            "P01,sporty,calm,3,"
        ]
    );
    assert_eq!(warnings, ["1 row of previews and tests: left out"]);
    let text = suggest(QUALTRICS.as_bytes());
    for line in [
        "software = \"qualtrics\"",
        "# participant = \"ExternalReference\"   # by convention: 2 different ones",
        "column = \"{condition}_calm_{item}\"",
    ] {
        assert!(text.contains(line), "{text}");
    }
    let (_, again) = mapped(QUALTRICS.as_bytes(), Some(&text)).unwrap();
    assert_eq!(again, table);
    // A table that Qualtrics wrote is not read as another's.
    let error = read(Some(Software::Sosci), QUALTRICS.as_bytes(), None, DESIGN).unwrap_err();
    assert!(
        error.contains("is of Qualtrics by its head, not of SoSci Survey")
            && error.contains("software = \"qualtrics\""),
        "{error}"
    );
}

/// LimeSurvey's headings by question code, as its Writer.php makes them: sub-questions in brackets; with code and text both, the text
/// behind a full stop.
const LIMESURVEY: &str = "\"id\",\"submitdate\",\"lastpage\",\"startlanguage\",\"seed\",\"token\",\"KTLX[SQ001]\",\"KTLX[SQ002]\",\"KTLX[SQ003]\",\"STLX[SQ001]. Was it calm?\",\"STLX[SQ002]. And now?\",\"STLX[SQ003]. And then?\"\n\
    \"1\",\"2026-01-01 10:00:00\",\"3\",\"de\",\"1\",\"P01\",\"1\",\"2\",\"3\",\"4\",\"5\",\"6\"\n\
    \"2\",\"\",\"1\",\"de\",\"1\",\"P02\",\"7\",\"N/A\",\"7\",\"\",\"\",\"\"\n";

#[test]
fn limesurveys_codes_name_condition_and_item() {
    let map = "[moments]\nK = \"calm\"\nS = \"sporty\"\n[scales.calm]\ncolumn = \"{condition}TLX[SQ{item}]\"\n";
    let (warnings, table) = mapped(LIMESURVEY.as_bytes(), Some(map)).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(
        rows(&table),
        [
            "P01,calm,calm,1,1",
            "P01,calm,calm,2,2",
            "P01,calm,calm,3,3",
            "P01,sporty,calm,1,4",
            "P01,sporty,calm,2,5",
            "P01,sporty,calm,3,6",
            "P02,calm,calm,1,7",
            "P02,calm,calm,2,",
            "P02,calm,calm,3,7"
        ]
    );
    for (from, to, expected) in [
        ("K = \"calm\"", "C = \"calm\"", "no column has `C`, for which [moments]"),
        ("K = \"calm\"\nS", "K", "2 words"),
    ] {
        let result = mapped(LIMESURVEY.as_bytes(), Some(&map.replacen(from, to, 1)));
        if expected == "2 words" {
            // `S` means nothing now: said, and not read.
            let (warnings, table) = result.unwrap();
            assert!(
                warnings[0].contains("3 columns not read: `S`")
                    && !table.contains("P01,calm,calm,1,1"),
                "{warnings:?}"
            );
        } else {
            let error = result.unwrap_err();
            assert!(error.contains(expected) && error.contains("`K`"), "{error}");
        }
    }
    let none = map.replace("K = \"calm\"\nS = \"sporty\"\n", "");
    let error = mapped(LIMESURVEY.as_bytes(), Some(&none)).unwrap_err();
    assert!(error.contains("there are `K`, `S`, expected calm, sporty"), "{error}");
}

#[test]
fn a_pattern_that_matches_one_condition_only_is_not_taken_for_before_the_drives() {
    let map = "[scales.calm]\ncolumn = \"KTLX[SQ{item}]\"\n";
    let error = mapped(LIMESURVEY.as_bytes(), Some(map)).unwrap_err();
    assert!(
        error.contains("`KTLX[SQ{item}]` names the columns of one moment only")
            && error.contains("moment = \"pre\""),
        "{error}"
    );
    // Where it is said, it is what is meant.
    let said = format!("{map}moment = \"pre\"\n");
    let (_, table) = mapped(LIMESURVEY.as_bytes(), Some(&said)).unwrap();
    assert_eq!(rows(&table)[0], "P01,pre,calm,1,1");
    // What no other columns are like is from before the drives, as it always was.
    let alone = LIMESURVEY.replace("STLX", "AGE");
    assert!(mapped(alone.as_bytes(), Some(map)).is_ok());
}

#[test]
fn limesurveys_proposal_abstains_where_a_letter_may_be_a_condition() {
    let text = suggest(LIMESURVEY.replace("TLX", "calm").as_bytes());
    assert!(
        text.contains("# column = \"{condition}calm[SQ{item}]\"")
            && text.contains("# [moments]   # ?")
            && text.contains("\n# K = \"?\"\n# S = \"?\"\n"),
        "{text}"
    );
    let sure = text.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    assert_eq!(sure.count(), 0, "{text}");
    // Filled in, its comments are the map.
    let map = text.replace("K = \"?\"", "K = \"calm\"").replace("S = \"?\"", "S = \"sporty\"");
    let meant = |line: &&str| {
        ["# [", "# K", "# S", "# column = \"{"].iter().any(|start| line.starts_with(start))
            && !line.contains("[files]")
    };
    let map: String = map.lines().filter(meant).map(|line| line[2..].to_owned() + "\n").collect();
    let answers = LIMESURVEY.replace("TLX", "calm");
    let (_, table) = mapped(answers.as_bytes(), Some(&map)).unwrap();
    assert!(table.contains("P01,sporty,calm,1,4"), "{table}");
    // Headings by the texts of the questions name no item.
    let texts = "Response ID,Date submitted,Was it calm? [1]\n1,2026-01-01,3\n";
    let error = mapped(texts.as_bytes(), None).unwrap_err();
    assert!(error.contains("Headings, Question code"), "{error}");
}

/// SoSci Survey's data: CASE, SERIAL, REF, QUESTNNR, MODE, STARTED, the items by code, a second head with their texts (as its downloads for
/// spreadsheets have it), -9 for no answer (soscisurvey.de/help, results:variables and results:values).
const SOSCI: &str = "CASE\tSERIAL\tREF\tQUESTNNR\tMODE\tSTARTED\tCA01_01\tCA01_02\tCA01_03\tFINISHED\n\
    Interview-Nummer (fortlaufend)\tPersonenkennung oder Teilnahmecode\tReferenz\tFragebogen\tInterview-Modus\tZeitpunkt\tRuhig: größer\tb\tc\tWurde die Befragung abgeschlossen\n\
    40\t\t\tcalm\tpretest\t2026-01-01\t1\t1\t1\t1\n\
    41\tP01\t\tbase\tinterview\t2026-01-01\t1\t2\t-9\t1\n\
    42\tP01\t\tsporty\tinterview\t2026-01-01\t7\t7\t-1\t1\n";

#[test]
fn soscis_codes_are_read_from_utf_16_and_its_questionnaire_says_when() {
    let map = "[moments]\nbase = \"pre\"\n[scales.calm]\ncolumn = \"CA01_{item}\"\n";
    let units = std::iter::once(0xfeff_u16).chain(SOSCI.encode_utf16());
    let utf_16: Vec<u8> = units.flat_map(u16::to_le_bytes).collect();
    let (warnings, table) = mapped(&utf_16, Some(map)).unwrap();
    assert_eq!(
        rows(&table),
        [
            "P01,pre,calm,1,1",
            "P01,pre,calm,2,2",
            "P01,pre,calm,3,",
            "P01,sporty,calm,1,7",
            "P01,sporty,calm,2,7",
            "P01,sporty,calm,3,"
        ]
    );
    assert_eq!(warnings, ["1 row of pretests: left out"]);
    let (warnings, same) = mapped(&encoding_rs::WINDOWS_1252.encode(SOSCI).0, Some(map)).unwrap();
    assert_eq!(same, table);
    assert!(warnings[0].contains("Windows-1252"), "{warnings:?}");
    // Two questionnaires of which nothing says when they were answered.
    let error =
        mapped(SOSCI.as_bytes(), Some("[scales.calm]\ncolumn = \"CA01_{item}\"\n")).unwrap_err();
    assert!(
        error.contains("`QUESTNNR` has base, calm, sporty, and `base` is no condition"),
        "{error}"
    );
    let mac = encoding_rs::MACINTOSH.encode(SOSCI).0;
    let error = mapped(&mac, Some(map)).unwrap_err();
    assert!(
        error.contains("cannot be told") && error.contains("encoding = \"macintosh\""),
        "{error}"
    );
    let (_, same) = mapped(&mac, Some(&format!("encoding = \"macintosh\"\n{map}"))).unwrap();
    assert_eq!(same, table);
}

#[test]
fn soscis_questionnaire_says_when_in_a_download_of_one_alone_too() {
    let one = "CASE\tSERIAL\tREF\tQUESTNNR\tMODE\tCA01_01\tCA01_02\tCA01_03\n41\tP01\t\tnachK\tinterview\t1\t2\t3\n";
    let scale = "[scales.calm]\ncolumn = \"CA01_{item}\"\n";
    let map = format!("[moments]\nnachK = \"calm\"\n{scale}");
    let (warnings, table) = mapped(one.as_bytes(), Some(&map)).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(rows(&table)[0], "P01,calm,calm,1,1");
    // A word that means nothing: from before the drives, as far as anybody knows, and told.
    let (warnings, table) = mapped(one.as_bytes(), Some(scale)).unwrap();
    assert_eq!(rows(&table)[0], "P01,pre,calm,1,1");
    assert!(warnings[0].contains("column `QUESTNNR` has `nachK` alone"), "{warnings:?}");
}

#[test]
fn every_kind_of_preview_is_nobodys_answer_and_possible_spam_is_told() {
    let with = |status: &str| {
        let text = QUALTRICS.replacen("08:28:48,1,100", &format!("08:28:48,{status},100"), 1);
        let (warnings, table) = mapped(text.as_bytes(), Some(BY_NAME)).unwrap();
        (warnings, table.contains("P00,"))
    };
    for status in
        ["2", "9", "17", "256", "Survey Preview Spam", "Offline Survey Preview", "Synthetic"]
    {
        let (warnings, is_there) = with(status);
        assert!(!is_there, "{status}");
        assert_eq!(warnings, ["1 row of previews and tests: left out"]);
    }
    for status in ["0", "4", "16", "IP Address"] {
        assert_eq!(with(status), (Vec::new(), true), "{status}");
    }
    for status in ["8", "12", "Spam"] {
        let (warnings, is_there) = with(status);
        assert!(is_there, "{status}");
        assert_eq!(warnings, ["1 row of possible spam by `Status` (row 1): read like the others"]);
    }
}

#[test]
fn limesurveys_own_columns_may_have_their_texts_behind_their_codes() {
    let text = "\"id. Response ID\",\"submitdate. Date submitted\",\"lastpage. Last page\",\"token. Token\",\"calm[1]. Was it calm?\",\"calm[2]. And now?\",\"calm[3]. And then?\"\n\
                \"1\",\"2026-01-01 10:00:00\",\"3\",\"P01\",\"1\",\"2\",\"3\"\n";
    let map = "[scales.calm]\ncolumn = \"calm[{item}]\"\n";
    let (_, table) = mapped(text.as_bytes(), Some(map)).unwrap();
    assert_eq!(rows(&table)[0], "P01,pre,calm,1,1");
    for name in ["id", "id. Response ID"] {
        let by_id = format!("participant = \"{name}\"\n{map}");
        let (_, table) = mapped(text.as_bytes(), Some(&by_id)).unwrap();
        assert_eq!(rows(&table)[0], "1,pre,calm,1,1");
    }
    // What others put behind a full stop is no code.
    let wide = "token. Token,calm_1,calm_2,calm_3\nP01,1,2,3\n";
    let error = mapped(wide.as_bytes(), None).unwrap_err();
    assert!(error.contains("no column `participant`"), "{error}");
}

/// A study whose answers are these bytes, its design with these keys under `[files]`.
fn study_of(folder: &Path, files: &str, answers: &[u8]) -> DesignFile {
    std::fs::write(folder.join("answers"), answers).unwrap();
    let design = format!("{DESIGN}[files]\nanswers = \"answers\"\n{files}");
    std::fs::write(folder.join("study.toml"), design).unwrap();
    DesignFile::read(&folder.join("study.toml")).unwrap()
}

#[test]
fn an_export_of_which_the_design_does_not_say_what_wrote_it_is_told_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let told = |files: &str, answers: &[u8]| {
        let error = refuse_export(&study_of(folder.path(), files, answers)).err()?;
        Some(format!("{error}; {}", error.suggestion().unwrap_or_default()))
    };
    for (answers, title, id) in [
        (OTREE.as_bytes(), "an export of oTree", "otree"),
        (LIMESURVEY.as_bytes(), "an export of LimeSurvey", "limesurvey"),
        (b"[{\"trial_type\": \"survey-likert\"}]", "an export of jsPsych", "jspsych"),
        (b"who,calm_1\nP01,1\n", "another table", "wide"),
    ] {
        let error = told("", answers).unwrap();
        assert!(
            error.contains(title) && error.contains(&format!("software = \"{id}\"")),
            "{error}"
        );
        assert_eq!(told(&format!("software = \"{id}\"\n"), answers), None);
    }
    assert_eq!(told("", b"participant,moment,scale,item,answer\nP01,pre,calm,1,1\n"), None);
}

#[test]
fn whose_rows_an_export_has_is_known_in_every_file() {
    let folder = tempfile::tempdir().unwrap();
    let utf_16: Vec<u8> = SOSCI.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let book = workbook(&[(
        "Sheet1",
        &[&["token", "id", "submitdate", "lastpage"], &["P01", "1", "2026", "3"]],
    )]);
    for (software, answers, column) in [
        ("qualtrics", QUALTRICS.as_bytes(), "ExternalReference"),
        ("sosci", &utf_16, "SERIAL"),
        ("limesurvey", &book, "token"),
        ("otree", OTREE.as_bytes(), "participant.label"),
    ] {
        let study = study_of(folder.path(), &format!("software = \"{software}\"\n"), answers);
        assert_eq!(column_of_people(&study).unwrap().as_deref(), Some(column));
        assert!(has_row_of(&study, &"P01".to_owned().try_into().unwrap()).unwrap(), "{software}");
        assert!(!has_row_of(&study, &"P09".to_owned().try_into().unwrap()).unwrap(), "{software}");
    }
}

//! Exports of each software, from file to table.

mod workbook;

use super::*;
use crate::DesignFile;
use maveric_domain::Moment;
use workbook::workbook;

const SCALE: &str = "id = \"calm\"\ntitle = \"Calmness\"\nreference = \"made up\"\nitems = 3\nmin = 1\nmax = 7\nscoring = \"mean\"\nreversed = [2]\n[[subscales]]\nid = \"calm\"\ntitle = \"Calmness\"\nitems = [1, 2, 3]\n";

/// Imports `text`; gives what was said and the table written.
fn run(from: Software, text: &str, map: Option<&str>) -> Result<(Vec<String>, String), String> {
    read(Some(from), text.as_bytes(), map, "paper.toml")
}

/// Imports the bytes of a file by the shipped design of a name.
fn read(
    from: Option<Software>,
    bytes: &[u8],
    map: Option<&str>,
    design: &str,
) -> Result<(Vec<String>, String), String> {
    let folder = tempfile::tempdir().unwrap();
    let options = in_folder(folder.path(), from, bytes, map, design);
    let done = options.run(Watch::unwatched());
    let done = done.map_err(|e| [e.to_string(), e.suggestion().unwrap_or_default()].join("\n"))?;
    let table = options
        .out
        .as_ref()
        .map(|out| std::fs::read_to_string(out).unwrap());
    Ok((
        done.warnings,
        table.unwrap_or_else(|| done.summary.join("\n")),
    ))
}
const OTREE: &str = "participant.code,participant.label,participant._is_bot,intro.1.player.calm_1,intro.1.player.calm_2,intro.1.player.calm_3,drive.1.player.condition,drive.1.player.calm_1,drive.1.player.calm_2,drive.1.player.calm_3,drive.1.player.remark\n\
    x1,P01,0,1,2,3,mimic,4,,6,\"nice, but slow\"\n\
    x2,P02,0,7,7,6,cautious,5,5,5,\n\
    x3,,1,1,1,1,mimic,1,1,1,\n\
    x4,P04,0,,,,,,,,\n";

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
        (
            "cautious,5,5",
            "cautious,5,five",
            "participant P02 (cautious), scale `calm`, item 2",
        ),
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
        .replace(
            "intro.1.player.calm_1",
            "drive.2.player.condition,drive.2.player.calm_1",
        )
        .replace("intro.1", "drive.2");
    let twice = twice
        .replace("P01,0,1", "P01,0,mimic,1")
        .replace("P02,0,7", "P02,0,mimic,7");
    let error = run(Software::Otree, &twice, None).unwrap_err();
    assert!(
        error.contains("P01 (mimic)")
            && error.contains("drive.1.player")
            && error.contains("drive.2.player"),
        "{error}"
    );
    let error = run(Software::Otree, "participant.label,a\nP01,1\n", None).unwrap_err();
    assert!(
        error.contains("holds no answers") && error.contains("calm_{item}"),
        "{error}"
    );
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
    let numbered = likert(
        "P01",
        r#", "scale": "calm", "condition": "mimic""#,
        r#""Q0": 1, "Q1": 2, "Q2": 3"#,
    );
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
    assert!(
        warnings[0].contains("3 answers left out: condition `x`"),
        "{warnings:?}"
    );
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
        (
            "\"condition\": \"mimic\"",
            "\"nothing\": 0",
            "answered twice",
        ),
        ("\"subject\"", "\"sbject\"", "whose"),
        ("]\n", "", "not JSON"),
    ] {
        assert!(text.contains(from), "{from}");
        let error = run(Software::Jspsych, &text.replace(from, to), None).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}

/// The import of a file in a folder with its scales: `paper.toml` is the paper's design, anything else the text of one.
fn in_folder(
    folder: &Path,
    from: Option<Software>,
    bytes: &[u8],
    map: Option<&str>,
    design: &str,
) -> Import {
    let scales = folder.join("scales");
    std::fs::create_dir_all(&scales).unwrap();
    std::fs::write(scales.join("calm.toml"), SCALE).unwrap();
    let write = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.join(name), bytes).unwrap();
        folder.join(name)
    };
    Import {
        file: write("export", bytes),
        from,
        design: (design != "paper.toml").then(|| write("study.toml", design.as_bytes())),
        columns: map.map(|map| write("map.toml", map.as_bytes())),
        sheet: None,
        scales,
        suggest: false,
        out: Some(folder.join("surveys.csv")),
    }
}

/// A study of two conditions.
const DESIGN: &str =
    "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n";

/// What `--suggest` prints of a file.
fn suggest(bytes: &[u8], design: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let options = Import {
        suggest: true,
        out: None,
        ..in_folder(folder.path(), None, bytes, None, design)
    };
    let done = options.run(Watch::unwatched()).unwrap();
    done.summary.join("\n")
}

/// The rows of a table after its head.
fn rows(table: &str) -> Vec<&str> {
    table.lines().skip(1).collect()
}

/// Qualtrics' three heads, as the sample of the R package qualtRics has them (tests/testthat/files/sample.csv): the names of a matrix have
/// the number of the statement behind them, and a preview has the status 1.
const QUALTRICS: &str = "StartDate,EndDate,Status,Progress,Finished,ResponseId,ExternalReference,DistributionChannel,calm_calm_1,calm_calm_2,calm_calm_3,sporty_calm_1,sporty_calm_2,sporty_calm_3\n\
    Start Date,End Date,Response Type,Progress,Finished,Response ID,External Data Reference,Distribution Channel,\"How calm, after the calm drive? - 1\",2,3,1,2,3\n\
    \"{\"\"ImportId\"\":\"\"startDate\"\",\"\"timeZone\"\":\"\"Europe/Berlin\"\"}\",\"{\"\"ImportId\"\":\"\"endDate\"\"}\",\"{\"\"ImportId\"\":\"\"status\"\"}\",\"{\"\"ImportId\"\":\"\"progress\"\"}\",\"{\"\"ImportId\"\":\"\"finished\"\"}\",\"{\"\"ImportId\"\":\"\"_recordId\"\"}\",\"{\"\"ImportId\"\":\"\"externalDataReference\"\"}\",\"{\"\"ImportId\"\":\"\"distributionChannel\"\"}\",\"{\"\"ImportId\"\":\"\"QID1_1\"\"}\",\"{\"\"ImportId\"\":\"\"QID1_2\"\"}\",\"{\"\"ImportId\"\":\"\"QID1_3\"\"}\",\"{\"\"ImportId\"\":\"\"QID2_1\"\"}\",\"{\"\"ImportId\"\":\"\"QID2_2\"\"}\",\"{\"\"ImportId\"\":\"\"QID2_3\"\"}\"\n\
    2026-07-18 08:28:09,2026-07-18 08:28:48,1,100,1,R_1,P00,preview,1,1,1,1,1,1\n\
    2026-07-18 08:28:09,2026-07-18 08:28:48,0,100,1,R_2YPOQ602ER1jkf1,P01,anonymous,1,2,3,7,6,-99\n";

/// Columns of which a condition is part of the name.
const BY_NAME: &str = "[scales.calm]\ncolumn = \"{condition}_calm_{item}\"\n";

#[test]
fn qualtrics_three_heads_are_known_and_a_preview_is_nobodys_answer() {
    let (warnings, table) = read(None, QUALTRICS.as_bytes(), Some(BY_NAME), DESIGN).unwrap();
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
    let text = suggest(QUALTRICS.as_bytes(), DESIGN);
    for line in [
        "software = \"qualtrics\"",
        "# participant = \"ExternalReference\"   # by convention: 2 different ones",
        "column = \"{condition}_calm_{item}\"",
    ] {
        assert!(text.contains(line), "{text}");
    }
    let (_, again) = read(None, QUALTRICS.as_bytes(), Some(&text), DESIGN).unwrap();
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
    let (warnings, table) = read(None, LIMESURVEY.as_bytes(), Some(map), DESIGN).unwrap();
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
        (
            "K = \"calm\"",
            "C = \"calm\"",
            "no column has `C`, for which [moments]",
        ),
        ("K = \"calm\"\nS", "K", "2 words"),
    ] {
        let result = read(
            None,
            LIMESURVEY.as_bytes(),
            Some(&map.replacen(from, to, 1)),
            DESIGN,
        );
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
    let error = read(None, LIMESURVEY.as_bytes(), Some(&none), DESIGN).unwrap_err();
    assert!(
        error.contains("there are `K`, `S`, expected calm, sporty"),
        "{error}"
    );
}

#[test]
fn a_pattern_that_matches_one_condition_only_is_not_taken_for_before_the_drives() {
    let map = "[scales.calm]\ncolumn = \"KTLX[SQ{item}]\"\n";
    let error = read(None, LIMESURVEY.as_bytes(), Some(map), DESIGN).unwrap_err();
    assert!(
        error.contains("`KTLX[SQ{item}]` names the columns of one moment only")
            && error.contains("moment = \"pre\""),
        "{error}"
    );
    // Where it is said, it is what is meant.
    let (_, table) = read(
        None,
        LIMESURVEY.as_bytes(),
        Some(&(map.to_owned() + "moment = \"pre\"\n")),
        DESIGN,
    )
    .unwrap();
    assert_eq!(rows(&table)[0], "P01,pre,calm,1,1");
    // What no other columns are like is from before the drives, as it always was.
    let alone = LIMESURVEY.replace("STLX", "AGE");
    assert!(read(None, alone.as_bytes(), Some(map), DESIGN).is_ok());
}

#[test]
fn limesurveys_proposal_abstains_where_a_letter_may_be_a_condition() {
    let text = suggest(LIMESURVEY.replace("TLX", "calm").as_bytes(), DESIGN);
    assert!(
        text.contains("# column = \"{condition}calm[SQ{item}]\"")
            && text.contains("# [moments]   # ?")
            && text.contains("\n# K = \"?\"\n# S = \"?\"\n"),
        "{text}"
    );
    let sure = text
        .lines()
        .filter(|line| !line.starts_with('#') && !line.is_empty());
    assert_eq!(sure.count(), 0, "{text}");
    // Filled in, its comments are the map.
    let map = text
        .replace("K = \"?\"", "K = \"calm\"")
        .replace("S = \"?\"", "S = \"sporty\"");
    let meant = |line: &&str| {
        ["# [", "# K", "# S", "# column = \"{"]
            .iter()
            .any(|start| line.starts_with(start))
            && !line.contains("[files]")
    };
    let map: String = map
        .lines()
        .filter(meant)
        .map(|line| line[2..].to_owned() + "\n")
        .collect();
    let answers = LIMESURVEY.replace("TLX", "calm");
    let (_, table) = read(None, answers.as_bytes(), Some(&map), DESIGN).unwrap();
    assert!(table.contains("P01,sporty,calm,1,4"), "{table}");
    // Headings by the texts of the questions name no item.
    let texts = "Response ID,Date submitted,Was it calm? [1]\n1,2026-01-01,3\n";
    let error = read(None, texts.as_bytes(), None, DESIGN).unwrap_err();
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
    let (warnings, table) = read(None, &utf_16, Some(map), DESIGN).unwrap();
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
    let (warnings, same) = read(
        None,
        &encoding_rs::WINDOWS_1252.encode(SOSCI).0,
        Some(map),
        DESIGN,
    )
    .unwrap();
    assert_eq!(same, table);
    assert!(warnings[0].contains("Windows-1252"), "{warnings:?}");
    // Two questionnaires of which nothing says when they were answered.
    let error = read(
        None,
        SOSCI.as_bytes(),
        Some("[scales.calm]\ncolumn = \"CA01_{item}\"\n"),
        DESIGN,
    )
    .unwrap_err();
    assert!(
        error.contains("`QUESTNNR` has base, calm, sporty, and `base` is no condition"),
        "{error}"
    );
    let mac = encoding_rs::MACINTOSH.encode(SOSCI).0;
    let error = read(None, &mac, Some(map), DESIGN).unwrap_err();
    assert!(
        error.contains("cannot be told") && error.contains("encoding = \"macintosh\""),
        "{error}"
    );
    let (_, same) = read(
        None,
        &mac,
        Some(&format!("encoding = \"macintosh\"\n{map}")),
        DESIGN,
    )
    .unwrap();
    assert_eq!(same, table);
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
    let text = suggest(table("0,3,6").as_bytes(), DESIGN);
    assert!(
        text.contains("column = \"calm_a{item}\"\nadd = 1   # the answers go from 0 to 6"),
        "{text}"
    );
    assert!(text.contains("\nmoment = \"ride\"\n"), "{text}");
    let (_, long) = read(None, table("0,3,6").as_bytes(), Some(&text), DESIGN).unwrap();
    assert_eq!(rows(&long)[0], "P01,sporty,calm,1,1");
    let text = suggest(table("never,often,never").as_bytes(), DESIGN);
    assert!(
        text.contains(
            "# labels = [\"?\"]   # from the lowest answer; there are \"never\", \"often\""
        ),
        "{text}"
    );
    let text = suggest(table("1,9,1").as_bytes(), DESIGN);
    assert!(
        text.contains("no columns numbered 1 to 3 have such answers"),
        "{text}"
    );
    let other = table("1,2,3").replace("calm_a", "q");
    let text = suggest(other.as_bytes(), DESIGN);
    assert!(
        text.contains("# column = \"q{item}\"") && text.contains("not by their names"),
        "{text}"
    );
}

#[test]
fn a_workbook_is_read_by_the_name_of_its_sheet() {
    let answers: &[&[&str]] = &[
        &["participant", "condition", "calm_1", "calm_2", "calm_3"],
        &["P01", "sporty", "1", "2", ""],
    ];
    let (_, table) = read(None, &workbook(&[("Sheet1", answers)]), None, DESIGN).unwrap();
    assert_eq!(
        rows(&table),
        [
            "P01,sporty,calm,1,1",
            "P01,sporty,calm,2,2",
            "P01,sporty,calm,3,"
        ]
    );
    let two = workbook(&[
        ("Notes", &[&["written by hand"]]),
        ("Data", answers),
        ("Empty", &[]),
    ]);
    let error = read(None, &two, None, DESIGN).unwrap_err();
    assert!(
        error.contains("has 2 sheets with something in them")
            && error.contains("its sheets are Notes, Data, Empty"),
        "{error}"
    );
    let (_, same) = read(None, &two, Some("sheet = \"Data\"\n"), DESIGN).unwrap();
    assert_eq!(same, table);
    let error = read(None, &two, Some("sheet = \"Date\"\n"), DESIGN).unwrap_err();
    assert!(
        error.contains("has no sheet `Date`; its sheets are Notes, Data, Empty"),
        "{error}"
    );
    let error = read(None, b"PK\x03\x04 and nothing else", None, DESIGN).unwrap_err();
    assert!(
        error.contains("is no workbook (.xlsx) that can be read"),
        "{error}"
    );
    let error = read(
        None,
        QUALTRICS.as_bytes(),
        Some("sheet = \"Data\"\n"),
        DESIGN,
    )
    .unwrap_err();
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
    let (_, table) = read(
        None,
        &workbook(&[("Sheet1", &lines)]),
        Some(BY_NAME),
        DESIGN,
    )
    .unwrap();
    assert_eq!(
        rows(&table),
        [
            "R_1,calm,calm,1,7",
            "R_1,calm,calm,2,6",
            "R_1,calm,calm,3,5"
        ]
    );
}

#[test]
fn a_column_whose_name_stands_twice_is_refused() {
    let error = read(
        None,
        b"participant,calm_1,calm_2,calm_3,calm_3\nP01,1,2,3,4\n",
        None,
        DESIGN,
    )
    .unwrap_err();
    assert!(
        error.contains("both `calm_3` and `calm_3 (column 5)` hold it"),
        "{error}"
    );
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
        Some(format!(
            "{error}; {}",
            error.suggestion().unwrap_or_default()
        ))
    };
    for (answers, title, id) in [
        (OTREE.as_bytes(), "an export of oTree", "otree"),
        (
            LIMESURVEY.as_bytes(),
            "an export of LimeSurvey",
            "limesurvey",
        ),
        (
            b"[{\"trial_type\": \"survey-likert\"}]",
            "an export of jsPsych",
            "jspsych",
        ),
        (b"who,calm_1\nP01,1\n", "another table", "wide"),
    ] {
        let error = told("", answers).unwrap();
        assert!(
            error.contains(title) && error.contains(&format!("software = \"{id}\"")),
            "{error}"
        );
        assert_eq!(told(&format!("software = \"{id}\"\n"), answers), None);
    }
    assert_eq!(
        told(
            "",
            b"participant,moment,scale,item,answer\nP01,pre,calm,1,1\n"
        ),
        None
    );
}

#[test]
fn whose_rows_an_export_has_is_known_in_every_file() {
    let folder = tempfile::tempdir().unwrap();
    let utf_16: Vec<u8> = SOSCI.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let book = workbook(&[(
        "Sheet1",
        &[
            &["token", "id", "submitdate", "lastpage"],
            &["P01", "1", "2026", "3"],
        ],
    )]);
    for (software, answers, column) in [
        ("qualtrics", QUALTRICS.as_bytes(), "ExternalReference"),
        ("sosci", &utf_16, "SERIAL"),
        ("limesurvey", &book, "token"),
        ("otree", OTREE.as_bytes(), "participant.label"),
    ] {
        let study = study_of(
            folder.path(),
            &format!("software = \"{software}\"\n"),
            answers,
        );
        assert_eq!(column_of_people(&study).unwrap().as_deref(), Some(column));
        assert!(
            has_row_of(&study, &"P01".to_owned().try_into().unwrap()).unwrap(),
            "{software}"
        );
        assert!(
            !has_row_of(&study, &"P09".to_owned().try_into().unwrap()).unwrap(),
            "{software}"
        );
    }
}

//! `import`: answers as survey software exports them, to the long table that is scored.

mod columns;
mod jspsych;
mod otree;

use crate::{
    atomic_write::read_text,
    design::DesignFile,
    error::StudyError,
    gate::{Gate, counted},
    outcome::{Outcome, Watch},
    run_folder::{exclusions_path, read_scales},
    stage::{Files, Stage},
    tables::{Table, TableName, write_rows},
};
use columns::ColumnMap;
use maveric_analysis::Why;
use maveric_domain::{Answer, ConditionId, Moment, ParticipantId, Scale};
use maveric_report::tables::Exclusion;
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

/// What wrote the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum SurveySoftware {
    /// A row a participant, columns `app.round.player.field`
    #[value(name = "otree")]
    OTree,
    /// An array of trials a session
    #[value(name = "jspsych")]
    JsPsych,
}

/// Read answers as survey software exports them, and write the table that `score` takes
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
Example: maveric import all_apps_wide.csv --from otree --out surveys.csv
         maveric import results.json --from jspsych --columns columns.toml --out surveys.csv")]
pub struct Import {
    /// The export: oTree's wide CSV of all apps (or any table with a row a participant), or jsPsych's JSON
    pub file: PathBuf,
    /// What wrote it
    #[arg(long, value_enum)]
    pub from: SurveySoftware,
    /// Design of the study (TOML), which says what conditions there are; study.toml of the folder one stands in when not given,
    /// else the paper's
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// What its columns mean (TOML), where they are not called SCALE_ITEM
    #[arg(long)]
    pub columns: Option<PathBuf>,
    /// Folder of questionnaire definitions
    #[arg(long, default_value = "study_data/scales")]
    pub scales: PathBuf,
    /// Answers to write: participant, moment, scale, item, answer, and seconds where they were measured
    #[arg(long)]
    pub out: PathBuf,
}

/// What was imported.
#[derive(Debug, Clone, Serialize)]
pub struct Imported {
    /// People with an answer.
    pub participants: usize,
    /// Answers, those left out among them.
    pub answers: usize,
    /// Sheets (one scale answered once) by scale.
    pub sheets: BTreeMap<String, usize>,
    /// Columns or fields that belong to no scale.
    pub unused: usize,
}

/// One answer with the time it took.
struct Row {
    participant: ParticipantId,
    moment: Moment,
    scale: usize,
    item: u32,
    answer: Option<i32>,
    seconds: Option<f64>,
    /// Where in the file the sheet is, for messages.
    place: String,
}

/// What a reader makes of a file.
#[derive(Default)]
struct Found {
    rows: Vec<Row>,
    /// Names that belong to no scale.
    unused: BTreeSet<String>,
    warnings: Vec<String>,
}

impl Stage for Import {
    const NAME: &'static str = "import";
    const FAILURE: &'static str = "could not import the answers";
    type Result = Imported;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        Ok(Files::default()
            .reads([&self.file, &self.scales])
            .reads(&self.columns)
            .reads_people(root, self.design.as_deref(), None)
            .writes([&self.out, &exclusions_path(&self.out)]))
    }

    /// Imports answers and writes them as a long table: participant, moment, scale, item, answer, and seconds where the software measured
    /// them.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Imported>, StudyError> {
        let scales = read_scales(&self.scales)?;
        let map = self.columns.as_deref().map(ColumnMap::read).transpose()?;
        let mut map = map.unwrap_or_default();
        let study = DesignFile::find(self.design.as_deref())?;
        map.know(&study.design);
        map.check(self.columns.as_deref(), &scales)?;
        let found = match self.from {
            SurveySoftware::OTree => otree::read(&Table::read(&self.file)?, &scales, &map)?,
            SurveySoftware::JsPsych => {
                jspsych::read(&self.file, &read_text(&self.file)?, &scales, &map)?
            }
        };
        watch.check()?;
        let Found {
            mut rows,
            unused,
            mut warnings,
        } = found;
        let unknown = unknown_moments(&mut rows, &study);
        let left_out: usize = unknown.values().sum();
        warnings.extend(unknown.into_iter().map(|((moment, place), n)| {
            format!(
                "{n} answers left out: condition `{moment}` ({place}) is none of the design's: {}",
                ConditionId::listed(&study.design.labels())
            )
        }));
        refuse_twice(&self.file, &rows, &scales)?;
        let nobody = rows.is_empty();
        let kept_out = let_in(&mut rows, self.design.as_deref())?;
        if rows.is_empty() && !nobody {
            return Err(StudyError::BadFile {
                path: self.file.clone(),
                problem: "holds no answers of anybody who is let in".to_owned(),
                help: Some(counted(["answer", "answers"], kept_out.values().flatten()).join("; ")),
            });
        }
        if rows.is_empty() {
            let patterns: Vec<String> = scales.iter().map(|s| map.pattern(s)).collect();
            return Err(StudyError::BadFile {
            path: self.file.clone(),
            problem: format!("holds no answers to any scale; looked for {}", patterns.join(", ")),
            help: Some(
                "say what the columns are called: `column` in a scale's file, or --columns MAP.toml".to_owned(),
            ),
        });
        }
        rows.sort_by(|a, b| {
            (&a.participant, a.moment, a.scale, a.item).cmp(&(
                &b.participant,
                b.moment,
                b.scale,
                b.item,
            ))
        });
        write(&self.out, &rows, &scales)?;
        let listed = kept_out.iter().map(|((who, moment), why)| Exclusion {
            who: who.to_string(),
            what: format!("answers ({moment})"),
            why: why[0].to_string(),
        });
        write_rows(TableName::LeftOut, &exclusions_path(&self.out), listed)?;
        let participants: BTreeSet<&ParticipantId> = rows.iter().map(|r| &r.participant).collect();
        let mut sheets: BTreeMap<String, usize> = BTreeMap::new();
        for row in rows.iter().filter(|r| r.item == 1) {
            *sheets.entry(scales[row.scale].id.clone()).or_default() += 1;
        }
        for scale in scales.iter().filter(|s| !sheets.contains_key(&s.id)) {
            warnings.push(format!(
                "scale `{}`: nobody answered it ({})",
                scale.id,
                map.pattern(scale)
            ));
        }
        let list = |n: &BTreeMap<String, usize>| {
            let each: Vec<String> = n.iter().map(|(scale, n)| format!("{scale} {n}")).collect();
            each.join(", ")
        };
        let mut summary = vec![
            format!(
                "{} answers of {} participants: {}",
                rows.len(),
                participants.len(),
                self.out.to_slash_lossy()
            ),
            format!(
                "sheets: {}; {} columns that belong to no scale were not read",
                list(&sheets),
                unused.len()
            ),
        ];
        if left_out > 0 {
            summary.push(format!("{left_out} answers left out by unknown condition"));
        }
        summary.extend(counted(["answer", "answers"], kept_out.values().flatten()));
        let value = Imported {
            participants: participants.len(),
            answers: rows.len(),
            sheets,
            unused: unused.len(),
        };
        Ok(Outcome {
            value,
            summary,
            warnings,
        })
    }
}

/// The column that says whose each row of an export is; none where it has none.
///
/// # Errors
/// [`StudyError`] for a map of columns that is none.
pub(crate) fn participant_column(
    table: &Table,
    columns: Option<&Path>,
) -> Result<Option<String>, StudyError> {
    let map = columns
        .map(ColumnMap::read)
        .transpose()?
        .unwrap_or_default();
    Ok(otree::people_column(table, &map).filter(|column| table.has(column)))
}

/// Takes out the answers about conditions that the design does not have: how many, by condition and place.
fn unknown_moments(rows: &mut Vec<Row>, study: &DesignFile) -> BTreeMap<(Moment, String), usize> {
    let mut unknown = BTreeMap::new();
    rows.retain(|row| match row.moment {
        Moment::After(condition) if !study.design.knows(condition) => {
            *unknown.entry((row.moment, row.place.clone())).or_default() += 1;
            false
        }
        _ => true,
    });
    unknown
}

/// Whose answers, and when → why each is left out.
type LeftOutAnswers = BTreeMap<(ParticipantId, Moment), Vec<Why>>;

/// Takes out the answers of whoever the design leaves out by name, or who is nobody of its people.
fn let_in(rows: &mut Vec<Row>, design: Option<&Path>) -> Result<LeftOutAnswers, StudyError> {
    let mut left_out = LeftOutAnswers::new();
    let Some(study) = DesignFile::here(design)? else {
        return Ok(left_out);
    };
    let gate = Gate::where_listed(&study, None)?;
    rows.retain(|row| match gate.answer(&row.participant, row.moment) {
        None => true,
        Some(why) => {
            let sheet = (row.participant.clone(), row.moment);
            left_out.entry(sheet).or_default().push(why);
            false
        }
    });
    Ok(left_out)
}

/// Refuses a sheet that is there twice: one row of a person too many, or a condition rated twice.
fn refuse_twice(file: &Path, rows: &[Row], scales: &[Scale]) -> Result<(), StudyError> {
    let mut seen: BTreeMap<(&ParticipantId, Moment, usize, u32), &Row> = BTreeMap::new();
    for row in rows {
        let key = (&row.participant, row.moment, row.scale, row.item);
        if let Some(before) = seen.insert(key, row) {
            let scale = &scales[row.scale].id;
            let problem = format!(
                "participant {} ({}), scale `{scale}`, item {}: answered twice, in {} and in {}",
                row.participant, row.moment, row.item, before.place, row.place
            );
            return Err(StudyError::BadFile {
                path: file.to_owned(),
                problem,
                help: Some("keep one; a condition can be rated once".to_owned()),
            });
        }
    }
    Ok(())
}

fn write(path: &Path, rows: &[Row], scales: &[Scale]) -> Result<(), StudyError> {
    let answers = rows.iter().map(|r| {
        let answer = Answer {
            participant: r.participant.clone(),
            moment: r.moment,
            scale: scales[r.scale].id.clone(),
            item: r.item,
            answer: r.answer,
        };
        (answer, r.seconds.map(|seconds| ("seconds", seconds)))
    });
    write_rows(TableName::Answers, path, answers)
}

/// A participant id as the file has it.
fn participant(path: &Path, place: &str, text: &str) -> Result<ParticipantId, StudyError> {
    ParticipantId::new(text.trim()).map_err(|e| StudyError::file(path, format!("{place}: {e}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicBool;

    const SCALE: &str = "id = \"calm\"\ntitle = \"Calmness\"\nreference = \"made up\"\nitems = 3\nmin = 1\nmax = 7\nscoring = \"mean\"\nreversed = [2]\n[[subscales]]\nid = \"calm\"\ntitle = \"Calmness\"\nitems = [1, 2, 3]\n";

    /// Imports `text`; gives what was said and the table written.
    fn run(
        from: SurveySoftware,
        text: &str,
        map: Option<&str>,
    ) -> Result<(Vec<String>, String), String> {
        let folder = tempfile::tempdir().unwrap();
        let scales = folder.path().join("scales");
        std::fs::create_dir(&scales).unwrap();
        std::fs::write(scales.join("calm.toml"), SCALE).unwrap();
        let write = |name: &str, text: &str| {
            std::fs::write(folder.path().join(name), text).unwrap();
            folder.path().join(name)
        };
        let options = Import {
            design: None,
            from,
            file: write("export", text),
            scales,
            columns: map.map(|m| write("map.toml", m)),
            out: folder.path().join("surveys.csv"),
        };
        let (quiet, go_on) = (|_: usize, _: usize, _: &str| (), AtomicBool::new(false));
        let done = options
            .run(Watch::new(&quiet, &go_on))
            .map_err(|e| e.to_string())?;
        Ok((
            done.warnings,
            std::fs::read_to_string(&options.out).unwrap(),
        ))
    }

    const OTREE: &str = "participant.code,participant.label,participant._is_bot,intro.1.player.calm_1,intro.1.player.calm_2,intro.1.player.calm_3,drive.1.player.condition,drive.1.player.calm_1,drive.1.player.calm_2,drive.1.player.calm_3,drive.1.player.remark\n\
        x1,P01,0,1,2,3,mimic,4,,6,\"nice, but slow\"\n\
        x2,P02,0,7,7,6,cautious,5,5,5,\n\
        x3,,1,1,1,1,mimic,1,1,1,\n\
        x4,P04,0,,,,,,,,\n";

    #[test]
    fn an_otree_table_becomes_a_long_one() {
        let (warnings, table) = run(SurveySoftware::OTree, OTREE, None).unwrap();
        assert_eq!(
            table,
            "participant,moment,scale,item,answer\nP01,pre,calm,1,1\nP01,pre,calm,2,2\nP01,pre,calm,3,3\nP01,mimic,calm,1,4\nP01,mimic,calm,2,\nP01,mimic,calm,3,6\n\
             P02,pre,calm,1,7\nP02,pre,calm,2,7\nP02,pre,calm,3,6\nP02,cautious,calm,1,5\nP02,cautious,calm,2,5\nP02,cautious,calm,3,5\n"
        );
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(
            warnings.iter().any(|w| w.contains("bot"))
                && warnings.iter().any(|w| w.contains("P04"))
        );
    }

    #[test]
    fn answers_about_a_condition_that_the_design_has_not_are_left_out_and_listed() {
        let text = OTREE.replace("cautious", "kautious");
        let (warnings, table) = run(SurveySoftware::OTree, &text, None).unwrap();
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
            run(SurveySoftware::OTree, &OTREE.replacen(from, to, 1), None).unwrap_err()
        };
        for (from, to, said) in [
            (
                "P01,0,1,2",
                "P01,0,1,9",
                "participant P01 (pre), scale `calm`, item 2 (row 1, column `intro.1.player.calm_2`): found `9`, expected a whole number from 1 to 7",
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
                "item 4 is not among its 3 items",
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
        let error = run(SurveySoftware::OTree, &twice, None).unwrap_err();
        assert!(
            error.contains("P01 (mimic)")
                && error.contains("drive.1.player")
                && error.contains("drive.2.player"),
            "{error}"
        );
        let error = run(SurveySoftware::OTree, "participant.label,a\nP01,1\n", None).unwrap_err();
        assert!(
            error.contains("holds no answers") && error.contains("calm_{item}"),
            "{error}"
        );
    }

    #[test]
    fn a_word_that_is_a_condition_of_the_design_means_it_whatever_else_it_means() {
        let mut map = ColumnMap::default();
        assert_eq!(map.moment_of("pre").unwrap(), Moment::Pre);
        let text =
            "[study]\ntitle = \"t\"\n[[condition]]\nid = \"pre\"\n[[condition]]\nid = \"post\"\n";
        let design = maveric_domain::Design::from_toml(text).unwrap();
        map.know(&design);
        let after = Moment::After("pre".parse().unwrap());
        assert_eq!(map.moment_of("pre").unwrap(), after);
        assert_eq!(map.moment_of("after:pre").unwrap(), after);
    }

    #[test]
    fn a_map_renames_columns_words_and_answers() {
        let table = "who;".replace(';', ",") + "q1,q2,q3,car\nP01,never,often,always,A\n";
        let map = "participant = \"who\"\nmoment = \"car\"\n[moments]\nA = \"aggressive\"\n[scales.calm]\ncolumn = \"q{item}\"\nlabels = [\"never\", \"rarely\", \"sometimes\", \"often\", \"usually\", \"almost always\", \"always\"]\n";
        let (_, long) = run(SurveySoftware::OTree, &table, Some(map)).unwrap();
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
            let error =
                run(SurveySoftware::OTree, &table, Some(&map.replace(from, to))).unwrap_err();
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
        let (warnings, table) = run(SurveySoftware::JsPsych, &text, None).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(
            table,
            "participant,moment,scale,item,answer,seconds\nP01,pre,calm,1,1,3.0\nP01,pre,calm,2,7,3.0\nP01,pre,calm,3,,3.0\n\
             P01,mimic,calm,1,2,3.0\nP01,mimic,calm,2,3,3.0\nP01,mimic,calm,3,4,3.0\n"
        );
        // A condition that the design does not know is left out, counted and named.
        let unknown = text.replace("\"mimic\"", "\"x\"");
        let (warnings, table) = run(SurveySoftware::JsPsych, &unknown, None).unwrap();
        assert!(
            warnings[0].contains("3 answers left out: condition `x`"),
            "{warnings:?}"
        );
        assert_eq!(table.lines().count(), 4);
        // Several sessions: one array each, one after the other or in an array.
        let second = text.replace("P01", "P02");
        for both in [format!("{text}{second}"), format!("[{text},{second}]")] {
            let (_, table) = run(SurveySoftware::JsPsych, &both, None).unwrap();
            assert_eq!(table.lines().count(), 13);
        }
        for (from, to, said) in [
            (
                "\"calm_2\": 6",
                "\"calm_2\": 7",
                "participant P01 (pre), scale `calm`, item 2 (session 1, trial 1): found `7`",
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
            let error = run(SurveySoftware::JsPsych, &text.replace(from, to), None).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
    }
}

//! What is peculiar to the tables of each survey software; everything else of them is read alike.

use super::grid::Grid;
use maveric_domain::design::Software;

/// The tables of one software.
#[derive(Debug, Clone, Copy)]
pub(super) struct Format {
    pub(super) software: Software,
    pub(super) title: &'static str,
    /// Whether a table is its own: what nobody else writes stands in it.
    is: fn(&Grid) -> bool,
    /// How many rows below the names hold no answers.
    heads: fn(&Grid) -> usize,
    /// Columns that say whose a row is: the first that anybody filled in.
    pub(super) participant: &'static [&'static str],
    /// Column that says which of several questionnaires a row answers.
    pub(super) questionnaire: Option<&'static str>,
    /// Rows that were made to try the questionnaire out.
    pub(super) trials: Option<Marked>,
    /// Words of the column of trials that mark a row of a participant.
    pub(super) real: &'static [&'static str],
    /// Rows that are read, and told.
    pub(super) doubtful: Option<Marked>,
    /// Words for no answer, beside an empty cell.
    pub(super) missing: &'static [&'static str],
    /// Whether the name before the last dot is that of a page: what is asked on it belongs together.
    pub(super) pages: bool,
}

/// Rows that a software marks: the column, its words, and what such rows are called.
type Marked = (&'static str, &'static [&'static str], &'static str);

/// Rows of bots, whose answers oTree makes up.
const BOTS: Marked = ("participant._is_bot", &["1", "True", "true"], "bots");

/// What Qualtrics calls rows of previews and tests, those marked as spam, made offline or made up among them: the values and labels of
/// `Status` in its exports for SPSS.
const QUALTRICS_TRIALS: Marked = (
    "Status",
    &[
        "1",
        "2",
        "9",
        "17",
        "256",
        "Survey Preview",
        "Survey Test",
        "Survey Preview Spam",
        "Offline Survey Preview",
        "Synthetic",
    ],
    "previews and tests",
);

/// What it calls rows that may be no person's.
const QUALTRICS_SPAM: Marked = ("Status", &["8", "12", "Spam", "Imported Spam"], "possible spam");

/// Every software whose tables are known, those that write what nobody else writes first; the last takes any table.
pub(super) const FORMATS: [Format; 5] = [
    // Three heads: the field, its question, its id at Qualtrics. Source: qualtrics.com, Understanding Your Dataset ("File Format Basics").
    Format {
        software: Software::Qualtrics,
        title: "Qualtrics",
        is: |grid| import_ids(grid).is_some(),
        heads: |grid| import_ids(grid).map_or(0, |row| row + 1),
        participant: &[
            "participant",
            "participant_id",
            "PROLIFIC_PID",
            "ExternalReference",
            "ResponseId",
        ],
        questionnaire: None,
        trials: Some(QUALTRICS_TRIALS),
        real: &["0", "4", "16", "IP Address", "Imported", "Offline"],
        doubtful: Some(QUALTRICS_SPAM),
        // What it writes for questions that were seen and not answered, where it is asked to.
        missing: &["-99"],
        pages: false,
    },
    // Source: LimeSurvey's application/helpers/admin/export/Writer.php (headings by code, with sub-questions in brackets).
    Format {
        software: Software::Limesurvey,
        title: "LimeSurvey",
        is: |grid| {
            let has_code = |name: &&str| any(grid, |column| code(column) == *name);
            ["submitdate", "lastpage"].iter().all(has_code)
                || is_by_questions(grid)
                || any(grid, |name| name.contains("[SQ"))
        },
        heads: |_| 0,
        participant: &["participant", "token", "id", "Response ID", "Antwort ID"],
        questionnaire: None,
        trials: None,
        real: &[],
        doubtful: None,
        missing: &["N/A"],
        pages: false,
    },
    // Source: soscisurvey.de/help, results:variables and results:values (what is answered is always above 0).
    Format {
        software: Software::Sosci,
        title: "SoSci Survey",
        is: |grid| all(grid, &["CASE", "QUESTNNR"]),
        heads: labels,
        participant: &["participant", "SERIAL", "REF", "CASE"],
        questionnaire: Some("QUESTNNR"),
        // `pretest` stands there; the other words are those of the project's own pages (?).
        trials: Some(("MODE", &["pretest", "admin", "debug", "qnrpreview"], "pretests")),
        real: &["interview"],
        doubtful: None,
        missing: &["-1", "-2", "-3", "-8", "-9"],
        pages: false,
    },
    Format {
        software: Software::Otree,
        title: "oTree",
        is: |grid| any(grid, |name| name == "participant.code" || name.contains(".player.")),
        heads: |_| 0,
        participant: &["participant.label", "participant.code", "participant"],
        questionnaire: None,
        trials: Some(BOTS),
        real: &["0", "False", "false"],
        doubtful: None,
        missing: &[],
        pages: true,
    },
    Format {
        software: Software::Wide,
        title: "a table with a row a participant",
        is: |_| true,
        heads: |_| 0,
        participant: &["participant", "participant_id"],
        questionnaire: None,
        trials: None,
        real: &[],
        doubtful: None,
        missing: &[],
        pages: true,
    },
];

impl Format {
    /// The format of a software that writes tables.
    pub(super) fn for_software(software: Software) -> Option<&'static Self> {
        FORMATS.iter().find(|format| format.software == software)
    }

    /// Whose table it is, by what stands in it.
    pub(super) fn of_grid(grid: &Grid) -> &'static Self {
        let [.., any] = &FORMATS;
        FORMATS.iter().find(|format| (format.is)(grid)).unwrap_or(any)
    }

    /// The table without the rows below its names that hold no answers.
    pub(super) fn without_heads(&self, grid: Grid) -> Grid {
        let heads = (self.heads)(&grid);
        grid.without_first(heads)
    }

    /// The page of a column, and the name of its field: `drive.1.player` and `calm_2`; for most there is one page without a name.
    pub(super) fn field_of<'c>(&self, column: &'c str) -> (&'c str, &'c str) {
        if self.pages {
            return column.rsplit_once('.').unwrap_or(("", column));
        }
        ("", self.code_of(column))
    }

    /// Where the column of this name, or of this code, stands.
    pub(super) fn position(&self, grid: &Grid, name: &str) -> Option<usize> {
        let mut columns = grid.columns.iter();
        let by_code = || columns.position(|column| self.code_of(column) == name);
        grid.position(name).or_else(by_code)
    }

    /// What a column is called without the text of its question.
    fn code_of<'c>(&self, column: &'c str) -> &'c str {
        if self.software == Software::Limesurvey { code(column) } else { column }
    }
}

/// The code before the text of a question, where LimeSurvey's heads have both: `KTLX[SQ001]` of `KTLX[SQ001]. How tired …`.
fn code(column: &str) -> &str {
    let code = column.split_once(". ").map_or(column, |(code, _)| code);
    if code.contains(' ') { column } else { code }
}

/// Whether LimeSurvey's heads are the texts of its questions, by which no item is known.
pub(super) fn is_by_questions(grid: &Grid) -> bool {
    all(grid, &["Response ID", "Date submitted"]) || all(grid, &["Antwort ID", "Datum Abgeschickt"])
}

fn all(grid: &Grid, names: &[&str]) -> bool {
    names.iter().all(|name| grid.position(name).is_some())
}

fn any(grid: &Grid, is: impl Fn(&str) -> bool) -> bool {
    grid.columns.iter().any(|name| is(name))
}

/// The row with `{"ImportId":"QID1"}` and the like.
fn import_ids(grid: &Grid) -> Option<usize> {
    let is_id = |row: usize| {
        (0..grid.columns.len()).any(|column| grid.cell(column, row).starts_with("{\"ImportId\""))
    };
    (0..grid.rows().min(3)).find(|row| is_id(*row))
}

/// A second head with the texts of the questions: then what stands under `CASE` is no number.
fn labels(grid: &Grid) -> usize {
    let first = grid.position("CASE").filter(|_| grid.rows() > 0);
    let is_text = |column| grid.cell(column, 0).parse::<u64>().is_err();
    usize::from(first.is_some_and(is_text))
}

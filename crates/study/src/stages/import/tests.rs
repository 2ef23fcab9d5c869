//! Exports of each software, from file to table.

mod software;
mod tables;
mod to_scores;
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
    let table = options.out.as_ref().map(|out| std::fs::read_to_string(out).unwrap());
    Ok((done.warnings, table.unwrap_or_else(|| done.summary.join("\n"))))
}

const OTREE: &str = "participant.code,participant.label,participant._is_bot,intro.1.player.calm_1,intro.1.player.calm_2,intro.1.player.calm_3,drive.1.player.condition,drive.1.player.calm_1,drive.1.player.calm_2,drive.1.player.calm_3,drive.1.player.remark\n\
    x1,P01,0,1,2,3,mimic,4,,6,\"nice, but slow\"\n\
    x2,P02,0,7,7,6,cautious,5,5,5,\n\
    x3,,1,1,1,1,mimic,1,1,1,\n\
    x4,P04,0,,,,,,,,\n";

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
        scales: Some(scales),
        suggest: false,
        out: Some(folder.join("surveys.csv")),
    }
}

/// A study of two conditions.
const DESIGN: &str =
    "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n";

/// Imports the bytes of a file by that study and a map.
fn mapped(bytes: &[u8], map: Option<&str>) -> Result<(Vec<String>, String), String> {
    read(None, bytes, map, DESIGN)
}

/// What `--suggest` prints of a file.
fn suggest(bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let options =
        Import { suggest: true, out: None, ..in_folder(folder.path(), None, bytes, None, DESIGN) };
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

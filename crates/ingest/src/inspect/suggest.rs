//! Proposes the mapping of a table, with its doubts as comments, once a drive was read by it.

use super::{
    columns::{self, Sheet},
    guess::{Choice, Guess, Shape, guess},
};
use crate::{
    error::IngestError,
    folder::file_name,
    mapping::{Mapping, TableMapping},
    quality::WarningKind,
    raw::table::text::Style,
    read_log::{Format, format_of, read_log},
    settings::IngestSettings,
};
use std::{fmt::Write as _, fs::File, io::Read as _, path::Path};

/// Bytes of a text that are looked at.
const LOOKED_AT: u64 = 32 << 20;
/// A drive shorter than this is no sign that times are in a unit that nothing names, in s: one sample a second is no drive of a
/// millisecond each.
const LONG_S: f64 = 30.0;

/// Proposes a mapping TOML for a table.
///
/// The columns are told by their names and the units in them. Where names leave something open, such as which position is along the
/// road, the table is read by each, and the one with the fewest doubts is taken. The proposal has its doubts as comments.
///
/// # Errors
/// [`IngestError::NotFound`] and the like; [`IngestError::BadTable`] for what is no table; [`IngestError::NoProposal`] where a
/// signal was not found, or no drive could be read by any proposal.
///
/// # Example
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("pair.csv");
/// let rows: String = (0..50)
///     .map(|i| format!("{},{},{},{}\n", f64::from(i) / 10.0, 2 * i, 20, 25))
///     .collect();
/// std::fs::write(&path, format!("t,x_follower,v_follower,spacing\n{rows}"))?;
/// let toml = maveric_ingest::suggest_mapping(&path)?;
/// assert!(toml.contains("ego_speed = \"v_follower\""));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn suggest_mapping(path: &Path) -> Result<String, IngestError> {
    if format_of(path)? == Format::Mcap {
        let what = "it is an MCAP recording, which says itself what is in it: no mapping is needed";
        return Err(IngestError::bad_table(path, what));
    }
    let table = columns::read(path, look(path)?, Style::default())?;
    if let Some(body) = ours(&table)
        && let Ok(trial) = Trial::of(path, body)
    {
        let head = "# The table has the columns of drives as this program writes them (study_data/mappings/ours.toml).\n";
        let doubt = "# doubt: lanes, their width and the posted speed are not in the table.\n";
        return Ok(format!("{head}{}{doubt}{}", trial.read, trial.body));
    }
    let guess = guess(&table);
    let none = |reason: String| IngestError::NoProposal { path: path.to_owned(), reason };
    let shape = guess.shape.map_err(|m| none(m.as_str().to_owned()))?;
    let trial = best(path, &table, &guess, shape);
    let trial = trial.map_err(|error| {
        none(format!("read by the names of its columns it is refused: {error}"))
    })?;
    let head = format!(
        "# A mapping for {}, proposed from the names of its columns. Check what says \"doubt\".\n",
        plain(&file_name(path))
    );
    Ok(format!("{head}{}{}", trial.read, trial.body))
}

/// A mapping by which drives were read.
struct Trial {
    body: String,
    /// What was read, as comments.
    read: String,
    /// Warnings that something is mistaken for another thing, and that ego is beside the road.
    doubts: [usize; 2],
    /// Length of the longest drive, in s.
    longest_s: f64,
}

impl Trial {
    /// Reads the table by a mapping.
    fn of(path: &Path, body: String) -> Result<Self, IngestError> {
        let settings = IngestSettings {
            mapping: Some(Mapping::from_toml(&body, Path::new("the proposal"))?),
            ..IngestSettings::default()
        };
        let drives = read_log(path, &settings)?;
        let rows: usize = drives.iter().map(|d| d.recording.rows()).sum();
        let s = if drives.len() == 1 { "" } else { "s" };
        let mut read = format!("# Read by it: {} drive{s}, {rows} rows.\n", drives.len());
        let warnings = || drives.iter().flat_map(|d| &d.warnings);
        for warning in warnings().take(5) {
            let what = plain(&warning.what);
            let _ = writeln!(read, "# warning: {what} ({} times)", warning.count);
        }
        let count = |kind| warnings().filter(|w| w.kind == kind).count();
        Ok(Self {
            body,
            read,
            doubts: [WarningKind::Unit, WarningKind::OtherLane].map(count),
            longest_s: drives
                .iter()
                .filter_map(|d| d.recording.time_s().last().copied())
                .fold(0.0, f64::max),
        })
    }
}

/// The proposal that leaves the fewest doubts of those by which the table can be read.
fn best(path: &Path, table: &Sheet, guess: &Guess<'_>, shape: Shape) -> Result<Trial, IngestError> {
    let of = |choice: &Choice<'_>| Trial::of(path, body(table, guess, shape, choice));
    let times = guess.times();
    let fits = |time: &&_| {
        let choice = Choice { time: **time, ..guess.first_choice() };
        let is_likely = |trial: Trial| **time == times[0] || trial.longest_s >= LONG_S;
        of(&choice).is_ok_and(is_likely)
    };
    let several = times.len() > 1;
    let time = times.iter().find(|time| !several || fits(time));
    let (mut best, mut refused): (Option<Trial>, _) = (None, None);
    for choice in guess.choices(*time.unwrap_or(&times[0])) {
        // A position that fits is not given up because the road has more lanes.
        if choice.along.is_none() && best.as_ref().is_some_and(|b| b.doubts[0] == 0) {
            break;
        }
        match of(&choice) {
            Ok(trial) if trial.doubts == [0; 2] => return Ok(trial),
            Ok(trial) if best.as_ref().is_none_or(|b| trial.doubts < b.doubts) => {
                best = Some(trial);
            }
            Ok(_) => {}
            Err(error) => {
                refused.get_or_insert(error);
            }
        }
    }
    match (best, refused) {
        (Some(trial), _) => Ok(trial),
        (None, Some(error)) => Err(error),
        (None, None) => of(&guess.first_choice()),
    }
}

/// The mapping of this program's own drives, whoever's they are, where a table has every column that it asks for.
fn ours(table: &Sheet) -> Option<String> {
    let text = maveric_data::MAPPINGS_OURS;
    let mapping: toml::Table = toml::from_str(text).ok()?;
    let columns = mapping.get("table")?.get("columns")?.as_table()?;
    let names = columns.values().filter_map(toml::Value::as_str);
    let has = |name: &str| table.columns.iter().any(|c| c.name == name);
    if !names.filter(|name| !name.ends_with('?')).all(has) {
        return None;
    }
    let (road, rest) = text.split_once("\n[names]\n")?;
    let (_, read) = rest.split_once("\n[table]\n")?;
    Some(format!("{road}{WHOSE}\n[table]\n{read}"))
}

/// The beginning of a file, up to its last whole line; all of Parquet.
pub(super) fn look(path: &Path) -> Result<Vec<u8>, IngestError> {
    let wrong = |e| IngestError::io(path, e);
    let mut file = File::open(path).map_err(wrong)?;
    let mut bytes = Vec::new();
    file.by_ref().take(LOOKED_AT).read_to_end(&mut bytes).map_err(wrong)?;
    if bytes.len() as u64 == LOOKED_AT {
        if crate::parquet::is_parquet(&bytes) {
            file.read_to_end(&mut bytes).map_err(wrong)?;
        } else if let Some(end) = bytes.iter().rposition(|&b| b == b'\n') {
            bytes.truncate(end + 1);
        }
    }
    Ok(bytes)
}

/// A text that may stand in a comment: one line, without control characters.
fn plain(text: &str) -> String {
    let printable = |c: char| if c.is_control() { ' ' } else { c };
    text.chars().map(printable).collect()
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn body(table: &Sheet, guess: &Guess<'_>, shape: Shape, choice: &Choice<'_>) -> String {
    let columns = guess.columns(choice);
    let has = |key: &str| columns.iter().any(|(k, _)| *k == key);
    let layout = match shape {
        Shape::Pair => "pair",
        Shape::Long => "long",
        Shape::Platoon => "platoon",
    };
    let numbers = guess.lanes().filter(|_| has("lane"));
    let (first, lanes) = numbers.map_or((TableMapping::FIRST_LANE, 1), lanes_of);
    let mut out = format!(
        "{WHOSE}\n[road]\n# doubt: lanes, their width and the posted speed are not in the table.\nlanes = {lanes}\n\
         lane_width_m = 3.66\nposted_speed_mps = 29.0\nframe = \"map\"\n\n[table]\nlayout = \"{layout}\"\n"
    );
    if let Some(separator) = table.separator {
        let separator = quoted(&char::from(separator).to_string());
        let _ = writeln!(out, "separator = {separator}");
    }
    if table.decimal_comma {
        out.push_str("decimal_comma = true\n");
    }
    if let Some((kind, why)) = guess.gap_kind().filter(|_| has("gap")) {
        let _ = writeln!(out, "# doubt: {why}\ngap_kind = \"{kind}\"");
    }
    if shape == Shape::Long {
        long(&mut out, guess, has("y"));
    } else if has("lead_x") {
        out.push_str(
            "# doubt: positions may be of the front, the centre or the rear.\npoint = \"front\"\n",
        );
    }
    if has("lane") {
        let (from, doubt) =
            if guess.is_of_ngsim() { ("left", "as in NGSIM") } else { ("right", "doubt") };
        let _ = writeln!(
            out,
            "# {doubt}: lanes are numbered from the {from}.\nlanes_from = \"{from}\""
        );
        if first != TableMapping::FIRST_LANE {
            let _ = writeln!(out, "first_lane = {first}");
        }
    }
    if has("offset") {
        out.push_str(
            "# doubt: the place in the lane grows to the left.\noffset_grows = \"left\"\n",
        );
        if !has("lane") {
            out.push_str("# doubt: no column numbers the lanes, so no lane changes are seen.\n");
        }
    }
    units(&mut out, guess, choice);
    out.push_str("\n[table.columns]\n");
    for (key, column) in &columns {
        let _ = writeln!(out, "{key} = {}", quoted(column));
    }
    let groups: Vec<String> = guess.groups().map(quoted).collect();
    if !groups.is_empty() {
        let _ = writeln!(out, "groups = [{}]", groups.join(", "));
    }
    let unused = guess.unused(&columns);
    if !unused.is_empty() {
        let names: Vec<String> = unused.iter().take(40).map(|n| plain(n)).collect();
        let _ = writeln!(out, "# not used: {}", names.join(", "));
    }
    out
}

/// How times are written, and the units.
fn units(out: &mut String, guess: &Guess<'_>, choice: &Choice<'_>) {
    let (time, pattern) = choice.time;
    if time == "frames" {
        out.push_str("# doubt: nothing says how many frames make a second.\nframes_per_s = 25.0\n");
    }
    if let Some(pattern) = pattern {
        let _ = writeln!(out, "time_pattern = {}", quoted(pattern));
    }
    out.push_str("\n[table.units]\n");
    let length = guess.named_length(choice);
    for (key, unit, is_named) in [
        ("time", time, guess.names_time(time)),
        ("length", length.unwrap_or(Guess::LENGTH), length.is_some()),
        ("speed", choice.speed, guess.named_speed().is_some()),
    ] {
        if !is_named {
            let _ = writeln!(out, "# doubt: no name says the unit of {key}.");
        }
        let _ = writeln!(out, "{key} = \"{unit}\"");
    }
}

/// Number of the first lane, and how many lanes there are, by the least and the greatest number: the first ones need not be driven in.
fn lanes_of((least, most): (i64, i64)) -> (i64, u8) {
    let first = least.min(TableMapping::FIRST_LANE);
    let lanes = most.saturating_sub(first).saturating_add(1);
    (first, u8::try_from(lanes).unwrap_or(u8::MAX))
}

/// What says whose drive a file is, for somebody to fill in.
const WHOSE: &str = "\n# Whose drive a file is, by its name; without it the file is called by its name, its person too, and its condition is `own`.\n\
    # [names]\n# file = \"{participant}_{condition}\"\n# drive = \"{participant}-{condition}\"\n# participant = \"{participant}\"\n\
    # condition = \"{condition}\"\n";

fn long(out: &mut String, guess: &Guess<'_>, has_y: bool) {
    let (grows, point, doubt) = if guess.is_of_ngsim() {
        ("right", "front", "as in NGSIM: ")
    } else {
        ("left", "centre", "doubt: ")
    };
    let _ = writeln!(
        out,
        "# {doubt}positions are of the vehicle's {point} (front, centre, rear or corner).\npoint = \"{point}\""
    );
    if has_y {
        let _ =
            writeln!(out, "# {doubt}y grows to the {grows}, seen along x.\ny_grows = \"{grows}\"");
    }
    if guess.drives_both_ways() {
        out.push_str("# Some drive along x and some against it.\ndirections = \"both\"\n");
    }
}

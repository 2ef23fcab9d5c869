//! Proposes the mapping of a table, with its doubts as comments.

use super::{
    columns::{self, Sheet},
    guess::{Guess, Shape, guess},
    units::Reason,
};
use crate::{
    error::IngestError,
    folder::file_name,
    mapping::{Mapping, TableMapping},
    raw::table::text::Style,
    read_log::{Format, format_of, read_log},
    settings::IngestSettings,
};
use std::{fmt::Write as _, fs::File, io::Read as _, path::Path};

/// Bytes of a text that are looked at.
const LOOKED_AT: u64 = 32 << 20;

/// Proposes a mapping TOML for a table.
///
/// The columns are told by their names, and by what their numbers do: positions move as speeds say, cars have lengths,
/// times rise. What is not certain is in comments, and so is what became of the table when it was read by the
/// proposal.
///
/// # Errors
/// [`IngestError::NotFound`] and the like; [`IngestError::BadTable`] for what is no table.
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
    if let Some(body) = ours(&table) {
        let head = "# The table has the columns of drives as this program writes them (study_data/mappings/ours.toml).\n";
        let doubt = "# doubt: lanes, their width and the posted speed are not in the table.\n";
        return Ok(format!("{head}{}{doubt}{body}", read_by(path, &body)));
    }
    let guess = guess(&table);
    let body = body(&table, &guess);
    Ok(format!("{}{body}", head(path, &guess, &body)))
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
    file.by_ref()
        .take(LOOKED_AT)
        .read_to_end(&mut bytes)
        .map_err(wrong)?;
    if bytes.len() as u64 == LOOKED_AT {
        if crate::parquet::is_parquet(&bytes) {
            file.read_to_end(&mut bytes).map_err(wrong)?;
        } else if let Some(end) = bytes.iter().rposition(|&b| b == b'\n') {
            bytes.truncate(end + 1);
        }
    }
    Ok(bytes)
}

/// What the proposal makes of the table, and what it leaves aside, as comments.
fn head(path: &Path, guess: &Guess, body: &str) -> String {
    let mut head = format!(
        "# A mapping for {}, proposed from its names and numbers. Check what says \"doubt\".\n",
        plain(&file_name(path))
    );
    if let Shape::Unknown(missing) = guess.shape {
        let _ = writeln!(head, "# It is not complete: {missing}. Fill it in by hand.");
        return head;
    }
    head + &read_by(path, body)
}

/// What a mapping makes of the table, as comments.
fn read_by(path: &Path, body: &str) -> String {
    let mut head = String::new();
    let read = Mapping::from_toml(body, Path::new("the proposal")).and_then(|mapping| {
        let settings = IngestSettings {
            mapping: Some(mapping),
            ..IngestSettings::default()
        };
        read_log(path, &settings)
    });
    match read {
        Ok(drives) => {
            let rows: usize = drives.iter().map(|d| d.recording.rows()).sum();
            let _ = writeln!(head, "# Read by it: {} drives, {rows} rows.", drives.len());
            for warning in drives.iter().flat_map(|d| &d.warnings).take(5) {
                let what = plain(&warning.what);
                let _ = writeln!(head, "# warning: {what} ({} times)", warning.count);
            }
        }
        Err(error) => {
            let why = plain(&error.to_string());
            let _ = writeln!(head, "# Read by it, the table is refused: {why}");
        }
    }
    head
}

/// A text that may stand in a comment: one line, without control characters.
fn plain(text: &str) -> String {
    let printable = |c: char| if c.is_control() { ' ' } else { c };
    text.chars().map(printable).collect()
}

fn comment(out: &mut String, reason: &Reason) {
    let doubt = if reason.doubt { "doubt: " } else { "" };
    let _ = writeln!(out, "# {doubt}{}", plain(&reason.why));
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn body(table: &Sheet, guess: &Guess) -> String {
    let mut out = String::new();
    let layout = match guess.shape {
        Shape::Pair | Shape::Unknown(_) => "pair",
        Shape::Long => "long",
        Shape::Platoon => "platoon",
    };
    if let Some(rate) = guess.rate_hz {
        let _ = writeln!(
            out,
            "# Its samples come at {rate:.3} Hz; without this they are resampled to {} Hz.\n# rate_hz = {rate:.3}",
            IngestSettings::RATE_HZ
        );
    }
    let has = |key: &str| guess.columns.iter().any(|(k, _)| *k == key);
    let numbered = guess.shape == Shape::Long || has("lane");
    let numbers = guess.lanes.filter(|_| numbered);
    let (first, lanes) = numbers.map_or((TableMapping::FIRST_LANE, 1), lanes_of);
    out.push_str(WHOSE);
    let _ = writeln!(
        out,
        "\n[road]\n# doubt: lanes, their width and the posted speed are not in the table.\nlanes = {lanes}\n\
         lane_width_m = 3.66\nposted_speed_mps = 29.0\nframe = \"map\"\n\n[table]\nlayout = \"{layout}\""
    );
    if let Some(separator) = table.separator {
        let separator = quoted(&char::from(separator).to_string());
        let _ = writeln!(out, "separator = {separator}");
    }
    if table.decimal_comma {
        out.push_str("decimal_comma = true\n");
    }
    if let Some((kind, why)) = &guess.gap_kind {
        let _ = writeln!(out, "# {}\ngap_kind = \"{kind}\"", plain(why));
    }
    if guess.shape == Shape::Long {
        long(&mut out, guess, has("y"));
    } else if has("lead_x") {
        out.push_str(
            "# doubt: positions may be of the front, the centre or the rear.\npoint = \"front\"\n",
        );
    }
    if has("lane") {
        let (from, doubt) = if guess.ngsim {
            ("left", "as in NGSIM")
        } else {
            ("right", "doubt")
        };
        let _ = writeln!(
            out,
            "# {doubt}: lanes are numbered from the {from}.\nlanes_from = \"{from}\""
        );
        if first != TableMapping::FIRST_LANE {
            let _ = writeln!(out, "first_lane = {first}");
        }
    }
    if let Some(why) = &guess.offset {
        let _ = writeln!(
            out,
            "# {}.\n# doubt: it grows to the left.\noffset_grows = \"left\"",
            plain(why)
        );
        if !has("lane") {
            out.push_str("# doubt: no column numbers the lanes, so no lane changes are seen.\n");
        }
    }
    if guess.time.0 == "frames" {
        out.push_str("# doubt: nothing says how many frames make a second.\nframes_per_s = 25.0\n");
    }
    if let Some(pattern) = guess.time_pattern {
        let _ = writeln!(out, "time_pattern = {}", quoted(pattern));
    }
    out.push_str("\n[table.units]\n");
    for (key, (unit, reason)) in [
        ("time", &guess.time),
        ("length", &guess.length),
        ("speed", &guess.speed),
    ] {
        comment(&mut out, reason);
        let _ = writeln!(out, "{key} = \"{unit}\"");
    }
    out.push_str("\n[table.columns]\n");
    for (key, column) in &guess.columns {
        let _ = writeln!(out, "{key} = {}", quoted(column));
    }
    if !guess.groups.is_empty() {
        let groups: Vec<String> = guess.groups.iter().map(|g| quoted(g)).collect();
        let _ = writeln!(out, "groups = [{}]", groups.join(", "));
    }
    if !guess.unused.is_empty() {
        let names = guess.unused.iter().take(40).map(|n| plain(n));
        let names: Vec<String> = names.collect();
        let _ = writeln!(out, "# not used: {}", names.join(", "));
    }
    out
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

fn long(out: &mut String, guess: &Guess, has_y: bool) {
    let (grows, point, doubt) = if guess.ngsim {
        ("right", "front", "as in NGSIM: ")
    } else {
        ("left", "centre", "doubt: ")
    };
    let _ = writeln!(
        out,
        "# {doubt}positions are of the vehicle's {point} (front, centre, rear or corner).\npoint = \"{point}\""
    );
    if has_y {
        let _ = writeln!(
            out,
            "# {doubt}y grows to the {grows}, seen along x.\ny_grows = \"{grows}\""
        );
    }
    if guess.both_ways {
        out.push_str("# Some drive along x and some against it.\ndirections = \"both\"\n");
    }
}

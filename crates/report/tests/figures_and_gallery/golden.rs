//! Eight small figures of the gallery, one of each way to draw, against committed ones: the SVG as text, one as pixels.
//!
//! `UPDATE_GOLDEN=1 cargo test -p maveric-report --test figures_and_gallery golden` writes them anew: look at what changed.

use crate::kinds;
use maveric_report::Figure;
use std::{fmt::Write as _, fs, path::PathBuf};

/// What `exp` and `sin` of another platform may change, in points.
const TOLERANCE_PT: f64 = 0.02;
/// Resolution of the committed pictures.
const DOTS_PER_INCH: f64 = 72.0;

fn golden(file: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden")).join(file)
}

pub(crate) fn updating() -> bool {
    std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1")
}

/// The committed bytes; written first if they are to be.
fn committed(file: &str, now: &[u8]) -> Vec<u8> {
    let path = golden(file);
    if updating() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, now).unwrap();
    }
    fs::read(&path)
        .unwrap_or_else(|error| panic!("tests/golden/{file}: {error}; UPDATE_GOLDEN=1 writes it"))
}

/// Pieces of a line: words, and numbers with what they are.
fn pieces(line: &str) -> Vec<(&str, Option<f64>)> {
    let numeric = |sign: char| sign.is_ascii_digit() || sign == '.' || sign == '-';
    let mut out = Vec::new();
    let mut rest = line;
    while let Some(first) = rest.chars().next() {
        let kind = numeric(first);
        let end = rest.find(|sign| numeric(sign) != kind).unwrap_or(rest.len());
        let (piece, after) = rest.split_at(end);
        out.push((piece, if kind { piece.parse().ok() } else { None }));
        rest = after;
    }
    out
}

/// Whether lines say the same: text to the letter, numbers within the tolerance.
fn alike(ours: &str, theirs: &str) -> bool {
    let (ours, theirs) = (pieces(ours), pieces(theirs));
    let mut pairs = ours.iter().zip(&theirs);
    let same = pairs.all(|(a, b)| match (a.1, b.1) {
        (Some(x), Some(y)) => (x - y).abs() <= TOLERANCE_PT + 1e-9,
        _ => a.0 == b.0,
    });
    ours.len() == theirs.len() && same
}

/// The first line that differs, in words; `None` if none does.
fn difference(name: &str, now: &str, before: &str) -> Option<String> {
    let (mut ours, mut theirs) = (now.lines(), before.lines());
    let mut number = 1;
    let (now, before) = loop {
        match (ours.next(), theirs.next()) {
            (None, None) => return None,
            (Some(a), Some(b)) if alike(a, b) => number += 1,
            (a, b) => break (a, b),
        }
    };
    let cut = |line: Option<&str>| {
        let line = line.unwrap_or("(no line)");
        line.chars().take(300).collect::<String>()
    };
    let mut words = format!("figure `{name}` is not tests/golden/{name}.svg, line {number}\n");
    let _ = writeln!(words, "  committed: {}", cut(before));
    let _ = writeln!(words, "  now:       {}", cut(now));
    words += "  if that is meant: UPDATE_GOLDEN=1 cargo test -p maveric-report --test figures_and_gallery golden, and look at it";
    Some(words)
}

/// Boxes and arrows; points; lines with error bars; a line through points; a scale; cells; rows; bars.
const COMMITTED: [&str; 8] =
    ["flow", "scatter", "preference", "residuals", "calibration", "family", "forest", "fidelity"];

fn figures() -> Vec<Figure> {
    let mut figures = kinds::figures(&kinds::context(7)).unwrap();
    figures.retain(|figure| COMMITTED.contains(&figure.name.as_str()));
    assert_eq!(figures.len(), COMMITTED.len());
    figures
}

#[test]
fn the_figures_are_the_committed_ones() {
    let differences: Vec<String> = figures()
        .iter()
        .filter_map(|figure| {
            let before = committed(&format!("{}.svg", figure.name), figure.svg.as_bytes());
            difference(&figure.name, &figure.svg, std::str::from_utf8(&before).unwrap())
        })
        .collect();
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

pub(crate) fn pixels(png: &[u8]) -> (u32, u32, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut buffer).unwrap();
    buffer.truncate(info.buffer_size());
    (info.width, info.height, buffer)
}

#[test]
fn a_figure_is_the_committed_one_pixel_by_pixel() {
    let name = "preference";
    let figure = figures().into_iter().find(|figure| figure.name == name).unwrap();
    let now = figure.png_at(DOTS_PER_INCH).unwrap();
    let before = committed(&format!("{name}.png"), &now);
    let ((w, h, ours), (wide, high, theirs)) = (pixels(&now), pixels(&before));
    assert_eq!((w, h), (wide, high), "{name}: another size");
    // Rims of letters may differ by a shade; a moved line or another word changes many pixels by much.
    let far = ours.iter().zip(&theirs).filter(|(a, b)| a.abs_diff(**b) > 48).count();
    let share = far as f64 / ours.len() as f64;
    assert!(
        share < 0.002,
        "{name}: {:.2}% of the samples differ by more than 48 of 255; UPDATE_GOLDEN=1 if that is meant",
        100.0 * share
    );
}

#[test]
fn a_moved_line_and_another_word_are_found_and_a_rounding_is_not() {
    let before = "<g>\n<line x1=\"12.34\" y=\"-0.5\"/>\n<text>n = 24</text>\n";
    assert_eq!(difference("x", &before.replace("12.34", "12.36"), before), None);
    let moved = difference("x", &before.replace("12.34", "12.37"), before).unwrap();
    assert!(moved.contains("line 2") && moved.contains("12.34") && moved.contains("12.37"));
    assert!(difference("x", &before.replace("24", "25"), before).is_some());
    assert!(difference("x", &before.replace("<text>", "<text >"), before).is_some());
    assert!(difference("x", before.trim_end_matches("<text>n = 24</text>\n"), before).is_some());
}

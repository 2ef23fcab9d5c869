//! The text of an export, in whichever encoding it was saved.

use crate::error::StudyError;
use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};
use std::{borrow::Cow, path::Path};

/// The text of a file in UTF-8, and what a reader has to know of its encoding. What is no text at all is given back as it is.
///
/// Known without being told are UTF-8, UTF-16 by its byte order mark or its zero bytes, and Windows-1252 where every other reading of
/// the bytes would be stranger.
///
/// # Errors
/// [`StudyError::BadFile`] naming the line and byte that no encoding explains, or an encoding that is not known.
pub(super) fn text_of(
    path: &Path,
    bytes: Vec<u8>,
    named: Option<&str>,
) -> Result<(Vec<u8>, Option<String>), StudyError> {
    let by_itself = Encoding::for_bom(&bytes).map(|(encoding, _)| encoding);
    let by_itself = by_itself.or_else(|| by_zeros(&bytes));
    if named.is_none() && by_itself.is_none() && bytes.contains(&0) {
        return Ok((bytes, None));
    }
    let (text, warning) = decode(path, &bytes, named, by_itself)?;
    Ok((text.into_bytes(), warning))
}

fn decode(
    path: &Path,
    bytes: &[u8],
    named: Option<&str>,
    by_itself: Option<&'static Encoding>,
) -> Result<(String, Option<String>), StudyError> {
    if let Some(name) = named {
        let encoding = Encoding::for_label(name.as_bytes()).ok_or_else(|| {
            let problem = format!("`encoding = \"{name}\"` of its map of columns is not an encoding");
            let help = "expected such as utf-8, utf-16le, windows-1252, windows-1250, iso-8859-15, macintosh";
            StudyError::file(path, problem).with_help(help)
        })?;
        let (text, used, damaged) = encoding.decode(bytes);
        if damaged {
            let problem = format!("is not {}, as its map of columns says", used.name());
            return Err(StudyError::file(path, problem));
        }
        return Ok((text.into_owned(), None));
    }
    let encoding = by_itself.unwrap_or(UTF_8);
    let (text, damaged) = encoding.decode_with_bom_removal(bytes);
    if !damaged {
        return Ok((text.into_owned(), None));
    }
    if by_itself.is_none() {
        let (text, _, _) = WINDOWS_1252.decode(bytes);
        if let Some(word) = western(&text) {
            let warning = format!(
                "not in UTF-8: read as Windows-1252, by which `{word}` is a word; `encoding` in the map of columns names another"
            );
            return Ok((text.into_owned(), Some(warning)));
        }
    }
    let help = "save it again as CSV in UTF-8 (spreadsheets call it `CSV UTF-8`), or name its encoding in the map of columns: encoding = \"macintosh\"";
    Err(StudyError::file(path, unknown(bytes, encoding)).with_help(help))
}

/// UTF-16 without its mark: every second byte of a text with Latin letters is zero.
fn by_zeros(bytes: &[u8]) -> Option<&'static Encoding> {
    let head = &bytes[..bytes.len().min(1000) / 2 * 2];
    let zeros = |from: usize| head.iter().skip(from).step_by(2).filter(|b| **b == 0).count();
    let most = head.len() / 2 * 9 / 10;
    match (zeros(0), zeros(1)) {
        (0, odd) if odd > most => Some(UTF_16LE),
        (even, 0) if even > most => Some(UTF_16BE),
        _ => None,
    }
}

/// A word that shows a text to be one of Western Europe: letters with marks stand alone between plain ones, and signs stand where signs
/// do. Other encodings read so put signs within words (`M„dchen`), or make words of marked letters alone.
fn western(text: &str) -> Option<String> {
    let mut shown = None;
    for word in text.split(|c: char| c.is_ascii() && !c.is_ascii_alphanumeric()) {
        if word.is_ascii() {
            continue;
        }
        let letters: Vec<char> = word.chars().collect();
        let marked = |c: &char| !c.is_ascii() && c.is_alphabetic();
        if letters.windows(3).any(|three| three.iter().all(marked)) {
            return None;
        }
        let within = |place: usize| {
            let side = |at: Option<usize>| {
                at.and_then(|i| letters.get(i)).is_some_and(|c| c.is_alphabetic())
            };
            side(place.checked_sub(1)) && side(Some(place + 1))
        };
        for (place, c) in letters.iter().enumerate() {
            let is_sign = !c.is_alphanumeric() && *c != '’';
            // š, ž, œ and ÿ are what ö, ü and ä of other encodings become.
            let doubtful = "ŠŽŒŸšžœÿƒˆ˜‚†‡".contains(*c) || ('\u{80}'..='\u{9f}').contains(c);
            if doubtful || (!c.is_ascii() && is_sign && within(place)) {
                return None;
            }
        }
        if letters.iter().any(marked) && letters.iter().any(char::is_ascii_alphabetic) {
            shown.get_or_insert_with(|| word.to_owned());
        }
    }
    shown
}

/// What is wrong with bytes that no known encoding explains.
fn unknown(bytes: &[u8], encoding: &'static Encoding) -> String {
    if encoding != UTF_8 {
        return format!("begins like {} and cannot be read as that", encoding.name());
    }
    let place = std::str::from_utf8(bytes).map_or_else(|e| e.valid_up_to(), |_| 0);
    let line = bytes[..place].split(|byte| *byte == b'\n').count();
    let byte = bytes.get(place).copied().unwrap_or_default();
    let word: Cow<'_, str> =
        WINDOWS_1252.decode(&bytes[place.saturating_sub(6)..(place + 6).min(bytes.len())]).0;
    format!(
        "its line {line} holds the byte {byte:02x}, which is not UTF-8, and Windows-1252 makes `{}` of what stands there: its encoding cannot be told",
        word.trim().replace(['\r', '\n'], " ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8], named: Option<&str>) -> Result<(String, Option<String>), String> {
        let (text, warning) =
            text_of(Path::new("a.csv"), bytes.to_vec(), named).map_err(|e| e.to_string())?;
        Ok((String::from_utf8(text).unwrap(), warning))
    }

    #[test]
    fn what_excel_and_spss_write_is_known_by_itself() {
        let text = "who,größe\nP01,für mich\n";
        let utf_16 = |to: fn(u16) -> [u8; 2], mark: bool| -> Vec<u8> {
            let units = mark.then_some(0xfeff).into_iter().chain(text.encode_utf16());
            units.flat_map(to).collect()
        };
        for bytes in [
            text.as_bytes().to_vec(),
            format!("\u{feff}{text}").into_bytes(),
            utf_16(u16::to_le_bytes, true),
            utf_16(u16::to_be_bytes, true),
            utf_16(u16::to_le_bytes, false),
            utf_16(u16::to_be_bytes, false),
        ] {
            assert_eq!(read(&bytes, None).unwrap(), (text.to_owned(), None));
        }
        let (decoded, warning) = read(&WINDOWS_1252.encode(text).0, None).unwrap();
        assert_eq!(decoded, text);
        assert!(warning.unwrap().contains("Windows-1252, by which `größe`"));
        // Typographic signs stand between words.
        let signs = "a,b\n1,the car’s – “nice” für\n";
        assert_eq!(read(&WINDOWS_1252.encode(signs).0, None).unwrap().0, signs);
    }

    #[test]
    fn an_encoding_that_cannot_be_told_is_refused_with_line_and_byte_and_read_where_it_is_named() {
        for (label, text) in [
            ("macintosh", "a,b\n1,größe\n"),
            ("ibm866", "a,b\n1,Скала\n"),
            ("windows-1251", "a,b\n1,Скала\n"),
        ] {
            let bytes = Encoding::for_label(label.as_bytes()).unwrap().encode(text).0;
            let error = read(&bytes, None).unwrap_err();
            assert!(
                error.contains("line 2") && error.contains("cannot be told"),
                "{label}: {error}"
            );
            assert_eq!(read(&bytes, Some(label)).unwrap().0, text, "{label}");
        }
        // ö in the code page of a German DOS.
        let error = read(b"a,b\n1,gr\x94\xe1e\n", None).unwrap_err();
        assert!(error.contains("the byte 94"), "{error}");
        assert!(read(b"a", Some("klingon")).unwrap_err().contains("`encoding = \"klingon\"`"));
        assert!(read(b"a,\xff\n", Some("utf-8")).unwrap_err().contains("is not UTF-8"));
    }
}

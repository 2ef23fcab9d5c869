//! Our three marks inside a line of text: `*italic*`, `_{lowered}` and `^{raised}`.
//!
//! Only strings written by this workspace go through here. A name that somebody typed is made
//! harmless first by [`literal`].

/// Where a run of text stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// On the line.
    Line,
    /// Below it, smaller.
    Lowered,
    /// Above it, smaller.
    Raised,
}

/// A stretch of text of one kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Run {
    /// What is written.
    pub text: String,
    /// Whether in italics.
    pub italic: bool,
    /// Where it stands.
    pub level: Level,
}

/// Makes any text mean itself: a mark in it loses its meaning.
///
/// # Example
/// ```
/// use maveric_stats::markup::{literal, plain};
/// assert_eq!(plain(&literal("*A*_{b}")), "*A*_{b}");
/// ```
pub fn literal(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for sign in text.chars() {
        if matches!(sign, '*' | '_' | '^' | '\\') {
            out.push('\\');
        }
        out.push(sign);
    }
    out
}

/// Splits a text at its marks. A mark that is not closed stands for itself.
pub fn runs(markup: &str) -> Vec<Run> {
    let mut out: Vec<Run> = Vec::new();
    let mut italic = false;
    let mut rest = markup;
    let mut push = |text: &str, italic: bool, level: Level| match out.last_mut() {
        Some(last) if last.italic == italic && last.level == level => last.text.push_str(text),
        _ => out.push(Run { text: text.to_owned(), italic, level }),
    };
    while let Some(sign) = rest.chars().next() {
        let after = &rest[sign.len_utf8()..];
        match sign {
            '\\' => {
                let escaped = after.chars().next().unwrap_or('\\');
                push(escaped.encode_utf8(&mut [0; 4]), italic, Level::Line);
                rest = after.strip_prefix(escaped).unwrap_or("");
            }
            '*' if italic || after.contains('*') => {
                italic = !italic;
                rest = after;
            }
            '_' | '^' => {
                let level = if sign == '_' { Level::Lowered } else { Level::Raised };
                let inside = after.strip_prefix('{').and_then(|inside| inside.split_once('}'));
                if let Some((inside, beyond)) = inside {
                    push(inside, italic, level);
                    rest = beyond;
                } else {
                    push(if sign == '_' { "_" } else { "^" }, italic, Level::Line);
                    rest = after;
                }
            }
            _ => {
                push(sign.encode_utf8(&mut [0; 4]), italic, Level::Line);
                rest = after;
            }
        }
    }
    out
}

/// The text without marks, for alt texts, CSV and terminals.
///
/// A raised 2 becomes `²`; a lowered word keeps an underscore before it (`p_Holm`), a lowered
/// letter does not (`ηp²`).
pub fn plain(markup: &str) -> String {
    let mut out = String::new();
    for run in runs(markup) {
        match (run.level, run.text.as_str()) {
            (Level::Raised, "2") => out.push('²'),
            (Level::Lowered, word) if word.chars().count() > 1 => {
                out.push('_');
                out.push_str(word);
            }
            (_, text) => out.push_str(text),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_that_is_not_closed_stands_for_itself() {
        assert_eq!(plain("2 * 3 _x ^"), "2 * 3 _x ^");
        assert_eq!(plain("_{never closed"), "_{never closed");
        assert_eq!(plain("ends in \\"), "ends in \\");
    }

    #[test]
    fn lowered_words_keep_an_underscore_in_plain_text() {
        assert_eq!(plain("*p*_{Holm} < .001"), "p_Holm < .001");
        assert_eq!(plain("*η*_{p}^{2}"), "ηp²");
    }
}

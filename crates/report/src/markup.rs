//! Our three marks inside a line of text: `*italic*`, `_{lowered}` and `^{raised}`.
//!
//! Only strings written by this workspace go through here. A name that somebody typed is made
//! harmless first by [`literal`].

use std::fmt::Write as _;

/// Where a run of text stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Level {
    /// On the line.
    Line,
    /// Below it, smaller.
    Lowered,
    /// Above it, smaller.
    Raised,
}

/// A stretch of text of one kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) text: String,
    pub(crate) italic: bool,
    pub(crate) level: Level,
}

/// Makes any text mean itself: a mark in it loses its meaning.
///
/// # Example
/// ```
/// use maveric_report::markup::{literal, plain};
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
pub(crate) fn runs(markup: &str) -> Vec<Run> {
    let mut out: Vec<Run> = Vec::new();
    let mut italic = false;
    let mut rest = markup;
    let mut push = |text: &str, italic: bool, level: Level| match out.last_mut() {
        Some(last) if last.italic == italic && last.level == level => last.text.push_str(text),
        _ => out.push(Run {
            text: text.to_owned(),
            italic,
            level,
        }),
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
                let level = if sign == '_' {
                    Level::Lowered
                } else {
                    Level::Raised
                };
                let inside = after
                    .strip_prefix('{')
                    .and_then(|inside| inside.split_once('}'));
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

/// Escapes text for HTML and XML and drops the control characters that neither allows.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for sign in text.chars() {
        match sign {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' => out.push(sign),
            _ if sign.is_control() || matches!(sign, '\u{fffe}' | '\u{ffff}') => {}
            _ => out.push(sign),
        }
    }
    out
}

/// The text as HTML, marks as elements, everything else escaped.
///
/// # Example
/// ```
/// assert_eq!(maveric_report::markup::html("*p* & <b>"), "<i>p</i> &amp; &lt;b&gt;");
/// ```
pub fn html(markup: &str) -> String {
    let mut out = String::new();
    for run in runs(markup) {
        // A statistic does not break before or after its sign.
        let mut text = escape(&run.text)
            .replace(" = ", "\u{a0}=\u{a0}")
            .replace(" &lt; ", "\u{a0}&lt;\u{a0}");
        if run.italic {
            text = format!("<i>{text}</i>");
        }
        let _ = match run.level {
            Level::Line => write!(out, "{text}"),
            Level::Lowered => write!(out, "<sub>{text}</sub>"),
            Level::Raised => write!(out, "<sup>{text}</sup>"),
        };
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_become_elements_and_signs_are_escaped() {
        assert_eq!(
            html("*η*^{2}_{p}= .5 & <b>"),
            "<i>η</i><sup>2</sup><sub>p</sub>= .5 &amp; &lt;b&gt;"
        );
    }

    #[test]
    fn a_mark_that_is_not_closed_stands_for_itself() {
        assert_eq!(plain("2 * 3 _x ^"), "2 * 3 _x ^");
        assert_eq!(plain("_{never closed"), "_{never closed");
        assert_eq!(plain("ends in \\"), "ends in \\");
    }

    #[test]
    fn a_name_cannot_become_markup() {
        let name = r#"*Eve*_{x}\ <script>"alert"</script>"#;
        assert_eq!(plain(&literal(name)), name);
        assert!(!html(&literal(name)).contains("<i>"));
        assert!(!html(&literal(name)).contains("<script>"));
    }

    #[test]
    fn lowered_words_keep_an_underscore_in_plain_text() {
        assert_eq!(plain("*p*_{Holm} < .001"), "p_Holm < .001");
        assert_eq!(plain("*η*_{p}^{2}"), "ηp²");
    }

    #[test]
    fn control_characters_are_dropped() {
        assert_eq!(escape("a\u{0}b\u{8}c\n"), "abc\n");
    }
}

//! A line of text with our three marks, `*italic*`, `_{lowered}` and `^{raised}`, for the page.
//!
//! Only strings written by this workspace go through here. A name that somebody typed is made
//! harmless first by [`literal`].

use std::fmt::Write as _;

pub use maveric_stats::markup::{Level, Run, literal, plain, runs};

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
        let mut text =
            escape(&run.text).replace(" = ", "\u{a0}=\u{a0}").replace(" &lt; ", "\u{a0}&lt;\u{a0}");
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

/// A sentence with its first letter large.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
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
    fn a_name_cannot_become_markup() {
        let name = r#"*Eve*_{x}\ <script>"alert"</script>"#;
        assert_eq!(plain(&literal(name)), name);
        assert!(!html(&literal(name)).contains("<i>"));
        assert!(!html(&literal(name)).contains("<script>"));
    }

    #[test]
    fn control_characters_are_dropped() {
        assert_eq!(escape("a\u{0}b\u{8}c\n"), "abc\n");
    }
}

//! Words that a page explains where they first stand in a part of it.

use crate::markup::escape;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Elements whose text stays as it is: what acts, what is code, what is a heading, what is drawn.
const LEFT: [&str; 19] = [
    "head", "svg", "script", "style", "a", "button", "code", "pre", "select", "h1", "h2", "h3",
    "summary", "abbr", "label", "canvas", "bdi", "nav", "header",
];

/// The page with every term in an `abbr` where it first stands in a section or a card, and the terms that it has.
pub(crate) fn explained<'a>(
    html: &str,
    terms: &'a [(String, String)],
) -> (String, BTreeSet<&'a str>) {
    let mut out = String::with_capacity(html.len() + html.len() / 50);
    let (mut found, mut here) = (BTreeSet::new(), BTreeSet::new());
    let mut within: Option<(String, usize)> = None;
    let mut rest = html;
    while let Some(open) = rest.find('<') {
        let (text, tagged) = rest.split_at(open);
        push(&mut out, text, within.is_none(), terms, &mut here, &mut found);
        let end = tagged.find('>').map_or(tagged.len(), |at| at + 1);
        let (tag, after) = tagged.split_at(end);
        out.push_str(tag);
        let name: String = tag
            .trim_start_matches(['<', '/'])
            .chars()
            .take_while(char::is_ascii_alphanumeric)
            .collect();
        let closes = tag.starts_with("</");
        match &mut within {
            Some((left, depth)) if *left == name => {
                *depth = if closes { *depth - 1 } else { *depth + 1 };
                if *depth == 0 {
                    within = None;
                }
            }
            None if !closes && !tag.ends_with("/>") && LEFT.contains(&name.as_str()) => {
                within = Some((name.clone(), 1));
            }
            _ => {}
        }
        if !closes && matches!(name.as_str(), "section" | "article") {
            here.clear();
        }
        rest = after;
    }
    push(&mut out, rest, within.is_none(), terms, &mut here, &mut found);
    (out, found)
}

fn push<'a>(
    out: &mut String,
    text: &str,
    reads: bool,
    terms: &'a [(String, String)],
    here: &mut BTreeSet<&'a str>,
    found: &mut BTreeSet<&'a str>,
) {
    let mut rest = text;
    let mut next = || -> Option<()> {
        let unexplained = terms.iter().filter(|(term, _)| reads && !here.contains(term.as_str()));
        let (at, term, meaning) = unexplained
            .filter_map(|(term, meaning)| Some((word(rest, term)?, term, meaning)))
            .min_by_key(|(at, term, _)| (*at, usize::MAX - term.len()))?;
        let (before, after) = rest.split_at(at);
        let (shown, after) = after.split_at(term.len());
        out.push_str(before);
        let _ = write!(out, "<abbr title=\"{}\">{shown}</abbr>", escape(meaning));
        here.insert(term.as_str());
        found.insert(term.as_str());
        rest = after;
        Some(())
    };
    while next().is_some() {}
    out.push_str(rest);
}

/// Where a term stands as a word of its own; its first letter may be large.
fn word(text: &str, term: &str) -> Option<usize> {
    let part = |sign: char| sign.is_alphanumeric() || matches!(sign, '-' | '_' | ';' | '&');
    let matches = |start: usize| {
        let Some(found) = text.get(start..start + term.len()) else {
            return false;
        };
        let same = found == term || {
            let (mut a, mut b) = (found.chars(), term.chars());
            let first = a.next().zip(b.next());
            first.is_some_and(|(a, b)| a.is_ascii_uppercase() && a.to_ascii_lowercase() == b)
                && a.as_str() == b.as_str()
        };
        let before = text[..start].chars().next_back().is_some_and(part);
        let after = text[start + term.len()..].chars().next().is_some_and(char::is_alphanumeric);
        same && !before && !after
    };
    text.char_indices().map(|(at, _)| at).find(|at| matches(*at))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terms() -> Vec<(String, String)> {
        [("ADB", "a \"scale\""), ("merge back", "the change back"), ("λ", "a gap")]
            .map(|(a, b)| (a.to_owned(), b.to_owned()))
            .to_vec()
    }

    #[test]
    fn a_term_is_explained_once_a_section_and_not_within_what_acts_or_draws() {
        let (html, found) = {
            let terms = terms();
            let page = "<section><p>ADB score, ADB</p><svg><text>ADB</text></svg><a>merge back</a> Merge back; λ, ADBx</section><article>ADB</article>";
            let (html, found) = explained(page, &terms);
            (html, found.len())
        };
        assert_eq!(
            html,
            "<section><p><abbr title=\"a &quot;scale&quot;\">ADB</abbr> score, ADB</p><svg><text>ADB</text></svg><a>merge back</a> \
             <abbr title=\"the change back\">Merge back</abbr>; <abbr title=\"a gap\">λ</abbr>, ADBx</section>\
             <article><abbr title=\"a &quot;scale&quot;\">ADB</abbr></article>"
        );
        assert_eq!(found, 3);
    }
}

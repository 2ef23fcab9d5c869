//! What a reader sees of a page.

use super::tells;
use std::path::Path;

/// The words of a page, without scripts, styles and the files that are shown whole.
pub struct Page(String);

/// Takes out every `<tag …>…</tag>`.
fn without(html: &str, tag: &str) -> String {
    let (open, close) = (format!("<{tag}"), format!("</{tag}>"));
    let mut parts = html.split(&open);
    let mut kept = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        kept.push_str(part.split_once(&close).map_or("", |(_, rest)| rest));
    }
    kept
}

impl Page {
    pub fn read(path: &Path) -> Self {
        let html = std::fs::read_to_string(path).unwrap();
        let html = ["script", "style", "pre"].iter().fold(html, |html, tag| without(&html, tag));
        let mut text = String::new();
        for part in html.split('<') {
            // Marks stand within words; everything else divides them.
            let (tag, rest) = part.split_once('>').unwrap_or(("", part));
            let name = tag.trim_start_matches('/');
            let within = ["i", "b", "em", "sub", "sup", "span", "abbr"]
                .iter()
                .any(|t| name.split_whitespace().next() == Some(t));
            text.push_str(if within { "" } else { " " });
            text.push_str(rest);
        }
        let text = text.replace("&#39;", "'").replace("&lt;", "<").replace("&#x2f;", "/");
        Self(text.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    /// The page has each of these.
    #[track_caller]
    pub fn says(&self, words: &[&str]) -> &Self {
        tells(&self.0, words);
        self
    }

    /// The page has none of these, whatever the case, before the list of files with their hashes.
    #[track_caller]
    pub fn is_silent_of(&self, words: &[&str]) -> &Self {
        let told = self.0.split("Files read").next();
        let text = told.unwrap_or_default().to_lowercase();
        for word in words {
            let seen = text.find(&word.to_lowercase()).map(|at| {
                let from = text[..at].char_indices().rev().nth(80).map_or(0, |c| c.0);
                text[from..].chars().take(200).collect::<String>()
            });
            assert_eq!(seen, None, "`{word}` is on the page");
        }
        self
    }
}

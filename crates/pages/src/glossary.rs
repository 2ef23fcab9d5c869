//! The words of `docs/glossary.md`, for pages.

/// The table of the glossary, compiled in: one list for documents and pages (the crate has a link to it, so that it can be packaged).
const GLOSSARY: &str = include_str!("../glossary.md");

/// Each term with its meaning. A row of several terms (`RM-ANOVA, ANOVA`) is one entry each; what stands in parentheses is no term.
pub fn glossary() -> Vec<(String, String)> {
    let rows = GLOSSARY.lines().filter(|l| l.starts_with("| ") && !l.starts_with("| word"));
    let mut entries = Vec::new();
    for row in rows {
        let mut cells = row.trim_matches('|').splitn(2, '|').map(str::trim);
        let (Some(terms), Some(meaning)) = (cells.next(), cells.next()) else {
            continue;
        };
        let meaning = meaning.replace(['`', '*'], "");
        for term in terms.split(',') {
            let term = term.split('(').next().unwrap_or_default().trim().replace('*', "");
            // Words of everyday speech explain themselves in most sentences.
            let rare = term.chars().any(|c| c.is_uppercase() || !c.is_ascii())
                || term.contains(' ')
                || RARE.contains(&term.as_str());
            if rare && term.chars().count() > 1 || term == "λ" {
                entries.push((term, meaning.clone()));
            }
        }
    }
    entries
}

/// Terms in small letters that a reader may not know.
const RARE: [&str; 7] =
    ["homophily", "sphericity", "clamped", "embedding", "hand-over", "internal", "external"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_glossary_has_the_words_that_pages_use() {
        let found = glossary();
        for term in [
            "ADB",
            "AV",
            "λ",
            "homophily",
            "merge back",
            "MDSI",
            "RM-ANOVA",
            "hand-over",
            "internal",
            "external",
        ] {
            assert!(found.iter().any(|(t, m)| t == term && m.len() > 8), "{term}");
        }
        assert!(found.iter().all(|(t, _)| !t.contains('|') && !t.contains('`')));
    }
}

//! References: as they are written, and taken apart for a reference manager where they follow APA.

use super::{Block, plainly};
use maveric_report::{markup, tables::latex};

/// What is cited, under a key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Reference {
    pub(crate) key: String,
    /// As it is written, plain.
    pub(crate) text: String,
}

/// The parts of a reference in the form of APA: `Authors (Year). Title. Journal, volume, pages.`
#[derive(Debug, PartialEq, Eq)]
struct Parts<'a> {
    authors: Vec<String>,
    year: &'a str,
    title: &'a str,
    /// Journal, volume and pages of an article; else whatever tells where it appeared.
    place: Result<[&'a str; 3], &'a str>,
}

impl<'a> Parts<'a> {
    /// `None` where it has another form: nothing is guessed.
    fn parse(text: &'a str) -> Option<Self> {
        let (authors, rest) = text.split_once(" (")?;
        let (year, rest) = rest.split_once("). ")?;
        if year.len() != 4 || !year.chars().all(|c| c.is_ascii_digit()) {
            return None;
        }
        let names: Vec<&str> = authors.split(", ").collect();
        let pairs = names.chunks_exact(2);
        if !pairs.remainder().is_empty() {
            return None;
        }
        let author = |pair: &[&str]| {
            let surname = pair[0].trim_start_matches("& ");
            pair[1].ends_with('.').then(|| format!("{surname}, {}", pair[1]))
        };
        let authors = pairs.map(author).collect::<Option<Vec<_>>>()?;
        let (title, place) = rest.trim_end_matches('.').rsplit_once(". ")?;
        Some(Self { authors, year, title, place: article(place).ok_or(place) })
    }
}

/// `Journal, 5, 269-278` as its three parts.
fn article(place: &str) -> Option<[&str; 3]> {
    let (rest, pages) = place.rsplit_once(", ")?;
    let (journal, volume) = rest.rsplit_once(", ")?;
    let number = |text: &str| text.starts_with(|c: char| c.is_ascii_digit());
    (number(volume) && number(pages) && !number(journal)).then_some([journal, volume, pages])
}

/// An entry a reference: an article where it follows APA, else its text as a note.
pub(super) fn bib(references: &[Reference]) -> String {
    let entry = |reference: &Reference| {
        let write = |text: &str| latex(&markup::literal(text));
        let field = |name: &str, text: &str| format!("  {name} = {{{text}}}");
        let (kind, fields) = match Parts::parse(&reference.text) {
            None => ("misc", vec![field("note", &write(&reference.text))]),
            Some(parts) => {
                // Double braces: capitals of a title stay.
                let mut fields = vec![
                    field("author", &write(&parts.authors.join(" and "))),
                    field("title", &format!("{{{}}}", write(parts.title))),
                    field("year", parts.year),
                ];
                let kind = match parts.place {
                    Ok([journal, volume, pages]) => {
                        fields.push(field("journal", &write(journal)));
                        fields.push(field("volume", &write(volume)));
                        fields.push(field("pages", &write(pages).replace('-', "--")));
                        "article"
                    }
                    Err(place) => {
                        fields.push(field("howpublished", &write(place)));
                        "misc"
                    }
                };
                (kind, fields)
            }
        };
        format!("@{kind}{{{},\n{}\n}}\n\n", reference.key, fields.join(",\n"))
    };
    references.iter().map(entry).collect()
}

/// A heading and a paragraph a reference; nothing without any.
pub(super) fn listed(references: &[Reference]) -> Vec<Block> {
    let mut texts: Vec<&str> = references.iter().map(|r| r.text.as_str()).collect();
    texts.sort_unstable();
    texts.dedup();
    let heading = Block::Heading(2, "References".to_owned());
    let heading = (!texts.is_empty()).then_some(heading);
    heading.into_iter().chain(texts.into_iter().map(plainly)).collect()
}

/// What makes LaTeX list them.
pub(super) fn cited(references: &[Reference]) -> String {
    if references.is_empty() {
        return String::new();
    }
    let keys: Vec<&str> = references.iter().map(|r| r.key.as_str()).collect();
    format!("\\nocite{{{}}}\n", keys.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(text: &str) -> String {
        let (key, text) = ("one".to_owned(), text.to_owned());
        bib(&[Reference { key, text }])
    }

    #[test]
    fn an_article_is_taken_apart_with_every_author_year_and_journal() {
        let text = "Jian, J.-Y., Bisantz, A. M., & Drury, C. G. (2000). Foundations for a scale. International Journal of Cognitive Ergonomics, 4, 53-71.";
        let bib = entry(text);
        for part in [
            "@article{one,\n",
            "author = {Jian, J.-Y. and Bisantz, A. M. and Drury, C. G.}",
            "title = {{Foundations for a scale}}",
            "year = {2000}",
            "journal = {International Journal of Cognitive Ergonomics}",
            "volume = {4}",
            "pages = {53--71}",
        ] {
            assert!(bib.contains(part), "{part} in {bib}");
        }
    }

    #[test]
    fn what_is_no_article_says_where_it_appeared_and_what_has_another_form_stays_a_note() {
        let bib = entry("Carpinella, C. M. (2017). RoSAS: Development. HRI '17, 254-262.");
        assert!(
            bib.contains("@misc") && bib.contains("howpublished = {HRI '17, 254-262}"),
            "{bib}"
        );
        let bib = entry("A & B_1 (50 %) {x}");
        assert!(bib.contains("note = {A \\& B\\_1 (50 \\%) \\{x\\}}"), "{bib}");
        assert!(
            !entry("Schrum, M., & Best, A. MAVERIC: an approach (unpublished).").contains("author")
        );
    }

    #[test]
    fn without_references_there_is_no_heading() {
        assert!(listed(&[]).is_empty() && cited(&[]).is_empty());
    }
}

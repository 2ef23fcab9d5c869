//! Names of columns with parts that say something: `{condition}_TLX_{item}`.

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Pattern(Vec<Part>);

#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    Text(String),
    Item,
    /// `{condition}` or `{moment}`: a word that means one.
    Moment,
    /// The number of the ride, from 1.
    Trial,
}

/// What the parts of a name say.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct NameParts<'n> {
    pub(super) item: u32,
    pub(super) moment: Option<&'n str>,
    pub(super) trial: Option<usize>,
}

const PARTS: [(&str, Part); 4] = [
    ("{item}", Part::Item),
    ("{condition}", Part::Moment),
    ("{moment}", Part::Moment),
    ("{trial}", Part::Trial),
];

impl Pattern {
    /// Reads a pattern.
    ///
    /// # Errors
    /// A sentence for one without `{item}`, with a part twice, or with one that is not known.
    pub(super) fn new(text: &str) -> Result<Self, String> {
        let mut parts = Vec::new();
        let mut rest = text;
        while let Some(at) = rest.find('{') {
            let known = PARTS.iter().find(|(word, _)| rest[at..].starts_with(word));
            let Some((word, part)) = known else {
                let words: Vec<&str> = PARTS.iter().map(|(word, _)| *word).collect();
                return Err(format!(
                    "column `{text}`: `{}` is not a part of a name; expected {}",
                    &rest[at..],
                    words.join(", ")
                ));
            };
            if at > 0 {
                parts.push(Part::Text(rest[..at].to_owned()));
            }
            if parts.contains(part) {
                return Err(format!("column `{text}` has `{word}`, or what says the same, twice"));
            }
            parts.push(part.clone());
            rest = &rest[at + word.len()..];
        }
        if !rest.is_empty() {
            parts.push(Part::Text(rest.to_owned()));
        }
        if !parts.contains(&Part::Item) {
            return Err(format!(
                "column `{text}` has no `{{item}}` where the item's number stands"
            ));
        }
        Ok(Self(parts))
    }

    /// Whether a condition or moment stands in the names.
    pub(super) fn names_a_moment(&self) -> bool {
        self.0.contains(&Part::Moment)
    }

    /// What a name says by this pattern; an item is its number, or its place among `words`.
    pub(super) fn read<'n>(&self, name: &'n str, words: &[String]) -> Option<NameParts<'n>> {
        read(&self.0, name, words)
    }

    /// What stands before the item's number, and what behind it.
    pub(super) fn around_item(&self) -> (String, String) {
        let item = self.0.iter().position(|p| *p == Part::Item).unwrap_or(0);
        let text = |parts: &[Part]| parts.iter().map(Part::text).collect();
        (text(&self.0[..item]), text(&self.0[item + 1..]))
    }
}

impl std::fmt::Display for Pattern {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.iter().try_for_each(|part| f.write_str(part.text()))
    }
}

impl Part {
    fn text(&self) -> &str {
        match self {
            Self::Text(text) => text,
            Self::Item => "{item}",
            Self::Moment => "{condition}",
            Self::Trial => "{trial}",
        }
    }
}

fn read<'n>(parts: &[Part], name: &'n str, words: &[String]) -> Option<NameParts<'n>> {
    let Some((part, rest)) = parts.split_first() else {
        return name.is_empty().then(NameParts::default);
    };
    if let Part::Text(text) = part {
        return read(rest, name.strip_prefix(text.as_str())?, words);
    }
    let ends = name.char_indices().map(|(at, c)| at + c.len_utf8());
    let mut taken = ends.filter_map(|end| {
        let (word, behind) = name.split_at(end);
        let parts_behind = read(rest, behind, words)?;
        Some(match part {
            Part::Item => NameParts { item: item(word, words)?, ..parts_behind },
            Part::Trial => NameParts { trial: Some(number(word)?), ..parts_behind },
            _ => NameParts { moment: Some(word), ..parts_behind },
        })
    });
    taken.next()
}

fn item(word: &str, words: &[String]) -> Option<u32> {
    if words.is_empty() {
        return number(word);
    }
    let place = words.iter().position(|w| w == word)?;
    u32::try_from(place + 1).ok()
}

/// A number of digits alone; zeros may stand before it.
fn number<T: std::str::FromStr>(word: &str) -> Option<T> {
    let digits = word.bytes().all(|b| b.is_ascii_digit());
    word.parse().ok().filter(|_| digits)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_name<'n>(pattern: &str, name: &'n str) -> Option<NameParts<'n>> {
        Pattern::new(pattern).unwrap().read(name, &[])
    }

    #[test]
    fn the_parts_of_a_name_say_item_condition_and_trial() {
        let parts = read_name("{condition}_TLX_{item}", "very_calm_TLX_12").unwrap();
        assert_eq!((parts.item, parts.moment), (12, Some("very_calm")));
        let parts = read_name("{moment}TLX[SQ{item}]", "KTLX[SQ001]").unwrap();
        assert_eq!((parts.item, parts.moment), (1, Some("K")));
        let parts = read_name("{trial}_Q3_{item}", "2_Q3_6").unwrap();
        assert_eq!((parts.item, parts.trial), (6, Some(2)));
        for name in ["calm_TLX_", "_TLX_1", "calm_TLX_x", "calm_TLX_1 (column 4)", "calm_TLY_1"] {
            assert_eq!(read_name("{condition}_TLX_{item}", name), None, "{name}");
        }
        assert_eq!(read_name("{trial}_Q3_{item}", "a_Q3_6"), None);
    }

    #[test]
    fn items_may_have_words() {
        let words = ["mental", "effort"].map(str::to_owned);
        let pattern = Pattern::new("TLX_{item}").unwrap();
        assert_eq!(pattern.read("TLX_effort", &words).unwrap().item, 2);
        assert_eq!(pattern.read("TLX_2", &words), None);
    }

    #[test]
    fn a_pattern_that_cannot_be_read_says_why() {
        for (pattern, why) in [
            ("TLX", "no `{item}`"),
            (
                "{item}_{session}",
                "`{session}` is not a part of a name; expected {item}, {condition}",
            ),
            ("{condition}{moment}{item}", "twice"),
        ] {
            let error = Pattern::new(pattern).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
    }
}

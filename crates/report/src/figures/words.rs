//! Pieces of captions that several figures say.

use crate::markup;

/// Each panel's title and what its statistic says, in words.
pub(crate) fn described<'a>(panels: impl IntoIterator<Item = (&'a str, &'a str)>) -> String {
    sentences(panels.into_iter().map(|(title, statistic)| {
        let statistic = markup::plain(statistic).replace('\n', "; ");
        format!("{title}: {statistic}.")
    }))
}

/// How many there are: one number, or the least and the most and by what they differ.
pub(crate) fn counted(counts: impl Iterator<Item = usize> + Clone, by: &str) -> String {
    let (least, most) = (counts.clone().min(), counts.max());
    match (least.unwrap_or(0), most.unwrap_or(0)) {
        (least, most) if least == most => most.to_string(),
        (least, most) => format!("{least} to {most}{by}"),
    }
}

/// The name of a part of a figure that takes several, and how its title ends; `part` is its number and that of all.
pub(crate) fn of_part(name: &str, part: Option<(usize, usize)>) -> (String, String) {
    let name = match part {
        Some((part @ 2.., _)) => format!("{name}-{part}"),
        _ => name.to_owned(),
    };
    let end = part.map(|(part, count)| format!(", part {part} of {count}"));
    (name, end.unwrap_or_default())
}

/// Sentences one after the other.
pub(crate) fn sentences(parts: impl IntoIterator<Item = String>) -> String {
    parts.into_iter().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_that_differ_say_by_what() {
        assert_eq!(counted([4, 4].into_iter(), ", by panel"), "4");
        assert_eq!(counted([7, 4, 9].into_iter(), ", by panel"), "4 to 9, by panel");
        assert_eq!(counted([].into_iter(), ""), "0");
    }
}

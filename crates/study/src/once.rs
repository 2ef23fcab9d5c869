//! What is the same of many is told once, with how many they are.

/// Names that are listed before the others are only counted.
const NAMED: usize = 6;

/// `a, b, c`; of more than six the first six `and 110 others`.
pub(crate) fn names<S: AsRef<str>>(of: &[S]) -> String {
    let shown: Vec<&str> = of.iter().take(NAMED).map(AsRef::as_ref).collect();
    let shown = shown.join(", ");
    match of.len().saturating_sub(NAMED) {
        0 => shown,
        1 => format!("{shown} and 1 other"),
        more => format!("{shown} and {more} others"),
    }
}

/// `a, b, …`: of more than `most` names the first.
pub(crate) fn first_names(names: impl IntoIterator<Item = impl AsRef<str>>, most: usize) -> String {
    let mut names = names.into_iter();
    let shown = names.by_ref().take(most).map(|name| name.as_ref().to_owned());
    let shown = shown.collect::<Vec<String>>().join(", ");
    shown + if names.next().is_some() { ", …" } else { "" }
}

/// What there is to tell of several things of a kind, in the order in which it first came: `drive P01-own: it is short`, or
/// `3 drives (P01-own, P02-own, P03-own): they are short` in the same words.
pub(crate) fn told_once(
    kind: &str,
    rows: impl IntoIterator<Item = (String, String)>,
) -> Vec<String> {
    let lines = together(rows).into_iter();
    lines
        .map(|(who, what)| match who.as_slice() {
            [one] => format!("{kind} {one}: {what}"),
            all => format!("{} {kind}s ({}): {what}", all.len(), names(all)),
        })
        .collect()
}

/// Everybody of whom the same is to be told, each once, in the order in which it first came.
pub(crate) fn together<What: PartialEq>(
    rows: impl IntoIterator<Item = (String, What)>,
) -> Vec<(Vec<String>, What)> {
    let mut groups: Vec<(Vec<String>, What)> = Vec::new();
    for (who, what) in rows {
        match groups.iter_mut().find(|(_, known)| *known == what) {
            Some((ids, _)) if ids.contains(&who) => {}
            Some((ids, _)) => ids.push(who),
            None => groups.push((vec![who], what)),
        }
    }
    groups
}

/// `1 person`, `2 people`.
pub(crate) fn count(n: usize, one: &str, several: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { several })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hundred_and_sixteen_equal_warnings_are_one_line_and_another_one_is_its_own() {
        let row = |i: usize| (format!("P{i:03}"), "no lead vehicle".to_owned());
        let other = ("P007".to_owned(), "too short".to_owned());
        let told = told_once("drive", (1..=116).map(row).chain([other]));
        assert_eq!(
            told,
            [
                "116 drives (P001, P002, P003, P004, P005, P006 and 110 others): no lead vehicle",
                "drive P007: too short",
            ]
        );
    }

    #[test]
    fn six_are_named_and_of_seven_one_is_counted() {
        let ids = ["a", "b", "c", "d", "e", "f", "g"];
        assert_eq!(names(&ids[..6]), "a, b, c, d, e, f");
        assert_eq!(names(&ids), "a, b, c, d, e, f and 1 other");
        assert_eq!([first_names(ids, 2), first_names(&ids[..2], 2)], ["a, b, …", "a, b"]);
        assert_eq!(count(1, "person", "people"), "1 person");
        assert_eq!(count(0, "person", "people"), "0 people");
    }
}

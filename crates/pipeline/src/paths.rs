//! Paths as the pipeline file writes them: text, `/` between parts, relative to the root.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Bound;

/// The one spelling of a path: no `.`, no `//`, no `/` at the end, `..` only in front.
///
/// On Windows `\` parts as well.
///
/// `None` if nothing is left, or nothing but `..`: such a path holds the root itself, and
/// with it the ledger. Symbolic links are not looked at.
pub(crate) fn normalise(path: &str) -> Option<String> {
    let path =
        &*if cfg!(windows) { Cow::Owned(path.replace('\\', "/")) } else { Cow::Borrowed(path) };
    // The name of a computer stands behind two.
    let lead = if cfg!(windows) && path.starts_with("//") {
        "//"
    } else if path.starts_with('/') {
        "/"
    } else {
        ""
    };
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => {
                parts.pop();
            }
            ".." if !lead.is_empty() => {}
            _ => parts.push(part),
        }
    }
    if parts.last().is_none_or(|last| *last == "..") {
        return None;
    }
    Some(format!("{lead}{}", parts.join("/")))
}

/// The path itself and then each directory above it, nearest first.
pub(crate) fn with_ancestors(path: &str) -> impl Iterator<Item = &str> {
    std::iter::successors(Some(path), |path| {
        path.rfind('/').map(|slash| &path[..slash]).filter(|above| !above.is_empty())
    })
}

/// The entries of `map` whose paths lie below `path`, in order.
pub(crate) fn below<'a, V>(
    map: &'a BTreeMap<String, V>,
    path: &str,
) -> impl Iterator<Item = (&'a String, &'a V)> {
    let prefix = format!("{path}/");
    map.range::<str, _>((Bound::Included(prefix.as_str()), Bound::Unbounded))
        .take_while(move |(key, _)| key.starts_with(&prefix))
        .collect::<Vec<_>>()
        .into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_has_one_spelling() {
        assert_eq!(normalise("./a//b/../c/").as_deref(), Some("a/c"));
        assert_eq!(normalise("../elsewhere/data").as_deref(), Some("../elsewhere/data"));
        assert_eq!(normalise("/data/../x").as_deref(), Some("/x"));
    }

    #[test]
    fn the_root_and_what_is_above_are_no_paths() {
        for path in ["", ".", "a/..", "..", "../..", "/"] {
            assert_eq!(normalise(path), None, "{path}");
        }
    }

    #[test]
    fn only_whole_parts_lie_below() {
        let map = BTreeMap::from([("a/b".to_owned(), 1), ("ab/c".to_owned(), 2)]);
        let found: Vec<_> = below(&map, "a").map(|(_, v)| *v).collect();
        assert_eq!(found, [1]);
        assert_eq!(with_ancestors("a/b/c").collect::<Vec<_>>(), ["a/b/c", "a/b", "a"]);
        assert_eq!(with_ancestors("/a/b").collect::<Vec<_>>(), ["/a/b", "/a"]);
    }
}

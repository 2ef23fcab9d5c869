//! What a task told of its end.

use std::fs;
use std::path::Path;

use super::script;

/// How a task ended, in its own words.
#[derive(Debug, PartialEq)]
pub(super) struct Ending {
    pub(super) code: i32,
    pub(super) seconds: f64,
    /// What hindered it from moving its outputs into place.
    pub(super) word: Option<String>,
    /// Size and second of the last change of each file that it made, in order; none where the node cannot tell.
    pub(super) made: Vec<(u64, i64)>,
}

impl Ending {
    /// The ending of a task, if it has told one.
    pub(super) fn read(spool: &Path, index: u32) -> Option<Self> {
        Self::parse(&fs::read_to_string(script::ending(spool, index)).ok()?)
    }

    fn parse(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        let mut words = lines.next()?.split_whitespace();
        let stamp = |line: &str| {
            let (size, time) = line.split_once(' ')?;
            let second = time.split('.').next()?;
            Some((size.parse().ok()?, second.parse().ok()?))
        };
        let mut stamps: Vec<(u64, i64)> = lines.filter_map(stamp).collect();
        stamps.sort_unstable();
        Some(Self {
            code: words.next()?.parse().ok()?,
            seconds: words.next()?.parse().ok()?,
            word: words.next().map(str::to_owned),
            made: stamps,
        })
    }

    /// Whether none of its outputs was put in place.
    pub(super) fn has_moved_nothing(&self) -> bool {
        self.code != 0 && self.word.as_deref() != Some(script::HALF_MOVED)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ending_has_a_status_and_seconds_and_may_have_a_word_and_files() {
        let ending = |code, word: Option<&str>, made: &[(u64, i64)]| Ending {
            code,
            seconds: 3.0,
            word: word.map(str::to_owned),
            made: made.to_vec(),
        };
        assert_eq!(Ending::parse("1 3\n"), Some(ending(1, None, &[])));
        assert_eq!(Ending::parse("126 3 way\n"), Some(ending(126, Some("way"), &[])));
        let text = "0 3\n12 1700000001.25\n4 1700000000.0000000000\n";
        let made = [(4, 1_700_000_000), (12, 1_700_000_001)];
        assert_eq!(Ending::parse(text), Some(ending(0, None, &made)));
        for (text, moved_nothing) in
            [("0 3\n", false), ("126 3 half\n", false), ("126 3 way\n", true), ("1 3\n", true)]
        {
            let ending = Ending::parse(text).unwrap();
            assert_eq!(ending.has_moved_nothing(), moved_nothing, "{text}");
        }
        for text in ["", "0\n", "x 3\n"] {
            assert_eq!(Ending::parse(text), None, "{text}");
        }
    }
}

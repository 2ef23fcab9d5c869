//! Names below an axis: on one line where they fit, else on several, else reading upwards.

use super::canvas::{Canvas, Look, cap_height};
use super::theme::size;
use crate::markup;

/// Most lines of a name.
const MOST_LINES: usize = 3;
/// Of so many names one may be cut before all read upwards.
const MOST_WHOLE: usize = 4;
/// A name that reads upwards is cut at this many points.
const LONGEST: f64 = 78.0;
/// Points between two names.
const GAP: f64 = 1.0;
/// From one line of names to the next.
pub(crate) const LINE: f64 = 1.18 * size::TICK;

/// How the names of an axis are set.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Names {
    /// Lines, one below the other.
    Level(Vec<Vec<String>>),
    /// Reading upwards.
    Turned(Vec<String>),
}

impl Names {
    /// Names, each with so many points from its neighbour.
    ///
    /// A long name among many that fit stands below those beside it, or is cut, if enough of it is left to tell it from the others.
    pub(crate) fn set(names: &[String], space: f64) -> Self {
        let room = space - GAP;
        let look = Look::new(size::TICK);
        let line_fits = |line: &str| look.width(line) <= room;
        let lines = names.iter().map(|name| wrapped(name, line_fits));
        let lines: Vec<Vec<String>> = lines.collect();
        let cut = |lines: &[String]| -> Vec<String> {
            lines.iter().map(|l| shortened(l, room)).collect()
        };
        let set = (0..lines.len())
            .map(|at| lowered(&lines, at, space).unwrap_or_else(|| cut(&lines[at])));
        let set: Vec<Vec<String>> = set.collect();
        let long = || lines.iter().zip(&set).filter(|(whole, cut)| whole != cut);
        let fits = set.iter().all(|l| {
            let is_lowered = l.first().is_some_and(String::is_empty);
            l.len() <= MOST_LINES && (is_lowered || l.iter().all(|line| line_fits(line)))
        });
        let different = (1..set.len()).all(|i| !set[..i].contains(&set[i]));
        if fits && different && long().count() * MOST_WHOLE <= names.len() {
            return Self::Level(set);
        }
        Self::Turned(names.iter().map(|name| shortened(name, LONGEST)).collect())
    }

    /// Places of the names that are not shown whole.
    pub(crate) fn cut(&self) -> Vec<usize> {
        let has_ellipsis = |text: &String| text.ends_with('…');
        let cut: Vec<bool> = match self {
            Self::Level(names) => names.iter().map(|l| l.iter().any(has_ellipsis)).collect(),
            Self::Turned(names) => names.iter().map(has_ellipsis).collect(),
        };
        (0..cut.len()).filter(|at| cut[*at]).collect()
    }

    /// Points from the ticks to the foot of the lowest.
    pub(crate) fn height(&self) -> f64 {
        match self {
            Self::Level(names) => {
                let lines = names.iter().map(Vec::len).max().unwrap_or(1);
                cap_height(size::TICK) + LINE * lines.saturating_sub(1) as f64
            }
            Self::Turned(names) => Look::new(size::TICK).widest(names),
        }
    }

    /// Draws one of them below a point.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, index: usize, (x, y): (f64, f64)) {
        let look = Look::new(size::TICK);
        match self {
            Self::Level(names) => {
                let lines = names[index].iter().enumerate();
                for (line, text) in lines.filter(|(_, text)| !text.is_empty()) {
                    let start = (x, y + LINE * line as f64);
                    canvas.text(text, start, look.middle().hanging());
                }
            }
            Self::Turned(names) => {
                canvas.text(&names[index], (x, y), look.end().centred().turned());
            }
        }
    }
}

/// A word too long for its own place, below the names beside it if these fit and it ends within the panel.
fn lowered(lines: &[Vec<String>], at: usize, space: f64) -> Option<Vec<String>> {
    let look = Look::new(size::TICK);
    let fits = |line: &String| look.width(line) <= space - GAP;
    let [name] = &lines[at][..] else {
        return None;
    };
    // At either end there is half a place and a little more.
    if fits(name) || look.width(name) > 1.2 * space + 4.0 {
        return None;
    }
    let beside = at.checked_sub(1).into_iter().chain([at + 1]);
    let beside: Vec<&Vec<String>> = beside.filter_map(|at| lines.get(at)).collect();
    if !beside.iter().copied().flatten().all(fits) {
        return None;
    }
    let above = beside.iter().map(|lines| lines.len()).max();
    let above = above.filter(|lines| *lines > 0)?;
    let mut set = vec![String::new(); above];
    set.push(name.clone());
    Some(set)
}

/// A text on as few lines as its words need where each line is to fit.
pub(crate) fn wrapped(text: &str, fits: impl Fn(&str) -> bool) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if fits(&format!("{line} {word}")) => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A line with marks on as many as a width takes. A statement such as `*p* = .04` and what stands in brackets stay whole where they fit; a word
/// that does not fit is divided at its dots and underscores.
pub(crate) fn fitted(text: &str, look: Look, width: f64) -> Vec<String> {
    let fits = |line: &str| look.width(line) <= width;
    let mut lines: Vec<String> = Vec::new();
    for (gap, piece) in pieces(text, fits) {
        match lines.last_mut() {
            Some(line) if fits(&format!("{line}{gap}{piece}")) => {
                line.push_str(gap);
                line.push_str(&piece);
            }
            _ => lines.push(piece),
        }
    }
    lines
}

/// What can begin a line, each with what parts it from the piece before.
fn pieces(text: &str, fits: impl Fn(&str) -> bool) -> Vec<(&'static str, String)> {
    let mut pieces = Vec::new();
    for whole in statements(text) {
        if fits(&whole) {
            pieces.push((" ", whole));
            continue;
        }
        for word in whole.split_whitespace() {
            if fits(word) {
                pieces.push((" ", word.to_owned()));
                continue;
            }
            let parts = word.split_inclusive(['.', '_']).enumerate();
            pieces
                .extend(parts.map(|(at, part)| (if at == 0 { " " } else { "" }, part.to_owned())));
        }
    }
    pieces
}

/// Words, those about a sign of relation and those in brackets in one.
fn statements(text: &str) -> Vec<String> {
    let is_sign = |word: &str| matches!(word, "=" | "<" | ">");
    let goes_on = |whole: &str, word: &str| {
        let brackets = |signs: [char; 2]| whole.matches(signs).count();
        brackets(['(', '[']) > brackets([')', ']'])
            || is_sign(word)
            || whole.split_whitespace().next_back().is_some_and(is_sign)
    };
    let mut out: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match out.last_mut() {
            Some(whole) if goes_on(whole.as_str(), word) => {
                whole.push(' ');
                whole.push_str(word);
            }
            _ => out.push(word.to_owned()),
        }
    }
    out
}

/// A name that fits, cut with an ellipsis.
pub(crate) fn shortened(name: &str, room: f64) -> String {
    let look = Look::new(size::TICK);
    let mut kept: String = name.to_owned();
    while look.width(&markup::literal(&kept)) > room && kept.chars().count() > 4 {
        kept = kept.trim_end_matches('…').chars().collect::<String>();
        kept.pop();
        kept = format!("{}…", kept.trim_end());
    }
    kept
}

/// A plain name on one line, else on two; of what does not fit there, the end stays: in it names of one kind differ.
pub(crate) fn on_two_lines(name: &str, room: f64) -> Vec<String> {
    let look = Look::new(size::TICK);
    let fits = |line: &str| look.width(&markup::literal(line)) <= room;
    let lines = fitted(name, look, room);
    let Some((first, others)) = lines.split_first() else {
        return Vec::new();
    };
    let mut set = vec![shortened(first, room)];
    if !others.is_empty() {
        let rest = name.strip_prefix(first.as_str()).map(str::trim_start);
        let mut end = rest.map_or_else(|| others.join(" "), str::to_owned);
        while !fits(&end) && end.chars().count() > 4 {
            let kept: String = end.trim_start_matches('…').chars().skip(1).collect();
            end = format!("…{}", kept.trim_start());
        }
        set.push(end);
    }
    set
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(all: &[&str]) -> Vec<String> {
        all.iter().map(|n| (*n).to_owned()).collect()
    }

    #[test]
    fn names_stand_on_as_few_lines_as_they_need_and_read_upwards_where_no_line_fits() {
        let short = names(&["calm", "sporty"]);
        let level = Names::set(&short, 40.0);
        assert_eq!(level, Names::Level(vec![names(&["calm"]), names(&["sporty"])]));
        let two = Names::set(&names(&["calm, dense", "calm, free"]), 27.0);
        assert_eq!(two, Names::Level(vec![names(&["calm,", "dense"]), names(&["calm,", "free"])]));
        assert!(two.height() > level.height());
        assert_eq!(Names::set(&short, 12.0), Names::Turned(short));
    }

    #[test]
    fn of_a_name_that_two_lines_do_not_hold_the_end_stays() {
        let room = Look::new(size::TICK).width("Conscientiousness and");
        let set = |name: &str| on_two_lines(name, room);
        assert_eq!(set("Trust"), ["Trust"]);
        assert_eq!(
            set("Conscientiousness and trust (own)"),
            ["Conscientiousness and", "trust (own)"]
        );
        let long = set("Conscientiousness and trust in the other car (own − calm)");
        assert_eq!(long.len(), 2);
        assert!(long[1].starts_with('…') && long[1].ends_with("(own − calm)"), "{long:?}");
        assert!(Look::new(size::TICK).widest(&long) <= room, "{long:?}");
        assert_eq!(set("panel.aggressiveness.score").concat(), "panel.aggressiveness.score");
        assert!(set("").is_empty());
    }

    #[test]
    fn a_line_ends_beside_a_statement_and_beside_brackets_and_a_long_word_at_its_dots() {
        let look = Look::new(size::SUBTITLE);
        let set = |text: &str, width: &str| fitted(text, look, look.width(width) + 0.1);
        let said = "Style × Traffic: *F*(1, 20.69) = 0.06, *p* = .813";
        assert_eq!(set(said, said), [said]);
        assert_eq!(
            set(said, "Style × Traffic: *F*(1, 20.69) = 0.06, *p* ="),
            ["Style × Traffic: *F*(1, 20.69) = 0.06,", "*p* = .813"]
        );
        assert_eq!(
            set("Comfort (Experience: Novice)", "Comfort (Experience: N"),
            ["Comfort", "(Experience: Novice)"]
        );
        assert_eq!(set("(a b c)", "(a b"), ["(a b", "c)"]);
        assert_eq!(set("line.with_score.p", "line.with_sc"), ["line.with_", "score.p"]);
        assert!(set("", "x").is_empty());
    }

    #[test]
    fn a_name_that_is_too_long_either_way_is_cut_with_an_ellipsis() {
        let long = names(&["an uncommonly long name of a condition that nobody can print"]);
        let Names::Turned(cut) = Names::set(&long, 15.0) else {
            panic!("turned");
        };
        assert!(cut[0].ends_with('…') && Look::new(size::TICK).width(&cut[0]) <= LONGEST);
        // One of four is cut where the others stand level; two of four are not.
        let one = names(&["calm", "sporty", "own", "perpendicular"]);
        let set = Names::set(&one, 28.0);
        assert!(matches!(&set, Names::Level(lines) if lines[3][0].ends_with('…')), "{set:?}");
        assert_eq!((set.cut(), Names::set(&one, 60.0).cut()), (vec![3], Vec::new()));
        // It stands whole below the others where that does not lead out of the panel.
        let set = Names::set(&one, 34.0);
        assert!(
            matches!(&set, Names::Level(lines) if lines[3] == ["", "perpendicular"]),
            "{set:?}"
        );
        assert!(set.cut().is_empty());
        let two = names(&["calm", "sporty", "perpendicularly", "perpendicular"]);
        assert!(matches!(Names::set(&two, 34.0), Names::Turned(_)));
    }
}

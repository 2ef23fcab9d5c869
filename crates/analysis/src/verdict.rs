//! What makes an answer "shown": rules that stand before the result.

use crate::AnalysisError;
use maveric_domain::design::Sign;
use maveric_stats::{Bounds, Tost, equivalence_one};
use serde::{Deserialize, Serialize};

/// What became of a hypothesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// As it says, by its rule.
    Shown,
    /// The data decide neither way.
    NotShown,
    /// The opposite of what it says, by the same rule.
    Fails,
    /// Nobody answered, or nothing measured, what it is about.
    NotAsked,
    /// Fewer than [`FEWEST`] have a value.
    TooFew,
    /// A primary outcome before it was not shown.
    NotTested,
    /// There are people enough and no p: what would test it does not exist for these data.
    NotTestable,
}

/// Level of every test.
pub(crate) const ALPHA: f64 = 0.05;

/// Fewest people, or drives, of whom anything is said.
pub const FEWEST: usize = 6;

impl Verdict {
    /// In the words of the page.
    pub fn words(self) -> &'static str {
        match self {
            Self::Shown => "shown",
            Self::NotShown => "not shown",
            Self::Fails => "fails",
            Self::NotAsked => "not asked",
            Self::TooFew => "too few to say",
            Self::NotTested => "not tested",
            Self::NotTestable => "not testable",
        }
    }

    /// Of fewer people than a test needs.
    fn of_few(n: usize) -> Self {
        if n == 0 { Self::NotAsked } else { Self::TooFew }
    }

    /// Of `n` people without the number that would decide.
    fn without_number(n: usize) -> Self {
        if n < FEWEST { Self::of_few(n) } else { Self::NotTestable }
    }

    /// Whether a number decided, whichever way.
    fn is_judged(self) -> bool {
        matches!(self, Self::Shown | Self::NotShown | Self::Fails)
    }

    /// Of several parts that all have to hold: fails where one does, shown where all are; where none was judged as the first that was asked.
    pub fn all(parts: impl IntoIterator<Item = Self>) -> Self {
        let parts: Vec<Self> = parts.into_iter().filter(|v| *v != Self::NotAsked).collect();
        let every = |verdict| parts.iter().all(|v| *v == verdict);
        if parts.is_empty() {
            Self::NotAsked
        } else if parts.contains(&Self::Fails) {
            Self::Fails
        } else if every(Self::Shown) {
            Self::Shown
        } else if !parts.iter().any(|verdict| verdict.is_judged()) {
            parts[0]
        } else {
            Self::NotShown
        }
    }

    /// Of several parts one of which is enough.
    pub fn any(parts: impl IntoIterator<Item = Self>) -> Self {
        let parts: Vec<Self> = parts.into_iter().collect();
        if parts.contains(&Self::Shown) {
            return Self::Shown;
        }
        match Self::all(parts) {
            Self::Fails => Self::NotShown,
            other => other,
        }
    }
}

/// A difference of an expected sign: shown below .05 on that side, fails below .05 on the other; not testable without a p.
pub fn directed(n: usize, difference: Option<f64>, p: Option<f64>, expected: Sign) -> Verdict {
    let (Some(difference), Some(p)) = (difference, p) else {
        return Verdict::without_number(n);
    };
    match Sign::of(difference) {
        _ if n < FEWEST => Verdict::TooFew,
        Some(way) if p < ALPHA && way == expected => Verdict::Shown,
        Some(_) if p < ALPHA => Verdict::Fails,
        _ => Verdict::NotShown,
    }
}

/// A difference or correlation of any sign: shown with p below .05, else not shown; not testable without a p.
pub fn significant(n: usize, p: Option<f64>) -> Verdict {
    match p {
        _ if n < FEWEST => Verdict::of_few(n),
        None => Verdict::NotTestable,
        Some(p) if p < ALPHA => Verdict::Shown,
        Some(_) => Verdict::NotShown,
    }
}

/// An interval of something estimated from `n` of them: shown where all of it lies within the bounds, fails where all lies outside.
/// An end that is infinite asks for one side only: `(0.8, f64::INFINITY)`. Not testable without an interval.
pub fn within(n: usize, interval: Option<(f64, f64)>, bounds: (f64, f64)) -> Verdict {
    match interval {
        None => Verdict::without_number(n),
        Some(_) if n < FEWEST => Verdict::TooFew,
        Some((low, high)) if low >= bounds.0 && high <= bounds.1 => Verdict::Shown,
        Some((low, high)) if high < bounds.0 || low > bounds.1 => Verdict::Fails,
        Some(_) => Verdict::NotShown,
    }
}

/// Two one-sided t tests of the differences against the bounds: shown where both are below .05, fails where one places the mean
/// outside with less than .05. The test is not there for fewer than two differences, nor where they do not vary: that is not testable.
///
/// # Errors
/// [`AnalysisError`] for bounds that are none, or a difference that is not finite.
pub fn equivalent(
    (low, high): (f64, f64),
    differences: &[f64],
) -> Result<(Verdict, Option<Tost>), AnalysisError> {
    if differences.len() < 2 {
        return Ok((Verdict::of_few(differences.len()), None));
    }
    let values: Vec<Option<f64>> = differences.iter().copied().map(Some).collect();
    let equivalence = equivalence_one(&values, 0.0, Bounds::Raw { low, high })?;
    let test = equivalence.tost.values().next().cloned();
    let sides = test.as_ref().and_then(|t| t.p_lower.zip(t.p_upper));
    Ok((one_sided(differences.len(), sides), test))
}

/// Two one-sided tests of `n` people, each p against what lies beyond its bound: shown where both are below .05, fails where one places
/// the estimate outside with less than .05; not testable without these.
pub(crate) fn one_sided(n: usize, sides: Option<(f64, f64)>) -> Verdict {
    match sides {
        _ if n < FEWEST => Verdict::TooFew,
        None => Verdict::NotTestable,
        Some((lower, upper)) if lower.max(upper) < ALPHA => Verdict::Shown,
        Some(sides) if outside(sides) < ALPHA => Verdict::Fails,
        Some(_) => Verdict::NotShown,
    }
}

/// The smaller p of the tests the other way round: that the estimate lies beyond one of the bounds.
pub(crate) fn outside((lower, upper): (f64, f64)) -> f64 {
    1.0 - lower.max(upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_is_shown_not_shown_fails_is_not_asked_or_has_too_few() {
        let judged = |n, difference, p| directed(n, difference, p, Sign::Minus);
        assert_eq!(judged(24, Some(-1.0), Some(0.01)), Verdict::Shown);
        assert_eq!(judged(24, Some(-1.0), Some(0.05)), Verdict::NotShown);
        assert_eq!(judged(24, Some(1.0), Some(0.01)), Verdict::Fails);
        assert_eq!(judged(24, Some(0.0), Some(0.01)), Verdict::NotShown);
        assert_eq!(judged(0, None, None), Verdict::NotAsked);
        // However small p is: of five people nothing is said.
        assert_eq!(judged(5, Some(-1.0), Some(0.001)), Verdict::TooFew);
    }

    #[test]
    fn without_a_number_that_decides_nothing_is_shown_nor_not_shown() {
        let directions = |n| directed(n, Some(-1.0), None, Sign::Minus);
        let intervals = |n| within(n, None, (0.0, 1.0));
        for judged in [directions(24), significant(24, None), intervals(24)] {
            assert_eq!(judged, Verdict::NotTestable);
        }
        for few in [directions(5), significant(5, None), intervals(5)] {
            assert_eq!(few, Verdict::TooFew);
        }
        assert_eq!(one_sided(24, None), Verdict::NotTestable);
        assert_eq!(significant(24, Some(0.05)), Verdict::NotShown);
    }

    #[test]
    fn an_interval_within_bounds_is_shown_and_one_outside_fails() {
        let judged = |low, high| within(24, Some((low, high)), (0.8, f64::INFINITY));
        assert_eq!(judged(0.81, 0.9), Verdict::Shown);
        assert_eq!(judged(0.7, 0.9), Verdict::NotShown);
        assert_eq!(judged(0.7, 0.79), Verdict::Fails);
        assert_eq!(within(0, None, (0.0, 1.0)), Verdict::NotAsked);
        assert_eq!(within(4, Some((0.2, 0.3)), (0.0, 1.0)), Verdict::TooFew);
        // As a rate of false positives: above the level fails, below it too.
        assert_eq!(within(9, Some((0.06, 0.08)), (0.0, 0.05)), Verdict::Fails);
    }

    #[test]
    fn differences_within_bounds_are_the_same_and_a_shift_beyond_them_fails() {
        let judged = |shift: f64, spread: f64, n: usize| {
            let one = |i: usize| shift + if i.is_multiple_of(2) { spread } else { -spread };
            let values: Vec<f64> = (0..n).map(one).collect();
            equivalent((-1.0, 1.0), &values).unwrap().0
        };
        assert_eq!(judged(0.1, 0.5, 24), Verdict::Shown);
        assert_eq!(judged(0.9, 0.5, 24), Verdict::NotShown);
        assert_eq!(judged(2.0, 0.5, 24), Verdict::Fails);
        assert_eq!(judged(0.1, 0.1, 4), Verdict::TooFew);
        assert_eq!(judged(0.0, 0.0, 24), Verdict::NotTestable);
        assert_eq!(equivalent((-1.0, 1.0), &[]).unwrap().0, Verdict::NotAsked);
    }

    #[test]
    fn several_parts_are_shown_when_all_are_and_fail_when_one_does() {
        use Verdict::{Fails, NotAsked, NotShown, NotTestable, Shown, TooFew};
        assert_eq!(Verdict::all([Shown, Shown, NotAsked]), Shown);
        assert_eq!(Verdict::all([NotTestable, NotTestable]), NotTestable);
        assert_eq!(Verdict::all([NotAsked, TooFew, NotTestable]), TooFew);
        assert_eq!(Verdict::all([Shown, NotTestable]), NotShown);
        assert_eq!(Verdict::any([Shown, NotTestable]), Shown);
        assert_eq!(Verdict::any([NotShown, NotTestable]), NotShown);
        assert_eq!(Verdict::all([Shown, TooFew]), NotShown);
        assert_eq!(Verdict::all([Shown, NotShown, Fails]), Fails);
        assert_eq!(Verdict::all([TooFew, TooFew]), TooFew);
        assert_eq!(Verdict::all([NotAsked]), NotAsked);
        assert_eq!(Verdict::any([NotShown, Shown, Fails]), Shown);
        assert_eq!(Verdict::any([NotShown, Fails]), NotShown);
        assert_eq!(Verdict::any([]), NotAsked);
    }
}

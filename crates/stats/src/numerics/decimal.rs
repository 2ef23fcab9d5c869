//! Numbers as they were written, and so which of them are equal.
//!
//! 0.3 - 0.1 and 0.4 - 0.2 are both 0.2, but the doubles differ in their last bit: ties of
//! decimals of up to [`SHORT`] significant digits are ties of what was written. A longer number is
//! itself a rounded result, such as the mean of three items: 2.33333333333333 - 2 and
//! 3.66666666666667 - 3.33333333333333 are the same third. Such numbers, and their differences,
//! tie within four units of the 15th digit of the largest value in the column.

use std::borrow::Cow;

/// Decimal places tried before the digits are read from the printed form.
const FAST_PLACES: i32 = 9;

/// Significant digits up to which a decimal stands for itself.
const SHORT: u32 = 12;

/// In units of the 15th digit: four, and what the doubles of both numbers lose beside it.
const TIED_UNITS: f64 = 4.25;

/// A column of numbers of which it is known which differences are equal.
#[derive(Debug)]
pub(crate) enum Written<'a> {
    /// Short decimals, each times one common power of ten, exactly.
    Decimals(Vec<i64>),
    /// Some are longer, or their magnitudes are too far apart for whole numbers.
    Rounded {
        /// As given.
        values: &'a [f64],
        /// Differences no further apart than this tie.
        tolerance: f64,
    },
}

impl<'a> Written<'a> {
    /// Looks at how the values of one column were written.
    pub(crate) fn of(values: &'a [f64]) -> Self {
        (0..=FAST_PLACES)
            .find_map(|places| scaled(values, places))
            .or_else(|| from_digits(values))
            .map_or_else(
                || Self::Rounded {
                    values,
                    tolerance: tolerance(values),
                },
                Self::Decimals,
            )
    }

    /// Whether some numbers are longer than stand for themselves.
    pub(crate) fn is_rounded(&self) -> bool {
        matches!(self, Self::Rounded { .. })
    }

    /// A number a row: equal where the differences `column[a] - column[b]` tie, with their sign
    /// and in their order by magnitude; 0 where both are equal.
    pub(crate) fn differences(&self, pairs: impl Iterator<Item = (usize, usize)>) -> Vec<i64> {
        match self {
            Self::Decimals(whole) => pairs.map(|(a, b)| whole[a] - whole[b]).collect(),
            Self::Rounded { values, tolerance } => {
                let raw: Vec<f64> = pairs.map(|(a, b)| values[a] - values[b]).collect();
                let sizes: Vec<f64> = raw.iter().map(|d| d.abs()).collect();
                let groups = groups(&sizes, *tolerance, Some(0.0));
                let signed = |(d, group): (&f64, i64)| if *d < 0.0 { -group } else { group };
                raw.iter().zip(groups).map(signed).collect()
            }
        }
    }

    /// Whether `column[a] - column[b]` and `column[c] - column[d]` tie.
    pub(crate) fn same_difference(&self, (a, b): (usize, usize), (c, d): (usize, usize)) -> bool {
        match self {
            Self::Decimals(whole) => whole[a] - whole[b] == whole[c] - whole[d],
            Self::Rounded { values, tolerance } => {
                ((values[a] - values[b]) - (values[c] - values[d])).abs() <= *tolerance
            }
        }
    }
}

/// The column with numbers that tie made equal, for ranking.
pub(crate) fn tied(values: &[f64]) -> Cow<'_, [f64]> {
    match Written::of(values) {
        Written::Decimals(_) => Cow::Borrowed(values),
        Written::Rounded { tolerance, .. } => {
            let groups = groups(values, tolerance, None);
            let most = groups.iter().max().map_or(0, |&g| g as usize + 1);
            let mut first = vec![f64::INFINITY; most];
            for (&group, &value) in groups.iter().zip(values) {
                first[group as usize] = first[group as usize].min(value);
            }
            groups.iter().map(|&group| first[group as usize]).collect()
        }
    }
}

/// The number of each value's group, from 0 upwards by size: a group reaches `tolerance` beyond
/// its smallest value; `origin`, if any, is the smallest of group 0.
fn groups(values: &[f64], tolerance: f64, origin: Option<f64>) -> Vec<i64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_unstable_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut start = origin.or_else(|| order.first().map(|&i| values[i]));
    let (mut group, mut groups) = (0, vec![0; values.len()]);
    for i in order {
        if start.is_some_and(|start| values[i] - start > tolerance) {
            start = Some(values[i]);
            group += 1;
        }
        groups[i] = group;
    }
    groups
}

fn tolerance(values: &[f64]) -> f64 {
    let largest = super::moments::largest(values);
    let text = format!("{largest:e}");
    let exponent = text
        .split_once('e')
        .and_then(|(_, e)| e.parse::<i32>().ok());
    TIED_UNITS * 10.0_f64.powi(exponent.unwrap_or(0) - 14)
}

fn is_short(mut whole: i64) -> bool {
    let limit = 10_i64.pow(SHORT);
    while whole.abs() >= limit && whole % 10 == 0 {
        whole /= 10;
    }
    whole.abs() < limit
}

fn scaled(values: &[f64], places: i32) -> Option<Vec<i64>> {
    let power = 10.0_f64.powi(places);
    values
        .iter()
        .map(|&value| {
            let whole = (value * power).round();
            // Division rounds correctly, so equality means: this decimal reads as `value`.
            let same = whole.abs() < 9.0e15 && (whole / power).to_bits() == value.to_bits();
            let none = value.abs() < f64::MIN_POSITIVE;
            (none || same && is_short(whole as i64)).then_some(whole as i64)
        })
        .collect()
}

fn from_digits(values: &[f64]) -> Option<Vec<i64>> {
    let parts: Vec<(i64, i32)> = values.iter().map(|&v| digits(v)).collect::<Option<_>>()?;
    let lowest = parts
        .iter()
        .filter(|(digits, _)| *digits != 0)
        .map(|&(_, exponent)| exponent)
        .min()
        .unwrap_or(0);
    parts
        .into_iter()
        .map(|(digits, exponent)| {
            if digits == 0 {
                return Some(0);
            }
            let power = 10_i64.checked_pow(u32::try_from(exponent - lowest).ok()?)?;
            let value = digits.checked_mul(power)?;
            (value.abs() < i64::MAX / 4).then_some(value)
        })
        .collect()
}

/// The digits of a short number and the power of ten they are multiplied by.
fn digits(value: f64) -> Option<(i64, i32)> {
    let text = format!("{value:e}");
    let (mantissa, exponent) = text.split_once('e')?;
    let places = mantissa.split_once('.').map_or(0, |(_, rest)| rest.len());
    let whole: i64 = mantissa.replace('.', "").parse().ok()?;
    let exponent: i32 = exponent.parse().ok()?;
    is_short(whole).then_some((whole, exponent - i32::try_from(places).ok()?))
}

/// The decimal places of a printed number: `.46` has 2.
pub(crate) fn places_of(text: &str) -> usize {
    text.split_once('.').map_or(0, |(_, rest)| rest.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn differences(values: &[f64]) -> Vec<i64> {
        let half = values.len() / 2;
        Written::of(values).differences((0..half).map(|i| (2 * i, 2 * i + 1)))
    }

    #[test]
    fn differences_that_tie_on_paper_tie_here() {
        let keys = differences(&[0.3, 0.1, 0.4, 0.2, 0.1, 0.3]);
        assert_eq!((keys[0], keys[0]), (keys[1], -keys[2]));
        assert!((0.3_f64 - 0.1).to_bits() != (0.4_f64 - 0.2).to_bits());
    }

    #[test]
    fn thirds_tie_whether_printed_with_15_digits_or_17() {
        let printed = [
            2.333_333_333_333_33,
            2.0,
            3.666_666_666_666_67,
            3.333_333_333_333_33,
        ];
        let doubles = [7.0 / 3.0, 2.0, 11.0 / 3.0, 10.0 / 3.0];
        for values in [printed, doubles] {
            assert_eq!(differences(&values), [1, 1]);
            assert_eq!(
                differences(&[values[0], values[0], 2.0, values[2]]),
                [0, -1]
            );
        }
    }

    #[test]
    fn long_numbers_tie_within_four_units_of_the_fifteenth_digit_and_not_within_six() {
        let with = |units: f64| {
            [
                5.123_456_789_012_34,
                5.0,
                5.123_456_789_012_34 + units * 1e-14,
                5.0,
            ]
        };
        assert_eq!(differences(&with(4.0)), [1, 1]);
        assert_eq!(differences(&with(6.0)), [1, 2]);
        // Twelve digits stand for themselves.
        assert_eq!(
            differences(&[0.123_456_789_012, 0.0, 0.123_456_789_011, 0.0]),
            [123_456_789_012, 123_456_789_011]
        );
    }

    #[test]
    fn values_that_tie_are_made_equal_and_short_ones_left_alone() {
        let thirds = [1.0 / 3.0, 2.0, 0.333_333_333_333_333, 5.0];
        assert_eq!(tied(&thirds)[0].to_bits(), tied(&thirds)[2].to_bits());
        assert!(matches!(tied(&[0.1, 0.2]), Cow::Borrowed(_)));
        assert!(tied(&[]).is_empty());
    }

    #[test]
    fn magnitudes_too_far_apart_for_whole_numbers_still_have_an_order() {
        assert_eq!(differences(&[1e300, 1e-300, 0.0, -0.0]), [1, 0]);
        assert_eq!(differences(&[1e-11, 0.0, 3e-11, 0.0]), [1, 3]);
    }
}

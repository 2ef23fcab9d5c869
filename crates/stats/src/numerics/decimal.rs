//! Numbers as they were written, and so which of them are equal.
//!
//! 0.3 - 0.1 and 0.4 - 0.2 are both 0.2, but the doubles differ in their last bit: ties of
//! decimals of up to [`SHORT`] significant digits are ties of what was written. A longer number is
//! itself a rounded result, such as the mean of three items: 2.33333333333333 - 2 and
//! 3.66666666666667 - 3.33333333333333 are the same third. Such numbers tie within four units of their
//! own 15th digit, and differences within four units of the 15th digit of what was subtracted: another
//! number of the column, however large, makes no tie.

use std::{borrow::Cow, collections::BTreeMap};

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
    },
}

impl<'a> Written<'a> {
    /// Looks at how the values of one column were written.
    pub(crate) fn from_values(values: &'a [f64]) -> Self {
        (0..=FAST_PLACES)
            .find_map(|places| scaled(values, places))
            .or_else(|| from_digits(values))
            .map_or_else(|| Self::Rounded { values }, Self::Decimals)
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
            Self::Rounded { values } => {
                let pairs: Vec<[f64; 2]> = pairs.map(|(a, b)| [values[a], values[b]]).collect();
                let raw = |[a, b]: &[f64; 2]| a - b;
                let sized = |pair| (f64::abs(raw(pair)), tolerance(pair));
                let sizes: Vec<(f64, f64)> = pairs.iter().map(sized).collect();
                let equal = |pair: &[f64; 2]| f64::abs(raw(pair)) <= reach(pair);
                let groups = groups(&sizes);
                let signed = |(pair, group): (&[f64; 2], i64)| match equal(pair) {
                    true => 0,
                    false if raw(pair) < 0.0 => -1 - group,
                    false => 1 + group,
                };
                dense(&pairs.iter().zip(groups).map(signed).collect::<Vec<i64>>())
            }
        }
    }

    /// Whether `column[a] - column[b]` and `column[c] - column[d]` tie.
    pub(crate) fn same_difference(&self, (a, b): (usize, usize), (c, d): (usize, usize)) -> bool {
        match self {
            Self::Decimals(whole) => whole[a] - whole[b] == whole[c] - whole[d],
            Self::Rounded { values } => {
                let [a, b, c, d] = [a, b, c, d].map(|at| values[at]);
                ((a - b) - (c - d)).abs() <= tolerance(&[a, b, c, d])
            }
        }
    }
}

/// The column with numbers that tie made equal, for ranking.
pub(crate) fn tied(values: &[f64]) -> Cow<'_, [f64]> {
    match Written::from_values(values) {
        Written::Decimals(_) => Cow::Borrowed(values),
        Written::Rounded { .. } => {
            let with_reach = |&value: &f64| (value, reach(&[value]));
            let groups = groups(&values.iter().map(with_reach).collect::<Vec<_>>());
            let most = groups.iter().max().map_or(0, |&g| g as usize + 1);
            let mut first = vec![f64::INFINITY; most];
            for (&group, &value) in groups.iter().zip(values) {
                first[group as usize] = first[group as usize].min(value);
            }
            groups.iter().map(|&group| first[group as usize]).collect()
        }
    }
}

/// What is left of each first number without its second: differences that tie as the numbers were written are the same number, so that their
/// ranks tie too.
///
/// # Example
/// ```
/// // Thirds, which 17 digits do not hold.
/// let pairs = [(49.0 / 12.0, 50.0 / 12.0), (39.0 / 12.0, 40.0 / 12.0)].map(Some);
/// let differences = maveric_stats::tied_differences(&pairs);
/// assert_eq!(differences[0], differences[1]);
/// ```
pub fn tied_differences(pairs: &[Option<(f64, f64)>]) -> Vec<Option<f64>> {
    let known = pairs.iter().flatten();
    let values: Vec<f64> = known.flat_map(|&(a, b)| [a, b]).collect();
    let places = (0..values.len() / 2).map(|i| (2 * i, 2 * i + 1));
    let mut groups = Written::from_values(&values).differences(places).into_iter();
    let mut sizes: BTreeMap<i64, f64> = BTreeMap::new();
    let mut one = |(a, b): (f64, f64)| {
        let group = groups.next()?;
        let size = *sizes.entry(group.abs()).or_insert((a - b).abs());
        Some(group.signum() as f64 * size)
    };
    pairs.iter().map(|pair| pair.and_then(&mut one)).collect()
}

/// The number of each value's group, from 0 upwards by size, of values each with a tolerance: a group reaches as far beyond its smallest
/// value as the larger tolerance of both.
fn groups(values: &[(f64, f64)]) -> Vec<i64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_unstable_by(|&a, &b| values[a].0.total_cmp(&values[b].0));
    let mut start = order.first().map(|&i| values[i]);
    let (mut group, mut groups) = (0, vec![0; values.len()]);
    for i in order {
        let (value, tolerance) = values[i];
        if start.is_some_and(|(first, reach)| value - first > tolerance.max(reach)) {
            start = Some(values[i]);
            group += 1;
        }
        groups[i] = group;
    }
    groups
}

/// Signed groups, numbered by their magnitude without gaps.
fn dense(signed: &[i64]) -> Vec<i64> {
    let mut sizes: Vec<i64> = signed.iter().map(|group| group.abs()).collect();
    sizes.sort_unstable();
    sizes.dedup();
    let first = i64::from(sizes.first() != Some(&0));
    let place = |group: i64| sizes.partition_point(|size| *size < group.abs()) as i64 + first;
    signed.iter().map(|&group| group.signum() * place(group)).collect()
}

/// Four units of the 15th digit of the largest of some values.
pub(crate) fn tolerance(values: &[f64]) -> f64 {
    let largest = super::moments::largest(values);
    TIED_UNITS * 10.0_f64.powi(exponent(largest) - 14)
}

/// The same, but short decimals are equal or not.
fn reach(values: &[f64]) -> f64 {
    if values.iter().all(|value| is_decimal(*value)) { 0.0 } else { tolerance(values) }
}

/// The power of ten of the first digit of a number that is not negative; 0 of 0.
fn exponent(value: f64) -> i32 {
    if value <= 0.0 {
        return 0;
    }
    let near = libm::floor(libm::log10(value)) as i32;
    // The logarithm, and powers beyond the 22nd, may be off in their last digits.
    let value = value * (1.0 + 1e-13);
    near + i32::from(10.0_f64.powi(near + 1) <= value) - i32::from(10.0_f64.powi(near) > value)
}

/// Whether a number is a decimal of few digits, which stands for itself.
fn is_decimal(value: f64) -> bool {
    let places = SHORT as i32 - 1 - exponent(value.abs());
    // Powers of ten to the 22nd are doubles, so that the division rounds once.
    if !(0..=22).contains(&places) {
        return digits(value).is_some();
    }
    let power = 10.0_f64.powi(places);
    (libm::round(value * power) / power).to_bits() == value.to_bits()
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
        Written::from_values(values).differences((0..half).map(|i| (2 * i, 2 * i + 1)))
    }

    #[test]
    fn differences_that_tie_on_paper_tie_here() {
        let keys = differences(&[0.3, 0.1, 0.4, 0.2, 0.1, 0.3]);
        assert_eq!((keys[0], keys[0]), (keys[1], -keys[2]));
        assert!((0.3_f64 - 0.1).to_bits() != (0.4_f64 - 0.2).to_bits());
    }

    #[test]
    fn thirds_tie_whether_printed_with_15_digits_or_17() {
        let printed = [2.333_333_333_333_33, 2.0, 3.666_666_666_666_67, 3.333_333_333_333_33];
        let doubles = [7.0 / 3.0, 2.0, 11.0 / 3.0, 10.0 / 3.0];
        for values in [printed, doubles] {
            assert_eq!(differences(&values), [1, 1]);
            assert_eq!(differences(&[values[0], values[0], 2.0, values[2]]), [0, -1]);
        }
    }

    #[test]
    fn long_numbers_tie_within_four_units_of_the_fifteenth_digit_and_not_within_six() {
        let with =
            |units: f64| [5.123_456_789_012_34, 5.0, 5.123_456_789_012_34 + units * 1e-14, 5.0];
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
    fn differences_that_tie_are_one_number_of_either_sign_and_others_stay_apart() {
        let (low, high) = (49.0_f64 / 12.0, 50.0_f64 / 12.0);
        let pairs = [
            Some((low, high)),
            Some((3.25, 40.0 / 12.0)),
            None,
            Some((40.0 / 12.0, 3.25)),
            Some((3.0, 3.0)),
            Some((4.0, 3.75)),
        ];
        assert!((low - high).to_bits() != (3.25_f64 - 40.0 / 12.0).to_bits());
        let found = tied_differences(&pairs);
        let of = |i: usize| found[i].unwrap();
        assert_eq!(of(0).to_bits(), of(1).to_bits());
        assert_eq!(of(0).to_bits(), (-of(3)).to_bits());
        assert!(found[2].is_none() && of(4).abs() < f64::MIN_POSITIVE);
        assert!(of(5) > 0.2 && (of(0) + 1.0 / 12.0).abs() < 1e-12);
        // As short decimals too.
        let short = tied_differences(&[Some((0.3, 0.1)), Some((0.4, 0.2))]);
        assert_eq!(short[0], short[1]);
        assert!(tied_differences(&[]).is_empty());
    }

    #[test]
    fn a_large_number_in_the_column_makes_no_small_ones_tie() {
        // p values: short decimals, and long ones.
        for scale in [1.0, 1.0 / 3.0] {
            let values: Vec<f64> = (0..26).map(|i| scale * 10.0_f64.powi(-i)).collect();
            let tied = tied(&values);
            assert!(tied.windows(2).all(|pair| pair[0] > pair[1]), "{scale}");
            let pairs: Vec<f64> = values.windows(2).flat_map(|p| [p[0], p[1]]).collect();
            let keys = differences(&pairs);
            assert!(keys.windows(2).all(|k| k[0] > k[1] && k[1] > 0), "{keys:?}");
        }
    }

    #[test]
    fn a_decimal_is_known_by_its_digits_whatever_its_size() {
        let long = [1.0 / 3.0, 2e-20 / 3.0, 0.123_456_789_012_3, 1e300 / 7.0];
        let short =
            [0.1, -0.3, 1e-26, 5e-324, 123_456_789_012.0, 1e22, 2.5e300, 0.0, 999_999_999_999.0];
        assert!(short.iter().all(|v| is_decimal(*v)), "{:?}", short.map(is_decimal));
        assert!(!long.iter().any(|v| is_decimal(*v)), "{:?}", long.map(is_decimal));
        for power in -30..30 {
            let text = format!("1e{power}");
            let value: f64 = text.parse().unwrap();
            assert_eq!(exponent(value), power, "{text}");
        }
    }

    #[test]
    fn a_rising_relation_of_p_values_is_one() {
        let p: Vec<Option<f64>> =
            (0..12).map(|i| Some(0.5 * 10.0_f64.powi(-2 * i) / 3.0)).collect();
        let rank: Vec<Option<f64>> = (0..12).map(|i| Some(-f64::from(i))).collect();
        let all = crate::correlate(&p, &rank, crate::CorrelationMethod::All, None).unwrap();
        assert!((all.spearman.unwrap().rho.unwrap() - 1.0).abs() < 1e-12);
        let group: Vec<String> = (0..12).map(|i| ["high", "low"][i / 6].to_owned()).collect();
        let two = crate::groups(&group, &p).unwrap();
        let u = two.mann_whitney.values().next().unwrap().u;
        assert!((u - 36.0).abs() < 1e-12, "{u}");
    }

    #[test]
    fn long_values_tie_within_their_own_digits() {
        let third = 1.0 / 3.0;
        let values = [third, 0.333_333_333_333_333, 1e6 / 3.0, third + 1e-13];
        let tied = tied(&values);
        assert_eq!(tied[0].to_bits(), tied[1].to_bits());
        assert!(tied[3] > tied[0] && tied[2] > tied[3]);
    }

    #[test]
    fn magnitudes_too_far_apart_for_whole_numbers_still_have_an_order() {
        assert_eq!(differences(&[1e300, 1e-300, 0.0, -0.0]), [1, 0]);
        assert_eq!(differences(&[1e-11, 0.0, 3e-11, 0.0]), [1, 3]);
    }
}

//! Numbers as they were written.
//!
//! 0.3 - 0.1 and 0.4 - 0.2 are both 0.2, but the doubles differ in their last bit. Ties of
//! differences are ties of the decimal numbers, so differences are taken on those.

/// Decimal places tried before the digits are read from the printed form.
const FAST_PLACES: i32 = 9;

/// Each value times one common power of ten, exactly, as the shortest decimal that reads
/// back as that double. `None` if the magnitudes are too far apart for 128-bit integers.
pub(crate) fn as_written(values: &[f64]) -> Option<Vec<i128>> {
    (0..=FAST_PLACES)
        .find_map(|places| scaled(values, places))
        .or_else(|| from_digits(values))
}

fn scaled(values: &[f64], places: i32) -> Option<Vec<i128>> {
    let power = 10.0_f64.powi(places);
    values
        .iter()
        .map(|&value| {
            let whole = (value * power).round();
            // Division rounds correctly, so equality means: this decimal reads as `value`.
            let same = whole.abs() < 9.0e15 && (whole / power).to_bits() == value.to_bits();
            (same || value.abs() < f64::MIN_POSITIVE).then_some(whole as i128)
        })
        .collect()
}

fn from_digits(values: &[f64]) -> Option<Vec<i128>> {
    let parts: Vec<(i128, i32)> = values.iter().map(|&v| digits(v)).collect::<Option<_>>()?;
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
            let power = 10_i128.checked_pow(u32::try_from(exponent - lowest).ok()?)?;
            let value = digits.checked_mul(power)?;
            (value.abs() < i128::MAX / 4).then_some(value)
        })
        .collect()
}

/// The shortest digits of a number and the power of ten they are multiplied by.
fn digits(value: f64) -> Option<(i128, i32)> {
    let text = format!("{value:e}");
    let (mantissa, exponent) = text.split_once('e')?;
    let places = mantissa.split_once('.').map_or(0, |(_, rest)| rest.len());
    let whole: i128 = mantissa.replace('.', "").parse().ok()?;
    let exponent: i32 = exponent.parse().ok()?;
    Some((whole, exponent - i32::try_from(places).ok()?))
}

/// The decimal places of a printed number: `.46` has 2.
pub(crate) fn places_of(text: &str) -> usize {
    text.split_once('.').map_or(0, |(_, rest)| rest.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_that_tie_on_paper_tie_here() {
        let w = as_written(&[0.3, 0.1, 0.4, 0.2]).unwrap();
        assert_eq!(w[0] - w[1], w[2] - w[3]);
        assert!((0.3_f64 - 0.1).to_bits() != (0.4_f64 - 0.2).to_bits());
    }

    #[test]
    fn long_digits_are_read_exactly() {
        let w = as_written(&[-1.541_868_583_841_723_2, 0.1]).unwrap();
        assert_eq!(w, [-15_418_685_838_417_232, 1_000_000_000_000_000]);
        assert_eq!(as_written(&[1e300, 1e-300]), None);
        assert_eq!(as_written(&[0.0, -0.0, 5.0]).unwrap(), [0, 0, 5]);
    }
}

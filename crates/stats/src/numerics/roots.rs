//! Where a function passes zero.

/// The root of `f` between `low` and `high`, by Brent's method, to full precision.
///
/// `None` unless `f` is finite and has different signs at both ends.
pub(crate) fn brent(f: impl Fn(f64) -> f64, low: f64, high: f64) -> Option<f64> {
    let (mut a, mut b) = (low, high);
    let (mut fa, mut fb) = (f(a), f(b));
    if !(fa.is_finite() && fb.is_finite()) || fa * fb > 0.0 {
        return None;
    }
    let (mut c, mut fc) = (a, fa);
    let mut step = b - a;
    let mut before = step;
    for _ in 0..200 {
        if fb * fc > 0.0 {
            (c, fc) = (a, fa);
            step = b - a;
            before = step;
        }
        if fc.abs() < fb.abs() {
            (a, b, c) = (b, c, b);
            (fa, fb, fc) = (fb, fc, fb);
        }
        let tolerance = 2.0 * f64::EPSILON * b.abs() + 1e-300;
        let middle = 0.5 * (c - b);
        if middle.abs() <= tolerance || fb.abs() < f64::MIN_POSITIVE {
            return Some(b);
        }
        if before.abs() >= tolerance && fa.abs() > fb.abs() {
            let s = fb / fa;
            let (mut p, mut q) = if (a - c).abs() < f64::MIN_POSITIVE {
                (2.0 * middle * s, 1.0 - s)
            } else {
                let (q, r) = (fa / fc, fb / fc);
                (
                    s * (2.0 * middle * q * (q - r) - (b - a) * (r - 1.0)),
                    (q - 1.0) * (r - 1.0) * (s - 1.0),
                )
            };
            if p > 0.0 {
                q = -q;
            }
            p = p.abs();
            if 2.0 * p < (3.0 * middle * q - (tolerance * q).abs()).min((before * q).abs()) {
                before = step;
                step = p / q;
            } else {
                step = middle;
                before = middle;
            }
        } else {
            step = middle;
            before = middle;
        }
        (a, fa) = (b, fb);
        b += if step.abs() > tolerance { step } else { tolerance.copysign(middle) };
        fb = f(b);
    }
    Some(b)
}

/// The root of an `f` that has one sign change above `low`, doubling the span from `width`.
pub(crate) fn upwards(f: impl Fn(f64) -> f64, low: f64, width: f64) -> Option<f64> {
    let start = f(low);
    let (mut left, mut width) = (low, width);
    for _ in 0..200 {
        let right = left + width;
        let value = f(right);
        if !value.is_finite() {
            return None;
        }
        if value * start <= 0.0 {
            return brent(f, left, right);
        }
        left = right;
        width *= 2.0;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_of_two_is_found_to_the_last_digit() {
        let root = upwards(|x| x * x - 2.0, 0.0, 0.5).unwrap();
        assert!((root - 2.0_f64.sqrt()).abs() < 4e-16);
        assert!(brent(|x| x * x + 1.0, 0.0, 1.0).is_none());
    }

    #[test]
    fn an_end_that_is_itself_the_root_is_one() {
        for (low, high) in [(1.0, 2.0), (0.0, 1.0)] {
            assert_eq!(brent(|x| x - 1.0, low, high), Some(1.0), "{low} to {high}");
        }
        assert_eq!(upwards(|x| x - 1.0, 1.0, 0.5), Some(1.0));
    }
}

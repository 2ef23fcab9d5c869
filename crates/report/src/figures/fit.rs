//! The little arithmetic that drawing itself needs: fits, densities, quantiles.
//!
//! No test is computed here: coefficients and p values come in from outside.

use maveric_stats::{LinearFit, linear_fit};
use std::f64::consts::{FRAC_PI_2, PI};

/// 97.5 % point of the standard normal distribution.
const NORMAL_975: f64 = 1.959_963_984_540_054;

/// Mean of values; `None` without any.
pub(crate) fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn sum_of_squares(values: &[f64], centre: f64) -> f64 {
    values.iter().map(|value| (value - centre).powi(2)).sum()
}

/// Standard deviation, n − 1; 0 for fewer than two values.
pub(crate) fn standard_deviation(values: &[f64]) -> f64 {
    match mean(values) {
        Some(centre) if values.len() > 1 => {
            (sum_of_squares(values, centre) / (values.len() - 1) as f64).sqrt()
        }
        _ => 0.0,
    }
}

/// 97.5 % point of Student's t.
///
/// # Source
/// Hill (1970), Algorithm 396, Communications of the ACM 13; exact for 1 and 2 degrees.
pub(crate) fn t_975(degrees: usize) -> f64 {
    let n = degrees as f64;
    match degrees {
        0 => return f64::INFINITY,
        1 => return 12.706_204_736,
        2 => return 4.302_652_730,
        _ => {}
    }
    let a = 1.0 / (n - 0.5);
    let b = 48.0 / (a * a);
    let mut c = ((20_700.0 * a / b - 98.0) * a - 16.0) * a + 96.36;
    let d = ((94.5 / (b + c) - 3.0) / b + 1.0) * (a * FRAC_PI_2).sqrt() * n;
    let mut y = libm::pow(d * 0.05, 2.0 / n);
    if y > 0.05 + a {
        let x = -NORMAL_975;
        y = x * x;
        if degrees < 5 {
            c += 0.3 * (n - 4.5) * (x + 0.6);
        }
        c += (((0.05 * d * x - 5.0) * x - 7.0) * x - 2.0) * x + b;
        y = (((((0.4 * y + 6.3) * y + 36.0) * y + 94.5) / c - y - 3.0) / b + 1.0) * x;
        y = libm::expm1(a * y * y);
    } else {
        y = ((1.0 / (((n + 6.0) / (n * y) - 0.089 * d - 0.822) * (n + 2.0) * 3.0)
            + 0.5 / (n + 4.0))
            * y
            - 1.0)
            * (n + 1.0)
            / (n + 2.0)
            + 1.0 / y;
    }
    (n * y).sqrt()
}

/// A least-squares line; `None` if the points do not determine one with its band.
pub(crate) fn line(points: &[(f64, f64)]) -> Option<LinearFit> {
    let xs: Vec<Option<f64>> = points.iter().map(|point| Some(point.0)).collect();
    let ys: Vec<Option<f64>> = points.iter().map(|point| Some(point.1)).collect();
    linear_fit(&xs, &ys)
        .ok()
        .filter(|fit| fit.residual_sd.is_some())
}

/// Least squares of y on 1, cos and sin of an angle in radians; `None` if they do not determine it.
pub(crate) fn circular_fit(points: &[(f64, f64)]) -> Option<[f64; 3]> {
    let mut normal = [[0.0; 4]; 3];
    for &(angle, y) in points {
        let row = [1.0, libm::cos(angle), libm::sin(angle)];
        for i in 0..3 {
            for j in 0..3 {
                normal[i][j] += row[i] * row[j];
            }
            normal[i][3] += row[i] * y;
        }
    }
    for column in 0..3 {
        let pivot = (column..3)
            .max_by(|&a, &b| normal[a][column].abs().total_cmp(&normal[b][column].abs()))?;
        normal.swap(column, pivot);
        if normal[column][column].abs() < 1e-9 * points.len() as f64 {
            return None;
        }
        let pivot_row = normal[column];
        for (index, row) in normal.iter_mut().enumerate() {
            if index != column {
                let factor = row[column] / pivot_row[column];
                for (cell, pivot) in row.iter_mut().zip(pivot_row) {
                    *cell -= factor * pivot;
                }
            }
        }
    }
    Some([0, 1, 2].map(|i| normal[i][3] / normal[i][i]))
}

/// Quantile by linear interpolation between order statistics (R's type 7). `sorted` is not empty.
pub(crate) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let low = place.floor() as usize;
    let high = place.ceil() as usize;
    sorted[low] + (sorted[high] - sorted[low]) * (place - low as f64)
}

/// A Gaussian kernel density at `steps` points: (value, density relative to the highest).
///
/// Silverman's bandwidth; reaches two bandwidths beyond the data. Empty if all values are equal.
pub(crate) fn density(sorted: &[f64], steps: usize, range: (f64, f64)) -> Vec<(f64, f64)> {
    if sorted.len() < 3 {
        return Vec::new();
    }
    let sd = standard_deviation(sorted);
    let spread = (quantile(sorted, 0.75) - quantile(sorted, 0.25)) / 1.34;
    let scale = if spread > 0.0 { sd.min(spread) } else { sd };
    let width = 0.9 * scale * libm::pow(sorted.len() as f64, -0.2);
    if width <= 1e-12 * sorted[0].abs().max(1.0) {
        return Vec::new();
    }
    let (low, high) = (
        (sorted[0] - 2.0 * width).max(range.0),
        (sorted[sorted.len() - 1] + 2.0 * width).min(range.1),
    );
    let at = |value: f64| -> f64 {
        sorted
            .iter()
            .map(|x| libm::exp(-0.5 * ((value - x) / width).powi(2)))
            .sum()
    };
    let curve: Vec<(f64, f64)> = (0..=steps)
        .map(|step| low + (high - low) * step as f64 / steps as f64)
        .map(|value| (value, at(value)))
        .collect();
    let top = curve
        .iter()
        .map(|point| point.1)
        .fold(f64::MIN_POSITIVE, f64::max);
    curve
        .into_iter()
        .map(|(value, height)| (value, height / top))
        .collect()
}

/// Half widths of within-subject 95 % intervals of k means, from complete rows.
///
/// # Source
/// Cousineau (2005) with the correction of Morey (2008), Tutorials in Quantitative Methods for
/// Psychology 4: each row is centred on its own mean, variances are multiplied by k / (k − 1).
pub(crate) fn within_subject_half_widths(rows: &[Vec<f64>]) -> Option<Vec<f64>> {
    let (n, k) = (rows.len(), rows.first()?.len());
    if n < 2 || k < 2 {
        return None;
    }
    let t = t_975(n - 1);
    let correction = (k as f64 / (k as f64 - 1.0)).sqrt();
    let half_width = |column: usize| {
        let centred: Vec<f64> = rows
            .iter()
            .map(|row| row[column] - row.iter().sum::<f64>() / k as f64)
            .collect();
        t * correction * standard_deviation(&centred) / (n as f64).sqrt()
    };
    Some((0..k).map(half_width).collect())
}

/// Degrees in 0..360 of an angle in radians.
pub(crate) fn degrees_from_radians(angle: f64) -> f64 {
    (angle * 180.0 / PI).rem_euclid(360.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn t_agrees_with_the_tables() {
        for (degrees, expected) in [
            (1, 12.7062),
            (2, 4.3027),
            (3, 3.1824),
            (4, 2.7764),
            (5, 2.5706),
            (10, 2.2281),
            (22, 2.0739),
            (100, 1.9840),
        ] {
            assert!(
                (t_975(degrees) - expected).abs() < 2e-4,
                "{degrees}: {}",
                t_975(degrees)
            );
        }
    }

    #[test]
    fn points_at_one_x_have_no_line() {
        assert!(line(&[(1.0, 1.0), (1.0, 3.0), (1.0, 5.0)]).is_none());
        assert!(line(&[(0.0, 1.0), (1.0, 3.0), (2.0, 4.0)]).is_some());
    }

    #[test]
    fn a_circular_fit_finds_its_coefficients() {
        let points: Vec<(f64, f64)> = (0..12)
            .map(|k| f64::from(k) * 0.5)
            .map(|angle| (angle, 2.0 + 3.0 * angle.cos() - angle.sin()))
            .collect();
        let fit = circular_fit(&points).unwrap();
        for (found, expected) in fit.iter().zip([2.0, 3.0, -1.0]) {
            assert!((found - expected).abs() < 1e-9);
        }
        assert!(circular_fit(&[(0.0, 1.0), (0.0, 2.0), (0.0, 3.0)]).is_none());
    }

    #[test]
    fn a_constant_shift_between_conditions_leaves_no_within_subject_interval() {
        let rows = vec![vec![1.0, 2.0], vec![5.0, 6.0], vec![9.0, 10.0]];
        let widths = within_subject_half_widths(&rows).unwrap();
        assert!(widths.iter().all(|width| width.abs() < 1e-12));
    }

    #[test]
    fn a_density_never_leaves_the_range_of_its_scale() {
        let curve = density(&[1.0, 1.0, 2.0, 6.5, 7.0], 20, (1.0, 7.0));
        assert!(curve.iter().all(|(value, _)| (1.0..=7.0).contains(value)));
    }

    #[test]
    fn equal_values_have_no_density() {
        assert!(density(&[2.0; 8], 20, (f64::NEG_INFINITY, f64::INFINITY)).is_empty());
    }

    fn close(found: f64, expected: f64) {
        assert!(
            (found - expected).abs() < 1e-12,
            "{found} instead of {expected}"
        );
    }

    #[test]
    fn spread_and_quantiles_are_those_by_hand() {
        close(
            standard_deviation(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]),
            (32.0_f64 / 7.0).sqrt(),
        );
        close(standard_deviation(&[1.0, 3.0]), 2.0_f64.sqrt());
        close(standard_deviation(&[3.0]), 0.0);
        close(standard_deviation(&[]), 0.0);
        assert_eq!(mean(&[]), None);
        close(mean(&[1.0, 2.0, 6.0]).unwrap(), 3.0);
        let sorted = [1.0, 2.0, 4.0, 8.0];
        for (share, expected) in [(0.0, 1.0), (0.25, 1.75), (0.5, 3.0), (0.9, 6.8), (1.0, 8.0)] {
            close(quantile(&sorted, share), expected);
        }
        close(degrees_from_radians(-0.5 * PI), 270.0);
        close(degrees_from_radians(2.5 * PI), 90.0);
    }

    #[test]
    fn t_agrees_with_the_tables_to_the_last_digit_that_is_drawn() {
        for (degrees, expected) in [
            (1, 12.706_205),
            (2, 4.302_653),
            (3, 3.182_446),
            (4, 2.776_445),
            (5, 2.570_582),
            (7, 2.364_624),
            (10, 2.228_139),
            (22, 2.073_873),
            (100, 1.983_972),
            (1000, 1.962_339),
        ] {
            let found = t_975(degrees);
            assert!((found / expected - 1.0).abs() < 3e-5, "{degrees}: {found}");
        }
        assert!(t_975(0).is_infinite());
    }

    #[test]
    fn within_subject_intervals_are_those_by_hand() {
        // Centred on their own means the first column is −1, 0, 1 and the second the reverse: each with a deviation of 1.
        let rows = vec![vec![1.0, 3.0], vec![10.0, 10.0], vec![6.0, 4.0]];
        let widths = within_subject_half_widths(&rows).unwrap();
        let expected = t_975(2) * 2.0_f64.sqrt() / 3.0_f64.sqrt();
        assert_eq!(widths.len(), 2);
        for width in widths {
            close(width, expected);
        }
        assert!(within_subject_half_widths(&rows[..1]).is_none());
        assert!(within_subject_half_widths(&[vec![1.0], vec![2.0]]).is_none());
        assert!(within_subject_half_widths(&[]).is_none());
    }

    #[test]
    fn a_density_is_a_sum_of_bells_of_silverman_s_width() {
        let sorted = [0.0, 1.0, 2.0, 3.0, 10.0];
        let all = (f64::NEG_INFINITY, f64::INFINITY);
        // The quartiles are 1 and 3, so the spread is 2 / 1.34, less than the standard deviation.
        let width = 0.9 * (2.0 / 1.34) * 5.0_f64.powf(-0.2);
        let curve = density(&sorted, 100, all);
        assert_eq!(curve.len(), 101);
        assert!((curve[0].0 + 2.0 * width).abs() < 1e-9);
        assert!((curve[100].0 - 10.0 - 2.0 * width).abs() < 1e-9);
        let bell = |value: f64| -> f64 {
            let each = sorted
                .iter()
                .map(|x| (-0.5 * ((value - x) / width).powi(2)).exp());
            each.sum()
        };
        let top = curve.iter().map(|p| bell(p.0)).fold(0.0, f64::max);
        for (value, height) in &curve {
            assert!((height - bell(*value) / top).abs() < 1e-9, "{value}");
        }
        // Where the middle half is one value, the deviation stands in; two values have none.
        let curve = density(&[0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0], 10, all);
        let width = 0.9 * (1.0_f64 / 3.0).sqrt() * 7.0_f64.powf(-0.2);
        assert!((curve[0].0 + 2.0 * width).abs() < 1e-9);
        assert!(density(&[1.0, 2.0], 10, all).is_empty());
    }
}

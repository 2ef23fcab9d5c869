//! The lowest point of a smooth function of few numbers, without its gradient.

/// Nelder and Mead's simplex from `start`, with `steps` as the first simplex' edges; starts again from what it found until that
/// helps no more. Gives the point and the value there.
///
/// # Source
/// Nelder and Mead (1965), with the usual coefficients 1, 2, ½, ½.
pub(crate) fn minimise(
    start: &[f64],
    step: f64,
    tolerance: f64,
    value: impl Fn(&[f64]) -> f64,
) -> (Vec<f64>, f64) {
    let mut best = (start.to_vec(), value(start));
    let mut edge = step;
    for _ in 0..12 {
        let candidate = simplex(&best.0, edge, tolerance, &value);
        let gain = best.1 - candidate.1;
        if candidate.1 <= best.1 {
            best = candidate;
        }
        edge *= 0.4;
        if gain.abs() <= tolerance {
            break;
        }
    }
    best
}

/// The power of ten, from 1 up, to which the value falls: where to look for a lowest point that may be decades away.
pub(crate) fn decades(value: impl Fn(f64) -> f64) -> f64 {
    let (mut factor, mut lowest) = (1.0, value(1.0));
    for _ in 0..20 {
        let there = value(10.0 * factor);
        if there >= lowest {
            break;
        }
        (factor, lowest) = (10.0 * factor, there);
    }
    factor
}

fn simplex(
    start: &[f64],
    step: f64,
    tolerance: f64,
    value: &impl Fn(&[f64]) -> f64,
) -> (Vec<f64>, f64) {
    let n = start.len();
    let mut points: Vec<(Vec<f64>, f64)> = vec![(start.to_vec(), value(start))];
    for i in 0..n {
        let mut point = start.to_vec();
        point[i] += step;
        let there = value(&point);
        points.push((point, there));
    }
    for _ in 0..400 * n.max(1) {
        points.sort_by(|a, b| a.1.total_cmp(&b.1));
        let width = (0..n).map(|i| (points[n].0[i] - points[0].0[i]).abs()).fold(0.0, f64::max);
        if points[n].1 - points[0].1 <= tolerance && width <= 1e-7 + 1e-3 * tolerance.sqrt() {
            break;
        }
        let centre: Vec<f64> =
            (0..n).map(|i| points[..n].iter().map(|p| p.0[i]).sum::<f64>() / n as f64).collect();
        let along = |factor: f64| -> (Vec<f64>, f64) {
            let point: Vec<f64> =
                (0..n).map(|i| centre[i] + factor * (points[n].0[i] - centre[i])).collect();
            let there = value(&point);
            (point, there)
        };
        let reflected = along(-1.0);
        let replacement = if reflected.1 < points[0].1 {
            let further = along(-2.0);
            Some(if further.1 < reflected.1 { further } else { reflected })
        } else if reflected.1 < points[n - 1].1 {
            Some(reflected)
        } else {
            let nearer = along(if reflected.1 < points[n].1 { -0.5 } else { 0.5 });
            (nearer.1 < points[n].1.min(reflected.1)).then_some(nearer)
        };
        if let Some(point) = replacement {
            points[n] = point;
        } else {
            let best = points[0].0.clone();
            for point in points.iter_mut().skip(1) {
                for (x, b) in point.0.iter_mut().zip(&best) {
                    *x = f64::midpoint(*x, *b);
                }
                point.1 = value(&point.0);
            }
        }
    }
    points.sort_by(|a, b| a.1.total_cmp(&b.1));
    points.swap_remove(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lowest_point_is_looked_for_decades_away_and_nearby() {
        let at = |place: f64| decades(|x: f64| (libm::log10(x) - place).powi(2));
        assert_eq!([at(-2.0), at(0.2), at(6.1)].map(|f| f.round() as i64), [1, 1, 1_000_000]);
        // Without an end it is given up.
        assert!(decades(|x: f64| -x).is_finite());
    }

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        let valley = |x: &[f64]| (1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2);
        let (at, value) = minimise(&[-1.2, 1.0], 0.5, 1e-12, valley);
        assert!((at[0] - 1.0).abs() < 1e-5 && (at[1] - 1.0).abs() < 1e-5, "{at:?}");
        assert!(value < 1e-10);
    }
}

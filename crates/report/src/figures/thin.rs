//! Fewer points with the same outline.

/// The lowest and the highest of each stretch, at most about `most` points.
pub(crate) fn thinned(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    let stretch = (2 * points.len()).div_ceil(most);
    if stretch < 3 {
        return points.to_vec();
    }
    let mut out = Vec::new();
    for part in points.chunks(stretch) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        if let (Some(&low), Some(&high)) =
            (part.iter().min_by(by_value), part.iter().max_by(by_value))
        {
            let in_time = low.0 <= high.0;
            out.extend(if in_time { [low, high] } else { [high, low] });
        }
    }
    out
}

/// The points without those that lie on the straight line between what is left, or beside it by less than `apart`; first and last stay.
pub(crate) fn straightened(points: &[(i32, i32)], apart: f64) -> Vec<(i32, i32)> {
    /// A line that would leave out more than this is broken, so that long paths take linear time.
    const MOST: usize = 64;
    let beside = |from: (i32, i32), to: (i32, i32), at: (i32, i32)| {
        let way = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
        let off = (f64::from(at.0 - from.0), f64::from(at.1 - from.1));
        let square = way.0 * way.0 + way.1 * way.1;
        let along = if square > 0.0 {
            ((off.0 * way.0 + off.1 * way.1) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        libm::hypot(off.0 - along * way.0, off.1 - along * way.1)
    };
    let mut out: Vec<(i32, i32)> = points.iter().take(1).copied().collect();
    let mut kept = 0;
    for next in 1..points.len() {
        let within = |&at: &(i32, i32)| beside(points[kept], points[next], at) < apart;
        if next - kept > MOST || !points[kept + 1..next].iter().all(within) {
            kept = next - 1;
            out.push(points[kept]);
        }
    }
    out.extend(points.last().filter(|_| points.len() > 1));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_on_a_straight_line_is_left_out_and_corners_stay() {
        let straight: Vec<(i32, i32)> = (0..200).map(|i| (10 * i, 3 * i)).collect();
        assert!(straightened(&straight, 2.0).len() <= 5);
        let corner = [(0, 0), (100, 0), (100, 100), (0, 100), (0, 0)];
        assert_eq!(straightened(&corner, 2.0), corner);
        let there_and_back = [(0, 0), (100, 0), (50, 0)];
        assert_eq!(straightened(&there_and_back, 2.0), there_and_back);
        let wave: Vec<(i32, i32)> = (0..500)
            .map(|i| (4 * i, (1000.0 * (0.02 * f64::from(i)).sin()).round() as i32))
            .collect();
        let thin = straightened(&wave, 2.0);
        assert!(thin.len() < 150, "{}", thin.len());
        let far = |at: &(i32, i32)| {
            let before = thin.partition_point(|p| p.0 <= at.0).clamp(1, thin.len() - 1);
            let (a, b) = (thin[before - 1], thin[before]);
            let share = f64::from(at.0 - a.0) / f64::from(b.0 - a.0);
            (f64::from(a.1) + share * f64::from(b.1 - a.1) - f64::from(at.1)).abs()
        };
        assert!(
            wave.iter().all(|at| far(at) < 11.0),
            "two beside a line are at most ten above one that climbs five in one"
        );
    }

    #[test]
    fn thinning_keeps_a_spike() {
        let points: Vec<(f64, f64)> =
            (0..9000).map(|i| (f64::from(i), f64::from(u8::from(i == 4321)))).collect();
        let thin = thinned(&points, 1600);
        assert!(thin.len() <= 1600 && thin.iter().any(|p| p.1 > 0.5));
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_a_spike() {
        let points: Vec<(f64, f64)> = (0..9000)
            .map(|i| (f64::from(i), f64::from(u8::from(i == 4321))))
            .collect();
        let thin = thinned(&points, 1600);
        assert!(thin.len() <= 1600 && thin.iter().any(|p| p.1 > 0.5));
    }
}

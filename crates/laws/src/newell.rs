//! Newell's rule.

/// Acceleration with which ego's next speed leads to `to_go_m` ahead within one step, in m/s².
///
/// By Newell's rule ego drives where the leader was a delay ago, a distance further back: `to_go_m` is how far ahead of ego
/// that place is. A mean speed that leads there within the step would swing about; as the next speed it does not.
///
/// # Source
/// Newell 2002, "A simplified car-following theory".
#[inline]
pub fn newell_accel_mps2(to_go_m: f64, ego_speed_mps: f64, step_s: f64) -> f64 {
    (to_go_m / step_s - ego_speed_mps) / step_s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_on_the_path_keeps_its_speed() {
        assert!(newell_accel_mps2(1.0, 10.0, 0.1).abs() < 1e-12);
        assert!((newell_accel_mps2(1.1, 10.0, 0.1) - 10.0).abs() < 1e-9);
    }
}

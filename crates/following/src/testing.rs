//! Made-up runs for the tests of this crate.

use crate::{
    closed_loop::simulate,
    run::{FollowingColumns, FollowingRun, Stretch},
};
use maveric_laws::Idm;

pub(super) const RATE_HZ: f64 = 10.0;

/// A driver whom the bounds of the calibration hold well inside.
pub(super) const DRIVER: Idm = Idm {
    desired_speed_mps: 33.0,
    time_gap_s: 1.4,
    standstill_gap_m: 2.5,
    max_accel_mps2: 1.3,
    comfortable_braking_mps2: 2.0,
};

/// Behind a leader of `lead_speed` (m/s by time in s), ego at `ego_speed_mps` and `gap_m` throughout.
pub(super) fn behind(
    driver: &str,
    rows: usize,
    gap_m: f64,
    ego_speed_mps: f64,
    lead_speed: impl Fn(f64) -> f64,
) -> FollowingRun {
    let time_s: Vec<f64> = (0..rows).map(|i| i as f64 / RATE_HZ).collect();
    let lead_speed_mps: Vec<f64> = time_s.iter().map(|&t| lead_speed(t)).collect();
    let mut x = 100.0;
    let mut leader_x_m = vec![x];
    for pair in lead_speed_mps.windows(2) {
        x += 0.5 * (pair[0] + pair[1]) / RATE_HZ;
        leader_x_m.push(x);
    }
    let columns = FollowingColumns {
        time_s,
        leader_x_m,
        lead_speed_mps,
        ego_speed_mps: vec![ego_speed_mps; rows],
        gap_m: vec![gap_m; rows],
    };
    FollowingRun::new(driver, RATE_HZ, columns).unwrap()
}

/// 150 s of what an IDM driver makes of a leader that keeps changing its speed between 3 and 29 m/s.
pub(super) fn driven_by_idm(driver: &str, law: Idm) -> FollowingRun {
    let lead = |t: f64| 16.0 + 9.0 * (t / 11.0).sin() + 4.0 * (t / 4.3).sin();
    let blank = behind(driver, 1500, 30.0, 15.0, lead);
    let whole = Stretch { run: &blank, rows: 0..blank.rows() };
    let driven = simulate(&whole, "idm", |g, v, lead| law.accel_mps2(g, v, lead)).unwrap();
    let columns = FollowingColumns {
        gap_m: driven.gap_m,
        ego_speed_mps: driven.speed_mps,
        ..blank.columns().clone()
    };
    FollowingRun::new(driver, RATE_HZ, columns).unwrap()
}

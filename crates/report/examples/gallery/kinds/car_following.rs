//! Gap and speed of a recorded follower and of three models.

use maveric_report::figures::car_following::{CarFollowing, Follower, FollowingSeries};

pub(crate) fn input() -> CarFollowing {
    let rows = 4000;
    let series = |follower, lag: f64, noise: f64| {
        let wave = |t: f64| ((t - lag) / 40.0).sin() + 0.5 * ((t - lag) / 13.0).sin();
        let time_s = |i: usize| i as f64 * 0.1;
        FollowingSeries {
            follower,
            gap_m: (0..rows)
                .map(|i| 34.0 + (14.0 + noise) * wave(time_s(i)) + noise * (time_s(i) / 7.0).sin())
                .collect(),
            speed_mps: (0..rows)
                .map(|i| 20.0 + (6.0 + 0.1 * noise) * wave(time_s(i) + 2.0))
                .collect(),
        }
    };
    CarFollowing {
        driver: "Made-up driver 1".into(),
        data_set: "Made-up recordings".into(),
        time_s: (0..rows).map(|i| 800.0 + i as f64 * 0.1).collect(),
        series: vec![
            series(Follower::Recorded, 0.0, 0.0),
            series(Follower::IdmOwnTimeGap, 1.0, 1.5),
            series(Follower::Idm, 2.0, 3.0),
            series(Follower::IdmPopulation, 3.0, 6.0),
        ],
    }
}

//! Errors of three models on six drivers.

use super::wobble;
use maveric_report::figures::car_following::Follower;
use maveric_report::figures::following_errors::{FollowingErrors, ModelErrors};

pub(crate) fn input() -> FollowingErrors {
    let model = |model, centre: f64, seed: usize| ModelErrors {
        model,
        gap_rmse_m: (0..6).map(|i| centre + 0.3 * centre * wobble(i, seed)).collect(),
    };
    FollowingErrors {
        data_set: "Made-up recordings".into(),
        drivers: (1..=6).map(|i| format!("Made-up driver {i}")).collect(),
        models: vec![
            model(Follower::IdmPopulation, 12.0, 2),
            model(Follower::IdmOwnTimeGap, 7.0, 1),
            model(Follower::Idm, 7.5, 3),
        ],
    }
}

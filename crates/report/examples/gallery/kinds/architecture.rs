//! The model's networks with the sizes of their layers.

use maveric_report::figures::architecture::Architecture;

pub(crate) fn input() -> Architecture {
    Architecture {
        embedding: 3,
        window_steps: 20,
        following_distance: vec![4, 64, 64, 1],
        lane_encoder: vec![60, 64, 16],
        lane_change: vec![19, 64, 64, 2],
        speed_encoder: vec![60, 64, 16],
        velocity: vec![19, 64, 64, 1],
        style: vec![3, 1],
        mutual_information: vec![37, 64, 64, 6],
    }
}

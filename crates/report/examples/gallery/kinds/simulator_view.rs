//! One moment of a drive: the ego, the vehicles round it, its plan.

use maveric_report::figures::simulator_view::{SimulatorView, VehicleView};

pub(crate) fn input() -> SimulatorView {
    let vehicle = |x_m, y_m, heading_rad, speed_mps| VehicleView {
        x_m,
        y_m,
        heading_rad,
        speed_mps,
        length_m: 4.6,
        width_m: 1.9,
    };
    SimulatorView {
        participant: "P07".into(),
        condition: super::conditions()[1],
        time_s: 83.2,
        lanes: 2,
        lane_width_m: 3.66,
        ego: vehicle(2000.0, 0.5, 0.03, 29.4),
        others: vec![
            vehicle(2039.0, 0.0, 0.0, 22.1),
            vehicle(1958.0, 3.66, 0.0, 31.0),
            vehicle(2094.0, 3.66, 0.0, 30.2),
            vehicle(2700.0, 0.0, 0.0, 27.0),
        ],
        reference: Some(0),
        trail_m: (0..40).map(|k| (1940.0 + 1.5 * f64::from(k), 0.0)).collect(),
        plan_m: (0..60)
            .map(|k| {
                let s = f64::from(k) / 59.0;
                (2002.0 + 90.0 * s, 0.5 + 3.16 * s * s * (3.0 - 2.0 * s))
            })
            .collect(),
    }
}

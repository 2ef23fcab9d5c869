//! V at the wheel: the predicted speed as a command, from a window of what was simulated.

use super::{laws::keep_distance::KeepDistance, run::Stretch};
use maveric_domain::{Situation, VehicleId, scene::Reference};
use maveric_model::{Predictor, WindowBuffer};

/// Time in which ego approaches the speed that V asks for, in s.
///
/// # Source
/// Ours: V gives a speed, and a closed loop needs an acceleration.
pub const LAG_S: f64 = 0.5;

/// V as a law for [`simulate`](super::simulate), asked once for each row of `stretch` but the last, in order.
///
/// Until ego has driven a whole window itself, V reads the recorded rows before the stretch. `window` is an empty
/// buffer of the model; with `distance` the smaller of V's and F's commands counts. A window that is not the model's
/// gives NaN, which `simulate` refuses.
///
/// # Source
/// Method section 5, the smaller of both commands; on recorded people V alone does not hold a gap.
pub fn velocity_law<'a, F: Fn(f64) -> f64>(
    predictor: &'a Predictor,
    window: WindowBuffer,
    stretch: &'a Stretch<'_>,
    distance: Option<KeepDistance<F>>,
) -> impl FnMut(f64, f64, f64) -> f64 {
    let mut window = filled(window, stretch);
    let mut row = stretch.rows.start;
    move |gap_m, ego_speed_mps, lead_speed_mps| {
        let time_s = stretch.run.columns().time_s[row];
        row += 1;
        let now = situation(time_s, ego_speed_mps, gap_m, lead_speed_mps);
        let predicted = window
            .push(&now)
            .and_then(|()| predictor.predict(&window))
            .map_or(f64::NAN, |asked| asked.speed_mps);
        let to_speed = (predicted - ego_speed_mps) / LAG_S;
        let to_distance = distance
            .as_ref()
            .map(|d| d.accel_mps2(gap_m, ego_speed_mps, lead_speed_mps));
        // `f64::min` would hide a command that is no number.
        match to_distance {
            Some(other) if other < to_speed || other.is_nan() => other,
            _ => to_speed,
        }
    }
}

/// V's prediction of ego's speed at each row of `stretch` from the recorded window, in m/s; shape `(m,)`.
///
/// NaN where the window is not the model's.
pub fn predicted_speeds_mps(
    predictor: &Predictor,
    window: WindowBuffer,
    stretch: &Stretch<'_>,
) -> Vec<f64> {
    let mut window = filled(window, stretch);
    let rows = stretch.rows.clone().map(|row| {
        window
            .push(&recorded(stretch, row))
            .and_then(|()| predictor.predict(&window))
            .map_or(f64::NAN, |asked| asked.speed_mps)
    });
    rows.collect()
}

/// The recorded rows of one window before the stretch. A row that it refuses shows in the next prediction.
fn filled(mut window: WindowBuffer, stretch: &Stretch<'_>) -> WindowBuffer {
    let before = (window.settings().window_s * stretch.run.rate_hz()).ceil() as usize;
    for row in stretch.rows.start.saturating_sub(before)..stretch.rows.start {
        if window.push(&recorded(stretch, row)).is_err() {
            window.clear();
        }
    }
    window
}

fn recorded(stretch: &Stretch<'_>, row: usize) -> Situation {
    let c = stretch.run.columns();
    situation(
        c.time_s[row],
        c.ego_speed_mps[row],
        c.gap_m[row],
        c.lead_speed_mps[row],
    )
}

fn situation(time_s: f64, ego_speed_mps: f64, gap_m: f64, lead_speed_mps: f64) -> Situation {
    Situation {
        time_s,
        ego_speed_mps,
        reference: Reference {
            vehicle: Some(VehicleId(0)),
            dx_m: gap_m,
            dy_m: 0.0,
            speed_mps: lead_speed_mps,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FollowingRun, made_up, simulate, test_drives::drivers};
    use maveric_model::{
        params::{TrainParams, TrainSettings},
        train::{TrainingDrive, train},
    };
    use std::ops::ControlFlow;

    type ByDistance = KeepDistance<fn(f64) -> f64>;

    #[test]
    fn v_drives_towards_its_prediction_and_the_smaller_command_counts() {
        let drives = drivers(2, 60.0);
        let given: Vec<_> = drives
            .iter()
            .map(|(drive, _)| TrainingDrive { drive, adb: None })
            .collect();
        let settings = TrainSettings {
            epochs: 1,
            ..TrainSettings::default()
        };
        let params = TrainParams::new(settings).unwrap();
        let go_on = &mut |_: &_| ControlFlow::Continue(());
        let model = train(&given, &params, 1, go_on).unwrap().model;
        let predictor = Predictor::new(&model, model.mean_embedding()).unwrap();
        let run: FollowingRun = made_up::behind("P01", 300, 30.0, 20.0, |_| 20.0);
        let test = run.test();
        let predicted = predicted_speeds_mps(&predictor, model.window_buffer(), &test);
        assert_eq!(predicted.len(), 100);
        assert!(predicted.iter().all(|v| v.is_finite()));
        let alone = |distance: Option<ByDistance>| {
            let window = model.window_buffer();
            let mut law = velocity_law(&predictor, window, &test, distance);
            law(30.0, 20.0, 20.0)
        };
        // The first command comes from the recorded window alone.
        let expected = (predicted[0] - 20.0) / LAG_S;
        assert!((alone(None) - expected).abs() < 1e-9);
        let far = |_: f64| 500.0;
        let with = alone(Some(KeepDistance {
            distance_m: far,
            gains: crate::ConstantTimeGap::GAINS,
            safety: crate::SafetyBound::default(),
        }));
        assert!(with < -8.0 && with <= expected);
        let window = model.window_buffer();
        let law = velocity_law(&predictor, window, &test, None::<ByDistance>);
        assert_eq!(simulate(&test, "V", law).unwrap().gap_m.len(), 100);
    }
}

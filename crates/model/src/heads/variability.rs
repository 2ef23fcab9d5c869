//! How a driver's speed, gap and place in the lane wander within one drive.

use super::{free_speed, situation::blocks};
use maveric_domain::{Drive, Variability, Wander};
use std::ops::Range;

/// Time for what went before to settle, in s: after a pass speed falls back over some 5 s, after closing in so does the gap.
const SETTLE_S: f64 = 10.0;
/// Time before a lane change in which the car is on its way already, in s.
const BEFORE_CHANGE_S: f64 = 3.0;
/// Pieces that a stretch is made of, in s; half of one is the shortest.
const PIECE_S: f64 = 5.0;
/// Change over this time tells how fast a value wanders, in s: long beside the noise of a sensor, short beside the wander.
const APART_S: f64 = 1.0;
/// Least and largest lag that is told apart, in s.
const LAG_S: (f64, f64) = (1.0, 60.0);
/// Driving below which nothing is said, in s.
const LEAST_S: f64 = 20.0;

/// What wanders in `drive`, and how much; nothing of a kind of which it shows less than 20 s.
///
/// SDs are over rows: of speed on free road and of the place in the lane about the drive's mean, of the logarithm of the time gap
/// about its mean behind each vehicle. Times are such that the mean square of the change over 1 s is that of the drive.
pub fn variability(drive: &Drive) -> Variability {
    let rows = drive.rows();
    let road = drive.road();
    let joined = |holds: &dyn Fn(usize) -> bool| joined(blocks(drive, SETTLE_S, PIECE_S, holds));
    let free = joined(&|row| free_speed::on_free_road(drive, row));
    let following = joined(&|row| rows.following[row]);
    let before = (BEFORE_CHANGE_S * drive.rate_hz()).round() as usize;
    let keeping: Vec<Range<usize>> = joined(&|row| rows.changing[row] == 0)
        .into_iter()
        .map(|s| s.start..s.end.saturating_sub(before).max(s.start))
        .collect();
    let speeds = columns(&free, |row| rows.ego_speed_mps[row]);
    let gaps = columns(&following, |row| {
        libm::log(rows.lead_dx_m[row] / rows.ego_speed_mps[row])
    });
    let places = columns(&keeping, |row| {
        rows.ego_y_m[row] - road.lane_centre_m(rows.lane[row])
    });
    Variability {
        free_speed: wander(drive, &speeds, About::Drive),
        gap: wander(drive, &gaps, About::Stretch),
        place: wander(drive, &places, About::Drive),
        place_m: enough(drive, &places).then(|| mean(places.iter().flatten())),
    }
}

/// About which mean a value wanders.
#[derive(Clone, Copy, PartialEq)]
enum About {
    Drive,
    Stretch,
}

/// Stretches whose pieces follow on each other.
fn joined(pieces: Vec<Range<usize>>) -> Vec<Range<usize>> {
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for piece in pieces {
        match stretches.last_mut() {
            Some(last) if last.end == piece.start => last.end = piece.end,
            _ => stretches.push(piece),
        }
    }
    stretches
}

fn columns(stretches: &[Range<usize>], value: impl Fn(usize) -> f64) -> Vec<Vec<f64>> {
    let column = |stretch: &Range<usize>| stretch.clone().map(&value).collect();
    stretches.iter().map(column).collect()
}

fn mean<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0_usize), |(sum, n), v| (sum + v, n + 1));
    sum / n.max(1) as f64
}

fn enough(drive: &Drive, stretches: &[Vec<f64>]) -> bool {
    let rows: usize = stretches.iter().map(Vec::len).sum();
    rows as f64 >= LEAST_S * drive.rate_hz()
}

/// SD and lag of the values in `stretches`.
fn wander(drive: &Drive, stretches: &[Vec<f64>], about: About) -> Option<Wander> {
    if !enough(drive, stretches) {
        return None;
    }
    let overall = mean(stretches.iter().flatten());
    let squares: Vec<f64> = stretches
        .iter()
        .flat_map(|stretch| {
            let middle = match about {
                About::Drive => overall,
                About::Stretch => mean(stretch.iter()),
            };
            stretch.iter().map(move |v| (v - middle).powi(2))
        })
        .collect();
    let variance = mean(squares.iter());
    let apart = ((APART_S * drive.rate_hz()).round() as usize).max(1);
    let changes: Vec<f64> = stretches
        .iter()
        .flat_map(|s| s.iter().zip(s.iter().skip(apart)))
        .map(|(then, now)| (now - then).powi(2))
        .collect();
    let time_s = lag_s(variance, mean(changes.iter()));
    Some(Wander {
        sd: variance.sqrt(),
        time_s,
    })
}

/// The lag of a wander of this variance whose change over [`APART_S`] has this mean square.
fn lag_s(variance: f64, change: f64) -> f64 {
    let expected_change = |time_s: f64| {
        let h = APART_S / time_s;
        2.0 * variance * (1.0 - (1.0 + h) * libm::exp(-h))
    };
    let (mut low, mut high) = LAG_S;
    // The longer the lag, the smaller the change.
    for _ in 0..50 {
        let middle = (low * high).sqrt();
        if expected_change(middle) > change {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low * high).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{DriveMeta, DrivenBy, EgoTrack, Recording, Road};
    use std::f64::consts::{SQRT_2, TAU};

    /// So long on free road at 20 Hz, speed and place in the lane by the time.
    fn drive(seconds: usize, of: impl Fn(f64) -> (f64, f64)) -> Drive {
        let time_s: Vec<f64> = (0..20 * seconds).map(|i| i as f64 / 20.0).collect();
        let (speed_mps, y_m): (Vec<f64>, Vec<f64>) = time_s.iter().map(|&t| of(t)).unzip();
        let step = |x: &mut f64, v: &f64| {
            *x += v / 20.0;
            Some(*x)
        };
        let ego = EgoTrack {
            length_m: 4.8,
            x_m: speed_mps.iter().scan(0.0, step).collect(),
            y_m,
            speed_mps,
        };
        let segment = vec![0; time_s.len()];
        let recording = Recording::new(Road::PAPER, 20.0, time_s, segment, ego, Vec::new());
        let meta = DriveMeta::named("P01-baseline", "P01", "baseline", DrivenBy::Human).unwrap();
        Drive::from_recording(meta, &recording.unwrap()).unwrap()
    }

    #[test]
    fn a_sway_has_the_sd_and_the_pace_of_its_course() {
        // Without the first 20 s ten periods are left of the one, and forty of the other.
        let found = variability(&drive(620, |t| {
            (
                25.0 + 0.8 * libm::sin(TAU * t / 60.0),
                0.2 + 0.1 * libm::sin(TAU * t / 15.0),
            )
        }));
        let near = |wander: Option<Wander>, sd: f64, time_s: f64| {
            let wander = wander.unwrap();
            assert!((wander.sd / sd - 1.0).abs() < 0.03, "{wander:?}");
            assert!((wander.time_s / time_s - 1.0).abs() < 0.2, "{wander:?}");
        };
        // The rate of change of a sine has the SD of the sine over its period / 2π.
        near(found.free_speed, 0.8 / SQRT_2, 60.0 / TAU);
        near(found.place, 0.1 / SQRT_2, 15.0 / TAU);
        assert!((found.place_m.unwrap() - 0.2).abs() < 0.01);
        assert_eq!(found.gap, None);
    }

    #[test]
    fn what_stands_still_does_not_wander_and_a_short_drive_says_nothing() {
        let still = variability(&drive(60, |_| (25.0, 0.0)));
        let sd = |w: Option<Wander>| w.unwrap().sd;
        assert!(sd(still.free_speed) < 1e-9 && sd(still.place) < 1e-9);
        assert_eq!(
            variability(&drive(25, |_| (25.0, 0.0))),
            Variability::default()
        );
    }
}

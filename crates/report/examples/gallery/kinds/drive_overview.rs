//! Speed, gap and lane of ten minutes, with a hole in the recording.

use super::wobble;
use maveric_report::figures::drive_overview::DriveOverview;

pub(crate) fn input() -> DriveOverview {
    let rows = || (0..1200_u32).filter(|k| !(500..540).contains(k));
    let time = |k: u32| f64::from(k) * 0.5;
    let passing = |k: u32| k % 180 >= 120;
    DriveOverview {
        drive: "P07-own".into(),
        source: "Example data".into(),
        time_s: rows().map(time).collect(),
        segment: rows().map(|k| u32::from(k >= 540)).collect(),
        speed_mps: rows()
            .map(|k| 28.0 + 2.0 * (time(k) / 20.0).sin() + 0.1 * wobble(k as usize, 1))
            .collect(),
        gap_m: rows().map(|k| (k % 180 > 40).then(|| 90.0 - 1.0 * f64::from(k % 180))).collect(),
        lane: rows().map(|k| u8::from(passing(k))).collect(),
        lanes: 2,
    }
}

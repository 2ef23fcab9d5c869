//! Others whose places are told from ego: where they are by where ego is at that time.

use crate::{
    lanes::EgoPath,
    raw::{EgoSample, RawDrive, Timed},
};

/// Puts others of ego's own frame into the frame of ego's poses; those of times without a pose are left out. Their speeds may be
/// relative or not, so that they are as if not recorded.
pub(super) fn place_by_ego(drive: &mut RawDrive) {
    // Where nobody stamped, receipt says when.
    let stamped =
        drive.ego.iter().any(|s| s.stamp_ns != 0) && drive.objects.iter().any(|o| o.stamp_ns != 0);
    let time = |s: &dyn Fn() -> (i64, i64)| {
        let (stamp, log) = s();
        if stamped { stamp } else { log }
    };
    let mut ego: Vec<EgoSample> = drive
        .ego
        .iter()
        .filter(|s| s.is_finite())
        .copied()
        .collect();
    for s in &mut ego {
        s.stamp_ns = time(&|| (s.stamp_ns, s.log_ns));
    }
    ego.sort_by_key(|s| s.stamp_ns);
    ego.dedup_by_key(|s| s.stamp_ns);
    let mut path = EgoPath::new(&ego);
    drive.objects.retain_mut(|o| {
        let now = time(&|| (o.stamp_ns, o.log_ns));
        let Some((x_m, y_m, (cos, sin))) = path.pose(now) else {
            return false;
        };
        (o.x_m, o.y_m) = (
            x_m + o.x_m * cos - o.y_m * sin,
            y_m + o.x_m * sin + o.y_m * cos,
        );
        o.speed_mps = f64::NAN;
        true
    });
}

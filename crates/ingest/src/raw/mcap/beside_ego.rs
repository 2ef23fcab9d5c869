//! Others whose places are told from ego: where they are by where ego is at that time.

use crate::{
    lanes::EgoPath,
    raw::{EgoSample, EgoSamples, RawDrive, Timed as _},
};

/// Puts others of ego's own frame into the frame of ego's poses; those of times without a pose are left out. Their speeds may be
/// relative or not, so that they are as if not recorded.
pub(super) fn place_by_ego(drive: &mut RawDrive) {
    // Where nobody stamped, receipt says when.
    let any = |stamps: &[i64]| stamps.iter().any(|ns| *ns != 0);
    let stamped = any(&drive.ego.stamp_ns) && any(&drive.objects.stamp_ns);
    let mut ego: EgoSamples = drive.ego.iter().filter(EgoSample::is_finite).collect();
    if !stamped {
        ego.stamp_ns.clone_from(&ego.log_ns);
    }
    ego.sort();
    ego.dedup();
    let mut path = EgoPath::new(&ego);
    drive.objects.retain_mut(|o| {
        let now = if stamped { o.stamp_ns } else { o.log_ns };
        let Some((x_m, y_m, (cos, sin))) = path.pose(now) else {
            return false;
        };
        (o.x_m, o.y_m) = (x_m + o.x_m * cos - o.y_m * sin, y_m + o.x_m * sin + o.y_m * cos);
        o.speed_mps = f64::NAN;
        true
    });
}

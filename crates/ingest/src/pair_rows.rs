//! What the rows of a follower and its leader leave to be worked out in the order of time.

use crate::raw::{
    EgoSample, EgoSamples, LEADER, ObjectSamples, PairRows, RawDrive, leader::Leaders,
};

/// Integrates ego's way and counts the leaders, where the rows say neither. Samples are sorted by time and have speeds.
pub(crate) fn in_order(drive: &mut RawDrive) {
    let Some(PairRows { x_from_speed, unnumbered }) = drive.pair else {
        return;
    };
    if x_from_speed {
        integrate(&mut drive.ego, &mut drive.objects);
    }
    if unnumbered {
        let mut leaders = Leaders::default();
        for i in 0..drive.objects.len() {
            drive.objects.id[i] = LEADER + leaders.before(drive.objects.at(i));
        }
    }
}

/// The way that ego's speed makes, by the trapezoidal rule; the leader of a row is from where ego is then.
fn integrate(ego: &mut EgoSamples, objects: &mut ObjectSamples) {
    let mut way_m = 0.0;
    let mut last: Option<(i64, f64)> = None;
    for i in 0..ego.len() {
        let EgoSample { stamp_ns, speed_mps, .. } = ego.at(i);
        let v = speed_mps.unwrap_or(0.0);
        if let Some((before_ns, before_mps)) = last {
            way_m += 0.5 * (before_mps + v) * (stamp_ns - before_ns) as f64 / 1e9;
        }
        last = Some((stamp_ns, v));
        ego.x_m[i] = way_m;
    }
    // Without ego in its row nobody knows where the leader was.
    let mut ego_row = 0;
    objects.retain_mut(|o| {
        while ego.get(ego_row).is_some_and(|s| s.stamp_ns < o.stamp_ns) {
            ego_row += 1;
        }
        let row = ego.get(ego_row).filter(|s| s.stamp_ns == o.stamp_ns);
        o.x_m += row.map_or(0.0, |s| s.x_m);
        row.is_some()
    });
}

//! Where ego follows its reference vehicle.

use super::Rows;
use crate::scene::Road;

/// Longest time gap at which ego still follows, in s.
const TIME_GAP_S: f64 = 3.0;
/// Largest difference of speeds at which ego follows rather than closes in, in m/s.
const SPEED_DIFFERENCE_MPS: f64 = 1.0;
/// Fills `following`: a reference vehicle ahead in ego's lane, a time gap below 3 s, speeds within
/// 1 m/s, and ego keeping its lane.
pub(super) fn label(rows: &mut Rows, road: &Road) {
    rows.following = (0..rows.time_s.len())
        .map(|i| {
            rows.lead_ahead(i, road)
                && rows.changing[i] == 0
                && rows.lead_dx_m[i] < TIME_GAP_S * rows.ego_speed_mps[i]
                && (rows.lead_speed_mps[i] - rows.ego_speed_mps[i]).abs() < SPEED_DIFFERENCE_MPS
        })
        .collect();
}

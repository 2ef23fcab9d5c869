//! What the samples of a drive are to become.

use crate::{
    error::IngestError,
    lane_centres::LaneShape,
    mapping::{FrameKind, Mapping, RoadMapping, SeesMapping},
    settings::IngestSettings,
};
use maveric_domain::Road;

/// How the samples of a drive become a recording.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target<'a> {
    pub(crate) road: Road,
    /// How the log's frame lies to it.
    pub(crate) frame: FrameKind,
    /// Points along the right lane in the log's frame, by which the road is straightened; none where it is straight.
    pub(crate) centre_line: &'a [[f64; 2]],
    /// How lanes lie across the road.
    pub(crate) lane_shape: LaneShape<'a>,
    /// Lateral position of lane 0's centre in the log's frame, in m.
    pub(crate) right_lane_centre_y_m: f64,
    /// Whether vehicles beside ego's lane are left out, because the only lane known is ego's.
    pub(crate) own_lane_only: bool,
    /// Whether y comes from numbers of lanes: its steps are held, not interpolated.
    pub(crate) lane_steps: bool,
    /// What the mapping says of the rig's sight.
    pub(crate) sees: SeesMapping,
    /// Rows a second.
    pub(crate) rate_hz: f64,
    /// Longest hole that is bridged, in s.
    pub(crate) max_gap_s: f64,
}

impl<'a> Target<'a> {
    /// The target for a log that does not describe its own road.
    ///
    /// # Errors
    /// [`IngestError::BadSetting`].
    pub(crate) fn mapped(settings: &'a IngestSettings) -> Result<Self, IngestError> {
        let mapping = settings.mapping.as_ref();
        let road = mapping.and_then(|m| m.road).unwrap_or(RoadMapping::UNKNOWN);
        let centre_line = mapping.map_or(&[][..], |m| &m.centre_line);
        Ok(Self {
            road: road.road(),
            frame: if centre_line.is_empty() { road.frame } else { FrameKind::Map },
            centre_line,
            lane_shape: mapping.map_or(LaneShape::Even, Mapping::lane_shape),
            right_lane_centre_y_m: road.right_lane_centre_y_m,
            own_lane_only: road.lanes == 1,
            lane_steps: false,
            sees: mapping.map(|m| m.sees).unwrap_or_default(),
            rate_hz: settings.rate_hz()?,
            max_gap_s: settings.max_gap_s()?,
        })
    }
}

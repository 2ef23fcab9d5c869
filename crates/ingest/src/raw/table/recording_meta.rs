//! The file beside a table that says how it was recorded: frame rate, posted speed, lane markings.

use super::{
    open::{Kind, Table},
    take,
    text::Style,
};
use crate::{
    error::IngestError,
    mapping::{RecordingMeta, RoadMapping, TableMapping},
    source::Source,
};
use std::path::{Path, PathBuf};

/// What such a file says.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Meta {
    pub(super) frames_per_s: Option<f64>,
    posted_speed_mps: Option<f64>,
    /// Positions of the markings across the road, in m, of those who drive along x and against it.
    markings_m: [Vec<f64>; 2],
}

/// Reads the file beside `table` that its mapping names.
///
/// # Errors
/// As [`crate::read_log`], naming that file.
pub(super) fn read(
    table: &Path,
    columns: &RecordingMeta,
    mapping: &TableMapping,
    sources: &mut Vec<Source>,
) -> Result<Meta, IngestError> {
    let path = beside(table, &columns.replace);
    let bytes = take(&path, sources)?;
    let numbers = [&columns.frames_per_s, &columns.posted_speed];
    let words = [&columns.markings_along_x, &columns.markings_against_x];
    let numbers = numbers.into_iter().flatten().map(|n| (n, Kind::Number));
    let words = words.into_iter().flatten().map(|n| (n, Kind::Word));
    let wanted = numbers.chain(words).map(|(name, kind)| (name.as_str(), kind));
    let wanted: Vec<(&str, Kind)> = wanted.collect();
    let meta = Table::open(&path, bytes, Style::default(), &wanted)?;
    let number = |name: &Option<String>| match name {
        Some(name) => {
            let value = meta.numbers(name)?.first().copied();
            Ok::<_, IngestError>(value.filter(|v| *v > 0.0))
        }
        None => Ok(None),
    };
    let markings = |name: &Option<String>| -> Result<Vec<f64>, IngestError> {
        let Some(name) = name else {
            return Ok(Vec::new());
        };
        let words = meta.words(name)?;
        let cell = words.into_iter().next().flatten().unwrap_or_default();
        let parse = |text: &str| {
            let value = text.trim().parse().ok().filter(|v: &f64| v.is_finite());
            let value = value.map(|v| v * mapping.units.length.metres());
            value.ok_or_else(|| meta.bad_cell(0, name, cell.clone()))
        };
        let parts = cell.split(';').filter(|p| !p.trim().is_empty());
        parts.map(parse).collect()
    };
    let frames_per_s = number(&columns.frames_per_s)?;
    if let (Some(name), None) = (&columns.frames_per_s, frames_per_s) {
        return Err(meta.bad_cell(0, name, "no number above 0"));
    }
    let posted = number(&columns.posted_speed)?;
    Ok(Meta {
        frames_per_s,
        posted_speed_mps: posted.map(|v| v * mapping.units.speed.metres_per_second()),
        markings_m: [markings(&columns.markings_along_x)?, markings(&columns.markings_against_x)?],
    })
}

fn beside(table: &Path, [from, to]: &[String; 2]) -> PathBuf {
    let name = table.file_name().unwrap_or_default().to_string_lossy();
    table.with_file_name(name.replacen(from.as_str(), to, 1))
}

impl Meta {
    /// The road of those who drive along x (`sign` 1) or against it (-1), where `flip` turns the table's y to
    /// the left; without markings the mapping's.
    pub(super) fn road(&self, mapped: &RoadMapping, sign: f64, flip: f64) -> RoadMapping {
        let mut road = *mapped;
        if let Some(posted) = self.posted_speed_mps {
            road.posted_speed_mps = posted;
        }
        let [along, against] = &self.markings_m;
        let markings = if sign > 0.0 { along } else { against };
        let mut y: Vec<f64> = markings.iter().map(|m| flip * sign * m).collect();
        y.sort_by(f64::total_cmp);
        if let [right, next, .., left] | [right, next @ left] = y[..]
            && left > right
        {
            road.lanes = u8::try_from(y.len() - 1).unwrap_or(u8::MAX);
            road.lane_width_m = (left - right) / f64::from(road.lanes);
            road.right_lane_centre_y_m = 0.5 * (right + next);
        }
        road
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markings_give_the_lanes_of_both_directions_from_the_right() {
        let meta = Meta {
            // As in images: y grows downwards, the upper road leads to the left.
            markings_m: [vec![21.0, 25.0, 29.0], vec![8.0, 12.0, 16.0]],
            posted_speed_mps: Some(36.0),
            frames_per_s: Some(25.0),
        };
        let along = meta.road(&RoadMapping::UNKNOWN, 1.0, -1.0);
        assert_eq!(along.lanes, 2);
        assert!((along.lane_width_m - 4.0).abs() < 1e-12);
        assert!((along.right_lane_centre_y_m + 27.0).abs() < 1e-12);
        assert!((along.posted_speed_mps - 36.0).abs() < 1e-12);
        let against = meta.road(&RoadMapping::UNKNOWN, -1.0, -1.0);
        assert!((against.right_lane_centre_y_m - 10.0).abs() < 1e-12);
        let beside =
            beside(Path::new("d/01_tracks.csv"), &["_tracks".into(), "_recordingMeta".into()]);
        assert_eq!(beside, Path::new("d/01_recordingMeta.csv"));
    }
}

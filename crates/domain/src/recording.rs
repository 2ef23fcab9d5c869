//! Who was where, evenly sampled.

use crate::{
    error::{DomainError, as_long, at_least, finite, positive},
    ids::VehicleId,
    scene::{EgoState, Road, Scene, VehicleState},
    sees::Sees,
};

/// Ego's track; every column has shape `(n,)`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EgoTrack {
    /// Bumper to bumper, in m.
    pub length_m: f64,
    /// Position of the centre along the road, in m.
    pub x_m: Vec<f64>,
    /// Lateral position of the centre, in m; 0 is the centre of lane 0.
    pub y_m: Vec<f64>,
    /// Speed, in m/s.
    pub speed_mps: Vec<f64>,
}

/// Another vehicle over consecutive rows; one that vanishes and returns has two tracks with one id.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectTrack {
    /// Which vehicle.
    pub id: VehicleId,
    /// Bumper to bumper, in m.
    pub length_m: f64,
    /// Row of the recording at which the columns start.
    pub first_row: usize,
    /// Position of the centre along the road, in m; shape `(m,)`.
    pub x_m: Vec<f64>,
    /// Lateral position of the centre, in m; shape `(m,)`.
    pub y_m: Vec<f64>,
    /// Speed, in m/s; shape `(m,)`.
    pub speed_mps: Vec<f64>,
}

impl ObjectTrack {
    /// A track that begins at `first_row`, still without a row.
    pub fn new(id: VehicleId, length_m: f64, first_row: usize) -> Self {
        Self { id, length_m, first_row, x_m: Vec::new(), y_m: Vec::new(), speed_mps: Vec::new() }
    }

    /// Adds the next row.
    pub fn push(&mut self, state: &VehicleState) {
        self.x_m.push(state.x_m);
        self.y_m.push(state.y_m);
        self.speed_mps.push(state.speed_mps);
    }
}

/// Who was where, at an even rate, from a log or from a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    road: Road,
    rate_hz: f64,
    time_s: Vec<f64>,
    segment: Vec<u32>,
    ego: EgoTrack,
    others: Vec<ObjectTrack>,
    lateral: bool,
    sees: Sees,
}

fn check_column(column: &'static str, values: &[f64], rows: usize) -> Result<(), DomainError> {
    as_long(column, values.len(), rows)?;
    finite(column, values)
}

fn not_negative(name: &'static str, found: f64) -> Result<(), DomainError> {
    if found.is_finite() && found >= 0.0 {
        Ok(())
    } else {
        Err(DomainError::OutOfRange { name, found, expected: "a finite number of 0 or more" })
    }
}

impl Recording {
    /// Takes tracks sampled every 1/`rate_hz` seconds within a segment.
    ///
    /// `time_s` (s since the start) and `segment` have shape `(n,)`; the segment number rises by one after
    /// each hole that was too long to bridge, and no window may span two segments. Rows are ordered in time.
    ///
    /// # Errors
    /// [`DomainError::TooShort`] below two rows; [`DomainError::LengthMismatch`],
    /// [`DomainError::NotFinite`] or [`DomainError::OutOfRange`] where a column is not as described.
    pub fn new(
        road: Road,
        rate_hz: f64,
        time_s: Vec<f64>,
        segment: Vec<u32>,
        ego: EgoTrack,
        others: Vec<ObjectTrack>,
    ) -> Result<Self, DomainError> {
        let rows = time_s.len();
        at_least("recording", rows, 2)?;
        positive("rate_hz", rate_hz)?;
        positive("lane_width_m", road.lane_width_m)?;
        positive("posted_speed_mps", road.posted_speed_mps)?;
        positive("lanes", f64::from(road.lanes))?;
        not_negative("ego.length_m", ego.length_m)?;
        check_column("time_s", &time_s, rows)?;
        check_column("ego.x_m", &ego.x_m, rows)?;
        check_column("ego.y_m", &ego.y_m, rows)?;
        check_column("ego.speed_mps", &ego.speed_mps, rows)?;
        as_long("segment", segment.len(), rows)?;
        if let Some(row) = time_s.windows(2).position(|w| w[1] <= w[0]) {
            return Err(DomainError::OutOfRange {
                name: "time_s",
                found: time_s[row + 1],
                expected: "later than the row before",
            });
        }
        for track in &others {
            let m = track.x_m.len();
            not_negative("object.length_m", track.length_m)?;
            check_column("object.x_m", &track.x_m, m)?;
            check_column("object.y_m", &track.y_m, m)?;
            check_column("object.speed_mps", &track.speed_mps, m)?;
            if track.first_row + m > rows {
                return Err(DomainError::LengthMismatch {
                    column: "object.x_m",
                    found: track.first_row + m,
                    expected: rows,
                });
            }
        }
        Ok(Self { road, rate_hz, time_s, segment, ego, others, lateral: true, sees: Sees::ALL })
    }

    /// The same, where nobody recorded who was how far to the side: every lateral position stands for none.
    #[must_use]
    pub fn without_lateral(self) -> Self {
        Self { lateral: false, ..self }
    }

    /// Whether lateral positions were recorded; else whoever is passed cannot be told from who is ahead in ego's lane.
    pub fn has_lateral(&self) -> bool {
        self.lateral
    }

    /// The same, by a rig that sees only this.
    #[must_use]
    pub fn seen_by(self, sees: Sees) -> Self {
        Self { sees, ..self }
    }

    /// What the rig sees; everything, unless [`Recording::seen_by`] said otherwise.
    pub fn sees(&self) -> Sees {
        self.sees
    }

    /// Number of rows, n.
    pub fn rows(&self) -> usize {
        self.time_s.len()
    }

    /// Its lanes, their width and the posted speed.
    pub fn road(&self) -> &Road {
        &self.road
    }

    /// Samples a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Time since the start, in s; shape `(n,)`.
    pub fn time_s(&self) -> &[f64] {
        &self.time_s
    }

    /// Segment number of each row; shape `(n,)`.
    pub fn segment(&self) -> &[u32] {
        &self.segment
    }

    /// Ego's track.
    pub fn ego(&self) -> &EgoTrack {
        &self.ego
    }

    /// Everybody else's tracks.
    pub fn others(&self) -> &[ObjectTrack] {
        &self.others
    }

    /// What was around ego at `row`; `None` past the end. For every row in turn, [`Recording::scenes`] does not search.
    pub fn scene(&self, row: usize) -> Option<Scene> {
        (row < self.rows()).then(|| self.scene_of(row, self.others.iter()))
    }

    /// The scenes of all rows, in their order; the work follows the number of samples, however many tracks there are.
    pub fn scenes(&self) -> impl Iterator<Item = Scene> + '_ {
        let mut coming: Vec<usize> = (0..self.others.len()).collect();
        coming.sort_by_key(|&i| std::cmp::Reverse((self.others[i].first_row, i)));
        // In the order of the tracks, as `scene` gives them.
        let mut present: Vec<usize> = Vec::new();
        (0..self.rows()).map(move |row| {
            present.retain(|&i| {
                let track = &self.others[i];
                row - track.first_row < track.x_m.len()
            });
            while let Some(i) = coming.pop_if(|&mut i| self.others[i].first_row <= row) {
                let place = present.partition_point(|&j| j < i);
                present.insert(place, i);
            }
            self.scene_of(row, present.iter().map(|&i| &self.others[i]))
        })
    }

    /// The scene of a row that there is, with those of some tracks that are there then.
    fn scene_of<'a>(&self, row: usize, tracks: impl Iterator<Item = &'a ObjectTrack>) -> Scene {
        let vehicles = tracks.filter_map(|track| {
            let index = row.checked_sub(track.first_row)?;
            Some(VehicleState {
                id: track.id,
                x_m: *track.x_m.get(index)?,
                y_m: track.y_m[index],
                speed_mps: track.speed_mps[index],
                length_m: track.length_m,
            })
        });
        Scene {
            time_s: self.time_s[row],
            ego: EgoState {
                x_m: self.ego.x_m[row],
                y_m: self.ego.y_m[row],
                speed_mps: self.ego.speed_mps[row],
                length_m: self.ego.length_m,
            },
            vehicles: vehicles.collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_rows(ego_m: f64, other_m: f64) -> Result<Recording, DomainError> {
        let ego = EgoTrack {
            length_m: ego_m,
            x_m: vec![0.0, 1.0],
            y_m: vec![0.0; 2],
            speed_mps: vec![20.0; 2],
        };
        let other = ObjectTrack {
            id: VehicleId(1),
            length_m: other_m,
            first_row: 0,
            x_m: vec![50.0, 51.0],
            y_m: vec![0.0; 2],
            speed_mps: vec![20.0; 2],
        };
        let (time_s, segment) = (vec![0.0, 0.05], vec![0; 2]);
        Recording::new(Road::PAPER, 20.0, time_s, segment, ego, vec![other])
    }

    #[test]
    fn a_length_that_no_vehicle_has_is_refused_by_name() {
        assert!(two_rows(4.7, 4.7).is_ok());
        for (ego_m, other_m, name) in [
            (-4.7, 4.7, "ego.length_m"),
            (f64::NAN, 4.7, "ego.length_m"),
            (4.7, -1.0, "object.length_m"),
        ] {
            let error = two_rows(ego_m, other_m).unwrap_err().to_string();
            assert!(error.contains(name), "{error}");
        }
    }
}

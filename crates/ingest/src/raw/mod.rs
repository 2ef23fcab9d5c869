//! What readers of raw formats give: samples as recorded, before they share a time base.

pub(crate) mod leader;
pub(crate) mod mcap;
mod samples;
pub(crate) mod table;

use maveric_domain::Sees;
pub(crate) use samples::{
    EgoSample, EgoSamples, ObjectSample, ObjectSamples, Sighting, Sightings, SpeedSample,
    SpeedSamples, Timed,
};

/// Number of the first leader that has none among the vehicles of its file.
pub(crate) const LEADER: u32 = 1;
/// Usual numbers of vehicles are below this, and those that are given to other names are not.
pub(crate) const GIVEN_FROM: u32 = 1 << 31;

/// What the rows of a follower and its leader leave to be worked out in the order of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct PairRows {
    /// Ego's way is integrated from its speed: until then ego's x is 0 and the leader's is from ego's.
    pub(crate) x_from_speed: bool,
    /// Leaders have no numbers: all have the same.
    pub(crate) unnumbered: bool,
}

/// The samples of one drive.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct RawDrive {
    /// Ego, in the order of the file.
    pub(crate) ego: EgoSamples,
    /// The others, in the order of the file.
    pub(crate) objects: ObjectSamples,
    /// Ego's speeds from a channel of their own, in the order of the file; joined once all are on one clock.
    pub(crate) speeds: SpeedSamples,
    /// Times at which the others were observed; `None` if every row of ego is one.
    pub(crate) sightings: Option<Sightings>,
    /// Of a table of a follower and its leader: what is worked out once its rows are in order; samples have the numbers of its
    /// rows, from 0.
    pub(crate) pair: Option<PairRows>,
    /// Ego's length, where the log says it, in m.
    pub(crate) ego_length_m: Option<f64>,
    /// Whether one of the objects may be ego itself.
    pub(crate) ego_among_objects: bool,
    /// What its files show of the road around ego.
    pub(crate) sees: Sees,
    /// Whether nobody recorded who was how far to the side, though ego passes others.
    pub(crate) without_lateral: bool,
}

impl RawDrive {
    /// Moves ego and the others.
    pub(crate) fn move_all(&mut self, to: impl Fn(f64, f64) -> (f64, f64)) {
        let (ego, objects) = (&mut self.ego, &mut self.objects);
        let of_ego = ego.x_m.iter_mut().zip(&mut ego.y_m);
        let of_objects = objects.x_m.iter_mut().zip(&mut objects.y_m);
        for (x, y) in of_ego.chain(of_objects) {
            (*x, *y) = to(*x, *y);
        }
    }
}

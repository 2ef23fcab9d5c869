//! What readers of raw formats give: samples as recorded, before they share a time base.

pub(crate) mod leader;
pub(crate) mod mcap;
pub(crate) mod table;

use maveric_domain::Sees;

/// Number of the first leader that has none among the vehicles of its file.
pub(crate) const LEADER: u32 = 1;

/// Where ego was at one time, as recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EgoSample {
    /// Time stamped by the source, in ns.
    pub(crate) stamp_ns: i64,
    /// Time of receipt, in ns.
    pub(crate) log_ns: i64,
    /// Number of the message or row that it came in; 0 where samples are not in the order of a file.
    pub(crate) nth: u32,
    /// Position of the centre in the log's frame, in m.
    pub(crate) x_m: f64,
    /// Position of the centre in the log's frame, in m.
    pub(crate) y_m: f64,
    /// Heading in the log's frame, in rad.
    pub(crate) yaw_rad: Option<f64>,
    /// Speed, in m/s; none where only poses were recorded.
    pub(crate) speed_mps: Option<f64>,
}

/// Where another vehicle was at one time, as recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ObjectSample {
    /// Time stamped by the source, in ns.
    pub(crate) stamp_ns: i64,
    /// Time of receipt, in ns.
    pub(crate) log_ns: i64,
    /// Number of the message or row that it came in; 0 where samples are not in the order of a file.
    pub(crate) nth: u32,
    /// Number within the log.
    pub(crate) id: u32,
    /// Position of the centre in the log's frame, in m.
    pub(crate) x_m: f64,
    /// Position of the centre in the log's frame, in m.
    pub(crate) y_m: f64,
    /// Speed, in m/s; NaN where it was not recorded and is differentiated from the positions.
    pub(crate) speed_mps: f64,
    /// Bumper to bumper, in m; NaN where it is not known: there are many samples, and an `Option` takes twice the room.
    pub(crate) length_m: f64,
}

/// Ego's speed at one time, from a channel of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SpeedSample {
    /// Time stamped by the source, in ns.
    pub(crate) stamp_ns: i64,
    /// Time of receipt, in ns.
    pub(crate) log_ns: i64,
    /// Number of the message that it came in.
    pub(crate) nth: u32,
    /// Speed, in m/s.
    pub(crate) speed_mps: f64,
}

/// A time at which somebody looked who else is there, whoever was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sighting {
    /// Time stamped by the source, in ns.
    pub(crate) stamp_ns: i64,
    /// Time of receipt, in ns.
    pub(crate) log_ns: i64,
    /// Number of the message or row that it came in; 0 where samples are not in the order of a file.
    pub(crate) nth: u32,
}

/// What ego, the others and speeds have in common: a place in time.
pub(crate) trait Timed {
    /// Time stamped by the source, in ns.
    fn stamp_ns(&self) -> i64;
    /// The same, to be set.
    fn stamp_mut(&mut self) -> &mut i64;
    /// Time of receipt, in ns.
    fn log_ns(&self) -> i64;
    /// What may not come twice at one time: a vehicle.
    fn id(&self) -> u32;
    /// Whether every number of it is one.
    fn is_finite(&self) -> bool;
}

macro_rules! timed {
    ($name:ty, $id:expr, $finite:expr) => {
        impl Timed for $name {
            fn stamp_ns(&self) -> i64 {
                self.stamp_ns
            }
            fn stamp_mut(&mut self) -> &mut i64 {
                &mut self.stamp_ns
            }
            fn log_ns(&self) -> i64 {
                self.log_ns
            }
            fn id(&self) -> u32 {
                $id(self)
            }
            fn is_finite(&self) -> bool {
                $finite(self)
            }
        }
    };
}

timed!(EgoSample, |_: &Self| 0, |s: &Self| {
    s.x_m.is_finite() && s.y_m.is_finite() && s.speed_mps.is_none_or(f64::is_finite)
});
timed!(ObjectSample, |s: &Self| s.id, |s: &Self| {
    s.x_m.is_finite() && s.y_m.is_finite() && !s.speed_mps.is_infinite()
});
timed!(Sighting, |_: &Self| 0, |_: &Self| true);
timed!(SpeedSample, |_: &Self| 0, |s: &Self| s
    .speed_mps
    .is_finite());

impl ObjectSample {
    /// Bumper to bumper, in m, where it is known.
    pub(crate) fn known_length_m(&self) -> Option<f64> {
        (!self.length_m.is_nan()).then_some(self.length_m)
    }

    /// The same of ego.
    pub(crate) fn as_ego(&self) -> EgoSample {
        EgoSample {
            stamp_ns: self.stamp_ns,
            log_ns: self.log_ns,
            nth: self.nth,
            x_m: self.x_m,
            y_m: self.y_m,
            yaw_rad: None,
            speed_mps: (!self.speed_mps.is_nan()).then_some(self.speed_mps),
        }
    }
}

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
    pub(crate) ego: Vec<EgoSample>,
    /// The others, in the order of the file.
    pub(crate) objects: Vec<ObjectSample>,
    /// Ego's speeds from a channel of their own, in the order of the file; joined once all are on one clock.
    pub(crate) speeds: Vec<SpeedSample>,
    /// When somebody looked who else is there; where it is empty every row of ego says it.
    pub(crate) sightings: Vec<Sighting>,
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

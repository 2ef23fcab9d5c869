//! What channels can tell about a drive, and which numbers each role has room for.

/// What a channel can tell about a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Role {
    /// Ego's pose and speed: `nav_msgs/Odometry`.
    Odometry,
    /// Ego's pose alone: `geometry_msgs/PoseStamped`.
    Pose,
    /// Transforms, ego's pose among them: `tf2_msgs/TFMessage`.
    Frames,
    /// Ego's place on Earth: `sensor_msgs/NavSatFix`.
    Fix,
    /// The other vehicles: `derived_object_msgs/ObjectArray`.
    Objects,
    /// Ego's speed alone: `geometry_msgs/TwistStamped`.
    Speed,
    /// Which of the objects is ego: `carla_msgs/CarlaEgoVehicleInfo`.
    Identity,
}

/// A number of ego or of an object, by its place in a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Slot {
    Sec,
    Nanosec,
    X,
    Y,
    Qx,
    Qy,
    Qz,
    Qw,
    Vx,
    Vy,
    Yaw,
    Speed,
    Id,
    Length,
    Shape,
    Size0,
    Size1,
    Class,
}

impl Slot {
    /// The number in a row; NaN where the message does not say it.
    pub(crate) fn at(self, row: &[f64]) -> f64 {
        row[self as usize]
    }

    /// The number in a row, where the message says it.
    pub(crate) fn known(self, row: &[f64]) -> Option<f64> {
        Some(self.at(row)).filter(|v| !v.is_nan())
    }
}

/// Names of the slots of an object; behind them stands the name of its frame, and then the 16 bytes of its UUID where it has one.
pub(crate) const OBJECT_SLOTS: [&str; 18] = [
    "sec", "nanosec", "x", "y", "qx", "qy", "qz", "qw", "vx", "vy", "yaw", "speed", "id", "length",
    "shape", "size0", "size1", "class",
];

/// Names of the slots of ego's pose, speed or fix (`x`, `y` are longitude and latitude there); behind them stand the names of its frames.
pub(crate) const EGO_SLOTS: &[&str] = OBJECT_SLOTS.split_at(Slot::Id as usize).0;

impl Role {
    /// Names of the slots that a mapping may fill.
    pub(crate) fn slots(self) -> &'static [&'static str] {
        match self {
            Self::Objects => &OBJECT_SLOTS,
            Self::Identity => &["id"],
            _ => EGO_SLOTS,
        }
    }
}

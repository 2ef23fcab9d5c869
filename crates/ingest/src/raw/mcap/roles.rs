//! Message types that tell something about a drive, and where in them it stands.

use super::slots::{EGO_SLOTS, OBJECT_SLOTS, Role};
use crate::mapping::MessageMapping;
use maveric_bag::plain_name;

/// How the numbers of an object are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Convention {
    /// Twist in the frame of the map, shapes of `shape_msgs/SolidPrimitive`, classes of `derived_object_msgs`.
    Derived,
    /// Twist in the object's own frame, shapes and labels of `autoware_perception_msgs`.
    Autoware,
    /// As a mapping says: twist in the frame of the map, every object a vehicle.
    Mapped,
}

/// What a channel tells, and the paths of the numbers for it, in the order of the role's slots.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Reading {
    pub(crate) role: Role,
    pub(crate) paths: Vec<String>,
    pub(crate) convention: Convention,
}

const HEADER: [(&str, &str); 2] = [
    ("sec", "header.stamp.sec|header.stamp.secs"),
    ("nanosec", "header.stamp.nanosec|header.stamp.nsecs"),
];
/// The name of the frame of positions, and ego's own.
const FRAME: &str = "header.frame_id#?";
const OWN_FRAME: &str = "child_frame_id#?";
const TIMESTAMP: [(&str, &str); 2] = [
    ("sec", "timestamp.sec|timestamp.seconds"),
    ("nanosec", "timestamp.nsec|timestamp.nanosec|timestamp.nanos"),
];

impl Reading {
    /// What messages of a type tell, by the mapping or by what is known; none where nothing is.
    pub(crate) fn for_type(type_name: &str, mapped: &[MessageMapping]) -> Option<Self> {
        let wanted = plain_name(type_name);
        if let Some(mapped) = mapped.iter().find(|m| plain_name(&m.message) == wanted) {
            return Some(Self::mapped(mapped));
        }
        let ego = |role, stamp: &[_], pose: &str, twist: &str| {
            let mut paths = place(EGO_SLOTS, stamp, pose, twist);
            paths.extend([FRAME, OWN_FRAME].map(str::to_owned));
            Self::new(role, paths, Convention::Mapped)
        };
        Some(match wanted.as_str() {
            "nav_msgs/Odometry" => ego(Role::Odometry, &HEADER, "pose.pose", "twist.twist"),
            "geometry_msgs/PoseStamped" => ego(Role::Pose, &HEADER, "pose", ""),
            "geometry_msgs/PoseWithCovarianceStamped" => ego(Role::Pose, &HEADER, "pose.pose", ""),
            "foxglove/PoseInFrame" | "foxglove_msgs/PoseInFrame" => {
                ego(Role::Pose, &TIMESTAMP, "pose", "")
            }
            "tf2_msgs/TFMessage" | "tf/tfMessage" => Self::frames(),
            "sensor_msgs/NavSatFix" => Self::fix(&HEADER),
            "foxglove/LocationFix" | "foxglove_msgs/LocationFix" => Self::fix(&TIMESTAMP),
            "geometry_msgs/TwistStamped" => ego(Role::Speed, &HEADER, "", "twist"),
            "geometry_msgs/TwistWithCovarianceStamped" => {
                ego(Role::Speed, &HEADER, "", "twist.twist")
            }
            "autoware_vehicle_msgs/VelocityReport"
            | "autoware_auto_vehicle_msgs/VelocityReport" => Self::speed("longitudinal_velocity"),
            "carla_msgs/CarlaEgoVehicleStatus" | "carla_msgs/CarlaVehicleStatus" => {
                Self::speed("velocity")
            }
            "carla_msgs/CarlaEgoVehicleInfo" | "carla_msgs/CarlaVehicleInfo" => {
                Self::new(Role::Identity, vec!["id".to_owned()], Convention::Mapped)
            }
            "derived_object_msgs/ObjectArray" => Self::derived(),
            "autoware_perception_msgs/TrackedObjects"
            | "autoware_auto_perception_msgs/TrackedObjects" => Self::autoware(""),
            "autoware_perception_msgs/PredictedObjects"
            | "autoware_auto_perception_msgs/PredictedObjects" => Self::autoware("initial_"),
            _ => return None,
        })
    }

    fn new(role: Role, paths: Vec<String>, convention: Convention) -> Self {
        Self { role, paths, convention }
    }

    fn mapped(mapped: &MessageMapping) -> Self {
        let role = mapped.tells.role();
        let path = |slot: &&str| match mapped.fields.get(*slot) {
            // An id may be a number or a text.
            Some(path) if *slot == "id" => format!("{path}|{path}#"),
            path => path.cloned().unwrap_or_default(),
        };
        let mut paths: Vec<String> = role.slots().iter().map(path).collect();
        if role == Role::Objects {
            paths.push(FRAME.to_owned());
        }
        Self::new(role, paths, Convention::Mapped)
    }

    /// A row for each transform; behind ego's slots stand the names of the frames.
    fn frames() -> Self {
        let known = [
            ("x", "transform.translation.x"),
            ("y", "transform.translation.y"),
            ("qx", "transform.rotation.x"),
            ("qy", "transform.rotation.y"),
            ("qz", "transform.rotation.z"),
            ("qw", "transform.rotation.w"),
        ];
        let mut paths = filled(EGO_SLOTS, &[&HEADER[..], &known].concat());
        paths.extend([FRAME, OWN_FRAME].map(str::to_owned));
        let of_each = |path: &String| {
            let paths = path.split('|').filter(|p| !p.is_empty());
            let paths: Vec<String> = paths.map(|p| format!("transforms[].{p}")).collect();
            paths.join("|")
        };
        let paths = paths.iter().map(of_each).collect();
        Self::new(Role::Frames, paths, Convention::Mapped)
    }

    fn fix(stamp: &[(&str, &str)]) -> Self {
        let place = [("x", "longitude"), ("y", "latitude")];
        let paths = filled(EGO_SLOTS, &[stamp, &place].concat());
        Self::new(Role::Fix, paths, Convention::Mapped)
    }

    fn speed(path: &str) -> Self {
        let paths = filled(EGO_SLOTS, &[&HEADER[..], &[("speed", path)]].concat());
        Self::new(Role::Speed, paths, Convention::Mapped)
    }

    fn derived() -> Self {
        let known = [
            ("id", "objects[].id"),
            ("shape", "objects[].shape.type?"),
            ("size0", "objects[].shape.dimensions[0]?"),
            ("size1", "objects[].shape.dimensions[1]?"),
            ("class", "objects[].classification?"),
        ];
        let paths = object("objects[].pose", "objects[].twist", &known);
        Self::new(Role::Objects, paths, Convention::Derived)
    }

    fn autoware(prefix: &str) -> Self {
        let kinematics =
            |what: &str| format!("objects[].kinematics.{prefix}{what}_with_covariance.{what}");
        let known = [
            ("shape", "objects[].shape.type?"),
            ("size0", "objects[].shape.dimensions.x?"),
            ("class", "objects[].classification[0].label?"),
        ];
        let mut paths = object(&kinematics("pose"), &kinematics("twist"), &known);
        paths.extend((0..16).map(|i| format!("objects[].object_id.uuid[{i}]")));
        Self::new(Role::Objects, paths, Convention::Autoware)
    }
}

/// Paths of an object, by those of its pose and its twist and the others that are known.
fn object(pose: &str, twist: &str, known: &[(&str, &str)]) -> Vec<String> {
    let mut paths = place(&OBJECT_SLOTS, &HEADER, pose, twist);
    fill(&mut paths, &OBJECT_SLOTS, known);
    paths.push(FRAME.to_owned());
    paths
}

/// Paths of a pose and a twist of `geometry_msgs`, where they are given.
fn place(slots: &[&str], stamp: &[(&str, &str)], pose: &str, twist: &str) -> Vec<String> {
    let mut paths = filled(slots, stamp);
    let joined = |prefix: &str, rest: &str| format!("{prefix}.{rest}");
    let mut set = |slot: &str, path: String| {
        fill(&mut paths, slots, &[(slot, path.as_str())]);
    };
    if !pose.is_empty() {
        set("x", joined(pose, "position.x"));
        set("y", joined(pose, "position.y"));
        for axis in ["x", "y", "z", "w"] {
            set(&format!("q{axis}"), joined(pose, &format!("orientation.{axis}")));
        }
    }
    if !twist.is_empty() {
        // Where there are positions speeds can do without it.
        let optional = if pose.is_empty() { "" } else { "?" };
        set("vx", joined(twist, &format!("linear.x{optional}")));
        set("vy", joined(twist, &format!("linear.y{optional}")));
    }
    paths
}

fn filled(slots: &[&str], known: &[(&str, &str)]) -> Vec<String> {
    let mut paths = vec![String::new(); slots.len()];
    fill(&mut paths, slots, known);
    paths
}

fn fill(paths: &mut [String], slots: &[&str], known: &[(&str, &str)]) {
    for (path, slot) in paths.iter_mut().zip(slots) {
        if let Some((_, known)) = known.iter().find(|k| k.0 == *slot) {
            (*known).clone_into(path);
        }
    }
}

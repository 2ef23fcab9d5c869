//! The message definitions that the writer puts into its files.

/// Type name and full `ros2msg` text of ego's odometry.
pub(crate) const ODOMETRY: (&str, &str) = (
    "nav_msgs/msg/Odometry",
    include_str!("schemas/odometry.txt"),
);

/// Type name and full `ros2msg` text of the other vehicles.
pub(crate) const OBJECT_ARRAY: (&str, &str) = (
    "derived_object_msgs/msg/ObjectArray",
    include_str!("schemas/object_array.txt"),
);

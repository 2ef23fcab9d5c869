//! The mappings of rigs that come with the program.

/// Names and texts of the rigs, the more particular first.
pub(crate) const SHIPPED_RIGS: [(&str, &str); 4] = [
    ("maveric", maveric_data::MAPPINGS_RIG_MAVERIC),
    ("carla-ros-bridge", maveric_data::MAPPINGS_RIG_CARLA_ROS_BRIDGE),
    ("autoware", maveric_data::MAPPINGS_RIG_AUTOWARE),
    ("generic-ros2", maveric_data::MAPPINGS_RIG_GENERIC_ROS2),
];

/// Names of the rigs that are known.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    SHIPPED_RIGS.into_iter().map(|r| r.0)
}

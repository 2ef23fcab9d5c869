//! Rigs out of the box: what their channels mean, chosen by looking at them.

use super::candidate::Candidate;
use crate::mapping::{Mapping, McapMapping, SHIPPED_RIGS, Topics};
use maveric_bag::plain_name;
use std::{path::Path, sync::LazyLock};

static RIGS: LazyLock<Vec<(&'static str, McapMapping)>> = LazyLock::new(|| {
    let read = |(name, text): (&'static str, &str)| {
        let mapping = Mapping::from_toml(text, Path::new(name)).ok()?;
        Some((name, mapping.mcap?))
    };
    SHIPPED_RIGS.into_iter().filter_map(read).collect()
});

/// The mapping that applies to some channels, and the name of the rig behind it.
///
/// What `given` leaves out is taken from the rig that it names, or else the first one that the channels show.
pub(crate) fn applied(
    given: Option<&McapMapping>,
    candidates: &[Candidate<'_>],
) -> (McapMapping, Option<&'static str>) {
    let types: Vec<String> = candidates.iter().map(|f| plain_name(f.type_name)).collect();
    let channels: Vec<(&str, &str)> =
        candidates.iter().zip(&types).map(|(f, t)| (f.topic, t.as_str())).collect();
    let named = given.and_then(|m| m.rig.as_deref());
    let is_it = |(name, rig): &&(&'static str, McapMapping)| match named {
        Some(named) => *name == named,
        None => rig.when.show(&channels),
    };
    let rig = RIGS.iter().find(is_it);
    let given = given.cloned().unwrap_or_default();
    let Some((name, rig)) = rig else {
        return (given, None);
    };
    let topics = |given: Topics, rig: &Topics| {
        if given.0.is_empty() { rig.clone() } else { given }
    };
    let mapping = McapMapping {
        rig: given.rig,
        when: given.when,
        ego_topic: topics(given.ego_topic, &rig.ego_topic),
        objects_topic: topics(given.objects_topic, &rig.objects_topic),
        speed_topic: topics(given.speed_topic, &rig.speed_topic),
        ego_object: given.ego_object.or(rig.ego_object),
        objects_twist: given.objects_twist.or(rig.objects_twist),
        left_handed: given.left_handed.or(rig.left_handed),
        messages: given.messages,
    };
    (mapping, Some(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(topic: &'static str, type_name: &'static str) -> Candidate<'static> {
        Candidate { topic, type_name, messages: 1, role: Ok(None) }
    }

    #[test]
    fn rigs_are_known_by_their_channels_and_a_mapping_comes_first() {
        assert_eq!(RIGS.len(), SHIPPED_RIGS.len());
        let rig = |candidates: &[Candidate<'_>]| applied(None, candidates).1;
        let odometry = "nav_msgs/msg/Odometry";
        let own = [
            channel("/carla/ego_vehicle/odometry", odometry),
            channel("/carla/ego_vehicle/objects", "derived_object_msgs/msg/ObjectArray"),
        ];
        assert_eq!(rig(&own), Some("maveric"));
        assert_eq!(rig(&[channel("/carla/hero/odometry", odometry)]), Some("carla-ros-bridge"));
        let autoware = [channel("/a", "autoware_auto_vehicle_msgs/msg/VelocityReport")];
        assert_eq!(rig(&autoware), Some("autoware"));
        assert_eq!(rig(&[channel("/odom", odometry)]), Some("generic-ros2"));
        assert_eq!(rig(&[channel("/x", "foxglove.Log")]), None);

        let given = McapMapping {
            rig: Some("autoware".to_owned()),
            ego_topic: Topics(vec!["/mine".to_owned()]),
            ..McapMapping::default()
        };
        let (mapping, name) = applied(Some(&given), &own);
        assert_eq!(name, Some("autoware"));
        assert_eq!(mapping.ego_topic.0, ["/mine"]);
        assert_eq!(mapping.objects_twist, Some(crate::mapping::TwistFrame::Object));
    }
}

//! What the channels of a recording mean.

use super::{names::matches, shipped_rigs};
use crate::raw::mcap::slots::Role;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Topics of a recording and how they are meant.
///
/// What is left out is taken from the rig that the channels show (`study_data/mappings/rig_*.toml`), and else chosen
/// by the types of the messages.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct McapMapping {
    /// The rig, by name; without it the channels decide.
    pub rig: Option<String>,
    /// By which channels a rig is known.
    #[serde(default)]
    pub when: RigSigns,
    /// Topic of ego's pose, or several in order of preference; `*` stands for any characters.
    #[serde(default)]
    pub ego_topic: Topics,
    /// Topic of the others.
    #[serde(default)]
    pub objects_topic: Topics,
    /// Topic of ego's speed, for rigs whose pose comes without one.
    #[serde(default)]
    pub speed_topic: Topics,
    /// Number of the object that is ego.
    pub ego_object: Option<u32>,
    /// In which frame the twists of the others are; without it as their type has it.
    pub objects_twist: Option<TwistFrame>,
    /// Whether y points to the right in the log's frame, as in CARLA's own interface.
    pub left_handed: Option<bool>,
    /// What messages of further types mean.
    #[serde(default)]
    pub messages: Vec<MessageMapping>,
}

/// One topic or several; read from a string or a list.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(from = "OneOrMore")]
pub struct Topics(pub Vec<String>);

#[derive(Deserialize)]
#[serde(untagged)]
enum OneOrMore {
    One(String),
    More(Vec<String>),
}

impl From<OneOrMore> for Topics {
    fn from(topics: OneOrMore) -> Self {
        match topics {
            OneOrMore::One(topic) => Self(vec![topic]),
            OneOrMore::More(topics) => Self(topics),
        }
    }
}

/// By which channels a rig is known: each pattern must fit some channel.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigSigns {
    /// Patterns of topics.
    #[serde(default)]
    pub topics: Vec<String>,
    /// Patterns of message types, `pkg/Type`.
    #[serde(default)]
    pub types: Vec<String>,
}

impl RigSigns {
    /// Whether channels, given as topic and type, show this rig; without a sign they never do.
    pub(crate) fn show(&self, channels: &[(&str, &str)]) -> bool {
        let topic = |pattern: &String| channels.iter().any(|c| matches(pattern, c.0));
        let of_type = |pattern: &String| channels.iter().any(|c| matches(pattern, c.1));
        let signs = self.topics.len() + self.types.len();
        signs > 0 && self.topics.iter().all(topic) && self.types.iter().all(of_type)
    }
}

/// The frame in which velocities are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TwistFrame {
    /// The frame of the positions.
    Map,
    /// The vehicle's own: x forward.
    Object,
}

/// What messages of a type mean: a path for each number that they hold.
///
/// A path names fields from the root, such as `pose.position.x`, `cars[].id` (each element of a list is an object) or
/// `size[0]`. Units are SI, angles in rad.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MessageMapping {
    /// The type's name, as the schema has it.
    #[serde(rename = "type")]
    pub message: String,
    /// What its messages tell.
    pub tells: Tells,
    /// Paths by what they hold. Of ego: `sec`, `nanosec`, `x`, `y` and a heading as `yaw` or `qx`, `qy`, `qz`, `qw`; a
    /// speed as `speed` or `vx`, `vy`. Of objects also `id` and `length`. Of a fix, `x` is the longitude and `y` the
    /// latitude in degrees.
    pub fields: BTreeMap<String, String>,
}

/// What messages tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Tells {
    /// Where ego is.
    Ego,
    /// Where ego is on Earth.
    Fix,
    /// How fast ego is.
    Speed,
    /// Where the others are.
    Objects,
}

impl Tells {
    pub(crate) fn role(self) -> Role {
        match self {
            Self::Ego => Role::Odometry,
            Self::Fix => Role::Fix,
            Self::Speed => Role::Speed,
            Self::Objects => Role::Objects,
        }
    }
}

impl McapMapping {
    /// Whether every message mapping names what it must, and nothing else.
    pub(super) fn check(&self) -> Result<(), String> {
        if let Some(rig) = &self.rig
            && !shipped_rigs::names().any(|name| name == rig)
        {
            let known: Vec<&str> = shipped_rigs::names().collect();
            return Err(format!("`mcap.rig` is `{rig}`, expected one of {}", known.join(", ")));
        }
        for message in &self.messages {
            let name = &message.message;
            let slots = message.tells.role().slots();
            if let Some(key) = message.fields.keys().find(|k| !slots.contains(&k.as_str())) {
                return Err(format!(
                    "`mcap.messages` of `{name}` has a field `{key}`, expected one of {}",
                    slots.join(", ")
                ));
            }
            let needed: &[&str] = match message.tells {
                Tells::Ego | Tells::Fix => &["x", "y"],
                Tells::Speed => &[],
                Tells::Objects => &["x", "y", "id"],
            };
            let has = |key: &str| message.fields.contains_key(key);
            if let Some(key) = needed.iter().find(|k| !has(k)) {
                return Err(format!("`mcap.messages` of `{name}` lacks the field `{key}`"));
            }
            let moves = matches!(message.tells, Tells::Speed | Tells::Objects);
            if moves && !has("speed") && !(has("vx") && has("vy")) {
                return Err(format!(
                    "`mcap.messages` of `{name}` lacks a speed: `speed`, or `vx` and `vy`"
                ));
            }
        }
        Ok(())
    }
}

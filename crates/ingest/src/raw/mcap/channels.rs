//! Channels: what each carries, how it is decoded, or why it is not.

use super::record::{Channel, Schema};
use crate::raw::ros2::{
    definition::{self, Definitions},
    plan::Plan,
};

/// What a channel can tell about a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// Ego's pose and speed: `nav_msgs/Odometry`.
    Odometry,
    /// Ego's pose alone: `geometry_msgs/PoseStamped`.
    Pose,
    /// The other vehicles: `derived_object_msgs/ObjectArray`.
    Objects,
}

impl Role {
    /// The role of a message type, `pkg/Type`.
    fn of(type_name: &str) -> Option<Self> {
        match type_name {
            "nav_msgs/Odometry" => Some(Self::Odometry),
            "geometry_msgs/PoseStamped" => Some(Self::Pose),
            "derived_object_msgs/ObjectArray" => Some(Self::Objects),
            _ => None,
        }
    }

    /// Paths of the numbers that this role needs, in the order of the slots.
    fn wanted(self) -> &'static [&'static str] {
        match self {
            Self::Odometry => &[
                "header.stamp.sec",
                "header.stamp.nanosec",
                "pose.pose.position.x",
                "pose.pose.position.y",
                "pose.pose.orientation.x",
                "pose.pose.orientation.y",
                "pose.pose.orientation.z",
                "pose.pose.orientation.w",
                "twist.twist.linear.x",
                "twist.twist.linear.y",
            ],
            Self::Pose => &[
                "header.stamp.sec",
                "header.stamp.nanosec",
                "pose.position.x",
                "pose.position.y",
                "pose.orientation.x",
                "pose.orientation.y",
                "pose.orientation.z",
                "pose.orientation.w",
            ],
            Self::Objects => &[
                "header.stamp.sec",
                "header.stamp.nanosec",
                "objects[].pose.position.x",
                "objects[].pose.position.y",
                "objects[].pose.orientation.x",
                "objects[].pose.orientation.y",
                "objects[].pose.orientation.z",
                "objects[].pose.orientation.w",
                "objects[].twist.linear.x",
                "objects[].twist.linear.y",
                "objects[].id",
                "objects[].shape.type?",
                "objects[].shape.dimensions[0]?",
                "objects[].shape.dimensions[1]?",
                "objects[].classification?",
            ],
        }
    }
}

/// How a channel is decoded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Decoder {
    /// What it tells, if anything that we use.
    pub(crate) role: Option<Role>,
    /// Takes what the role needs; passes over whole messages where there is no role.
    pub(crate) plan: Plan,
}

/// Compiles the decoder of a channel.
///
/// # Errors
/// A sentence that says why this channel cannot be decoded.
pub(crate) fn decoder(channel: &Channel, schema: Option<&OwnedSchema>) -> Result<Decoder, String> {
    let definitions = definitions(channel, schema)?;
    let role = Role::of(&definitions.root);
    let plan = Plan::compile(&definitions, role.map_or(&[], Role::wanted))?;
    Ok(Decoder { role, plan })
}

/// A schema that outlives the record it came in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct OwnedSchema {
    pub(crate) name: String,
    pub(crate) encoding: String,
    data: Vec<u8>,
}

impl From<Schema<'_>> for OwnedSchema {
    fn from(schema: Schema<'_>) -> Self {
        Self {
            name: schema.name,
            encoding: schema.encoding,
            data: schema.data.to_vec(),
        }
    }
}

/// The message definitions of a channel.
///
/// # Errors
/// A sentence that says why there are none that can be used.
pub(crate) fn definitions(
    channel: &Channel,
    schema: Option<&OwnedSchema>,
) -> Result<Definitions, String> {
    if channel.encoding != "cdr" {
        return Err(format!(
            "message encoding is `{}`, expected `cdr`",
            channel.encoding
        ));
    }
    let Some(schema) = schema else {
        return Err(format!("its schema {} is missing", channel.schema_id));
    };
    if schema.encoding != "ros2msg" {
        return Err(format!(
            "schema encoding is `{}`, expected `ros2msg`",
            schema.encoding
        ));
    }
    let text = std::str::from_utf8(&schema.data).map_err(|_| "its schema is not text")?;
    definition::parse(&schema.name, text)
}

//! Which column of a table is what, layout by layout.
//!
//! A name that ends in `?` is used where the table has such a column and passed over where it has not.

use serde::{Deserialize, Serialize};

/// Columns of layout `pair`.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairColumns {
    /// When each row was recorded, in the mapping's unit of time.
    pub time: String,
    /// Ego's speed.
    pub ego_speed: String,
    /// Ego's position along the road; without it the way is the integral of the speed.
    pub ego_x: Option<String>,
    /// Ego's position across the road, to the left.
    pub ego_y: Option<String>,
    /// Number of ego's lane.
    pub lane: Option<String>,
    /// Ego's distance from its lane's centre, to the side that `offset_grows` says.
    pub offset: Option<String>,
    /// Ego's length.
    pub ego_length: Option<String>,
    /// Distance to the leader, of the mapping's kind.
    pub gap: Option<String>,
    /// The leader's position, of the same point and in the same frame as ego's.
    pub lead_x: Option<String>,
    /// The leader's speed; without it the leader's position is differentiated.
    pub lead_speed: Option<String>,
    /// The leader's length; 0 means that it is not known.
    pub lead_length: Option<String>,
    /// The leader's lateral position less ego's, to the left.
    pub lead_dy: Option<String>,
    /// The leader's number; nobody where it is empty.
    pub lead_id: Option<String>,
}

/// Columns of layout `platoon`; `{n}` stands for the number of the vehicle in all but the time's.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlatoonColumns {
    /// When each row was recorded, of all vehicles.
    pub time: String,
    /// Each vehicle's speed.
    pub speed: String,
    /// Distance from vehicle n to vehicle n + 1 behind it, of the mapping's kind.
    pub gap: String,
    /// Position along the road.
    pub x: Option<String>,
    /// Number of the lane.
    pub lane: Option<String>,
    /// Distance from the lane's centre, to the side that `offset_grows` says.
    pub offset: Option<String>,
    /// Each vehicle's length; without it the mapping's.
    pub length: Option<String>,
}

/// Columns of layout `long`.
///
/// Where a row is one time of all vehicles, `{id}` stands for each one's name in the columns of its own: `x = "{id}_pos_x"`.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LongColumns {
    /// When each row was recorded, in the mapping's unit of time.
    pub time: String,
    /// Position along the road, or eastwards.
    pub x: String,
    /// The vehicle's number or name. Where `{id}` stands in the names of columns it is optional, and names the vehicle that a group of
    /// columns holds in each row.
    pub id: Option<String>,
    /// What else a vehicle's number needs to be its own, such as the place.
    #[serde(default)]
    pub groups: Vec<String>,
    /// Position across the road, or northwards.
    pub y: Option<String>,
    /// Number of the lane.
    pub lane: Option<String>,
    /// Distance from the lane's centre, to the side that `offset_grows` says.
    pub offset: Option<String>,
    /// How fast the vehicle drives; without it from the velocities, else from the positions.
    pub speed: Option<String>,
    /// Velocity along x, where there is no speed.
    pub speed_x: Option<String>,
    /// Velocity along y.
    pub speed_y: Option<String>,
    /// Heading, counter-clockwise from x.
    pub heading: Option<String>,
    /// The vehicle's length.
    pub length: Option<String>,
    /// The vehicle's width, where `point` is a corner of its box.
    pub width: Option<String>,
    /// How far the vehicle's centre is ahead of its position, where `point` is a `reference`.
    pub centre_ahead: Option<String>,
    /// Distance to the leader, of the mapping's kind.
    pub gap: Option<String>,
    /// The leader's number; nobody where it is empty, 0 or -1.
    pub lead_id: Option<String>,
    /// The leader's position, of the same point and in the same frame as the vehicle's.
    pub lead_x: Option<String>,
    /// The leader's speed.
    pub lead_speed: Option<String>,
    /// The leader's length; 0 means that it is not known.
    pub lead_length: Option<String>,
}

/// The keys of columns that are given, each with its column, as they stand in a mapping.
pub(crate) fn given(columns: &impl Serialize) -> Vec<(String, String)> {
    let keys = toml::Table::try_from(columns).unwrap_or_default();
    let columns = keys.into_iter().flat_map(|(key, column)| match column {
        toml::Value::Array(names) => names.into_iter().map(|name| (key.clone(), name)).collect(),
        name => vec![(key, name)],
    });
    let named = columns.filter_map(|(key, name)| Some((key, name.as_str()?.to_owned())));
    named.collect()
}

impl LongColumns {
    /// What stands for a vehicle's name.
    pub(crate) const ID: &str = "{id}";

    /// What stands before and behind a vehicle's name in the column of its position, where vehicles have columns of their own.
    pub(crate) fn around_id(&self) -> Option<(&str, &str)> {
        self.x.split_once(Self::ID)
    }

    /// A column by the name that it has for one vehicle.
    pub(crate) fn of_vehicle(column: &str, id: &str) -> String {
        column.replace(Self::ID, id)
    }

    /// Whether `{id}` stands in the columns of vehicles and in no other, or in none at all.
    ///
    /// # Errors
    /// A sentence that names the column.
    pub(super) fn check_id(&self) -> Result<(), String> {
        let wide = self.around_id().is_some();
        let given = given(self);
        let odd = given.iter().find(|(key, name)| {
            let shared = ["time", "groups"].contains(&key.as_str());
            name.contains(Self::ID) != (wide && !shared)
        });
        match odd.map(|(key, name)| (key.as_str(), name)) {
            None => Ok(()),
            Some((key, name)) if name.contains(Self::ID) => Err(format!(
                "`table.columns.{key}` has `{{id}}`, which stands for vehicles' names in the columns of vehicles, `x` among them"
            )),
            Some(("id", name)) => Err(format!(
                "`table.columns.id` is `{name}` for all vehicles, expected a name with `{{id}}` as in `x`, or no `id` where the columns' names tell vehicles apart"
            )),
            Some((key, name)) => Err(format!(
                "`table.columns.{key}` is `{name}` for all vehicles, expected a name with `{{id}}` as in `x`"
            )),
        }
    }
}

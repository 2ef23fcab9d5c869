//! Which column of a table is what.

use serde::{Deserialize, Serialize};

/// Names of the columns; which of them a table needs depends on its layout.
///
/// A name that ends in `?` is used where the table has such a column and passed over where it has not. In a platoon
/// `{n}` stands for the number of the vehicle. Where a row of a long table is one time of all vehicles, `{id}` stands for each
/// vehicle's name in the columns of its own: `x = "{id}_pos_x"`.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Columns {
    /// Time (all layouts but signals).
    pub time: Option<String>,
    /// Ego's position along the road (pair).
    pub ego_x: Option<String>,
    /// Ego's lateral position, to the left (pair).
    pub ego_y: Option<String>,
    /// Ego's speed (pair).
    pub ego_speed: Option<String>,
    /// Ego's length (pair).
    pub ego_length: Option<String>,
    /// Distance to the leader, of the mapping's kind (pair, long; platoon: from vehicle n to n + 1 behind it).
    pub gap: Option<String>,
    /// The leader's position, of the same point and in the same frame as ego's (pair, long).
    pub lead_x: Option<String>,
    /// The leader's speed (pair, long).
    pub lead_speed: Option<String>,
    /// The leader's length; 0 means that it is not known (pair, long).
    pub lead_length: Option<String>,
    /// The leader's lateral position less ego's, to the left (pair).
    pub lead_dy: Option<String>,
    /// The leader's number; none where it is empty, 0 or -1 (long), or empty (pair).
    pub lead_id: Option<String>,
    /// The vehicle's number or name (long, unless `{id}` stands in the names of columns).
    pub id: Option<String>,
    /// What else a vehicle's number needs to be its own, such as the place (long).
    #[serde(default)]
    pub groups: Vec<String>,
    /// Position along the road, or eastwards (long, platoon).
    pub x: Option<String>,
    /// Position across the road, or northwards (long).
    pub y: Option<String>,
    /// Number of the lane (long).
    pub lane: Option<String>,
    /// Speed (long, platoon).
    pub speed: Option<String>,
    /// Velocity along x, where there is no speed (long).
    pub speed_x: Option<String>,
    /// Velocity along y (long).
    pub speed_y: Option<String>,
    /// Heading, counter-clockwise from x (long).
    pub heading: Option<String>,
    /// The vehicle's length (long, platoon).
    pub length: Option<String>,
    /// The vehicle's width, where `point` is a corner of its box (long).
    pub width: Option<String>,
    /// How far the vehicle's centre is ahead of its position, where `point` is a `reference` (long).
    pub centre_ahead: Option<String>,
}

/// The keys of [`Columns`] with their fields, by reference of some kind.
macro_rules! keys {
    (one $columns:ident [$($by:tt)+] $key:ident) => { (stringify!($key), $($by)+ $columns.$key) };
    (all $columns:ident $by:tt $($key:ident)+) => { [$(keys!(one $columns $by $key)),+] };
    ($columns:ident, $($by:tt)+) => {
        keys!(all $columns [$($by)+] time ego_x ego_y lead_dy ego_speed ego_length gap lead_x lead_speed lead_length
            lead_id id x y lane speed speed_x speed_y heading length width centre_ahead)
    };
}

impl Columns {
    /// The keys that are given, each with its column.
    pub(crate) fn given(&self) -> Vec<(&'static str, &str)> {
        let keys = keys!(self, &).into_iter();
        let given = keys.filter_map(|(key, name)| Some((key, name.as_deref()?)));
        given
            .chain(self.groups.iter().map(|g| ("groups", g.as_str())))
            .collect()
    }

    /// What stands before and behind a vehicle's name in the column of its position, where vehicles have columns of their own.
    pub(crate) fn around_id(&self) -> Option<(&str, &str)> {
        self.x.as_ref()?.split_once(Self::ID)
    }

    /// The columns of one vehicle.
    pub(crate) fn of_vehicle(&self, id: &str) -> Self {
        let mut columns = self.clone();
        for (_, name) in keys!(columns, &mut) {
            *name = name.take().map(|name| name.replace(Self::ID, id));
        }
        columns
    }

    /// Whether `{id}` stands in the columns of vehicles and in no other, or in none at all.
    ///
    /// # Errors
    /// A sentence that names the column.
    pub(super) fn check_id(&self) -> Result<(), String> {
        let wide = self.around_id().is_some();
        let odd = self.given().into_iter().find(|(key, name)| {
            let shared = ["time", "groups"].contains(key);
            name.contains(Self::ID) != (wide && !shared)
        });
        match odd {
            None => Ok(()),
            Some((key, name)) if name.contains(Self::ID) => Err(format!(
                "`table.columns.{key}` has `{{id}}`, which stands for vehicles' names in the columns of vehicles, `x` among them"
            )),
            Some(("id", _)) => Err("`table.columns.id` does nothing where `{id}` in the names of columns tells vehicles apart: leave it out".to_owned()),
            Some((key, name)) => Err(format!(
                "`table.columns.{key}` is `{name}` for all vehicles, expected a name with `{{id}}` as in `x`"
            )),
        }
    }

    /// What stands for a vehicle's name.
    const ID: &str = "{id}";
}

/// A file beside the table that says how it was recorded, one row (layout `long`).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingMeta {
    /// What to replace in the table's name to find it, and by what: `["_tracks", "_recordingMeta"]`.
    pub replace: [String; 2],
    /// Column of the frames a second.
    pub frames_per_s: Option<String>,
    /// Column of the posted speed, in the table's unit of speed; not above 0 means none.
    pub posted_speed: Option<String>,
    /// Column of the lane markings' positions across the road of those who drive along x, separated by semicolons.
    pub markings_along_x: Option<String>,
    /// The same for those who drive against x.
    pub markings_against_x: Option<String>,
}

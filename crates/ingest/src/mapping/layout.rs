//! The layouts of tables, each with the keys and columns that it alone has.

use super::{
    columns::{LongColumns, PairColumns, PlatoonColumns, given},
    recording_meta::RecordingMeta,
    side::Side,
};
use maveric_domain::nearest;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// The keys that a table of any layout may have.
pub(super) const OF_EVERY_TABLE: &str = "`separator`, `header`, `decimal_comma`, `gap_kind`, `lanes_from`, `first_lane`, \
    `time_pattern`, `frames_per_s`, `ego_length_m`, `lead_length_m`, `units`";

/// What a row and a file are: `table.layout`, and the keys that this layout alone has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "layout", rename_all = "snake_case", try_from = "toml::Table")]
#[non_exhaustive]
#[expect(clippy::large_enum_variant, reason = "there is one a mapping")]
pub enum Layout {
    /// A file is one follower (ego) behind one leader, a row is one time.
    Pair(Pair),
    /// A row is one vehicle at one time; each vehicle is ego of a drive of its own.
    Long(Long),
    /// A row is one time of several vehicles in file, number 1 ahead; each but the first is ego of a drive.
    Platoon(Platoon),
}

/// The keys of layout `pair`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// Which way of the table's x is ahead.
    #[serde(default)]
    pub forward: Forward,
    /// Which point of a vehicle positions are of; needed where the leader's position stands in the place of a gap.
    pub point: Option<Point>,
    /// To which side the place in the lane grows; needed where there is one.
    pub offset_grows: Option<Side>,
    /// Names of the columns.
    pub columns: PairColumns,
}

/// The keys of layout `platoon`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Platoon {
    /// To which side the place in the lane grows; needed where there is one.
    pub offset_grows: Option<Side>,
    /// Names of the columns.
    pub columns: PlatoonColumns,
}

/// The keys of layout `long`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Long {
    /// Which way of the table's x is ahead.
    #[serde(default)]
    pub forward: Forward,
    /// Which point of a vehicle positions are of: `front`, `centre`, `rear`, `corner`, or another `reference`.
    pub point: Point,
    /// Which way y grows, seen along x; needed where there is a y.
    pub y_grows: Option<Side>,
    /// To which side the place in the lane grows; needed where there is one.
    pub offset_grows: Option<Side>,
    /// Whether everybody drives along x.
    #[serde(default)]
    pub directions: Directions,
    /// The one vehicle that is ego, where the others only surround it; without it every vehicle is ego of a drive.
    pub ego: Option<String>,
    /// How far vehicles' centres are ahead of their positions, in m, where `point` is a `reference` and no column says it.
    pub centre_ahead_m: Option<f64>,
    /// A hole longer than this, in s, makes the number of a vehicle that of another one.
    pub new_vehicle_after_s: Option<f64>,
    /// Names of the columns.
    pub columns: LongColumns,
    /// A file beside the table that says how it was recorded.
    pub recording_meta: Option<RecordingMeta>,
}

/// Which point of a vehicle a position is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Point {
    /// The middle of its length and width.
    Centre,
    /// The middle of its front bumper.
    Front,
    /// The middle of its rear bumper.
    Rear,
    /// The corner of its box with the smallest x and y; needs the width (layout `long`).
    Corner,
    /// A point such as the middle of the rear axle, behind the centre as `centre_ahead` says (layout `long`).
    Reference,
}

/// Which way of a table's x is ahead.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Forward {
    /// x grows ahead.
    #[default]
    #[serde(rename = "x")]
    AlongX,
    /// x falls ahead: both axes are turned round.
    #[serde(rename = "-x")]
    AgainstX,
}

impl Forward {
    /// 1, or -1 where both axes are turned round.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::AlongX => 1.0,
            Self::AgainstX => -1.0,
        }
    }
}

/// Which ways the vehicles of a table drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Directions {
    /// All along x.
    #[default]
    Along,
    /// Both ways: the sign of a vehicle's own movement along x tells, and who drives the other way is not there.
    Both,
}

impl TryFrom<toml::Table> for Layout {
    type Error = String;

    /// Takes the keys of a `[table]` that not every layout has; one that is another layout's is refused with those that belong here.
    fn try_from(mut keys: toml::Table) -> Result<Self, String> {
        let words = "`pair`, `long`, `platoon`";
        let Some(name) = keys.remove("layout") else {
            let near = nearest("layout", keys.keys().map(String::as_str));
            let near = near.map_or_else(String::new, |key| {
                format!("\n`{key}` is no key: did you mean `layout`?")
            });
            return Err(format!("`table.layout` is not given, expected one of {words}{near}"));
        };
        match name.as_str() {
            Some("pair") => read("pair", keys).map(Self::Pair),
            Some("long") => read("long", keys).map(Self::Long),
            Some("platoon") => read("platoon", keys).map(Self::Platoon),
            _ => Err(format!(
                "unknown layout `{}`, expected one of {words}",
                name.as_str().unwrap_or(&name.to_string())
            )),
        }
    }
}

/// The keys of a layout; what serde says of them, with the place of the key.
fn read<T: DeserializeOwned>(layout: &str, keys: toml::Table) -> Result<T, String> {
    T::deserialize(keys).map_err(|e| {
        let text = e.to_string();
        // The key stands on a line of its own.
        let (what, place) = text.trim_end().split_once("\nin `").unwrap_or((text.trim_end(), "`"));
        match place.trim_end_matches('`') {
            "" => format!("layout `{layout}`: {what}; every layout may have {OF_EVERY_TABLE}"),
            key => format!("layout `{layout}`, `table.{key}`: {what}"),
        }
    })
}

impl Layout {
    /// Each key of a column with the column that it names.
    pub(crate) fn columns(&self) -> Vec<(String, String)> {
        match self {
            Self::Pair(pair) => given(&pair.columns),
            Self::Long(long) => given(&long.columns),
            Self::Platoon(platoon) => given(&platoon.columns),
        }
    }

    /// The column of ego's place across the road, with its key, where one says it alone.
    pub(crate) fn lateral(&self) -> Option<(&'static str, &str)> {
        match self {
            Self::Pair(pair) => Some(("ego_y", pair.columns.ego_y.as_deref()?)),
            Self::Long(long) if long.columns.heading.is_none() && long.columns.lane.is_none() => {
                Some(("y", long.columns.y.as_deref()?))
            }
            _ => None,
        }
    }

    /// The first column that one of some keys names.
    pub(crate) fn column(&self, keys: &[&str]) -> Option<String> {
        let mut columns = self.columns().into_iter();
        columns.find(|(key, _)| keys.contains(&key.as_str())).map(|(_, name)| name)
    }

    /// Whether there is a column of a gap.
    pub(super) fn has_gap(&self) -> bool {
        self.column(&["gap"]).is_some()
    }

    /// Whether a column numbers lanes.
    pub(super) fn numbers_lanes(&self) -> bool {
        self.column(&["lane"]).is_some()
    }

    /// Whether positions are places in the world, so that a line through it can straighten the road.
    pub(super) fn is_of_the_world(&self) -> bool {
        let Self::Long(long) = self else { return false };
        let headed = long.columns.heading.is_some();
        long.directions == Directions::Along && (long.point == Point::Centre || headed)
    }

    /// The columns of a file beside the table that says how it was recorded.
    pub(super) fn meta(&self) -> Option<&RecordingMeta> {
        match self {
            Self::Long(long) => long.recording_meta.as_ref(),
            _ => None,
        }
    }
}

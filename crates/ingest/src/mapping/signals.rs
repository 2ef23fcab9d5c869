//! Which file of a folder is which signal, and what its columns are.

use super::{
    columns::given,
    refusal::{Checked, refuse},
    side::Side,
};
use serde::{Deserialize, Serialize};

/// The signals of a drive, each with times of its own (layout `signals`).
///
/// A signal without a `file` is read from the log itself: then a log is one table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Signals {
    /// Ego's speed.
    pub speed: SpeedSignal,
    /// Ego's velocity in the world, for the bends of the road; without it the road is taken to be straight.
    pub velocity: Option<VelocitySignal>,
    /// What the radar or a tracker saw ahead.
    pub tracks: Option<TracksSignal>,
    /// The one vehicle ahead in ego's lane, without a number.
    pub lead: Option<LeadSignal>,
    /// Ego's place in its lane, the lane's number, or both.
    pub lane: Option<LaneSignal>,
    /// Ego's lane changes, one a row.
    pub lane_changes: Option<LaneChangesSignal>,
    /// The road that ego is on.
    pub road: Option<RoadSignal>,
}

/// One signal as it stands in a mapping.
pub(crate) struct GivenSignal {
    /// Its key.
    pub(crate) name: String,
    /// Its file; empty where it is read from the log itself.
    pub(crate) file: String,
    /// Keys of its columns with their names.
    pub(crate) columns: Vec<(String, String)>,
}

/// Keys of signals that name no column.
const NO_COLUMNS: [&str; 4] = ["file", "missing", "only", "offset_grows"];

impl Signals {
    /// The files, ego's speed first, each once.
    pub fn files(&self) -> Vec<String> {
        let mut files: Vec<String> = Vec::new();
        for GivenSignal { file, .. } in self.given() {
            if !file.is_empty() && !files.contains(&file) {
                files.push(file);
            }
        }
        files
    }

    /// The signals that are given, ego's speed first.
    pub(crate) fn given(&self) -> Vec<GivenSignal> {
        let signals = toml::Table::try_from(self).unwrap_or_default();
        let of_signal = |(name, keys): (String, toml::Value)| {
            let mut columns = given(&keys);
            let file = columns.iter().find(|(key, _)| key == "file");
            let file = file.map(|f| f.1.clone()).unwrap_or_default();
            // What a direction is called is no column either.
            let words = |key: &str| name == "lane_changes" && ["left", "right"].contains(&key);
            columns.retain(|(key, _)| !NO_COLUMNS.contains(&key.as_str()) && !words(key));
            GivenSignal {
                name,
                file,
                columns,
            }
        };
        let mut signals: Vec<GivenSignal> = signals.into_iter().map(of_signal).collect();
        signals.sort_by_key(|signal| signal.name != "speed");
        signals
    }

    /// What is wrong with them.
    pub(super) fn check(&self) -> Checked {
        let given = self.given();
        let unnamed = given.iter().find(|signal| signal.file.is_empty());
        if let Some(GivenSignal { name, .. }) = unnamed
            && given.iter().any(|signal| !signal.file.is_empty())
        {
            return Err(format!(
                "`table.signals.{name}.file` is not given, but those of other signals are: name the file of each, or of none"
            ));
        }
        if let Some(lane) = &self.lane {
            let why = "`table.signals.lane` needs `number`, `offset` or both: columns of the lane's number and of ego's place in it";
            refuse(lane.number.is_none() && lane.offset.is_none(), why)?;
            let why = "`table.signals.lane` needs `offset` and `offset_grows` together: does the place in the lane grow to the `left` or to the `right`?";
            refuse(lane.offset.is_some() != lane.offset_grows.is_some(), why)?;
            let why = "`table.signals.lane.number` and `table.signals.lane_changes` both say when ego changes lanes: give one of them";
            refuse(lane.number.is_some() && self.lane_changes.is_some(), why)?;
        }
        if let Some(changes) = &self.lane_changes {
            let both = changes.left.iter().find(|w| changes.right.contains(w));
            if let Some(word) = both {
                return Err(format!(
                    "`table.signals.lane_changes` has `{word}` under `left` and `right`: expected one of them"
                ));
            }
            let why = "`table.signals.lane_changes` needs `left` and `right`: what its column of the direction holds for either";
            refuse(changes.left.is_empty() || changes.right.is_empty(), why)?;
        }
        if let Some(road) = &self.road {
            let why = "`table.signals.road.lane` does nothing without `table.signals.lane_changes`: leave it out, or map it as `table.signals.lane.number`";
            refuse(road.lane.is_some() && self.lane_changes.is_none(), why)?;
            let why = "`table.signals.road` needs `posted_speed`, `lanes` or both";
            refuse(road.posted_speed.is_none() && road.lanes.is_none(), why)?;
        }
        Ok(())
    }
}

/// Which rows of a file count: those whose cell is one of some words.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Only {
    /// Whose words decide.
    pub column: String,
    /// What it holds in rows that count.
    pub is: Vec<String>,
}

/// Ego's speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedSignal {
    /// Name of the file; the log itself without it.
    #[serde(default)]
    pub file: String,
    /// Column of the time.
    pub time: String,
    /// Column of the speed.
    pub value: String,
    /// Numbers that stand for no speed.
    #[serde(default)]
    pub missing: Vec<f64>,
}

/// Ego's position and velocity in earth-centred, earth-fixed coordinates, always in m and m/s.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VelocitySignal {
    /// Name of the file; the log itself without it.
    #[serde(default)]
    pub file: String,
    /// Column of the time.
    pub time: String,
    /// Columns of the position.
    pub position: [String; 3],
    /// Columns of the velocity.
    pub velocity: [String; 3],
}

/// Tracks of vehicles as seen from ego.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TracksSignal {
    /// Name of the file; the log itself without it.
    #[serde(default)]
    pub file: String,
    /// Column of the time.
    pub time: String,
    /// Column of the track's number; numbers may be used again.
    pub track: String,
    /// Column that is not 0 where a number is used for another vehicle than before.
    pub new_track: Option<String>,
    /// Column of the distance ahead, of the mapping's `gap_kind`.
    pub forward: String,
    /// Column of the offset to the left.
    pub left: String,
    /// Column of the speed relative to ego's, negative while closing in.
    pub relative_speed: String,
}

/// The vehicle ahead in ego's lane, as a camera or a radar with one target tells it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeadSignal {
    /// Name of the file; the log itself without it.
    #[serde(default)]
    pub file: String,
    /// Column of the time.
    pub time: String,
    /// Column of the distance ahead, of the mapping's `gap_kind`; empty or [`LeadSignal::missing`] where nobody was seen.
    pub gap: String,
    /// Column of its speed; without it the change of the gap tells.
    pub speed: Option<String>,
    /// Numbers that stand for nobody.
    #[serde(default)]
    pub missing: Vec<f64>,
    /// Rows that count; all of them without it. At the others nobody looked.
    pub only: Option<Only>,
}

/// Where ego is across the road.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaneSignal {
    /// Name of the file; the log itself without it.
    #[serde(default)]
    pub file: String,
    /// Column of the time.
    pub time: String,
    /// Column of the lane's number, counted as the table's `lanes_from` and `first_lane` say.
    pub number: Option<String>,
    /// Column of the distance from the lane's centre.
    pub offset: Option<String>,
    /// To which side that grows.
    pub offset_grows: Option<Side>,
    /// Numbers that stand for no place.
    #[serde(default)]
    pub missing: Vec<f64>,
    /// Rows that count; all of them without it.
    pub only: Option<Only>,
}

/// Lane changes, a row each; a file without a row says that there were none.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaneChangesSignal {
    /// Name of the file; the log itself without it.
    #[serde(default)]
    pub file: String,
    /// Column of the time at which ego crosses the marking.
    pub time: String,
    /// Column of the direction.
    pub direction: String,
    /// What that holds for a change to the left.
    pub left: Vec<String>,
    /// What it holds for a change to the right.
    pub right: Vec<String>,
}

/// The road along the drive; the drive's road is what holds for most of its time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadSignal {
    /// Name of the file; the log itself without it.
    #[serde(default)]
    pub file: String,
    /// Column of the time.
    pub time: String,
    /// Column of the posted speed, in the table's unit of speed.
    pub posted_speed: Option<String>,
    /// Column of the number of lanes in ego's direction.
    pub lanes: Option<String>,
    /// Column of the number of the lane that ego is thought to be in, counted as the table's `lanes_from` and `first_lane` say. It
    /// only says where listed lane changes start.
    pub lane: Option<String>,
    /// Numbers that stand for not known.
    #[serde(default)]
    pub missing: Vec<f64>,
}

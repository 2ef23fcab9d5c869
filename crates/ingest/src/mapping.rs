//! Mappings: what the columns of a table, the topics of a recording and the names of files mean.

mod check;
mod columns;
mod layout;
mod mcap;
pub(crate) mod names;
mod recording_meta;
mod refusal;
mod sees;
mod shipped_rigs;
mod side;
mod table;
mod time_pattern;
mod units;

use crate::{error::IngestError, lane_centres::LaneShape};
pub use columns::{LongColumns, PairColumns, PlatoonColumns};
pub use layout::{Directions, Forward, Layout, Long, Pair, Platoon, Point};
use maveric_domain::{Road, nearest};
pub use mcap::{McapMapping, MessageMapping, RigSigns, Tells, Topics, TwistFrame};
pub use names::{Names, named_after};
pub use recording_meta::RecordingMeta;
use refusal::{positive, refuse};
pub use sees::SeesMapping;
use serde::{Deserialize, Serialize};
pub(crate) use shipped_rigs::SHIPPED_RIGS;
pub use side::Side;
use std::path::Path;
pub use table::{GapKind, TableMapping};
pub(crate) use time_pattern::patterned;
pub use units::{AngleUnit, LengthUnit, SpeedUnit, TimeUnit, Units};

/// What a log means where it does not say so itself; read from TOML, where a misspelt key is an error.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mapping {
    /// Rows a second of the result; without it the canonical rate.
    pub rate_hz: Option<f64>,
    /// Longest hole between samples that is bridged, in s, where the rig's slowest signal needs more than the canonical half second.
    pub max_gap_s: Option<f64>,
    /// Names of files and folders that are no logs, such as `manifest.csv`; `*` stands for any characters.
    #[serde(default)]
    pub skip: Vec<String>,
    /// The road, where the log does not say it.
    pub road: Option<RoadMapping>,
    /// Points along the centre of the right lane in the log's frame, in m and in driving direction: the road is straightened
    /// along them, instead of by [`RoadMapping::frame`].
    #[serde(default)]
    pub centre_line: Vec<[f64; 2]>,
    /// Edges of the lanes across the road in that frame, from the right one to the left one, in m: lanes of any width become
    /// those of the road.
    #[serde(default)]
    pub lane_edges_m: Vec<f64>,
    /// Whether lanes lie where vehicles drove: as many as the road has, about as wide as it says.
    #[serde(default)]
    pub lanes_driven: bool,
    /// What the rig sees, where the log does not show it.
    #[serde(default)]
    pub sees: SeesMapping,
    /// Ids from file names.
    pub names: Option<Names>,
    /// Columns of a table.
    pub table: Option<TableMapping>,
    /// Topics of a recording.
    pub mcap: Option<McapMapping>,
}

/// The road of a log, and how the log's frame lies to it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadMapping {
    /// Number of lanes.
    pub lanes: u8,
    /// From marking to marking, in m; the same in every lane.
    pub lane_width_m: f64,
    /// Posted speed, in m/s: the lead speed that stands for a free road.
    pub posted_speed_mps: f64,
    /// How the log's frame lies to the road.
    #[serde(default)]
    pub frame: FrameKind,
    /// Lateral position of the right lane's centre in that frame, in m.
    #[serde(default)]
    pub right_lane_centre_y_m: f64,
}

impl RoadMapping {
    /// One lane of the paper's road, in a frame to be found: what stands in where nothing is known.
    pub const UNKNOWN: Self = Self {
        lanes: 1,
        lane_width_m: Road::PAPER.lane_width_m,
        posted_speed_mps: Road::PAPER.posted_speed_mps,
        frame: FrameKind::Auto,
        right_lane_centre_y_m: 0.0,
    };

    /// These lanes, their width and the posted speed, without the frame.
    pub fn road(&self) -> Road {
        Road {
            lanes: self.lanes,
            lane_width_m: self.lane_width_m,
            posted_speed_mps: self.posted_speed_mps,
        }
    }
}

/// How the frame of a log lies to the road.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FrameKind {
    /// x runs along the road and y to the left already.
    Map,
    /// x is the way that ego has driven; ego's lateral position is lost.
    Path,
    /// A straight line through ego's drive where it is straight, else [`FrameKind::Path`].
    #[default]
    Auto,
}

impl Mapping {
    /// Reads a mapping file.
    ///
    /// # Errors
    /// [`IngestError::NotFound`] and the like; [`IngestError::BadMapping`] as [`Mapping::from_toml`].
    pub fn read(path: &Path) -> Result<Self, IngestError> {
        let text = std::fs::read_to_string(path).map_err(|e| IngestError::io(path, e))?;
        Self::from_toml(&text, path)
    }

    /// Takes the text of a mapping; `path` is named in errors.
    ///
    /// # Errors
    /// [`IngestError::BadMapping`] where the text is no TOML, has an unknown or missing key, or a value
    /// outside its range.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, IngestError> {
        let bad = |reason: String| IngestError::bad_mapping(path, reason);
        let mapping: Self = toml::from_str(text).map_err(|e| bad(with_suggestion(&e)))?;
        mapping.check().map_err(bad)?;
        Ok(mapping)
    }

    /// Whether the mapping says to pass over a file or a folder of this name.
    pub fn skips(&self, path: &Path) -> bool {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.skip.iter().any(|pattern| names::matches(pattern, &name))
    }

    /// What is wrong with it; one that is read from a file has nothing.
    pub(crate) fn check(&self) -> Result<(), String> {
        positive("rate_hz", self.rate_hz)?;
        positive("max_gap_s", self.max_gap_s)?;
        if let Some(road) = &self.road {
            positive("road.lanes", Some(f64::from(road.lanes)))?;
            positive("road.lane_width_m", Some(road.lane_width_m))?;
            positive("road.posted_speed_mps", Some(road.posted_speed_mps))?;
            let centre_y_m = road.right_lane_centre_y_m;
            let why = "`road.right_lane_centre_y_m` is not finite";
            refuse(!centre_y_m.is_finite(), why)?;
        }
        if !self.centre_line.is_empty() {
            let finite = self.centre_line.iter().flatten().all(|v| v.is_finite());
            let way = |w: &[[f64; 2]]| libm::hypot(w[1][0] - w[0][0], w[1][1] - w[0][1]);
            let apart = self.centre_line.windows(2).all(|w| way(w) > 0.0);
            let why = "`centre_line` is expected to have two or more finite points, no two alike in a row";
            refuse(self.centre_line.len() < 2 || !finite || !apart, why)?;
            let table = self.table.as_ref();
            let elsewhere = table.is_some_and(|t| !t.layout.is_of_the_world());
            let why = "`centre_line` needs positions in the world: layout `long`, `directions = \"along\"`, and a `heading` unless positions are of vehicles' centres";
            refuse(elsewhere, why)?;
        }
        self.check_lanes()?;
        if let Some(names) = &self.names {
            names.check()?;
            let table = self.table.as_ref();
            let meta = table.is_some_and(|t| t.layout.meta().is_some());
            let why = "`names.parts` is for drives of one table or recording: leave it out where a table has a file beside it";
            refuse(names.parts.is_some() && meta, why)?;
        }
        if let Some(mcap) = &self.mcap {
            mcap.check()?;
        }
        if let Some(table) = &self.table {
            table.check()?;
        }
        Ok(())
    }

    /// Whether edges rise and are those of the road's lanes, and nothing else says where lanes are.
    fn check_lanes(&self) -> Result<(), String> {
        let edges = &self.lane_edges_m;
        if edges.is_empty() && !self.lanes_driven {
            return Ok(());
        }
        let Some(road) = self.road else {
            return Err("`lane_edges_m` and `lanes_driven` need a `[road]`".to_owned());
        };
        let twice = self.lanes_driven || road.right_lane_centre_y_m != 0.0;
        let why = "only one of `lane_edges_m`, `lanes_driven` and `road.right_lane_centre_y_m` says where lanes are";
        refuse(!edges.is_empty() && twice, why)?;
        let rising = edges.windows(2).all(|e| e[0] < e[1]) && edges.iter().all(|e| e.is_finite());
        if !edges.is_empty() && (!rising || edges.len() != usize::from(road.lanes) + 1) {
            return Err(format!(
                "`lane_edges_m` has {} numbers, expected {}, rising: one more than `road.lanes`",
                edges.len(),
                usize::from(road.lanes) + 1
            ));
        }
        let table = self.table.as_ref();
        let lanes_are_told =
            table.is_some_and(|t| t.layout.numbers_lanes() || t.layout.meta().is_some());
        let why = "`lane_edges_m` and `lanes_driven` do nothing beside numbers or markings of lanes, or in the frame `path`: leave them out";
        refuse(lanes_are_told || road.frame == FrameKind::Path, why)
    }

    /// How lanes lie across the road.
    pub(crate) fn lane_shape(&self) -> LaneShape<'_> {
        match self.lane_edges_m.as_slice() {
            [] if self.lanes_driven => LaneShape::Driven,
            [] => LaneShape::Even,
            edges => LaneShape::Edges(edges),
        }
    }
}

/// What serde says of a mapping, and the key or word that was probably meant.
fn with_suggestion(error: &toml::de::Error) -> String {
    let text = error.to_string();
    let unknown = error.message().split_once("unknown ").map(|(_, what)| what);
    let mut words = unknown.unwrap_or_default().split('`').skip(1).step_by(2);
    match words.next().and_then(|found| nearest(found, words)) {
        Some(meant) => format!("{}\ndid you mean `{meant}`?", text.trim_end()),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mapping_built_in_code_is_checked_as_one_of_a_file_is() {
        type Change = fn(&mut Mapping);
        let changes: [(Change, &str); 3] = [
            (
                |m| match &mut m.table.as_mut().unwrap().layout {
                    Layout::Platoon(platoon) => "speed".clone_into(&mut platoon.columns.speed),
                    layout => panic!("{layout:?}"),
                },
                "with `{n}`",
            ),
            (|m| m.table.as_mut().unwrap().gap_kind = None, "`table.gap_kind`"),
            (|m| m.rate_hz = Some(f64::NAN), "`rate_hz`"),
        ];
        for (change, words) in changes {
            let mut mapping = shipped("openacc_platoon.toml");
            change(&mut mapping);
            let settings = crate::IngestSettings {
                mapping: Some(mapping),
                ..crate::IngestSettings::default()
            };
            let error = crate::read_log(Path::new("any.csv"), &settings).unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
        }
    }

    fn shipped(name: &str) -> Mapping {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
        Mapping::read(&folder.join(name)).unwrap()
    }

    #[test]
    fn shipped_mappings_are_read_and_skip_their_manifests() {
        for name in ["openacc.toml", "ngsim_pairs.toml"] {
            let mapping = shipped(name);
            assert!(mapping.skips(Path::new("data/manifest.csv")), "{name}");
            assert!(!mapping.skips(Path::new("data/i80_0400pm_f1_l2.csv")), "{name}");
        }
        let units = shipped("ngsim_pairs.toml").table.unwrap().units;
        assert_eq!(units.length, LengthUnit::Feet);
    }

    #[test]
    fn a_misspelt_key_a_missing_unit_and_a_senseless_value_are_refused() {
        let of = |text: &str| {
            let refused = Mapping::from_toml(text, Path::new("m.toml"));
            refused.unwrap_err().to_string()
        };
        assert!(of("rate = 10").contains("unknown field `rate`"));
        assert!(of("rate_hz = 0").contains("rate_hz"));
        let table = "[table]\nlayout = \"pair\"\ngap_kind = \"bumper_to_bumper\"\n[table.columns]\n\
            time = \"t\"\nego_x = \"x\"\nego_speed = \"v\"\nlead_speed = \"w\"\ngap = \"s\"\n[table.units]\nlength = \"m\"\n";
        assert!(of(table).contains("time"));
        let pair = format!("{table}time = \"s\"\nspeed = \"m/s\"\n");
        assert!(Mapping::from_toml(&pair, Path::new("m.toml")).is_ok());
        for (from, to, said) in [
            ("gap_kind = \"bumper_to_bumper\"\n", "", "`centre_to_centre`?"),
            ("layout", "layuot", "did you mean `layout`?"),
            ("\"pair\"", "\"pears\"", "unknown layout `pears`, expected one of `pair`, `long`"),
            (
                "\"pair\"",
                "\"signals\"",
                "unknown layout `signals`, expected one of `pair`, `long`, `platoon`",
            ),
            ("layout = \"pair\"", "layout = \"pair\"\nfoward = \"x\"", "did you mean `forward`?"),
            (
                "layout = \"pair\"",
                "layout = \"pair\"\nseperator = \",\"",
                "did you mean `separator`?",
            ),
            (
                "ego_speed = \"v\"\n",
                "",
                "layout `pair`, `table.columns`: missing field `ego_speed`",
            ),
            (
                "ego_speed = \"v\"",
                "ego_speed = 3",
                "layout `pair`, `table.columns.ego_speed`: invalid type: integer `3`",
            ),
            ("\"m/s\"", "\"m/h\"", "unknown variant `m/h`"),
        ] {
            let error = of(&pair.replace(from, to));
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn a_key_of_another_layout_is_refused_with_those_that_belong_there() {
        let refused = |name: &str, from: &str, to: &str| {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
            let text = std::fs::read_to_string(folder.join(name)).unwrap();
            assert!(text.contains(from), "{name} has no {from}");
            let text = text.replacen(from, to, 1);
            Mapping::from_toml(&text, Path::new("m.toml")).unwrap_err().to_string()
        };
        for (name, from, to, layout, key, belongs) in [
            (
                "openacc.toml",
                "[table]",
                "[table]\ny_grows = \"left\"",
                "pair",
                "y_grows",
                "`forward`, `point`",
            ),
            (
                "openacc.toml",
                "[table.columns]",
                "[table.columns]\nspeed_x = \"vx\"",
                "pair",
                "speed_x",
                "`ego_speed`, `ego_x`",
            ),
            (
                "openacc_platoon.toml",
                "[table]",
                "[table]\nego = \"1\"",
                "platoon",
                "ego",
                "`offset_grows` or `columns`",
            ),
            (
                "highd.toml",
                "[table.columns]",
                "[table.columns]\nego_y = \"y\"",
                "long",
                "ego_y",
                "`lane`, `offset`",
            ),
        ] {
            let error = refused(name, from, to);
            let words = [
                format!("layout `{layout}`"),
                format!("unknown field `{key}`"),
                belongs.to_owned(),
            ];
            assert!(words.iter().all(|w| error.contains(w)), "{error}");
        }
    }

    #[test]
    fn every_key_that_is_said_to_be_of_every_table_is_one() {
        let rest: toml::Table = toml::from_str("layout = \"pair\"\n[columns]\ntime = \"t\"\nego_speed = \"v\"\n[units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n").unwrap();
        let keys = layout::OF_EVERY_TABLE.split('`').skip(1).step_by(2);
        assert!(keys.clone().count() > 5);
        for key in keys.filter(|key| *key != "units") {
            let mut with = rest.clone();
            // Of no key's type.
            with.insert(key.to_owned(), toml::Value::Array(Vec::new()));
            let error = toml::from_str::<TableMapping>(&with.to_string()).unwrap_err();
            assert!(!error.message().contains("unknown field"), "{key}: {error}");
        }
    }
}

//! What a table's rows and files are, and what its mapping must say about them.

use super::{
    columns::{Columns, RecordingMeta},
    side::Side,
    signals::Signals,
    time_pattern::is_pattern,
    units::{TimeUnit, Units},
};
use serde::{Deserialize, Serialize};

/// Columns of a table, their units and what its gap is measured between.
///
/// Units, the kind of gap and the point that positions are of have no defaults: a table that does not say them must
/// be asked about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableMapping {
    /// What a row and a file are.
    pub layout: Layout,
    /// Character between cells; without it the most frequent of comma, semicolon and tab in the header. A blank stands for any
    /// number of blanks and tabs.
    pub separator: Option<char>,
    /// Whether a line of names stands above the cells; else columns are named by their numbers, from `1`.
    #[serde(default = "yes")]
    pub header: bool,
    /// Whether numbers are written 1,5 for one and a half.
    #[serde(default)]
    pub decimal_comma: bool,
    /// What the gap is measured between; needed where there is a gap.
    pub gap_kind: Option<GapKind>,
    /// Which point of a vehicle a position is of; needed where there are positions of several vehicles.
    pub point: Option<Point>,
    /// Which way y grows, seen along x; needed where there is a y.
    pub y_grows: Option<Side>,
    /// The side from which lanes are numbered; needed where there is a lane and no y.
    pub lanes_from: Option<Side>,
    /// Number of the first lane on that side.
    #[serde(default = "one")]
    pub first_lane: i64,
    /// Which way of the table's x is ahead.
    #[serde(default)]
    pub forward: Forward,
    /// How times are written, with `time = "pattern"`: `%Y%m%d %H:%M:%S:%f`, where `%f` at the end is a fraction of any width.
    pub time_pattern: Option<String>,
    /// Whether everybody drives along x.
    #[serde(default)]
    pub directions: Directions,
    /// Frames a second, where times are numbers of frames.
    pub frames_per_s: Option<f64>,
    /// The one vehicle that is ego, where the others only surround it; without it every vehicle is ego of a drive.
    pub ego: Option<String>,
    /// How far vehicles' centres are ahead of their positions, in m, where `point` is a `reference` and no column says it.
    pub centre_ahead_m: Option<f64>,
    /// A hole longer than this, in s, makes the number of a vehicle that of another one.
    pub new_vehicle_after_s: Option<f64>,
    /// Ego's length where no column says it, in m.
    #[serde(default = "car_length")]
    pub ego_length_m: f64,
    /// Length of the vehicle ahead where no column says it, in m.
    #[serde(default = "car_length")]
    pub lead_length_m: f64,
    /// Units of the columns.
    pub units: Units,
    /// Names of the columns.
    #[serde(default)]
    pub columns: Columns,
    /// The signals of a drive.
    pub signals: Option<Signals>,
    /// A file beside the table that says how it was recorded.
    pub recording_meta: Option<RecordingMeta>,
}

fn one() -> i64 {
    1
}

fn yes() -> bool {
    true
}

fn car_length() -> f64 {
    TableMapping::CAR_LENGTH_M
}

/// What a row and a file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Layout {
    /// A file is one follower (ego) behind one leader, a row is one time.
    Pair,
    /// A row is one vehicle at one time; each vehicle is ego of a drive of its own.
    Long,
    /// A row is one time of several vehicles in file, number 1 ahead; each but the first is ego of a drive.
    Platoon,
    /// A folder is one drive, a file in it is one signal with its own times; or a file is one drive, and its columns are the signals.
    Signals,
}

/// What a gap is measured between.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GapKind {
    /// From ego's front bumper to the leader's rear bumper.
    BumperToBumper,
    /// From front bumper to front bumper: the leader's length is taken off.
    FrontToFront,
    /// From centre to centre: half of both lengths is taken off.
    CentreToCentre,
    /// From bumper to bumper, negative where the other vehicle is behind: `lead_dx_m` of our own drives.
    Signed,
}

/// Which point of a vehicle a position is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Point {
    /// Its centre.
    Centre,
    /// The middle of its front bumper.
    Front,
    /// The middle of its rear bumper.
    Rear,
    /// The corner of its box with the smallest x and y; needs the width.
    Corner,
    /// A point such as the middle of the rear axle, behind the centre as `centre_ahead` says.
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

impl TableMapping {
    /// A middle-sized car, bumper to bumper, in m.
    pub const CAR_LENGTH_M: f64 = 4.7;

    /// A table of this layout in these units; everything else is as where a file does not say it. What the layout needs beside is
    /// asked for when a log is read.
    pub fn new(layout: Layout, units: Units) -> Self {
        Self {
            layout,
            separator: None,
            header: true,
            decimal_comma: false,
            gap_kind: None,
            point: None,
            y_grows: None,
            lanes_from: None,
            first_lane: one(),
            forward: Forward::default(),
            time_pattern: None,
            directions: Directions::default(),
            frames_per_s: None,
            ego: None,
            centre_ahead_m: None,
            new_vehicle_after_s: None,
            ego_length_m: Self::CAR_LENGTH_M,
            lead_length_m: Self::CAR_LENGTH_M,
            units,
            columns: Columns::default(),
            signals: None,
            recording_meta: None,
        }
    }

    /// Whether the layout has what it needs.
    ///
    /// # Errors
    /// A sentence that says what to add.
    pub(super) fn check(&self) -> Result<(), String> {
        let columns = &self.columns;
        let positive = |name: &str, value: Option<f64>| match value {
            Some(v) if !(v.is_finite() && v > 0.0) => Err(format!(
                "`table.{name}` is {v}, expected a finite number above 0"
            )),
            _ => Ok(()),
        };
        positive("ego_length_m", Some(self.ego_length_m))?;
        positive("lead_length_m", Some(self.lead_length_m))?;
        positive("frames_per_s", self.frames_per_s)?;
        positive("new_vehicle_after_s", self.new_vehicle_after_s)?;
        if let Some(separator) = self.separator
            && (!separator.is_ascii() || separator.is_ascii_alphanumeric() || separator == '"')
        {
            return Err(format!(
                "`table.separator` is `{separator}`, expected a character such as `,`, `;` or a tab"
            ));
        }
        if let Some(signals) = &self.signals {
            signals.check()?;
        }
        self.check_keys()?;
        let (c, name, known) = (columns, self.layout.as_str(), self.layout.columns());
        if let Some((key, _)) = c.given().iter().find(|(k, _)| !known.contains(k)) {
            return Err(format!(
                "layout `{name}` has no `table.columns.{key}`; its columns are {}",
                known.join(", ")
            ));
        }
        if c.gap.is_some() && self.gap_kind.is_none() {
            return Err(
                "`table.gap_kind` is not given: is the gap `bumper_to_bumper`, `front_to_front` or `centre_to_centre`?"
                    .to_owned(),
            );
        }
        if self.layout == Layout::Long {
            c.check_id()?;
        }
        let missing = self.needs().into_iter().find(|(given, _)| !given);
        missing.map_or(Ok(()), |(_, what)| {
            Err(format!("layout `{name}` needs {what}"))
        })
    }

    /// What the layout needs, and whether it is given.
    fn needs(&self) -> Vec<(bool, &'static str)> {
        let (c, signals) = (&self.columns, self.signals.as_ref());
        let (point, is) = (self.point.is_some(), |point| self.point == Some(point));
        let numbered = |c: &Option<String>| c.as_ref().is_some_and(|c| c.contains("{n}"));
        let meta = self.recording_meta.as_ref();
        let rated = self.frames_per_s.is_some() || meta.is_some_and(|m| m.frames_per_s.is_some());
        let timed = c.time.is_some() || self.layout == Layout::Signals;
        let has_gap = signals.is_some_and(|s| s.tracks.is_some() || s.lead.is_some());
        let numbered_lanes = self.has_lane_numbers();
        let mut needs = vec![
            (timed, "`table.columns.time`"),
            (
                rated || self.units.time != TimeUnit::Frames,
                "`table.frames_per_s`, as its times are frames",
            ),
        ];
        needs.extend(match self.layout {
            Layout::Pair => vec![
                (c.ego_speed.is_some(), "`table.columns.ego_speed`"),
                (
                    c.gap.is_some() || c.lead_x.is_some(),
                    "`table.columns.gap`, or `lead_x` beside `ego_x` and `point`",
                ),
                (c.gap.is_some() || c.ego_x.is_some(), "`table.columns.ego_x`"),
                (c.gap.is_some() || point, POINT),
            ],
            Layout::Platoon => vec![(
                numbered(&c.speed) && numbered(&c.gap),
                "`table.columns.speed` and `gap` with `{n}` where the vehicle's number stands",
            )],
            Layout::Long => vec![
                (c.x.is_some(), "`table.columns.x`"),
                (
                    c.id.is_some() || c.around_id().is_some(),
                    "`table.columns.id`, or `{id}` in the columns of each vehicle",
                ),
                (
                    !is(Point::Reference) || c.centre_ahead.is_some() || self.centre_ahead_m.is_some(),
                    "`table.columns.centre_ahead` or `table.centre_ahead_m`, as its point is a reference",
                ),
                (point, POINT),
                (
                    !is(Point::Corner) || c.length.is_some() && c.width.is_some(),
                    "columns `length` and `width`, as its point is a corner",
                ),
                (
                    c.y.is_none() || self.y_grows.is_some(),
                    "`table.y_grows`: does y grow to the `left` or to the `right` of x?",
                ),
                (
                    c.y.is_some() || c.lane.is_none() || self.lanes_from.is_some(),
                    "`table.lanes_from`: are lanes numbered from the `left` or the `right`?",
                ),
            ],
            Layout::Signals => vec![
                (signals.is_some(), "`[table.signals.speed]` and the like"),
                (
                    self.gap_kind.is_some() || !has_gap,
                    "`table.gap_kind`: is the distance ahead `bumper_to_bumper`, `front_to_front` or `centre_to_centre`?",
                ),
                (
                    self.lanes_from.is_some() || !numbered_lanes,
                    "`table.lanes_from`: are lanes numbered from the `left` or the `right`?",
                ),
            ],
        });
        needs
    }

    /// Whether a signal numbers lanes.
    pub(super) fn has_lane_numbers(&self) -> bool {
        let lane = self.signals.as_ref().and_then(|s| s.lane.as_ref());
        let road = self.signals.as_ref().and_then(|s| s.road.as_ref());
        lane.is_some_and(|l| l.number.is_some()) || road.is_some_and(|r| r.lane.is_some())
    }

    /// Whether positions are places in the world, so that a line through it can straighten the road.
    pub(super) fn is_of_the_world(&self) -> bool {
        let centre = matches!(self.point, Some(Point::Centre));
        self.layout == Layout::Long
            && self.directions == Directions::Along
            && (centre || self.columns.heading.is_some())
    }

    /// Refuses keys that do nothing: somebody thinks that they do.
    fn check_keys(&self) -> Result<(), String> {
        let c = &self.columns;
        let [pair, long] = [Layout::Pair, Layout::Long].map(|layout| self.layout == layout);
        let signals = self.signals.as_ref();
        let in_signals = self.layout == Layout::Signals;
        let (y_grows, lanes_from) = (self.y_grows.is_some(), self.lanes_from.is_some());
        let numbered = self.first_lane != one();
        let reference = self.point == Some(Point::Reference);
        let signed = self.gap_kind == Some(GapKind::Signed);
        // What is given, its key, and whether the layout has it.
        let of_layout = [
            (self.directions != Directions::Along, "directions", long),
            (y_grows, "y_grows", long),
            (lanes_from, "lanes_from", long || in_signals),
            (numbered, "first_lane", long || in_signals),
            (
                self.new_vehicle_after_s.is_some(),
                "new_vehicle_after_s",
                long,
            ),
            (self.recording_meta.is_some(), "recording_meta", long),
            (self.ego.is_some(), "ego", long),
            (reference, "point = \"reference\"", long),
            (signals.is_some(), "signals", in_signals),
            (self.forward != Forward::AlongX, "forward", long || pair),
            (self.point.is_some(), "point", long || pair),
            (signed, "gap_kind = \"signed\"", !long),
        ];
        if let Some((_, key, _)) = of_layout.iter().find(|(given, _, has)| *given && !has) {
            let name = self.layout.as_str();
            return Err(format!(
                "layout `{name}` has no `table.{key}`: leave it out"
            ));
        }
        let gap =
            c.gap.is_some() || signals.is_some_and(|s| s.tracks.is_some() || s.lead.is_some());
        let lanes = c.lane.is_some() || self.has_lane_numbers();
        let lane_column = if in_signals {
            "`table.signals.lane.number` or `table.signals.road.lane`"
        } else {
            "`table.columns.lane`"
        };
        let point = long || c.lead_x.is_some() && c.gap.is_none();
        let ahead = self.centre_ahead_m.is_some() || c.centre_ahead.is_some();
        let pattern = self.time_pattern.as_deref();
        let time = |unit: TimeUnit| self.units.time == unit;
        // What is given, its key, whether it does something, and what it needs for that.
        let of_others = [
            (
                self.gap_kind.is_some(),
                "gap_kind",
                gap,
                "`table.columns.gap`",
            ),
            (
                self.point.is_some(),
                "point",
                point,
                "`table.columns.lead_x`, or beside a `gap`",
            ),
            (y_grows, "y_grows", c.y.is_some(), "`table.columns.y`"),
            (ahead, "centre_ahead", reference, "`point = \"reference\"`"),
            (lanes_from, "lanes_from", lanes, lane_column),
            (numbered, "first_lane", lanes, lane_column),
            (
                pattern.is_some(),
                "time_pattern",
                time(TimeUnit::Pattern),
                "`time = \"pattern\"`",
            ),
            (
                self.frames_per_s.is_some(),
                "frames_per_s",
                time(TimeUnit::Frames),
                "`time = \"frames\"`",
            ),
        ];
        let mut idle = of_others
            .iter()
            .filter(|(given, _, used, _)| *given && !used);
        if let Some((_, key, _, what)) = idle.next() {
            return Err(format!(
                "`table.{key}` does nothing without {what}: leave it out"
            ));
        }
        if time(TimeUnit::Pattern) && !pattern.is_some_and(is_pattern) {
            return Err(format!(
                "`table.time_pattern` is `{}`, expected one such as `%Y%m%d %H:%M:%S:%f`, with `%f` at the end alone",
                pattern.unwrap_or_default()
            ));
        }
        Ok(())
    }
}

const POINT: &str = "`table.point`: are positions of a vehicle's `front`, `centre`, `rear`, `corner`, or of another `reference`?";

impl Layout {
    /// The word in a mapping.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Pair => "pair",
            Self::Long => "long",
            Self::Platoon => "platoon",
            Self::Signals => "signals",
        }
    }

    /// Keys of the columns that mean something in it.
    fn columns(self) -> Vec<&'static str> {
        let keys = match self {
            Self::Pair => {
                "time ego_x ego_y ego_speed ego_length gap lead_id lead_dy lead_x lead_speed lead_length"
            }
            Self::Long => {
                "time id groups x y lane speed speed_x speed_y heading length width centre_ahead gap lead_id lead_x \
                 lead_speed lead_length"
            }
            Self::Platoon => "time x speed length gap",
            Self::Signals => "",
        };
        keys.split_whitespace().collect()
    }
}

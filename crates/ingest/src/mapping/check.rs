//! What a mapping of a table must say, and what it may not.

use super::{
    columns::given,
    layout::{Layout, Long, Pair, Platoon, Point},
    refusal::{Checked, positive, refuse},
    side::Side,
    table::{GapKind, TableMapping},
    time_pattern::is_pattern,
    units::TimeUnit,
};

/// Refuses a key that does nothing: somebody thinks that it does.
fn idle(key: &str, given: bool, does: bool, needs: &str) -> Checked {
    refuse(given && !does, &format!("`table.{key}` does nothing without {needs}: leave it out"))
}

/// Where the place in a lane grows, which goes with a column of it.
fn offset_grows(grows: Option<Side>, offset: Option<&String>) -> Checked {
    let needs = "`table.columns.offset`";
    idle("offset_grows", grows.is_some(), offset.is_some(), needs)?;
    let question = "`table.offset_grows` is not given: does the place in the lane grow to the `left` or to the `right`?";
    refuse(offset.is_some() && grows.is_none(), question)
}

impl TableMapping {
    /// Whether the layout has what it needs, and no key does nothing.
    ///
    /// # Errors
    /// A sentence that says what to add or to leave out.
    pub(super) fn check(&self) -> Checked {
        positive("table.ego_length_m", Some(self.ego_length_m))?;
        positive("table.lead_length_m", Some(self.lead_length_m))?;
        positive("table.frames_per_s", self.frames_per_s)?;
        if let Some(separator) = self.separator
            && (!separator.is_ascii() || separator.is_ascii_alphanumeric() || separator == '"')
        {
            return Err(format!(
                "`table.separator` is `{separator}`, expected a character such as `,`, `;` or a tab"
            ));
        }
        self.layout.check()?;
        let (gap, numbered) = (self.layout.has_gap(), self.layout.numbers_lanes());
        let needs = "`table.columns.gap`";
        idle("gap_kind", self.gap_kind.is_some(), gap, needs)?;
        let question = "`table.gap_kind` is not given: is the gap `bumper_to_bumper`, `front_to_front` or `centre_to_centre`?";
        refuse(gap && self.gap_kind.is_none(), question)?;
        let signed = self.gap_kind == Some(GapKind::Signed);
        let why = "layout `long` has no `gap_kind = \"signed\"`: its gaps are to the vehicle ahead";
        refuse(signed && matches!(self.layout, Layout::Long(_)), why)?;
        let needs = "a column that numbers lanes";
        idle("lanes_from", self.lanes_from.is_some(), numbered, needs)?;
        let renumbered = self.first_lane != TableMapping::FIRST_LANE;
        idle("first_lane", renumbered, numbered, needs)?;
        // Beside a y the number may stand for nothing.
        let by_y = matches!(&self.layout, Layout::Long(long) if long.columns.y.is_some());
        let question =
            "`table.lanes_from` is not given: are lanes numbered from the `left` or the `right`?";
        refuse(numbered && !by_y && self.lanes_from.is_none(), question)?;
        self.check_times()
    }

    fn check_times(&self) -> Checked {
        let (framed, rated) = (self.units.time == TimeUnit::Frames, self.frames_per_s.is_some());
        idle("frames_per_s", rated, framed, "`time = \"frames\"`")?;
        let meta_rated = self.layout.meta().is_some_and(|m| m.frames_per_s.is_some());
        let needs = "`table.frames_per_s` is not given, as is needed where times are frames";
        refuse(framed && !rated && !meta_rated, needs)?;
        let patterned = self.units.time == TimeUnit::Pattern;
        let pattern = self.time_pattern.as_deref();
        let needs = "`time = \"pattern\"`";
        idle("time_pattern", pattern.is_some(), patterned, needs)?;
        let wrong = format!(
            "`table.time_pattern` is `{}`, expected one such as `%Y%m%d %H:%M:%S:%f`, with `%f` at the end alone",
            pattern.unwrap_or_default()
        );
        refuse(patterned && !pattern.is_some_and(is_pattern), &wrong)
    }
}

impl Layout {
    fn check(&self) -> Checked {
        match self {
            Self::Pair(pair) => pair.check(),
            Self::Long(long) => long.check(),
            Self::Platoon(platoon) => platoon.check(),
        }
    }
}

impl Pair {
    fn check(&self) -> Checked {
        let c = &self.columns;
        let positions = c.lead_x.is_some() && c.gap.is_none();
        let needs = "`table.columns.lead_x`, or beside a `gap`";
        idle("point", self.point.is_some(), positions, needs)?;
        let odd = matches!(self.point, Some(Point::Reference | Point::Corner));
        let question = "`table.point` of layout `pair` is not given, or another: are positions of a vehicle's `front`, `centre` or `rear`?";
        refuse(positions && (odd || self.point.is_none()), question)?;
        let twice = "`table.columns.ego_y` and `lane` or `offset` both say where ego is across the road: `ego_y` is for a position across \
                     the road, `lane` and `offset` are for a lane's number and the place in it";
        let in_lane = c.lane.is_some() || c.offset.is_some();
        refuse(c.ego_y.is_some() && in_lane, twice)?;
        offset_grows(self.offset_grows, c.offset.as_ref())?;
        let needs =
            "layout `pair` needs `table.columns.gap`, or `lead_x` beside `ego_x` and `point`";
        let placed = c.gap.is_some() || c.lead_x.is_some() && c.ego_x.is_some();
        refuse(!placed, needs)
    }
}

impl Platoon {
    fn check(&self) -> Checked {
        let c = &self.columns;
        let mut of_cars = given(c).into_iter().filter(|(key, _)| key != "time");
        if let Some((key, name)) = of_cars.find(|(_, name)| !name.contains("{n}")) {
            return Err(format!(
                "`table.columns.{key}` is `{name}`, expected a name with `{{n}}` where the vehicle's number stands"
            ));
        }
        offset_grows(self.offset_grows, c.offset.as_ref())
    }
}

impl Long {
    fn check(&self) -> Checked {
        let c = &self.columns;
        positive("table.new_vehicle_after_s", self.new_vehicle_after_s)?;
        let needs = "`table.columns.y`";
        idle("y_grows", self.y_grows.is_some(), c.y.is_some(), needs)?;
        let question =
            "`table.y_grows` is not given: does y grow to the `left` or to the `right` of x?";
        refuse(c.y.is_some() && self.y_grows.is_none(), question)?;
        let reference = self.point == Point::Reference;
        let ahead = self.centre_ahead_m.is_some() || c.centre_ahead.is_some();
        idle("centre_ahead", ahead, reference, "`point = \"reference\"`")?;
        let needs = "a point that is a `reference` needs `table.columns.centre_ahead` or `table.centre_ahead_m`";
        refuse(reference && !ahead, needs)?;
        let sized = c.length.is_some() && c.width.is_some();
        let needs = "a point that is a `corner` needs `table.columns.length` and `width`";
        refuse(self.point == Point::Corner && !sized, needs)?;
        let twice = "`table.columns.y` and `offset` both say where a vehicle is across the road: `y` is for a position across the road, \
                     `offset` beside `lane` for the place in a lane";
        refuse(c.y.is_some() && c.offset.is_some(), twice)?;
        let question =
            "`table.columns.lane` is not given: in which lane is the place that `offset` says?";
        refuse(c.offset.is_some() && c.lane.is_none(), question)?;
        offset_grows(self.offset_grows, c.offset.as_ref())?;
        let named = c.id.is_some() || c.around_id().is_some();
        let needs =
            "layout `long` needs `table.columns.id`, or `{id}` in the columns of each vehicle";
        refuse(!named, needs)?;
        c.check_id()
    }
}

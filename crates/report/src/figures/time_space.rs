//! One drive as a time-space diagram, with what was decided marked on it.

use super::prelude::*;
use maveric_domain::ConditionId;

/// The ego and the vehicles round it over time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TimeSpace {
    /// Id of the drive. Plain text.
    pub drive: String,
    /// In which condition it was driven: the colour of the ego.
    pub condition: ConditionId,
    /// The ego, without holes.
    pub ego: Track,
    /// The vehicles that were leads at some time.
    pub leads: Vec<Track>,
    /// All other vehicles.
    pub others: Vec<Track>,
    /// What the ego's driver or car decided, and when.
    pub decisions: Vec<Decision>,
}

/// Where one vehicle was; three lists of one length.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Track {
    /// Time in seconds, rising.
    pub time_s: Vec<f64>,
    /// Front bumper along the road, in metres.
    pub x_m: Vec<f64>,
    /// Lane, 0 the right one.
    pub lane: Vec<u8>,
}

/// Something that was decided.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// When, in seconds, within the ego's track.
    pub time_s: f64,
    /// What.
    pub kind: DecisionKind,
}

/// What can be decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DecisionKind {
    /// To change lane, to pass.
    LaneChange,
    /// To merge back in front of the passed vehicle.
    MergeBack,
    /// To leave a lane change undone, or to brake, because a safety rule says so.
    Safety,
}

impl DecisionKind {
    const ALL: [Self; 3] = [Self::LaneChange, Self::MergeBack, Self::Safety];

    fn look(self) -> (Marker, RGBColor, &'static str) {
        match self {
            Self::LaneChange => (Marker::TriangleUp, ORANGE, "changes lane to pass"),
            Self::MergeBack => (Marker::TriangleDown, BLUE, "merges back"),
            Self::Safety => (Marker::Diamond, OCHRE, "safety rule steps in"),
        }
    }
}

const NAME: &str = "time-space";
/// Vehicles farther from the ego than this are not drawn, in metres.
const SIGHT_M: f64 = 250.0;
/// Most points of the ego's line; others get fewer, being many.
const MOST_POINTS: usize = 1200;
const MOST_POINTS_OF_OTHERS: usize = 240;
/// Above this many other vehicles, those beyond it are left out, and the caption says so.
const MOST_OTHERS: usize = 120;

/// Draws positions against time, less a steady ride at the ego's mean speed, so that differences show.
///
/// # Errors
/// [`ReportError`] if the ego has fewer than two rows or does not move on in time, lengths differ, a decision lies
/// outside the drive, or a value is not finite.
///
/// # Source
/// The oblique form of the diagram: Muñoz and Daganzo (2002), Transportation Research Part A 36, there for counts.
pub fn time_space(input: &TimeSpace, context: &Context) -> Result<Figure, ReportError> {
    let (first, last) = check(input)?;
    let ego = Path(&input.ego);
    let start = input.ego.x_m[0];
    let speed = (input.ego.x_m[input.ego.x_m.len() - 1] - start) / (last - first);
    let flat = |(time, x): (f64, f64)| (time - first, x - start - speed * (time - first));
    let near = |track: &Track| -> Vec<Piece> {
        let seen = |&(time, x): &(f64, f64)| {
            (first..=last).contains(&time) && (x - ego.at(time)).abs() <= SIGHT_M
        };
        pieces(track, seen, flat)
    };
    let leads: Vec<Piece> = input.leads.iter().flat_map(near).collect();
    let others: Vec<Piece> = input.others.iter().take(MOST_OTHERS).flat_map(near).collect();
    let ego_pieces = pieces(&input.ego, |_| true, flat);
    let condition = context.look(input.condition);
    let whose = condition.words();
    let kept = format!("{} {}", context.speed(speed, 1), context.speed.name());
    let plan = plan(input, &whose, last - first, &kept);
    let ego_pen = Pen::new(condition.rgb(), 1.5);
    let lead_pen = Pen::new(MUTED, stroke::BOX);
    let other_pen = Pen::new(GREY, stroke::AXIS).alpha(0.7);
    draw(plan, context, |canvas, whole| {
        let ego_label = format!("ego ({whose})");
        let mut keys =
            vec![(Key::Line(ego_pen), ego_label.as_str()), (Key::Line(lead_pen), "lead")];
        if !others.is_empty() {
            keys.push((Key::Line(other_pen), "other traffic"));
        }
        for (marker, colour, name) in input.kinds().map(|(kind, _)| kind.look()) {
            keys.push((Key::Point(marker, colour), name));
        }
        let place = canvas.legend(whole, &keys);
        let everything = ego_pieces.iter().chain(&leads).chain(&others);
        let places = everything.flat_map(|piece| piece.points.iter().map(|p| p.1));
        let labels =
            Labels { x: "Time (s)", y: "Ahead of the steady ride (m)", ..Labels::default() };
        let scales = (Scale::between(0.0, last - first, 8), Scale::over(places, 5));
        let mut panel = Panel::open(canvas, place, &labels, scales);
        for piece in ego_pieces.iter().filter(|piece| !piece.right_lane) {
            let ends = [piece.points[0].0, piece.points[piece.points.len() - 1].0];
            panel.stripe(ends, OCHRE, 0.1);
        }
        for (pieces, pen, most) in [
            (&others, other_pen, MOST_POINTS_OF_OTHERS),
            (&leads, lead_pen, MOST_POINTS_OF_OTHERS),
            (&ego_pieces, ego_pen, MOST_POINTS),
        ] {
            for Piece { right_lane, points } in pieces {
                let pen = if *right_lane { pen } else { pen.dashed(4.0, 1.8) };
                panel.thin_line(points, most, pen);
            }
        }
        for decision in &input.decisions {
            let (marker, colour, _) = decision.kind.look();
            let place = flat((decision.time_s, ego.at(decision.time_s)));
            panel.mark(place, (2.8, marker, colour));
        }
    })
}

impl TimeSpace {
    /// What was decided, and how often.
    fn kinds(&self) -> impl Iterator<Item = (DecisionKind, usize)> {
        let count = |kind| self.decisions.iter().filter(|d| d.kind == kind).count();
        let kinds = DecisionKind::ALL.map(|kind| (kind, count(kind)));
        kinds.into_iter().filter(|(_, count)| *count > 0)
    }
}

fn plan(input: &TimeSpace, whose: &str, seconds: f64, kept: &str) -> Plan {
    let counts = input.kinds().map(|(kind, count)| format!("{count} × {}", kind.look().2));
    let counts = match counts.collect::<Vec<_>>() {
        none if none.is_empty() => "none".to_owned(),
        counts => counts.join(", "),
    };
    let left_out = match input.others.len().saturating_sub(MOST_OTHERS) {
        0 => String::new(),
        more => format!(" {more} more vehicles are left out, there being too many."),
    };
    Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 92.0),
        title: format!("Time-space diagram of {}", markup::literal(&input.drive)),
        caption: format!(
            "Position along the road against time, less a steady ride at the drive’s mean speed ({kept}): a line \
             that rises is faster than that. Solid: in the right lane; dashed: in another; shaded: the ego ({whose}) \
             is out of the right lane. Vehicles are drawn within {SIGHT_M:.0} m of the ego. Decisions: {counts}.\
             {left_out} *n* = 1 drive of {seconds:.0} s; no test."
        ),
        alt: format!(
            "{} over {seconds:.0} s at {kept} on average among {} leads and {} other vehicles. Decisions: {counts}.",
            input.drive,
            input.leads.len(),
            input.others.len()
        ),
        shows: Shows::Participants,
    }
}

fn check(input: &TimeSpace) -> Result<(f64, f64), ReportError> {
    let check = Check(NAME);
    check.at_least(2, "rows of the ego", input.ego.time_s.len())?;
    for track in [&input.ego].into_iter().chain(&input.leads).chain(&input.others) {
        let rows = track.time_s.len();
        check.length("x_m", track.x_m.len(), rows)?;
        check.length("lane", track.lane.len(), rows)?;
        check.finite("time_s", track.time_s.iter().copied())?;
        check.finite("x_m", track.x_m.iter().copied())?;
        check.rising("time_s", track.time_s.iter().copied(), "rising times")?;
    }
    let first = input.ego.time_s[0];
    let last = input.ego.time_s[input.ego.time_s.len() - 1];
    for decision in &input.decisions {
        let expected = format!("a time within the drive, {first} to {last} s");
        check.within((first, last), "time of a decision", [decision.time_s], &expected)?;
    }
    Ok((first, last))
}

/// A stretch in which a vehicle is near and stays in or out of the right lane.
struct Piece {
    right_lane: bool,
    points: Vec<(f64, f64)>,
}

fn pieces(
    track: &Track,
    seen: impl Fn(&(f64, f64)) -> bool,
    flat: impl Fn((f64, f64)) -> (f64, f64),
) -> Vec<Piece> {
    let mut out: Vec<Piece> = Vec::new();
    let mut before: Option<bool> = None;
    for (row, &lane) in track.lane.iter().enumerate() {
        let point = (track.time_s[row], track.x_m[row]);
        if !seen(&point) {
            before = None;
            continue;
        }
        let right_lane = lane == 0;
        if before != Some(right_lane) {
            // A change of lane leaves no gap: the new piece begins where the old one ends.
            let joint = before.and(out.last()).and_then(|piece| piece.points.last().copied());
            out.push(Piece { right_lane, points: joint.into_iter().collect() });
        }
        if let Some(piece) = out.last_mut() {
            piece.points.push(flat(point));
        }
        before = Some(right_lane);
    }
    out
}

/// A position between rows.
struct Path<'a>(&'a Track);

impl Path<'_> {
    /// By linear interpolation; held at the ends.
    fn at(&self, time: f64) -> f64 {
        let Track { time_s, x_m, .. } = self.0;
        let after = time_s.partition_point(|&t| t < time);
        if after == 0 {
            return x_m[0];
        }
        if after == time_s.len() {
            return x_m[after - 1];
        }
        let share = (time - time_s[after - 1]) / (time_s[after] - time_s[after - 1]);
        x_m[after - 1] + share * (x_m[after] - x_m[after - 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(speed: f64, from: f64, lane: impl Fn(usize) -> u8) -> Track {
        Track {
            time_s: (0..60).map(f64::from).collect(),
            x_m: (0..60).map(|t| from + speed * f64::from(t)).collect(),
            lane: (0..60).map(lane).collect(),
        }
    }

    fn input() -> TimeSpace {
        TimeSpace {
            drive: "P07 Mimic".into(),
            condition: ConditionId::new("same").unwrap(),
            ego: track(30.0, 0.0, |t| u8::from((20..40).contains(&t))),
            leads: vec![track(25.0, 150.0, |_| 0)],
            others: Vec::new(),
            decisions: vec![Decision { time_s: 19.5, kind: DecisionKind::LaneChange }],
        }
    }

    #[test]
    fn pieces_join_where_the_lane_changes() {
        let input = input();
        let pieces = pieces(&input.ego, |_| true, |at| at);
        let lanes: Vec<bool> = pieces.iter().map(|piece| piece.right_lane).collect();
        assert_eq!(lanes, [true, false, true]);
        assert_eq!(pieces[0].points.last(), pieces[1].points.first());
    }

    #[test]
    fn a_decision_outside_the_drive_is_refused() {
        let mut input = input();
        assert!(time_space(&input, &Context::real()).is_ok());
        input.decisions[0].time_s = 61.0;
        let refused = time_space(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

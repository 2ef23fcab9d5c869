//! One moment of a simulated drive, from above.

use super::prelude::*;
use super::theme::{LANE_LINE, ROAD};
use super::vehicle::paint_vehicle;
use maveric_domain::ConditionId;

/// Where everything is at one moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimulatorView {
    /// Id of the participant.
    pub participant: String,
    /// Whose style the ego drives.
    pub condition: ConditionId,
    /// Seconds since the drive's start.
    pub time_s: f64,
    /// Lanes of the road; lane 0 is the right one, its centre at y = 0.
    pub lanes: usize,
    /// Width of a lane in metres.
    pub lane_width_m: f64,
    /// The car in the middle of the view.
    pub ego: VehicleView,
    /// The traffic around it.
    pub others: Vec<VehicleView>,
    /// Which of `others` is the reference vehicle.
    pub reference: Option<usize>,
    /// Where the ego has been, road frame, metres: (x, y).
    pub trail_m: Vec<(f64, f64)>,
    /// Where it means to go, likewise.
    pub plan_m: Vec<(f64, f64)>,
}

/// One vehicle, road frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VehicleView {
    /// Centre along the road, metres.
    pub x_m: f64,
    /// Centre across the road, metres, left positive.
    pub y_m: f64,
    /// Heading in radians, 0 along the road, left positive.
    pub heading_rad: f64,
    /// Speed in m/s.
    pub speed_mps: f64,
    /// Length in metres.
    pub length_m: f64,
    /// Width in metres.
    pub width_m: f64,
}

impl VehicleView {
    fn numbers(&self) -> [f64; 6] {
        [self.x_m, self.y_m, self.heading_rad, self.speed_mps, self.length_m, self.width_m]
    }
}

const NAME: &str = "simulator-view";
/// The stretch of road shown, metres behind and ahead of the ego.
const BEHIND_M: f64 = 60.0;
const AHEAD_M: f64 = 120.0;
/// How much wider than long everything is drawn.
const STRETCH: f64 = 2.0;

/// Draws lanes, vehicles with speeds, the ego's trail and plan, and the gap to the reference.
///
/// # Errors
/// [`ReportError`] if a number is not finite, or there is no lane or a lane has no width.
///
/// # Source
/// In the place of the paper's photograph of its driving simulator; method, sections 5 and 6.
pub fn simulator_view(input: &SimulatorView, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "lanes", input.lanes)?;
    check.finite("time_s", [input.time_s])?;
    check.finite("lane_width_m", [input.lane_width_m])?;
    let width = input.lane_width_m;
    check.that(width > 0.0, "lane_width_m", width, "a width above 0 m")?;
    check.finite("ego", input.ego.numbers())?;
    check.finite("a vehicle", input.others.iter().flat_map(VehicleView::numbers))?;
    let paths = input.trail_m.iter().chain(&input.plan_m);
    check.finite("a path", paths.flat_map(|place| [place.0, place.1]))?;
    let condition = context.look(input.condition);
    draw(plan(input, context), context, |canvas, place| {
        let view = View::new(input, context, place);
        view.road(canvas);
        view.path(canvas, &input.trail_m, Pen::new(GREY, stroke::STRONG).dashed(2.0, 2.0));
        let plan_pen = Pen::new(condition.rgb(), stroke::STRONG).dashed(4.0, 2.0);
        view.path(canvas, &input.plan_m, plan_pen);
        for (index, vehicle) in input.others.iter().enumerate().filter(|(_, v)| input.sees(v)) {
            let is_reference = input.reference == Some(index);
            view.other(canvas, vehicle, if is_reference { GREY } else { PAPER });
        }
        view.ego(canvas, condition.rgb());
        view.gap(canvas);
        view.ruler(canvas);
        let head = format!("{}, {} s", condition.words(), number(input.time_s, 1));
        let y = place.top + cap_height(size::TITLE);
        canvas.text(&head, (place.left, y), Look::new(size::TITLE).semibold());
        let look = Look::new(size::TICK).end().colour(MUTED);
        canvas.text("driving direction →", (place.right, y), look);
    })
}

impl SimulatorView {
    fn sees(&self, vehicle: &VehicleView) -> bool {
        let (ahead, half) = (vehicle.x_m - self.ego.x_m, vehicle.length_m / 2.0);
        ahead - half >= -BEHIND_M && ahead + half <= AHEAD_M
    }

    /// The reference vehicle, and its distance from bumper to bumper.
    fn lead(&self) -> Option<(&VehicleView, f64)> {
        let lead = self.others.get(self.reference?)?;
        let lengths = f64::midpoint(lead.length_m, self.ego.length_m);
        Some((lead, lead.x_m - self.ego.x_m - lengths))
    }
}

fn plan(input: &SimulatorView, context: &Context) -> Plan {
    let (condition, unit) = (context.look(input.condition), context.speed.name());
    let hidden = input.others.iter().filter(|vehicle| !input.sees(vehicle));
    let hidden = match hidden.count() {
        0 => String::new(),
        1 => " One more vehicle is outside the picture.".to_owned(),
        more => format!(" {more} more vehicles are outside the picture."),
    };
    let (others, speed) = (input.others.len(), context.speed(input.ego.speed_mps, 1));
    let words = match input.lead() {
        Some((_, gap)) => format!(
            "The ego drives {speed} {unit}, {} m from the reference vehicle; {} other vehicles.",
            number(gap, 1),
            others.saturating_sub(1)
        ),
        None => format!(
            "The ego drives {speed} {unit} without a reference vehicle; {others} other vehicles."
        ),
    };
    let road = STRETCH * input.lane_width_m * input.lanes as f64;
    Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 25.5 + road),
        title: "The simulator".to_owned(),
        caption: format!(
            "One moment of a simulated drive: participant {}, {}, {} s after the start. Speeds in \
             {unit}; widths are drawn {} times as large as lengths. Dashed: the ego’s trail and plan.{hidden} \
             *n* = 1 drive; no test.",
            markup::literal(&input.participant),
            condition.words(),
            number(input.time_s, 1),
            number(STRETCH, 0),
        ),
        alt: words,
        shows: Shows::Participants,
    }
}

/// The stretch of road round the ego, laid on the page.
struct View<'a> {
    input: &'a SimulatorView,
    context: &'a Context,
    left: f64,
    right: f64,
    top: f64,
    /// Points in a metre along the road.
    scale: f64,
}

impl<'a> View<'a> {
    fn new(input: &'a SimulatorView, context: &'a Context, place: Place) -> Self {
        Self {
            input,
            context,
            left: place.left,
            right: place.right,
            top: place.top + 14.0,
            scale: (place.right - place.left) / (BEHIND_M + AHEAD_M),
        }
    }

    /// Where a place of the road frame, in metres, lies on the page.
    fn at(&self, x_m: f64, y_m: f64) -> (f64, f64) {
        let highest = (self.input.lanes as f64 - 0.5) * self.input.lane_width_m;
        (
            self.left + (x_m - self.input.ego.x_m + BEHIND_M) * self.scale,
            self.top + (highest - y_m) * self.scale * STRETCH,
        )
    }

    /// The lower edge of the road.
    fn bottom(&self) -> f64 {
        self.at(0.0, -self.input.lane_width_m / 2.0).1
    }

    fn road(&self, canvas: &mut Canvas<'_>) {
        let edge_m = |line: usize| (line as f64 - 0.5) * self.input.lane_width_m;
        let y = |line: usize| self.at(0.0, edge_m(line)).1;
        let lanes = self.input.lanes;
        canvas.fill_rect((self.left, y(lanes)), (self.right, y(0)), ROAD, 1.0);
        let pen = Pen::new(LANE_LINE, stroke::STRONG);
        for line in 0..=lanes {
            let inner = line > 0 && line < lanes;
            let pen = if inner { pen.dashed(8.5, 12.0) } else { pen };
            canvas.line((self.left, y(line)), (self.right, y(line)), pen);
        }
    }

    fn path(&self, canvas: &mut Canvas<'_>, path: &[(f64, f64)], pen: Pen) {
        let seen = |(x, _): &&(f64, f64)| (-BEHIND_M..=AHEAD_M).contains(&(x - self.input.ego.x_m));
        let inside = path.iter().filter(seen).map(|&(x, y)| self.at(x, y));
        canvas.path(&inside.collect::<Vec<_>>(), pen);
    }

    /// Draws a vehicle; gives its centre, length and width on the page.
    fn vehicle(
        &self,
        canvas: &mut Canvas<'_>,
        vehicle: &VehicleView,
        ink: RGBColor,
    ) -> ((f64, f64), f64, f64) {
        let centre = self.at(vehicle.x_m, vehicle.y_m);
        let length = vehicle.length_m * self.scale;
        let width = vehicle.width_m * self.scale * STRETCH;
        paint_vehicle(canvas, centre, (length, width), vehicle.heading_rad, ink);
        (centre, length, width)
    }

    /// A label with its own ground, since a plan may run through it.
    fn label(canvas: &mut Canvas<'_>, text: &str, (left, y): (f64, f64)) {
        let look = Look::new(size::TICK).centred();
        let corner = (left + look.width(text) + 1.5, y + 4.5);
        canvas.fill_rect((left - 1.5, y - 4.5), corner, ROAD, 1.0);
        canvas.text(text, (left, y), look);
    }

    fn other(&self, canvas: &mut Canvas<'_>, vehicle: &VehicleView, ink: RGBColor) {
        let (centre, length, _) = self.vehicle(canvas, vehicle, ink);
        let beside = (centre.0 + length / 2.0 + 3.0, centre.1);
        Self::label(canvas, &self.context.speed(vehicle.speed_mps, 0), beside);
    }

    fn ego(&self, canvas: &mut Canvas<'_>, ink: RGBColor) {
        let (centre, _, width) = self.vehicle(canvas, &self.input.ego, ink);
        // The plan leaves the ego's front, so its own label stands beside it: to the left, or to the right in the
        // leftmost lane.
        let leftmost_m = (self.input.lanes as f64 - 1.25) * self.input.lane_width_m;
        let aside = if self.input.ego.y_m > leftmost_m { 1.0 } else { -1.0 };
        let speed = self.context.speed(self.input.ego.speed_mps, 0);
        let label = format!("{speed} {}", self.context.speed.name());
        let half = Look::new(size::TICK).width(&label) / 2.0;
        let place = (centre.0 - half, centre.1 + aside * (width / 2.0 + 6.0));
        Self::label(canvas, &label, place);
    }

    /// The distance to the reference vehicle, below the road.
    fn gap(&self, canvas: &mut Canvas<'_>) {
        let SimulatorView { ego, .. } = self.input;
        let lead = self.input.lead().filter(|(lead, gap)| self.input.sees(lead) && *gap > 0.0);
        let Some((lead, gap)) = lead else {
            return;
        };
        let y = self.bottom() + 6.0;
        let from = self.at(ego.x_m + ego.length_m / 2.0, ego.y_m);
        let to = self.at(lead.x_m - lead.length_m / 2.0, lead.y_m);
        let thin = Pen::new(MUTED, stroke::THIN).dashed(1.5, 1.5);
        for (x, bumper) in [from, to] {
            canvas.line((x, bumper), (x, y + 2.5), thin);
        }
        canvas.line((from.0, y), (to.0, y), Pen::new(INK, stroke::AXIS));
        let label = format!("*d*^{{(x)}} = {} m", number(gap, 1));
        let place = (f64::midpoint(from.0, to.0), y + 4.0);
        canvas.text(&label, place, Look::new(size::TICK).middle().hanging());
    }

    fn ruler(&self, canvas: &mut Canvas<'_>) {
        let (left, right, y) = (self.left, self.right, self.bottom() + 19.0);
        let pen = Pen::new(INK, stroke::AXIS);
        canvas.line((left, y), (right, y), pen);
        let look = Look::new(size::TICK).hanging().middle();
        for step in -2..=5 {
            let metres = f64::from(step) * 20.0;
            let x = left + (metres + BEHIND_M) * self.scale;
            canvas.line((x, y), (x, y + 2.0), pen);
            canvas.text(&number(metres, 0), (x, y + 4.5), look);
        }
        let title = Look::new(size::AXIS).middle();
        let place = (f64::midpoint(left, right), y + 21.0);
        canvas.text("Distance from the ego along the road (m)", place, title);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> SimulatorView {
        let vehicle = |x_m: f64, y_m: f64| VehicleView {
            x_m,
            y_m,
            heading_rad: 0.0,
            speed_mps: 25.0,
            length_m: 4.5,
            width_m: 1.9,
        };
        SimulatorView {
            participant: "P<07>".into(),
            condition: ConditionId::new("faster").unwrap(),
            time_s: 83.2,
            lanes: 2,
            lane_width_m: 3.66,
            ego: vehicle(2000.0, 0.0),
            others: vec![vehicle(2044.5, 0.0), vehicle(9000.0, 3.66)],
            reference: Some(0),
            trail_m: vec![],
            plan_m: vec![],
        }
    }

    #[test]
    fn the_gap_is_bumper_to_bumper_and_what_is_outside_is_counted() {
        let figure = simulator_view(&view(), &Context::real()).unwrap();
        assert!(figure.svg.contains("= 40.0 m"));
        assert!(figure.caption.contains("One more vehicle is outside"));
    }

    #[test]
    fn a_vehicle_nowhere_is_refused() {
        let mut input = view();
        input.others[1].y_m = f64::NAN;
        assert!(matches!(
            simulator_view(&input, &Context::real()),
            Err(ReportError::NotFinite { .. })
        ));
    }
}

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
    /// The ego.
    pub ego: VehicleView,
    /// The others.
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
        [
            self.x_m,
            self.y_m,
            self.heading_rad,
            self.speed_mps,
            self.length_m,
            self.width_m,
        ]
    }
}

const NAME: &str = "simulator-view";
const MPH_PER_MPS: f64 = 2.236_936_292_054_402;
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
    check.finite(
        "a vehicle",
        input.others.iter().flat_map(VehicleView::numbers),
    )?;
    let paths = input.trail_m.iter().chain(&input.plan_m);
    check.finite("a path", paths.flat_map(|place| [place.0, place.1]))?;
    let seen = |vehicle: &VehicleView| {
        let ahead = vehicle.x_m - input.ego.x_m;
        ahead - vehicle.length_m / 2.0 >= -BEHIND_M && ahead + vehicle.length_m / 2.0 <= AHEAD_M
    };
    let hidden = input.others.iter().filter(|vehicle| !seen(vehicle)).count();
    let reference = input.reference.and_then(|index| input.others.get(index));
    let gap = reference.map(|vehicle| {
        vehicle.x_m - input.ego.x_m - f64::midpoint(vehicle.length_m, input.ego.length_m)
    });
    let speed = number(input.ego.speed_mps * MPH_PER_MPS, 1);
    let condition = context.look(input.condition);
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (
            TWO_COLUMNS_MM,
            25.5 + STRETCH * input.lane_width_m * input.lanes as f64,
        ),
        title: "The simulator".to_owned(),
        caption: format!(
            "One moment of a simulated drive: participant {}, {}, {} s after the start. Speeds in \
             mph; widths are drawn {} times as large as lengths. Dashed: the ego’s trail and plan.{} \
             *n* = 1 drive; no test.",
            markup::literal(&input.participant),
            condition.words(),
            number(input.time_s, 1),
            number(STRETCH, 0),
            match hidden {
                0 => String::new(),
                1 => " One more vehicle is outside the picture.".to_owned(),
                more => format!(" {more} more vehicles are outside the picture."),
            }
        ),
        alt: match gap {
            Some(gap) => format!(
                "The ego drives {speed} mph, {} m from the reference vehicle; {} other vehicles.",
                number(gap, 1),
                input.others.len().saturating_sub(1)
            ),
            None => format!(
                "The ego drives {speed} mph without a reference vehicle; {} other vehicles.",
                input.others.len()
            ),
        },
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, place| {
        let scale = (place.right - place.left) / (BEHIND_M + AHEAD_M);
        let top = place.top + 14.0;
        let highest = (input.lanes as f64 - 0.5) * input.lane_width_m;
        let at = |x_m: f64, y_m: f64| {
            (
                place.left + (x_m - input.ego.x_m + BEHIND_M) * scale,
                top + (highest - y_m) * scale * STRETCH,
            )
        };
        paint_road(canvas, input, place.left, place.right, &|y_m| {
            at(0.0, y_m).1
        });
        for (path, pen) in [
            (
                &input.trail_m,
                Pen::new(GREY, stroke::STRONG).dashed(2.0, 2.0),
            ),
            (
                &input.plan_m,
                Pen::new(condition.rgb(), stroke::STRONG).dashed(4.0, 2.0),
            ),
        ] {
            let inside: Vec<(f64, f64)> = path
                .iter()
                .filter(|(x, _)| (-BEHIND_M..=AHEAD_M).contains(&(x - input.ego.x_m)))
                .map(|&(x, y)| at(x, y))
                .collect();
            canvas.path(&inside, pen);
        }
        // The plan leaves the ego's front, so its own label stands beside it: to the left, or to the right in the
        // leftmost lane.
        let leftmost = input.ego.y_m > (input.lanes as f64 - 1.25) * input.lane_width_m;
        let aside = if leftmost { 1.0 } else { -1.0 };
        let mut paint = |vehicle: &VehicleView, ink: RGBColor, is_ego: bool| {
            let centre = at(vehicle.x_m, vehicle.y_m);
            let length = vehicle.length_m * scale;
            let width = vehicle.width_m * scale * STRETCH;
            paint_vehicle(canvas, centre, (length, width), vehicle.heading_rad, ink);
            let speed = number(vehicle.speed_mps * MPH_PER_MPS, 0);
            if is_ego {
                let label = format!("{speed} mph");
                let look = Look::new(size::TICK).centred().middle();
                let at = (centre.0, centre.1 + aside * (width / 2.0 + 6.0));
                let half = look.width(&label) / 2.0 + 1.5;
                let corners = ((at.0 - half, at.1 - 4.5), (at.0 + half, at.1 + 4.5));
                canvas.fill_rect(corners.0, corners.1, ROAD, 1.0);
                canvas.text(&label, at, look);
                return;
            }
            let label = speed;
            let right = centre.0 + length / 2.0 + 3.0;
            let look = Look::new(size::TICK).centred();
            // A plan may run through here: the label gets its own ground.
            let corner = (right + look.width(&label) + 1.5, centre.1 + 4.5);
            canvas.fill_rect((right - 1.5, centre.1 - 4.5), corner, ROAD, 1.0);
            canvas.text(&label, (right, centre.1), look);
        };
        for (index, vehicle) in input.others.iter().enumerate().filter(|(_, v)| seen(v)) {
            let is_reference = input.reference == Some(index);
            paint(vehicle, if is_reference { GREY } else { PAPER }, false);
        }
        paint(&input.ego, condition.rgb(), true);
        let bottom = at(0.0, -input.lane_width_m / 2.0).1;
        if let (Some(vehicle), Some(gap)) =
            (reference.filter(|v| seen(v)), gap.filter(|gap| *gap > 0.0))
        {
            let y = bottom + 6.0;
            let from = at(input.ego.x_m + input.ego.length_m / 2.0, 0.0).0;
            let to = at(vehicle.x_m - vehicle.length_m / 2.0, 0.0).0;
            let pen = Pen::new(INK, stroke::AXIS);
            for (x, vehicle_y) in [(from, input.ego.y_m), (to, vehicle.y_m)] {
                canvas.line(
                    (x, at(0.0, vehicle_y).1),
                    (x, y + 2.5),
                    Pen::new(MUTED, stroke::THIN).dashed(1.5, 1.5),
                );
            }
            canvas.line((from, y), (to, y), pen);
            let label = format!("*d*^{{(x)}} = {} m", number(gap, 1));
            let label_at = (f64::midpoint(from, to), y + 4.0);
            canvas.text(&label, label_at, Look::new(size::TICK).middle().hanging());
        }
        paint_ruler(canvas, place.left, place.right, bottom + 19.0, scale);
        let head = format!("{}, {} s", condition.words(), number(input.time_s, 1));
        let y = place.top + cap_height(size::TITLE);
        canvas.text(&head, (place.left, y), Look::new(size::TITLE).semibold());
        canvas.text(
            "driving direction →",
            (place.right, y),
            Look::new(size::TICK).end().colour(MUTED),
        );
    })
}

fn paint_road(
    canvas: &mut Canvas<'_>,
    input: &SimulatorView,
    left: f64,
    right: f64,
    y: &dyn Fn(f64) -> f64,
) {
    let edge_m = |line: usize| (line as f64 - 0.5) * input.lane_width_m;
    let (low, high) = (y(edge_m(0)), y(edge_m(input.lanes)));
    canvas.fill_rect((left, high), (right, low), ROAD, 1.0);
    let pen = Pen::new(LANE_LINE, stroke::STRONG);
    for line in 0..=input.lanes {
        let y = y(edge_m(line));
        let inner = line > 0 && line < input.lanes;
        canvas.line(
            (left, y),
            (right, y),
            if inner { pen.dashed(8.5, 12.0) } else { pen },
        );
    }
}

fn paint_ruler(canvas: &mut Canvas<'_>, left: f64, right: f64, y: f64, scale: f64) {
    let pen = Pen::new(INK, stroke::AXIS);
    canvas.line((left, y), (right, y), pen);
    let look = Look::new(size::TICK).hanging().middle();
    for step in -2..=5 {
        let metres = f64::from(step) * 20.0;
        let x = left + (metres + BEHIND_M) * scale;
        canvas.line((x, y), (x, y + 2.0), pen);
        canvas.text(&number(metres, 0), (x, y + 4.5), look);
    }
    let title = Look::new(size::AXIS).middle();
    canvas.text(
        "Distance from the ego along the road (m)",
        (f64::midpoint(left, right), y + 21.0),
        title,
    );
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

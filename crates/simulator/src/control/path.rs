//! Where the car steers: a lane's centre, or a Bezier curve to another's, by Stanley's rule.

use super::action::Manoeuvre;
use crate::{
    road::CentreLine,
    vehicle::{Pose, Vehicle},
};

/// Share of the length at each end over which the curve leaves and meets its lanes.
const HANDLE: f64 = 0.45;
/// A change is no shorter than this, in m, however slow the car: it may speed up on the way, and a path over half as long is so
/// steep that wheels of limited rate swing across both lanes.
const SHORTEST_M: f64 = 30.0;
/// Speed added in Stanley's denominator, so that a slow car does not steer wildly, in m/s.
const SOFTENING_MPS: f64 = 1.0;

/// A cubic Bezier curve from a pose to the centre line of a lane.
#[derive(Debug, Clone, Copy)]
struct Bezier {
    x: [f64; 4],
    y: [f64; 4],
}

impl Bezier {
    fn new(from: (f64, f64), heading_rad: f64, length_m: f64, target_y_m: f64) -> Self {
        let handle = HANDLE * length_m;
        let end = from.0 + length_m;
        Self {
            x: [from.0, from.0 + handle * libm::cos(heading_rad), end - handle, end],
            y: [from.1, from.1 + handle * libm::sin(heading_rad), target_y_m, target_y_m],
        }
    }

    fn value(p: &[f64; 4], s: f64) -> f64 {
        let r = 1.0 - s;
        r * r * r * p[0] + 3.0 * r * r * s * p[1] + 3.0 * r * s * s * p[2] + s * s * s * p[3]
    }

    fn slope(p: &[f64; 4], s: f64) -> f64 {
        let r = 1.0 - s;
        3.0 * (r * r * (p[1] - p[0]) + 2.0 * r * s * (p[2] - p[1]) + s * s * (p[3] - p[2]))
    }

    /// Lateral position (m) and heading (rad) of the curve at `x_m`.
    fn at(&self, x_m: f64) -> (f64, f64) {
        if x_m >= self.x[3] {
            return (self.y[3], 0.0);
        }
        // x rises with s, so halving always finds it; 24 halvings are micrometres.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            if Self::value(&self.x, middle) < x_m {
                low = middle;
            } else {
                high = middle;
            }
        }
        let s = 0.5 * (low + high);
        let heading = libm::atan2(Self::slope(&self.y, s), Self::slope(&self.x, s));
        (Self::value(&self.y, s), heading)
    }
}

/// What a lane change looks like from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathShape {
    /// A cubic Bezier curve: the automated car's and the usual people's.
    Bezier,
    /// The course of an even movement of the hand, crossing the line late where `lateness` is above 1.
    Eased {
        /// Exponent on the share of the change that lies behind.
        lateness: f64,
    },
}

/// A lane change whose lateral position follows the quintic of least jerk, in a share that is bent by an exponent.
#[derive(Debug, Clone, Copy)]
struct Eased {
    from: (f64, f64),
    to: (f64, f64),
    lateness: f64,
}

impl Eased {
    fn at(&self, x_m: f64) -> (f64, f64) {
        let length_m = self.to.0 - self.from.0;
        let share = ((x_m - self.from.0) / length_m).clamp(0.0, 1.0);
        if share <= 0.0 || share >= 1.0 {
            let y_m = if share <= 0.0 { self.from.1 } else { self.to.1 };
            return (y_m, 0.0);
        }
        let s = libm::pow(share, self.lateness);
        let ds = self.lateness * s / share / length_m;
        let across = self.to.1 - self.from.1;
        let y_m = self.from.1 + across * s * s * s * (10.0 + s * (6.0 * s - 15.0));
        let slope = across * 30.0 * s * s * (1.0 - s) * (1.0 - s) * ds;
        (y_m, libm::atan(slope))
    }
}

#[derive(Debug, Clone, Copy)]
enum Curve {
    Bezier(Bezier),
    Eased(Eased),
}

impl Curve {
    fn at(&self, x_m: f64) -> (f64, f64) {
        match self {
            Self::Bezier(curve) => curve.at(x_m),
            Self::Eased(curve) => curve.at(x_m),
        }
    }

    fn end_x_m(&self) -> f64 {
        match self {
            Self::Bezier(curve) => curve.x[3],
            Self::Eased(curve) => curve.to.0,
        }
    }
}

/// A lane change under way.
#[derive(Debug, Clone, Copy)]
struct Change {
    from: u8,
    start_x_m: f64,
    curve: Curve,
}

/// Keeps the lane, or carries out a change.
#[derive(Debug, Clone)]
pub struct Steering {
    lane_width_m: f64,
    gain_per_s: f64,
    lane: u8,
    shape: PathShape,
    offset_m: f64,
    change: Option<Change>,
}

impl Steering {
    /// Keeps `lane` (the right one is 0) on lanes of this width (m); `gain_per_s` is Stanley's gain on the distance to the path.
    pub fn new(lane_width_m: f64, gain_per_s: f64, lane: u8, shape: PathShape) -> Self {
        Self { lane_width_m, gain_per_s, lane, shape, offset_m: 0.0, change: None }
    }

    /// The lane kept, or the one a change goes to.
    pub fn lane(&self) -> u8 {
        self.lane
    }

    /// The lane a change under way came from.
    pub fn coming_from(&self) -> Option<u8> {
        self.change.map(|change| change.from)
    }

    /// How much of the change under way lies behind, 0 to 1, at `x_m`.
    pub fn progress(&self, x_m: f64) -> Option<f64> {
        self.change.map(|change| {
            let length = change.curve.end_x_m() - change.start_x_m;
            ((x_m - change.start_x_m) / length).clamp(0.0, 1.0)
        })
    }

    /// Control points of the Bezier curve under way, in m.
    pub fn path_m(&self) -> Option<[(f64, f64); 4]> {
        match self.change?.curve {
            Curve::Bezier(curve) => Some(std::array::from_fn(|i| (curve.x[i], curve.y[i]))),
            Curve::Eased(_) => None,
        }
    }

    /// Where in its lane the car drives from now on, in m to the left of the centre.
    pub fn drive_at(&mut self, offset_m: f64) {
        self.offset_m = offset_m;
    }

    /// Begins what the driver asks, from where the car is.
    pub fn begin(&mut self, manoeuvre: Manoeuvre, car: Pose) {
        let (lane, duration_s) = match manoeuvre {
            Manoeuvre::Change { lane, duration_s } => (lane, duration_s),
            Manoeuvre::GoBack { duration_s } => match self.change {
                Some(change) => (change.from, duration_s),
                None => return,
            },
        };
        let length_m = (car.speed_mps * duration_s).max(SHORTEST_M);
        let target_y_m = f64::from(lane) * self.lane_width_m;
        let from = (car.x_m, car.y_m - self.offset_m);
        let curve = match self.shape {
            PathShape::Bezier => {
                Curve::Bezier(Bezier::new(from, car.heading_rad, length_m, target_y_m))
            }
            PathShape::Eased { lateness } => {
                Curve::Eased(Eased { from, to: (from.0 + length_m, target_y_m), lateness })
            }
        };
        self.change = Some(Change { from: self.lane, start_x_m: car.x_m, curve });
        self.lane = lane;
    }

    /// Lateral position (m) and heading (rad) of the path at `x_m`.
    pub fn path_at(&self, x_m: f64) -> (f64, f64) {
        let (y_m, heading_rad) = match &self.change {
            Some(change) => change.curve.at(x_m),
            None => (f64::from(self.lane) * self.lane_width_m, 0.0),
        };
        (y_m + self.offset_m, heading_rad)
    }

    /// Angle of the front wheels, in rad, positive to the left: Stanley's rule at the front axle. To be asked at every step: it also
    /// ends a change that is done.
    ///
    /// # Source
    /// Snider 2009, section 2.3: heading error plus atan(k e / v); plus the slip of the front tyres in the road's bend (ours),
    /// without which a car with tyres runs wide.
    pub fn angle_rad(&mut self, car: &dyn Vehicle, line: &CentreLine) -> f64 {
        let axle = car.front_axle(line);
        let pose = car.pose();
        if self.change.is_some_and(|c| pose.x_m >= c.curve.end_x_m()) {
            self.change = None;
        }
        let (path_y, path_heading) = self.path_at(axle.x_m);
        let error = (path_y - axle.y_m) * libm::cos(path_heading);
        let pull = libm::atan2(self.gain_per_s * error, pose.speed_mps + SOFTENING_MPS);
        let slip = car.front_slip_rad(line.curvature_per_m(pose.x_m));
        path_heading - axle.heading_rad + pull + slip
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        scenario::{Scenario, VehicleModel, VehicleSettings},
        vehicle::{Command, build},
    };

    fn cars(speed_mps: f64) -> [Box<dyn Vehicle>; 2] {
        [VehicleModel::Kinematic, VehicleModel::Dynamic].map(|model| {
            let settings =
                VehicleSettings { model, ..Scenario::paper().settings().vehicle.clone() };
            build(&settings, 0.0, speed_mps)
        })
    }

    fn drive(car: &mut dyn Vehicle, steering: &mut Steering, seconds: f64) -> f64 {
        let mut furthest = f64::MIN;
        let line = CentreLine::default();
        for _ in 0..(seconds * 100.0) as usize {
            let steering_rad = steering.angle_rad(car, &line);
            let command = Command { acceleration_mps2: 0.0, steering_rad };
            car.step(command, &line);
            furthest = furthest.max(car.pose().y_m);
        }
        furthest
    }

    const OUT: Manoeuvre = Manoeuvre::Change { lane: 1, duration_s: 4.8 };

    #[test]
    fn a_lane_change_ends_in_the_lane_centre_without_swinging_past_it() {
        for (speed, duration_s) in [(15.0, 4.8), (30.0, 4.8), (38.0, 2.5), (30.0, 2.5)] {
            for mut car in cars(speed) {
                let mut steering = Steering::new(3.66, 1.5, 0, PathShape::Bezier);
                let out = Manoeuvre::Change { lane: 1, duration_s };
                steering.begin(out, car.pose());
                let furthest = drive(car.as_mut(), &mut steering, duration_s + 4.0);
                let end = car.pose();
                assert!((end.y_m - 3.66).abs() < 0.05, "{speed} {duration_s}: {}", end.y_m);
                assert!(furthest < 3.66 + 0.35, "{speed} {duration_s}: {furthest}");
                assert!(end.heading_rad.abs() < 0.005 && steering.coming_from().is_none());
            }
        }
    }

    #[test]
    fn an_eased_change_crosses_the_line_late_and_ends_where_the_car_drives_in_its_lane() {
        let crossing = |lateness| {
            let mut car = cars(30.0).into_iter().next().unwrap();
            let mut steering = Steering::new(3.66, 1.5, 0, PathShape::Eased { lateness });
            steering.drive_at(0.2);
            drive(car.as_mut(), &mut steering, 6.0);
            assert!((car.pose().y_m - 0.2).abs() < 0.02);
            steering.begin(OUT, car.pose());
            let mut seconds = 0.0;
            while car.pose().y_m < 1.83 {
                drive(car.as_mut(), &mut steering, 0.05);
                seconds += 0.05;
            }
            let furthest = drive(car.as_mut(), &mut steering, 6.0);
            assert!((car.pose().y_m - 3.86).abs() < 0.05 && furthest < 4.2);
            seconds
        };
        let (early, late) = (crossing(0.7), crossing(1.4));
        assert!(early < 2.3 && late > 2.6 && late < 4.0, "{early} {late}");
    }

    #[test]
    fn a_change_given_up_halfway_ends_in_the_lane_it_came_from() {
        for mut car in cars(30.0) {
            let mut steering = Steering::new(3.66, 1.5, 0, PathShape::Bezier);
            steering.begin(OUT, car.pose());
            drive(car.as_mut(), &mut steering, 2.0);
            assert!(car.pose().y_m > 0.5);
            steering.begin(Manoeuvre::GoBack { duration_s: 3.0 }, car.pose());
            drive(car.as_mut(), &mut steering, 8.0);
            assert!(car.pose().y_m.abs() < 0.05 && steering.lane() == 0);
        }
    }

    #[test]
    fn the_front_axle_stays_within_decimetres_of_the_path_at_every_speed() {
        const STEP_S: f64 = 0.01;
        let line = CentreLine::default();
        for speed in [15.0, 25.0, 35.0] {
            for (mut car, within_m) in cars(speed).into_iter().zip([0.1, 0.25]) {
                let mut steering = Steering::new(3.66, 1.5, 0, PathShape::Bezier);
                steering.begin(OUT, car.pose());
                let mut y_m = Vec::new();
                for _ in 0..1400 {
                    let axle = car.front_axle(&line);
                    let error_m = axle.y_m - steering.path_at(axle.x_m).0;
                    assert!(error_m.abs() < within_m, "{speed}: {error_m}");
                    y_m.push(car.pose().y_m);
                    drive(car.as_mut(), &mut steering, STEP_S);
                }
                let second = |w: &[f64]| (w[2] - 2.0 * w[1] + w[0]) / (STEP_S * STEP_S);
                let acceleration: Vec<f64> = y_m.windows(3).map(second).collect();
                assert!(acceleration.iter().all(|a| a.abs() < 2.0), "{speed}");
                // Over a tenth of a second.
                let jerk = acceleration.iter().zip(&acceleration[10..]);
                assert!(jerk.clone().all(|(a, b)| (b - a).abs() / 0.1 < 20.0), "{speed}");
            }
        }
    }
}

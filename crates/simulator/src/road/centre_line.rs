//! The centre line of lane 0: curvature, heading and place on a map at every x.

use super::Segment;

/// The centre line of lane 0, on which x is measured and from which y is.
///
/// Straight without segments. Its segments repeat, forward and backward, as often as a drive needs.
///
/// # Source
/// Curvature is piecewise linear in x: 0 on a straight, constant on an arc, linear on a clothoid. A vehicle at (x, y) with
/// speed v and heading ψ relative to the road has x' = v cos ψ / (1 − κ y), y' = v sin ψ, and the road turns under it by
/// κ x': Snider 2009, section 2.2, and the lane-based coordinates of Shalev-Shwartz et al. 2017, section 3.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CentreLine {
    pieces: Vec<Piece>,
    length_m: f64,
    turn_rad: f64,
}

/// A pose in the plane of the map: x east, y north at the start of the road, heading counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MapPose {
    /// Position, in m.
    pub x_m: f64,
    /// Position, in m.
    pub y_m: f64,
    /// In rad from x; not wrapped to one turn.
    pub heading_rad: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    from_m: f64,
    length_m: f64,
    starts_per_m: f64,
    rises_per_m2: f64,
    pose: MapPose,
}

impl Piece {
    fn curvature(&self, along_m: f64) -> f64 {
        self.starts_per_m + self.rises_per_m2 * along_m
    }

    fn turned(&self, along_m: f64) -> f64 {
        along_m * (self.starts_per_m + 0.5 * self.rises_per_m2 * along_m)
    }

    /// Pose after `along_m`: the heading in closed form, the position by Gauss-Legendre quadrature of its direction.
    fn after(&self, along_m: f64) -> MapPose {
        // At most a fifth of a radian a panel: three points are then exact to 1e-9 of its length.
        let panels = (self.turned(along_m).abs() / 0.2)
            .max(self.largest_per_m() * along_m / 0.2)
            .ceil()
            .max(1.0);
        let width = along_m / panels;
        let (mut x, mut y) = (0.0, 0.0);
        for panel in 0..panels as usize {
            for (node, weight) in GAUSS {
                let node_m = width * (panel as f64 + node);
                let (sin, cos) = libm::sincos(self.pose.heading_rad + self.turned(node_m));
                x += weight * cos;
                y += weight * sin;
            }
        }
        MapPose {
            x_m: self.pose.x_m + width * x,
            y_m: self.pose.y_m + width * y,
            heading_rad: self.pose.heading_rad + self.turned(along_m),
        }
    }

    fn largest_per_m(&self) -> f64 {
        let end = self.curvature(self.length_m);
        self.starts_per_m.abs().max(end.abs())
    }
}

/// Nodes and weights of three-point Gauss-Legendre quadrature over 0 to 1.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

impl CentreLine {
    /// The line made of `segments`, which have been checked.
    pub(crate) fn new(segments: &[Segment]) -> Self {
        let mut line = Self::default();
        let mut before_per_m = segments.last().map_or(0.0, Segment::ends_per_m);
        let mut pose = MapPose::default();
        for segment in segments {
            let length_m = segment.length_m();
            let starts_per_m = segment.starts_per_m(before_per_m);
            before_per_m = segment.ends_per_m();
            let piece = Piece {
                from_m: line.length_m,
                length_m,
                starts_per_m,
                rises_per_m2: (before_per_m - starts_per_m) / length_m,
                pose,
            };
            pose = piece.after(length_m);
            line.length_m += length_m;
            line.pieces.push(piece);
        }
        line.turn_rad = pose.heading_rad;
        line
    }

    /// Whether the road is straight everywhere.
    pub fn is_straight(&self) -> bool {
        self.pieces.iter().all(|piece| piece.largest_per_m() == 0.0)
    }

    /// The lap that `x_m` is in, the piece, and how far into it.
    fn find(&self, x_m: f64) -> Option<(f64, usize, f64)> {
        if self.pieces.is_empty() {
            return None;
        }
        let lap = (x_m / self.length_m).floor();
        let within = (x_m - lap * self.length_m).clamp(0.0, self.length_m);
        let next = self.pieces.partition_point(|piece| piece.from_m <= within);
        let index = next.saturating_sub(1);
        Some((lap, index, within - self.pieces[index].from_m))
    }

    /// Curvature κ at `x_m`, in 1/m; positive to the left.
    pub fn curvature_per_m(&self, x_m: f64) -> f64 {
        self.find(x_m).map_or(0.0, |(_, i, along)| self.pieces[i].curvature(along))
    }

    /// Heading at `x_m`, in rad, 0 at the start, counter-clockwise and not wrapped.
    pub fn heading_rad(&self, x_m: f64) -> f64 {
        self.find(x_m).map_or(0.0, |(lap, i, along)| {
            let piece = &self.pieces[i];
            lap * self.turn_rad + piece.pose.heading_rad + piece.turned(along)
        })
    }

    /// Where (x, y) of the road lies on the map, and which way the road runs there.
    ///
    /// A road whose laps meet, such as a ring, comes back to where it was.
    ///
    /// # Example
    /// ```
    /// # use maveric_simulator::Scenario;
    /// let pose = Scenario::paper().centre_line().map_pose(120.0, 3.66);
    /// assert!((pose.x_m - 120.0).abs() < 1e-12 && (pose.y_m - 3.66).abs() < 1e-12);
    /// ```
    pub fn map_pose(&self, x_m: f64, y_m: f64) -> MapPose {
        let centre = match self.find(x_m) {
            None => MapPose { x_m, ..MapPose::default() },
            Some((lap, i, along)) => {
                let start = self.lap_start(lap);
                let local = self.pieces[i].after(along);
                let (sin, cos) = libm::sincos(start.heading_rad);
                MapPose {
                    x_m: start.x_m + cos * local.x_m - sin * local.y_m,
                    y_m: start.y_m + sin * local.x_m + cos * local.y_m,
                    heading_rad: start.heading_rad + local.heading_rad,
                }
            }
        };
        let (sin, cos) = libm::sincos(centre.heading_rad);
        MapPose { x_m: centre.x_m - y_m * sin, y_m: centre.y_m + y_m * cos, ..centre }
    }

    /// Pose at the start of a lap: the lap's own displacement, turned by every lap before it, summed.
    fn lap_start(&self, lap: f64) -> MapPose {
        let Some(last) = self.pieces.last() else {
            return MapPose::default();
        };
        let end = last.after(last.length_m);
        let mut pose = MapPose::default();
        let forward = lap >= 0.0;
        for k in 0..lap.abs() as usize {
            let turn =
                if forward { k as f64 * self.turn_rad } else { -(k as f64 + 1.0) * self.turn_rad };
            let (sin, cos) = libm::sincos(turn);
            let sign = if forward { 1.0 } else { -1.0 };
            pose.x_m += sign * (cos * end.x_m - sin * end.y_m);
            pose.y_m += sign * (sin * end.x_m + cos * end.y_m);
        }
        pose.heading_rad = lap * self.turn_rad;
        pose
    }

    /// How far a metre at lateral position `y_m` carries along x: 1 / (1 − κ y).
    pub fn stretch(&self, x_m: f64, y_m: f64) -> f64 {
        1.0 / (1.0 - self.curvature_per_m(x_m) * y_m)
    }

    /// x of a point as seen from `from_m`, such that differences of x are lengths along the point's own lane, in m.
    ///
    /// The length of the lane at lateral position y between two x is Δx − y Δθ, exactly, however the road bends between.
    pub(crate) fn lane_x_m(&self, from_m: f64, x_m: f64, y_m: f64) -> f64 {
        if self.pieces.is_empty() {
            return x_m;
        }
        x_m - y_m * (self.heading_rad(x_m) - self.heading_rad(from_m))
    }

    /// Highest speed at `x_m`, in m/s, that keeps the lateral acceleration below `lateral_mps2` here and, braking with
    /// `braking_mps2`, in every bend ahead; infinite on a straight road.
    pub(crate) fn speed_limit_mps(&self, x_m: f64, lateral_mps2: f64, braking_mps2: f64) -> f64 {
        let Some((_, index, along)) = self.find(x_m) else {
            return f64::INFINITY;
        };
        let squared = |curvature: f64| {
            let curvature = curvature.abs();
            if curvature > 0.0 { lateral_mps2 / curvature } else { f64::INFINITY }
        };
        let mut lowest = squared(self.pieces[index].curvature(along));
        // Within a piece the tightest place is an end; looking a second lap ahead covers short ones.
        let mut ahead_m = self.pieces[index].length_m - along;
        for step in 1..=2 * self.pieces.len() {
            let before = &self.pieces[(index + step - 1) % self.pieces.len()];
            let after = &self.pieces[(index + step) % self.pieces.len()];
            let end = before.curvature(before.length_m).abs();
            let tightest = end.max(after.starts_per_m.abs());
            lowest = lowest.min(squared(tightest) + 2.0 * braking_mps2 * ahead_m);
            if ahead_m > HORIZON_M {
                break;
            }
            ahead_m += after.length_m;
        }
        lowest.sqrt()
    }
}

/// No bend further ahead slows a car down, in m: from 60 m/s to a stand at 3 m/s².
const HORIZON_M: f64 = 600.0;

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    const BEND: [Segment; 4] = [
        Segment::Straight { length_m: 300.0 },
        Segment::Clothoid { length_m: 120.0, to_radius_m: Some(400.0) },
        Segment::Arc { length_m: 250.0, radius_m: 400.0 },
        Segment::Clothoid { length_m: 120.0, to_radius_m: None },
    ];

    #[test]
    fn an_arc_ends_where_the_circle_does() {
        let quarter = 200.0 * FRAC_PI_2;
        let line = CentreLine::new(&[Segment::Arc { length_m: quarter, radius_m: 200.0 }]);
        let end = line.map_pose(quarter - 1e-9, 0.0);
        assert!((end.x_m - 200.0).abs() < 1e-6 && (end.y_m - 200.0).abs() < 1e-6);
        assert!((end.heading_rad - FRAC_PI_2).abs() < 1e-9);
        // Four laps of a quarter are a ring; so are laps driven backward.
        for laps in [4.0, 8.0, -4.0] {
            let round = line.map_pose(laps * quarter + 1e-9, 0.0);
            assert!(round.x_m.abs() < 1e-6 && round.y_m.abs() < 1e-6, "{round:?}");
        }
    }

    #[test]
    fn a_clothoid_is_the_fresnel_integral() {
        let (length, radius) = (150.0, 300.0);
        let line = CentreLine::new(&[
            Segment::Clothoid { length_m: length, to_radius_m: Some(radius) },
            Segment::Clothoid { length_m: length, to_radius_m: None },
        ]);
        let end = line.map_pose(length, 0.0);
        // Series of the Fresnel integrals with τ = L / 2R: x = L Σ (−1)ⁿ τ²ⁿ / ((4n+1)(2n)!), y likewise.
        let tau = length / (2.0 * radius);
        let (mut x, mut y, mut power, mut factorial) = (0.0, 0.0, 1.0, 1.0);
        for n in 0..8 {
            let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
            let n = f64::from(n);
            x += sign * power / ((4.0 * n + 1.0) * factorial);
            y += sign * power * tau / ((4.0 * n + 3.0) * factorial * (2.0 * n + 1.0));
            power *= tau * tau;
            factorial *= (2.0 * n + 1.0) * (2.0 * n + 2.0);
        }
        assert!((end.x_m - length * x).abs() < 1e-6, "{end:?} {x}");
        assert!((end.y_m - length * y).abs() < 1e-6, "{end:?} {y}");
        assert!((end.heading_rad - tau).abs() < 1e-12);
    }

    #[test]
    fn curvature_is_linear_on_a_clothoid_and_continuous_over_the_laps() {
        let line = CentreLine::new(&BEND);
        assert!((line.curvature_per_m(360.0) - 0.5 / 400.0).abs() < 1e-12);
        assert!((line.curvature_per_m(500.0) - 1.0 / 400.0).abs() < 1e-12);
        for x in 0..5000 {
            let x = f64::from(x) - 1000.0;
            let jump = line.curvature_per_m(x + 0.01) - line.curvature_per_m(x);
            assert!(jump.abs() < 1e-6, "{x}");
            let turn = (line.heading_rad(x + 0.01) - line.heading_rad(x)) / 0.01;
            assert!((turn - line.curvature_per_m(x + 0.005)).abs() < 1e-6);
        }
    }

    #[test]
    fn the_map_keeps_lengths_along_and_across() {
        let line = CentreLine::new(&BEND);
        for x in 0..300 {
            let x = 7.0 * f64::from(x) - 500.0;
            let (a, b) = (line.map_pose(x, 3.66), line.map_pose(x + 0.01, 3.66));
            let walked = (b.x_m - a.x_m).hypot(b.y_m - a.y_m);
            let stretch = line.stretch(x + 0.005, 3.66);
            assert!((walked * stretch - 0.01).abs() < 1e-7, "{x} {walked}");
            let middle = line.map_pose(x, 0.0);
            assert!(((a.x_m - middle.x_m).hypot(a.y_m - middle.y_m) - 3.66).abs() < 1e-9);
        }
    }

    #[test]
    fn lengths_along_a_lane_are_exact() {
        let line = CentreLine::new(&BEND);
        let (from, to, y) = (250.0, 820.0, 7.32);
        let mut walked = 0.0;
        for i in 0..57_000 {
            walked += 0.01 / line.stretch(from + 0.01 * (f64::from(i) + 0.5), y);
        }
        let lane = line.lane_x_m(from, to, y) - from;
        assert!((lane - walked).abs() < 1e-6, "{lane} {walked}");
        assert!(lane < to - from);
    }

    #[test]
    fn speed_falls_in_time_for_a_bend_and_rises_after_it() {
        let line = CentreLine::new(&BEND);
        let limit = |x| line.speed_limit_mps(x, 2.0, 1.5);
        assert!((limit(500.0) - 800.0_f64.sqrt()).abs() < 1e-9);
        assert!(limit(10.0) > 35.0 && limit(400.0) < 30.0);
        for x in 0..4000 {
            let (here, next) = (limit(f64::from(x)), limit(f64::from(x) + 1.0));
            if here.is_finite() && next.is_finite() {
                let braking = 0.5 * (here * here - next * next);
                assert!(braking < 1.5 + 1e-6, "{x}: {braking}");
            }
        }
        assert!(CentreLine::default().speed_limit_mps(0.0, 2.0, 1.5).is_infinite());
    }

    #[test]
    fn a_road_without_bends_is_straight() {
        let straight = CentreLine::new(&[Segment::Straight { length_m: 100.0 }]);
        assert!(straight.is_straight() && CentreLine::default().is_straight());
        assert!(!CentreLine::new(&BEND).is_straight());
        assert!((straight.map_pose(12_345.0, 1.0).x_m - 12_345.0).abs() < 1e-6);
        assert!(straight.heading_rad(PI).abs() < 1e-12);
    }
}

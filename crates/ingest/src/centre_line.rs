//! A road by the points along its right lane: from the log's frame to places along and beside it.

use crate::raw::RawDrive;

/// Segments whose bounds are looked at together.
const BLOCK: usize = 32;

/// A line through points.
pub(crate) struct CentreLine<'a> {
    points: &'a [[f64; 2]],
    /// Way from the first point to each.
    way_m: Vec<f64>,
    /// Least and greatest x and y of each block of segments.
    bounds: Vec<[f64; 4]>,
}

impl<'a> CentreLine<'a> {
    /// Takes two or more finite points, of which no two in a row are alike.
    pub(crate) fn new(points: &'a [[f64; 2]]) -> Self {
        let mut way_m = vec![0.0];
        for w in points.windows(2) {
            let so_far = way_m.last().copied().unwrap_or(0.0);
            way_m.push(so_far + libm::hypot(w[1][0] - w[0][0], w[1][1] - w[0][1]));
        }
        let segments = points.len().saturating_sub(1);
        let bounds = (0..segments).step_by(BLOCK).map(|first| {
            let within = &points[first..=(first + BLOCK).min(segments)];
            let extreme = |axis: usize, f: fn(f64, f64) -> f64, start| {
                within.iter().map(|p| p[axis]).fold(start, f)
            };
            [
                extreme(0, f64::min, f64::INFINITY),
                extreme(1, f64::min, f64::INFINITY),
                extreme(0, f64::max, f64::NEG_INFINITY),
                extreme(1, f64::max, f64::NEG_INFINITY),
            ]
        });
        Self { points, way_m, bounds: bounds.collect() }
    }

    /// Way along the line and distance to its left of a place, both in m; the first and last segment go on for ever.
    pub(crate) fn place(&self, x_m: f64, y_m: f64) -> (f64, f64) {
        let last = self.points.len().saturating_sub(2);
        let (mut nearest, mut place) = (f64::INFINITY, (f64::NAN, f64::NAN));
        for (block, [x0, y0, x1, y1]) in self.bounds.iter().enumerate() {
            let (dx, dy) = (x_m - x_m.clamp(*x0, *x1), y_m - y_m.clamp(*y0, *y1));
            let first = block * BLOCK;
            let end = (first + BLOCK).min(last + 1);
            // The ends go on beyond their bounds.
            if libm::hypot(dx, dy) > nearest && first != 0 && end != last + 1 {
                continue;
            }
            for i in first..end {
                let ([ax, ay], [bx, by]) = (self.points[i], self.points[i + 1]);
                let length = self.way_m[i + 1] - self.way_m[i];
                let (cos, sin) = ((bx - ax) / length, (by - ay) / length);
                let (px, py) = (x_m - ax, y_m - ay);
                let along = px * cos + py * sin;
                let least = if i == 0 { f64::NEG_INFINITY } else { 0.0 };
                let most = if i == last { f64::INFINITY } else { length };
                let kept = along.clamp(least, most);
                let left = py * cos - px * sin;
                let distance = libm::hypot(along - kept, left);
                if distance < nearest {
                    nearest = distance;
                    place = (self.way_m[i] + kept, distance.copysign(left));
                }
            }
        }
        place
    }

    /// Moves ego and the others into the frame of the road. Samples that are not finite stay so.
    pub(crate) fn straighten(&self, drive: &mut RawDrive) {
        drive.move_all(|x_m, y_m| self.place(x_m, y_m));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_on_a_bend_are_along_and_beside_it() {
        // A quarter of a circle of 200 m to the left, then straight on northwards.
        let mut points: Vec<[f64; 2]> = (0..=90)
            .map(|i| f64::from(i).to_radians())
            .map(|a| [200.0 * a.sin(), 200.0 * (1.0 - a.cos())])
            .collect();
        points.push([200.0, 400.0]);
        let line = CentreLine::new(&points);
        let at = |angle: f64, left: f64| {
            let (r, a) = (200.0 - left, angle.to_radians());
            line.place(r * a.sin(), 200.0 - r * a.cos())
        };
        for (angle, left) in [(10.0, 0.0), (33.3, 3.66), (71.0, -3.66)] {
            let (s, d) = at(angle, left);
            assert!((s - 200.0 * angle.to_radians()).abs() < 0.02, "{s}");
            assert!((d - left).abs() < 0.02, "{d}");
        }
        let (s, d) = line.place(197.0, 450.0);
        assert!((s - 564.15).abs() < 0.1 && (d - 3.0).abs() < 1e-9, "{s} {d}");
        let (s, d) = line.place(-10.0, 1.0);
        assert!(s < -9.0 && (d - 1.0).abs() < 0.1, "{s} {d}");
        assert!(line.place(f64::NAN, 0.0).0.is_nan());
    }
}

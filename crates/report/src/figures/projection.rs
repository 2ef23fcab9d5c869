//! A box in three dimensions on a flat page: orthographic, drawn back to front by the caller.

use super::prelude::*;

/// Looking from this many degrees above.
const ELEVATION_DEGREES: f64 = 22.0;
/// Room for tick labels and axis titles round the box, in points.
const RIM: f64 = 26.0;

/// How the box is looked at, and where it lies on the page.
#[derive(Debug, Clone)]
pub(crate) struct View {
    right: [f64; 3],
    up: [f64; 3],
    towards: [f64; 3],
    low: [f64; 3],
    high: [f64; 3],
    scales: [Scale; 3],
    centre: [f64; 3],
    origin: (f64, f64),
    points_per_unit: f64,
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Length of the shortest axis, as a share of the longest.
const LEAST_SHARE: f64 = 0.25;

impl View {
    /// Fits the box of all points into a place, turned so that `shown` is seen well.
    pub(crate) fn fit(points: &[[f64; 3]], shown: [f64; 3], place: Place) -> Self {
        let ends = [0, 1, 2].map(|axis: usize| extent(points.iter().map(|w| w[axis])));
        let widest = ends.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
        let scales = [0, 1, 2].map(|axis: usize| {
            let (low, high) = ends[axis];
            let (middle, half) = (f64::midpoint(low, high), 0.5 * LEAST_SHARE * widest);
            // An axis along which hardly anything lies apart still has a length, and room for its numbers.
            if high - low < 2.0 * half {
                Scale::between(middle - half, middle + half, 1)
            } else {
                Scale::over([low, high], 4)
            }
        });
        let low = [0, 1, 2].map(|axis: usize| scales[axis].ends().0);
        let high = [0, 1, 2].map(|axis: usize| scales[axis].ends().1);
        let centre = [0, 1, 2].map(|axis: usize| f64::midpoint(low[axis], high[axis]));
        let seen = |azimuth: f64| {
            let (right, up, _) = axes(azimuth);
            libm::hypot(dot(right, shown), dot(up, shown))
        };
        // Not at its longest: then all that lies across it would be seen edge on.
        let off = |azimuth: f64| (seen(azimuth) - 0.8).abs();
        let azimuth = (0..=10)
            .map(|step| -70.0 + 5.0 * f64::from(step))
            .min_by(|a, b| off(*a).total_cmp(&off(*b)))
            .unwrap_or(-45.0);
        let (right, up, towards) = axes(azimuth);
        let mut view = Self {
            right,
            up,
            towards,
            low,
            high,
            scales,
            centre,
            origin: (0.0, 0.0),
            points_per_unit: 1.0,
        };
        let corners: Vec<(f64, f64)> = (0..8).map(|k| view.project(view.corner(k)).0).collect();
        let x = extent(corners.iter().map(|corner| corner.0));
        let y = extent(corners.iter().map(|corner| corner.1));
        let (wide, tall) =
            (place.right - place.left - 2.0 * RIM, place.bottom - place.top - 1.5 * RIM);
        view.points_per_unit = (wide / (x.1 - x.0)).min(tall / (y.1 - y.0));
        let scale = view.points_per_unit;
        view.origin = (
            f64::midpoint(place.left, place.right) + 0.2 * RIM - scale * f64::midpoint(x.0, x.1),
            f64::midpoint(place.top, place.bottom) - 0.4 * RIM - scale * f64::midpoint(y.0, y.1),
        );
        view
    }

    fn corner(&self, index: usize) -> [f64; 3] {
        [0, 1, 2].map(
            |axis: usize| {
                if index >> axis & 1 == 0 { self.low[axis] } else { self.high[axis] }
            },
        )
    }

    /// Place on the page in points, and depth: greater is nearer.
    pub(crate) fn project(&self, w: [f64; 3]) -> ((f64, f64), f64) {
        let centred = [0, 1, 2].map(|axis: usize| w[axis] - self.centre[axis]);
        let scale = self.points_per_unit;
        let x = self.origin.0 + scale * dot(centred, self.right);
        let y = self.origin.1 - scale * dot(centred, self.up);
        ((x, y), dot(centred, self.towards))
    }

    /// Longest diagonal of the box: nothing is nearer than another thing by more.
    pub(crate) fn size(&self) -> f64 {
        (0..3).map(|axis: usize| (self.high[axis] - self.low[axis]).powi(2)).sum::<f64>().sqrt()
    }

    /// From where to where a line through `centre` runs inside the box, in units of `unit`.
    pub(crate) fn chord(&self, centre: [f64; 3], unit: [f64; 3]) -> (f64, f64) {
        let mut range = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            if unit[axis].abs() > 1e-12 {
                let a = (self.low[axis] - centre[axis]) / unit[axis];
                let b = (self.high[axis] - centre[axis]) / unit[axis];
                range = (range.0.max(a.min(b)), range.1.min(a.max(b)));
            }
        }
        range
    }
}

fn axes(azimuth_degrees: f64) -> ([f64; 3], [f64; 3], [f64; 3]) {
    let (sin_a, cos_a) = libm::sincos(azimuth_degrees.to_radians());
    let (sin_e, cos_e) = libm::sincos(ELEVATION_DEGREES.to_radians());
    let right = [-sin_a, cos_a, 0.0];
    let up = [-sin_e * cos_a, -sin_e * sin_a, cos_e];
    let towards = [cos_e * cos_a, cos_e * sin_a, sin_e];
    (right, up, towards)
}

/// Draws the three far faces with their grids, ticks and axis titles.
pub(crate) fn paint_box(canvas: &mut Canvas<'_>, view: &View, titles: [&str; 3]) {
    let (grid, edge) = (Pen::new(GRID, stroke::THIN), edge());
    for face in 0..3 {
        let (j, k) = ((face + 1) % 3, (face + 2) % 3);
        for (across, along) in [(j, k), (k, j)] {
            let line = |value: f64| {
                let mut from = [0.0; 3];
                from[face] = view.ends(face).1;
                from[across] = value;
                let mut to = from;
                from[along] = view.low[along];
                to[along] = view.high[along];
                (view.project(from).0, view.project(to).0)
            };
            for &tick in &view.scales[across].ticks {
                let (from, to) = line(tick);
                canvas.line(from, to, grid);
            }
            for end in [view.low[across], view.high[across]] {
                let (from, to) = line(end);
                canvas.line(from, to, edge);
            }
        }
    }
    for (axis, title) in titles.into_iter().enumerate() {
        paint_axis(canvas, view, axis, title);
    }
}

fn edge() -> Pen {
    Pen::new(GREY, stroke::AXIS)
}

impl View {
    /// The nearer and the farther end of an axis.
    fn ends(&self, axis: usize) -> (f64, f64) {
        let (low, high) = (self.low[axis], self.high[axis]);
        if self.towards[axis] > 0.0 { (high, low) } else { (low, high) }
    }

    /// A point of the edge that carries an axis's numbers: a near one on the floor, the leftmost upright one.
    fn numbered_edge(&self, axis: usize) -> [f64; 3] {
        let mut base = [0.0; 3];
        if axis < 2 {
            base[1 - axis] = self.ends(1 - axis).0;
            base[2] = self.low[2];
            return base;
        }
        let left = |k: &usize| self.project(self.corner(*k)).0.0;
        let leftmost = (0..4).min_by(|a, b| left(a).total_cmp(&left(b)));
        self.corner(leftmost.unwrap_or(0))
    }
}

/// An axis with its numbers and its title, beside the box.
fn paint_axis(canvas: &mut Canvas<'_>, view: &View, axis: usize, title: &str) {
    let upright = axis == 2;
    let base = view.numbered_edge(axis);
    let point = |value: f64| {
        let mut w = base;
        w[axis] = value;
        view.project(w).0
    };
    let (middle, centre) = (view.project(view.centre).0, point(view.centre[axis]));
    let (dx, dy) =
        if upright { (-1.0, 0.0) } else { (centre.0 - middle.0, (centre.1 - middle.1).max(1.0)) };
    let length = libm::hypot(dx, dy);
    let beside = |(x, y): (f64, f64), gap: f64| (x + gap * dx / length, y + gap * dy / length);
    canvas.line(point(view.low[axis]), point(view.high[axis]), edge());
    let look = Look::new(size::TICK).centred();
    let (look, gap) = if upright { (look.end(), 4.0) } else { (look.middle(), 8.0) };
    // A short axis, or one seen from its end, has room for some of its numbers only.
    let mut last: Option<((f64, f64), f64)> = None;
    let Scale { ticks, labels, .. } = &view.scales[axis];
    for (&tick, label) in ticks.iter().zip(labels) {
        let (x, y) = point(tick);
        canvas.line((x, y), beside((x, y), 2.0), edge());
        let width = look.width(label);
        let meets = last.is_some_and(|((from, height), of)| {
            let across = if upright { 0.0 } else { f64::midpoint(of, width) };
            (x - from).abs() <= across + 2.0 && (y - height).abs() < 1.4 * size::TICK
        });
        if !meets {
            last = Some(((x, y), width));
            canvas.text(label, beside((x, y), gap), look);
        }
    }
    let look = Look::new(size::AXIS + 0.5).middle().centred();
    canvas.text(title, beside(centre, 21.0), look);
}

#[cfg(test)]
mod tests {
    use super::*;
    const PLACE: Place = Place { left: 40.0, top: 20.0, right: 340.0, bottom: 260.0 };

    fn view() -> View {
        let points = [[0.0, -1.0, 10.0], [4.0, 3.0, 12.0], [2.0, 0.0, 14.0]];
        View::fit(&points, [1.0, 0.5, 0.25], PLACE)
    }

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
    }

    #[test]
    fn page_and_depth_keep_every_distance() {
        let view = view();
        let scale = view.points_per_unit;
        let points = [
            [0.0, 0.0, 10.0],
            [1.0, 0.0, 10.0],
            [1.0, 2.0, 10.0],
            [1.0, 2.0, 13.0],
            [-3.0, 0.5, 11.0],
        ];
        for (i, a) in points.iter().enumerate() {
            for b in &points[i + 1..] {
                let ((x, y), depth) = view.project(*a);
                let ((u, v), far) = view.project(*b);
                let seen =
                    ((x - u).powi(2) + (y - v).powi(2)) / (scale * scale) + (depth - far).powi(2);
                let apart: f64 = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum();
                near(seen, apart);
            }
        }
        // What is higher lies higher on the page, and nearer for who looks from above.
        let (low, high) = (view.project([1.0, 1.0, 10.0]), view.project([1.0, 1.0, 11.0]));
        assert!(high.0.1 < low.0.1 && high.1 > low.1);
        near(high.0.0, low.0.0);
    }

    #[test]
    fn the_box_fills_its_place_but_for_the_rim_and_shows_what_is_to_be_seen() {
        let view = view();
        let corners: Vec<(f64, f64)> = (0..8).map(|k| view.project(view.corner(k)).0).collect();
        let span = |pick: fn(&(f64, f64)) -> f64| {
            let low = corners.iter().map(pick).fold(f64::INFINITY, f64::min);
            (low, corners.iter().map(pick).fold(f64::NEG_INFINITY, f64::max))
        };
        let (x, y) = (span(|c| c.0), span(|c| c.1));
        let wide = (x.1 - x.0) / (300.0 - 2.0 * RIM);
        let tall = (y.1 - y.0) / (240.0 - 1.5 * RIM);
        near(wide.max(tall), 1.0);
        near(f64::midpoint(x.0, x.1), 190.0 + 0.2 * RIM);
        near(f64::midpoint(y.0, y.1), 140.0 - 0.4 * RIM);
        // What is to be seen is drawn as near to 0.8 of its length as one of the eleven turns makes it.
        let shown = [0.6, 0.8, 0.0];
        let view = View::fit(&[[0.0; 3], [1.0; 3]], shown, PLACE);
        let (a, b) = (view.project([0.0; 3]).0, view.project(shown).0);
        let length = libm::hypot(a.0 - b.0, a.1 - b.1) / view.points_per_unit;
        let off = |degrees: f64| {
            let (right, up, _) = axes(degrees);
            (libm::hypot(dot(right, shown), dot(up, shown)) - 0.8).abs()
        };
        let turns = (0..=10).map(|i| off(-70.0 + 5.0 * f64::from(i)));
        near((length - 0.8).abs(), turns.fold(1.0, f64::min));
    }

    #[test]
    fn an_axis_along_which_nothing_lies_apart_still_has_a_length() {
        let view = View::fit(&[[0.0, 5.0, 1.0], [8.0, 5.0, 3.0]], [1.0, 0.0, 0.0], PLACE);
        near(view.low[1], 4.0);
        near(view.high[1], 6.0);
        near(view.low[2], 1.0 - 0.08);
        near(view.high[0], 8.0 + 0.32);
        let sides = [8.64_f64, 2.0, 2.16];
        near(view.size(), sides.iter().map(|s| s * s).sum::<f64>().sqrt());
    }

    #[test]
    fn a_chord_ends_at_the_nearest_faces() {
        let mut view = view();
        (view.low, view.high) = ([0.0, 0.0, 0.0], [4.0, 2.0, 10.0]);
        let ends = |centre, unit| view.chord(centre, unit);
        assert_eq!(ends([1.0, 1.0, 5.0], [1.0, 0.0, 0.0]), (-1.0, 3.0));
        assert_eq!(ends([1.0, 1.0, 5.0], [-1.0, 0.0, 0.0]), (-3.0, 1.0));
        assert_eq!(ends([1.0, 1.0, 5.0], [0.0, 0.0, 2.0]), (-2.5, 2.5));
        let slanted = ends([1.0, 1.0, 5.0], [0.6, 0.8, 0.0]);
        near(slanted.0, -1.25);
        near(slanted.1, 1.25);
    }
}

//! Half a violin and a box: one condition of a raincloud.

use super::density::density;
use super::prelude::*;
use maveric_stats::quantile;

/// Offset of the box within a slot, as a share of the slot's width.
pub(crate) const BOX: f64 = 0.02;
const VIOLIN: f64 = 0.11;
const VIOLIN_WIDTH: f64 = 0.27;
const STEPS: usize = 48;

/// The values of one condition with their density.
#[derive(Debug)]
pub(crate) struct Cloud {
    sorted: Vec<f64>,
    curve: Vec<(f64, f64)>,
}

impl Cloud {
    /// `None` without values. The density ends where the scale does: nobody can answer beyond it.
    pub(crate) fn new(mut values: Vec<f64>, range: Option<(f64, f64)>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let everything = (f64::NEG_INFINITY, f64::INFINITY);
        let curve = density(&values, STEPS, range.unwrap_or(everything));
        (!values.is_empty()).then_some(Self { sorted: values, curve })
    }

    /// Lowest and highest value that the drawing reaches.
    pub(crate) fn ends(&self) -> [f64; 2] {
        let (first, last) = (self.sorted[0], self.sorted[self.sorted.len() - 1]);
        let low = self.curve.first().map_or(first, |point| point.0);
        let high = self.curve.last().map_or(last, |point| point.0);
        [low, high]
    }
}

/// Draws half a violin and a box round the middle of a slot, both in points.
pub(crate) fn paint(
    canvas: &mut Canvas<'_>,
    frame: &Frame,
    Cloud { sorted, curve }: &Cloud,
    (middle, slot): (f64, f64),
    ink: RGBColor,
) {
    let edge = middle + VIOLIN * slot;
    let (least, most) = frame.y.ends();
    let inside = curve.iter().filter(|(value, _)| (least..=most).contains(value));
    let outline =
        inside.map(|(value, height)| (edge + height * VIOLIN_WIDTH * slot, frame.y.at(*value)));
    let mut corners: Vec<(f64, f64)> = outline.collect();
    if let (Some(first), Some(last)) = (corners.first().copied(), corners.last().copied()) {
        corners.extend([(edge, last.1), (edge, first.1)]);
        canvas.polygon(&corners, ink, 0.25);
        corners.push(corners[0]);
        canvas.path(&corners, Pen::new(ink, stroke::OUTLINE));
    }
    let [low, median, high] = [0.25, 0.5, 0.75].map(|share| quantile(sorted, share).unwrap_or(0.0));
    let fence = 1.5 * (high - low);
    let inside = || sorted.iter().copied().filter(|v| (low - fence..=high + fence).contains(v));
    let whiskers =
        [(inside().next().unwrap_or(low), low), (high, inside().next_back().unwrap_or(high))];
    let (centre, half) = (middle + BOX * slot, 0.07 * slot);
    let point = |side: f64, value: f64| (centre + side * half, frame.y.at(value));
    let pen = Pen::new(ink, stroke::BOX);
    for (from, to) in whiskers {
        canvas.line(point(0.0, from), point(0.0, to), pen);
    }
    canvas.fill_rect(point(-1.0, high), point(1.0, low), PAPER, 1.0);
    canvas.rect(point(-1.0, high), point(1.0, low), pen);
    canvas.line(point(-1.0, median), point(1.0, median), pen);
}

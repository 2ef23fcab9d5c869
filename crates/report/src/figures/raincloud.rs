//! Half a violin and a box: one condition of a raincloud.

use super::fit;
use super::prelude::*;

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
    pub(crate) fn of(mut values: Vec<f64>, range: Option<(f64, f64)>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let everything = (f64::NEG_INFINITY, f64::INFINITY);
        let curve = fit::density(&values, STEPS, range.unwrap_or(everything));
        (!values.is_empty()).then_some(Self {
            sorted: values,
            curve,
        })
    }

    /// Lowest and highest value that the drawing reaches.
    pub(crate) fn ends(&self) -> [f64; 2] {
        let (first, last) = (self.sorted[0], self.sorted[self.sorted.len() - 1]);
        let low = self.curve.first().map_or(first, |point| point.0);
        let high = self.curve.last().map_or(last, |point| point.0);
        [low, high]
    }
}

/// Draws half a violin and a box round the middle of a slot.
pub(crate) fn paint(
    canvas: &mut Canvas<'_>,
    frame: &Frame,
    Cloud { sorted, curve }: &Cloud,
    (middle, slot): (f64, f64),
    ink: RGBColor,
) {
    let edge = middle + VIOLIN * slot;
    let curve: Vec<(f64, f64)> = curve
        .iter()
        .filter(|(value, _)| *value >= frame.y.low() && *value <= frame.y.high())
        .map(|(value, height)| (edge + height * VIOLIN_WIDTH * slot, frame.y.at(*value)))
        .collect();
    if let (Some(first), Some(last)) = (curve.first().copied(), curve.last().copied()) {
        let mut corners = curve;
        corners.push((edge, last.1));
        corners.push((edge, first.1));
        canvas.polygon(&corners, ink, 0.25);
        corners.push(corners[0]);
        canvas.path(&corners, Pen::new(ink, stroke::OUTLINE));
    }
    let [low, median, high] = [0.25, 0.5, 0.75].map(|share| fit::quantile(sorted, share));
    let fence = 1.5 * (high - low);
    let whisker_low = sorted
        .iter()
        .copied()
        .find(|v| *v >= low - fence)
        .unwrap_or(low);
    let whisker_high = sorted
        .iter()
        .rev()
        .copied()
        .find(|v| *v <= high + fence)
        .unwrap_or(high);
    let centre = middle + BOX * slot;
    let half = 0.07 * slot;
    let pen = Pen::new(ink, stroke::BOX);
    for (from, to) in [(whisker_low, low), (high, whisker_high)] {
        canvas.line((centre, frame.y.at(from)), (centre, frame.y.at(to)), pen);
    }
    let corners = (
        (centre - half, frame.y.at(high)),
        (centre + half, frame.y.at(low)),
    );
    canvas.fill_rect(corners.0, corners.1, PAPER, 1.0);
    canvas.rect(corners.0, corners.1, pen);
    canvas.line(
        (centre - half, frame.y.at(median)),
        (centre + half, frame.y.at(median)),
        pen,
    );
}

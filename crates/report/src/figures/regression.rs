//! A least-squares line with its band, over a panel's points.

use super::fit;
use super::prelude::*;
use maveric_stats::LinearFit;

const STEPS: u32 = 30;
const LEVEL: f64 = 0.95;
/// How far beyond the points, as a share of their range, the band may widen the y axis.
const ROOM: f64 = 0.35;

/// A line through points, drawn from the lowest x to the highest.
#[derive(Debug)]
pub(crate) struct Regression {
    line: LinearFit,
    low: f64,
    high: f64,
}

impl Regression {
    /// `None` if the points do not determine a line with its band.
    pub(crate) fn of(points: &[(f64, f64)]) -> Option<Self> {
        let xs = || points.iter().map(|point| point.0);
        Some(Self {
            line: fit::line(points)?,
            low: xs().fold(f64::INFINITY, f64::min),
            high: xs().fold(f64::NEG_INFINITY, f64::max),
        })
    }

    fn band(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        (0..=STEPS).map(|step| {
            let x = self.low + (self.high - self.low) * f64::from(step) / f64::from(STEPS);
            let middle = self.line.predict(x);
            let (low, high) = self.line.band(x, LEVEL).unwrap_or((middle, middle));
            (x, low, high)
        })
    }

    /// Shades the band and draws the line. A band that leaves the panel is cut there.
    pub(crate) fn paint(&self, canvas: &mut Canvas<'_>, frame: &Frame, ink: RGBColor) {
        let inside = |value: f64| value.clamp(frame.y.low(), frame.y.high());
        let band: Vec<(f64, f64, f64)> = self.band().collect();
        let upper = band.iter().map(|&(x, _, high)| frame.at(x, inside(high)));
        let lower = band
            .iter()
            .rev()
            .map(|&(x, low, _)| frame.at(x, inside(low)));
        canvas.polygon(&upper.chain(lower).collect::<Vec<_>>(), ink, 0.12);
        let ends = [self.low, self.high].map(|x| frame.at(x, inside(self.line.predict(x))));
        canvas.path(&ends, Pen::new(ink, stroke::STRONG));
    }
}

/// The y axis of a panel: the points, and the band as far as it does not squeeze them.
pub(crate) fn y_scale(points: &[(f64, f64)], line: Option<&Regression>, ticks: usize) -> Scale {
    let ys = || points.iter().map(|point| point.1);
    let low = ys().fold(f64::INFINITY, f64::min);
    let high = ys().fold(f64::NEG_INFINITY, f64::max);
    let room = ROOM * (high - low);
    let band = line.map(Regression::band).into_iter().flatten();
    let ends = band.flat_map(|(_, a, b)| [a.max(low - room), b.min(high + room)]);
    Scale::over(ys().chain(ends), ticks)
}

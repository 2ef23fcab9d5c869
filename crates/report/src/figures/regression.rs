//! Points in a panel of their own, with their least-squares line and its band.

use super::crowd;
use super::prelude::*;
use maveric_stats::{LinearFit, linear_fit};

const STEPS: u32 = 30;
const LEVEL: f64 = 0.95;
/// How far beyond the points, as a share of their range, the band may widen the y axis.
const ROOM: f64 = 0.35;

/// Points, and how they are drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cloud<'a> {
    pub(crate) points: &'a [(f64, f64)],
    /// About so many ticks an axis.
    pub(crate) ticks: usize,
    /// Of a point, on the page.
    pub(crate) radius: f64,
}

impl Cloud<'_> {
    /// Draws axes, the points, and other straight lines by their ends; without others the line with its band, where the points determine one.
    pub(crate) fn paint(
        self,
        canvas: &mut Canvas<'_>,
        place: Place,
        labels: &Labels<'_>,
        others: &[[(f64, f64); 2]],
    ) {
        let line = Regression::fit(self.points).filter(|_| others.is_empty());
        let x = Scale::over(self.points.iter().map(|point| point.0), self.ticks);
        let y = self.y_scale(line.as_ref());
        let mut panel = Panel::open(canvas, place, labels, (x, y));
        if let Some(line) = line {
            line.paint(&mut panel);
        }
        for ends in others {
            panel.line(*ends, Pen::new(GREY, stroke::OUTLINE));
        }
        let look = (Marker::Circle, INK);
        crowd::paint(panel.canvas, &panel.frame, self.points, self.radius, look);
    }

    /// The y axis: the points, and the band as far as it does not squeeze them.
    fn y_scale(self, line: Option<&Regression>) -> Scale {
        let ys = || self.points.iter().map(|point| point.1);
        let (low, high) = extent(ys());
        let room = ROOM * (high - low);
        let band = line.map(Regression::band).into_iter().flatten();
        let ends = band.flat_map(|(_, a, b)| [a.max(low - room), b.min(high + room)]);
        Scale::over(ys().chain(ends), self.ticks)
    }
}

/// A line through points, drawn from the lowest x to the highest.
#[derive(Debug)]
struct Regression {
    line: LinearFit,
    low: f64,
    high: f64,
}

impl Regression {
    /// `None` if the points do not determine a line with its band.
    fn fit(points: &[(f64, f64)]) -> Option<Self> {
        let column = |value: fn(&(f64, f64)) -> f64| -> Vec<Option<f64>> {
            points.iter().map(|point| Some(value(point))).collect()
        };
        let line = linear_fit(&column(|point| point.0), &column(|point| point.1)).ok();
        let (low, high) = extent(points.iter().map(|point| point.0));
        let line = line.filter(|line| line.residual_sd.is_some())?;
        Some(Self { line, low, high })
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
    fn paint(&self, panel: &mut Panel<'_, '_>) {
        let (least, most) = panel.frame.y.ends();
        let inside = |value: f64| value.clamp(least, most);
        let band: Vec<(f64, f64, f64)> = self.band().collect();
        let upper = band.iter().map(|&(x, _, high)| (x, inside(high)));
        let lower = band.iter().rev().map(|&(x, low, _)| (x, inside(low)));
        panel.area(&upper.chain(lower).collect::<Vec<_>>(), INK, 0.12);
        let ends = [self.low, self.high].map(|x| (x, inside(self.line.predict(x))));
        panel.line(ends, Pen::new(INK, stroke::STRONG));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_at_one_x_have_no_line() {
        assert!(Regression::fit(&[(1.0, 1.0), (1.0, 3.0), (1.0, 5.0)]).is_none());
        assert!(Regression::fit(&[(0.0, 1.0), (1.0, 3.0), (2.0, 4.0)]).is_some());
    }
}

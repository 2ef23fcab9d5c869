//! Curves with intervals against a number, panel by panel: power against participants, errors against trials.

use super::prelude::*;

/// Curves to be drawn, and everything said about them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curves {
    /// Stem of the files.
    pub name: String,
    /// One line.
    pub title: String,
    /// With marks.
    pub caption: String,
    /// The finding in words.
    pub alt: String,
    /// Title of every x axis.
    pub x: String,
    /// Names of the curves, at most five, the same in every panel.
    pub curves: Vec<String>,
    /// A dashed line across every panel, such as a power of .8.
    pub rule: Option<f64>,
    /// Lowest and highest y of every panel; from the points without.
    pub range: Option<(f64, f64)>,
    /// The panels, in rows of three.
    pub panels: Vec<CurvePanel>,
}

/// Some curves over the same axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CurvePanel {
    /// With marks.
    pub title: String,
    /// Title of the y axis.
    pub y: String,
    /// The points of each curve, ascending in x; in the order of [`Curves::curves`].
    pub curves: Vec<Vec<CurvePoint>>,
}

/// A value with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CurvePoint {
    /// Where.
    pub x: f64,
    /// The value.
    pub y: f64,
    /// Low end of its 95 % interval.
    pub low: f64,
    /// High end.
    pub high: f64,
}

/// Marker and colour of each curve.
const LOOKS: [(Marker, RGBColor); 5] = [
    (Marker::Circle, INK),
    (Marker::Square, ORANGE),
    (Marker::TriangleUp, BLUE),
    (Marker::Diamond, GREY),
    (Marker::TriangleDown, GREEN),
];

/// Draws every panel's curves.
///
/// # Errors
/// [`ReportError`] if there is no panel or no curve, more than five curves, a panel has another number of curves, x does not ascend, or a value is not finite.
pub fn curves(input: &Curves, context: &Context) -> Result<Figure, ReportError> {
    let check = Check("curves");
    check.at_least(1, "panels", input.panels.len())?;
    check.at_least(1, "curves", input.curves.len())?;
    let count = input.curves.len();
    check.at_most(LOOKS.len(), "curves", count)?;
    check.finite("rule", input.rule)?;
    check.finite("range", input.range.into_iter().flat_map(<[f64; 2]>::from))?;
    for panel in &input.panels {
        check.length("curves", panel.curves.len(), count)?;
        for curve in &panel.curves {
            check.finite("a point", curve.iter().flat_map(CurvePoint::numbers))?;
            check.rising("x", curve.iter().map(|p| p.x), "ascending x")?;
        }
    }
    let grid = Grid::limited(input.panels.len(), 3, (10.0, 9.0));
    let plan = Plan {
        name: input.name.clone(),
        size_mm: (TWO_COLUMNS_MM, 54.0 * grid.rows() + 8.0),
        title: input.title.clone(),
        caption: input.caption.clone(),
        alt: input.alt.clone(),
        shows: Shows::Participants,
    };
    let points = || input.panels.iter().flat_map(|p| &p.curves).flatten();
    let names = input.curves.iter().zip(LOOKS);
    let keys: Vec<(Key, &str)> =
        names.map(|(name, (marker, colour))| (Key::Point(marker, colour), name.as_str())).collect();
    draw_panels(plan, context, grid, &keys, |canvas, index, place| {
        let curves = &input.panels[index];
        let values = curves.curves.iter().flatten().flat_map(|p| [p.low, p.high]);
        let y = match input.range {
            Some((low, high)) => Scale::between(low, high, 5),
            None => Scale::over(values.chain([0.0]), 5),
        };
        let labels =
            Labels { title: &curves.title, x: &input.x, y: &curves.y, ..Labels::default() };
        let x = Scale::over(points().map(|p| p.x), 5);
        let mut panel = Panel::open(canvas, place, &labels, (x, y));
        if let Some(rule) = input.rule {
            panel.level(rule, Pen::new(MUTED, stroke::AXIS).dashed(2.0, 2.0));
        }
        for (curve, (marker, colour)) in curves.curves.iter().zip(LOOKS) {
            let points: Vec<[f64; 4]> = curve.iter().map(CurvePoint::numbers).collect();
            panel.curve(&points, (1.7, marker, colour));
        }
    })
}

impl CurvePoint {
    fn numbers(&self) -> [f64; 4] {
        [self.x, self.y, self.low, self.high]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(x: [f64; 2]) -> Curves {
        let point = |x| CurvePoint { x, y: 0.5, low: 0.4, high: 0.6 };
        Curves {
            name: "power-curves".into(),
            title: "Power".into(),
            caption: String::new(),
            alt: String::new(),
            x: "Participants".into(),
            curves: vec!["as planted".into()],
            rule: Some(0.8),
            range: Some((0.0, 1.0)),
            panels: vec![CurvePanel {
                title: "r".into(),
                y: "Power".into(),
                curves: vec![x.map(point).to_vec()],
            }],
        }
    }

    #[test]
    fn curves_are_drawn_and_say_whose_they_are() {
        let figure = curves(&input([12.0, 24.0]), &Context::synthetic(1)).unwrap();
        assert!(figure.svg.contains("synthetic participants") && !figure.svg.contains("NaN"));
    }

    #[test]
    fn sizes_out_of_order_are_refused() {
        let refused = curves(&input([24.0, 12.0]), &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

//! What changes on the way round the perpendicular ellipse.

use super::crowd;
use super::prelude::*;
use maveric_domain::ConditionId;
use maveric_stats::circular_fit;

/// Panels side by side, one a measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PerpendicularChanges {
    /// From left to right.
    pub panels: Vec<PerpendicularPanel>,
    /// The condition that moves across the dial.
    pub across: ConditionId,
    /// The condition at 0 on the dial, from which it moves.
    pub from: ConditionId,
}

/// One measure against the angle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PerpendicularPanel {
    /// Such as `Minimum headway distance`.
    pub title: String,
    /// Title of the axis with the unit, such as `Change (m)`.
    pub axis: String,
    /// A participant each.
    pub points: Vec<AngleChange>,
    /// The test, with marks. Shown as the subtitle.
    pub statistic: String,
}

/// One participant's place on the ellipse, and what changed there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AngleChange {
    /// Angle on the ellipse, in radians; any turn.
    pub angle_rad: f64,
    /// The condition across the dial minus that at 0, in the axis's unit.
    pub change: f64,
}

impl PerpendicularPanel {
    /// Angle in degrees, from 0 to below 360, and what changed there.
    fn places(&self) -> impl Iterator<Item = (f64, f64)> {
        let place = |p: &AngleChange| (p.angle_rad.to_degrees().rem_euclid(360.0), p.change);
        self.points.iter().map(place)
    }

    /// Those that are drawn again: none where there are too many for single points.
    fn repeated(&self) -> impl Iterator<Item = (f64, f64)> {
        let is_few = self.points.len() <= crowd::MOST_POINTS;
        let again = move |(degrees, _): &(f64, f64)| is_few && *degrees <= REPEATED_DEGREES;
        self.places().filter(again)
    }
}

const NAME: &str = "perpendicular";
/// The first part of the circle is drawn again after 360°, so that neighbours are seen as such.
const REPEATED_DEGREES: f64 = 30.0;

/// Draws each change against the angle with its fit on cosine and sine.
///
/// # Errors
/// [`ReportError`] if there is no panel, a panel is empty or a value is not finite.
///
/// # Source
/// The paper's figure of perpendicular headway; method, section 9.4. The fit on cosine and sine
/// is ours: the angle has no natural zero, so a straight line through it depends on the plane's
/// axes.
pub fn perpendicular(
    input: &PerpendicularChanges,
    context: &Context,
) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.at_least(1, "participants", panel.points.len())?;
        check.finite("angle_rad", panel.points.iter().map(|point| point.angle_rad))?;
        check.finite("change", panel.points.iter().map(|point| point.change))?;
    }
    let count = input.panels.len();
    let most = input.panels.iter().map(|p| p.points.len()).max();
    let most = most.unwrap_or(0);
    let sizes: Vec<String> = input
        .panels
        .iter()
        .map(|panel| format!("{} ({})", panel.points.len(), panel.title.to_lowercase()))
        .collect();
    let panels = input.panels.iter();
    let is_any_repeated = input.panels.iter().any(|p| p.repeated().next().is_some());
    let repeated = if is_any_repeated { "The first 30° are repeated in grey. " } else { "" };
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (if count == 1 { 85.0 } else { TWO_COLUMNS_MM }, 66.0),
        title: "Moving round the ellipse across the dial".to_owned(),
        caption: format!(
            "Change from {from} to {across} against the angle on the ellipse at which each \
             participant’s embedding of {across} lies. What the dial turns is the same all \
             round. Line: least squares on cosine and sine of the angle. {repeated}*n* = {}; the multiple correlation *R* with cosine and sine and its \
             *p* (*F* test) stand below each title.{}",
            sizes.join(", "),
            crowd::words(most),
            from = context.look(input.from).words(),
            across = context.look(input.across).words(),
        ),
        alt: described(panels.map(|p| (p.title.as_str(), p.statistic.as_str()))),
        shows: Shows::Participants,
    };
    let grid = Grid::new(count, count, (14.0, 0.0));
    draw_panels(plan, context, grid, &[], |canvas, index, place| {
        paint(canvas, place, &input.panels[index]);
    })
}

fn paint(canvas: &mut Canvas<'_>, place: Place, input: &PerpendicularPanel) {
    let ticks = [0.0, 90.0, 180.0, 270.0, 360.0].map(|angle| (angle, format!("{angle:.0}°")));
    let x = Scale::labelled(-6.0, 360.0 + REPEATED_DEGREES + 4.0, ticks.to_vec());
    let (angles, changes): (Vec<f64>, Vec<f64>) =
        input.points.iter().map(|p| (p.angle_rad, p.change)).unzip();
    let y = Scale::over(changes.iter().copied().chain([0.0]), 5);
    let labels = Labels {
        title: &input.title,
        subtitle: &input.statistic,
        x: "Angle on the ellipse across the dial",
        y: &input.axis,
        ..Labels::default()
    };
    let mut panel = Panel::open(canvas, place, &labels, (x, y));
    panel.rule(0.0);
    if let Some([level, cosine, sine]) = circular_fit(&angles, &changes) {
        let point = |degrees: f64| {
            let (sin, cos) = libm::sincos(degrees.to_radians());
            (degrees, level + cosine * cos + sine * sin)
        };
        let (least, most) = panel.frame.y.ends();
        let curve = (0..=90).map(|step| point(4.0 * f64::from(step)));
        let inside = curve.filter(|(_, change)| (least..=most).contains(change));
        panel.line(inside, Pen::new(GREEN, stroke::STRONG));
    }
    for (degrees, change) in input.repeated() {
        let again = panel.frame.at(degrees + 360.0, change);
        panel.canvas.disc(again, 1.5, GREY, 0.6);
        panel.canvas.ring(again, 1.5, Pen::new(PAPER, stroke::THIN));
    }
    let places: Vec<(f64, f64)> = input.places().collect();
    let look = (Marker::Diamond, GREEN);
    crowd::paint(panel.canvas, &panel.frame, &places, 1.8, look);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn input(angle_rad: f64) -> PerpendicularChanges {
        let points = vec![
            AngleChange { angle_rad, change: 2.0 },
            AngleChange { angle_rad: 2.0, change: -1.0 },
            AngleChange { angle_rad: 4.0, change: 0.5 },
            AngleChange { angle_rad: 5.0, change: 1.5 },
        ];
        PerpendicularChanges {
            panels: vec![PerpendicularPanel {
                title: "Minimum headway distance".into(),
                axis: "Change (m)".into(),
                points,
                statistic: "*r*(2) = .68".into(),
            }],
            across: ConditionId::new("across").unwrap(),
            from: ConditionId::new("same").unwrap(),
        }
    }

    #[test]
    fn an_angle_and_the_same_angle_a_turn_later_are_drawn_alike() {
        let (a, b) = (input(0.25), input(0.25 - TAU));
        let svg =
            |input: &PerpendicularChanges| perpendicular(input, &Context::real()).unwrap().svg;
        assert_eq!(svg(&a), svg(&b));
    }

    #[test]
    fn the_caption_speaks_of_repeated_points_where_there_are_some() {
        let caption = |angle: f64| perpendicular(&input(angle), &Context::real()).unwrap().caption;
        assert!(caption(0.25).contains("repeated in grey"));
        assert!(!caption(1.0).contains("repeated in grey"));
    }

    #[test]
    fn an_infinite_angle_is_refused() {
        let refused = perpendicular(&input(f64::INFINITY), &Context::real());
        assert!(matches!(refused, Err(ReportError::NotFinite { .. })));
    }
}

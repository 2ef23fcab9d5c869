//! The perpendicular ellipse as it is: the angle all round, what changed as the distance from a circle.

use super::axes::{Place, Scale};
use super::canvas::{Canvas, Look, Pen, cap_height};
use super::check::Check;
use super::crowd::MOST_POINTS;
use super::fit;
use super::perpendicular::{PerpendicularChanges, PerpendicularPanel};
use super::theme::{GREEN, GRID, INK, MUTED, Marker, PAPER, TWO_COLUMNS_MM, size, stroke};
use super::{Context, Figure, Plan, Shows, draw};
use crate::error::ReportError;
use crate::markup;
use std::f64::consts::TAU;

const NAME: &str = "perpendicular-circle";
const SECTORS: usize = 36;

/// Draws each change outside (more) or inside (less) the circle of no change, at its angle, with the fit on cosine
/// and sine: the circular axis beside [`super::perpendicular()`]'s straight one, which is better to read values from.
///
/// # Errors
/// [`ReportError`] if there is no panel, a panel is empty or a value is not finite.
///
/// # Source
/// Method, section 9.4. The circular picture is ours.
pub fn perpendicular_circle(
    input: &PerpendicularChanges,
    context: &Context,
) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.at_least(1, "participants", panel.points.len())?;
        check.finite("angle_rad", panel.points.iter().map(|p| p.angle_rad))?;
        check.finite("change", panel.points.iter().map(|p| p.change))?;
    }
    let sizes: Vec<String> = input
        .panels
        .iter()
        .map(|panel| format!("{} ({})", panel.points.len(), panel.title.to_lowercase()))
        .collect();
    let found: Vec<String> = input
        .panels
        .iter()
        .map(|panel| {
            let test = markup::plain(&panel.statistic).replace('\n', "; ");
            format!("{}: {test}.", panel.title)
        })
        .collect();
    let many = input.panels.iter().any(|p| p.points.len() > MOST_POINTS);
    let points = if many {
        "Bars: the middle half of the participants in each tenth of a right angle, with the median"
    } else {
        "Points: participants"
    };
    let columns = input.panels.len().min(2);
    let rows = input.panels.len().div_ceil(columns);
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (
            if columns == 1 { 85.0 } else { TWO_COLUMNS_MM },
            86.0 * rows as f64,
        ),
        title: "Round the ellipse across the dial".to_owned(),
        caption: format!(
            "Change from {from} to {across} at the angle on the ellipse at which each participant’s embedding \
             lies. Dashed circle: no change; outside it more, inside it less. {points}; closed line: least squares on \
             cosine and sine. *n* = {}; the test stands below each title.",
            sizes.join(", "),
            from = context.look(input.from).words(),
            across = context.look(input.across).words(),
        ),
        alt: found.join(" "),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, whole| {
        for (index, panel) in input.panels.iter().enumerate() {
            let cell = (index % columns, index / columns);
            paint(
                canvas,
                whole.cell(cell, (columns, rows), (14.0, 9.0)),
                panel,
            );
        }
    })
}

/// Centre and scale of a round panel.
struct Dial {
    centre: (f64, f64),
    scale: Scale,
}

impl Dial {
    fn at(&self, angle: f64, change: f64) -> (f64, f64) {
        let r = self.scale.at(change);
        (
            self.centre.0 + r * angle.cos(),
            self.centre.1 - r * angle.sin(),
        )
    }

    fn round(&self, change: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let angles = (0..=120).map(|step| TAU * f64::from(step) / 120.0);
        angles.map(|angle| self.at(angle, change(angle))).collect()
    }
}

fn paint(canvas: &mut Canvas<'_>, place: Place, panel: &PerpendicularPanel) {
    let mut top = place.top + 7.0;
    canvas.text(
        &panel.title,
        (place.left, top),
        Look::new(size::TITLE).semibold(),
    );
    for line in panel.statistic.lines() {
        top += 9.0;
        canvas.text(line, (place.left, top), Look::new(size::SUBTITLE));
    }
    top += 9.0;
    canvas.text(
        &panel.axis,
        (place.left, top),
        Look::new(size::TICK).colour(MUTED),
    );
    top += 12.0;
    let room = 9.0;
    let radius = ((place.right - place.left) / 2.0 - 20.0).min((place.bottom - top) / 2.0 - room);
    let centre = (
        f64::midpoint(place.left, place.right),
        f64::midpoint(top, place.bottom),
    );
    let pairs: Vec<(f64, f64)> = panel
        .points
        .iter()
        .map(|p| (p.angle_rad, p.change))
        .collect();
    let curve = fit::circular_fit(&pairs);
    let bend = curve.map(|[level, c, s]| [level - c.hypot(s), level + c.hypot(s)]);
    let changes = pairs.iter().map(|pair| pair.1).chain([0.0]);
    let data = Scale::over(changes.chain(bend.into_iter().flatten()), 3);
    // The lowest value stands a fifth of the radius from the centre, where angles can still be told apart.
    let low = data.low() - 0.25 * (data.high() - data.low());
    let high = data.high();
    let ticks = data.ticks.into_iter().zip(data.labels).collect();
    let dial = Dial {
        centre,
        scale: Scale::labelled(low, high, ticks).placed(0.0, radius),
    };
    for quarter in 0..4 {
        let angle = TAU * f64::from(quarter) / 4.0;
        let (inner, outer) = (dial.at(angle, low), dial.at(angle, dial.scale.high()));
        canvas.line(inner, outer, Pen::new(GRID, stroke::THIN));
        let name = Look::new(size::TICK).colour(MUTED).centred();
        let (x, y) = outer;
        let label = format!("{}°", 90 * quarter);
        match quarter {
            0 => canvas.text(&label, (x + 3.0, y), name),
            1 => canvas.text(&label, (x, y - 5.5), name.middle()),
            2 => canvas.text(&label, (x - 3.0, y), name.end()),
            _ => canvas.text(&label, (x, y + 5.5), name.middle()),
        }
    }
    for &tick in &dial.scale.ticks {
        let ring = dial.scale.at(tick);
        canvas.ring(centre, ring, Pen::new(GRID, stroke::THIN));
    }
    canvas.path(
        &dial.round(|_| 0.0),
        Pen::new(INK, stroke::AXIS).dashed(2.0, 1.5),
    );
    let ink = GREEN;
    if let Some([level, cosine, sine]) = curve {
        let line = dial.round(|angle| level + cosine * angle.cos() + sine * angle.sin());
        canvas.path(&line, Pen::new(ink, stroke::STRONG));
    }
    if pairs.len() <= MOST_POINTS {
        for &(angle, change) in &pairs {
            canvas.marker(dial.at(angle, change), 1.8, Marker::Diamond, ink);
        }
    } else {
        paint_sectors(canvas, &dial, &pairs);
    }
    // Numbers along one spoke between two quarters, over everything else.
    let spoke = TAU / 16.0;
    let look = Look::new(size::SMALL).middle().centred();
    for (&tick, label) in dial.scale.ticks.iter().zip(&dial.scale.labels) {
        let (x, y) = dial.at(spoke, tick);
        let half = (
            look.width(label) / 2.0 + 1.2,
            cap_height(size::SMALL) / 2.0 + 1.2,
        );
        let corners = ((x - half.0, y - half.1), (x + half.0, y + half.1));
        canvas.fill_rect(corners.0, corners.1, PAPER, 0.85);
        canvas.text(label, (x, y), look);
    }
}

fn paint_sectors(canvas: &mut Canvas<'_>, dial: &Dial, pairs: &[(f64, f64)]) {
    let ink = GREEN;
    let mut sectors = vec![Vec::new(); SECTORS];
    for &(angle, change) in pairs {
        let share = angle.rem_euclid(TAU) / TAU;
        sectors[((share * SECTORS as f64) as usize).min(SECTORS - 1)].push(change);
    }
    for (index, changes) in sectors
        .iter_mut()
        .enumerate()
        .filter(|(_, c)| !c.is_empty())
    {
        changes.sort_by(f64::total_cmp);
        let angle = TAU * (index as f64 + 0.5) / SECTORS as f64;
        let [low, middle, high] =
            [0.25, 0.5, 0.75].map(|share| dial.at(angle, fit::quantile(changes, share)));
        canvas.line(low, high, Pen::new(ink, 2.0).alpha(0.45));
        canvas.disc(middle, stroke::POINT, ink, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::perpendicular::AngleChange;
    use super::*;
    use maveric_domain::ConditionId;

    fn input(change: f64) -> PerpendicularChanges {
        let points = (0..6).map(|k| AngleChange {
            angle_rad: f64::from(k),
            change: change * f64::from(k % 3),
        });
        PerpendicularChanges {
            panels: vec![PerpendicularPanel {
                title: "Left lane".into(),
                axis: "Change (share)".into(),
                points: points.collect(),
                statistic: "*R* = .4".into(),
            }],
            across: ConditionId::new("across").unwrap(),
            from: ConditionId::new("own").unwrap(),
        }
    }

    #[test]
    fn no_change_at_all_is_still_a_picture() {
        assert!(perpendicular_circle(&input(0.0), &Context::real()).is_ok());
    }

    #[test]
    fn a_change_that_is_not_finite_is_refused() {
        let refused = perpendicular_circle(&input(f64::NAN), &Context::real());
        assert!(matches!(refused, Err(ReportError::NotFinite { .. })));
    }
}

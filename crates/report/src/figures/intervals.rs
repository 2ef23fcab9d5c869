//! A few estimates with their intervals, small: the picture of an answer.

use super::prelude::*;
use crate::apa;
use maveric_stats::Proportion;

/// Estimates under each other on one axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Intervals {
    /// Title of the axis, with marks.
    pub axis: String,
    /// The estimates, from top to bottom; at most 30.
    pub rows: Vec<IntervalRow>,
    /// The value of no effect.
    pub nothing: Option<f64>,
    /// What the rule asks for, or what counts as none: shaded. An infinite end lies at the border.
    pub bounds: Option<(f64, f64)>,
    /// What the rows are: `95% CI`. With marks.
    pub what: String,
}

/// One estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IntervalRow {
    /// Its name. Plain text.
    pub label: String,
    /// The estimate; none is a dash.
    pub estimate: Option<f64>,
    /// Ends of its interval.
    pub interval: Option<(f64, f64)>,
    /// What costs nothing reaches: a grey bar.
    pub floor: Option<f64>,
    /// What cannot be beaten: a ring.
    pub ceiling: Option<f64>,
}

impl IntervalRow {
    /// A row without floor and ceiling.
    pub fn new(
        label: impl Into<String>,
        estimate: Option<f64>,
        interval: Option<(f64, f64)>,
    ) -> Self {
        Self {
            label: label.into(),
            estimate,
            interval,
            floor: None,
            ceiling: None,
        }
    }

    /// A share with its interval, in per cent.
    pub fn share(label: impl Into<String>, share: Option<&Proportion>) -> Self {
        let share = share.map(Proportion::percent);
        let ends = share.as_ref().map(Proportion::ends);
        Self::new(label, share.map(|s| s.estimate), ends)
    }

    fn values(&self) -> impl Iterator<Item = f64> {
        let ends = self.interval.into_iter().flat_map(|(a, b)| [a, b]);
        [self.estimate, self.floor, self.ceiling]
            .into_iter()
            .flatten()
            .chain(ends)
    }
}

impl Intervals {
    /// Whether there is anything to draw.
    pub fn has_values(&self) -> bool {
        self.rows.iter().any(|r| r.estimate.is_some())
    }
}

const MOST: usize = 30;
const ROW_MM: f64 = 3.9;
/// Names get at most this share of the width.
const NAMES: f64 = 0.42;

/// Draws an estimate a line: dot, interval, a grey bar at its floor and a ring at its ceiling.
///
/// # Errors
/// [`ReportError`] if there is no estimate, there are more than 30 rows, or a number is not finite.
pub fn intervals(
    name: &str,
    title: &str,
    input: &Intervals,
    context: &Context,
) -> Result<Figure, ReportError> {
    let check = Check(name);
    let values = || input.rows.iter().flat_map(IntervalRow::values);
    let most = input.rows.len() as f64;
    check.that(input.rows.len() <= MOST, "rows", most, "at most 30")?;
    check.at_least(
        1,
        "estimates",
        input.rows.iter().filter(|r| r.estimate.is_some()).count(),
    )?;
    check.finite("an estimate", values().chain(input.nothing))?;
    let said = input.rows.iter().filter_map(|row| {
        let ends = row.interval.map_or_else(String::new, |(low, high)| {
            format!(" [{}, {}]", apa::number(low, 2), apa::number(high, 2))
        });
        Some(format!(
            "{} {}{ends}",
            row.label,
            apa::number(row.estimate?, 2)
        ))
    });
    let mut caption = format!("{}.", input.what);
    if input.rows.iter().any(|r| r.floor.is_some()) {
        caption += " Grey bar: the floor.";
    }
    if input.rows.iter().any(|r| r.ceiling.is_some()) {
        caption += " Ring: the ceiling.";
    }
    if input.bounds.is_some() {
        caption += " Shaded: what the rule asks for.";
    }
    let plan = Plan {
        name: name.to_owned(),
        size_mm: (ONE_COLUMN_MM, ROW_MM * input.rows.len() as f64 + 12.0),
        title: title.to_owned(),
        caption,
        alt: said.collect::<Vec<_>>().join("; "),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, place| {
        let look = Look::new(size::TICK);
        let room = NAMES * (place.right - place.left);
        let last = input.rows.len() as f64 - 1.0;
        let names = input.rows.iter().enumerate().map(|(i, row)| {
            let name = shortened(&row.label, look, room);
            (last - i as f64, name)
        });
        let ends = input.bounds.into_iter().flat_map(|(a, b)| [a, b]);
        let x = Scale::over(
            values()
                .chain(input.nothing)
                .chain(ends.filter(|e| e.is_finite())),
            4,
        );
        let y = Scale::labelled(-0.6, last + 0.6, names.collect());
        let labels = Labels {
            x: &input.axis,
            ..Labels::default()
        };
        let frame = Frame::draw(canvas, place, &labels, x, y);
        ground(canvas, &frame, input);
        for (i, row) in input.rows.iter().enumerate() {
            one(canvas, &frame, row, frame.y.at(last - i as f64));
        }
    })
}

/// A name that fits, cut with an ellipsis.
fn shortened(name: &str, look: Look, room: f64) -> String {
    let mut kept: String = name.to_owned();
    while look.width(&markup::literal(&kept)) > room && kept.chars().count() > 4 {
        kept = kept.trim_end_matches('…').chars().collect::<String>();
        kept.pop();
        kept = format!("{}…", kept.trim_end());
    }
    markup::literal(&kept)
}

fn ground(canvas: &mut Canvas<'_>, frame: &Frame, input: &Intervals) {
    let (top, bottom) = (frame.place.top, frame.place.bottom);
    if let Some((low, high)) = input.bounds {
        let at = |value: f64| {
            let inside = value.clamp(frame.x.low(), frame.x.high());
            frame.x.at(inside)
        };
        canvas.fill_rect((at(low), top), (at(high), bottom), PALE, 1.0);
    }
    if let Some(nothing) = input.nothing {
        let x = frame.x.at(nothing);
        canvas.line(
            (x, top),
            (x, bottom),
            Pen::new(GREY, stroke::AXIS).dashed(2.0, 1.5),
        );
    }
}

fn one(canvas: &mut Canvas<'_>, frame: &Frame, row: &IntervalRow, y: f64) {
    let Some(value) = row.estimate else {
        let look = Look::new(size::TICK).middle().centred();
        canvas.text(
            "–",
            (f64::midpoint(frame.place.left, frame.place.right), y),
            look,
        );
        return;
    };
    if let Some(floor) = row.floor {
        let x = frame.x.at(floor);
        canvas.line((x, y - 3.2), (x, y + 3.2), Pen::new(GREY, 1.6));
    }
    if let Some((low, high)) = row.interval {
        let ends = ((frame.x.at(low), y), (frame.x.at(high), y));
        canvas.line(ends.0, ends.1, Pen::new(INK, stroke::STRONG));
    }
    if let Some(ceiling) = row.ceiling {
        canvas.ring((frame.x.at(ceiling), y), 2.6, Pen::new(MUTED, stroke::BOX));
    }
    canvas.disc((frame.x.at(value), y), 1.9, INK, 1.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input() -> Intervals {
        let mut rows = vec![
            IntervalRow::new("Mean velocity", Some(0.4), Some((0.1, 0.7))),
            IntervalRow::new(
                "A measure of so long a name that no room is left for its interval",
                None,
                None,
            ),
        ];
        rows[0].floor = Some(0.05);
        Intervals {
            axis: "*r*".to_owned(),
            rows,
            nothing: Some(0.0),
            bounds: Some((0.3, f64::INFINITY)),
            what: "95% CI".to_owned(),
        }
    }

    #[test]
    fn an_open_bound_ends_at_the_border_and_a_long_name_is_cut() {
        let figure = intervals("card-x", "Does it?", &input(), &Context::real()).unwrap();
        assert!(figure.svg.contains('…') && figure.svg.contains("Mean velocity"));
        assert_eq!(figure.alt, "Mean velocity 0.40 [0.10, 0.70]");
        assert!(figure.caption.contains("Grey bar") && !figure.caption.contains("Ring"));
    }

    #[test]
    fn an_estimate_that_is_not_finite_is_refused() {
        let mut bad = input();
        bad.rows[0].estimate = Some(f64::NAN);
        assert!(intervals("card-x", "Does it?", &bad, &Context::real()).is_err());
        bad.rows.clear();
        assert!(intervals("card-x", "Does it?", &bad, &Context::real()).is_err());
    }
}

//! A few estimates with their intervals, small: the picture of an answer.

use super::figure::MARGIN;
use super::names::{on_two_lines, shortened};
use super::page::points_from_mm;
use super::prelude::*;
use super::style;
use crate::apa::decimals;
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
        Self { label: label.into(), estimate, interval, floor: None, ceiling: None }
    }

    /// A share with its interval, in per cent.
    pub fn share(label: impl Into<String>, share: Option<&Proportion>) -> Self {
        let share = share.map(Proportion::percent);
        let ends = share.as_ref().map(Proportion::ends);
        Self::new(label, share.map(|s| s.estimate), ends)
    }

    fn words(&self) -> Option<String> {
        let width = self.interval.map_or(0.0, |(low, high)| high - low);
        let written = |value| number(value, decimals(width));
        let estimate = written(self.estimate?);
        let ends = self.interval.map_or_else(String::new, |(low, high)| {
            format!(" [{}, {}]", written(low), written(high))
        });
        Some(format!("{} {estimate}{ends}", self.label))
    }

    fn values(&self) -> impl Iterator<Item = f64> {
        let ends = self.interval.into_iter().flat_map(<[f64; 2]>::from);
        [self.estimate, self.floor, self.ceiling].into_iter().flatten().chain(ends)
    }
}

impl Intervals {
    /// Whether there is anything to draw.
    pub fn has_values(&self) -> bool {
        self.rows.iter().any(|r| r.estimate.is_some())
    }

    /// What the rows and marks are. With marks.
    pub fn key(&self) -> String {
        let mut key = format!("{}.", self.what);
        if self.rows.iter().any(|r| r.floor.is_some()) {
            key += " Grey bar: the floor.";
        }
        if self.rows.iter().any(|r| r.ceiling.is_some()) {
            key += " Ring: the ceiling.";
        }
        if self.bounds.is_some() {
            key += " Shaded: what the rule asks for.";
        }
        key
    }
}

const MOST: usize = 30;
const ROW_MM: f64 = 3.9;
/// Of a row whose name takes two lines.
const TALL_ROW_MM: f64 = 7.4;
/// Names get at most this share of the width; where one is longer than that, the second.
const NAMES: [f64; 2] = [0.42, 0.56];

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
    check.at_most(MOST, "rows", input.rows.len())?;
    let estimates = input.rows.iter().filter(|r| r.estimate.is_some());
    check.at_least(1, "estimates", estimates.count())?;
    check.finite("an estimate", values().chain(input.nothing))?;
    let estimates = input.rows.iter().filter_map(IntervalRow::words);
    let drawn_mm = style::drawn_width(ONE_COLUMN_MM);
    let width = points_from_mm(drawn_mm) - 2.0 * MARGIN;
    let is_long =
        |row: &IntervalRow, share: f64| on_two_lines(called(&row.label), share * width).len() > 1;
    let any_is_long = |share: &f64| input.rows.iter().any(|row| is_long(row, *share));
    let share = NAMES.into_iter().find(|share| !any_is_long(share));
    let are_tall = share.is_none();
    let share = share.unwrap_or(NAMES[1]);
    let row_mm = if are_tall { TALL_ROW_MM * ONE_COLUMN_MM / drawn_mm } else { ROW_MM };
    let plan = Plan {
        name: name.to_owned(),
        size_mm: (ONE_COLUMN_MM, row_mm * input.rows.len() as f64 + 12.0),
        title: title.to_owned(),
        caption: input.key(),
        alt: estimates.collect::<Vec<_>>().join("; "),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, place| {
        let room = share * (place.right - place.left);
        let names = input.rows.iter().map(|row| {
            let whole = called(&row.label);
            let name = if are_tall {
                on_two_lines(whole, room).join("\n")
            } else {
                shortened(whole, room)
            };
            // Whoever draws it looks up what it is to be called.
            if name == whole { row.label.clone() } else { name }
        });
        let rows = Rows::new(names, 0.6);
        let ends = input.bounds.into_iter().flat_map(<[f64; 2]>::from);
        let ends = ends.filter(|end| end.is_finite());
        let x = Scale::over(values().chain(input.nothing).chain(ends), 4);
        let labels = Labels { x: &input.axis, ..Labels::default() };
        let mut panel = Panel::open(canvas, place, &labels, (x, rows.axis()));
        if let Some((low, high)) = input.bounds {
            let (least, most) = panel.frame.x.ends();
            let ends = [low, high].map(|end| end.clamp(least, most));
            panel.stripe(ends, PALE, 1.0);
        }
        if let Some(nothing) = input.nothing {
            panel.nothing(nothing);
        }
        for (i, row) in input.rows.iter().enumerate() {
            paint(&mut panel, row, rows.y(i));
        }
    })
}

/// What a row is called where another label was asked for.
fn called(label: &str) -> &str {
    let other = style::current().and_then(|style| style.label(label));
    other.unwrap_or(label)
}

fn paint(panel: &mut Panel<'_, '_>, row: &IntervalRow, y: f64) {
    let Place { left, right, .. } = panel.frame.place;
    let Some(value) = row.estimate else {
        return panel.dash(f64::midpoint(left, right), y);
    };
    let (x, height) = (panel.frame.x.clone(), panel.frame.y.at(y));
    if let Some(floor) = row.floor {
        let (x, pen) = (x.at(floor), Pen::new(GREY, 1.6));
        panel.canvas.line((x, height - 3.2), (x, height + 3.2), pen);
    }
    if let Some((low, high)) = row.interval {
        panel.line([(low, y), (high, y)], Pen::new(INK, stroke::STRONG));
    }
    if let Some(ceiling) = row.ceiling {
        let pen = Pen::new(MUTED, stroke::BOX);
        panel.canvas.ring((x.at(ceiling), height), 2.6, pen);
    }
    panel.canvas.disc((x.at(value), height), 1.9, INK, 1.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input() -> Intervals {
        let mut rows = vec![
            IntervalRow::new("Mean velocity", Some(0.4), Some((0.1, 0.7))),
            IntervalRow::new(
                "A measure of so long a name that two lines of the widest room do not hold it, so that its middle is left out and what tells it apart stays",
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
    fn what_is_small_is_no_zero_in_the_words_of_a_figure() {
        let row = |interval| IntervalRow::new("Glances", Some(-0.003_97), interval);
        let said = |interval| row(interval).words().unwrap();
        assert_eq!(said(Some((-0.0057, -0.0023))), "Glances −0.0040 [−0.0057, −0.0023]");
        assert_eq!(said(Some((-0.2, 0.2))), "Glances 0.00 [−0.20, 0.20]");
    }

    #[test]
    fn rows_that_differ_at_their_ends_can_be_told_apart() {
        let mut alike = input();
        let rows = ["calm", "sporty"].map(|car| {
            let label = format!("Conscientiousness / Perceived intelligence (own - {car})");
            IntervalRow::new(label, Some(0.1), None)
        });
        alike.rows = rows.to_vec();
        let figure = intervals("card-x", "Does it?", &alike, &Context::real()).unwrap();
        for end in ["calm)</text>", "sporty)</text>"] {
            assert!(figure.svg.contains(end), "{end}: {}", figure.svg);
        }
        // The second line of a name stands nearer to its first than to the next name.
        let height = |line: &str| {
            let (_, y) = line.split_once(" y=\"")?;
            y.split('"').next()?.parse::<f64>().ok()
        };
        let names = figure.svg.lines().filter(|line| line.contains(">Consc"));
        let ends = figure.svg.lines().filter(|line| line.contains(")</text>"));
        let [first, next] = names.filter_map(height).collect::<Vec<_>>()[..] else {
            panic!("{}", figure.svg);
        };
        let second = ends.filter_map(height).fold(f64::INFINITY, f64::min);
        assert!(second > first && next - second > 1.4 * (second - first));
        let short = intervals("card-x", "Does it?", &input(), &Context::real()).unwrap();
        assert!(short.svg.contains("Mean velocity</text>"));
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

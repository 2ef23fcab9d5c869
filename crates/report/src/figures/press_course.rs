//! What a ride was like in the seconds before somebody pressed.

use super::prelude::*;

/// Courses, a panel each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PressCourses {
    /// The panels, in reading order.
    pub panels: Vec<CoursePanel>,
    /// Presses behind them.
    pub presses: usize,
}

/// One thing before a press.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CoursePanel {
    /// Such as `Strongest braking`. Plain text.
    pub title: String,
    /// The test, with marks; empty where there is none.
    pub test: String,
    /// What is measured, with its unit.
    pub axis: String,
    /// People in it.
    pub n: usize,
    /// Seconds before the press, mean and ends of its interval, from far to near.
    pub points: Vec<[f64; 4]>,
    /// The mean at other moments.
    pub others: Option<f64>,
}

const NAME: &str = "press-course";

/// Draws the mean courses with their intervals, and the mean at other moments as a dashed line.
///
/// # Errors
/// [`ReportError`] if there is no panel or point, or a number is not finite.
pub fn press_course(input: &PressCourses, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.at_least(1, "points", panel.points.len())?;
        check.finite(&panel.title, panel.points.iter().flatten().copied())?;
        check.finite("the mean at other moments", panel.others)?;
    }
    let grid = Grid::limited(input.panels.len(), 3, (12.0, 11.0));
    let n = counted(input.panels.iter().map(|panel| panel.n), " (by panel)");
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 48.0 * grid.rows() + 3.0),
        title: "Before a press".to_owned(),
        caption: format!(
            "Means over people of what happened in the 4 s before each moment, with 95% intervals, in the seconds before {} presses of \
             “uncomfortable”; the dashed line is the mean at the other moments of the same minutes. *n* = {n} people.",
            input.presses
        ),
        alt: sentences(input.panels.iter().map(told_of)),
        shows: Shows::Participants,
    };
    draw_panels(plan, context, grid, &[], |canvas, index, place| {
        let input = &input.panels[index];
        let ends = input.points.iter().flat_map(|p| p[1..].iter().copied());
        let y = Scale::over(ends.chain(input.others), 4);
        let x = Scale::over(input.points.iter().map(|p| -p[0]), 4);
        let labels = Labels {
            title: &input.title,
            subtitle: &input.test,
            x: "Time to the press (s)",
            y: &input.axis,
            ..Labels::default()
        };
        let mut panel = Panel::open(canvas, place, &labels, (x, y));
        if let Some(others) = input.others {
            panel.line(
                [(-10.0, others), (0.0, others)],
                Pen::new(MUTED, stroke::AXIS).dashed(3.0, 2.0),
            );
        }
        let points: Vec<[f64; 4]> = input
            .points
            .iter()
            .map(|[before, mean, low, high]| [-before, *mean, *low, *high])
            .collect();
        panel.curve(&points, (1.6, Marker::Circle, INK));
    })
}

fn told_of(panel: &CoursePanel) -> String {
    let ends = panel.points.first().zip(panel.points.last());
    let course = ends.map_or_else(String::new, |(far, near)| {
        format!(
            " from {} at {} s before to {} at {} s",
            number(far[1], 2),
            number(far[0], 0),
            number(near[1], 2),
            number(near[0], 0)
        )
    });
    let others = panel
        .others
        .map_or_else(String::new, |others| format!(", {} at other moments", number(others, 2)));
    format!("{}:{course}{others}.", panel.title)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input() -> PressCourses {
        PressCourses {
            panels: vec![CoursePanel {
                title: "Strongest braking".into(),
                test: "OR 2.10".into(),
                axis: "m/s²".into(),
                n: 12,
                points: (0..=10)
                    .rev()
                    .map(|s| {
                        let mean = 1.0 - 0.05 * f64::from(s);
                        [f64::from(s), mean, mean - 0.1, mean + 0.1]
                    })
                    .collect(),
                others: Some(0.4),
            }],
            presses: 40,
        }
    }

    #[test]
    fn the_course_ends_at_the_press_and_other_moments_are_a_line() {
        let figure = press_course(&input(), &Context::real()).unwrap();
        assert!(figure.svg.contains(">Time to the press (s)<"), "{}", figure.svg);
        assert!(figure.caption.contains("40 presses") && figure.caption.contains("*n* = 12"));
        assert_eq!(
            figure.alt,
            "Strongest braking: from 0.50 at 10 s before to 1.00 at 0 s, 0.40 at other moments."
        );
    }

    #[test]
    fn no_panel_no_point_and_no_number_are_refused() {
        let drawn = |change: &dyn Fn(&mut PressCourses)| {
            let mut input = input();
            change(&mut input);
            press_course(&input, &Context::real())
        };
        assert!(drawn(&|_| ()).is_ok());
        assert!(drawn(&|input| input.panels.clear()).is_err());
        assert!(drawn(&|input| input.panels[0].points.clear()).is_err());
        assert!(drawn(&|input| input.panels[0].points[0][1] = f64::NAN).is_err());
    }
}

//! What turning the dial does: each measure over the shift in aggression.

use super::fit;
use super::prelude::*;

/// Drives of the same drivers at several shifts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DialSweep {
    /// What the dial is counted in, such as `ADB points`.
    pub unit: String,
    /// Settings of the dial, ascending; 0 is the driver's own style.
    pub points: Vec<f64>,
    /// One panel a measure.
    pub panels: Vec<DialPanel>,
}

/// One measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DialPanel {
    /// Such as `Mean velocity`.
    pub title: String,
    /// Title of the axis with the unit.
    pub axis: String,
    /// Drivers, and for each its value at every shift; `None` where that drive has none.
    pub drivers: Vec<Vec<Option<f64>>>,
    /// Below the title, with marks: how many drivers went the right way.
    pub statistic: String,
}

const NAME: &str = "dial-sweep";
const MOST_LINES: usize = 120;

/// Draws a line a driver and the mean of those with every value, with its 95% interval.
///
/// # Errors
/// [`ReportError`] if there are fewer than two shifts, no panel, a panel without drivers, lengths differ, shifts
/// do not ascend, or a value is not finite.
pub fn dial_sweep(input: &DialSweep, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(2, "shifts", input.points.len())?;
    check.at_least(1, "panels", input.panels.len())?;
    check.finite("points", input.points.iter().copied())?;
    for pair in input.points.windows(2) {
        check.that(pair[0] < pair[1], "points", pair[1], "ascending shifts")?;
    }
    for panel in &input.panels {
        check.at_least(1, "drivers", panel.drivers.len())?;
        for values in &panel.drivers {
            check.length(&panel.title, values.len(), input.points.len())?;
            check.finite(&panel.title, values.iter().flatten().copied())?;
        }
    }
    let whole_drivers = |panel: &DialPanel| -> Vec<Vec<f64>> {
        panel
            .drivers
            .iter()
            .filter_map(|values| values.iter().copied().collect::<Option<Vec<f64>>>())
            .collect()
    };
    let counted: Vec<String> = input
        .panels
        .iter()
        .map(|panel| {
            let all = panel.drivers.len();
            let whole = whole_drivers(panel).len();
            format!("{whole} of {all} ({})", panel.title.to_lowercase())
        })
        .collect();
    let panels = input.panels.iter();
    let found = told(panels.map(|p| (p.title.as_str(), p.statistic.as_str())));
    let most = input.panels.iter().map(|panel| panel.drivers.len()).max();
    let lines = if most.is_some_and(|most| most > MOST_LINES) {
        format!("Grey: the first {MOST_LINES} drivers")
    } else {
        "Grey: drivers".to_owned()
    };
    let shift = format!("Shift ({})", input.unit);
    let columns = input.panels.len().min(3);
    let rows = input.panels.len().div_ceil(columns);
    let (first, last) = (input.points[0], input.points[input.points.len() - 1]);
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 62.0 * rows as f64 + 6.0),
        title: "Turning the dial".to_owned(),
        caption: format!(
            "Each measure of the car’s drives as its driver, shifted by {} to {} {}. \
             {lines}; black: mean of the drivers with a value at every shift, with 95% intervals, \
             marked blue below the driver’s own setting, purple at it and orange above. *n* = {}; no test.",
            number(first, 0),
            number(last, 0),
            input.unit,
            counted.join(", ")
        ),
        alt: found,
        shows: Shows::Participants,
    };
    draw_panels(
        plan,
        context,
        Grid::new(input.panels.len(), columns, (12.0, 9.0)),
        |canvas, index, place| {
            let panel = &input.panels[index];
            let labels = Labels {
                title: &panel.title,
                subtitle: &panel.statistic,
                x: &shift,
                y: &panel.axis,
                ..Labels::default()
            };
            let values = panel.drivers.iter().flatten().flatten().copied();
            let frame = Frame::draw(
                canvas,
                place,
                &labels,
                Scale::over([first, last], 5),
                Scale::over(values, 5),
            );
            for values in panel.drivers.iter().take(MOST_LINES) {
                let path: Vec<(f64, f64)> = input
                    .points
                    .iter()
                    .zip(values)
                    .filter_map(|(shift, value)| Some(frame.at(*shift, (*value)?)))
                    .collect();
                canvas.path(&path, Pen::new(GREY, stroke::THIN).alpha(0.6));
            }
            let drivers = whole_drivers(panel);
            let mut path = Vec::new();
            for (step, &shift) in input.points.iter().enumerate() {
                let here: Vec<f64> = drivers.iter().map(|values| values[step]).collect();
                let Some(mean) = fit::mean(&here) else {
                    continue;
                };
                path.push((shift, mean, here));
            }
            let line: Vec<(f64, f64)> = path.iter().map(|(s, m, _)| frame.at(*s, *m)).collect();
            canvas.path(&line, Pen::new(INK, stroke::STRONG));
            for (shift, mean, here) in &path {
                if here.len() > 1 {
                    let n = here.len() as f64;
                    let half =
                        fit::t_975(here.len() - 1) * fit::standard_deviation(here) / n.sqrt();
                    let clip = |value: f64| value.clamp(frame.y.low(), frame.y.high());
                    let ends = [
                        frame.at(*shift, clip(mean - half)),
                        frame.at(*shift, clip(mean + half)),
                    ];
                    canvas.line(ends[0], ends[1], Pen::new(INK, stroke::BOX));
                }
                let (shape, ink) = match shift {
                    s if *s > 0.0 => (Marker::TriangleUp, ORANGE),
                    s if *s < 0.0 => (Marker::TriangleDown, BLUE),
                    _ => (Marker::Square, PURPLE),
                };
                canvas.marker(frame.at(*shift, *mean), 2.2, shape, ink);
            }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_driver_with_too_few_values_is_refused() {
        let panel = DialPanel {
            title: "Mean velocity".into(),
            axis: "mph".into(),
            drivers: vec![vec![Some(60.0), Some(61.0)], vec![Some(60.0)]],
            statistic: String::new(),
        };
        let input = DialSweep {
            unit: "ADB points".to_owned(),
            points: vec![-15.0, 15.0],
            panels: vec![panel],
        };
        assert!(matches!(
            dial_sweep(&input, &Context::real()),
            Err(ReportError::LengthMismatch { .. })
        ));
    }
}

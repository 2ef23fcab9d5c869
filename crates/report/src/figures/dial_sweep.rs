//! What turning the dial does: each measure over the shift in aggression.

use super::prelude::*;
use maveric_stats::{mean, mean_interval};

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
    check.rising("points", input.points.iter().copied(), "ascending shifts")?;
    for panel in &input.panels {
        check.at_least(1, "drivers", panel.drivers.len())?;
        for values in &panel.drivers {
            check.length(&panel.title, values.len(), input.points.len())?;
            check.finite(&panel.title, values.iter().flatten().copied())?;
        }
    }
    let grid = Grid::limited(input.panels.len(), 3, (12.0, 9.0));
    let ends = [input.points[0], input.points[input.points.len() - 1]];
    let shift = format!("Shift ({})", input.unit);
    draw_panels(plan(input, grid, ends), context, grid, &[], |canvas, index, place| {
        let drivers = &input.panels[index].drivers;
        let labels = Labels {
            title: &input.panels[index].title,
            subtitle: &input.panels[index].statistic,
            x: &shift,
            y: &input.panels[index].axis,
            ..Labels::default()
        };
        let values = drivers.iter().flatten().flatten().copied();
        let scales = (Scale::over(ends, 5), Scale::over(values, 5));
        let mut panel = Panel::open(canvas, place, &labels, scales);
        let shifts = || input.points.iter().copied();
        for values in drivers.iter().take(MOST_LINES) {
            let there = shifts().zip(values).filter_map(|(at, value)| Some((at, (*value)?)));
            panel.line(there, Pen::new(GREY, stroke::THIN).alpha(0.6));
        }
        let whole = input.panels[index].whole();
        let column =
            |step: usize| -> Vec<f64> { whole.iter().map(|values| values[step]).collect() };
        let columns: Vec<Vec<f64>> = (0..input.points.len()).map(column).collect();
        let means = || shifts().zip(&columns).filter_map(|(at, values)| Some((at, mean(values)?)));
        panel.line(means(), Pen::new(INK, stroke::STRONG));
        for ((at, middle), values) in means().zip(&columns) {
            let mark = match at {
                at if at > 0.0 => (2.2, Marker::TriangleUp, ORANGE),
                at if at < 0.0 => (2.2, Marker::TriangleDown, BLUE),
                _ => (2.2, Marker::Square, PURPLE),
            };
            match mean_interval(values, 0.95) {
                Some(interval) => {
                    panel.upright_interval(at, interval, Pen::new(INK, stroke::BOX), mark);
                }
                None => panel.mark((at, middle), mark),
            }
        }
    })
}

impl DialPanel {
    /// The drivers with a value at every shift.
    fn whole(&self) -> Vec<Vec<f64>> {
        let values = self.drivers.iter();
        values.filter_map(|v| v.iter().copied().collect()).collect()
    }
}

fn plan(input: &DialSweep, grid: Grid, [first, last]: [f64; 2]) -> Plan {
    let counted = input.panels.iter().map(|panel| {
        let (all, whole) = (panel.drivers.len(), panel.whole().len());
        format!("{whole} of {all} ({})", panel.title.to_lowercase())
    });
    let counted: Vec<String> = counted.collect();
    let many = input.panels.iter().any(|p| p.drivers.len() > MOST_LINES);
    let lines = if many {
        format!("Grey: the first {MOST_LINES} drivers")
    } else {
        "Grey: drivers".to_owned()
    };
    let panels = input.panels.iter();
    Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 62.0 * grid.rows() + 6.0),
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
        alt: described(panels.map(|p| (p.title.as_str(), p.statistic.as_str()))),
        shows: Shows::Participants,
    }
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

//! What the networks' predictions leave over.

use super::prelude::*;

/// Distributions of residuals side by side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// A panel a network.
    pub panels: Vec<ResidualPanel>,
    /// Drives whose rows these are.
    pub drives: usize,
    /// Whether the networks learned from these rows.
    pub held_out: bool,
}

/// One network's residuals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResidualPanel {
    /// Such as `Ego speed (V)`.
    pub title: String,
    /// Title of the axis with the unit: `Predicted − recorded (m/s)`.
    pub axis: String,
    /// Unit, for words: `m/s`.
    pub unit: String,
    /// Share below and residual, shares ascending; symmetric about one half, which is among them.
    pub quantiles: Vec<(f64, f64)>,
    /// Mean of the residuals, in the unit.
    pub mean: f64,
    /// Root-mean-square of the residuals, in the unit.
    pub rms: f64,
    /// Rows.
    pub rows: usize,
}

const NAME: &str = "residuals";

/// Draws nested boxes a panel, each between two quantiles, with the median, the mean and zero marked.
///
/// # Errors
/// [`ReportError`] if there is no panel, shares or residuals do not ascend, there are not an odd number of them, or a
/// value is not finite.
pub fn residuals(input: &Residuals, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        let count = panel.quantiles.len();
        check.at_least(3, "quantiles", count)?;
        check.that(
            count % 2 == 1,
            "quantiles",
            count as f64,
            "an odd number of them",
        )?;
        check.finite("quantiles", panel.quantiles.iter().flat_map(|q| [q.0, q.1]))?;
        check.finite("mean and root-mean-square", [panel.mean, panel.rms])?;
        for pair in panel.quantiles.windows(2) {
            let ascend = pair[0].0 < pair[1].0 && pair[0].1 <= pair[1].1;
            check.that(
                ascend,
                "quantiles",
                pair[1].1,
                "ascending shares and residuals",
            )?;
        }
    }
    let rows: Vec<String> = input
        .panels
        .iter()
        .map(|panel| format!("{} rows ({})", panel.rows, panel.title))
        .collect();
    let spread = |panel: &ResidualPanel| {
        format!(
            "mean {} {unit}, root-mean-square {} {unit}",
            number(panel.mean, 2),
            number(panel.rms, 2),
            unit = panel.unit
        )
    };
    let found: Vec<String> = input
        .panels
        .iter()
        .map(|panel| format!("{}: {}.", panel.title, spread(panel)))
        .collect();
    let shares: Vec<String> = input.panels[0]
        .quantiles
        .iter()
        .map(|(share, _)| number(100.0 * share, 0))
        .collect();
    let whose = if input.held_out {
        "not learned from"
    } else {
        "learned from"
    };
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 40.0),
        title: "What the predictions leave over".to_owned(),
        caption: format!(
            "Residuals of the networks on recorded windows {whose}, each drive with its own embedding. Boxes reach \
             between the quantiles at {}%; solid: the mean; dashed: no error. *n* = {}, {} drives; no test.",
            shares.join(", "),
            rows.join(", "),
            input.drives
        ),
        alt: found.join(" "),
        shows: Shows::Participants,
    };
    draw_panels(
        plan,
        context,
        Grid::new(input.panels.len(), input.panels.len().max(2), (14.0, 0.0)),
        |canvas, index, place| {
            let panel = &input.panels[index];
            let subtitle = spread(panel);
            let labels = Labels {
                title: &panel.title,
                subtitle: &subtitle,
                x: &panel.axis,
                ..Labels::default()
            };
            let values = panel.quantiles.iter().map(|q| q.1).chain([0.0, panel.mean]);
            let x = Scale::over(values, 6);
            let frame = Frame::draw(
                canvas,
                place,
                &labels,
                x,
                Scale::labelled(-1.0, 1.0, Vec::new()),
            );
            let pairs = panel.quantiles.len() / 2;
            for outer in 0..pairs {
                let inner = panel.quantiles.len() - 1 - outer;
                let (low, high) = (panel.quantiles[outer].1, panel.quantiles[inner].1);
                let half = 0.75 * (outer + 1) as f64 / pairs as f64;
                canvas.fill_rect(frame.at(low, -half), frame.at(high, half), GREY, 0.35);
            }
            let marks = [
                (0.0, 1.0, Pen::new(MUTED, stroke::AXIS).dashed(2.0, 2.0)),
                (panel.mean, 0.85, Pen::new(INK, stroke::STRONG)),
            ];
            for (value, half, pen) in marks {
                canvas.line(frame.at(value, -half), frame.at(value, half), pen);
            }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_that_fall_are_refused() {
        let panel = ResidualPanel {
            title: "Ego speed".into(),
            axis: "Predicted − recorded (m/s)".into(),
            unit: "m/s".into(),
            quantiles: vec![(0.25, 0.0), (0.5, 1.0), (0.75, 0.5)],
            mean: 0.5,
            rms: 0.7,
            rows: 10,
        };
        let input = Residuals {
            panels: vec![panel],
            drives: 1,
            held_out: true,
        };
        let refused = residuals(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

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
    /// How many rows have a residual.
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
        let odd = count % 2 == 1;
        check.that(odd, "quantiles", count as f64, "an odd number of them")?;
        check.finite("quantiles", panel.quantiles.iter().flat_map(|q| [q.0, q.1]))?;
        check.finite("mean and root-mean-square", [panel.mean, panel.rms])?;
        for pair in panel.quantiles.windows(2) {
            let ascend = pair[0].0 < pair[1].0 && pair[0].1 <= pair[1].1;
            let expected = "ascending shares and residuals";
            check.that(ascend, "quantiles", pair[1].1, expected)?;
        }
    }
    let columns = input.panels.len().max(2);
    let grid = Grid::new(input.panels.len(), columns, (14.0, 0.0));
    draw_panels(plan(input), context, grid, &[], |canvas, index, place| {
        let ResidualPanel { quantiles, mean, .. } = &input.panels[index];
        let labels = Labels {
            title: &input.panels[index].title,
            subtitle: &input.panels[index].spread(),
            x: &input.panels[index].axis,
            ..Labels::default()
        };
        let values = quantiles.iter().map(|q| q.1).chain([0.0, *mean]);
        let scales = (Scale::over(values, 6), Scale::labelled(-1.0, 1.0, Vec::new()));
        let mut panel = Panel::open(canvas, place, &labels, scales);
        let pairs = quantiles.len() / 2;
        for outer in 0..pairs {
            let ends = [outer, quantiles.len() - 1 - outer].map(|at| quantiles[at].1);
            let half = 0.75 * (outer + 1) as f64 / pairs as f64;
            panel.shade(ends, [-half, half], GREY, 0.35);
        }
        let dashed = Pen::new(MUTED, stroke::AXIS).dashed(2.0, 2.0);
        panel.line([(0.0, -1.0), (0.0, 1.0)], dashed);
        let solid = Pen::new(INK, stroke::STRONG);
        panel.line([(*mean, -0.85), (*mean, 0.85)], solid);
    })
}

impl ResidualPanel {
    fn spread(&self) -> String {
        let [mean, rms] = [self.mean, self.rms].map(|value| number(value, 2));
        let unit = &self.unit;
        format!("mean {mean} {unit}, root-mean-square {rms} {unit}")
    }
}

fn plan(input: &Residuals) -> Plan {
    let panels = input.panels.iter();
    let rows = panels.map(|panel| format!("{} rows ({})", panel.rows, panel.title));
    let shares = input.panels[0].quantiles.iter();
    let shares = shares.map(|(share, _)| number(100.0 * share, 0));
    let panels = input.panels.iter();
    let whose = if input.held_out { "not learned from" } else { "learned from" };
    Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 40.0),
        title: "What the predictions leave over".to_owned(),
        caption: format!(
            "Residuals of the networks on recorded windows {whose}, each drive with its own embedding. Boxes reach \
             between the quantiles at {}%; solid: the mean; dashed: no error. *n* = {}, {} drives; no test.",
            shares.collect::<Vec<_>>().join(", "),
            rows.collect::<Vec<_>>().join(", "),
            input.drives
        ),
        alt: sentences(panels.map(|panel| format!("{}: {}.", panel.title, panel.spread()))),
        shows: Shows::Participants,
    }
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
        let input = Residuals { panels: vec![panel], drives: 1, held_out: true };
        let refused = residuals(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

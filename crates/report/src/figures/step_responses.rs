//! How the car's controllers answer a step: velocity, gap, lane.

use super::prelude::*;

/// Answers to steps, side by side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepResponses {
    /// One panel a controller; three to a row.
    pub panels: Vec<StepPanel>,
}

/// One controller's answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepPanel {
    /// Such as `Velocity`.
    pub title: String,
    /// Title of the axis with the unit: `Speed (m/s)`.
    pub axis: String,
    /// The unit, for words: `m/s`.
    pub unit: String,
    /// Time in seconds, rising.
    pub time_s: Vec<f64>,
    /// What was reached, one value a time.
    pub value: Vec<f64>,
    /// What was asked for, one value a time.
    pub target: Vec<f64>,
    /// Where the answer ends; none where that is the last target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<f64>,
    /// How far the answer went beyond where it ends, in the unit; 0 if it did not.
    pub overshoot: f64,
    /// From when on, in seconds after the step, the answer stays within [`band`](Self::band); `None`: it does not.
    pub settling_s: Option<f64>,
    /// When the step came, in seconds.
    pub step_at_s: f64,
    /// Half width of the band round where it ends that counts as settled, in the unit.
    pub band: f64,
    /// Mean of the answer less the target once settled, in the unit; `None` if it did not settle.
    pub steady_state_error: Option<f64>,
}

const NAME: &str = "step-responses";
const MOST_POINTS: usize = 800;

/// Draws each answer with its target, the band that counts as settled, and the moment from which it stays there.
///
/// # Errors
/// [`ReportError`] if there is no panel, a panel has fewer than two rows, lengths differ, times do not rise, the band
/// or the overshoot is negative, or a value is not finite.
///
/// # Source
/// Method, section 6: the controllers. Overshoot, settling time and steady-state error as control engineering has
/// them; all three come in from outside.
pub fn step_responses(input: &StepResponses, context: &Context) -> Result<Figure, ReportError> {
    check(input)?;
    let bands = input.panels.iter().map(|panel| {
        let title = panel.title.to_lowercase();
        format!("±{} {} ({title})", number(panel.band, 2), panel.unit)
    });
    let most = if input.panels.len() == 4 { 2 } else { 3 };
    let grid = Grid::limited(input.panels.len(), most, (11.0, 10.0));
    let panels = input.panels.iter();
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (grid.width_mm(), 60.0 * grid.rows() + 6.0),
        title: "Answers of the controllers to a step".to_owned(),
        caption: format!(
            "What each controller reaches (black) when what it is asked for (dashed) steps. Shaded: the band round where \
             the answer ends that counts as settled, {}; vertical line: from then on the answer stays within it. \
             Overshoot: how far it went beyond where it ends. Steady-state error: mean of answer less target after it has settled. One simulated run a panel, without noise: no data of participants, \
             *n* = {}; no test.",
            bands.collect::<Vec<_>>().join(", "),
            input.panels.len()
        ),
        alt: sentences(
            panels.map(|panel| format!("{}: {}.", panel.title, words(panel).join(", "))),
        ),
        shows: Shows::Explanation,
    };
    let solid = Pen::new(INK, stroke::STRONG);
    let target_pen = Pen::new(GREY, stroke::STRONG).dashed(3.0, 2.0);
    let settled = Pen::new(OCHRE, stroke::BOX);
    let keys = [
        (Key::Line(solid), "reached"),
        (Key::Line(target_pen), "asked for"),
        (Key::Line(settled), "settled from here on"),
    ];
    draw_panels(plan, context, grid, &keys, |canvas, index, place| {
        let StepPanel {
            time_s,
            value,
            target,
            band,
            step_at_s,
            end,
            ..
        } = &input.panels[index];
        let labels = Labels {
            title: &input.panels[index].title,
            subtitle: &words(&input.panels[index]).join("\n"),
            x: "Time (s)",
            y: &input.panels[index].axis,
            ..Labels::default()
        };
        let (first, last) = (time_s[0], time_s[time_s.len() - 1]);
        let end = end.unwrap_or(target[target.len() - 1]);
        let ends = [end - band, end + band];
        let values = value.iter().chain(target).chain(&ends).copied();
        let scales = (Scale::between(first, last, 5), Scale::over(values, 5));
        let mut panel = Panel::open(canvas, place, &labels, scales);
        panel.shade([step_at_s.clamp(first, last), last], ends, PALE, 1.0);
        if let Some(settling) = input.panels[index].settling_s {
            panel.upright((step_at_s + settling).clamp(first, last), settled);
        }
        for (values, pen) in [(target, target_pen), (value, solid)] {
            let pairs = time_s.iter().copied().zip(values.iter().copied());
            panel.thin_line(&pairs.collect::<Vec<_>>(), MOST_POINTS, pen);
        }
    })
}

fn words(panel: &StepPanel) -> Vec<String> {
    let unit = markup::literal(&panel.unit);
    let settled = panel.settling_s.map_or_else(
        || "does not settle".to_owned(),
        |settling| format!("settled after {} s", number(settling, 1)),
    );
    let overshoot = format!("overshoot {} {unit}", number(panel.overshoot, 2));
    let error = panel.steady_state_error;
    let error = error.map(|e| format!("steady-state error {} {unit}", number(e, 3)));
    [overshoot, settled].into_iter().chain(error).collect()
}

fn check(input: &StepResponses) -> Result<(), ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        let rows = panel.time_s.len();
        check.at_least(2, "rows", rows)?;
        for (field, values) in [("value", &panel.value), ("target", &panel.target)] {
            check.length(field, values.len(), rows)?;
            check.finite(field, values.iter().copied())?;
        }
        check.finite("time_s", panel.time_s.iter().copied())?;
        check.rising("time_s", panel.time_s.iter().copied(), "rising times")?;
        let times = [panel.step_at_s].into_iter().chain(panel.settling_s);
        let levels = panel.steady_state_error.into_iter().chain(panel.end);
        check.finite("times and levels of the step", times.chain(levels))?;
        let any = (0.0, f64::MAX);
        check.within(any, "band", [panel.band], "at least 0")?;
        check.within(any, "overshoot", [panel.overshoot], "at least 0")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(settling_s: Option<f64>) -> StepResponses {
        StepResponses {
            panels: vec![StepPanel {
                title: "Velocity".into(),
                axis: "Speed (m/s)".into(),
                unit: "m/s".into(),
                time_s: vec![0.0, 1.0, 2.0],
                value: vec![25.0, 28.0, 30.0],
                target: vec![30.0; 3],
                end: None,
                overshoot: 0.0,
                settling_s,
                step_at_s: 0.0,
                band: 0.5,
                steady_state_error: None,
            }],
        }
    }

    #[test]
    fn an_answer_that_does_not_settle_says_so() {
        let figure = step_responses(&input(None), &Context::synthetic(1)).unwrap();
        assert!(figure.svg.contains(">does not settle</text>"));
        let figure = step_responses(&input(Some(1.8)), &Context::synthetic(1)).unwrap();
        assert!(figure.svg.contains(">settled after 1.8 s</text>"));
    }

    #[test]
    fn the_band_lies_round_where_the_answer_ends() {
        let bands = |end| {
            let mut input = input(Some(1.0));
            input.panels[0].end = end;
            let svg = step_responses(&input, &Context::real()).unwrap().svg;
            let rects = svg.lines().filter(|line| line.starts_with("<rect x="));
            rects.map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(bands(None).len(), 1);
        assert_eq!(bands(None), bands(Some(30.0)));
        assert_ne!(bands(None), bands(Some(28.0)));
    }

    #[test]
    fn a_negative_overshoot_is_refused() {
        let mut input = input(None);
        input.panels[0].overshoot = -0.1;
        let refused = step_responses(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

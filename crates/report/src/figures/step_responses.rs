//! How the car's controllers answer a step: velocity, gap, lane.

use super::prelude::*;
use super::thin::thinned;

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
    /// What was asked for, one value a time; its last is what the answer settles at.
    pub target: Vec<f64>,
    /// How far the answer went beyond the last target, in the unit; 0 if it did not.
    pub overshoot: f64,
    /// From when on, in seconds after the step, the answer stays within [`band`](Self::band); `None`: it does not.
    pub settling_s: Option<f64>,
    /// When the step came, in seconds.
    pub step_at_s: f64,
    /// Half width of the band round the last target that counts as settled, in the unit.
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
    let found: Vec<String> = input
        .panels
        .iter()
        .map(|panel| format!("{}: {}.", panel.title, words(panel).join(", ")))
        .collect();
    let bands: Vec<String> = input
        .panels
        .iter()
        .map(|panel| {
            let title = panel.title.to_lowercase();
            format!("±{} {} ({title})", number(panel.band, 2), panel.unit)
        })
        .collect();
    let columns = match input.panels.len() {
        4 => 2,
        panels => panels.min(3),
    };
    let rows = input.panels.len().div_ceil(columns);
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (
            (TWO_COLUMNS_MM / 3.0 * columns as f64).max(85.0),
            60.0 * rows as f64 + 6.0,
        ),
        title: "Answers of the controllers to a step".to_owned(),
        caption: format!(
            "What each controller reaches (black) when what it is asked for (dashed) steps. Shaded: the band that \
             counts as settled, {}; vertical line: from then on the answer stays within it. Steady-state error: mean \
             of answer less target after that. One simulated run a panel, without noise: no data of participants, \
             *n* = {}; no test.",
            bands.join(", "),
            input.panels.len()
        ),
        alt: found.join(" "),
        shows: Shows::Explanation,
    };
    let solid = Pen::new(INK, stroke::STRONG);
    let target = Pen::new(GREY, stroke::STRONG).dashed(3.0, 2.0);
    let settled = Pen::new(OCHRE, stroke::BOX);
    draw_panels_below(
        plan,
        context,
        Grid::new(input.panels.len(), columns, (11.0, 10.0)),
        |canvas, whole| {
            let keys = [
                (Key::Line(solid), "reached"),
                (Key::Line(target), "asked for"),
                (Key::Line(settled), "settled from here on"),
            ];
            canvas.legend(whole, &keys)
        },
        |canvas, index, place| {
            let panel = &input.panels[index];
            let subtitle = words(panel).join("\n");
            let labels = Labels {
                title: &panel.title,
                subtitle: &subtitle,
                x: "Time (s)",
                y: &panel.axis,
                ..Labels::default()
            };
            let (first, last) = (panel.time_s[0], panel.time_s[panel.time_s.len() - 1]);
            let goal = panel.target[panel.target.len() - 1];
            let ends = [goal - panel.band, goal + panel.band];
            let values = panel.value.iter().chain(&panel.target).chain(&ends);
            let y = Scale::over(values.copied(), 5);
            let frame = Frame::draw(canvas, place, &labels, Scale::between(first, last, 5), y);
            let from = panel.step_at_s.clamp(first, last);
            canvas.fill_rect(frame.at(from, ends[1]), frame.at(last, ends[0]), PALE, 1.0);
            if let Some(settling) = panel.settling_s {
                let x = frame.x.at((panel.step_at_s + settling).clamp(first, last));
                canvas.line((x, frame.place.bottom), (x, frame.place.top), settled);
            }
            for (values, pen) in [(&panel.target, target), (&panel.value, solid)] {
                let pairs: Vec<(f64, f64)> = panel
                    .time_s
                    .iter()
                    .copied()
                    .zip(values.iter().copied())
                    .collect();
                let path = thinned(&pairs, MOST_POINTS);
                let path: Vec<(f64, f64)> = path.into_iter().map(|(t, v)| frame.at(t, v)).collect();
                canvas.path(&path, pen);
            }
        },
    )
}

fn words(panel: &StepPanel) -> Vec<String> {
    let unit = markup::literal(&panel.unit);
    let settled = panel.settling_s.map_or_else(
        || "does not settle".to_owned(),
        |settling| format!("settled after {} s", number(settling, 1)),
    );
    let mut words = vec![
        format!("overshoot {} {unit}", number(panel.overshoot, 2)),
        settled,
    ];
    if let Some(error) = panel.steady_state_error {
        words.push(format!("steady-state error {} {unit}", number(error, 3)));
    }
    words
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
        for pair in panel.time_s.windows(2) {
            check.that(pair[0] < pair[1], "time_s", pair[1], "rising times")?;
        }
        let found = [panel.step_at_s].into_iter().chain(panel.settling_s);
        check.finite("times of the step", found.chain(panel.steady_state_error))?;
        for (field, value) in [("band", panel.band), ("overshoot", panel.overshoot)] {
            check.that(
                value >= 0.0 && value.is_finite(),
                field,
                value,
                "at least 0",
            )?;
        }
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
    fn a_negative_overshoot_is_refused() {
        let mut input = input(None);
        input.panels[0].overshoot = -0.1;
        let refused = step_responses(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

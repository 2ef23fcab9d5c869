//! How many rated another style above their own.

use super::ConditionLook;
use super::prelude::*;
use maveric_domain::ConditionId;
use maveric_stats::proportion;

/// One pair of bars a scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Preferences {
    /// The condition at 0 on the dial.
    pub own: ConditionId,
    /// The conditions elsewhere on the dial, in the order of the bars.
    pub others: Vec<ConditionId>,
    /// The scales.
    pub scales: Vec<ScalePreference>,
}

/// Counts on one scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScalePreference {
    /// Such as `Trust`.
    pub scale: String,
    /// Participants with a score in all of these conditions.
    pub n: usize,
    /// Whether less of it counts as better.
    pub less_is_better: bool,
    /// How many of them rated each other condition better than their own style.
    pub above: Vec<usize>,
}

const NAME: &str = "preference";

/// Draws the share who rated each other condition better than their own style, with Wilson intervals.
///
/// # Errors
/// [`ReportError`] if there is no scale, a scale has no participants, or a count exceeds n.
///
/// # Source
/// The paper's figure of preference; method, section 9.5. The intervals are ours.
pub fn preference(input: &Preferences, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "scales", input.scales.len())?;
    check.at_least(1, "conditions", input.others.len())?;
    for scale in &input.scales {
        check.at_least(1, "participants", scale.n)?;
        check.length("above", scale.above.len(), input.others.len())?;
        for &count in &scale.above {
            check.that(
                count <= scale.n,
                "above",
                count as f64,
                &format!("at most n = {}", scale.n),
            )?;
        }
    }
    let low = input.scales.iter().map(|scale| scale.n).min().unwrap_or(0);
    let high = input.scales.iter().map(|scale| scale.n).max().unwrap_or(0);
    let n = if low == high {
        format!("{low}")
    } else {
        format!("{low} to {high}, by scale")
    };
    let own = context.look(input.own);
    let others: Vec<ConditionLook> = input.others.iter().map(|c| context.look(*c)).collect();
    let less: Vec<&str> = input
        .scales
        .iter()
        .filter(|s| s.less_is_better)
        .map(|s| s.scale.as_str())
        .collect();
    let less = if less.is_empty() {
        String::new()
    } else {
        format!("; on {}, less is better", less.join(" and "))
    };
    let share = |count: usize, n: usize| number(100.0 * count as f64 / n as f64, 0);
    let found: Vec<String> = input
        .scales
        .iter()
        .map(|scale| {
            let one = |(look, above): (&ConditionLook, &usize)| {
                format!("{}% {}", share(*above, scale.n), look.label)
            };
            let rated: Vec<String> = others.iter().zip(&scale.above).map(one).collect();
            format!(
                "{}: {} rated better than {}.",
                scale.scale,
                rated.join(" and "),
                own.label
            )
        })
        .collect();
    let width = if input.scales.len() > 4 {
        120.0
    } else {
        ONE_COLUMN_MM
    };
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (width, 66.0),
        title: "Preference for another style than one’s own".to_owned(),
        caption: format!(
            "Share of participants who rated {} better than {}, scale by scale (ties count as not better{less}). Lines: Wilson 95% \
             intervals. *n* = {n}; no test.",
            others
                .iter()
                .map(ConditionLook::words)
                .collect::<Vec<_>>()
                .join(" or "),
            own.words()
        ),
        alt: found.join(" "),
        shows: Shows::Participants,
    };
    let tops = input
        .scales
        .iter()
        .flat_map(|scale| scale.above.iter().map(|k| 100.0 * interval(*k, scale.n).1));
    let top = tops.fold(50.0, f64::max).min(100.0);
    draw(plan, context, |canvas, mut place| {
        let keys: Vec<(Key, &str)> = others
            .iter()
            .map(|look| (Key::Point(Marker::Square, look.rgb()), look.label.as_str()))
            .collect();
        canvas.legend_row((place.left, place.top + 4.0), &keys);
        place.top += cap_height(size::TICK) + 8.0;
        let count = input.scales.len() as f64;
        let ticks = input
            .scales
            .iter()
            .enumerate()
            .map(|(index, scale)| (index as f64, scale.scale.clone()));
        let x = Scale::labelled(-0.55, count - 0.45, ticks.collect());
        let y = Scale::between(0.0, top + 3.0, 5);
        let axis = format!("Rated better than {} (% of participants)", own.label);
        let labels = Labels {
            y: &axis,
            ..Labels::default()
        };
        let frame = Frame::draw(canvas, place, &labels, x, y);
        for (index, scale) in input.scales.iter().enumerate() {
            let k = others.len() as f64;
            for (at, (look, &above)) in others.iter().zip(&scale.above).enumerate() {
                let offset = (at as f64 - (k - 1.0) / 2.0) * 0.8 / k;
                let half = 0.34 / k;
                let share = 100.0 * above as f64 / scale.n as f64;
                let (left, base) = frame.at(index as f64 + offset - half, 0.0);
                let (right, height) = frame.at(index as f64 + offset + half, share);
                canvas.fill_rect((left, height), (right, base), look.rgb(), 0.55);
                canvas.line(
                    (left, height),
                    (right, height),
                    Pen::new(look.rgb(), stroke::STRONG),
                );
                let middle = f64::midpoint(left, right);
                let (low, high) = interval(above, scale.n);
                let ends = [frame.y.at(100.0 * low), frame.y.at(100.0 * high)];
                canvas.line(
                    (middle, ends[0]),
                    (middle, ends[1]),
                    Pen::new(INK, stroke::BOX),
                );
                let look = Look::new(size::SMALL).middle();
                let label = format!("{}%", number(share, 0));
                canvas.text(&label, (middle, ends[1] - 2.5), look);
            }
        }
    })
}

/// Wilson's 95 % interval of a share; everything if the counts make no share.
fn interval(above: usize, n: usize) -> (f64, f64) {
    proportion(above, n, 0.95).map_or((0.0, 1.0), |share| (share.low, share.high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_above_than_there_are_people_is_refused() {
        let input = Preferences {
            own: ConditionId::new("same").unwrap(),
            others: vec![ConditionId::new("fast").unwrap()],
            scales: vec![ScalePreference {
                scale: "Trust".into(),
                n: 4,
                less_is_better: false,
                above: vec![5],
            }],
        };
        let refused = preference(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

//! How many rated Aggressive or Cautious above Mimic.

use super::axes::{Frame, Labels, Scale};
use super::canvas::{Key, Look, Pen, cap_height};
use super::check::Check;
use super::theme::{INK, Marker, ONE_COLUMN_MM, colour, condition_name, size, stroke};
use super::{Context, Figure, Plan, Shows, draw};
use crate::apa::number;
use crate::error::ReportError;
use maveric_domain::ConditionId;
use maveric_stats::proportion;
use serde::{Deserialize, Serialize};

/// One pair of bars a scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Preferences {
    /// The scales, in the order of the bars.
    pub scales: Vec<ScalePreference>,
}

/// Counts on one scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScalePreference {
    /// Such as `Trust`.
    pub scale: String,
    /// Participants with a score in all three conditions.
    pub n: usize,
    /// How many of them rated Aggressive better than Mimic (less discomfort counts as better).
    pub aggressive_above: usize,
    /// How many rated Cautious better than Mimic.
    pub cautious_above: usize,
}

const NAME: &str = "preference";

/// Draws the share who rated Aggressive and Cautious better than Mimic, with Wilson intervals.
///
/// # Errors
/// [`ReportError`] if there is no scale, a scale has no participants, or a count exceeds n.
///
/// # Source
/// The paper's figure of preference; method, section 9.5. The intervals are ours.
pub fn preference(input: &Preferences, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "scales", input.scales.len())?;
    for scale in &input.scales {
        check.at_least(1, "participants", scale.n)?;
        for (field, count) in [
            ("aggressive_above", scale.aggressive_above),
            ("cautious_above", scale.cautious_above),
        ] {
            check.that(
                count <= scale.n,
                field,
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
    let share = |count: usize, n: usize| number(100.0 * count as f64 / n as f64, 0);
    let found: Vec<String> = input
        .scales
        .iter()
        .map(|scale| {
            format!(
                "{}: {}% rated Aggressive and {}% Cautious better than Mimic.",
                scale.scale,
                share(scale.aggressive_above, scale.n),
                share(scale.cautious_above, scale.n)
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
            "Share of participants who rated Aggressive or Cautious better than Mimic, scale by \
             scale (ties count as not better; on Discomfort, less is better). Lines: Wilson 95% \
             intervals. *n* = {n}; no test."
        ),
        alt: found.join(" "),
        shows: Shows::Participants,
    };
    let tops = input.scales.iter().flat_map(|scale| {
        [scale.aggressive_above, scale.cautious_above].map(|k| 100.0 * interval(k, scale.n).1)
    });
    let top = tops.fold(50.0, f64::max).min(100.0);
    draw(plan, context, |canvas, mut place| {
        let keys = [ConditionId::AGGRESSIVE, ConditionId::CAUTIOUS]
            .map(|c| (Key::Point(Marker::Square, colour(c)), condition_name(c)));
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
        let labels = Labels {
            y: "Rated better than Mimic (% of participants)",
            ..Labels::default()
        };
        let frame = Frame::draw(canvas, place, &labels, x, y);
        for (index, scale) in input.scales.iter().enumerate() {
            let bars = [
                (-0.2, scale.aggressive_above, ConditionId::AGGRESSIVE),
                (0.2, scale.cautious_above, ConditionId::CAUTIOUS),
            ];
            for (offset, above, condition) in bars {
                let share = 100.0 * above as f64 / scale.n as f64;
                let (left, base) = frame.at(index as f64 + offset - 0.17, 0.0);
                let (right, height) = frame.at(index as f64 + offset + 0.17, share);
                canvas.fill_rect((left, height), (right, base), colour(condition), 0.55);
                canvas.line(
                    (left, height),
                    (right, height),
                    Pen::new(colour(condition), stroke::STRONG),
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
        let scale = ScalePreference {
            scale: "Trust".into(),
            n: 4,
            aggressive_above: 5,
            cautious_above: 0,
        };
        let refused = preference(
            &Preferences {
                scales: vec![scale],
            },
            &Context::real(),
        );
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}

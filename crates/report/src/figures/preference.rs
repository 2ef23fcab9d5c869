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
    /// From left to right, with the counts on each.
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
        let (most, counts) = (scale.n as f64, scale.above.iter().map(|&k| k as f64));
        let expected = format!("at most n = {}", scale.n);
        check.within((0.0, most), "above", counts, &expected)?;
    }
    let own_look = context.look(input.own);
    let others: Vec<ConditionLook> = input.others.iter().map(|c| context.look(*c)).collect();
    let intervals = input.scales.iter().map(ScalePreference::percent);
    let intervals: Vec<Vec<[f64; 3]>> = intervals.collect();
    let tops = intervals.iter().flatten().map(|[_, _, high]| *high);
    let top = tops.fold(50.0, f64::max).min(100.0);
    draw(plan(input, &own_look, &others), context, |canvas, place| {
        let key =
            |look: &ConditionLook| (Key::Point(Marker::Square, look.rgb()), look.label.clone());
        let place = canvas.legend(place, &others.iter().map(key).collect::<Vec<_>>());
        let scales = input.scales.iter().enumerate();
        let ticks = scales.map(|(index, scale)| (index as f64, scale.scale.clone()));
        let x = Scale::labelled(-0.55, input.scales.len() as f64 - 0.45, ticks.collect());
        let y = Scale::between(0.0, top + 3.0, 5);
        let labels = Labels {
            y: &format!("Rated better than {} (% of participants)", own_look.label),
            ..Labels::default()
        };
        let mut panel = Panel::open(canvas, place, &labels, (x, y));
        let k = others.len() as f64;
        for (index, bars) in intervals.iter().enumerate() {
            for (at, (look, interval)) in others.iter().zip(bars).enumerate() {
                let middle = index as f64 + (at as f64 - (k - 1.0) / 2.0) * 0.8 / k;
                bar(&mut panel, (middle, 0.34 / k), *interval, look.rgb());
            }
        }
    })
}

/// A bar of a share in per cent, its interval, and the share in words above it.
fn bar(
    panel: &mut Panel<'_, '_>,
    (middle, half): (f64, f64),
    [share, low, high]: [f64; 3],
    colour: RGBColor,
) {
    let ends = [middle - half, middle + half];
    panel.shade(ends, [0.0, share], colour, 0.55);
    panel.line(ends.map(|x| (x, share)), Pen::new(colour, stroke::STRONG));
    panel.line([(middle, low), (middle, high)], Pen::new(INK, stroke::BOX));
    let (x, y) = panel.frame.at(middle, high);
    let look = Look::new(size::SMALL).middle();
    panel.canvas.text(&whole_percent(share), (x, y - 2.5), look);
}

/// A share in per cent without decimals; a half goes up, as readers round the one decimal of the table beside it.
fn whole_percent(share: f64) -> String {
    format!("{}%", number(share.round(), 0))
}

impl ScalePreference {
    /// Of each other condition the share in per cent, and the ends of Wilson's 95% interval.
    fn percent(&self) -> Vec<[f64; 3]> {
        let share = |&above: &usize| {
            let ends = proportion(above, self.n, 0.95);
            let (low, high) = ends.map_or((0.0, 1.0), |share| (share.low, share.high));
            [100.0 * above as f64 / self.n as f64, 100.0 * low, 100.0 * high]
        };
        self.above.iter().map(share).collect()
    }
}

fn plan(input: &Preferences, own: &ConditionLook, others: &[ConditionLook]) -> Plan {
    let less = input.scales.iter().filter(|s| s.less_is_better);
    let less = match less.map(|s| s.scale.as_str()).collect::<Vec<_>>() {
        none if none.is_empty() => String::new(),
        scales => format!("; on {}, less is better", scales.join(" and ")),
    };
    let words = |scale: &ScalePreference| {
        let shares = others.iter().zip(scale.percent());
        let shares =
            shares.map(|(look, [share, ..])| format!("{} {}", whole_percent(share), look.label));
        let shares = shares.collect::<Vec<_>>().join(" and ");
        format!("{}: {shares} rated better than {}.", scale.scale, own.label)
    };
    let many = input.scales.len() > 4;
    let names: Vec<String> = others.iter().map(ConditionLook::words).collect();
    Plan {
        name: NAME.to_owned(),
        size_mm: (if many { 120.0 } else { ONE_COLUMN_MM }, 66.0),
        title: "Preference for another style than one’s own".to_owned(),
        caption: format!(
            "Share of participants who rated {} better than {}, scale by scale (ties count as not better{less}). Lines: Wilson 95% \
             intervals. *n* = {}; no test.",
            names.join(" or "),
            own.words(),
            counted(input.scales.iter().map(|scale| scale.n), ", by scale"),
        ),
        alt: sentences(input.scales.iter().map(words)),
        shows: Shows::Participants,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_percent_goes_up() {
        let scale = |above: usize, n: usize| ScalePreference {
            scale: "Trust".into(),
            n,
            less_is_better: false,
            above: vec![above],
        };
        let label = |above, n| whole_percent(scale(above, n).percent()[0][0]);
        assert_eq!([label(3, 24), label(29, 200)], ["13%", "15%"]);
        assert_eq!([label(2, 24), label(0, 24)], ["8%", "0%"]);
    }

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

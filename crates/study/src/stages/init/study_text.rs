//! The commented `study.toml` of a new study.

use crate::texts;
use maveric_domain::{ConditionId, ScoreRange, design::ScoreName};
use maveric_report::markup::capital;
use minijinja::{Value, context};

/// The score that the dial turns.
pub(super) struct DialledScore {
    pub(super) score: ScoreName,
    pub(super) range: ScoreRange,
    pub(super) label: String,
}

/// What the text is to say.
pub(super) struct Wanted<'a> {
    pub(super) conditions: &'a [ConditionId],
    /// None where every car was recorded elsewhere.
    pub(super) style: Option<&'a DialledScore>,
    /// Whether people are asked at the end how sick they are: asking before raises what is reported after.
    pub(super) sickness_after: bool,
    pub(super) synthetic: bool,
}

/// The text; it reads as a design.
pub(super) fn study_text(wanted: &Wanted<'_>) -> String {
    let middle = (wanted.conditions.len() as f64 - 1.0) / 2.0;
    let style = wanted.style.map(|style| {
        let [low, high] = style.range.into();
        let points = style.range.step(middle).to_string();
        let (score, label) = (style.score.to_string(), &style.label);
        context! { score, label, scale => style.score.scale.as_str(), range => format!("{low}, {high}"), points }
    });
    let conditions = wanted.conditions.iter().enumerate().map(|(place, id)| {
        let steps = place as f64 - middle;
        let sign = if steps > 0.0 { "+" } else { "" };
        context! { id => id.as_str(), label => label(*id), steps => format!("{sign}{steps}") }
    });
    let conditions: Vec<Value> = conditions.collect();
    let values = context! {
        synthetic => wanted.synthetic,
        sickness_after => wanted.sickness_after,
        style,
        conditions
    };
    texts::fill(texts::STUDY, values)
}

fn label(id: ConditionId) -> String {
    capital(&id.as_str().replace(['_', '-'], " "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{Design, design::Condition};

    fn of(conditions: &[&str], style: Option<(&str, [f64; 2])>) -> Design {
        let ids: Vec<ConditionId> = conditions.iter().map(|c| c.parse().unwrap()).collect();
        let score = style.map(|(name, [low, high])| DialledScore {
            score: name.parse().unwrap(),
            range: ScoreRange::new(low, high).unwrap(),
            label: "risky score".to_owned(),
        });
        let text = study_text(&Wanted {
            conditions: &ids,
            style: score.as_ref(),
            sickness_after: style.is_some(),
            synthetic: false,
        });
        Design::from_toml(&text).unwrap()
    }

    #[test]
    fn what_init_writes_is_a_design() {
        let none = of(&["calm", "normal", "sporty"], None);
        assert!(none.conditions().iter().all(|c| c.car.is_none()) && none.style().is_none());
        let five = of(&["a", "b", "c", "d", "e"], Some(("adb.total", [11.0, 55.0])));
        let dials: Vec<f64> = five.conditions().iter().filter_map(Condition::dial).collect();
        assert!(
            dials.iter().zip([-30.0, -15.0, 0.0, 15.0, 30.0]).all(|(a, b)| (a - b).abs() < 1e-9)
        );
        // However many there are, the outermost lie on the scale.
        let names = ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l"];
        for n in 2..=names.len() {
            for (score, range) in [("adb.total", [11.0, 55.0]), ("mdsi.risky", [1.0, 6.0])] {
                let many = of(&names[..n], Some((score, range)));
                let furthest = many.conditions()[n - 1].dial().unwrap();
                assert!(furthest > 0.0 && furthest <= range[1] - range[0], "{n}: {furthest}");
            }
        }
        let risky = of(&["calm", "sporty"], Some(("mdsi.risky", [1.0, 6.0])));
        // The seat asks what a style is learned by.
        assert_eq!(risky.protocol().before, ["mdsi"]);
        assert_eq!(risky.style().unwrap().label, "risky score");
        assert_eq!(risky.protocol().post, ["ssq"]);
        assert!(none.protocol().post.is_empty());
        assert!(none.protocol().before.is_empty() && none.protocol().consent.is_some());
        assert!((risky.conditions()[1].dial().unwrap() - 0.85).abs() < 1e-9);
    }
}

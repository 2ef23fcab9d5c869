//! What is asked before somebody takes part, and on the way: the steps of a screening, the probe of a ride.

use crate::{
    hindrance::Hindrance,
    steps::{AskedProbe, Judged, Step, StopRule, sheet},
};
use maveric_domain::{
    Moment, Scale,
    design::{AnswerRule, Probe, Protocol},
};

/// The screening, if there is one.
pub(crate) fn screen(
    protocol: &Protocol,
    scales: &[Scale],
    language: &str,
) -> Result<Option<Step>, Hindrance> {
    if protocol.screen.is_empty() {
        return Ok(None);
    }
    let ids = protocol.screen.iter();
    let sheets = ids.map(|id| sheet(scales, id, Moment::Pre, language));
    let sheets = sheets.collect::<Result<_, _>>()?;
    let rules = protocol.admit_if.iter();
    let rules = rules.map(|rule| judged(rule, &protocol.screen, scales));
    Ok(Some(Step::Screen {
        sheets,
        rules: rules.collect::<Result<_, _>>()?,
    }))
}

/// A rule with the place of its item.
fn judged(rule: &AnswerRule, screen: &[String], scales: &[Scale]) -> Result<Judged, Hindrance> {
    let sheet = screen.iter().position(|id| *id == rule.scale);
    let scale = scales.iter().find(|scale| scale.id == rule.scale);
    let (Some(sheet), Some(scale)) = (sheet, scale) else {
        // The design asks the scale, and a scale that no file has was found before.
        return Err(unknown_item(
            "admit_if",
            rule,
            "no item of [protocol] `screen`",
        ));
    };
    Ok(Judged {
        rule: rule.to_string(),
        sheet,
        item: item_of("admit_if", rule, scale)?,
        than: rule.than,
        value: rule.value,
    })
}

fn unknown_item(key: &'static str, rule: &AnswerRule, problem: impl Into<String>) -> Hindrance {
    Hindrance::Rule {
        key,
        rule: rule.to_string(),
        problem: problem.into(),
    }
}

/// Which item of its scale a rule is on, from 0: by its number, by the subscale that it alone makes, or the only one.
fn item_of(key: &'static str, rule: &AnswerRule, scale: &Scale) -> Result<usize, Hindrance> {
    let items = scale.items.len();
    let alone = |name: &str| {
        let named = scale.subscales.iter().find(|s| s.id == name)?;
        match named.items[..] {
            [item] => Some(item as usize - 1),
            _ => None,
        }
    };
    let item = match &rule.item {
        None => (items == 1).then_some(0),
        Some(name) => match name.parse::<usize>() {
            Ok(number) => number.checked_sub(1).filter(|item| *item < items),
            Err(_) => alone(name),
        },
    };
    let item = item.ok_or_else(|| {
        let of_one = scale.subscales.iter().filter(|s| s.items.len() == 1);
        let named = of_one.map(|s| format!(", {}.{}", scale.id, s.id));
        let named = named.collect::<Vec<_>>().concat();
        let problem = format!(
            "expected an item: {}.1 to {}.{items}{named}",
            scale.id, scale.id
        );
        unknown_item(key, rule, problem)
    })?;
    let question = &scale.items[item];
    if !(question.min..=question.max).contains(&rule.value) {
        let problem = format!(
            "`{}` has answers from {} to {}",
            scale.id, question.min, question.max
        );
        return Err(unknown_item(key, rule, problem));
    }
    Ok(item)
}

/// From which answer to the probe on nobody goes on.
fn stop_rule(protocol: &Protocol, scale: &Scale) -> Result<Option<StopRule>, Hindrance> {
    let Some(rule) = &protocol.stop_if else {
        return Ok(None);
    };
    item_of("stop_if", rule, scale)?;
    Ok(Some(StopRule {
        rule: rule.to_string(),
        than: rule.than,
        value: rule.value,
    }))
}

/// What is asked on the way, if something is.
pub(crate) fn probe(
    protocol: &Protocol,
    scales: &[Scale],
    language: &str,
) -> Result<Option<AskedProbe>, Hindrance> {
    let Some(probe) = &protocol.probe else {
        return Ok(None);
    };
    // Of its kind, with its wording.
    sheet(scales, &probe.scale, Moment::Post, language)?;
    let scale = scales.iter().find(|scale| scale.id == probe.scale);
    let one = scale.filter(|scale| scale.items.len() == 1);
    let worded = |scale: &Scale| {
        let wording = scale.wording_in(language)?;
        Some(wording.items.first()?.text.clone())
    };
    let (scale, question) = one
        .and_then(|scale| Some((scale, worded(scale)?)))
        .ok_or_else(|| Hindrance::ProbeItems {
            scale: probe.scale.clone(),
            items: scale.map_or(0, Scale::count),
        })?;
    Ok(Some(AskedProbe {
        scale: scale.id.clone(),
        question,
        min: scale.items[0].min,
        max: scale.items[0].max,
        every_s: probe.every_s,
        within_s: Probe::ANSWERED_WITHIN_S,
        stop: stop_rule(protocol, scale)?,
    }))
}

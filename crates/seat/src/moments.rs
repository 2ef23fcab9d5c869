//! What is asked before somebody takes part, and on the way: the steps of a screening, the probe of a ride.

use crate::{
    hindrance::{Hindrance, MOST_PROBE_ANSWERS},
    steps::{Asked, AskedProbe, Judged, Step, StopRule, sheet, worded_scale},
};
use maveric_domain::{
    Moment, Scale,
    design::{AnswerRule, Probe, Protocol},
    survey::Kind,
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
    Ok(Some(Step::Screen { sheets, rules: rules.collect::<Result<_, _>>()? }))
}

/// A rule with the place of its item.
fn judged(rule: &AnswerRule, screen: &[String], scales: &[Scale]) -> Result<Judged, Hindrance> {
    let sheet = screen.iter().position(|id| *id == rule.scale);
    let scale = scales.iter().find(|scale| scale.id == rule.scale);
    let (Some(sheet), Some(scale)) = (sheet, scale) else {
        // The design asks the scale, and a scale that no file has was found before.
        return Err(unknown_item("admit_if", rule, "no item of [protocol] `screen`"));
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
    Hindrance::Rule { key, rule: rule.to_string(), problem: problem.into() }
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
        let problem = format!("expected an item: {}.1 to {}.{items}{named}", scale.id, scale.id);
        unknown_item(key, rule, problem)
    })?;
    let question = &scale.items[item];
    if !(question.min..=question.max).contains(&rule.value) {
        let problem =
            format!("`{}` has answers from {} to {}", scale.id, question.min, question.max);
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
    Ok(Some(StopRule { rule: rule.to_string(), than: rule.than, value: rule.value }))
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
    let (scale, wording, items) = worded_scale(scales, &probe.scale, language)?;
    let one: Result<[Asked; 1], _> = items.try_into();
    let [question] =
        one.map_err(|_| Hindrance::ProbeItems { scale: scale.id.clone(), items: scale.count() })?;
    let kind = question.item.kind;
    if matches!(kind, Kind::Number | Kind::Text) {
        let scale = scale.id.clone();
        return Err(Hindrance::ProbeKind { scale, kind });
    }
    let answers = question.item.answers().count();
    if answers > MOST_PROBE_ANSWERS {
        let scale = scale.id.clone();
        return Err(Hindrance::ProbeAnswers { scale, answers });
    }
    Ok(Some(AskedProbe {
        scale: scale.id.clone(),
        instruction: wording.instruction.clone(),
        question,
        every_s: probe.every_s,
        within_s: Probe::ANSWERED_WITHIN_S,
        stop: stop_rule(protocol, scale)?,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_seat_page::Event;

    /// The probe of a study that asks one item, which is delivered so; nobody is stopped, or by this rule.
    fn probe_of(delivery: &str, stop_if: Option<&str>) -> Result<AskedProbe, Hindrance> {
        let scale = format!(
            "id = \"feeling\"\ntitle = \"Feeling\"\nreference = \"made for this test\"\ninstruction = \"As you feel now.\"\n\
             [[item]]\n{delivery}\n"
        );
        let protocol = Protocol {
            probe: Some(Probe { scale: "feeling".to_owned(), every_s: 60.0 }),
            stop_if: stop_if.map(|rule| rule.parse().unwrap()),
            ..Protocol::default()
        };
        let probe = probe(&protocol, &[Scale::from_toml(&scale).unwrap()], "en")?;
        Ok(probe.unwrap())
    }

    #[test]
    fn a_probe_is_sent_as_its_scale_says_that_it_is_asked() {
        let ladder = "kind = \"ladder\"\nmin = 0\ntext = \"How do you feel?\"\nlevels = [\"well\", \"uneasy\", \"sick\"]";
        let probe = probe_of(ladder, Some("feeling >= 1")).unwrap();
        let sent = serde_json::to_value(&probe).unwrap();
        assert_eq!(sent["instruction"], "As you feel now.");
        let question = &sent["question"];
        assert_eq!(question["kind"], "ladder");
        assert_eq!(question["text"], "How do you feel?");
        let levels = serde_json::json!(["well", "uneasy", "sick"]);
        assert_eq!(question["anchors"], levels);
        assert!(probe.takes(0) && probe.takes(2));
        assert!(!probe.takes(-1) && !probe.takes(3));
        assert!(probe.stops(1) && probe.stops(2) && !probe.stops(0));
        let read: AskedProbe = serde_json::from_value(sent).unwrap();
        assert_eq!(read, probe);
    }

    #[test]
    fn an_answer_is_one_of_those_that_have_a_button() {
        let line = "kind = \"slider\"\ntext = \"How sick?\"\nmin = 0\nmax = 100\nstep = 25\nanchors = [\"not\", \"very\"]";
        let probe = probe_of(line, None).unwrap();
        assert_eq!(probe.question.words.anchors, ["not", "very"]);
        assert!(probe.takes(75) && !probe.takes(80) && !probe.stops(100));
        let answer = |points: f64| {
            let event =
                Event { tick: 6_100, what: "probe:feeling".to_owned(), points: Some(points) };
            probe.answer(&event).unwrap()
        };
        assert_eq!(answer(75.0), Ok((60.0, Some(75))));
        for none in [80.0, 75.5, -25.0, 1e12] {
            let told = answer(none).unwrap_err();
            assert!(told.contains("0 to 100 by 25"), "{told}");
        }
    }

    #[test]
    fn what_is_written_and_not_pressed_is_no_probe() {
        for (delivery, kind) in [
            ("kind = \"number\"\ntext = \"How sick?\"\nmin = 0\nmax = 10", "`number`"),
            ("kind = \"text\"\ntext = \"How do you feel?\"", "`text`"),
        ] {
            let refused = probe_of(delivery, None).unwrap_err();
            let told = format!("{refused}; {}", refused.remedy());
            for word in ["`feeling`", kind, "\"ladder\""] {
                assert!(told.contains(word), "{word}: {told}");
            }
        }
        let line = |step: u32| {
            let line = "kind = \"slider\"\ntext = \"How sick?\"\nmin = 0\nmax = 100\nanchors = [\"not\", \"very\"]";
            probe_of(&format!("{line}\nstep = {step}"), None)
        };
        assert!(line(5).is_ok());
        let told = line(4).unwrap_err().to_string();
        assert!(told.contains("26 answers, expected 21 at most"), "{told}");
    }
}

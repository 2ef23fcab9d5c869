//! Whether the seat can run a study: all that it cannot is found before anybody is let in, also what only a later phase needs.

use crate::{
    crash,
    hindrance::Hindrance,
    moments,
    plan::{car, ridden_elsewhere},
    steps::{Texts, sheet},
    withdrawal,
};
use maveric_domain::{
    Design, Moment, Scale,
    design::{Car, Condition, FEWEST_DONORS, ProtocolStep, Software, WHICH},
};
use maveric_model::{
    Model, ModelError,
    style_space::{LinearHead, Matching, PerpendicularEllipse},
};

/// All that keeps the seat from running a study, in the order of the design; nothing for one that it can run to its end.
pub(crate) fn hindrances(
    design: &Design,
    (scales, texts): (&[Scale], &Texts),
    model: Option<&Model>,
) -> Vec<Hindrance> {
    let (protocol, conditions) = (design.protocol(), design.conditions());
    let asks = |step| protocol.steps.contains(&step);
    let mut problems = Vec::new();
    let software = design.files().software;
    if software != Software::Table {
        problems.push(Hindrance::Software { software });
    }
    let consent = texts.consent.as_ref().filter(|_| asks(ProtocolStep::Consent));
    if let Some(text) = consent {
        let until = protocol.withdraw_until.as_deref();
        problems.extend(withdrawal::in_consent(text, until, &texts.words).err());
    }
    let consent = consent.map(String::as_str);
    problems.extend(crash::named(consent, protocol.crash).err());
    let before = protocol.before.iter().filter(|_| asks(ProtocolStep::Before));
    let after = protocol.after.iter().filter(|_| asks(ProtocolStep::Rides));
    let (screen, post) = (&protocol.screen, &protocol.post);
    let scales_asked = screen.iter().chain(before).chain(after).chain(post);
    let which = protocol.which.map(|_| WHICH);
    for id in scales_asked.map(String::as_str).chain(which) {
        let missing = sheet(scales, id, Moment::Pre, &texts.words.language).err();
        problems.extend(missing.filter(|hindrance| !problems.contains(hindrance)));
    }
    let unanswerable = [
        moments::screen(protocol, scales, &texts.words.language).err(),
        moments::probe(protocol, scales, &texts.words.language).err(),
    ];
    for hindrance in unanswerable.into_iter().flatten() {
        if !problems.contains(&hindrance) {
            problems.push(hindrance);
        }
    }
    let learns = design.model().is_none() && design.people().learn.is_some();
    let is_asked = |scale| asks(ProtocolStep::Before) && protocol.before.contains(scale);
    let unasked = design.style().filter(|style| learns && !is_asked(&style.score.scale));
    problems.extend(unasked.map(|style| Hindrance::StyleNotAsked { score: style.score.clone() }));
    if learns && !asks(ProtocolStep::Drive) {
        problems.push(Hindrance::NoDrive);
    }
    if !asks(ProtocolStep::Rides) || ridden_elsewhere(design) {
        return problems;
    }
    if model.is_none() && !learns && design.needs_a_model() {
        problems.push(Hindrance::NoModel);
    }
    for condition in conditions {
        problems.extend(car(condition).err());
        let hides = matches!(condition.car, Some(Car::Matched(_) | Car::Replay));
        if hides && protocol.debrief.is_none() {
            problems.push(Hindrance::NoDebriefing { condition: condition.id });
        }
        let lends = matches!(condition.car, Some(Car::Matched(_)));
        let donors = model.map(|model| model.training().len());
        problems.extend(donors.filter(|n| lends && *n < FEWEST_DONORS).map(|donors| {
            Hindrance::FewDonors {
                condition: condition.id,
                donors,
                learned_here: design.model().is_none(),
            }
        }));
        if let Some(Err(error)) = model.map(|model| asked_of(model, condition)) {
            problems
                .push(Hindrance::NotByModel { condition: condition.id, why: error.to_string() });
        }
    }
    problems
}

/// Whether the model has what a condition asks of it.
fn asked_of(model: &Model, condition: &Condition) -> Result<(), ModelError> {
    match &condition.car {
        Some(Car::Across) => PerpendicularEllipse::of(model).map(drop),
        Some(Car::Matched(matched)) => Matching::of(model, matched.apart_sd).map(drop),
        Some(Car::Free) => LinearHead::aggression(model).map(drop),
        _ if condition.side().is_some() => LinearHead::aggression(model).map(drop),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOUND: &str = r#"
[study]
title = "Two phases"
[people]
learn = { part = "learn" }
[style]
score = "mood.total"
range = [1, 5]
[[condition]]
id = "mine"
car = { dial = 0, recorded = true }
[[condition]]
id = "sporty"
car = { dial = 1, recorded = true }
[baseline]
id = "own"
[protocol]
before = ["mood"]
after = ["mood"]
"#;

    fn mood(wording: &str) -> Scale {
        let text = format!(
            "id = \"mood\"\ntitle = \"Mood\"\nreference = \"made for this test\"\nitems = 2\nmin = 1\nmax = 5\nscoring = \"mean\"\n{wording}\n\
             [[subscales]]\nid = \"total\"\ntitle = \"Mood\"\nitems = [1, 2]\n"
        );
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("mood.toml"), text).unwrap();
        let mut scales = maveric_study::run_folder::read_scales(folder.path()).unwrap();
        scales.remove(0)
    }

    fn of(design: &str, wording: &str, consent: Option<&str>) -> Vec<Hindrance> {
        let texts = Texts { consent: consent.map(str::to_owned), ..Texts::default() };
        let design = Design::from_toml(design).unwrap();
        hindrances(&design, (&[mood(wording)], &texts), None)
    }

    const WORDED: &str = "wording = [\"I am calm.\", \"I am tense.\"]";

    #[test]
    fn a_study_that_can_be_run_has_no_hindrance() {
        assert_eq!(of(SOUND, WORDED, Some("You may leave.")), []);
        // Who only drives and is not learned from here is asked nothing.
        let hand = "[study]\ntitle = \"By hand\"\n[baseline]\nid = \"own\"\n[[condition]]\nid = \"x\"\ncar = { recorded = true }\n\
                    [protocol]\nsteps = [\"drive\"]\n";
        assert_eq!(of(hand, "", None), []);
    }

    #[test]
    fn a_crash_that_is_felt_is_a_hindrance_until_the_consent_names_it() {
        let felt = SOUND.replace("[protocol]\n", "[protocol]\ncrash = \"felt\"\n");
        assert_eq!(of(&felt, WORDED, Some("You may leave.")), [Hindrance::CrashNotNamed]);
        assert_eq!(of(&felt, WORDED, None), [Hindrance::CrashNotNamed]);
        assert_eq!(of(&felt, WORDED, Some("{crash} You may leave.")), []);
        assert_eq!(of(SOUND, WORDED, Some("{crash}")), [Hindrance::NoCrash]);
    }

    #[test]
    fn which_ride_it_was_is_asked_by_a_scale_that_has_to_be_there() {
        let asked = format!("{SOUND}which = [\"mine\", \"sporty\"]\ndebrief = \"debrief.md\"\n");
        let hindrances = of(&asked, WORDED, Some("You may leave."));
        assert!(
            matches!(&hindrances[..], [Hindrance::UnknownScale { scale, .. }] if scale == "which"),
            "{hindrances:?}"
        );
    }

    #[test]
    fn all_that_is_missing_is_in_one_list_also_what_only_the_rides_need() {
        let faulty = SOUND
            .replace("before = [\"mood\"]", "before = [\"moood\"]")
            .replace(
                "title = \"Two phases\"",
                "title = \"Two phases\"\n[files]\nsoftware = \"otree\"",
            )
            .replace("dial = 1, recorded = true", "dial = 1");
        let found = of(&faulty, "", Some("Until {withdraw_until} you may leave."));
        let software = Software::Otree;
        let id = |id: &str| id.parse().unwrap();
        assert_eq!(
            found,
            [
                Hindrance::Software { software },
                Hindrance::NoLastDay,
                Hindrance::UnknownScale {
                    scale: "moood".to_owned(),
                    known: vec!["mood".to_owned()],
                    nearest: Some("mood".to_owned()),
                },
                Hindrance::NoWording { scale: "mood".to_owned(), worded: 0, items: 2 },
                Hindrance::StyleNotAsked { score: "mood.total".parse().unwrap() },
                Hindrance::SimulatedAgain { condition: id("sporty") },
            ]
        );
        let said = crate::SeatError::Unfit(found).to_string();
        for part in ["- `files.software` is", "did you mean `mood`?", "before = [\"mood\"]"] {
            assert!(said.contains(part), "{said}");
        }
        assert_eq!(said.lines().count(), 7);
    }

    #[test]
    fn who_is_learned_from_has_to_drive() {
        let answers = SOUND.replace("after = [\"mood\"]", "steps = [\"consent\", \"before\"]");
        assert_eq!(of(&answers, WORDED, None), [Hindrance::NoDrive]);
    }

    #[test]
    fn the_style_has_to_be_asked_only_where_somebody_is_learned_from() {
        let unasked = SOUND.replace("before = [\"mood\"]\n", "");
        let score = "mood.total".parse().unwrap();
        assert_eq!(of(&unasked, WORDED, None), [Hindrance::StyleNotAsked { score }]);
        let elsewhere = unasked.replace("[style]", "[model]\nfile = \"lab.maveric\"\n[style]");
        assert_eq!(of(&elsewhere, WORDED, None), [Hindrance::NoModel]);
    }
}

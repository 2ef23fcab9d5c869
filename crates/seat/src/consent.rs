//! What was agreed to beside the text of the consent, and how many people did not agree.

use crate::{
    books::Books, error::SeatError, listed::KeptSheet, person::Person, steps::Step, token,
};
use maveric_domain::{Design, DriveId, ParticipantId, Ride};
use maveric_model::Model;
use maveric_study::{stages::steer::withheld_drives, tables::collected::NotAgreed};
use std::collections::BTreeSet;

/// The step at which somebody is asked to agree, and the text; none where nothing is agreed to.
fn consent(person: &Person) -> Option<(usize, &str)> {
    let mut steps = person.steps.iter().enumerate();
    steps.find_map(|(at, step)| match step {
        Step::Text { text, agree: true, .. } => Some((at, text.as_str())),
        _ => None,
    })
}

/// Whether somebody's style may be lent to others: where there is a consent, only of whoever ticked its box; where nothing is agreed to,
/// nobody is asked.
pub(crate) fn lets_lend(person: &Person, sheets: &[KeptSheet]) -> bool {
    let Some((at, _)) = consent(person) else {
        return true;
    };
    let kept = sheets.iter().find(|kept| kept.step == at);
    let sheet = kept.and_then(KeptSheet::sheet);
    sheet.and_then(|sheet| sheet.style_lent) == Some(true)
}

/// The drives by hand of a person, by their names.
fn driven_by_hand(person: &Person) -> Result<Vec<DriveId>, SeatError> {
    let who = ParticipantId::new(&*person.participant)?;
    let drives = person.steps.iter().filter_map(Step::drives);
    let by_hand = drives.filter(|(_, by_hand)| *by_hand);
    let name = |(ride, _): (Ride, bool)| DriveId::in_condition(&who, ride);
    Ok(by_hand.map(name).collect::<Result<_, _>>()?)
}

/// The drives by hand of those people who do not let their style be lent.
pub(crate) fn withheld(b: &Books<'_>) -> Result<BTreeSet<DriveId>, SeatError> {
    let mut withheld = BTreeSet::new();
    for person in b.everybody()? {
        if !lets_lend(&person, &b.answers(&person.participant)?) {
            withheld.extend(driven_by_hand(&person)?);
        }
    }
    Ok(withheld)
}

/// The drives of whoever is forgotten that a model of this study learned from.
pub(crate) fn of_forgotten(
    b: &Books<'_>,
    design: &Design,
    model: &Model,
) -> Result<BTreeSet<DriveId>, SeatError> {
    let ids = b.forgotten()?.into_iter();
    let forgotten: BTreeSet<ParticipantId> =
        ids.filter_map(|id| ParticipantId::new(id).ok()).collect();
    let learned = model.training().iter().map(|training| &training.drive);
    Ok(withheld_drives(&forgotten, design, learned))
}

impl Books<'_> {
    /// Counts somebody who leaves now by the text that they do not agree to; false where they are elsewhere.
    pub(crate) fn refuse_consent(&self, person: &Person) -> Result<bool, SeatError> {
        let unanswered =
            consent(person).filter(|(at, _)| *at == person.at && person.ended.is_none());
        let Some((_, text)) = unanswered else {
            return Ok(false);
        };
        self.change(
            "INSERT INTO not_agreed (text_sha256, people) VALUES (?1, 1) ON CONFLICT DO UPDATE SET people = people + 1",
            [token::sha256(text)],
        )?;
        Ok(true)
    }

    /// How many people did not agree, by the text.
    pub(crate) fn not_agreed(&self) -> Result<Vec<NotAgreed>, SeatError> {
        let question = "SELECT text_sha256, people FROM not_agreed ORDER BY text_sha256";
        self.rows(question, [], |row| {
            Ok(NotAgreed { text_sha256: row.get(0)?, people: row.get::<_, i64>(1)? as usize })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{listed::Listed, sheet::Sheet, store::Store};

    fn text(lend: Option<&str>) -> Step {
        Step::Text {
            title: "A study".to_owned(),
            text: "You drive.".to_owned(),
            agree: true,
            lend: lend.map(str::to_owned),
        }
    }

    fn person(consent: Option<Step>) -> Person {
        let steps = consent.into_iter().chain([Step::Controls]).collect();
        Person::new("t".to_owned(), "P001".to_owned(), steps)
    }

    fn checked(step: &Step, body: &str) -> Result<String, String> {
        let sheet: Sheet = serde_json::from_str(body).unwrap();
        sheet.checked(step)
    }

    fn lends(step: Step, body: &str) -> bool {
        let kept = KeptSheet {
            step: 0,
            body: checked(&step, body).unwrap(),
            given: 0,
            listed: Listed::NotYet,
        };
        lets_lend(&person(Some(step)), &[kept])
    }

    const TICKED: &str = r#"{"agreed":true,"style_lent":true,"seconds":4}"#;
    const LEFT: &str = r#"{"agreed":true,"style_lent":false,"seconds":4}"#;
    const AGREED: &str = r#"{"agreed":true,"seconds":4}"#;

    #[test]
    fn a_style_is_lent_of_whoever_ticked_the_box_and_of_nobody_else_who_was_to_agree() {
        let asked = || text(Some("Others may be driven in my style."));
        assert!(lends(asked(), TICKED));
        assert!(!lends(asked(), LEFT) && !lends(asked(), AGREED));
        // A page showed no box, and nothing is kept as if it had; and somebody has not agreed yet.
        let kept = checked(&asked(), AGREED).unwrap();
        assert!(!kept.contains("style_lent"), "{kept}");
        assert!(!lends(text(None), AGREED));
        assert!(!lets_lend(&person(Some(asked())), &[]));
        // Where nothing is agreed to nobody is asked.
        assert!(lets_lend(&person(None), &[]));
        // A box that is not there is ticked by nobody, and alone it is no consent.
        assert!(checked(&text(None), TICKED).is_err());
        assert!(checked(&Step::Break { seconds: 0.0 }, TICKED).is_err());
        assert!(checked(&asked(), r#"{"style_lent":true,"seconds":4}"#).is_err());
    }

    #[test]
    fn the_drives_of_whoever_did_not_tick_the_box_are_withheld_and_of_whoever_did_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("seat.db")).unwrap();
        let asked = || text(Some("Others may be driven in my style."));
        let drive = |session: u32| Step::Drive {
            condition: "own".parse().unwrap(),
            occasion: maveric_domain::Occasion::new(session, 1).unwrap(),
            seconds: 60.0,
            seed: "1".to_owned(),
            probe: None,
        };
        let steps = || vec![asked(), drive(1), drive(2)];
        let answered = |id: &str, body: Option<&str>| {
            let person = Person::new(id.to_owned(), id.to_owned(), steps());
            let kept = body.map(|body| checked(&asked(), body).unwrap());
            store
                .within(|b| {
                    b.add(&person)?;
                    kept.iter().try_for_each(|kept| b.answer(&person, 0, kept))
                })
                .unwrap();
        };
        answered("P001", Some(TICKED));
        answered("P002", Some(LEFT));
        answered("P003", Some(AGREED));
        answered("P004", None);
        let withheld = store.look(withheld).unwrap();
        let withheld: Vec<String> = withheld.iter().map(ToString::to_string).collect();
        let both = |who: &str| [format!("{who}-own"), format!("{who}-own_s2_t1")];
        assert_eq!(withheld, ["P002", "P003", "P004"].map(both).concat());
    }

    #[test]
    fn whoever_leaves_where_they_are_to_agree_is_counted_by_the_text_and_nobody_else_is() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("seat.db")).unwrap();
        let refuses = |person: &Person| store.within(|b| b.refuse_consent(person)).unwrap();
        let here = person(Some(text(None)));
        let past = Person { at: 1, ..here.clone() };
        let over = Person { ended: Some("left".to_owned()), ..here.clone() };
        assert!(refuses(&here) && refuses(&here));
        assert!(!refuses(&past) && !refuses(&over) && !refuses(&person(None)));
        let counted = store.look(|b| {
            let rows = b.not_agreed()?.into_iter();
            let rows = rows.map(|row| (row.text_sha256, row.people));
            Ok::<_, SeatError>(rows.collect::<Vec<_>>())
        });
        assert_eq!(counted.unwrap(), [(token::sha256("You drive."), 2)]);
    }
}

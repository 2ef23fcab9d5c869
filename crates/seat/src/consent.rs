//! What was agreed to beside the text of the consent, and how many people did not agree.

use crate::{
    books::Books, error::SeatError, listed::KeptSheet, person::Person, steps::Step, token,
};
use maveric_domain::{Design, DriveId, ParticipantId};
use maveric_study::{stages::steer::withheld_drives, tables::collected::NotAgreed};
use std::collections::BTreeSet;

/// The step at which somebody is asked to agree, and the text; none where nothing is agreed to.
fn consent(person: &Person) -> Option<(usize, &str)> {
    let mut steps = person.steps.iter().enumerate();
    steps.find_map(|(at, step)| match step {
        Step::Text {
            text, agree: true, ..
        } => Some((at, text.as_str())),
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

/// Those of the drives that a model of this study learned from that nobody may be driven by: of whoever does not let their style be lent, and of
/// whoever is forgotten.
pub(crate) fn withheld<'a>(
    b: &Books<'_>,
    design: &Design,
    learned: impl IntoIterator<Item = &'a DriveId>,
) -> Result<BTreeSet<DriveId>, SeatError> {
    let mut people = b.forgotten()?;
    for person in b.everybody()? {
        if !lets_lend(&person, &b.answers(&person.participant)?) {
            people.push(person.participant);
        }
    }
    let ids = people.into_iter();
    let people = ids.filter_map(|id| ParticipantId::new(id).ok()).collect();
    Ok(withheld_drives(&people, design, learned))
}

impl Books<'_> {
    /// Counts somebody who leaves now by the text that they do not agree to; false where they are elsewhere.
    pub(crate) fn refuse_consent(&self, person: &Person) -> Result<bool, SeatError> {
        let asked = consent(person).filter(|(at, _)| *at == person.at && person.ended.is_none());
        let Some((_, text)) = asked else {
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
            Ok(NotAgreed {
                text_sha256: row.get(0)?,
                people: row.get::<_, i64>(1)? as usize,
            })
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
        // A page showed no box, and nothing is kept as if it had; nor was there one in an older version; and somebody has not agreed yet.
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
        let answered = |id: &str, body: Option<&str>| {
            let person = Person::new(id.to_owned(), id.to_owned(), vec![asked()]);
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
        let people = (1..=6).map(|number| format!("P00{number}"));
        let both = |who: String| [format!("{who}-own"), format!("{who}-own_s2_t1")];
        let learned: Vec<DriveId> = people
            .flat_map(both)
            .map(|id| DriveId::new(id).unwrap())
            .collect();
        let design = "[study]\ntitle = \"Two\"\n[people]\nlearn = { part = \"learn\" }\n[style]\nscore = \"adb.total\"\n\
                      [[condition]]\nid = \"faster\"\ncar = { dial = 15 }\n";
        let design = Design::from_toml(design).unwrap();
        let withheld = || store.look(|b| withheld(b, &design, &learned)).unwrap();
        assert_eq!(withheld(), BTreeSet::from_iter(learned[2..8].to_vec()));
        // Whoever is forgotten is driven by no more, and of somebody who is not among the seat's people nothing is known.
        store.within(|b| b.forget("P001")).unwrap();
        assert_eq!(withheld(), BTreeSet::from_iter(learned[..8].to_vec()));
    }

    #[test]
    fn whoever_leaves_where_they_are_to_agree_is_counted_by_the_text_and_nobody_else_is() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("seat.db")).unwrap();
        let refuses = |person: &Person| store.within(|b| b.refuse_consent(person)).unwrap();
        let here = person(Some(text(None)));
        let past = Person {
            at: 1,
            ..here.clone()
        };
        let over = Person {
            ended: Some("left".to_owned()),
            ..here.clone()
        };
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

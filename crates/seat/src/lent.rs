//! Whose styles were lent to whom, as it is kept: in the steps of those who ride them.

use crate::{books::Books, error::SeatError, listed::Listed, person::Person, steps::Step};
use maveric_domain::{ConditionId, DriveId, Embedding, Lent, Occasion, ParticipantId};
use maveric_seat_page::RideStyle;
use maveric_study::tables::collected::LentRow;

/// In the place of a donor who was forgotten.
const FORGOTTEN: &str = "forgotten";

/// The name of the drive by hand that somebody's style is learned of.
pub(crate) fn by_hand(person: &Person) -> Option<DriveId> {
    let mut drives = person.steps.iter().filter_map(Step::drives);
    let (drive, _) = drives.find(|(_, by_hand)| *by_hand)?;
    let who = ParticipantId::new(&*person.participant).ok()?;
    DriveId::in_condition(&who, drive).ok()
}

/// The styles that were lent to somebody, each with its condition and as it is ridden: the same in each ride of the condition.
pub(crate) fn lent_to(person: &Person) -> impl Iterator<Item = (ConditionId, &Lent, &Embedding)> {
    person.steps.iter().filter_map(|step| match step {
        Step::Ride {
            condition,
            occasion: Occasion::FIRST,
            style: RideStyle::Given(style),
            lent: Some(lent),
            ..
        } => Some((*condition, lent, style)),
        _ => None,
    })
}

/// The styles that were lent to somebody, as rows.
pub(crate) fn rows_of(person: &Person) -> Result<Vec<LentRow>, SeatError> {
    let participant = ParticipantId::new(&*person.participant)?;
    let row = |(condition, lent, embedding): (ConditionId, &Lent, &Embedding)| LentRow {
        participant: participant.clone(),
        condition,
        lent: lent.clone(),
        embedding: embedding.clone(),
    };
    Ok(lent_to(person).map(row).collect())
}

impl Books<'_> {
    /// The styles that were lent to everybody but who was taken out of the study's table.
    pub(crate) fn lent(&self) -> Result<Vec<LentRow>, SeatError> {
        let mut everybody = self.everybody()?;
        everybody.retain(|person| person.listed != Listed::TakenOut);
        let rows: Result<Vec<_>, SeatError> = everybody.iter().map(rows_of).collect();
        Ok(rows?.concat())
    }

    /// Nobody's steps name a donor any more who is forgotten: what was ridden stays, whose it was does not.
    pub(crate) fn without_donor(&self, participant: &str) -> Result<(), SeatError> {
        let everybody = self.everybody()?;
        let gone = everybody.iter().find(|p| p.participant == participant);
        let Some(gone) = gone.and_then(by_hand) else {
            return Ok(());
        };
        for mut person in everybody {
            let mut changed = false;
            for step in &mut person.steps {
                if let Step::Ride { lent: Some(lent), .. } = step
                    && lent.donor == gone
                {
                    lent.donor = DriveId::new(FORGOTTEN)?;
                    changed = true;
                }
            }
            if changed {
                self.set_steps(&person.participant, &person.steps)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Store;

    fn person(id: &str, donor: Option<&str>) -> Person {
        let drive = Step::Drive {
            condition: "own".parse().unwrap(),
            occasion: maveric_domain::Occasion::FIRST,
            seconds: 60.0,
            seed: "1".to_owned(),
            probe: None,
        };
        let ride = Step::Ride {
            condition: "other".parse().unwrap(),
            occasion: maveric_domain::Occasion::FIRST,
            number: 1,
            seconds: 60.0,
            seed: "1".to_owned(),
            style: RideStyle::Given(Embedding::new(vec![0.5, 1.0]).unwrap()),
            points: 0.0,
            turns: None,
            lent: donor.map(|donor| Lent {
                donor: DriveId::new(donor).unwrap(),
                donor_shift_points: 2.0,
                donor_distance_sd: 1.0,
                donor_within_reach: true,
            }),
            probe: None,
        };
        Person::new(id.to_owned(), id.to_owned(), vec![drive, ride])
    }

    #[test]
    fn whoever_lent_a_style_and_is_forgotten_is_named_in_nobodys_ride() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("seat.db")).unwrap();
        let people = [
            person("P001", None),
            person("P002", Some("P001-own")),
            person("P003", Some("P002-own")),
        ];
        store.within(|b| people.iter().try_for_each(|person| b.add(person))).unwrap();
        let donors = || -> Vec<(String, String)> {
            let row = |row: LentRow| (row.participant.to_string(), row.lent.donor.to_string());
            let rows = store.look(|b| b.lent().map(|rows| rows.into_iter().map(row).collect()));
            rows.unwrap()
        };
        let row = |who: &str, donor: &str| (who.to_owned(), donor.to_owned());
        assert_eq!(donors(), [row("P002", "P001-own"), row("P003", "P002-own")]);
        store.within(|b| b.forget("P001")).unwrap();
        assert_eq!(donors(), [row("P002", FORGOTTEN), row("P003", "P002-own")]);
    }
}

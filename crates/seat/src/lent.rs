//! Whose style is lent to somebody, once their own is known.

use crate::{books::Books, error::SeatError, person::Person, seat::Seat, steps::Step};
use maveric_domain::{ConditionId, DriveId, Embedding, Lent, ParticipantId, design::Car};
use maveric_seat_page::{Fit, RideStyle};
use maveric_study::{StudyError, lending::Lending, tables::collected::LentRow};

/// In the place of a donor who was forgotten.
const FORGOTTEN: &str = "forgotten";

/// The name of the drive by hand that somebody's style is learned of.
fn by_hand(person: &Person) -> Option<DriveId> {
    let mut drives = person.steps.iter().filter_map(Step::drives);
    let (condition, _) = drives.find(|(_, by_hand)| *by_hand)?;
    let who = ParticipantId::new(&*person.participant).ok()?;
    DriveId::in_condition(&who, condition).ok()
}

/// What somebody may lend: nothing whose drive shows no habit, or is beyond what the model has met.
fn lends(person: &Person, style: &Fit) -> Option<(DriveId, Embedding)> {
    let known = style.readings > 0 && style.beyond.is_none();
    let embedding = Embedding::new(style.embedding.clone()).ok()?;
    known.then_some((by_hand(person)?, embedding))
}

impl Seat {
    /// Draws whose style is lent in those rides of a person's steps that have somebody else's; `style` is what was learned of their drive.
    ///
    /// Whoever rode where no server was has ridden in the style that the page drew: it stays.
    pub(crate) fn lend(
        &self,
        b: &Books<'_>,
        person: &Person,
        style: &str,
    ) -> Result<(), SeatError> {
        let waits = |step: &Step| {
            matches!(
                step,
                Step::Ride {
                    style: RideStyle::Lent { .. },
                    ..
                }
            )
        };
        let style = Person {
            fit: Some(style.to_owned()),
            ..person.clone()
        }
        .style();
        let (Some(model), Some(own)) = (&self.model, style) else {
            return Ok(());
        };
        let (Some(drive), Ok(embedding)) = (by_hand(person), Embedding::new(own.embedding.clone()))
        else {
            return Ok(());
        };
        let mut steps = person.steps.clone();
        if !steps.iter().any(waits) {
            return Ok(());
        }
        let mut others = self.seen(b.everybody()?);
        others.retain(|other| other.token != person.token);
        let fits = others
            .iter()
            .filter_map(|other| lends(other, &other.style()?));
        let tested: Vec<(DriveId, Embedding)> = fits.chain(lends(person, &own)).collect();
        for step in &mut steps {
            let Step::Ride {
                condition,
                style,
                stretch,
                lent,
                ..
            } = step
            else {
                continue;
            };
            let RideStyle::Lent { seed, .. } = style else {
                continue;
            };
            let car = self.settings.design.condition(*condition).map(|c| &c.car);
            let drawn = match car {
                Some(Some(Car::Matched(matched))) if person.ended.is_none() => {
                    let mut lending = Lending::of(model, *matched, tested.clone())?;
                    others
                        .iter()
                        .filter_map(|other| lent_to(other, *condition))
                        .for_each(|lent| lending.count(&lent.donor));
                    lending.lend((&drive, &embedding), seed.0)?
                }
                _ => {
                    let placed = style
                        .place(model, &embedding, 0.0)
                        .map_err(StudyError::from)?;
                    placed.lent.map(|lent| (placed.embedding, lent))
                }
            };
            if let Some((embedding, from)) = drawn {
                *style = RideStyle::Given(embedding);
                *lent = Some(Lent {
                    donor_shift_points: from.donor_shift_points / *stretch,
                    ..from
                });
            }
        }
        b.set_steps(&person.participant, &steps)
    }
}

/// The style that was lent to somebody in a condition.
fn lent_to(person: &Person, ridden: ConditionId) -> Option<&Lent> {
    person.steps.iter().find_map(|step| match step {
        Step::Ride {
            condition, lent, ..
        } if *condition == ridden => lent.as_ref(),
        _ => None,
    })
}

impl Books<'_> {
    /// Every style that was lent.
    pub(crate) fn lent(&self) -> Result<Vec<LentRow>, SeatError> {
        let mut rows = Vec::new();
        for person in self.everybody()? {
            let participant = ParticipantId::new(&*person.participant).map_err(StudyError::from)?;
            for step in person.steps {
                if let Step::Ride {
                    condition,
                    style: RideStyle::Given(embedding),
                    lent: Some(lent),
                    ..
                } = step
                {
                    rows.push(LentRow {
                        participant: participant.clone(),
                        condition,
                        donor: lent.donor,
                        donor_shift_points: lent.donor_shift_points,
                        donor_distance_sd: lent.donor_distance_sd,
                        donor_within_reach: lent.donor_within_reach,
                        embedding,
                    });
                }
            }
        }
        Ok(rows)
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
                if let Step::Ride {
                    lent: Some(lent), ..
                } = step
                    && lent.donor == gone
                {
                    lent.donor = DriveId::new(FORGOTTEN).map_err(StudyError::from)?;
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
            seconds: 60.0,
            seed: "1".to_owned(),
            probe: None,
        };
        let ride = Step::Ride {
            condition: "other".parse().unwrap(),
            number: 1,
            seconds: 60.0,
            seed: "1".to_owned(),
            style: RideStyle::Given(Embedding::new(vec![0.5, 1.0]).unwrap()),
            points: 0.0,
            stretch: 1.0,
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
        store
            .within(|b| people.iter().try_for_each(|person| b.add(person)))
            .unwrap();
        let donors = || -> Vec<(String, String)> {
            let row = |row: LentRow| (row.participant.to_string(), row.donor.to_string());
            let rows = store.look(|b| b.lent().map(|rows| rows.into_iter().map(row).collect()));
            rows.unwrap()
        };
        let row = |who: &str, donor: &str| (who.to_owned(), donor.to_owned());
        assert_eq!(donors(), [row("P002", "P001-own"), row("P003", "P002-own")]);
        store.within(|b| b.forget("P001")).unwrap();
        assert_eq!(donors(), [row("P002", FORGOTTEN), row("P003", "P002-own")]);
    }
}

//! Whose style is lent to somebody, once their own is known.

use crate::{
    books::Books,
    consent::{lets_lend, of_forgotten},
    error::SeatError,
    hindrance::Hindrance,
    lent::{by_hand, lent_to},
    person::{Person, style_kept},
    seat::Seat,
    steps::Step,
};
use maveric_domain::{
    DriveId, Embedding,
    design::{Car, FEWEST_DONORS},
};
use maveric_model::ModelError;
use maveric_seat_page::{Fit, Lending, RideStyle};
use maveric_study::StudyError;
use std::collections::BTreeSet;

/// What somebody may lend: nothing whose drive shows no habit, or is beyond what the model has met.
fn lends(person: &Person, style: &Fit) -> Option<(DriveId, Embedding)> {
    let known = style.readings > 0 && style.beyond.is_none();
    let embedding = Embedding::new(style.embedding.clone()).ok()?;
    known.then_some((by_hand(person)?, embedding))
}

/// Those who are tested and lend theirs, with whoever is let in next: they count, whether they lend theirs or not.
fn with_the_next<T: Clone>(mut tested: Vec<T>) -> Vec<T> {
    let next = tested.first().cloned();
    tested.extend(next);
    tested
}

impl Seat {
    /// The conditions in which whoever is let in now would have somebody else's style, of too few who let theirs be lent.
    pub fn few_donors(&self) -> Result<Vec<Hindrance>, SeatError> {
        let tested = self.store.look(|b| self.tested(b, None))?;
        let mut few = Vec::new();
        let Some(model) = self.model.as_ref().filter(|_| self.rides()) else {
            return Ok(few);
        };
        let tested = with_the_next(tested);
        for condition in self.settings.design.conditions() {
            let Some(Car::Matched(matched)) = &condition.car else {
                continue;
            };
            let lending = Lending::of(model, *matched, tested.clone(), &self.withheld);
            let donors = lending.map_err(StudyError::from)?.lenders();
            if donors < FEWEST_DONORS {
                few.push(Hindrance::FewDonors {
                    condition: condition.id,
                    donors,
                    learned_here: self.settings.design.model().is_none(),
                });
            }
        }
        Ok(few)
    }

    /// Refuses to let somebody ride in such a condition.
    pub(crate) fn refuse_few_donors(&self) -> Result<(), SeatError> {
        let few = self.few_donors()?;
        let refused = |few: &Hindrance| Err(SeatError::cannot(few.to_string(), &few.remedy()));
        few.first().map_or(Ok(()), refused)
    }

    /// Writes into the rides that wait for somebody else's style which may not be lent; gives whether that is new.
    pub(crate) fn withhold(&self, steps: &mut [Step]) -> bool {
        let mut is_new = false;
        for step in steps {
            if let Step::Ride { style: RideStyle::Lent { withheld, .. }, .. } = step
                && *withheld != self.withheld
            {
                withheld.clone_from(&self.withheld);
                is_new = true;
            }
        }
        is_new
    }

    /// What those who ride may lend: of whoever lets it be lent, but for the person themselves.
    fn tested(
        &self,
        b: &Books<'_>,
        but: Option<&Person>,
    ) -> Result<Vec<(DriveId, Embedding)>, SeatError> {
        let mut tested = Vec::new();
        for other in self.seen(b.everybody()?) {
            let is_other = but.is_none_or(|person| person.token != other.token);
            // Whoever was only learned from is lent as the model knows them.
            if is_other
                && !other.rides().is_empty()
                && let Some(style) = other.style()
                && lets_lend(&other, &b.answers(&other.participant)?)
            {
                tested.extend(lends(&other, &style));
            }
        }
        Ok(tested)
    }

    /// Draws whose style is lent in those rides of a person's steps that have somebody else's; `style` is what was learned of their drive.
    pub(crate) fn lend(
        &self,
        b: &Books<'_>,
        person: &Person,
        style: &str,
    ) -> Result<(), SeatError> {
        let waits = |step: &Step| match step {
            Step::Ride { style, .. } => matches!(style, RideStyle::Lent { .. }),
            _ => false,
        };
        if !person.steps.iter().any(waits) {
            return Ok(());
        }
        let (Some(model), Some(own)) = (&self.model, style_kept(Some(style))) else {
            return Ok(());
        };
        let mut others = self.seen(b.everybody()?);
        others.retain(|other| other.token != person.token);
        let mut tested = self.tested(b, Some(person))?;
        // Counted among those who drove, and never lent to themselves.
        tested.extend(lends(person, &own));
        let drive = by_hand(person);
        let own_embedding = Embedding::new(own.embedding)?;
        // Somebody may have been forgotten since the seat was opened.
        let mut withheld = self.withheld.clone();
        withheld.extend(of_forgotten(b, &self.settings.design, model)?);
        let mut nobodys = BTreeSet::new();
        let mut steps = person.steps.clone();
        for step in &mut steps {
            let Step::Ride { condition, style, lent, .. } = step else {
                continue;
            };
            let RideStyle::Lent { seed, .. } = style else {
                continue;
            };
            let condition = self.settings.design.condition(*condition);
            let drawn = match condition.map(|c| (c.id, &c.car)) {
                Some((id, Some(Car::Matched(matched)))) => {
                    let lending = Lending::of(model, *matched, tested.clone(), &withheld);
                    let mut lending = lending.map_err(StudyError::from)?;
                    let before = others.iter().flat_map(lent_to);
                    before
                        .filter(|(ridden, ..)| *ridden == id)
                        .for_each(|(_, lent, _)| lending.count(&lent.donor));
                    lending.lend((drive.as_ref(), &own_embedding), seed.0)
                }
                _ => match style.place(model, &own_embedding, 0.0) {
                    Err(ModelError::NoDonor) => Ok(None),
                    placed => placed.map(|placed| Some(placed.embedding).zip(placed.lent)),
                },
            };
            let Some((embedding, from)) = drawn.map_err(StudyError::from)? else {
                nobodys.extend(condition.map(|condition| condition.id));
                continue;
            };
            *style = RideStyle::Given(embedding);
            *lent = Some(from);
        }
        for id in nobodys {
            let text =
                format!("condition {id}: there is nobody whose style may be lent: skip its rides");
            b.event(Some(&person.participant), &text)?;
        }
        b.set_steps(&person.participant, &steps)
    }
}

#[cfg(test)]
mod tests {
    use super::with_the_next;
    use maveric_domain::design::Donors;

    #[test]
    fn the_eleventh_rides_in_the_style_of_one_of_ten_who_are_tested_and_the_tenth_does_not() {
        let counted = |tested: usize| with_the_next(vec![(); tested]).len();
        assert!(counted(Donors::FROM) > Donors::FROM);
        assert!(counted(Donors::FROM - 1) <= Donors::FROM);
        assert_eq!(counted(0), 0);
    }
}

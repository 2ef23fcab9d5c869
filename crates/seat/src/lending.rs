//! Whose style is lent to somebody, once their own is known.

use crate::{
    books::Books,
    consent::lets_lend,
    error::SeatError,
    hindrance::Hindrance,
    lent::{by_hand, lent_to},
    person::{Person, style_kept},
    seat::Seat,
    steps::Step,
};
use maveric_domain::{
    DriveId, Embedding, Lent,
    design::{Car, FEWEST_DONORS},
};
use maveric_seat_page::{Fit, Lending, RideStyle};
use maveric_study::StudyError;

/// What somebody may lend: nothing whose drive shows no habit, or is beyond what the model has met.
fn lends(person: &Person, style: &Fit) -> Option<(DriveId, Embedding)> {
    let known = style.readings > 0 && style.beyond.is_none();
    let embedding = Embedding::new(style.embedding.clone()).ok()?;
    known.then_some((by_hand(person)?, embedding))
}

impl Seat {
    /// Refuses to open where a condition lends somebody else's style and too few of the people learned from let theirs be lent, while those who
    /// ride do not lend theirs yet.
    pub(crate) fn refuse_few_lenders(&self) -> Result<(), SeatError> {
        let Some(model) = self.model.as_ref().filter(|_| self.rides()) else {
            return Ok(());
        };
        let tested = self.store.look(|b| self.tested(b, None))?;
        let mut few = Vec::new();
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
                });
            }
        }
        if few.is_empty() {
            return Ok(());
        }
        Err(SeatError::Unfit(few))
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
    ///
    /// Whoever rode where no server was has ridden in the style that the page drew: it stays.
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
        let own_embedding = Embedding::new(own.embedding).map_err(StudyError::from)?;
        let mut steps = person.steps.clone();
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
            let condition = self.settings.design.condition(*condition);
            let matched = condition.filter(|_| person.ended.is_none());
            let drawn = match matched.map(|c| (c.id, &c.car)) {
                Some((id, Some(Car::Matched(matched)))) => {
                    let lending = Lending::of(model, *matched, tested.clone(), &self.withheld);
                    let mut lending = lending.map_err(StudyError::from)?;
                    let before = others.iter().flat_map(lent_to);
                    before
                        .filter(|(ridden, ..)| *ridden == id)
                        .for_each(|(_, lent, _)| lending.count(&lent.donor));
                    lending.lend((drive.as_ref(), &own_embedding), seed.0)
                }
                _ => style
                    .place(model, &own_embedding, 0.0)
                    .map(|placed| Some(placed.embedding).zip(placed.lent)),
            };
            if let Some((embedding, from)) = drawn.map_err(StudyError::from)? {
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

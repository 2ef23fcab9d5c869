//! In which language somebody goes on.

use crate::{error::SeatError, person::Person, request::Refused, seat::Seat, steps::Step};

impl Seat {
    /// Keeps the language that somebody chose, and says all that comes in it.
    pub(crate) fn choose(&self, token: &str, step: usize, wanted: &str) -> Result<usize, Refused> {
        let (person, found) = self.store.look(|b| b.at(token, step))?;
        let Step::Language { languages, .. } = &found else {
            return Err(Refused::NotThis("no language is asked for here".to_owned()));
        };
        if !languages.iter().any(|known| known == wanted) {
            let why = format!("`{wanted}`, expected {}", languages.join(", "));
            return Err(Refused::NotThis(why));
        }
        if person.at > step {
            return Ok(person.at);
        }
        let order = self.order_of(&person)?;
        let mut steps = self.steps_of(Some(wanted), &person.participant, &order)?;
        // What was made longer before stays so.
        for (new, old) in steps.iter_mut().zip(&person.steps) {
            if let (Some(seconds), Some((_, kept))) = (new.seconds_mut(), old.world()) {
                *seconds = kept;
            }
        }
        if let Some(Step::Language { chosen, .. }) = steps.get_mut(step) {
            *chosen = Some(wanted.to_owned());
        }
        let person = self.store.within(|b| {
            b.set_steps(&person.participant, &steps)?;
            b.go_on(&person, step)?;
            b.somebody(token)
        })?;
        self.add_link(&person);
        Ok(person.at)
    }

    /// The places of the conditions in the order in which somebody rides; none where they do not.
    fn order_of(&self, person: &Person) -> Result<Vec<usize>, SeatError> {
        let rides = person.rides();
        if rides.is_empty() {
            return Ok(Vec::new());
        }
        self.order_by_hand(&rides.join(" "))
    }
}

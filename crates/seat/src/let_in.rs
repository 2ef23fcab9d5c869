//! Who is let in: their id, their row of the square, their steps; and who never came.

use crate::{
    books::Books,
    error::SeatError,
    person::{NEVER_CAME, Person},
    seat::Seat,
    token,
};
use maveric_domain::{
    ParticipantId,
    design::{williams, williams_rows},
};
use std::collections::BTreeSet;

/// What the experimenter says of the next person.
#[derive(Debug, Clone, Default)]
pub struct Invitation {
    /// Their id; none: the next that nobody has.
    pub participant: Option<String>,
    /// The conditions in the order in which they ride, ids with spaces or commas between them; none: the row of the square that is free.
    pub order: Option<String>,
}

impl Books<'_> {
    /// The lowest row of `first` and every `apart`-th after it that nobody has: who left has none.
    fn free_row(&self, first: usize, apart: usize) -> Result<usize, SeatError> {
        let held: BTreeSet<usize> = self.rows(
            "SELECT row FROM person WHERE row IS NOT NULL AND (ended IS NULL OR ended = 'done')",
            [],
            |row| Ok(row.get::<_, i64>(0)? as usize),
        )?;
        let mut row = first;
        while held.contains(&row) {
            row += apart;
        }
        Ok(row)
    }

    /// Whether somebody takes part: they opened their link, were admitted and agreed. Nobody else stands in
    /// the study's tables.
    pub(crate) fn takes_part(&self, person: &Person) -> Result<bool, SeatError> {
        let question = "SELECT tab IS NOT NULL FROM person WHERE token = ?1";
        let opened = self.row(question, [&person.token], |row| row.get(0))?;
        Ok(person.is_let_in() && (person.at > 0 || opened == Some(true)))
    }
}

impl Seat {
    /// Rows of the square; one while nobody rides.
    pub(crate) fn orders(&self) -> usize {
        if self.rides() { williams_rows(self.settings.design.conditions().len()).max(1) } else { 1 }
    }

    /// The places of the conditions in this row of the square.
    pub(crate) fn order(&self, row: usize) -> Vec<usize> {
        williams(self.settings.design.conditions().len(), row)
    }

    /// The lowest row of this order that nobody has; none where the square does not have the order.
    fn row_of(&self, b: &Books<'_>, order: &[usize]) -> Result<Option<usize>, SeatError> {
        let mut rows = 0..self.orders();
        let first = rows.find(|row| self.order(*row) == order);
        first.map(|first| b.free_row(first, self.orders())).transpose()
    }

    /// The places of conditions that were named in an order, each of the study's once.
    pub(crate) fn order_by_hand(&self, text: &str) -> Result<Vec<usize>, SeatError> {
        let conditions = self.settings.design.conditions();
        let ids = || conditions.iter().map(|condition| condition.id.as_str());
        let help = format!("expected each of these once: {}", ids().collect::<Vec<_>>().join(" "));
        let cannot =
            |problem: String| SeatError::cannot(format!("the order `{text}`: {problem}"), &help);
        if !self.rides() {
            return Err(cannot("nobody rides in this phase of the study".to_owned()));
        }
        let mut order = Vec::new();
        for word in text.split([' ', ',']).filter(|word| !word.is_empty()) {
            let place = ids().position(|id| id == word);
            let place = place
                .ok_or_else(|| cannot(format!("`{word}` is not a condition of this study")))?;
            if order.contains(&place) {
                return Err(cannot(format!("`{word}` stands twice")));
            }
            order.push(place);
        }
        let missing = (0..conditions.len()).find(|place| !order.contains(place));
        missing.map_or(Ok(order), |place| {
            Err(cannot(format!("`{}` is missing", conditions[place].id)))
        })
    }

    /// The ids that nobody is given, in small letters: files of ids that differ by nothing else are one file on some systems.
    fn ids_taken(&self, b: &Books<'_>) -> Result<BTreeSet<String>, SeatError> {
        let elsewhere = self.settings.files.people()?.into_iter();
        let in_store = b.ids()?.into_iter().chain(b.forgotten()?);
        Ok(elsewhere.chain(in_store).map(|id| id.to_lowercase()).collect())
    }

    /// The id that is wanted, or the next that nobody has or had, here or in the study's table of people.
    fn id_for(&self, b: &Books<'_>, wanted: Option<&str>) -> Result<String, SeatError> {
        let taken = self.ids_taken(b)?;
        let Some(wanted) = wanted else {
            let mut number = b.ids()?.len() + 1;
            while taken.contains(&format!("p{number:03}")) {
                number += 1;
            }
            return Ok(format!("P{number:03}"));
        };
        let checked = ParticipantId::new(wanted).map_err(|e| {
            SeatError::cannot(e.to_string(), "give another one, or none for the next that is free")
        })?;
        if taken.contains(&wanted.to_lowercase()) {
            return Err(SeatError::cannot(
                format!(
                    "the id `{wanted}` stands already, here or in the study's table of people, or was somebody's who is forgotten"
                ),
                "give another one, or none for the next that is free; nobody was let in",
            ));
        }
        Ok(checked.into())
    }

    /// Lets the next person in: their token.
    pub fn let_in(&self) -> Result<String, SeatError> {
        self.invite(&Invitation::default())
    }

    /// Lets somebody in as the experimenter says: their token. Their row of the square is the lowest that nobody has, of an order by hand where it has one.
    ///
    /// # Errors
    /// [`SeatError::Protocol`] for an id that stands already or can be none, or an order in which a condition is missing or stands twice,
    /// or rides in somebody else's style where too few let theirs be lent; [`SeatError::Store`], [`SeatError::Random`];
    /// [`SeatError::Study`] if the table of people cannot be read.
    pub fn invite(&self, invitation: &Invitation) -> Result<String, SeatError> {
        let rides = self.rides();
        if rides {
            self.model_for_page()?;
            self.refuse_few_donors()?;
        }
        let token = token::new()?;
        let person = self.store.within(|b| {
            let participant = self.id_for(b, invitation.participant.as_deref())?;
            let (row, order) = if let Some(text) = &invitation.order {
                let order = self.order_by_hand(text)?;
                (self.row_of(b, &order)?, order)
            } else {
                let row = b.free_row(0, 1)?;
                (Some(row), self.order(row))
            };
            let steps = self.steps_of(None, &participant, &order)?;
            let person = Person {
                row: row.filter(|_| rides),
                ..Person::new(token.clone(), participant, steps)
            };
            b.add(&person)?;
            Ok::<_, SeatError>(person)
        })?;
        self.add_link(&person);
        Ok(token)
    }

    /// Ends the part of somebody who gave nothing and is waited for no more: their row goes to whoever comes next.
    ///
    /// # Errors
    /// [`SeatError::Nobody`]; [`SeatError::Protocol`] for somebody who began, or whose part has ended; [`SeatError::Store`];
    /// [`SeatError::Study`] if a file cannot be written.
    pub fn never_came(&self, participant: &str) -> Result<(), SeatError> {
        self.store.within(|b| {
            let person = b.called(participant)?;
            if let Some(how) = &person.ended {
                return Err(SeatError::cannot(
                    format!("the part of `{participant}` has ended already: {how}"),
                    "nothing is left to do",
                ));
            }
            if person.at > 0 || !b.begun(participant, 0)?.is_empty() {
                return Err(SeatError::cannot(
                    format!(
                        "`{participant}` came: they are at step {} of {}",
                        person.at + 1,
                        person.steps.len()
                    ),
                    "let them leave by their own page, or forget them",
                ));
            }
            b.ended(&person, NEVER_CAME)?;
            // Of no person: it is kept also of somebody who is in no table, since they were not admitted yet.
            let place = if person.row.is_some() { ": their row of the square is free" } else { "" };
            b.event(None, &format!("{participant} never came{place}"))
        })?;
        self.write_files()
    }

    /// The first person, let in if nobody was: for a seat that one person uses.
    pub fn only_person(&self) -> Result<String, SeatError> {
        let first = |people: Vec<Person>| people.into_iter().find(|p| p.ended.is_none());
        match self.store.look(|b| b.everybody().map(first))? {
            Some(person) => Ok(person.token),
            None => self.let_in(),
        }
    }
}

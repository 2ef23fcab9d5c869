//! Who takes part, by what they answer and what their computer has: judged in the page; what is kept is how often each rule held somebody back.

use crate::{
    books::Books,
    error::SeatError,
    person::{NOT_ADMITTED, Person},
};
use maveric_study::tables::collected::NotAdmitted;
use rusqlite::params;

impl Books<'_> {
    /// Lets somebody go on, or holds them back by a rule; `refused` is its place.
    pub(crate) fn judge(
        &self,
        (person, step): (&Person, usize),
        rules: &[String],
        refused: Option<usize>,
    ) -> Result<(), SeatError> {
        match refused.and_then(|at| rules.get(at)) {
            // A reply that was lost is no second person.
            Some(rule) if person.at == step && person.ended.is_none() => {
                self.hold_back(rule)?;
                self.ended(person, NOT_ADMITTED)
            }
            Some(_) => Ok(()),
            None => self.go_on(person, step),
        }
    }

    /// Counts somebody whom a rule held back.
    pub(crate) fn hold_back(&self, rule: &str) -> Result<(), SeatError> {
        self.change(
            "INSERT INTO not_admitted (rule, people) VALUES (?1, 1) ON CONFLICT DO UPDATE SET people = people + 1",
            params![rule],
        )
    }

    /// How many people each rule held back.
    pub(crate) fn not_admitted(&self) -> Result<Vec<NotAdmitted>, SeatError> {
        let question = "SELECT rule, people FROM not_admitted ORDER BY rule";
        self.rows(question, [], |row| {
            Ok(NotAdmitted { rule: row.get(0)?, people: row.get::<_, i64>(1)? as usize })
        })
    }
}

//! Between two sessions: from which day on somebody goes on with the same link.

use crate::{
    books::Books, error::SeatError, person::Person, request::Refused, seat::Seat, steps::Step,
    withdrawal::today,
};
use chrono::{DateTime, Days, NaiveDate};
use serde::Serialize;
use std::num::NonZeroU32;

/// When the next session is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Between {
    /// The first day of it.
    pub(crate) from: String,
    /// The last day on which it is as the study asks for.
    pub(crate) until: String,
    /// Whether the first day has come.
    pub(crate) open: bool,
    /// What is written down of somebody who comes today, which is later than the study asks for; none where it is not.
    #[serde(skip)]
    late: Option<String>,
}

impl Between {
    /// Of a session before that ended at `since`, in s since 1970; days are Greenwich's, as all of the seat's are.
    fn new(since: i64, today: NaiveDate, session: NonZeroU32, [least, most]: [u32; 2]) -> Self {
        let ended = DateTime::from_timestamp(since, 0).unwrap_or_default();
        let ended = ended.date_naive();
        let after = |days: u32| ended.checked_add_days(Days::new(u64::from(days)));
        let [from, until] = [least, most].map(|days| after(days).unwrap_or(NaiveDate::MAX));
        let days = (today - ended).num_days();
        let late = || {
            format!(
                "session {session}: {days} days after the one before, at most {most} were asked for"
            )
        };
        Self {
            open: today >= from,
            late: (today > until).then(late),
            from: from.to_string(),
            until: until.to_string(),
        }
    }

    /// When somebody's next session is; none of who is not between two.
    pub(crate) fn at(b: &Books<'_>, person: &Person) -> Result<Option<Self>, SeatError> {
        match person.steps.get(person.at) {
            Some(Step::Between { session, days }) => {
                let since = b.since(&person.token)?;
                Ok(Some(Self::new(since, today(), *session, *days)))
            }
            _ => Ok(None),
        }
    }
}

impl Books<'_> {
    /// When somebody came to the step at which they are, in s since 1970.
    fn since(&self, token: &str) -> Result<i64, SeatError> {
        let question = "SELECT since FROM person WHERE token = ?1";
        let since = self.row(question, [token], |row| row.get(0))?;
        Ok(since.unwrap_or_default())
    }
}

impl Person {
    /// Whether they are between two sessions.
    pub(crate) fn waits(&self) -> bool {
        matches!(self.steps.get(self.at), Some(Step::Between { .. }))
    }
}

impl Seat {
    /// Refuses who comes before the day, and writes down who comes late.
    pub(crate) fn comes_again(&self, person: &Person) -> Result<(), Refused> {
        let between = self.store.look(|b| Between::at(b, person))?;
        let Some(between) = between.filter(|between| between.open) else {
            return Err(Refused::NotThis("it is not the day yet".to_owned()));
        };
        match between.late {
            Some(late) => Ok(self.store.within(|b| b.event(Some(&person.participant), &late))?),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_session_opens_on_its_first_day_and_late_is_after_its_last() {
        // 25 November 2026, ten minutes to midnight.
        let ended = 1_795_650_600;
        let second = NonZeroU32::new(2).unwrap();
        let on = |day: &str| Between::new(ended, day.parse().unwrap(), second, [2, 14]);
        let early = on("2026-11-26");
        assert_eq!((early.from.as_str(), early.until.as_str()), ("2026-11-27", "2026-12-09"));
        assert!(!early.open && on("2026-11-27").open);
        assert_eq!(on("2026-12-09").late, None);
        let late = on("2026-12-10").late.unwrap();
        assert!(late.contains("15 days") && late.contains("14"), "{late}");
        assert!(on("2026-12-10").open);
    }
}

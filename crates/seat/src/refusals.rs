//! What the server refused or could not keep, for whoever runs the study: held in memory, since a full disk keeps nothing.

use crate::{books, held::held};
use std::{
    sync::Mutex,
    time::{Duration, Instant},
};

/// Different ones that are held; the one that came longest ago goes first.
const MOST: usize = 100;
/// The same is told again at most so often.
const TOLD_EVERY: Duration = Duration::from_mins(1);
/// Of what others sent so much is told within that time, and so many letters of each.
const MOST_TOLD: usize = 30;
const LONGEST: usize = 300;

/// Something that was refused, as often as it was.
#[derive(Debug, Clone)]
pub(crate) struct Refusal {
    /// To whom; none for somebody without a link.
    pub(crate) participant: Option<String>,
    pub(crate) why: String,
    pub(crate) times: u64,
    /// When it came last, in s since 1970.
    pub(crate) last_s: i64,
    told: Option<Instant>,
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let who = self.participant.as_deref().unwrap_or("somebody");
        write!(f, "refused to {who}: {}", self.why)?;
        if self.times > 1 {
            write!(f, " ({} times)", self.times)?;
        }
        Ok(())
    }
}

/// The list, the one that came last at its end.
#[derive(Default)]
struct List {
    all: Vec<Refusal>,
    /// How much of what others sent was told lately, and since when that is counted.
    told: usize,
    since: Option<Instant>,
}

/// The list, and who is told of it at once.
pub(crate) struct Refusals {
    list: Mutex<List>,
    tell: Box<dyn Fn(&str) + Send + Sync>,
}

impl Refusals {
    pub(crate) fn new(tell: Box<dyn Fn(&str) + Send + Sync>) -> Self {
        Self { list: Mutex::default(), tell }
    }

    /// Takes one down; tells of it when it is new, and now and then while it goes on. `ours` is a failure of the server's: it is told
    /// however much others sent that was refused.
    pub(crate) fn add(&self, participant: Option<String>, why: &str, ours: bool) {
        let why: String = why.chars().take(LONGEST).collect();
        let now = Instant::now();
        let mut list = held(&self.list);
        let lately = |told: Option<Instant>| told.is_some_and(|t| t.elapsed() < TOLD_EVERY);
        if !lately(list.since) {
            (list.since, list.told) = (Some(now), 0);
        }
        let same = |r: &Refusal| r.participant == participant && r.why == why;
        let place = list.all.iter().position(same);
        let mut refusal = match place {
            Some(place) => list.all.remove(place),
            None => Refusal { participant, why, times: 0, last_s: 0, told: None },
        };
        refusal.times += 1;
        refusal.last_s = books::now();
        if !lately(refusal.told) && (ours || list.told < MOST_TOLD) {
            refusal.told = Some(now);
            list.told += usize::from(!ours);
            (self.tell)(&refusal.to_string());
        }
        if list.all.len() == MOST {
            list.all.remove(0);
        }
        list.all.push(refusal);
    }

    /// Takes out what was refused to somebody who is forgotten.
    pub(crate) fn forget(&self, participant: &str) {
        held(&self.list).all.retain(|r| r.participant.as_deref() != Some(participant));
    }

    pub(crate) fn newest_first(&self) -> Vec<Refusal> {
        held(&self.list).all.iter().rev().cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn the_same_is_told_once_and_counted_and_the_list_does_not_grow_without_end() {
        let told = Arc::new(Mutex::new(Vec::new()));
        let heard = Arc::clone(&told);
        let refusals = Refusals::new(Box::new(move |line| {
            heard.lock().unwrap().push(line.to_owned());
        }));
        for _ in 0..3 {
            refusals.add(Some("P001".to_owned()), "the disk is full", true);
        }
        assert_eq!(*told.lock().unwrap(), ["refused to P001: the disk is full"]);
        assert_eq!(
            refusals.newest_first()[0].to_string(),
            "refused to P001: the disk is full (3 times)"
        );
        for number in 0..2 * MOST {
            refusals.add(None, &format!("strange {number}"), false);
        }
        assert!(told.lock().unwrap().len() <= 1 + MOST_TOLD);
        refusals.add(None, "the disk is full again", true);
        assert!(told.lock().unwrap().last().unwrap().contains("again"));
        assert_eq!(refusals.newest_first().len(), MOST);
        refusals.add(Some("P002".to_owned()), "x", false);
        refusals.forget("P002");
        assert!(refusals.newest_first().iter().all(|r| r.participant.is_none()));
    }
}

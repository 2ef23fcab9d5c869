//! What people pressed during the rides: how often in which condition, and what the ride was like before.

use crate::data::StudyData;
use maveric_domain::{
    ConditionId, ParticipantId,
    press::{PRECURSORS, Precursor, PressMoment, PressedRide},
};
use maveric_stats::{
    Adjustment, CaseCrossover, CaseStratum, EventRates, Exposed, StatsError, case_crossover,
    event_rates, mean, mean_interval,
};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Fewest people with a press, and fewest presses, of which it is asked what came before.
pub const FEWEST_PEOPLE: usize = 10;
/// As [`FEWEST_PEOPLE`].
pub const FEWEST_PRESSES: usize = 30;
/// Arrangements within people by which rates are tested, and the seed by which they are drawn.
const PERMUTATIONS: usize = 10_000;
const SEED: u64 = 1;

/// What people pressed during the rides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Presses {
    /// Presses a minute by condition, of those who rode all of them; none for fewer than two conditions or people.
    pub rates: Option<EventRates>,
    /// Who lacks a ride, and is left out of the rates.
    pub incomplete: Vec<ParticipantId>,
    /// People with a press that takes part in what came before, and such presses.
    pub people: usize,
    /// As `people`.
    pub presses: usize,
    /// What came before a press, a row each; empty below ten people or thirty presses.
    pub before: Vec<BeforePress>,
    /// The course before a press, a row each.
    pub course: Vec<PressCourse>,
}

/// One thing that may have come before a press.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BeforePress {
    /// Its column among the moments.
    pub precursor: String,
    /// Name for people.
    pub title: String,
    /// Unit; empty for what is there or not.
    pub unit: String,
    /// Presses against other moments of the same minute.
    pub test: CaseCrossover,
    /// Its p after Holm over all rows.
    pub p_holm: Option<f64>,
    /// Moments without a value, which are left out.
    pub missing: usize,
}

/// The mean course of something before a press.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PressCourse {
    /// Its column among the moments.
    pub precursor: String,
    /// Name for people.
    pub title: String,
    /// Unit; empty for what is there or not.
    pub unit: String,
    /// People with a press.
    pub n: usize,
    /// Mean of the people's means at so many seconds before a press, with its 95 % interval.
    pub points: Vec<CoursePoint>,
    /// The same at the other moments of these minutes.
    pub others: Option<f64>,
}

/// A point of such a course.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CoursePoint {
    /// Seconds before the press.
    pub before_s: u32,
    /// Mean over people.
    pub mean: f64,
    /// Ends of its 95 % interval; none for one person.
    pub interval: Option<(f64, f64)>,
}

/// What was pressed; none where no ride could be pressed in.
pub(crate) fn presses(data: &StudyData) -> Result<Option<Presses>, StatsError> {
    let rides: Vec<&PressedRide> = data.pressed_rides().collect();
    if rides.is_empty() {
        return Ok(None);
    }
    let (rates, incomplete) = rates(data, &rides)?;
    let moments: Vec<&PressMoment> = data.press_moments().collect();
    let pressed: Vec<&&PressMoment> = moments.iter().filter(|m| m.pressed).collect();
    let people: BTreeSet<&ParticipantId> = pressed.iter().map(|m| &m.participant).collect();
    let enough = people.len() >= FEWEST_PEOPLE && pressed.len() >= FEWEST_PRESSES;
    Ok(Some(Presses {
        rates,
        incomplete,
        people: people.len(),
        presses: pressed.len(),
        before: if enough { before(&moments) } else { Vec::new() },
        course: PRECURSORS.iter().filter_map(|precursor| course(precursor, &moments)).collect(),
    }))
}

type Rates = (Option<EventRates>, Vec<ParticipantId>);

/// Rates by condition of those who rode all that anybody rode; who lacks one.
fn rates(data: &StudyData, rides: &[&PressedRide]) -> Result<Rates, StatsError> {
    let mut cells: BTreeMap<(&ParticipantId, ConditionId), Exposed> = BTreeMap::new();
    for ride in rides {
        let cell = cells
            .entry((&ride.participant, ride.condition))
            .or_insert(Exposed { events: 0, time: 0.0 });
        cell.events += ride.presses;
        cell.time += ride.minutes;
    }
    let ridden: BTreeSet<ConditionId> = rides.iter().map(|ride| ride.condition).collect();
    let conditions = data.design.condition_ids();
    let conditions: Vec<ConditionId> = conditions.filter(|id| ridden.contains(id)).collect();
    let people: BTreeSet<&ParticipantId> = rides.iter().map(|ride| &ride.participant).collect();
    let (mut rows, mut incomplete) = (Vec::new(), Vec::new());
    for person in people {
        let row = conditions.iter().map(|id| cells.get(&(person, *id)).copied());
        match row.collect::<Option<Vec<Exposed>>>() {
            Some(row) => rows.push(row),
            None => incomplete.push(person.clone()),
        }
    }
    if conditions.len() < 2 || rows.len() < 2 {
        return Ok((None, incomplete));
    }
    let names: Vec<String> = conditions.iter().map(ToString::to_string).collect();
    let rates = event_rates(&names, &rows, PERMUTATIONS, SEED)?;
    Ok((Some(rates), incomplete))
}

fn before(moments: &[&PressMoment]) -> Vec<BeforePress> {
    let mut rows: Vec<BeforePress> = PRECURSORS
        .iter()
        .map(|precursor| {
            let mut strata: BTreeMap<_, CaseStratum> = BTreeMap::new();
            let mut missing = 0;
            for moment in moments.iter().filter(|m| m.at_risk) {
                let Some(value) = (precursor.value)(moment) else {
                    missing += 1;
                    continue;
                };
                let key = (&moment.participant, &moment.drive, moment.minute);
                let stratum = strata.entry(key).or_insert_with(|| CaseStratum {
                    person: moment.participant.to_string(),
                    events: Vec::new(),
                    others: Vec::new(),
                });
                if moment.pressed {
                    stratum.events.push(value);
                } else {
                    stratum.others.push(value);
                }
            }
            let strata: Vec<CaseStratum> = strata.into_values().collect();
            BeforePress {
                precursor: precursor.id.to_owned(),
                title: precursor.title.to_owned(),
                unit: precursor.unit.to_owned(),
                test: case_crossover(&strata),
                p_holm: None,
                missing,
            }
        })
        .collect();
    let p: Vec<Option<f64>> = rows.iter().map(|row| row.test.p).collect();
    for (row, p_holm) in rows.iter_mut().zip(Adjustment::Holm.apply_defined(&p)) {
        row.p_holm = p_holm;
    }
    rows
}

/// Means of people's means, second by second; none where nobody has a value.
fn course<'a>(precursor: &Precursor, moments: &[&'a PressMoment]) -> Option<PressCourse> {
    /// Sum and number of a person's values.
    type Sums<'a> = BTreeMap<&'a ParticipantId, (f64, usize)>;
    let mut seconds: BTreeMap<u32, Sums> = BTreeMap::new();
    let mut others: Sums<'a> = Sums::new();
    for moment in moments {
        let Some(value) = (precursor.value)(moment) else {
            continue;
        };
        let add = |sums: &mut Sums<'a>| {
            let (sum, n) = sums.entry(&moment.participant).or_default();
            (*sum, *n) = (*sum + value, *n + 1);
        };
        if let Some(before_s) = moment.to_press_s {
            add(seconds.entry(before_s.round() as u32).or_default());
        } else if moment.at_risk {
            add(&mut others);
        }
    }
    let means = |sums: &Sums<'_>| {
        let means = sums.values().map(|(sum, n)| sum / *n as f64);
        means.collect::<Vec<f64>>()
    };
    let points = seconds.iter().map(|(before_s, sums)| {
        let values = means(sums);
        Some(CoursePoint {
            before_s: *before_s,
            mean: mean(&values)?,
            interval: mean_interval(&values, 0.95).map(|[_, low, high]| (low, high)),
        })
    });
    let points: Vec<CoursePoint> = points.collect::<Option<_>>()?;
    (!points.is_empty()).then(|| PressCourse {
        precursor: precursor.id.to_owned(),
        title: precursor.title.to_owned(),
        unit: precursor.unit.to_owned(),
        n: seconds.values().map(BTreeMap::len).max().unwrap_or(0),
        points,
        others: mean(&means(&others)),
    })
}

//! What several rides and sessions tell: how many rides a mean is over, how alike people are in the second session, and who did not come back.

use crate::{AnalysisError, data::StudyData, outcomes::Asked, outcomes::outcomes};
use maveric_domain::{ConditionId, Occasion, ParticipantId, design::Quantity};
use maveric_stats::{Icc, icc, mean};
use serde::{Deserialize, Serialize};
use std::num::NonZeroU32;

/// People below whom a coefficient of agreement says too little to be read, or judged.
pub const FEWEST_FOR_ICC: usize = 30;

/// How many rides of the first session count, in a condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RidesCounted {
    /// A condition of which the design asks for several rides.
    pub condition: ConditionId,
    /// Rides that the design asks for.
    pub declared: usize,
    /// People of whom all of them count.
    pub whole: usize,
    /// People of whom some are missing or left out: their mean is over the others.
    pub fewer: usize,
    /// Rides that count, over all people.
    pub rides: usize,
}

/// A reading of the same people in the first and in the second session; of several rides in a condition each is a mean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Retest {
    /// In which condition, or in the drive by hand.
    pub condition: ConditionId,
    /// The measure's column, `SCALE.SUBSCALE`, `line_position` or `adb_hat`.
    pub outcome: String,
    /// For people.
    pub title: String,
    /// Unit in which people read it.
    pub unit: String,
    /// People with a reading in both sessions.
    pub n: usize,
    /// ICC(2,1), SEM and SDC, in the unit in which people read it; none below two people.
    pub icc: Option<Icc>,
    /// Mean of the first session over those.
    pub mean_back: Option<f64>,
    /// People with a reading in the first session alone.
    pub gone: usize,
    /// Mean of the first session over those.
    pub mean_gone: Option<f64>,
}

/// What several rides and sessions tell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Repeats {
    /// A row a condition, where the design asks for several rides.
    pub rides: Vec<RidesCounted>,
    /// People of whom anything is there of the second session.
    pub back: usize,
    /// People of whom nothing is.
    pub gone: usize,
    /// A row a condition and outcome that somebody has in both sessions.
    pub retest: Vec<Retest>,
}

/// None where the design has one session with one ride in each condition.
pub(crate) fn repeats(data: &StudyData) -> Result<Option<Repeats>, AnalysisError> {
    if !data.design.repeats() {
        return Ok(None);
    }
    let readings =
        if data.design.protocol().session_count() > 1 { readings(data) } else { Vec::new() };
    let back = |index: &usize| readings.iter().any(|reading| reading.second[*index].is_some());
    let people = data.participants.len();
    let back = (0..people).filter(back).count();
    let rows = readings.iter().map(Reading::compared);
    let rows: Vec<Retest> = rows.collect::<Result<_, _>>()?;
    Ok(Some(Repeats {
        rides: rides(data),
        back,
        gone: if readings.is_empty() { 0 } else { people - back },
        retest: rows.into_iter().filter(|row| row.n > 0).collect(),
    }))
}

fn rides(data: &StudyData) -> Vec<RidesCounted> {
    let declared = data.design.protocol().rides_per_condition as usize;
    if declared < 2 {
        return Vec::new();
    }
    let counted = |condition: ConditionId| {
        let counts = data.participants.iter().map(|p| data.rides(p, condition));
        let counts: Vec<usize> = counts.filter(|n| *n > 0).collect();
        let whole = counts.iter().filter(|n| **n >= declared).count();
        RidesCounted {
            condition,
            declared,
            whole,
            fewer: counts.len() - whole,
            rides: counts.iter().sum(),
        }
    };
    data.design.conditions().iter().map(|c| counted(c.id)).collect()
}

/// What everybody has in the first and the second session, in the unit in which people read it.
struct Reading {
    condition: ConditionId,
    outcome: String,
    title: String,
    unit: String,
    first: Vec<Option<f64>>,
    second: Vec<Option<f64>>,
}

impl Reading {
    fn compared(&self) -> Result<Retest, AnalysisError> {
        let pairs = || self.first.iter().zip(&self.second);
        let both = pairs().filter_map(|(first, second)| Some((Some((*first)?), Some((*second)?))));
        let (first, second): (Vec<Option<f64>>, Vec<Option<f64>>) = both.unzip();
        let gone = pairs().filter_map(|(first, second)| first.filter(|_| second.is_none()));
        let gone: Vec<f64> = gone.collect();
        let n = first.len();
        let agreement =
            (n > 1).then(|| icc(&[("first session", &first), ("second session", &second)]));
        let back: Vec<f64> = first.iter().copied().flatten().collect();
        Ok(Retest {
            condition: self.condition,
            outcome: self.outcome.clone(),
            title: self.title.clone(),
            unit: self.unit.clone(),
            n,
            icc: agreement.transpose()?,
            mean_back: mean(&back),
            gone: gone.len(),
            mean_gone: mean(&gone),
        })
    }
}

/// The drive by hand first, with the style that is read from it alone; then each condition.
fn readings(data: &StudyData) -> Vec<Reading> {
    let sessions = [1, 2].map(|session| Occasion::new(session, 1).unwrap_or_default().session);
    let compared = outcomes(data);
    let baseline = data.design.baseline_id();
    let conditions = data.design.condition_ids();
    let conditions = conditions.filter(|c| Some(*c) != baseline);
    let mut readings = Vec::new();
    for condition in baseline.into_iter().chain(conditions) {
        for asked in &compared {
            let values_of = |session: NonZeroU32| {
                let value = |p: &ParticipantId| {
                    Some(asked.factor * value_in(data, session, asked, (p, condition))?)
                };
                data.participants.iter().map(value).collect()
            };
            let [first, second] = sessions.map(values_of);
            readings.push(Reading {
                condition,
                outcome: asked.id.clone(),
                title: asked.title.clone(),
                unit: asked.unit.clone(),
                first,
                second,
            });
        }
        if Some(condition) == baseline {
            readings.extend(style(data, condition, sessions));
        }
    }
    readings
}

fn value_in(
    data: &StudyData,
    session: NonZeroU32,
    asked: &Asked,
    (who, condition): (&ParticipantId, ConditionId),
) -> Option<f64> {
    match &asked.quantity {
        Quantity::Measure(name) => data.measured_in(session, who, condition, name),
        Quantity::Score(name) => data.rated_in(session, who, condition, name),
    }
}

/// Place on the line and score, as they are read from driving alone.
fn style(data: &StudyData, baseline: ConditionId, sessions: [NonZeroU32; 2]) -> Vec<Reading> {
    let read = |column: fn(&maveric_domain::EmbeddingRow) -> Option<f64>| {
        sessions.map(|session| {
            let value = |p: &ParticipantId| column(data.embedding_in(session, p, false)?);
            data.participants.iter().map(value).collect::<Vec<_>>()
        })
    };
    let rows = [
        ("line_position", "Position on the line", "SD", read(|e| e.line_position)),
        ("adb_hat", "Score read from the style", "points", read(|e| e.adb_hat)),
    ];
    let reading =
        |(outcome, title, unit, [first, second]): (&str, &str, &str, [Vec<_>; 2])| Reading {
            condition: baseline,
            outcome: outcome.to_owned(),
            title: title.to_owned(),
            unit: unit.to_owned(),
            first,
            second,
        };
    rows.map(reading).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Analysis, Purpose, Question, StudyData, Tables, Verdict, analyse, finding,
        testing::{SPEED, design, drive, id, near, person, score},
    };
    use maveric_domain::{Moment, Ride};

    const STUDY: &str = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"fast\"\n[[condition]]\nid = \"slow\"\n[baseline]\nid = \"own\"\n\
                         [protocol]\nrides_per_condition = 2\nsessions = { count = 2, days_between = [2, 14] }\n";

    /// People with a drive by hand and two rides of each condition in every session; `speed` says how fast, in m/s.
    fn tables(people: usize, speed: impl Fn(usize, Ride) -> Option<f64>) -> Tables {
        let mut tables = Tables::default();
        let design = design(STUDY);
        for i in 0..people {
            for condition in ["own", "fast", "slow"].map(id) {
                for occasion in design.occasions(condition) {
                    let ride = Ride { condition, occasion };
                    let Some(mps) = speed(i, ride) else { continue };
                    let mut driven = drive(i, condition.as_str(), Some(mps));
                    driven.meta = driven.meta.on(occasion);
                    driven.meta.drive =
                        maveric_domain::DriveId::in_condition(&person(i), ride).unwrap();
                    tables.measurements.push(driven);
                    if condition != id("own") {
                        let trust = score(i, Moment::After(ride), "jian_trust", "overall", mps);
                        tables.post.push(trust);
                    }
                }
            }
        }
        tables
    }

    fn analysed(tables: Tables) -> Analysis {
        let data = StudyData::new(&design(STUDY), tables).unwrap();
        analyse(&data, Purpose::Report).unwrap()
    }

    /// 20 + i m/s, 1 less and 1 more in the two rides, `later` more in the second session.
    fn steady(later: impl Fn(usize) -> f64) -> impl Fn(usize, Ride) -> Option<f64> {
        move |i, ride| {
            let Occasion { session, trial } = ride.occasion;
            let side = match (ride.condition.as_str(), trial.get()) {
                ("own", _) => 0.0,
                (_, 1) => -1.0,
                _ => 1.0,
            };
            let again = if session.get() == 2 { later(i) } else { 0.0 };
            Some(20.0 + i as f64 + side + again)
        }
    }

    #[test]
    fn a_cell_is_the_mean_of_the_rides_of_the_first_session_and_one_that_is_missing_is_counted() {
        let all = steady(|_| 7.0);
        // The second ride of the first person in `fast` is missing: 20 - 1 is left.
        let gap = tables(4, |i, ride| {
            let gone = i == 0 && ride.to_string() == "fast:s1:t2";
            all(i, ride).filter(|_| !gone)
        });
        let data = StudyData::new(&design(STUDY), gap.clone()).unwrap();
        near(data.measured(&person(0), id("fast"), SPEED), 19.0);
        near(data.measured(&person(0), id("slow"), SPEED), 20.0);
        near(data.measured(&person(1), id("fast"), SPEED), 21.0);
        let trust = "jian_trust.overall".parse().unwrap();
        near(data.rated(&person(0), id("fast"), &trust), 19.0);
        near(data.rated(&person(3), id("slow"), &trust), 23.0);
        near(data.baseline(&person(2), SPEED), 22.0);
        let repeats = analysed(gap).repeats.unwrap();
        let counted: Vec<_> =
            repeats.rides.iter().map(|r| (r.condition, r.whole, r.fewer, r.rides)).collect();
        assert_eq!(counted, [(id("fast"), 3, 1, 7), (id("slow"), 4, 0, 8)]);
    }

    #[test]
    fn a_ride_of_which_something_was_said_counts_without_a_log_of_it() {
        let mut elsewhere = tables(4, steady(|_| 7.0));
        elsewhere.measurements.clear();
        elsewhere.post.retain(|score| {
            let ride = score.moment.ride().map(|ride| ride.to_string());
            score.participant != person(0) || ride.as_deref() != Some("fast:s1:t2")
        });
        let repeats = analysed(elsewhere).repeats.unwrap();
        let counted = repeats.rides.iter();
        let counted: Vec<_> = counted.map(|r| (r.condition, r.whole, r.fewer, r.rides)).collect();
        assert_eq!(counted, [(id("fast"), 3, 1, 7), (id("slow"), 4, 0, 8)]);
    }

    #[test]
    fn the_second_session_is_set_against_the_first_and_who_did_not_come_back_is_counted_with_their_means()
     {
        // The last two of six do not come back. The others are 1 m/s faster or slower in turn.
        let all = steady(|i| if i % 2 == 0 { 1.0 } else { -1.0 });
        let some = tables(6, |i, ride| {
            let gone = i > 3 && ride.occasion.session.get() == 2;
            all(i, ride).filter(|_| !gone)
        });
        let repeats = analysed(some).repeats.unwrap();
        assert_eq!((repeats.back, repeats.gone), (4, 2));
        let mut rows = repeats.retest.iter();
        let own = rows.find(|r| r.condition == id("own") && r.outcome == SPEED);
        let own = own.unwrap();
        assert_eq!((own.n, own.gone), (4, 2));
        // As people read it, in km/h.
        near(own.mean_back, 3.6 * 21.5);
        near(own.mean_gone, 3.6 * 24.5);
        // Pairs (20, 21), (21, 20), (22, 23), (23, 22): between people 2 · ((1 + 1 + 1 + 1) / 3) = 8/3, sessions nothing, rest 8 · 0.25 / 3
        // = 2/3; ICC = (8/3 - 2/3) / (8/3 + 2/3 + (2/4) (0 - 2/3)) = 2/3, SEM = √(2/3) m/s.
        let icc = own.icc.as_ref().unwrap();
        near(icc.icc, 2.0 / 3.0);
        near(Some(icc.sem), 3.6 * (2.0_f64 / 3.0).sqrt());
        near(Some(icc.sdc), 1.96 * 2.0_f64.sqrt() * icc.sem);
    }

    fn verdict(people: usize, later: impl Fn(usize) -> f64) -> Option<Verdict> {
        let analysis = analysed(tables(people, steady(later)));
        finding::by_question(&analysis.findings, Question::Retest).map(|f| f.verdict)
    }

    #[test]
    fn who_drives_as_before_is_shown_who_drives_as_anybody_fails_and_thirty_are_asked_for() {
        let little = |i: usize| 0.2 * ((i * 7) % 5) as f64;
        assert_eq!(verdict(30, little), Some(Verdict::Shown));
        assert_eq!(verdict(29, little), None);
        // In the second session everybody drives as somebody else did.
        let other = |i: usize| ((i * 17 + 5) % 30) as f64 - i as f64;
        assert_eq!(verdict(30, other), Some(Verdict::Fails));
    }

    #[test]
    fn one_session_with_one_ride_in_each_condition_has_nothing_of_this() {
        let found = crate::testing::analysed(crate::testing::tables());
        assert_eq!(found.repeats, None);
    }
}

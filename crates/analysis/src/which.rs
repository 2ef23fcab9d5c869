//! Do people tell which of two rides was in their own style?

use crate::{AnalysisError, data::StudyData};
use maveric_domain::{
    ConditionId, ParticipantId,
    design::{Condition, ScoreName, WHICH},
};
use maveric_stats::{ForcedChoice, forced_choice};
use serde::{Deserialize, Serialize};

/// What people said of the two rides that the design asks about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WhichRide {
    /// The condition in the own style.
    pub own: ConditionId,
    /// The condition that it was held against.
    pub other: ConditionId,
    /// Everybody who was asked; none where nobody was.
    pub all: Option<ForcedChoice>,
    /// Those who rode in the own style first, then those who rode so second: a habit of naming the earlier or the later ride shows as a difference.
    pub by_place: [Option<ForcedChoice>; 2],
    /// People who answered and of whom it is not known in which order they rode, or who have only one of the rides: not counted.
    pub not_counted: usize,
}

/// None where the design does not ask.
pub(crate) fn which_ride(data: &StudyData) -> Result<Option<WhichRide>, AnalysisError> {
    let Some(pair) = data.design.protocol().which else {
        return Ok(None);
    };
    let own = |id: &ConditionId| {
        let condition = data.design.condition(*id);
        condition.is_some_and(Condition::in_own_style)
    };
    let [Some(own), Some(other)] =
        [pair.into_iter().find(own), pair.into_iter().find(|id| !own(id))]
    else {
        return Ok(None);
    };
    // People with the own style first, then with it second: right choices of all.
    let mut counts = [(0, 0); 2];
    let mut not_counted = 0;
    for p in &data.participants {
        let Some(says_later) = answer(data, p) else {
            continue;
        };
        let ridden = data.measurements.is_empty()
            || [own, other].iter().all(|c| data.drive(p, *c).is_some());
        let periods = data.period(p, own).zip(data.period(p, other));
        let Some((period, than)) = periods.filter(|_| ridden) else {
            not_counted += 1;
            continue;
        };
        let own_is_later = period > than;
        let (correct, n) = &mut counts[usize::from(own_is_later)];
        *correct += usize::from(says_later == own_is_later);
        *n += 1;
    }
    let choice = |(correct, n): (usize, usize)| {
        let test = (n > 0).then(|| forced_choice(correct, n, 0.95));
        test.transpose()
    };
    let [first, second] = counts;
    Ok(Some(WhichRide {
        own,
        other,
        all: choice((first.0 + second.0, first.1 + second.1))?,
        by_place: [choice(first)?, choice(second)?],
        not_counted,
    }))
}

/// Whether somebody named the later ride; none where they were not asked or left it out.
fn answer(data: &StudyData, p: &ParticipantId) -> Option<bool> {
    let name = ScoreName { scale: WHICH.to_owned(), subscale: WHICH.to_owned() };
    Some(data.pre(p, &name)? > 1.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::Moment;

    use crate::{
        Person, Question, StudyData, Tables, Verdict, finding,
        testing::{analysed_by, design, id, near, person, score},
    };

    const DESIGN: &str = r#"
        [study]
        title = "Whose"
        [model]
        file = "model.maveric"
        [style]
        score = "adb.total"
        [baseline]
        id = "hand"
        [[condition]]
        id = "mine"
        car = { dial = 0, recorded = true }
        [[condition]]
        id = "mean"
        car = { mean = true, recorded = true }
        [protocol]
        which = ["mean", "mine"]
        debrief = "debrief.md"
    "#;

    /// So many people, of whom every second rode in their own style first; `right` of them name it.
    fn asked(people: usize, right: usize) -> Tables {
        let mut tables = Tables::default();
        for i in 0..people {
            let own_first = i % 2 == 0;
            let order = if own_first { ["mine", "mean"] } else { ["mean", "mine"] };
            tables.people.push(Person {
                id: person(i),
                learned: false,
                tested: true,
                order: order.map(id).to_vec(),
                columns: std::collections::BTreeMap::new(),
            });
            for condition in order {
                let after = Moment::After(id(condition).into());
                let trust = score(i, after, "jian_trust", "overall", 4.0);
                tables.post.push(trust);
            }
            let says_later = own_first != (i < right);
            let said = if says_later { 2.0 } else { 1.0 };
            let told = score(i, Moment::Post, WHICH, WHICH, said);
            tables.pre.push(told);
        }
        tables
    }

    fn told(tables: Tables) -> WhichRide {
        let data = StudyData::new(&design(DESIGN), tables).unwrap();
        which_ride(&data).unwrap().unwrap()
    }

    #[test]
    fn who_names_the_ride_in_the_own_style_is_right_whichever_came_first() {
        let ride = told(asked(20, 16));
        assert_eq!((ride.own, ride.other), (id("mine"), id("mean")));
        let all = ride.all.unwrap();
        assert_eq!((all.correct, all.n), (16, 20));
        assert!((all.d_prime - 1.1195).abs() < 1e-4);
        let places = ride.by_place.map(|place| {
            let place = place.unwrap();
            (place.correct, place.n)
        });
        assert_eq!(places, [(8, 10), (8, 10)]);
    }

    #[test]
    fn it_is_shown_where_the_whole_interval_lies_above_a_half_and_fails_below() {
        let verdict = |right| {
            let analysis = analysed_by(DESIGN, asked(20, right));
            finding::by_question(&analysis.findings, Question::Which).unwrap().verdict
        };
        // Clopper and Pearson of 15 in 20: .509 to .913; of 14: .457 to .881.
        assert_eq!(verdict(15), Verdict::Shown);
        assert_eq!(verdict(14), Verdict::NotShown);
        assert_eq!(verdict(6), Verdict::NotShown);
        assert_eq!(verdict(5), Verdict::Fails);
        let few = analysed_by(DESIGN, asked(5, 5));
        let few = finding::by_question(&few.findings, Question::Which).unwrap();
        assert_eq!(few.verdict, Verdict::TooFew);
        near(few.parts[0].estimate, 1.0);
    }

    #[test]
    fn without_an_order_nobody_is_right_or_wrong() {
        let mut tables = asked(8, 8);
        tables.people[0].order.clear();
        let ride = told(tables);
        assert_eq!((ride.not_counted, ride.all.unwrap().n), (1, 7));
    }
}

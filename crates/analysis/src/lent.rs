//! What the own style is beyond its score: beside somebody else's that was moved to the same score.

use crate::{
    AnalysisError,
    data::StudyData,
    outcomes::{Asked, outcomes_and},
    verdict::FEWEST,
};
use maveric_domain::{ConditionId, DriveId, Lent, ParticipantId, design::Car};
use maveric_stats::{StatsError, linear_fit, mean_interval};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// How both rides drove, whatever was asked of them.
const SPEED: &str = "mean_velocity_mps";
const BESIDE: [&str; 3] = [SPEED, "mean_headway_time_s", "lane_changes"];

/// The own style beside the style that was lent in a condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BesideLent {
    /// The condition with the own style.
    pub own: ConditionId,
    /// The condition with somebody else's.
    pub condition: ConditionId,
    /// People to whom a style was lent.
    pub people: usize,
    /// Different drives of which those styles were learned.
    pub donors: usize,
    /// People to whom the nearest was lent, since nobody was within reach.
    pub beyond_reach: usize,
    /// Mean distance of donor and person across the dial, in standard deviations.
    pub distance_sd: Option<f64>,
    /// Outcomes, then speed, gap and lane changes where they are none.
    pub rows: Vec<LentContrast>,
}

/// Own less lent of an outcome, in the unit in which people read it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LentContrast {
    /// Its id: a measure or a score.
    pub outcome: String,
    /// On the page.
    pub title: String,
    /// Its unit; empty for counts and shares.
    pub unit: String,
    /// People with both rides.
    pub n: usize,
    /// Mean of the own style's rides.
    pub own: Option<f64>,
    /// Mean of the others.
    pub lent: Option<f64>,
    /// Mean difference with its 95 % interval; none of fewer than six people.
    pub difference: Option<[f64; 3]>,
    /// The same where both rides are equally fast on the mean: the line of difference on difference of speed, at 0. None where speeds are not
    /// known or differ by as much for everybody, of fewer than six people, and of the speed itself.
    pub at_same_speed: Option<[f64; 3]>,
}

/// One a condition in which somebody else's style is lent; none without the own style.
pub(crate) fn beside_lent(data: &StudyData) -> Result<Vec<BesideLent>, AnalysisError> {
    let Some(own) = data.design.own_style() else {
        return Ok(Vec::new());
    };
    let conditions = data.design.conditions().iter();
    let lent = conditions.filter(|c| matches!(c.car, Some(Car::Matched(_))));
    lent.map(|condition| beside(data, own, condition.id)).collect()
}

fn beside(
    data: &StudyData,
    own: ConditionId,
    condition: ConditionId,
) -> Result<BesideLent, AnalysisError> {
    let people = data.participants.iter();
    let lent = people.filter_map(|p| data.condition(p, condition)?.lent.as_ref());
    let lent: Vec<&Lent> = lent.collect();
    let donors: BTreeSet<&DriveId> = lent.iter().map(|l| &l.donor).collect();
    let sum: f64 = lent.iter().map(|l| l.donor_distance_sd).sum();
    let more = BESIDE.map(|measure| Asked::measure(&data.design, measure));
    let compared = outcomes_and(data, more);
    let rows = compared.iter().map(|asked| contrast(data, asked, [own, condition]));
    Ok(BesideLent {
        own,
        condition,
        people: lent.len(),
        donors: donors.len(),
        beyond_reach: lent.iter().filter(|l| !l.donor_within_reach).count(),
        distance_sd: Some(sum / lent.len() as f64).filter(|mean| mean.is_finite()),
        rows: rows.collect::<Result<_, _>>()?,
    })
}

fn contrast(
    data: &StudyData,
    asked: &Asked,
    [own, lent]: [ConditionId; 2],
) -> Result<LentContrast, AnalysisError> {
    let mut pairs: Vec<(&ParticipantId, f64, f64)> = Vec::new();
    for p in &data.participants {
        let value = |c| asked.value(data, p, c).map(|v| v * asked.factor);
        if let (Some(own), Some(lent)) = (value(own), value(lent)) {
            pairs.push((p, own, lent));
        }
    }
    let mean = |number: fn(&(&ParticipantId, f64, f64)) -> f64| {
        let sum: f64 = pairs.iter().map(number).sum();
        Some(sum / pairs.len() as f64).filter(|mean| mean.is_finite())
    };
    let differences: Vec<f64> = pairs.iter().map(|(_, own, lent)| own - lent).collect();
    let enough = pairs.len() >= FEWEST;
    let faster =
        |p: &ParticipantId| Some(data.measured(p, own, SPEED)? - data.measured(p, lent, SPEED)?);
    let faster: Vec<Option<f64>> = pairs.iter().map(|(p, ..)| faster(p)).collect();
    let known = faster.iter().flatten().count() >= FEWEST;
    let at_same_speed = if enough && known && asked.id != SPEED {
        let y: Vec<Option<f64>> = differences.iter().copied().map(Some).collect();
        match linear_fit(&faster, &y) {
            Ok(line) => line.band(0.0, 0.95).map(|(low, high)| [line.intercept, low, high]),
            // Everybody's speeds differ by as much.
            Err(StatsError::BadParameter { .. }) => None,
            Err(error) => return Err(error.into()),
        }
    } else {
        None
    };
    Ok(LentContrast {
        outcome: asked.id.clone(),
        title: asked.title.clone(),
        unit: asked.unit.clone(),
        n: pairs.len(),
        own: mean(|pair| pair.1),
        lent: mean(|pair| pair.2),
        difference: enough.then(|| mean_interval(&differences, 0.95)).flatten(),
        at_same_speed,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{DESIGN, SPEED as VELOCITY, analysed_by, id, near, person, tables};
    use maveric_domain::ConditionRow;

    /// The six people, whose fourth condition has somebody else's style.
    fn found() -> BesideLent {
        let design = DESIGN.replace("{ across = true }", "{ other = \"matched\" }");
        let mut tables = tables();
        for i in 0..6 {
            tables.conditions.push(ConditionRow {
                lent: Some(Lent {
                    donor: DriveId::new(format!("D{}-own", i / 2)).unwrap(),
                    donor_shift_points: 1.0,
                    donor_distance_sd: 1.0 + i as f64 / 5.0,
                    donor_within_reach: i < 4,
                }),
                ..crate::testing::steered(i, "across", None, false)
            });
        }
        analysed_by(&design, tables).lent.remove(0)
    }

    #[test]
    fn own_less_lent_stands_with_and_without_the_difference_in_speed() {
        let found = found();
        assert_eq!((found.own, found.condition), (id("same"), id("across")));
        assert_eq!((found.people, found.donors, found.beyond_reach), (6, 3, 2));
        near(found.distance_sd, 1.5);
        let row = |outcome: &str| found.rows.iter().find(|r| r.outcome == outcome).unwrap();
        let trust = row("jian_trust.overall");
        assert_eq!(trust.n, 6);
        near(trust.own, 5.0);
        // By numpy, of the six differences in trust and in speed.
        let expected = [
            (
                trust.difference,
                [0.916_666_666_666_666_6, 0.521_673_441_420_690_5, 1.311_659_891_912_642_8],
            ),
            (
                trust.at_same_speed,
                [0.921_710_063_335_679_1, 0.462_700_724_489_485_7, 1.380_719_402_182_187_2],
            ),
        ];
        for (interval, expected) in expected {
            for (number, expected) in interval.unwrap().into_iter().zip(expected) {
                near(Some(number), expected);
            }
        }
        let speed = row(VELOCITY);
        assert!(speed.difference.is_some() && speed.at_same_speed.is_none());
        // What nobody measured has no numbers, and says so by its n.
        assert_eq!((row("lane_changes").n, row("lane_changes").difference), (0, None));
    }

    #[test]
    fn below_six_people_and_without_an_own_style_nothing_is_said() {
        let design = DESIGN.replace("{ across = true }", "{ other = \"matched\" }");
        let mut five = tables();
        five.post.retain(|score| score.participant != person(5));
        let found = analysed_by(&design, five).lent.remove(0);
        let trust = found.rows.iter().find(|r| r.outcome == "jian_trust.overall").unwrap();
        assert_eq!((trust.n, trust.difference, trust.at_same_speed), (5, None, None));
        let nobodys = design.replace("{ dial = 0 }", "{ dial = 3 }");
        assert!(analysed_by(&nobodys, tables()).lent.is_empty());
        assert!(analysed_by(DESIGN, tables()).lent.is_empty());
    }
}

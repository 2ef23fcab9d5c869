//! What became of the questions that an evaluation asks: of what was learned beside its peers, and of knowing the driver.

use maveric_analysis::{Finding, Part, Question};
use maveric_following::{Compared, FollowingEvaluation, FollowingMethod};

/// Methods that were learned by a network.
pub(crate) const NETWORKS: [FollowingMethod; 6] = [
    FollowingMethod::FollowingDistanceOwn,
    FollowingMethod::FollowingDistanceMean,
    FollowingMethod::ClosedLoopOwn,
    FollowingMethod::ClosedLoopShrunken,
    FollowingMethod::ClosedLoopMean,
    FollowingMethod::ClosedLoopAndIdmShrunken,
];
/// Methods that are the same for everybody, beside which the same with knowledge of the driver stands.
const FOR_ALL: [FollowingMethod; 3] = [
    FollowingMethod::ClosedLoopMean,
    FollowingMethod::IdmPopulation,
    FollowingMethod::FollowingDistanceMean,
];

/// What was learned against each of its peers.
pub(crate) fn beside_peers(evaluation: &FollowingEvaluation) -> Vec<&Compared> {
    let ours = FollowingMethod::ClosedLoopShrunken;
    let peers = evaluation.compared.iter();
    peers
        .filter(|c| c.method == ours && !NETWORKS.contains(&c.beside))
        .collect()
}

/// Each way of knowing the driver against the same for everybody.
pub(crate) fn beside_everybody(evaluation: &FollowingEvaluation) -> Vec<&Compared> {
    let pairs = evaluation.compared.iter();
    pairs.filter(|c| FOR_ALL.contains(&c.beside)).collect()
}

/// The findings of an evaluation; errors have to be below those that they are held beside, and no drive may reach its leader.
pub(crate) fn findings(evaluation: &FollowingEvaluation) -> Vec<Finding> {
    let n = evaluation.people();
    let part = |pair: &&Compared| {
        let label = format!("{} - {}", pair.method.label(), pair.beside.label());
        let estimate = (Some(pair.mean_m), pair.low_m.zip(pair.high_m));
        Part::within(label, n, estimate, (f64::NEG_INFINITY, 0.0))
    };
    let every = |question, pairs: Vec<&Compared>| {
        Finding::every(question, pairs.iter().map(part).collect())
    };
    let driven = evaluation.driven;
    let (hits, drives) = evaluation
        .mean(driven)
        .map_or((0, 0), |mean| (mean.reached_zero, mean.drivers));
    vec![
        every(Question::Better, beside_peers(evaluation)),
        every(Question::Personal, beside_everybody(evaluation)),
        Finding::every(
            Question::Reached,
            vec![Part::never(driven.label(), hits, drives)],
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_analysis::Verdict::{self, Fails, NotShown, Shown, TooFew};

    /// So many drivers, a mean error a method, and one comparison with its interval.
    fn found(drivers: usize, low_m: f64, high_m: f64) -> FollowingEvaluation {
        let driver = |i: usize| {
            serde_json::json!({ "driver": format!("D{i}"), "methods": [],
                "series": { "time_s": [], "gap_m": [], "ego_speed_mps": [], "lead_speed_mps": [], "simulated": [] } })
        };
        let mean = |method: &str, gap: f64| {
            serde_json::json!({ "method": method, "gap_rmse_m": gap, "gap_rmse_median_m": gap, "speed_rmse_mps": 1.0,
                "nrmse": 0.1, "mixed": 0.1, "reached_zero": 0, "drivers": drivers })
        };
        let against = |method: &str, beside: &str| {
            serde_json::json!({ "method": method, "beside": beside, "mean_m": 0.5 * (low_m + high_m), "low_m": low_m,
                "high_m": high_m, "median_m": 0.0, "better": 1, "worse": drivers - 1 })
        };
        serde_json::from_value(serde_json::json!({
            "learned_from": drivers,
            "driven": "closed_loop_shrunken",
            "drivers": (0..drivers).map(driver).collect::<Vec<_>>(),
            "means": [mean("closed_loop_shrunken", 3.0), mean("closed_loop_mean", 3.4), mean("idm_own", 2.0), mean("gipps_own", 2.5),
                mean("idm_population", 2.8), mean("idm_floor", 1.0)],
            "compared": [against("closed_loop_shrunken", "idm_own"), against("closed_loop_shrunken", "closed_loop_mean")],
            "peers": [],
            "time_gap_shrinkage": { "people": drivers, "half_s": 60.0, "within": 1.0, "between": 1.0, "strength_s": 60.0, "most": 0.9 },
            "closed_loop": null,
        }))
        .unwrap()
    }

    fn judged(drivers: usize, low_m: f64, high_m: f64) -> [Verdict; 2] {
        let all = findings(&found(drivers, low_m, high_m));
        [all[0].verdict, all[1].verdict]
    }

    #[test]
    fn an_error_below_its_peers_is_shown_one_above_fails_and_one_that_may_be_either_is_open() {
        assert_eq!(judged(8, -1.8, -0.2), [Shown, Shown]);
        assert_eq!(judged(8, 0.2, 1.8), [Fails, Fails]);
        assert_eq!(judged(8, -1.0, 1.0), [NotShown, NotShown]);
        assert_eq!(judged(4, -1.8, -0.2), [TooFew, TooFew]);
    }

    #[test]
    fn further_drives_of_the_same_people_are_no_further_people() {
        let mut evaluation = found(8, -1.8, -0.2);
        assert_eq!(findings(&evaluation)[0].verdict, Shown);
        for (i, drive) in evaluation.drivers.iter_mut().enumerate() {
            drive.person = Some(format!("P{}", i / 2));
        }
        let all = findings(&evaluation);
        assert_eq!((all[0].parts[0].n, all[0].verdict), (4, TooFew));
    }

    #[test]
    fn the_best_of_the_peers_stands_beside_ours_and_drivers_are_counted_not_named() {
        let cards = |low_m, high_m| {
            let evaluation = found(8, low_m, high_m);
            let following = maveric_pages::cards::following::Following {
                found: &evaluation,
                peers: beside_peers(&evaluation),
                personal: beside_everybody(&evaluation),
                networks: &NETWORKS,
                driven: evaluation.driven,
            };
            following.cards(&findings(&evaluation)).unwrap()
        };
        let all = cards(0.2, 1.8);
        let (better, personal) = (&all[0], &all[1]);
        assert!(
            better.answer.contains("3.00 m") && better.answer.contains("IDM, own 2.00 m"),
            "{}",
            better.answer
        );
        let number = format!("{:?}", better.number);
        assert!(
            number.contains("2.80 m") && number.contains("1.00 m"),
            "the population's and the fitted law too: {number}"
        );
        assert!(
            personal.answer.contains("1 of 8 nearer, 7 further off"),
            "{}",
            personal.answer
        );
        assert!(!personal.answer.contains("D1"));
        let tie = cards(-1.0, 1.0);
        assert!(tie[0].answer.contains("a tie by its interval"));
    }

    #[test]
    fn one_drive_that_reaches_its_leader_is_enough() {
        let reached = |times: usize, drivers: usize| {
            let mut evaluation = found(drivers, -1.8, -0.2);
            for mean in &mut evaluation.means {
                // Another method that does it decides nothing.
                let ours = mean.method == FollowingMethod::ClosedLoopShrunken;
                mean.reached_zero = if ours { times } else { 1 };
            }
            findings(&evaluation)[2].verdict
        };
        assert_eq!(
            [reached(0, 8), reached(1, 8), reached(0, 4)],
            [Shown, Fails, TooFew]
        );
    }
}

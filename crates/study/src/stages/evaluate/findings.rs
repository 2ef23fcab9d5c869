//! What became of the questions that an evaluation asks: of knowing the driver, and of staying behind the leader.

use maveric_analysis::{Finding, Part, Question};
use maveric_following::{Compared, FollowingEvaluation, FollowingMethod};

/// Each way of knowing the driver against the same for everybody.
pub(crate) fn beside_everybody(evaluation: &FollowingEvaluation) -> Vec<&Compared> {
    let pairs = evaluation.compared.iter();
    pairs.filter(|c| c.beside == FollowingMethod::IdmPopulation).collect()
}

/// The findings of an evaluation; errors have to be below those that they are held beside, and no drive may reach its leader.
pub(crate) fn findings(evaluation: &FollowingEvaluation) -> Vec<Finding> {
    let n = evaluation.people();
    let part = |pair: &&Compared| {
        let label = format!("{} - {}", pair.method.label(), pair.beside.label());
        let estimate = (Some(pair.mean_m), pair.low_m.zip(pair.high_m));
        Part::within(label, n, estimate, (f64::NEG_INFINITY, 0.0))
    };
    let pairs = beside_everybody(evaluation);
    let driven = evaluation.driven;
    let (hits, drives) =
        evaluation.mean(driven).map_or((0, 0), |mean| (mean.reached_zero, mean.drivers));
    vec![
        Finding::every(Question::Personal, pairs.iter().map(part).collect()),
        Finding::every(Question::Reached, vec![Part::never(driven.label(), hits, drives)]),
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
            "driven": "idm_population_own_time_gap",
            "drivers": (0..drivers).map(driver).collect::<Vec<_>>(),
            "means": [mean("idm_population", 2.8), mean("idm_population_own_time_gap", 2.5), mean("idm_own", 2.0)],
            "compared": [against("idm_population_own_time_gap", "idm_population"), against("idm_own", "idm_population_own_time_gap")],
        }))
        .unwrap()
    }

    fn personal(drivers: usize, low_m: f64, high_m: f64) -> Verdict {
        findings(&found(drivers, low_m, high_m))[0].verdict
    }

    #[test]
    fn an_error_below_that_of_everybody_is_shown_one_above_fails_and_one_that_may_be_either_is_open()
     {
        assert_eq!(personal(8, -1.8, -0.2), Shown);
        assert_eq!(personal(8, 0.2, 1.8), Fails);
        assert_eq!(personal(8, -1.0, 1.0), NotShown);
        assert_eq!(personal(4, -1.8, -0.2), TooFew);
    }

    #[test]
    fn one_way_of_knowing_the_driver_that_fails_is_enough() {
        let mut evaluation = found(8, -1.8, -0.2);
        assert_eq!(findings(&evaluation)[0].parts.len(), 1, "not own beside own");
        let mut own = evaluation.compared[0];
        own.method = FollowingMethod::IdmOwn;
        (own.low_m, own.high_m) = (Some(0.2), Some(1.8));
        evaluation.compared.push(own);
        let all = findings(&evaluation);
        assert_eq!((all[0].parts.len(), all[0].verdict), (2, Fails));
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
    fn cards_count_drivers_and_do_not_name_them() {
        let evaluation = found(8, 0.2, 1.8);
        let following = maveric_pages::cards::following::Following {
            found: &evaluation,
            personal: beside_everybody(&evaluation),
        };
        let cards = following.cards(&findings(&evaluation)).unwrap();
        let [personal, reached] = cards.as_slice() else { panic!("{cards:?}") };
        assert!(personal.answer.contains("1 of 8 nearer, 7 further off"), "{}", personal.answer);
        assert!(!personal.answer.contains("D1"));
        assert!(reached.answer.contains("IDM, population and own time gap"), "{}", reached.answer);
    }

    #[test]
    fn one_drive_that_reaches_its_leader_is_enough() {
        let reached = |times: usize, drivers: usize| {
            let mut evaluation = found(drivers, -1.8, -0.2);
            for mean in &mut evaluation.means {
                // Another method that does it decides nothing.
                let ours = mean.method == FollowingMethod::IdmPopulationOwnTimeGap;
                mean.reached_zero = if ours { times } else { 1 };
            }
            findings(&evaluation)[1].verdict
        };
        assert_eq!([reached(0, 8), reached(1, 8), reached(0, 4)], [Shown, Fails, TooFew]);
    }
}

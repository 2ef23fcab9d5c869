//! What is driven by default in a recorded person's place, and the rule by which that was chosen, once.

use crate::{
    closed_loop_network::train_all,
    error::{FollowingError, enough_drivers},
    evaluation::drive,
    method::FollowingMethod as M,
    peers,
    results::DriverEvaluation,
    run::FollowingRun,
    settings::FollowingSettings,
    simulation_errors::SimulationErrors,
};
use serde::Serialize;

/// What the others are held beside.
const BESIDE: M = M::IdmPopulationOwnTimeGap;

/// Tries every candidate on people it did not learn from, by their fit rows alone.
///
/// People are dealt into `folds` by the place of their first drive. Each fold is judged by what was learned from the fit rows of the
/// others: a person's own part are the first two thirds of the fit rows, and the last third of the fit rows is driven.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] where a fold leaves fewer than two people to learn from, and those of [`evaluate`](crate::evaluate).
pub fn try_over_people(
    runs: &[FollowingRun],
    folds: usize,
    settings: &FollowingSettings,
) -> Result<Vec<DriverEvaluation>, FollowingError> {
    settings.check()?;
    for run in runs {
        run.long_enough()?;
    }
    let people = peers::people(runs);
    let mut evaluations = Vec::new();
    for fold in 0..folds.min(people.len()) {
        let part = |judged: bool| -> Vec<FollowingRun> {
            let is_in = |run: &&FollowingRun| {
                let place = people.iter().position(|person| *person == run.person());
                place.is_some_and(|place| place % folds == fold) == judged
            };
            runs.iter().filter(is_in).cloned().collect()
        };
        let (judged, learned) = (part(true), part(false));
        enough_drivers(peers::people(&learned).len(), 2)?;
        let judged: Vec<FollowingRun> = judged
            .iter()
            .map(FollowingRun::fit_alone)
            .collect::<Result<_, _>>()?;
        let (mut laws, _) = peers::idm(&judged, &learned, settings)?;
        peers::add_own_idm(&mut laws, &judged, settings)?;
        let networks = train_all(&judged, &learned, settings)?;
        evaluations.extend(drive(&judged, &laws, &networks, None, settings)?);
    }
    Ok(evaluations)
}

/// One candidate on the people of one set or of all.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Candidate {
    /// Which.
    pub method: M,
    /// Mean over sets of the mean over people of the logarithm of its error of the gap over that of IDM of the others with the own
    /// time gap; below 0 where it is nearer.
    pub score: f64,
    /// People in whose place it reached the leader.
    pub reached_zero: usize,
}

/// One candidate in the place of one person.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Name of the person.
    pub person: String,
    /// Which candidate.
    pub method: M,
    /// RMSE of the simulated gap over the person's test rows, in m: the mean over the drives of one who has several.
    pub gap_rmse_m: f64,
    /// Whether the simulated gap reached 0, in any of them.
    pub reached_zero: bool,
}

/// The candidates of some people who were tried.
pub fn trials(drivers: &[DriverEvaluation]) -> Vec<Trial> {
    let people = peers::each_once(drivers.iter().map(DriverEvaluation::person));
    let trial = |person: &str, method: M| {
        let drives = drivers.iter().filter(|d| d.person() == person);
        let errors: Vec<SimulationErrors> = drives
            .flat_map(|d| &d.methods)
            .filter(|m| m.method == method)
            .map(|m| m.errors)
            .collect();
        (!errors.is_empty()).then(|| Trial {
            person: person.to_owned(),
            method,
            gap_rmse_m: errors.iter().map(|e| e.gap_rmse_m).sum::<f64>() / errors.len() as f64,
            reached_zero: errors.iter().any(|e| e.reached_zero),
        })
    };
    let of_person = |person: &str| -> Vec<Trial> {
        let candidates = M::CANDIDATES.into_iter();
        candidates.filter_map(|m| trial(person, m)).collect()
    };
    people.into_iter().flat_map(of_person).collect()
}

/// The candidates of several sets of people, the best first: the rule.
///
/// Every set weighs the same, and within a set every person. Ratios, because a metre is little on a track and much in dense traffic.
/// Whatever reached the leader comes after whatever did not. Candidates without a trial of everybody are left out.
pub fn ranked(sets: &[Vec<Trial>]) -> Vec<Candidate> {
    let candidate = |method: M| {
        let in_set = |set: &Vec<Trial>| {
            let people = set.iter().filter(|t| t.method == BESIDE);
            let ratio = |beside: &Trial| {
                let same = |t: &&Trial| t.method == method && t.person == beside.person;
                let trial = set.iter().find(same)?;
                Some(libm::log(trial.gap_rmse_m / beside.gap_rmse_m))
            };
            let ratios = people.map(ratio).collect::<Option<Vec<f64>>>()?;
            (!ratios.is_empty()).then(|| ratios.iter().sum::<f64>() / ratios.len() as f64)
        };
        let means = sets.iter().map(in_set).collect::<Option<Vec<f64>>>()?;
        let reached = sets.iter().flatten();
        Some(Candidate {
            method,
            score: means.iter().sum::<f64>() / means.len() as f64,
            reached_zero: reached
                .filter(|t| t.method == method && t.reached_zero)
                .count(),
        })
    };
    let mut candidates: Vec<Candidate> = M::CANDIDATES.into_iter().filter_map(candidate).collect();
    candidates.sort_by(|a, b| {
        let reaches = |c: &Candidate| c.reached_zero > 0;
        reaches(a)
            .cmp(&reaches(b))
            .then(a.score.total_cmp(&b.score))
    });
    candidates
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ClosedLoopSettings, SearchSettings, testing};

    /// Each candidate on the people of a set: its error beside 2 m of the one that all are held beside, and whether it reached the leader.
    fn set(people: &[&str], of: impl Fn(M, usize) -> (f64, bool)) -> Vec<Trial> {
        let trial = |(at, person): (usize, &&str)| {
            let person = (*person).to_owned();
            M::CANDIDATES.map(|method| {
                let (gap_rmse_m, reached_zero) = of(method, at);
                Trial {
                    person: person.clone(),
                    method,
                    gap_rmse_m,
                    reached_zero,
                }
            })
        };
        people.iter().enumerate().flat_map(trial).collect()
    }

    #[test]
    fn sets_weigh_alike_however_many_people_they_have_and_metres_do_not() {
        // Halved for one person of a track, a tenth further off for each of three in traffic, where a metre is a hundred times as much.
        let track = set(&["a"], |m, _| {
            (if m == M::IdmOwn { 50.0 } else { 100.0 }, false)
        });
        let traffic = set(&["b", "c", "d"], |m, _| {
            (if m == M::IdmOwn { 1.1 } else { 1.0 }, false)
        });
        let best = ranked(&[track, traffic])[0];
        assert_eq!(best.method, M::IdmOwn);
        assert!((best.score - 0.5 * (0.5_f64.ln() + 1.1_f64.ln())).abs() < 1e-12);
    }

    #[test]
    fn what_reached_the_leader_comes_last_and_what_was_not_tried_on_everybody_not_at_all() {
        let mut trials = set(&["a", "b"], |m, at| {
            (
                if m == M::ClosedLoopOwn { 0.1 } else { 1.0 },
                m == M::ClosedLoopOwn && at == 1,
            )
        });
        trials.retain(|t| !(t.method == M::IdmOwn && t.person == "b"));
        let found = ranked(&[trials]);
        assert_eq!(found.len(), M::CANDIDATES.len() - 1);
        let last = found.last().unwrap();
        assert_eq!((last.method, last.reached_zero), (M::ClosedLoopOwn, 1));
        assert!(found.iter().all(|c| c.method != M::IdmOwn));
    }

    fn settings() -> FollowingSettings {
        FollowingSettings {
            search: SearchSettings {
                members_per_parameter: 4,
                generations: 10,
                ..SearchSettings::default()
            },
            closed_loop_seeds: 1,
            closed_loop: ClosedLoopSettings {
                iterations: 30,
                ..ClosedLoopSettings::default()
            },
            ..FollowingSettings::default()
        }
    }

    fn runs() -> Vec<FollowingRun> {
        let run =
            |t: f64| testing::driven_by_idm(&format!("T{t}"), testing::DRIVER.with_time_gap_s(t));
        [1.0, 1.4, 1.8, 2.2].map(run).to_vec()
    }

    #[test]
    fn drives_of_one_person_are_in_one_fold_and_make_one_trial_a_candidate() {
        let mut runs = runs();
        runs[1] = runs[1].clone().of_person("T1");
        let found = try_over_people(&runs, 3, &settings()).unwrap();
        let names: Vec<&str> = found.iter().map(|d| d.driver.as_str()).collect();
        assert_eq!(names, ["T1", "T1.4", "T1.8", "T2.2"]);
        let tried = trials(&found);
        assert_eq!(tried.len(), 3 * M::CANDIDATES.len());
        let of_both = tried.iter().find(|t| t.method == BESIDE).unwrap();
        let [first, second] = [0, 1].map(|at| found[at].gap_rmse_m(BESIDE).unwrap());
        assert_eq!(of_both.person, "T1");
        assert!((of_both.gap_rmse_m - 0.5 * (first + second)).abs() < 1e-12);
    }

    #[test]
    fn people_are_judged_by_others_and_their_test_rows_move_nothing() {
        let (mut runs, settings) = (runs(), settings());
        let before = try_over_people(&runs, 2, &settings).unwrap();
        let names: Vec<&str> = before.iter().map(|d| d.driver.as_str()).collect();
        assert_eq!(names, ["T1", "T1.8", "T1.4", "T2.2"]);
        assert_eq!(trials(&before).len(), 4 * M::CANDIDATES.len());
        for run in &mut runs {
            let mut columns = run.columns().clone();
            columns.gap_m[run.test_start()..].fill(50.0);
            *run = FollowingRun::new(run.driver(), run.rate_hz(), columns).unwrap();
        }
        assert_eq!(before, try_over_people(&runs, 2, &settings).unwrap());
        let one = try_over_people(&runs[..2], 2, &settings);
        assert!(matches!(one, Err(FollowingError::TooFewDrivers { .. })));
    }

    #[test]
    fn what_is_driven_by_default_is_what_the_rule_says_of_the_recordings() {
        let mut sets: std::collections::BTreeMap<&str, Vec<Trial>> =
            std::collections::BTreeMap::new();
        for line in include_str!("driven_by_default.csv").lines().skip(1) {
            let [set, person, method, gap, reached] = line.split(',').collect::<Vec<_>>()[..]
            else {
                panic!("{line}")
            };
            sets.entry(set).or_default().push(Trial {
                person: person.to_owned(),
                method: M::all().find(|m| m.as_str() == method).unwrap(),
                gap_rmse_m: gap.parse().unwrap(),
                reached_zero: reached == "1",
            });
        }
        let sets: Vec<Vec<Trial>> = sets.into_values().collect();
        assert_eq!(
            sets.iter()
                .map(|s| s.len() / M::CANDIDATES.len())
                .collect::<Vec<_>>(),
            [12, 4]
        );
        assert_eq!(ranked(&sets)[0].method, M::DRIVEN_BY_DEFAULT);
    }
}

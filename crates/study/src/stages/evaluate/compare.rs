//! Two methods person by person.

use crate::{error::StudyError, mean::mean_interval};
use maveric_following::{Compared, FollowingEvaluation, FollowingMethod, median};

/// Every pair of methods of which both were tried, with intervals from people drawn with replacement.
pub(super) fn pairs(
    evaluation: &FollowingEvaluation,
    seed: u64,
) -> Result<Vec<Compared>, StudyError> {
    FollowingMethod::PAIRS
        .into_iter()
        .map(|(method, beside)| (method, beside, evaluation.differences_m(method, beside)))
        .filter(|(.., differences)| !differences.is_empty())
        .map(|(method, beside, differences)| compared(method, beside, &differences, seed))
        .collect()
}

fn compared(
    method: FollowingMethod,
    beside: FollowingMethod,
    differences: &[f64],
    seed: u64,
) -> Result<Compared, StudyError> {
    let values: Vec<Option<f64>> = differences.iter().copied().map(Some).collect();
    let interval = mean_interval(&values, seed)?;
    Ok(Compared {
        method,
        beside,
        mean_m: differences.iter().sum::<f64>() / differences.len() as f64,
        low_m: interval.and_then(|i| i.low),
        high_m: interval.and_then(|i| i.high),
        median_m: median(differences),
        better: differences.iter().filter(|d| **d < 0.0).count(),
        worse: differences.iter().filter(|d| **d > 0.0).count(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_drivers_carry_a_mean_and_its_interval_says_so() {
        let (a, b) = (FollowingMethod::IdmPopulationOwnTimeGap, FollowingMethod::IdmPopulation);
        let mut differences = vec![0.1; 19];
        differences.push(-20.0);
        let found = compared(a, b, &differences, 1).unwrap();
        assert!((found.mean_m + 0.905).abs() < 1e-12 && (found.median_m - 0.1).abs() < 1e-12);
        assert_eq!((found.better, found.worse), (1, 19));
        assert!(found.low_m.unwrap() < -1.5 && found.high_m.unwrap() > 0.05);
        let alone = compared(a, b, &[0.5], 1).unwrap();
        assert_eq!((alone.low_m, alone.high_m), (None, None));
    }
}

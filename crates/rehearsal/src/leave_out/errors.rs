//! Do standard errors hold? Two drives of one person in one role, each coordinate of the style in units of what both leave open.

use super::{By, Drove, Missing, Styles, Uncounted, order::twice, people};
use crate::validation::standardised;
use maveric_domain::ConditionId;
use serde::Serialize;

/// How many coordinates lie within so many standard errors; of so few people there is no verdict.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ErrorShare {
    pub pairs: usize,
    /// Coordinates over them; one of which the second drive says nothing is not counted.
    pub coordinates: usize,
    /// Coordinates within one standard error; 68.3 % are expected.
    pub within_1: usize,
    /// Within two; 95.4 % are expected.
    pub within_2: usize,
    pub uncounted: Vec<Uncounted>,
}

/// Counts over everybody's first two drives in each of the roles; `folds` in the order of [`people`], styles fitted without a score.
/// With a `prior` N(0, I) in them, a second style is expected where the prior draws the first one to.
pub fn errors_that_hold(
    drives: &[Drove],
    folds: &[Styles],
    roles: &[ConditionId],
    prior: bool,
) -> ErrorShare {
    let mut share = ErrorShare::default();
    for (who, styles) in people(drives).iter().zip(folds) {
        for role in roles {
            let mut miss = |why| share.uncounted.push(Uncounted::new(who, why));
            let (first, second) = match twice(drives, who, *role) {
                Ok(both) => both,
                Err(why) => {
                    miss(why);
                    continue;
                }
            };
            let ratios = match (&styles[first], &styles[second]) {
                (Some(first), Some(second)) => standardised(first, second, prior, 0.0),
                _ => Vec::new(),
            };
            if ratios.is_empty() {
                // The first drive that shows nothing; the second where both leave a style, of which it says nothing.
                let blank = if styles[first].is_none() { first } else { second };
                miss(Missing::reading(&drives[blank], By::Line));
            }
            share.pairs += usize::from(!ratios.is_empty());
            share.coordinates += ratios.len();
            let within = |k: f64| ratios.iter().filter(|r| r.abs() <= k).count();
            share.within_1 += within(1.0);
            share.within_2 += within(2.0);
        }
    }
    share
}

#[cfg(test)]
mod tests {
    use super::{super::testing::*, *};

    #[test]
    fn a_drive_that_shows_nothing_is_expected_at_the_mean_and_never_missed() {
        // Nothing seen: the posterior is the prior, so the second mean is 0 whatever the first is.
        let nothing = (vec![0.0], vec![vec![1.0]]);
        let sure = (vec![5.0], vec![vec![0.01]]);
        assert!(standardised(&sure, &nothing, true, 0.0).is_empty(), "nothing is left open");
        let ratio = standardised(&nothing, &sure, true, 0.0)[0];
        assert!((ratio - 5.0 / (0.99_f64 * 0.99 + 0.99 * 0.01).sqrt()).abs() < 1e-12);
        let plain = standardised(&nothing, &sure, false, 0.0)[0];
        assert!((plain - 5.0 / 1.01_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn coordinates_within_one_and_two_standard_errors_are_counted() {
        let mut drives = six();
        for drive in &mut drives {
            drive.role = "calm".parse().unwrap();
        }
        // Differences of 0, .5, …, 2.5 standard errors of √(.5 + .5).
        let styles: Styles = (0..12)
            .map(|i| {
                let mean = if i % 2 == 1 { 0.25 * f64::from(i - 1) } else { 0.0 };
                Some((vec![mean], vec![vec![0.5]]))
            })
            .collect();
        let role = drives[0].role;
        let found = errors_that_hold(&drives, &vec![styles; 6], &[role], false);
        assert_eq!((found.pairs, found.coordinates), (6, 6));
        assert_eq!((found.within_1, found.within_2), (3, 5));
        assert!(found.uncounted.is_empty());
        // Whoever drove once, and whose drive shows nothing, is named.
        let once = errors_that_hold(&six(), &vec![vec![None; 12]; 6], &[role], true);
        assert_eq!((once.pairs, once.coordinates), (0, 0));
        let why: Vec<&Missing> = once.uncounted.iter().map(|u| &u.why).collect();
        assert_eq!(why, [&Missing::Second { role }; 6]);
        let blank = errors_that_hold(&drives, &vec![vec![None; 12]; 6], &[role], true);
        assert_eq!((blank.pairs, blank.uncounted.len()), (0, 6));
        assert!(blank.uncounted[0].why.to_string().contains("no habit"));
    }
}

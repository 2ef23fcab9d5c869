//! The laws of each driver: IDM of the others, with the own time gap, and of the driver alone.

use crate::{
    calibrate::{Calibrated, Family},
    error::FollowingError,
    method::FollowingMethod as M,
    run::{FollowingRun, Stretch},
    settings::FollowingSettings,
};
use maveric_domain::stream_seed;
use rayon::prelude::*;

/// The law of each method of [`FollowingMethod::ALL`](M::ALL), fitted for one driver.
pub(crate) type DriverLaws = [(M, Calibrated); 3];

/// Fits the three laws for each of `judged`, in parallel; what is known of other people are the fit rows of `learned`.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] where a driver has no others.
pub(crate) fn laws_of_each(
    judged: &[FollowingRun],
    learned: &[FollowingRun],
    settings: &FollowingSettings,
) -> Result<Vec<DriverLaws>, FollowingError> {
    let search = &settings.search;
    let seed = |driver: &str, method: M| stream_seed(settings.seed, &[driver, method.as_str()]);
    let all: Vec<Stretch<'_>> = learned.iter().map(FollowingRun::fit).collect();
    let of_all = Family::Idm.calibrate(&all, search, seed("", M::IdmPopulation))?;
    let of_driver = |run: &FollowingRun| {
        let others = others(learned, run.person());
        // A person who was not learned from has all people as others.
        let population = if others.len() == learned.len() {
            of_all
        } else {
            Family::Idm.calibrate_from(of_all.law, &others, search)?
        };
        let fit = |family: Family, method: M| {
            family.calibrate(&[run.fit()], search, seed(run.driver(), method))
        };
        let time_gap = Family::IdmTimeGap(population.law);
        Ok([
            (M::IdmPopulation, population),
            (M::IdmPopulationOwnTimeGap, fit(time_gap, M::IdmPopulationOwnTimeGap)?),
            (M::IdmOwn, fit(Family::Idm, M::IdmOwn)?),
        ])
    };
    // The first error in their order, whichever was found first.
    let laws: Vec<_> = judged.par_iter().map(of_driver).collect();
    laws.into_iter().collect()
}

/// The fit rows of the drives of `learned` that are not this person's.
fn others<'a>(learned: &'a [FollowingRun], person: &str) -> Vec<Stretch<'a>> {
    let others = learned.iter().filter(|r| r.person() != person);
    others.map(FollowingRun::fit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SearchSettings, SimulationErrors, simulate, testing};

    fn runs(time_gaps_s: &[f64]) -> Vec<FollowingRun> {
        let run =
            |t: &f64| testing::driven_by_idm(&format!("T{t}"), testing::DRIVER.with_time_gap_s(*t));
        time_gaps_s.iter().map(run).collect()
    }

    fn laws(judged: &[FollowingRun], learned: &[FollowingRun]) -> Vec<DriverLaws> {
        let settings = FollowingSettings {
            search: SearchSettings {
                members_per_parameter: 4,
                generations: 15,
                ..SearchSettings::default()
            },
            ..FollowingSettings::default()
        };
        laws_of_each(judged, learned, &settings).unwrap()
    }

    #[test]
    fn own_time_gap_is_the_only_number_that_differs_from_the_population() {
        let runs = runs(&[1.0, 1.5, 2.2]);
        let found = laws(&runs, &runs);
        let [short, _, long] = found.as_slice() else { panic!("{found:?}") };
        for [(_, population), (_, time_gap), _] in &found {
            let own_s = time_gap.law.time_gap_s;
            assert_eq!(time_gap.law, population.law.with_time_gap_s(own_s));
        }
        // The shortest gap is below that of the others, the longest is above.
        assert!(short[1].1.law.time_gap_s < short[0].1.law.time_gap_s - 0.3);
        assert!(long[1].1.law.time_gap_s > long[0].1.law.time_gap_s + 0.3);
    }

    #[test]
    fn own_numbers_are_those_that_drove() {
        let runs = runs(&[1.0, 1.5, 2.2]);
        for (law, expected_s) in laws(&runs, &runs).into_iter().zip([1.0, 1.5, 2.2]) {
            let own = law[2].1;
            assert!((own.law.time_gap_s - expected_s).abs() < 0.05, "{own:?}");
            assert!(own.fit_gap_rmse_m < 0.2, "{own:?}");
        }
    }

    #[test]
    fn population_is_fitted_to_all_but_the_person() {
        let runs = runs(&[1.0, 1.5, 2.2]);
        // The error that a fit states is the mean over the drives that it was fitted to.
        let is_fitted_to = |judged: &FollowingRun, drives: &[FollowingRun]| {
            let Calibrated { law, fit_gap_rmse_m } =
                laws(std::slice::from_ref(judged), &runs)[0][0].1;
            let rmse = |run: &FollowingRun| {
                let fit = run.fit();
                let by_law = |g, v, lead| law.accel_mps2(g, v, lead);
                let driven = simulate(&fit, "idm", by_law).unwrap();
                SimulationErrors::between(&fit, &driven).gap_rmse_m
            };
            let mean = drives.iter().map(rmse).sum::<f64>() / drives.len() as f64;
            (mean - fit_gap_rmse_m).abs() < 1e-9
        };
        assert!(is_fitted_to(&runs[0], &runs[1..]));
        assert!(is_fitted_to(&runs[2], &runs[..2]));
        assert!(!is_fitted_to(&runs[0], &runs));
        // A person who was not learned from.
        let other = runs[0].clone().of_person("somebody");
        assert!(is_fitted_to(&other, &runs));
        assert!(!is_fitted_to(&other, &runs[1..]));
    }
}

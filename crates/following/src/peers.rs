//! What a few parameters can do: the laws that stand beside what is learned.

use crate::{
    calibrate::{Calibrated, Family, own_time_gap_s},
    closed_loop::gap_rmse_within,
    error::FollowingError,
    law::{Idm, Law},
    method::FollowingMethod as M,
    run::{FollowingRun, Stretch},
    settings::FollowingSettings,
    shrinkage::Shrinkage,
};
use maveric_domain::stream_seed;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The laws fitted for one driver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Peers {
    /// Name of the driver.
    pub driver: String,
    /// The law of each method and how well it fits what it was fitted to.
    pub laws: BTreeMap<M, Calibrated>,
}

/// Those of `learned` who are not `driver`.
pub(crate) fn others<'a>(learned: &'a [FollowingRun], driver: &str) -> Vec<&'a FollowingRun> {
    learned.iter().filter(|r| r.driver() != driver).collect()
}

/// `fit` of each, in parallel; the first error in their order, whichever was found first.
pub(crate) fn each<T: Send>(
    runs: &[FollowingRun],
    fit: impl Fn(&FollowingRun) -> Result<T, FollowingError> + Sync + Send,
) -> Result<Vec<T>, FollowingError> {
    let found: Vec<_> = runs.par_iter().map(fit).collect();
    found.into_iter().collect()
}

/// IDM of everybody else, fitted once for each set of others.
struct Population {
    calibrated: Calibrated,
    law: Idm,
}

impl Population {
    fn of(
        learned: &[FollowingRun],
        driver: &str,
        settings: &FollowingSettings,
    ) -> Result<Self, FollowingError> {
        let fits: Vec<Stretch<'_>> = others(learned, driver).iter().map(|r| r.fit()).collect();
        let seed = seed(settings, driver, M::IdmPopulation);
        let calibrated = Family::Idm.calibrate(&fits, &settings.search, seed)?;
        let Law::Idm(law) = calibrated.law else {
            unreachable!("a family gives its own law")
        };
        Ok(Self { calibrated, law })
    }
}

fn seed(settings: &FollowingSettings, driver: &str, method: M) -> u64 {
    stream_seed(settings.seed, &[driver, method.as_str()])
}

/// Fits IDM of the others, with the own time gap and with it shrunken, for each of `judged`; and says how much of the own time
/// gap's logarithm to believe.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] where a driver has no others.
pub(crate) fn idm(
    judged: &[FollowingRun],
    learned: &[FollowingRun],
    settings: &FollowingSettings,
) -> Result<(Vec<Peers>, Shrinkage), FollowingError> {
    let search = &settings.search;
    let own = |population: &Population, stretch: &Stretch<'_>| {
        let seed = seed(settings, stretch.run.driver(), M::IdmPopulationOwnTimeGap);
        own_time_gap_s(population.law, stretch, search, seed)
    };
    let of_learned = each(learned, |run| {
        let population = Population::of(learned, run.driver(), settings)?;
        let [first, second] = run.fit().halves();
        let log = |half| Ok::<_, FollowingError>(vec![libm::log(own(&population, half)?.0)]);
        let halves = [log(&first)?, log(&second)?];
        Ok((population, halves))
    })?;
    let halves: Vec<_> = of_learned.iter().map(|(_, h)| h.clone()).collect();
    let seconds: Vec<f64> = learned.iter().map(|r| 0.5 * r.fit().seconds()).collect();
    let shrinkage = Shrinkage::estimate(&halves, &seconds)?;
    let place = |run: &FollowingRun| learned.iter().position(|r| r.driver() == run.driver());
    // Strangers have the same others, all who were learned from.
    let of_all = if judged.iter().all(|run| place(run).is_some()) {
        None
    } else {
        Some(Population::of(learned, "", settings)?)
    };
    let peers = each(judged, |run| {
        let known = place(run).map(|at| &of_learned[at].0);
        let Some(population) = known.or(of_all.as_ref()) else {
            unreachable!("who was not learned from is a stranger")
        };
        let fit = run.fit();
        let (own_s, calibrated) = own(population, &fit)?;
        let mean = libm::log(population.law.time_gap_s);
        let log = mean + shrinkage.share(fit.seconds()) * (libm::log(own_s) - mean);
        let law = Law::Idm(population.law.with_time_gap_s(libm::exp(log)));
        Ok(Peers {
            driver: run.driver().to_owned(),
            laws: BTreeMap::from([
                (M::IdmPopulation, population.calibrated),
                (M::IdmPopulationOwnTimeGap, calibrated),
                (M::IdmPopulationShrunkenTimeGap, as_given(law, &fit)),
            ]),
        })
    })?;
    Ok((peers, shrinkage))
}

/// A law that was not fitted by its error on these rows.
fn as_given(law: Law, fit: &Stretch<'_>) -> Calibrated {
    let rmse = gap_rmse_within(fit, law.driving(fit), f64::INFINITY);
    Calibrated {
        law,
        fit_gap_rmse_m: rmse.unwrap_or(f64::MAX),
    }
}

/// Fits IDM to the own fit rows of each of `judged` and adds it to `peers`.
pub(crate) fn add_own_idm(
    peers: &mut [Peers],
    judged: &[FollowingRun],
    settings: &FollowingSettings,
) -> Result<(), FollowingError> {
    let found = each(judged, |run| {
        let seed = seed(settings, run.driver(), M::IdmOwn);
        Family::Idm.calibrate(&[run.fit()], &settings.search, seed)
    })?;
    for (peers, law) in peers.iter_mut().zip(found) {
        peers.laws.insert(M::IdmOwn, law);
    }
    Ok(())
}

/// Fits the other laws and adds them to `peers`, one entry a driver of `judged`.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] where a driver has no others, [`FollowingError::NeverMoves`] for one without a time gap.
pub(crate) fn add_the_rest(
    peers: &mut [Peers],
    judged: &[FollowingRun],
    learned: &[FollowingRun],
    settings: &FollowingSettings,
) -> Result<(), FollowingError> {
    add_own_idm(peers, judged, settings)?;
    let time_gap_s = |run: &FollowingRun| run.fit().mean_time_gap_s(settings.moving_above_mps);
    let found = each(judged, |run| {
        let seed = |method| seed(settings, run.driver(), method);
        let fit = |family: Family, stretches: &[Stretch<'_>], method: M| {
            let found = family.calibrate(stretches, &settings.search, seed(method))?;
            Ok((method, found))
        };
        let from = others(learned, run.driver());
        let fits: Vec<Stretch<'_>> = from.iter().map(|r| r.fit()).collect();
        let gaps = from
            .iter()
            .map(|r| time_gap_s(r))
            .collect::<Result<Vec<_>, _>>()?;
        let of_others_s = gaps.iter().sum::<f64>() / gaps.len() as f64;
        let (own, test) = ([run.fit()], [run.test()]);
        let constant = |method: M, time_gap_s: f64| {
            (
                method,
                as_given(Law::constant_time_gap(time_gap_s), &own[0]),
            )
        };
        Ok([
            constant(M::ConstantTimeGapOwn, time_gap_s(run)?),
            constant(M::ConstantTimeGapPopulation, of_others_s),
            fit(Family::Newell, &own, M::NewellOwn)?,
            fit(Family::Helly, &own, M::HellyOwn)?,
            fit(Family::Helly, &fits, M::HellyPopulation)?,
            fit(Family::Gipps, &own, M::GippsOwn)?,
            fit(Family::Idm, &test, M::IdmFloor)?,
        ])
    })?;
    for (peers, laws) in peers.iter_mut().zip(found) {
        peers.laws.extend(laws);
    }
    Ok(())
}

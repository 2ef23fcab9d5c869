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

/// The drives of `learned` that are not this person's.
pub(crate) fn others<'a>(learned: &'a [FollowingRun], person: &str) -> Vec<&'a FollowingRun> {
    learned.iter().filter(|r| r.person() != person).collect()
}

/// Who drove, each once, in the order of their first drives.
pub(crate) fn people(runs: &[FollowingRun]) -> Vec<&str> {
    each_once(runs.iter().map(FollowingRun::person))
}

/// Names, each once, in the order in which they come first.
pub(crate) fn each_once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut met: Vec<&str> = Vec::new();
    for name in names {
        if !met.contains(&name) {
            met.push(name);
        }
    }
    met
}

/// How much to believe of what was fitted to both halves of the fit rows of each of `runs`: who has several drives is one person, by the
/// mean of their halves.
pub(crate) fn shrinkage_of(
    runs: &[FollowingRun],
    halves: &[[Vec<f64>; 2]],
) -> Result<Shrinkage, FollowingError> {
    let of_person = |person: &str| {
        let drives = runs.iter().zip(halves);
        let drives: Vec<(&FollowingRun, &[Vec<f64>; 2])> =
            drives.filter(|(run, _)| run.person() == person).collect();
        let mean = |half: usize| -> Vec<f64> {
            let numbers = 0..drives[0].1[half].len();
            let sum = |k: usize| drives.iter().map(|(_, h)| h[half][k]).sum::<f64>();
            numbers.map(|k| sum(k) / drives.len() as f64).collect()
        };
        let seconds = drives.iter().map(|(run, _)| 0.5 * run.fit().seconds());
        ([mean(0), mean(1)], seconds.sum::<f64>())
    };
    let (halves, seconds): (Vec<[Vec<f64>; 2]>, Vec<f64>) =
        people(runs).into_iter().map(of_person).unzip();
    Shrinkage::estimate(&halves, &seconds)
}

/// The mean over people but this one of the mean of a value over the drives of each.
fn mean_over_others(
    learned: &[FollowingRun],
    person: &str,
    value: impl Fn(&FollowingRun) -> Result<f64, FollowingError>,
) -> Result<f64, FollowingError> {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let of_person = |other: &str| -> Result<f64, FollowingError> {
        let drives = learned.iter().filter(|r| r.person() == other);
        let values: Vec<f64> = drives.map(&value).collect::<Result<_, _>>()?;
        Ok(mean(&values))
    };
    let others = people(learned).into_iter().filter(|p| *p != person);
    let means: Vec<f64> = others.map(of_person).collect::<Result<_, _>>()?;
    Ok(mean(&means))
}

/// `fit` of each, in parallel; the first error in their order, whichever was found first.
pub(crate) fn each<T: Send>(
    runs: &[FollowingRun],
    fit: impl Fn(&FollowingRun) -> Result<T, FollowingError> + Sync + Send,
) -> Result<Vec<T>, FollowingError> {
    let results: Vec<_> = runs.par_iter().map(fit).collect();
    results.into_iter().collect()
}

/// A law of all who were learned from, and from there on that of all but one.
struct Population<'a> {
    learned: &'a [FollowingRun],
    settings: &'a FollowingSettings,
    family: Family,
    of_all: Calibrated,
}

impl<'a> Population<'a> {
    fn calibrate(
        family: Family,
        method: M,
        learned: &'a [FollowingRun],
        settings: &'a FollowingSettings,
    ) -> Result<Self, FollowingError> {
        let fits: Vec<Stretch<'_>> = learned.iter().map(FollowingRun::fit).collect();
        let of_all = family.calibrate(&fits, &settings.search, seed(settings, "", method))?;
        Ok(Self {
            learned,
            settings,
            family,
            of_all,
        })
    }

    /// That of the others; of all, for who was not learned from.
    fn without(&self, person: &str) -> Result<Calibrated, FollowingError> {
        let others = others(self.learned, person);
        if others.len() == self.learned.len() {
            return Ok(self.of_all);
        }
        let fits: Vec<Stretch<'_>> = others.iter().map(|r| r.fit()).collect();
        self.family
            .calibrate_from(self.of_all.law, &fits, &self.settings.search)
    }
}

fn idm_of(calibrated: &Calibrated) -> Idm {
    let Law::Idm(law) = calibrated.law else {
        unreachable!("a family gives its own law")
    };
    law
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
    let fit_time_gap = |population: Idm, stretch: &Stretch<'_>| {
        let seed = seed(settings, stretch.run.driver(), M::IdmPopulationOwnTimeGap);
        own_time_gap_s(population, stretch, search, seed)
    };
    let population = Population::calibrate(Family::Idm, M::IdmPopulation, learned, settings)?;
    let of_learned = each(learned, |run| {
        let others = population.without(run.person())?;
        let [first, second] = run.fit().halves();
        let log =
            |half| Ok::<_, FollowingError>(vec![libm::log(fit_time_gap(idm_of(&others), half)?.0)]);
        let halves = [log(&first)?, log(&second)?];
        Ok((others, halves))
    })?;
    let halves: Vec<_> = of_learned.iter().map(|(_, h)| h.clone()).collect();
    let shrinkage = shrinkage_of(learned, &halves)?;
    let place = |run: &FollowingRun| learned.iter().position(|r| r.person() == run.person());
    let peers = each(judged, |run| {
        // Strangers have the same others, all who were learned from.
        let others = place(run).map_or(population.of_all, |index| of_learned[index].0);
        let law = idm_of(&others);
        let fit = run.fit();
        let (own_s, calibrated) = fit_time_gap(law, &fit)?;
        let mean = libm::log(law.time_gap_s);
        let log = mean + shrinkage.share(fit.seconds()) * (libm::log(own_s) - mean);
        let shrunken = Law::Idm(law.with_time_gap_s(libm::exp(log)));
        Ok(Peers {
            driver: run.driver().to_owned(),
            laws: BTreeMap::from([
                (M::IdmPopulation, others),
                (M::IdmPopulationOwnTimeGap, calibrated),
                (M::IdmPopulationShrunkenTimeGap, as_given(shrunken, &fit)),
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
    let calibrated = each(judged, |run| {
        let seed = seed(settings, run.driver(), M::IdmOwn);
        Family::Idm.calibrate(&[run.fit()], &settings.search, seed)
    })?;
    for (peers, law) in peers.iter_mut().zip(calibrated) {
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
    let helly = Population::calibrate(Family::Helly, M::HellyPopulation, learned, settings)?;
    let laws_of_each = each(judged, |run| {
        let seed = |method| seed(settings, run.driver(), method);
        let fit = |family: Family, stretches: &[Stretch<'_>], method: M| {
            let calibrated = family.calibrate(stretches, &settings.search, seed(method))?;
            Ok((method, calibrated))
        };
        let of_others_s = mean_over_others(learned, run.person(), time_gap_s)?;
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
            (M::HellyPopulation, helly.without(run.person())?),
            fit(Family::Gipps, &own, M::GippsOwn)?,
            fit(Family::Idm, &test, M::IdmFloor)?,
        ])
    })?;
    for (peers, laws) in peers.iter_mut().zip(laws_of_each) {
        peers.laws.extend(laws);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    /// Drives of 60 s to fit; those of a name that begins with A are one person's.
    fn drives(names: &[&str]) -> Vec<FollowingRun> {
        let run = |name: &&str| {
            let run = testing::behind(name, 900, 20.0, 15.0, |_| 15.0);
            if name.starts_with('A') {
                run.of_person("A")
            } else {
                run
            }
        };
        names.iter().map(run).collect()
    }

    #[test]
    fn drives_of_one_person_are_believed_as_one_persons() {
        let halves = [(0.0, 2.0), (2.0, 0.0), (4.0, 2.0), (7.0, 9.0)];
        let halves = halves.map(|(a, b)| [vec![a], vec![b]]);
        let found = shrinkage_of(&drives(&["A1", "A2", "B", "C"]), &halves).unwrap();
        // A has 1 in both halves: middles 1, 3, 8 and within (0 + 2 + 2) / 3; two degrees of freedom say nothing yet.
        assert_eq!(found.people, 3);
        assert!((found.half_s - 40.0).abs() < 1e-12);
        assert!((found.within - 4.0 / 3.0).abs() < 1e-12);
        assert!((found.between - (13.0 - 2.0 / 3.0)).abs() < 1e-12);
        assert!(found.most.abs() < 1e-12);
    }

    #[test]
    fn a_mean_over_others_has_each_person_once_however_many_drives_they_have() {
        let runs = drives(&["A1", "A2", "A3", "B", "C"]);
        let value = |run: &FollowingRun| Ok(if run.person() == "A" { 1.0 } else { 2.0 });
        let of_others = |person| mean_over_others(&runs, person, value).unwrap();
        assert!((of_others("C") - 1.5).abs() < 1e-12);
        assert!((of_others("A") - 2.0).abs() < 1e-12);
    }
}

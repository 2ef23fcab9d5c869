//! How often each test says yes, over many studies.

use crate::outcomes::{Found, Part, Studied};
use maveric_analysis::{Judged, Verdict};
use maveric_domain::ConditionId;
use maveric_stats::{Proportion, proportion};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Level of every test.
pub const ALPHA: f64 = 0.05;

/// One test over the studies of a cell.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TestRate {
    /// Part of the report.
    pub part: Part,
    /// Name of the test.
    pub key: String,
    /// Studies in which the test had a p.
    pub studies: usize,
    /// Those with p < .05.
    pub rejected: usize,
    /// Their share, with Wilson's 95 % interval.
    pub rate: Option<Proportion>,
    /// Share with p < .05 after Holm within the test's family.
    pub holm: Option<Proportion>,
    /// Mean of the estimate (r, share less ½, difference or coefficient); none for an omnibus test.
    pub mean_estimate: Option<f64>,
    /// The same over the studies with p < .05: what a reader sees who is shown those alone.
    pub mean_when_significant: Option<f64>,
    /// Share of studies with an estimate above zero.
    pub above_zero: Option<Proportion>,
}

/// One family over the studies of a cell.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FamilyRate {
    /// Name of the family.
    pub family: String,
    /// Tests in it.
    pub tests: usize,
    /// Share of studies in which any of them has p < .05, uncorrected.
    pub any_uncorrected: Option<Proportion>,
    /// The same after Holm.
    pub any_holm: Option<Proportion>,
}

/// One declared hypothesis over the studies of a cell.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct HypothesisRate {
    /// In words, as declared.
    pub says: String,
    /// Id of the outcome.
    pub outcome: String,
    /// The conditions: first minus second.
    pub contrast: [ConditionId; 2],
    /// Studies that could judge it.
    pub studies: usize,
    /// Share of them in which it is shown by its own rule, with Wilson's 95 % interval: its power where it is true.
    pub shown: Option<Proportion>,
    /// Share in which it fails.
    pub fails: Option<Proportion>,
}

impl HypothesisRate {
    fn of(judged: &[&Judged]) -> Option<Self> {
        let first = judged.first()?;
        let asked = judged.iter().filter(|j| j.verdict != Verdict::NotAsked);
        let studies = asked.count();
        let became = |verdict| {
            let came = judged.iter().filter(|j| j.verdict == verdict);
            share(came.count(), studies)
        };
        Some(Self {
            says: first.says.clone(),
            outcome: first.outcome.clone(),
            contrast: [first.first, first.second],
            studies,
            shown: became(Verdict::Shown),
            fails: became(Verdict::Fails),
        })
    }
}

/// Studies of one size and one scale of the effects.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Cell {
    /// Participants of each study.
    pub participants: usize,
    /// What every effect is multiplied with.
    pub effect_scale: f64,
    /// Studies.
    pub studies: usize,
    /// Every test of the report.
    pub tests: Vec<TestRate>,
    /// Every family.
    pub families: Vec<FamilyRate>,
    /// Every declared hypothesis, in the design's order.
    #[serde(default)]
    pub hypotheses: Vec<HypothesisRate>,
}

fn share(part: usize, whole: usize) -> Option<Proportion> {
    proportion(part, whole, 0.95).ok()
}

impl Cell {
    /// Counts over studies, each with the same tests in the same order.
    pub fn of(participants: usize, effect_scale: f64, studies: &[Studied]) -> Self {
        let count = studies.first().map_or(0, |s| s.tests.len());
        let tests = (0..count).map(|i| {
            let found: Vec<&Found> = studies.iter().map(|s| &s.tests[i]).collect();
            let first = found[0];
            let p: Vec<f64> = found.iter().filter_map(|f| f.p).collect();
            let rejected = p.iter().filter(|p| **p < ALPHA).count();
            let holm: Vec<f64> = found.iter().filter_map(|f| f.p_holm).collect();
            let estimates: Vec<f64> = found.iter().filter_map(|f| f.estimate).collect();
            TestRate {
                part: first.part,
                key: first.key.clone(),
                studies: p.len(),
                rejected,
                rate: share(rejected, p.len()),
                holm: share(holm.iter().filter(|p| **p < ALPHA).count(), holm.len()),
                mean_estimate: (!estimates.is_empty())
                    .then(|| estimates.iter().sum::<f64>() / estimates.len() as f64),
                mean_when_significant: {
                    let yes = |f: &&&Found| f.p.is_some_and(|p| p < ALPHA);
                    let seen: Vec<f64> = found
                        .iter()
                        .filter(yes)
                        .filter_map(|f| f.estimate)
                        .collect();
                    (!seen.is_empty()).then(|| seen.iter().sum::<f64>() / seen.len() as f64)
                },
                above_zero: share(
                    estimates.iter().filter(|e| **e > 0.0).count(),
                    estimates.len(),
                ),
            }
        });
        Self {
            participants,
            effect_scale,
            studies: studies.len(),
            tests: tests.collect(),
            families: families(studies),
            hypotheses: hypotheses(studies),
        }
    }
}

fn hypotheses(studies: &[Studied]) -> Vec<HypothesisRate> {
    let count = studies.first().map_or(0, |s| s.judged.len());
    let of = |i: usize| studies.iter().map(|s| &s.judged[i]).collect::<Vec<_>>();
    (0..count)
        .filter_map(|i| HypothesisRate::of(&of(i)))
        .collect()
}

fn families(studies: &[Studied]) -> Vec<FamilyRate> {
    let mut members: BTreeMap<&str, usize> = BTreeMap::new();
    for family in studies
        .first()
        .into_iter()
        .flat_map(|s| &s.tests)
        .filter_map(|f| f.family.as_deref())
    {
        *members.entry(family).or_default() += 1;
    }
    let any = |family: &str, of: fn(&Found) -> Option<f64>| {
        let hit = |study: &&Studied| {
            study
                .tests
                .iter()
                .filter(|f| f.family.as_deref() == Some(family))
                .any(|f| of(f).is_some_and(|p| p < ALPHA))
        };
        share(studies.iter().filter(hit).count(), studies.len())
    };
    members
        .into_iter()
        .map(|(family, tests)| FamilyRate {
            family: family.to_owned(),
            tests,
            any_uncorrected: any(family, |f| f.p),
            any_holm: any(family, |f| f.p_holm),
        })
        .collect()
}

/// The smallest n at which a rate reaches `wanted`, by straight lines between the sizes tried (ascending); `None` beyond them.
///
/// The first size tried, if the rate is reached there: it may need fewer.
pub fn n_for(curve: &[(usize, f64)], wanted: f64) -> Option<f64> {
    let at = curve.iter().position(|(_, rate)| *rate >= wanted)?;
    let (n, rate) = curve[at];
    if at == 0 {
        return Some(n as f64);
    }
    let (before, low) = curve[at - 1];
    let part = (wanted - low) / (rate - low);
    Some(before as f64 + part * (n - before) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{World, found_in, testing::world};
    use maveric_analysis::Purpose;

    fn found(p: f64, p_holm: f64, estimate: f64) -> Found {
        Found {
            part: Part::Nearer,
            key: "nearer.x".to_owned(),
            family: Some("nearer".to_owned()),
            estimate: Some(estimate),
            p: Some(p),
            p_holm: Some(p_holm),
        }
    }

    #[test]
    fn rates_count_studies_and_families_count_any_test() {
        let studies = [
            vec![found(0.01, 0.02, 0.4), found(0.5, 0.5, -0.1)],
            vec![found(0.04, 0.08, 0.2), found(0.9, 0.9, 0.1)],
            vec![
                Found {
                    p: None,
                    p_holm: None,
                    ..found(0.3, 0.6, 0.3)
                },
                found(0.7, 0.7, 0.3),
            ],
            vec![found(0.3, 0.6, -0.1), found(0.06, 0.12, 0.3)],
        ]
        .map(|tests| Studied {
            tests,
            judged: Vec::new(),
        });
        let cell = Cell::of(24, 1.0, &studies);
        let first = &cell.tests[0];
        assert_eq!((first.studies, first.rejected), (3, 2));
        assert!((first.holm.unwrap().estimate - 1.0 / 3.0).abs() < 1e-12);
        assert!((first.above_zero.unwrap().estimate - 0.75).abs() < 1e-12);
        assert!((first.mean_when_significant.unwrap() - 0.3).abs() < 1e-12);
        let family = &cell.families[0];
        assert_eq!(family.tests, 2);
        assert!((family.any_uncorrected.unwrap().estimate - 0.5).abs() < 1e-12);
        assert!((family.any_holm.unwrap().estimate - 0.25).abs() < 1e-12);
    }

    #[test]
    fn the_size_needed_lies_between_those_tried() {
        let curve = [(12, 0.2), (24, 0.6), (48, 0.9)];
        assert!((n_for(&curve, 0.8).unwrap() - 40.0).abs() < 1e-9);
        assert_eq!(n_for(&curve, 0.95), None);
        assert_eq!(n_for(&curve, 0.1), Some(12.0));
    }

    fn run(world: &World, n: usize, studies: u64) -> Cell {
        let found: Vec<_> = (0..studies)
            .map(|seed| {
                let study = world.study(n, 1000 + seed).unwrap();
                let a = maveric_analysis::analyse(&study.data, Purpose::Simulation);
                found_in(&a.unwrap())
            })
            .collect();
        Cell::of(n, 1.0, &found)
    }

    #[test]
    fn without_effects_tests_say_yes_about_one_time_in_twenty() {
        let cell = run(&world().scaled(0.0), 12, 40);
        let (yes, all) = cell
            .tests
            .iter()
            .fold((0, 0), |(yes, all), t| (yes + t.rejected, all + t.studies));
        let rate = yes as f64 / all as f64;
        assert!((0.03..0.07).contains(&rate), "{rate} of {all}");
    }

    #[test]
    fn planted_effects_are_found() {
        let cell = run(&world(), 24, 6);
        let of = |key: &str| cell.tests.iter().find(|t| t.key == key).unwrap();
        assert_eq!(of("panel.mean_velocity_mps.omnibus").rejected, 6);
        let r = of("homophily.mini_ipip.conscientiousness.mimic-cautious.rosas.competence")
            .mean_estimate
            .unwrap();
        assert!(r < -0.2, "{r}");
    }

    #[test]
    fn a_study_depends_on_its_seed_alone() {
        let world = world();
        let scores = |seed| {
            let study = world.study(5, seed).unwrap();
            let p = study.data.participants[2].clone();
            let name = "rosas.competence".parse().unwrap();
            study.data.rated(&p, study.data.own_style().unwrap(), &name)
        };
        assert_eq!(scores(3), scores(3));
        let all: std::collections::BTreeSet<String> =
            (0..8).map(|seed| format!("{:?}", scores(seed))).collect();
        assert!(all.len() > 2);
    }
}

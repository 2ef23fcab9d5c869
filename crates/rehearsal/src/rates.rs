//! How often each test says yes, over many studies.

use crate::{
    outcomes::{Found, Part, Studied},
    validation::mean,
};
use maveric_analysis::{Judged, Question, Verdict};
use maveric_domain::ConditionId;
use maveric_stats::{Proportion, proportion};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

pub const ALPHA: f64 = 0.05;

/// One test over the studies of a cell.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TestRate {
    pub part: Part,
    pub key: String,
    /// What it is about, for people.
    pub about: String,
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
    pub family: String,
    /// Tests that are corrected together.
    pub tests: usize,
    /// Share of studies in which any of them has p < .05, uncorrected.
    pub any_uncorrected: Option<Proportion>,
    pub any_holm: Option<Proportion>,
}

/// One declared hypothesis over the studies of a cell.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct HypothesisRate {
    pub says: String,
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

/// One question of a study's page over the studies of a cell.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FindingRate {
    pub question: Question,
    /// Studies that could judge it.
    pub studies: usize,
    /// Share of them in which it is shown by its own rule, with Wilson's 95 % interval: its power where it is true.
    pub shown: Option<Proportion>,
    /// Share in which it fails.
    pub fails: Option<Proportion>,
}

impl HypothesisRate {
    fn from_judged(judged: &[&Judged]) -> Option<Self> {
        let first = judged.first()?;
        let (studies, shown, fails) = shares(judged.iter().map(|j| j.verdict));
        Some(Self {
            says: first.says.clone(),
            outcome: first.outcome.clone(),
            contrast: [first.first, first.second],
            studies,
            shown,
            fails,
        })
    }
}

/// Of those that could be judged, how many there are, and the shares shown and failed.
fn shares(
    verdicts: impl Iterator<Item = Verdict>,
) -> (usize, Option<Proportion>, Option<Proportion>) {
    let judged: Vec<Verdict> = verdicts.filter(|v| *v != Verdict::NotAsked).collect();
    let became = |verdict| {
        let came = judged.iter().filter(|v| **v == verdict);
        share(came.count(), judged.len())
    };
    (judged.len(), became(Verdict::Shown), became(Verdict::Fails))
}

/// Studies of one size and one scale of the effects.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Cell {
    pub participants: usize,
    /// What every effect is multiplied with.
    pub effect_scale: f64,
    /// Studies that were made up and analysed.
    pub studies: usize,
    /// Every test of the report.
    pub tests: Vec<TestRate>,
    pub families: Vec<FamilyRate>,
    /// Every declared hypothesis, in the design's order.
    pub hypotheses: Vec<HypothesisRate>,
    /// Every question of the study's page, in its order; the declared hypotheses stand above.
    pub findings: Vec<FindingRate>,
}

fn share(part: usize, whole: usize) -> Option<Proportion> {
    proportion(part, whole, 0.95).ok()
}

impl Cell {
    /// Counts over studies, each with the same tests in the same order.
    pub fn of(participants: usize, effect_scale: f64, studies: &[Studied]) -> Self {
        let count = studies.first().map_or(0, |s| s.tests.len());
        let tests = (0..count).map(|i| {
            let results: Vec<&Found> = studies.iter().map(|s| &s.tests[i]).collect();
            let first = results[0];
            let p: Vec<f64> = results.iter().filter_map(|f| f.p).collect();
            let rejected = p.iter().filter(|p| **p < ALPHA).count();
            let holm: Vec<f64> = results.iter().filter_map(|f| f.p_holm).collect();
            let estimates: Vec<f64> = results.iter().filter_map(|f| f.estimate).collect();
            TestRate {
                part: first.part,
                key: first.key.clone(),
                about: first.about.clone(),
                studies: p.len(),
                rejected,
                rate: share(rejected, p.len()),
                holm: share(holm.iter().filter(|p| **p < ALPHA).count(), holm.len()),
                mean_estimate: mean(&estimates),
                mean_when_significant: {
                    let yes = |f: &&&Found| f.p.is_some_and(|p| p < ALPHA);
                    let seen: Vec<f64> =
                        results.iter().filter(yes).filter_map(|f| f.estimate).collect();
                    mean(&seen)
                },
                above_zero: share(estimates.iter().filter(|e| **e > 0.0).count(), estimates.len()),
            }
        });
        Self {
            participants,
            effect_scale,
            studies: studies.len(),
            tests: tests.collect(),
            families: families(studies),
            hypotheses: hypotheses(studies),
            findings: findings(studies),
        }
    }
}

/// A question may come up in some studies alone: those that ask it are counted.
fn findings(studies: &[Studied]) -> Vec<FindingRate> {
    let mut questions: Vec<Question> = Vec::new();
    for (question, _) in studies.iter().flat_map(|s| &s.findings) {
        let declared = matches!(question, Question::Hypothesis(_));
        if !declared && !questions.contains(question) {
            questions.push(*question);
        }
    }
    let rate = |question: Question| {
        let findings = studies.iter().flat_map(|s| &s.findings);
        let findings = findings.filter(|(answered, _)| *answered == question);
        let (studies, shown, fails) = shares(findings.map(|(_, verdict)| *verdict));
        FindingRate { question, studies, shown, fails }
    };
    questions.into_iter().map(rate).collect()
}

fn hypotheses(studies: &[Studied]) -> Vec<HypothesisRate> {
    let count = studies.first().map_or(0, |s| s.judged.len());
    let judgements = |i: usize| studies.iter().map(|s| &s.judged[i]).collect::<Vec<_>>();
    (0..count).filter_map(|i| HypothesisRate::from_judged(&judgements(i))).collect()
}

fn families(studies: &[Studied]) -> Vec<FamilyRate> {
    let mut members: BTreeMap<&str, usize> = BTreeMap::new();
    for family in
        studies.first().into_iter().flat_map(|s| &s.tests).filter_map(|f| f.family.as_deref())
    {
        *members.entry(family).or_default() += 1;
    }
    let any = |family: &str, p_of: fn(&Found) -> Option<f64>| {
        let hit = |study: &&Studied| {
            study
                .tests
                .iter()
                .filter(|f| f.family.as_deref() == Some(family))
                .any(|f| p_of(f).is_some_and(|p| p < ALPHA))
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

/// The smallest whole n at which a rate reaches `wanted`, by straight lines between the sizes tried (ascending); `None` beyond them.
///
/// The first size tried, if the rate is reached there: it may need fewer.
pub fn n_for(curve: &[(usize, f64)], wanted: f64) -> Option<usize> {
    let index = curve.iter().position(|(_, rate)| *rate >= wanted)?;
    let (n, rate) = curve[index];
    if index == 0 {
        return Some(n);
    }
    let (before, low) = curve[index - 1];
    let part = (wanted - low) / (rate - low);
    // What is a whole number but for rounding is that number.
    Some(before + (part * (n - before) as f64 - 1e-9).ceil() as usize)
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
            about: "X".to_owned(),
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
            vec![Found { p: None, p_holm: None, ..found(0.3, 0.6, 0.3) }, found(0.7, 0.7, 0.3)],
            vec![found(0.3, 0.6, -0.1), found(0.06, 0.12, 0.3)],
        ]
        .map(|tests| Studied { tests, judged: Vec::new(), findings: Vec::new() });
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
    fn a_question_counts_the_studies_that_could_judge_it() {
        let study = |findings: &[(Question, Verdict)]| Studied {
            tests: Vec::new(),
            judged: Vec::new(),
            findings: findings.to_vec(),
        };
        let cell = Cell::of(
            24,
            1.0,
            &[
                study(&[(Question::Dial, Verdict::Shown)]),
                study(&[(Question::Dial, Verdict::Fails), (Question::Stays, Verdict::Shown)]),
                study(&[
                    (Question::Dial, Verdict::NotAsked),
                    (Question::Hypothesis(1), Verdict::Shown),
                ]),
                study(&[(Question::Dial, Verdict::NotShown)]),
            ],
        );
        let of = |rate: &Option<Proportion>| rate.unwrap().estimate;
        let [dial, stays] = cell.findings.as_slice() else {
            panic!("{:?}", cell.findings);
        };
        assert_eq!((dial.question, dial.studies), (Question::Dial, 3));
        assert!((of(&dial.shown) - 1.0 / 3.0).abs() < 1e-12);
        assert!((of(&dial.fails) - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!((stays.question, stays.studies), (Question::Stays, 1));
        assert!((of(&stays.shown) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_size_needed_lies_between_those_tried() {
        let curve = [(12, 0.2), (24, 0.6), (48, 0.9)];
        assert_eq!(n_for(&curve, 0.8), Some(40));
        // 12 + 12 · .01 / .4 = 12.3: twelve are too few.
        assert_eq!(n_for(&curve, 0.21), Some(13));
        assert_eq!(n_for(&curve, 0.95), None);
        assert_eq!(n_for(&curve, 0.1), Some(12));
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
        let (yes, all) =
            cell.tests.iter().fold((0, 0), |(yes, all), t| (yes + t.rejected, all + t.studies));
        let rate = yes as f64 / all as f64;
        assert!((0.03..0.07).contains(&rate), "{rate} of {all}");
    }

    #[test]
    fn every_test_says_what_it_is_about() {
        let cell = run(&world(), 12, 1);
        assert!(cell.tests.iter().all(|t| !t.about.is_empty()));
        let is_speed = |t: &&TestRate| t.key.starts_with("panel.mean_velocity_mps.");
        let mut speeds = cell.tests.iter().filter(is_speed);
        assert!(speeds.all(|t| t.about.starts_with("Mean velocity")));
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
        // What lies far from the preferred style is liked less.
        let bend = of("congruence.rosas.competence.curvature");
        assert!(bend.mean_estimate.unwrap() < 0.0, "{bend:?}");
        for question in [Question::Dial, Question::Congruence] {
            let asked = cell.findings.iter().find(|f| f.question == question);
            assert_eq!(asked.unwrap().studies, 6, "{question}");
        }
    }

    #[test]
    fn a_study_depends_on_its_seed_alone() {
        let world = world();
        let scores = |seed| {
            let study = world.study(5, seed).unwrap();
            let p = study.data.participants[2].clone();
            let name = "rosas.competence".parse().unwrap();
            study.data.rated(&p, study.data.design.own_style().unwrap(), &name)
        };
        assert_eq!(scores(3), scores(3));
        let all: std::collections::BTreeSet<String> =
            (0..8).map(|seed| format!("{:?}", scores(seed))).collect();
        assert!(all.len() > 2);
    }
}

//! Made-up measures, the shipped scales, and the scores that the tests look at.

use crate::{
    answers::answer_before,
    cohort::Cohort,
    effects::Effects,
    ratings::rate,
    response::{normal, stream},
    settings::CohortSettings,
};
use maveric_domain::{
    Answer, ConditionId, Design, MeasureValues, Moment, ParticipantId, Scale, spread,
};
use std::collections::BTreeMap;

pub(crate) fn design() -> Design {
    Design::from_toml(maveric_data::DESIGNS_PAPER).unwrap()
}

/// The id of a condition of the paper's.
pub(crate) fn id(word: &str) -> ConditionId {
    word.parse().unwrap()
}

/// Its conditions, in the order of its page.
pub(crate) fn conditions() -> Vec<ConditionId> {
    design().condition_ids().collect()
}

pub(crate) fn effects() -> Effects {
    toml::from_str(maveric_data::EFFECTS).unwrap()
}

pub(crate) fn scales() -> Vec<Scale> {
    [
        maveric_data::SCALES_ADB,
        maveric_data::SCALES_MDSI,
        maveric_data::SCALES_MINI_IPIP,
        maveric_data::SCALES_JIAN_TRUST,
        maveric_data::SCALES_ROSAS,
        maveric_data::SCALES_GODSPEED_INTELLIGENCE,
        maveric_data::SCALES_SIMILARITY,
        maveric_data::SCALES_AGGRESSIVENESS,
    ]
    .into_iter()
    .map(|text| Scale::from_toml(text).unwrap())
    .collect()
}

/// Measure, population mean and SD, and the change in the aggressive and the cautious condition (calibration).
const MEASURES: [(&str, f64, f64, f64, f64); 7] = [
    ("mean_velocity_mps", 29.3, 2.6, 2.0, -1.9),
    ("lane_changes", 8.9, 2.9, 1.3, -1.9),
    ("mean_headway_time_s", 1.8, 0.6, -0.1, 0.25),
    ("min_headway_distance_m", 31.0, 10.0, -3.0, 0.0),
    ("headway_merge_back_m", 46.0, 16.0, -9.0, 15.0),
    ("headway_merge_back_s", 1.5, 0.5, -0.4, 0.6),
    ("left_lane_fraction", 0.22, 0.12, 0.0, 0.0),
];

pub(crate) fn own_measures(id: &ParticipantId, seed: u64) -> MeasureValues {
    let mut rng = stream(seed, &[id.as_str(), "test own"]);
    MEASURES
        .iter()
        .map(|(name, mean, sd, _, _)| ((*name).to_owned(), Some(mean + sd * normal(&mut rng))))
        .collect()
}

/// What the four conditions did, with errors of about the size that calibration expects.
pub(crate) fn trials(
    own: &MeasureValues,
    id: &ParticipantId,
    seed: u64,
) -> Vec<(ConditionId, MeasureValues)> {
    let mut shared = stream(seed, &[id.as_str(), "test error"]);
    let errors: Vec<f64> = MEASURES.iter().map(|_| normal(&mut shared)).collect();
    let trial = |condition: ConditionId| {
        let mut rng = stream(seed, &[id.as_str(), "test trial", condition.as_str()]);
        let value = |(i, (name, _, sd, up, down)): (usize, &(&str, f64, f64, f64, f64))| {
            let size = if i == 0 { 0.2 } else { 0.65 };
            let error = size * sd * (0.7 * errors[i] + 0.7 * normal(&mut rng));
            let change = match condition.as_str() {
                "aggressive" => *up,
                "cautious" => *down,
                "perpendicular" => 0.6 * sd * normal(&mut rng),
                _ => 0.0,
            };
            let own = own.get(*name).copied().flatten().unwrap();
            ((*name).to_owned(), Some(own + change + error))
        };
        (condition, MEASURES.iter().enumerate().map(value).collect())
    };
    conditions().into_iter().map(trial).collect()
}

/// Mean of a subscale's answered items after reversal.
pub(crate) fn score(
    answers: &[Answer],
    scales: &[Scale],
    id: &ParticipantId,
    moment: Moment,
    scale: &str,
    subscale: &str,
) -> f64 {
    let scale = scales.iter().find(|s| s.id == scale).unwrap();
    let subscale = scale.subscales.iter().find(|s| s.id == subscale).unwrap();
    let values: Vec<f64> = answers
        .iter()
        .filter(|a| a.participant == *id && a.moment == moment && a.scale == scale.id)
        .filter(|a| subscale.items.contains(&a.item))
        .filter_map(|a| {
            let reversed = scale.is_reversed(subscale, a.item);
            a.answer.map(|x| {
                f64::from(if reversed { scale.items[0].min + scale.items[0].max - x } else { x })
            })
        })
        .collect();
    values.iter().sum::<f64>() / values.len() as f64
}

pub(crate) fn correlation(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sum =
        |f: &dyn Fn(f64, f64) -> f64| x.iter().zip(y).map(|(a, b)| f(a - mx, b - my)).sum::<f64>();
    sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt()
}

/// A study of `n` people: all their answers, before and after.
pub(crate) struct TestStudy {
    pub(crate) cohort: Cohort,
    pub(crate) scales: Vec<Scale>,
    pub(crate) answers: Vec<Answer>,
}

impl TestStudy {
    pub(crate) fn run(n: usize, seed: u64, effects: &Effects) -> Self {
        let scales = scales();
        let cohort = Cohort::draw(0, n, seed, &CohortSettings::default(), &design()).unwrap();
        let mut answers = answer_before(&cohort, &scales, effects, seed).unwrap();
        let own: Vec<MeasureValues> =
            cohort.participants.iter().map(|p| own_measures(&p.id, seed)).collect();
        let spread: BTreeMap<String, f64> = spread(&own.iter().collect::<Vec<_>>());
        for (p, own) in cohort.participants.iter().zip(&own) {
            let trials = trials(own, &p.id, seed);
            answers.extend(rate(p, own, &trials, &spread, &scales, effects, seed).unwrap().answers);
        }
        Self { cohort, scales, answers }
    }

    /// A subscale's score for everybody, in the order of the cohort.
    pub(crate) fn scores(&self, moment: Moment, scale: &str, subscale: &str) -> Vec<f64> {
        let mut asked: BTreeMap<&ParticipantId, Vec<Answer>> = BTreeMap::new();
        let of_scale = |a: &&Answer| a.moment == moment && a.scale == scale;
        for answer in self.answers.iter().filter(of_scale) {
            asked.entry(&answer.participant).or_default().push(answer.clone());
        }
        let people = self.cohort.participants.iter();
        people.map(|p| score(&asked[&p.id], &self.scales, &p.id, moment, scale, subscale)).collect()
    }

    pub(crate) fn mimic_minus(&self, other: ConditionId, scale: &str, subscale: &str) -> Vec<f64> {
        let mimic = self.scores(Moment::after(id("mimic")), scale, subscale);
        let other = self.scores(Moment::after(other), scale, subscale);
        mimic.iter().zip(other).map(|(m, o)| m - o).collect()
    }
}

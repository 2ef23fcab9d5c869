//! 9.2: how well Mimic reproduces the driver; 9.3: whether it is nearer than the other conditions.

use crate::{
    AnalysisError,
    data::StudyData,
    line::{FOLLOWS, title},
    result::{MimicAccuracy, Nearer},
};
use maveric_domain::ConditionId;
use maveric_measures::mean_accuracy;
use maveric_stats::{Adjustment, PosthocTest, WithinSubjects, adjust, posthoc};

/// Mimic accuracy of each measure, beside what the mean of the training drivers would have reached.
pub(crate) fn accuracy(data: &StudyData) -> Vec<MimicAccuracy> {
    let one = |measure: &str| {
        let own: Vec<Option<f64>> = data
            .participants
            .iter()
            .map(|p| data.measured(p, ConditionId::OWN, measure))
            .collect();
        let pair = |(i, p)| (data.measured(p, ConditionId::MIMIC, measure), own[i]);
        let pairs: Vec<_> = data.participants.iter().enumerate().map(pair).collect();
        let found = mean_accuracy(&pairs);
        let trained: Vec<f64> = data.training_drives(measure);
        let guess =
            (!trained.is_empty()).then(|| trained.iter().sum::<f64>() / trained.len() as f64);
        let guesses: Vec<_> = own.iter().map(|v| (guess, *v)).collect();
        MimicAccuracy {
            measure: measure.to_owned(),
            title: title(measure),
            mean: found.mean,
            sd: found.sd,
            n: found.n,
            dropped: found.dropped(),
            population_mean: mean_accuracy(&guesses).mean,
        }
    };
    FOLLOWS.iter().map(|m| one(m)).collect()
}

/// |Mimic − own| against |other − own|, Holm over all rows.
pub(crate) fn nearer(data: &StudyData) -> Result<Vec<Nearer>, AnalysisError> {
    let mut rows = Vec::new();
    for measure in FOLLOWS {
        for than in [ConditionId::AGGRESSIVE, ConditionId::CAUTIOUS] {
            let mut subjects = Vec::new();
            let mut distances: Vec<Vec<f64>> = Vec::new();
            for p in &data.participants {
                let Some(own) = data.measured(p, ConditionId::OWN, measure) else {
                    continue;
                };
                let distance = |c| data.measured(p, c, measure).map(|v| (v - own).abs());
                if let (Some(mimic), Some(other)) = (distance(ConditionId::MIMIC), distance(than)) {
                    subjects.push(p.to_string());
                    distances.push(vec![mimic, other]);
                }
            }
            let n = subjects.len();
            let wins = distances.iter().filter(|d| d[0] < d[1]).count();
            let tested = WithinSubjects::from_rows(
                &["mimic".to_owned(), "other".to_owned()],
                &subjects,
                &distances,
            )
            .ok();
            let compared = tested
                .and_then(|t| posthoc(&t, PosthocTest::Wilcoxon, Adjustment::None, 0.05).ok());
            let p = compared.and_then(|c| c.pairs.get("mimic|other").and_then(|w| w.p));
            rows.push(Nearer {
                measure: measure.to_owned(),
                title: title(measure),
                than,
                n,
                share: (n > 0).then(|| wins as f64 / n as f64),
                p,
                p_holm: None,
            });
        }
    }
    let tested: Vec<usize> = (0..rows.len()).filter(|&i| rows[i].p.is_some()).collect();
    let p: Vec<f64> = tested.iter().filter_map(|&i| rows[i].p).collect();
    if !p.is_empty() {
        let holm = adjust(&p)?.holm;
        for (k, &i) in tested.iter().enumerate() {
            rows[i].p_holm = holm.get(k).copied();
        }
    }
    Ok(rows)
}

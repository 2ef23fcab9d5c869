//! How well the car that drives as the person does reproduces the person, and whether it is nearer than the others.

use crate::{
    AnalysisError,
    data::StudyData,
    outcomes::{Asked, outcomes},
    result::{Nearer, Reproduction},
};
use maveric_measures::mean_accuracy;
use maveric_stats::{Adjustment, PosthocTest, WithinSubjects, adjust, posthoc};

/// The measures among the outcomes.
fn measures(data: &StudyData) -> Vec<Asked> {
    let mut found = outcomes(data);
    found.retain(|asked| asked.column().is_some());
    found
}

/// Accuracy of each measure, beside what the mean of the training drivers would have reached; nothing without a baseline and a condition
/// that lies at 0 on the dial.
pub(crate) fn reproduction(data: &StudyData) -> Vec<Reproduction> {
    let (Some(condition), Some(baseline)) = (data.own_style(), data.design.baseline_id()) else {
        return Vec::new();
    };
    let one = |asked: Asked| {
        let value = |p, c| asked.value(data, p, c);
        let pairs: Vec<_> = data
            .participants
            .iter()
            .map(|p| (value(p, condition), value(p, baseline)))
            .collect();
        let found = mean_accuracy(&pairs);
        let trained = data.training_drives(&asked.id);
        let guess =
            (!trained.is_empty()).then(|| trained.iter().sum::<f64>() / trained.len() as f64);
        let guesses: Vec<_> = pairs.iter().map(|(_, own)| (guess, *own)).collect();
        Reproduction {
            condition,
            measure: asked.id,
            title: asked.title,
            mean: found.mean,
            sd: found.sd,
            n: found.n,
            dropped: found.dropped(),
            population_mean: mean_accuracy(&guesses).mean,
        }
    };
    measures(data).into_iter().map(one).collect()
}

/// |own style − baseline| against |other − baseline|, Holm over all rows.
pub(crate) fn nearer(data: &StudyData) -> Result<Vec<Nearer>, AnalysisError> {
    let (Some(near), Some(baseline)) = (data.own_style(), data.design.baseline_id()) else {
        return Ok(Vec::new());
    };
    let mut rows = Vec::new();
    for asked in measures(data) {
        for than in data.shifted() {
            let mut subjects = Vec::new();
            let mut distances: Vec<Vec<f64>> = Vec::new();
            for p in &data.participants {
                let Some(own) = asked.value(data, p, baseline) else {
                    continue;
                };
                let distance = |c| asked.value(data, p, c).map(|v| (v - own).abs());
                if let (Some(near), Some(other)) = (distance(near), distance(than)) {
                    subjects.push(p.to_string());
                    distances.push(vec![near, other]);
                }
            }
            let n = subjects.len();
            let wins = distances.iter().filter(|d| d[0] < d[1]).count();
            let tested = WithinSubjects::from_rows(
                &["near".to_owned(), "other".to_owned()],
                &subjects,
                &distances,
            )
            .ok();
            let compared = tested
                .and_then(|t| posthoc(&t, PosthocTest::Wilcoxon, Adjustment::None, 0.05).ok());
            let p = compared.and_then(|c| c.pairs.get("near|other").and_then(|w| w.p));
            rows.push(Nearer {
                condition: near,
                measure: asked.id.clone(),
                title: asked.title.clone(),
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

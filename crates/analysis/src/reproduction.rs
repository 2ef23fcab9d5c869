//! How well the car that drives as the person does reproduces the person, and whether it is nearer than the others.

use crate::{
    AnalysisError,
    data::StudyData,
    family::holm,
    outcomes::{Asked, outcomes},
    pairs::panel_of_everybody,
    result::{Bias, Nearer, Panel, Reproduction},
    verdict::equivalent,
};
use maveric_domain::ParticipantId;
use maveric_measures::mean_accuracy;
use maveric_stats::{Adjustment, PosthocTest, WithinSubjects, normality, posthoc};
use std::cmp::Ordering;

/// The measures among the outcomes.
fn measures(data: &StudyData) -> Vec<Asked> {
    let mut measures = outcomes(data);
    measures.retain(|asked| asked.column().is_some());
    measures
}

/// Accuracy of each measure, beside what the mean of the training drivers would have reached; nothing without a baseline and a condition
/// that lies at 0 on the dial.
///
/// Whoever the tests of a measure leave out, for a missing value of any condition, factor or covariate, is left out here too.
pub(crate) fn reproduction(
    data: &StudyData,
    panels: &[Panel],
) -> Result<Vec<Reproduction>, AnalysisError> {
    let (Some(condition), Some(baseline)) = (data.design.own_style(), data.design.baseline_id())
    else {
        return Ok(Vec::new());
    };
    let one = |asked: Asked| {
        let left_out = left_out(panels, &asked.id);
        let value = |p: &ParticipantId, c| {
            let tested = !left_out.contains(&p.to_string());
            asked.value(data, p, c).filter(|_| tested)
        };
        let people = || data.participants.iter();
        let pairs: Vec<_> = people().map(|p| (value(p, condition), value(p, baseline))).collect();
        let accuracy = mean_accuracy(&pairs);
        let trained = data.training_drives(&asked.id);
        let guess =
            (!trained.is_empty()).then(|| trained.iter().sum::<f64>() / trained.len() as f64);
        let guesses: Vec<_> = pairs.iter().map(|(_, own)| (guess, *own)).collect();
        let again: Vec<_> = people()
            .map(|p| (data.second_drive(p, &asked.id), value(p, baseline)))
            .filter(|(again, _)| again.is_some())
            .collect();
        Ok(Reproduction {
            condition,
            mean: accuracy.mean,
            sd: accuracy.sd,
            n: accuracy.n,
            dropped: accuracy.dropped(),
            population_mean: mean_accuracy(&guesses).mean,
            second_drive: mean_accuracy(&again).mean,
            bias: bias(&asked, &pairs)?,
            measure: asked.id,
            title: asked.title,
        })
    };
    let mut rows: Vec<Reproduction> =
        measures(data).into_iter().map(one).collect::<Result<_, AnalysisError>>()?;
    let biases = rows.iter_mut().filter_map(|r| r.bias.as_mut());
    holm(biases.map(|b| (b.p, &mut b.p_holm)))?;
    Ok(rows)
}

/// Whom the tests of a measure leave out.
pub(crate) fn left_out<'a>(panels: &'a [Panel], measure: &str) -> &'a [String] {
    panel_of_everybody(panels, measure).map_or(&[], |panel| &panel.dropped)
}

/// Mean of AV minus driver with its 90 % interval, against what counts as none; nothing for fewer than two people with both
/// values, or where people’s own drives do not differ and nobody declared what counts as none.
///
/// # Source
/// Half a standard deviation: Norman, Sloan and Wyrwich (2003), Interpretation of changes in health-related quality of life: the remarkable
/// universality of half a standard deviation, Medical Care 41.
fn bias(
    asked: &Asked,
    pairs: &[(Option<f64>, Option<f64>)],
) -> Result<Option<Bias>, AnalysisError> {
    let both: Vec<(f64, f64)> = pairs
        .iter()
        .filter_map(|(car, own)| Some((asked.factor * (*car)?, asked.factor * (*own)?)))
        .collect();
    let own_values: Vec<Option<f64>> = both.iter().map(|(_, own)| Some(*own)).collect();
    let half_sd = || Some(0.5 * normality(&own_values).ok()?.desc.sd?);
    let Some(same_within) = asked.same_within.or_else(half_sd).filter(|w| *w > 0.0) else {
        return Ok(None);
    };
    let differences: Vec<f64> = both.iter().map(|(car, own)| car - own).collect();
    let (verdict, test) = equivalent((-same_within, same_within), &differences)?;
    Ok(test.map(|test| Bias {
        unit: asked.unit.clone(),
        n: test.n,
        df: test.df,
        mean: test.estimate,
        interval: test.ci90.ends(),
        t: test.t,
        p: test.p_difference,
        p_holm: None,
        same_within,
        declared: asked.same_within.is_some(),
        p_equivalent: test.p,
        verdict,
    }))
}

/// |own style − baseline| against |other − baseline|, Holm over all rows.
///
/// Of the people of whom the measure is tested, as [`reproduction`].
pub(crate) fn nearer(data: &StudyData, panels: &[Panel]) -> Result<Vec<Nearer>, AnalysisError> {
    let (Some(near), Some(baseline)) = (data.design.own_style(), data.design.baseline_id()) else {
        return Ok(Vec::new());
    };
    let mut rows = Vec::new();
    for asked in measures(data) {
        for than in data.shifted() {
            let mut subjects = Vec::new();
            let mut distances: Vec<Vec<f64>> = Vec::new();
            let left_out = left_out(panels, &asked.id);
            let tested = |p: &&ParticipantId| !left_out.contains(&p.to_string());
            for p in data.participants.iter().filter(tested) {
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
            if n == 0 {
                continue;
            }
            let count = |order| distances.iter().filter(|d| d[0].total_cmp(&d[1]) == order).count();
            let [nearer, tied, farther] =
                [Ordering::Less, Ordering::Equal, Ordering::Greater].map(count);
            let tested = WithinSubjects::from_rows(
                &["near".to_owned(), "other".to_owned()],
                &subjects,
                &distances,
            )
            .ok();
            let compared = tested
                .and_then(|t| posthoc(&t, PosthocTest::Wilcoxon, Adjustment::None, 0.05).ok());
            let compared = compared.and_then(|c| c.pairs.get("near|other").cloned());
            let p = compared.as_ref().and_then(|w| w.p);
            // Of |near| less |other|: a nearer car makes it negative.
            let effect = compared.map(|w| w.effect);
            rows.push(Nearer {
                condition: near,
                measure: asked.id.clone(),
                title: asked.title.clone(),
                than,
                n,
                nearer,
                tied,
                farther,
                effect: effect.as_ref().and_then(|e| Some(-e.value?)),
                interval: effect.as_ref().and_then(|e| e.ci.negated().ends()),
                p,
                p_holm: None,
            });
        }
    }
    holm(rows.iter_mut().map(|r| (r.p, &mut r.p_holm)))?;
    Ok(rows)
}

//! Who prefers what, and what goes with it.

use crate::{
    AnalysisError,
    correlations::{correlate, correlate_within},
    data::StudyData,
    result::{Above, HomophilyRow, Preference, SimilarityRow},
};
use maveric_domain::{
    ConditionId, ParticipantId,
    design::{Homophily, ScoreName, Sign},
};
use maveric_stats::{
    CorrelationMethod, adjust, least_correlation, proportion, simultaneous_interval,
    tied_differences,
};

/// The scale that a member of the family names, and the factor of it, if one alone is meant.
pub(crate) fn scale_and_factor(word: &str) -> (&str, Option<&str>) {
    let parts = word.split_once('.');
    parts.map_or((word, None), |(scale, factor)| (scale, Some(factor)))
}

/// Scores of each member of the family, once each, in the order declared.
fn factors(data: &StudyData, family: &Homophily) -> Result<Vec<ScoreName>, AnalysisError> {
    let mut names: Vec<ScoreName> = Vec::new();
    for word in &family.factors {
        let (scale, factor) = scale_and_factor(word);
        let known = data.pre_subscales(scale);
        if known.is_empty() {
            return Err(AnalysisError::UnansweredScale { scale: scale.to_owned() });
        }
        let wanted: Vec<ScoreName> = match factor {
            None => known,
            Some(factor) if known.iter().any(|k| k.subscale == factor) => {
                vec![ScoreName { scale: scale.to_owned(), subscale: factor.to_owned() }]
            }
            Some(factor) => {
                return Err(AnalysisError::UnknownFactor {
                    scale: scale.to_owned(),
                    factor: factor.to_owned(),
                    known: known.into_iter().map(|k| k.subscale).collect(),
                });
            }
        };
        for name in wanted {
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    Ok(names)
}

/// The declared ratings that somebody gave.
pub(crate) fn ratings(data: &StudyData) -> &[ScoreName] {
    data.design.homophily().map_or(&[], |family| &family.ratings)
}

/// Every factor of the family against every rating difference, own style minus the other: one family of tests.
pub(crate) fn homophily(data: &StudyData) -> Result<Vec<HomophilyRow>, AnalysisError> {
    let (Some(family), Some(own)) = (data.design.homophily(), data.design.own_style()) else {
        return Ok(Vec::new());
    };
    // Once for all factors.
    let mut differences = Vec::new();
    for versus in data.shifted() {
        for name in ratings(data) {
            let pair = |p| Some((data.rated(p, own, name)?, data.rated(p, versus, name)?));
            let pairs: Vec<Option<(f64, f64)>> = data.participants.iter().map(pair).collect();
            differences.push((versus, name, tied_differences(&pairs)));
        }
    }
    let mut rows = Vec::new();
    for factor in factors(data, family)? {
        let x: Vec<Option<f64>> = data.participants.iter().map(|p| data.pre(p, &factor)).collect();
        for (versus, name, y) in &differences {
            rows.push(HomophilyRow {
                title: data.score_title(&factor),
                factor: factor.clone(),
                own,
                versus: *versus,
                rating_title: data.score_title(name),
                rating: (*name).clone(),
                correlation: correlate(&x, y, CorrelationMethod::Auto)?,
                p_holm: None,
                p_bh: None,
                simultaneous: None,
            });
        }
    }
    let p: Vec<f64> = rows.iter().filter_map(|row| row.correlation.p).collect();
    if !p.is_empty() {
        let adjusted = adjust(&p)?;
        let tested = rows.iter_mut().filter(|row| row.correlation.p.is_some());
        for ((row, holm), bh) in tested.zip(adjusted.holm).zip(adjusted.bh) {
            (row.p_holm, row.p_bh) = (Some(holm), Some(bh));
            let c = &row.correlation;
            let ranks = c.method == "spearman";
            row.simultaneous = c.r.and_then(|r| simultaneous_interval(r, c.n, p.len(), ranks));
        }
    }
    Ok(rows)
}

/// People of the pair that most have both values of, and the smallest coefficient of so many, whatever its sign, that could be below .05
/// after Holm in a family of the size of all that were tested; none where nothing was.
pub fn least_that_holds(rows: &[HomophilyRow]) -> Option<(usize, f64)> {
    let tested = rows.iter().filter(|row| row.p_holm.is_some());
    let most = tested.clone().map(|row| row.correlation.n).max()?;
    Some((most, least_correlation(most, tested.count())?))
}

/// Everybody in every condition.
pub(crate) fn cells(data: &StudyData) -> Vec<(&ParticipantId, ConditionId)> {
    let conditions = data.design.conditions();
    data.participants.iter().flat_map(|p| conditions.iter().map(move |c| (p, c.id))).collect()
}

/// Perceived similarity against the ratings, over participants × conditions; nothing where none was declared.
pub(crate) fn similarity(data: &StudyData) -> Result<Vec<SimilarityRow>, AnalysisError> {
    let Some(similar) = data.design.homophily().and_then(|h| h.similarity.as_ref()) else {
        return Ok(Vec::new());
    };
    let cells = cells(data);
    let subjects: Vec<String> = cells.iter().map(|(p, _)| p.to_string()).collect();
    let column = |name: &ScoreName| -> Vec<Option<f64>> {
        cells.iter().map(|(p, c)| data.rated(p, *c, name)).collect()
    };
    let x = column(similar);
    let one = |name: &ScoreName| {
        let y = column(name);
        Ok(SimilarityRow {
            rating: name.clone(),
            title: data.score_title(name),
            pooled: correlate(&x, &y, CorrelationMethod::Spearman)?,
            within: correlate_within(&subjects, &x, &y)?,
        })
    };
    ratings(data).iter().filter(|name| *name != similar).map(one).collect()
}

/// Who rated another style above their own.
pub(crate) fn preferences(data: &StudyData) -> Vec<Preference> {
    let (Some(own), others) = (data.design.own_style(), data.shifted()) else {
        return Vec::new();
    };
    if others.is_empty() {
        return Vec::new();
    }
    let one = |name: &ScoreName| {
        let better = data.better(name);
        let complete: Vec<(f64, Vec<f64>)> = data
            .participants
            .iter()
            .filter_map(|p| {
                let score = |c| data.rated(p, c, name).map(|v| v * better.factor());
                let others = others.iter().map(|c| score(*c)).collect::<Option<_>>()?;
                Some((score(own)?, others))
            })
            .collect();
        let n = complete.len();
        let above = |(index, condition): (usize, &ConditionId)| {
            let above = complete.iter().filter(|(own, o)| o[index] > *own).count();
            let not_below = complete.iter().filter(|(own, o)| *own <= o[index]).count();
            Above {
                condition: *condition,
                above,
                share: proportion(above, n, 0.95).ok(),
                not_below,
                not_below_share: proportion(not_below, n, 0.95).ok(),
            }
        };
        Preference {
            rating: name.clone(),
            title: data.score_title(name),
            less_is_better: better == Sign::Minus,
            own,
            n,
            others: others.iter().enumerate().map(above).collect(),
        }
    };
    ratings(data).iter().map(one).collect()
}

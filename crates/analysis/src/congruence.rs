//! Do people like best a car near their own style?

use crate::{
    AnalysisError, Purpose,
    data::StudyData,
    homophily::{cells, ratings},
    result::{CongruenceCurve, CongruenceRow, PerceivedStyle},
};
use maveric_domain::{
    ConditionId, Moment, ParticipantId,
    design::{Condition, ScoreName, Sign},
};
use maveric_stats::{Congruence, CongruenceData, Named, Predictor, StatsError, congruence};
use std::{collections::BTreeSet, iter};

/// What counts as near: this share of a step of the dial, 5 of the paper's 15 points.
const NEAR: f64 = 1.0 / 3.0;

/// Each rating, turned so that more is better, over the distance of the car from the person's own style, as it was driven; nothing where
/// the dial has fewer than three places. Where people rated the car's style the same follows by what they perceived, if all is asked for.
///
/// Rated similarity says how near a car is, not how it is liked.
pub(crate) fn by_rating(
    data: &StudyData,
    purpose: Purpose,
) -> Result<Vec<CongruenceRow>, AnalysisError> {
    let dials = data.design.conditions().iter().filter_map(Condition::dial);
    let places: BTreeSet<u64> = dials.clone().map(|d| (d + 0.0).to_bits()).collect();
    if places.len() < 3 {
        return Ok(Vec::new());
    }
    let furthest = dials.fold(0.0, |far: f64, d| far.max(d.abs()));
    let step = data.design.style().and_then(|style| style.points);
    let near = NEAR * step.unwrap_or(furthest);
    let rows = Rows::new(data);
    let driven = rows.driven(near, places.len());
    let perceived = match purpose {
        Purpose::Report => rows.perceived(near),
        Purpose::Simulation => None,
    };
    let similar = data.design.homophily().and_then(|h| h.similarity.as_ref());
    let mut fitted = Vec::new();
    for distances in iter::once(driven).chain(perceived) {
        for name in ratings(data) {
            if Some(name) != similar && !distances.is_by(name) {
                fitted.push(rows.fitted(name, &distances)?);
            }
        }
    }
    Ok(fitted)
}

/// How far each car lies from the person's own style, a value a row.
struct Distances {
    perceived: Option<PerceivedStyle>,
    moved: Vec<Option<f64>>,
    /// Less the middle.
    own: Vec<Option<f64>>,
    middle: f64,
    near: f64,
    /// Of the dial; none where they are the distances that people perceived.
    places: Option<usize>,
    /// Why no model can be made of them.
    why_not: Option<String>,
}

impl Distances {
    /// Whether a score is what says how far the car lies.
    fn is_by(&self, name: &ScoreName) -> bool {
        self.perceived.as_ref().is_some_and(|by| by.score == *name)
    }
}

/// A score by which people compared the car with themselves.
struct Comparing {
    score: ScoreName,
    /// The answer that means "as I do".
    same: f64,
    range: (f64, f64),
    /// Which way along the dial more of it points; none where conditions expect both.
    along: Option<Sign>,
}

/// Everybody in every car on the dial.
struct Rows<'a> {
    data: &'a StudyData,
    cells: Vec<(&'a ParticipantId, ConditionId)>,
    subjects: Vec<String>,
    periods: Vec<Option<String>>,
}

impl<'a> Rows<'a> {
    fn new(data: &'a StudyData) -> Self {
        let on_the_dial = |c| data.design.condition(c).is_some_and(|c| c.dial().is_some());
        let mut cells = cells(data);
        cells.retain(|(_, c)| on_the_dial(*c));
        let period = |p, c| data.period(p, c).map(|period| period.to_string());
        Self {
            data,
            subjects: cells.iter().map(|(p, _)| p.to_string()).collect(),
            periods: cells.iter().map(|&(p, c)| period(p, c)).collect(),
            cells,
        }
    }

    fn driven(&self, near: f64, places: usize) -> Distances {
        let middle = middle(self.data.style_range());
        let row = |(person, condition)| self.data.condition(person, condition);
        let own_points = |cell| {
            let row = row(cell)?;
            Some(row.adb_hat? - row.moved_points? - middle)
        };
        let cells = || self.cells.iter().copied();
        Distances {
            perceived: None,
            moved: cells().map(|cell| row(cell)?.moved_points).collect(),
            own: cells().map(own_points).collect(),
            middle,
            near,
            places: Some(places),
            why_not: None,
        }
    }

    /// The first score that compares the car with oneself, was asked after rides and is expected to turn on the dial.
    fn comparing(&self) -> Option<Comparing> {
        let data = self.data;
        let conditions = data.design.conditions().iter();
        let expected = conditions.filter_map(|c| Some((c.side()?, &c.expected)));
        let mut keys = expected.clone().flat_map(|(_, expected)| expected.keys());
        keys.find_map(|key| {
            let score: ScoreName = key.parse().ok()?;
            let is_rated = data.rated_names().contains(&score);
            let (scale, subscale) = data.subscale(&score).filter(|_| is_rated)?;
            let mut along =
                expected.clone().filter_map(|(side, expected)| Some(side * *expected.get(key)?));
            let first = along.next()?;
            Some(Comparing {
                same: subscale.same?,
                range: scale.score_range(subscale),
                along: along.all(|other| other == first).then_some(first),
                score,
            })
        })
    }

    /// How people rated the car by the style's score less how they rated themselves before the drives; where rides did not ask for it, how
    /// they compared the car with themselves, what is near being the same share of its range. None where neither was asked.
    fn perceived(&self, near: f64) -> Option<Distances> {
        let data = self.data;
        let style = &data.design.style()?.score;
        let own_score = |p: &ParticipantId| data.answered_at(Moment::Pre, p, style);
        if data.participants.iter().all(|p| own_score(p).is_none()) {
            return None;
        }
        let comparing =
            if data.rated_names().contains(style) { None } else { Some(self.comparing()?) };
        let range = data.style_range();
        let (score, near) = match &comparing {
            None => (style, near),
            Some(with) => {
                let ((low, high), (lowest, highest)) = (with.range, range?);
                (&with.score, near * (high - low) / (highest - lowest))
            }
        };
        let moved = |&(p, c): &(&ParticipantId, ConditionId)| {
            let rated = data.rated(p, c, score)?;
            Some(match &comparing {
                None => rated - own_score(p)?,
                Some(with) => with.along.map_or(1.0, Sign::factor) * (rated - with.same),
            })
        };
        let moved: Vec<Option<f64>> = self.cells.iter().map(moved).collect();
        let middle = middle(range);
        let cells = self.cells.iter();
        let unclear = comparing.as_ref().filter(|with| with.along.is_none());
        Some(Distances {
            perceived: Some(PerceivedStyle {
                score: score.clone(),
                title: data.score_title(score),
                same: comparing.as_ref().map(|with| with.same),
            }),
            own: cells.map(|&(p, _)| Some(own_score(p)? - middle)).collect(),
            moved,
            middle,
            near,
            places: None,
            why_not: unclear.map(|with| {
                format!(
                    "expected of {} is not one sign above 0 on the dial and the other below, so which way along the dial it points is not known",
                    with.score
                )
            }),
        })
    }

    fn fitted(
        &self,
        name: &ScoreName,
        distances: &Distances,
    ) -> Result<CongruenceRow, AnalysisError> {
        let better = self.data.better(name).factor();
        let liking: Vec<Option<f64>> = self
            .cells
            .iter()
            .map(|(p, c)| self.data.rated(p, *c, name).map(|rated| better * rated))
            .collect();
        let (mut model, period, why_not) = self.model(&liking, distances)?;
        let needs_period = period && model.is_some();
        let complete = |index: &usize| {
            let (moved, own) = (distances.moved[*index], distances.own[*index]);
            let has_period = !needs_period || self.periods[*index].is_some();
            has_period && liking[*index].and(moved).and(own).is_some()
        };
        let complete: Vec<usize> = (0..self.cells.len()).filter(complete).collect();
        let curves = match &mut model {
            // It decides nothing, and is not drawn.
            Some(model) if distances.perceived.is_some() => {
                model.surface = Named::default();
                Vec::new()
            }
            Some(model) => self.curves(model, better, distances, &complete),
            None => Vec::new(),
        };
        // What differs by less is the same number, added up in another way.
        let place = |d: f64| ((d * 1e6).round() + 0.0).to_bits();
        let met = complete.iter().filter_map(|row| distances.moved[*row]);
        let met: BTreeSet<u64> = met.map(place).collect();
        Ok(CongruenceRow {
            rating: name.clone(),
            title: self.data.score_title(name),
            less_is_better: better < 0.0,
            perceived: distances.perceived.clone(),
            n: self.people(&complete),
            places: distances.places.unwrap_or(met.len()),
            near_points: distances.near,
            middle: distances.middle,
            period,
            model,
            curves,
            why_not,
        })
    }

    /// How many people have these rows.
    fn people(&self, rows: &[usize]) -> usize {
        let people = rows.iter().map(|row| self.cells[*row].0);
        people.collect::<BTreeSet<_>>().len()
    }

    /// The fit, whether it takes the period, and why there is none.
    fn model(
        &self,
        liking: &[Option<f64>],
        distances: &Distances,
    ) -> Result<(Option<Congruence>, bool, Option<String>), AnalysisError> {
        if let Some(why) = &distances.why_not {
            return Ok((None, false, Some(why.clone())));
        }
        let fit = |beside: &[(&str, Predictor)]| {
            let rows = CongruenceData {
                subjects: &self.subjects,
                liking,
                moved: &distances.moved,
                own: &distances.own,
                beside,
            };
            congruence(&rows, distances.near)
        };
        let period = [("period", Predictor::Factor(&self.periods))];
        let with_period = self.data.has_orders().then(|| fit(&period));
        let separable = |fitted: &Result<_, StatsError>| {
            !matches!(fitted, Err(StatsError::Collinear { .. } | StatsError::OneLevel { .. }))
        };
        let with_period = with_period.filter(separable);
        let period = with_period.is_some();
        match with_period.unwrap_or_else(|| fit(&[])) {
            Ok(model) => Ok((Some(model), period, None)),
            Err(
                why @ (StatsError::TooFew { .. }
                | StatsError::BadParameter { .. }
                | StatsError::Collinear { .. }
                | StatsError::NoFit { .. }),
            ) => Ok((None, period, Some(why.to_string()))),
            Err(why) => Err(why.into()),
        }
    }

    /// What people of the mean own style and one standard deviation to either side are predicted to answer, where there are such.
    fn curves(
        &self,
        model: &Congruence,
        better: f64,
        distances: &Distances,
        complete: &[usize],
    ) -> Vec<CongruenceCurve> {
        let style_at = |sds: i8| model.own_mean + f64::from(sds) * model.own_sd;
        let drawn_sds: [i8; 3] = [-1, 0, 1];
        let ends = self.data.style_range();
        let nearest = |own: f64| {
            let apart = |sds: &i8| (style_at(*sds) - own).abs();
            drawn_sds.into_iter().min_by(|a, b| apart(a).total_cmp(&apart(b)))
        };
        let curve = |sds: i8| {
            let is_theirs = |row: &usize| distances.own[*row].and_then(nearest) == Some(sds);
            let theirs: Vec<usize> = complete.iter().copied().filter(is_theirs).collect();
            let moved = theirs.iter().filter_map(|row| distances.moved[*row]);
            let met = moved.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), moved| {
                (low.min(moved), high.max(moved))
            });
            // Nobody's car has a score that the scale does not have.
            let (lowest, highest) = ends.map_or(met, |(lowest, highest)| {
                let own_points = style_at(sds) + distances.middle;
                (lowest - own_points, highest - own_points)
            });
            let met = (met.0.max(lowest), met.1.min(highest));
            (!theirs.is_empty()).then(|| CongruenceCurve {
                sds,
                own: style_at(sds) + distances.middle,
                n: self.people(&theirs),
                met,
                rating: predicted(model, style_at(sds)).map(|of| better * of),
            })
        };
        drawn_sds.into_iter().filter_map(curve).collect()
    }
}

fn middle(range: Option<(f64, f64)>) -> f64 {
    range.map_or(0.0, |(low, high)| f64::midpoint(low, high))
}

/// Liking at a distance of 0, by the distance and by its square, of somebody whose own style, less the middle, is this.
fn predicted(model: &Congruence, own: f64) -> [f64; 3] {
    let estimate = |name: &str| model.coef.get(name).map_or(0.0, |effect| effect.estimate);
    // Each less the first, whose effect is 0.
    let periods = model.coef.iter();
    let periods: Vec<f64> = periods
        .filter(|(name, _)| name.starts_with("period["))
        .map(|(_, effect)| effect.estimate)
        .collect();
    let period = periods.iter().sum::<f64>() / (periods.len() + 1) as f64;
    [
        estimate("(Intercept)") + period + own * (estimate("own") + own * estimate("own^2")),
        estimate("moved") + own * estimate("moved:own"),
        estimate("moved^2"),
    ]
}

#[cfg(test)]
mod tests;

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
        let own = |cell| {
            let row = row(cell)?;
            Some(row.adb_hat? - row.moved_points? - middle)
        };
        let cells = || self.cells.iter().copied();
        Distances {
            perceived: None,
            moved: cells().map(|cell| row(cell)?.moved_points).collect(),
            own: cells().map(own).collect(),
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
            let asked = data.rated_names().contains(&score);
            let (scale, subscale) = data.subscale(&score).filter(|_| asked)?;
            let mut along = expected
                .clone()
                .filter_map(|(side, expected)| Some(side * *expected.get(key)?));
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
        let own = |p: &ParticipantId| data.answered_at(Moment::Pre, p, style);
        if data.participants.iter().all(|p| own(p).is_none()) {
            return None;
        }
        let comparing = if data.rated_names().contains(style) {
            None
        } else {
            Some(self.comparing()?)
        };
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
                None => rated - own(p)?,
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
            own: cells.map(|&(p, _)| Some(own(p)? - middle)).collect(),
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
            !matches!(
                fitted,
                Err(StatsError::Collinear { .. } | StatsError::OneLevel { .. })
            )
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
        let at = |sds: i8| model.own_mean + f64::from(sds) * model.own_sd;
        let all: [i8; 3] = [-1, 0, 1];
        let ends = self.data.style_range();
        let nearest = |own: f64| {
            let apart = |sds: &i8| (at(*sds) - own).abs();
            all.into_iter().min_by(|a, b| apart(a).total_cmp(&apart(b)))
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
                let own = at(sds) + distances.middle;
                (lowest - own, highest - own)
            });
            let met = (met.0.max(lowest), met.1.min(highest));
            (!theirs.is_empty()).then(|| CongruenceCurve {
                sds,
                own: at(sds) + distances.middle,
                n: self.people(&theirs),
                met,
                rating: predicted(model, at(sds)).map(|of| better * of),
            })
        };
        all.into_iter().filter_map(curve).collect()
    }
}

fn middle(range: Option<(f64, f64)>) -> f64 {
    range.map_or(0.0, |(low, high)| f64::midpoint(low, high))
}

/// Liking at a distance of 0, by the distance and by its square, of somebody whose own style, less the middle, is this.
fn predicted(model: &Congruence, own: f64) -> [f64; 3] {
    let of = |name: &str| model.coef.get(name).map_or(0.0, |effect| effect.estimate);
    // Each less the first, whose effect is 0.
    let periods = model.coef.iter();
    let periods: Vec<f64> = periods
        .filter(|(name, _)| name.starts_with("period["))
        .map(|(_, effect)| effect.estimate)
        .collect();
    let period = periods.iter().sum::<f64>() / (periods.len() + 1) as f64;
    [
        of("(Intercept)") + period + own * (of("own") + own * of("own^2")),
        of("moved") + own * of("moved:own"),
        of("moved^2"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Analysis, Person, Question, StudyData, Tables, Verdict, finding,
        testing::{DESIGN, analysed_by, id, liked, person},
    };
    use Verdict::{Fails, NotShown, Shown, TooFew};
    use maveric_domain::{ConditionRow, Design, Scale, Score};
    use maveric_stats::{Bend, Region};
    use std::collections::BTreeMap;

    /// The design less its car across the dial.
    fn on_the_dial() -> String {
        let across = "    [[condition]]\n    id = \"across\"\n    car = { across = true }\n";
        assert!(DESIGN.contains(across));
        DESIGN.replace(across, "")
    }

    fn analysed(tables: Tables) -> Analysis {
        analysed_by(&on_the_dial(), tables)
    }

    fn row(analysis: &Analysis) -> &CongruenceRow {
        &analysis.congruence[0]
    }

    fn verdict(analysis: &Analysis) -> Option<Verdict> {
        finding::by_question(&analysis.findings, Question::Congruence).map(|f| f.verdict)
    }

    #[test]
    fn people_who_like_best_what_is_near_their_own_style_are_found_and_others_are_not() {
        let near = analysed(liked(24, |_| 1.0, 0.01));
        let model = row(&near).model.as_ref().unwrap();
        assert_eq!(
            (model.bend, model.n_subjects, row(&near).n),
            (Bend::Top, 24, 24)
        );
        assert!((model.turn.estimate.unwrap() - 1.0).abs() < 1.0);
        assert!((row(&near).near_points - 5.0).abs() < 1e-12);
        assert_eq!(verdict(&near), Some(Shown));
        // Everybody wants a car ten points above their own.
        assert_eq!(verdict(&analysed(liked(24, |_| 10.0, 0.01))), Some(Fails));
        // Everybody wants the same car, wherever their own style lies.
        let one_car = analysed(liked(24, |own| 30.0 - own, 0.01));
        let parts = &finding::by_question(&one_car.findings, Question::Congruence)
            .unwrap()
            .parts;
        let of: Vec<(&str, Verdict)> = parts.iter().map(|p| (p.of.as_str(), p.verdict)).collect();
        assert_eq!(
            of,
            [
                ("jian_trust.overall.top", Shown),
                ("jian_trust.overall.movement", Fails)
            ]
        );
        assert_eq!(verdict(&analysed(liked(24, |_| 0.0, 0.0))), Some(NotShown));
    }

    #[test]
    fn what_is_liked_least_near_ones_own_style_fails_and_has_no_top() {
        let worst = analysed(liked(24, |_| 0.0, -0.01));
        assert_eq!(verdict(&worst), Some(Fails));
        let finding = finding::by_question(&worst.findings, Question::Congruence).unwrap();
        assert!(finding.parts.iter().all(|part| part.estimate.is_none()));
        let flat = analysed(liked(24, |_| 0.0, 0.0));
        let region = row(&flat).model.as_ref().unwrap().turn.region;
        assert!(
            !matches!(region, Some(Region::Between { .. })),
            "{region:?}"
        );
    }

    #[test]
    fn fewer_than_six_people_or_three_places_are_not_judged() {
        assert_eq!(verdict(&analysed(liked(5, |_| 1.0, 0.01))), Some(TooFew));
        let two = on_the_dial().replace("car = { dial = \"-1\" }", "car = { mean = true }");
        let two = analysed_by(&two, liked(24, |_| 1.0, 0.01));
        assert!(two.congruence.is_empty());
        assert_eq!(verdict(&two), None);
        // Without a style nobody's distance is known.
        let mut unknown = liked(24, |_| 1.0, 0.01);
        unknown
            .conditions
            .iter_mut()
            .for_each(|row| row.adb_hat = None);
        let unknown = analysed(unknown);
        assert_eq!((row(&unknown).n, row(&unknown).model.is_some()), (0, false));
        assert!(row(&unknown).why_not.is_some() && row(&unknown).curves.is_empty());
        assert_eq!(verdict(&unknown), None);
    }

    #[test]
    fn a_rating_whose_low_values_are_better_is_turned() {
        let mut tables = rated(liked(24, |_| 1.0, 0.01), |moved| moved);
        for score in tables.post.iter_mut().filter(|s| s.scale == "jian_trust") {
            score.value = score.value.map(|trust| 8.0 - trust);
        }
        let keyed = |lower: bool| {
            let scale = format!(
                "id = \"jian_trust\"\ntitle = \"T\"\nreference = \"r\"\nitems = 1\nmin = 1\nmax = 7\nscoring = \"mean\"\n\
                 [[subscales]]\nid = \"overall\"\ntitle = \"T\"\nitems = [1]\nlower_is_better = {lower}"
            );
            vec![Scale::from_toml(&scale).unwrap()]
        };
        tables.scales = keyed(true);
        let turned = analysed(tables.clone());
        assert_eq!(verdict(&turned), Some(Shown));
        // Best is where the rating, as it is keyed, is lowest.
        let is_lowest = |curve: &CongruenceCurve| curve.rating[2] > 0.0;
        assert!(row(&turned).less_is_better && row(&turned).curves.iter().all(is_lowest));
        let bend = |analysis: &Analysis| {
            let perceived = by_what_was_perceived(analysis);
            let model = perceived.model.as_ref().unwrap();
            (perceived.less_is_better, model.bend)
        };
        assert_eq!(bend(&turned), (true, Bend::Top));
        tables.scales = keyed(false);
        let as_asked = analysed(tables);
        assert_eq!(verdict(&as_asked), Some(Fails));
        assert_eq!(bend(&as_asked), (false, Bend::Bottom));
    }

    /// The same people, who rated themselves and each car by the score of the style: the car where they felt it to be.
    fn rated(mut tables: Tables, felt: impl Fn(f64) -> f64) -> Tables {
        for row in tables.conditions.clone() {
            let moved = row.moved_points.unwrap();
            let own = row.adb_hat.unwrap() - moved;
            let score = |moment, value| Score {
                participant: row.participant.clone(),
                moment,
                scale: "adb".to_owned(),
                subscale: "total".to_owned(),
                value: Some(value),
                answered: 1,
                items: 1,
            };
            let after = Moment::after(row.condition);
            tables.post.push(score(after, own + felt(moved)));
            if moved == 0.0 {
                tables.pre.push(score(Moment::Pre, own));
            }
        }
        tables
    }

    fn by_what_was_perceived(analysis: &Analysis) -> &CongruenceRow {
        let [driven, row] = &analysis.congruence[..] else {
            panic!("{:?}", analysis.congruence)
        };
        assert!(driven.perceived.is_none() && row.perceived.is_some());
        // It is not drawn.
        let surface = |row: &CongruenceRow| row.model.as_ref().map_or(0, |m| m.surface.len());
        assert_eq!((surface(driven), driven.curves.len()), (9, 3));
        assert_eq!((surface(row), row.curves.len()), (0, 0));
        row
    }

    fn turn(row: &CongruenceRow) -> (f64, bool) {
        let turn = &row.model.as_ref().unwrap().turn;
        let p = turn.p_lower.unwrap().max(turn.p_upper.unwrap());
        (turn.estimate.unwrap(), p < 0.05)
    }

    #[test]
    fn what_is_liked_best_as_perceived_is_found_near_and_elsewhere_and_decides_nothing() {
        // Everybody likes best their own style, and feels every car to lie where it does, or eight points below.
        let alike = analysed(rated(liked(24, |_| 1.0, 0.01), |moved| moved));
        let (driven, near) = turn(row(&alike));
        let (perceived, also_near) = turn(by_what_was_perceived(&alike));
        assert!(near && also_near && (driven - perceived).abs() < 1e-3);
        let below = analysed(rated(liked(24, |_| 1.0, 0.01), |moved| moved - 8.0));
        let (perceived, near) = turn(by_what_was_perceived(&below));
        assert!(!near && (driven - 8.0 - perceived).abs() < 0.05);
        assert_eq!(verdict(&below), Some(Shown));
        // Everybody likes best what lies ten points above and is felt to be their own.
        let above = analysed(rated(liked(24, |_| 10.0, 0.01), |moved| moved - 10.0));
        let (perceived, near) = turn(by_what_was_perceived(&above));
        assert!(near && perceived.abs() < 1.5, "{perceived}");
        assert_eq!(verdict(&above), Some(Fails));
        let finding = finding::by_question(&above.findings, Question::Congruence).unwrap();
        assert_eq!(finding.parts.len(), 2);
    }

    /// The design, where the car at a place of the dial is expected to seem more aggressive (+) or less (-).
    fn expecting(signs: &[(&str, &str)]) -> String {
        let design = on_the_dial().replace("points = 15", "points = 15\n    range = [11, 55]");
        signs.iter().fold(design, |design, (dial, sign)| {
            let car = format!("car = {{ dial = \"{dial}\" }}");
            let expected =
                format!("expected = {{ \"aggressiveness.aggressiveness\" = \"{sign}\" }}");
            design.replace(&car, &format!("{car}\n    {expected}"))
        })
    }

    /// People who rated themselves by the score of the style, and how much more aggressive than they a car is: 4, and so much more a point.
    fn compared(best: f64, more: f64) -> Tables {
        let mut tables = rated(liked(24, |_| best, 0.01), |moved| moved);
        for score in tables.post.iter_mut().filter(|s| s.scale == "adb") {
            let theirs = |s: &&Score| s.scale == "adb" && s.participant == score.participant;
            let own = tables.pre.iter().find(theirs).unwrap().value.unwrap();
            score.value = score.value.map(|felt| 4.0 + more * (felt - own));
            "aggressiveness".clone_into(&mut score.scale);
            "aggressiveness".clone_into(&mut score.subscale);
        }
        let scale = "id = \"aggressiveness\"\ntitle = \"T\"\nreference = \"r\"\nitems = 1\nmin = 1\nmax = 7\nscoring = \"mean\"\n\
             [[subscales]]\nid = \"aggressiveness\"\ntitle = \"T\"\nitems = [1]\nsame = 4";
        tables.scales = vec![Scale::from_toml(scale).unwrap()];
        tables
    }

    /// Points a step of the answer.
    const STEP: f64 = 7.5;

    #[test]
    fn a_score_that_compares_the_car_with_oneself_is_a_distance_of_its_own() {
        let design = expecting(&[("+1", "+"), ("-1", "-")]);
        let mut tables = compared(1.0, 1.0 / STEP);
        let analysis = analysed_by(&design, tables.clone());
        let perceived = by_what_was_perceived(&analysis);
        let same = |row: &CongruenceRow| row.perceived.as_ref().unwrap().same;
        assert_eq!(same(perceived), Some(4.0));
        assert!((perceived.near_points - 5.0 * 6.0 / 44.0).abs() < 1e-12);
        assert_eq!((perceived.places, perceived.middle), (3, 33.0));
        let (driven, _) = turn(row(&analysis));
        let (turned, near) = turn(perceived);
        assert!(near && (driven / STEP - turned).abs() < 1e-3);
        // Of studies that are only counted, nothing is asked twice.
        let data = StudyData::new(&Design::from_toml(&design).unwrap(), tables.clone()).unwrap();
        assert_eq!(by_rating(&data, Purpose::Simulation).unwrap().len(), 1);
        // Who answered it before the drives too has the same own style and distances.
        for mut score in tables.pre.clone() {
            if score.scale == "adb" {
                "aggressiveness".clone_into(&mut score.scale);
                "aggressiveness".clone_into(&mut score.subscale);
                tables.pre.push(score);
            }
        }
        let both = analysed_by(&design, tables.clone());
        assert_eq!(turn(by_what_was_perceived(&both)), (turned, near));
        // The style's own score goes before.
        let own = rated(liked(24, |_| 1.0, 0.01), |moved| moved).post;
        let mut with_own = tables.clone();
        with_own
            .post
            .extend(own.into_iter().filter(|s| s.scale == "adb"));
        let with_own = analysed_by(&design, with_own);
        assert_eq!(same(by_what_was_perceived(&with_own)), None);
        // What is not expected to turn on the dial, or compares with nothing though it was asked before and after, says nothing of style; nor
        // is known whose own style was asked after the drives.
        let rows = |design: &str, tables| analysed_by(design, tables).congruence.len();
        assert_eq!(rows(&expecting(&[]), tables.clone()), 1);
        let mut unknown = tables.clone();
        unknown.scales.clear();
        assert_eq!(rows(&design, unknown), 1);
        for score in &mut tables.pre {
            score.moment = Moment::Post;
        }
        assert_eq!(rows(&design, tables), 1);
    }

    #[test]
    fn what_was_compared_points_as_the_dial_does_or_nowhere() {
        // Who scores high drives calmly; everybody likes best what scores 3 points above their own.
        let turned = |signs: &[(&str, &str)], more: f64| {
            let calm = "range = [11, 55]\n    aggression = \"-\"";
            let design = expecting(signs).replace("range = [11, 55]", calm);
            let analysis = analysed_by(&design, compared(3.0, more / STEP));
            let (driven, _) = turn(row(&analysis));
            let (perceived, _) = turn(by_what_was_perceived(&analysis));
            assert!(driven > 2.0, "{driven}");
            perceived - driven / STEP
        };
        assert!(turned(&[("+1", "-"), ("-1", "+")], -1.0).abs() < 1e-3);
        assert!(turned(&[("-1", "+")], -1.0).abs() < 1e-3);
        assert!(turned(&[("+1", "+")], -1.0) < -0.5);
        let both = expecting(&[("+1", "+"), ("-1", "+")]);
        let both = analysed_by(&both, compared(1.0, 1.0 / STEP));
        let nowhere = by_what_was_perceived(&both);
        assert!(nowhere.model.is_none() && nowhere.n == 24);
        let why = nowhere.why_not.as_ref().unwrap();
        assert!(why.contains("aggressiveness.aggressiveness"), "{why}");
        assert_eq!(verdict(&both), Some(Shown));
    }

    #[test]
    fn who_has_no_order_is_not_counted_where_the_model_takes_the_period() {
        let mut tables = liked(24, |_| 1.0, 0.01);
        for i in 0..24 {
            let mut order = ["same", "fast", "slow"].map(id).to_vec();
            order.rotate_left(i % 3);
            if i == 5 {
                order.clear();
            }
            tables.people.push(Person {
                id: person(i),
                learned: false,
                tested: true,
                order,
                columns: BTreeMap::new(),
            });
        }
        let theirs =
            |row: &&mut ConditionRow| row.participant == person(5) && row.condition == id("fast");
        let furthest = tables.conditions.iter_mut().find(theirs).unwrap();
        furthest.moved_points = furthest.moved_points.map(|moved| moved + 10.0);
        furthest.adb_hat = furthest.adb_hat.map(|score| score + 10.0);
        let tables = rated(tables, |moved| moved);
        let data = StudyData::new(&Design::from_toml(&on_the_dial()).unwrap(), tables).unwrap();
        let rows = by_rating(&data, Purpose::Report).unwrap();
        assert_eq!(rows.len(), 2);
        for row in &rows {
            let model = row.model.as_ref().unwrap();
            assert_eq!((row.period, row.n, model.n_subjects), (true, 23, 23));
        }
        let curves = &rows[0].curves;
        assert_eq!(curves.iter().map(|curve| curve.n).sum::<usize>(), 23);
        assert!(curves.iter().all(|curve| curve.met == (-15.0, 15.0)));
    }

    #[test]
    fn a_row_written_before_curves_and_what_was_perceived_is_read() {
        let analysis = analysed(liked(24, |_| 1.0, 0.01));
        let mut before = serde_json::to_value(row(&analysis)).unwrap();
        for key in ["less_is_better", "perceived", "curves"] {
            let had = before.as_object_mut().unwrap().remove(key);
            assert!(had.is_some(), "{key}");
        }
        let read: CongruenceRow = serde_json::from_value(before).unwrap();
        assert!(read.is_judged() && !read.less_is_better && read.curves.is_empty());
        assert_eq!(read.n, row(&analysis).n);
    }

    #[test]
    fn curves_are_those_of_the_model_over_what_was_met_and_as_the_rating_is_keyed() {
        let analysis = analysed(liked(24, |own| 0.3 * (own - 30.0), 0.01));
        let near = row(&analysis);
        let model = near.model.as_ref().unwrap();
        let sds: Vec<i8> = near.curves.iter().map(|curve| curve.sds).collect();
        assert_eq!(sds, [-1, 0, 1]);
        assert_eq!(near.curves.iter().map(|curve| curve.n).sum::<usize>(), 24);
        let top = |curve: &CongruenceCurve| -curve.rating[1] / (2.0 * curve.rating[2]);
        let [low, mean, high] = &near.curves[..] else {
            panic!("{:?}", near.curves)
        };
        assert!((top(mean) - model.turn.estimate.unwrap()).abs() < 1e-9);
        let movement = model.movement.estimate.unwrap();
        assert!((top(high) - top(low) - movement).abs() < 1e-9);
        assert!((mean.own - near.middle - model.own_mean).abs() < 1e-9);
        assert!((high.own - low.own - 2.0 * model.own_sd).abs() < 1e-9);
        for curve in &near.curves {
            assert_eq!(curve.met, (-15.0, 15.0));
            assert!(curve.rating[2] < 0.0 && (2.0..6.0).contains(&curve.rating[0]));
        }
        // No car has a score that the scale does not have.
        let ranged = on_the_dial().replace("points = 15", "points = 15\n    range = [11, 55]");
        let tables = liked(24, |own| 0.3 * (own - 30.0), 0.01);
        let ends = row(&analysed_by(&ranged, tables)).curves[0].clone();
        assert!((ends.met.0 - (11.0 - ends.own)).abs() < 1e-9, "{ends:?}");
        assert!((ends.met.1 - 15.0).abs() < 1e-9, "{ends:?}");
    }
}
